/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan.h"

#include "fathom/engine/line.h"
#include "ports/line_text.h"
#include "sensors/models.h"

enum {
    REQUEST_BYTES = 8,
    FIRST_ADDRESS = 1,
    LAST_ADDRESS = 32, /* of an HPS-167S */
    /* The datasheets print no period of the frames. A16 2(2) gives its value 7.5 s to settle. */
    DEFAULT_LISTEN_US = 8000000
};

/* The system wakes a program late, and a USB adapter reports late that a request has left. */
enum { LATENESS_US = 5000 };

const fathom_line_settings_t *scan_listen_line(void)
{
    return &model_with(DECODE_STREAM_ONE | DECODE_STREAM_FOUR)->line;
}

static bool is_of(const model_t *model, const fathom_line_settings_t *line)
{
    return line->baud == model->line.baud && line->parity == model->line.parity;
}

/* Returns none at 9600 baud and even above, which an HPS-167S keeps at all its rates (HPS-167S 2.2.2). */
static uint8_t factory_parity(uint32_t baud)
{
    size_t i = 0;
    while (i != model_count - 1 && !model_has_rate(&models[i], baud)) i++;
    return models[i].line.parity;
}

bool scan_has_dyp(const fathom_line_settings_t *line) { return is_of(model_with(DECODE_DYP), line); }

uint32_t scan_timeout_us(const scan_plan_t *plan, const fathom_line_settings_t *line)
{
    uint32_t timeout_us = SCAN_TIMEOUT_US;
    if (plan->timeout_us != 0) return plan->timeout_us;
    for (size_t i = 0; i != model_count; i++)
        if (is_of(&models[i], line) && models[i].scan.timeout_us > timeout_us)
            timeout_us = models[i].scan.timeout_us;
    return timeout_us;
}

uint16_t scan_silence_us(const scan_plan_t *plan)
{
    uint16_t longest_us = 0;
    for (uint8_t i = 0; i != plan->setting_count; i++) {
        const fathom_line_settings_t *const line = &plan->settings[i];
        const uint16_t us = fathom_silence_us(line);
        if (us > longest_us) longest_us = us;
    }
    return longest_us;
}

static void add_settings(scan_plan_t *plan, uint32_t baud, uint8_t parity, uint8_t stop_bits)
{
    plan->settings[plan->setting_count++] = (fathom_line_settings_t){baud, parity, stop_bits};
}

/* The parity of the factory comes first: at an address where a device responds, the others of this rate are left out. */
static void add_rate(scan_plan_t *plan, uint32_t baud, unsigned parities, uint8_t stop_bits)
{
    const uint8_t factory = factory_parity(baud);
    if (parities == 0 || (parities & 1u << factory) != 0) add_settings(plan, baud, factory, stop_bits);
    for (uint8_t parity = 0; parity != SCAN_PARITIES; parity++)
        if (parity != factory && (parities & 1u << parity) != 0) add_settings(plan, baud, parity, stop_bits);
}

void scan_make_plan(scan_plan_t *plan, const scan_settings_t *settings)
{
    scan_rates_t rates = settings->rates;
    unsigned parities = settings->parities;
    if (parities == 0 && settings->stop_bits == 2) parities = 1u << FATHOM_PARITY_NONE; /* HPS-167S 2.2.2 */
    for (size_t i = 0; i != model_count && settings->rates.count == 0; i++)
        scan_add_rate(&rates, models[i].line.baud);
    *plan = (scan_plan_t){.timeout_us = settings->timeout_us,
                          .listen_us = settings->listen_us != 0 ? settings->listen_us : DEFAULT_LISTEN_US,
                          .addresses = settings->addresses,
                          .repeats = settings->retries};
    if (!settings->has_addresses) plan->addresses = (scan_addresses_t){FIRST_ADDRESS, LAST_ADDRESS};
    for (uint8_t i = 0; i != rates.count; i++)
        add_rate(plan, rates.baud[i], parities, settings->stop_bits != 0 ? settings->stop_bits : 1);
}

static uint32_t request_us(const fathom_line_settings_t *line)
{
    return (uint32_t)(REQUEST_BYTES * fathom_character_bits(line) * UINT32_C(1000000) / line->baud);
}

uint32_t scan_address_count(const scan_plan_t *plan)
{
    return (uint32_t)(plan->addresses.last - plan->addresses.first + 1);
}

uint32_t scan_probe_us(const scan_plan_t *plan, const fathom_line_settings_t *line)
{
    /* The silence before the next request passes with the time-out. Before an address is asked again, the scan waits as
     * long again, since the address may still respond. */
    const uint32_t timeout_us = scan_timeout_us(plan, line);
    const uint32_t once_us = request_us(line) + timeout_us + LATENESS_US;
    return once_us + plan->repeats * (once_us + timeout_us);
}

uint32_t scan_any_us(const scan_plan_t *plan)
{
    return scan_timeout_us(plan, &model_with(DECODE_DYP)->line) + 2 * SCAN_ANY_TIMEOUT_US + LATENESS_US;
}

uint64_t scan_plan_us(const scan_plan_t *plan)
{
    uint64_t sum_us = plan->listen_us;
    for (uint8_t i = 0; i != plan->setting_count; i++) {
        sum_us += (uint64_t)scan_probe_us(plan, &plan->settings[i]) * scan_address_count(plan);
        if (scan_has_dyp(&plan->settings[i])) sum_us += scan_any_us(plan);
    }
    return sum_us;
}
