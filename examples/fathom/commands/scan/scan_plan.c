/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_plan.h"

#include "fathom/engine/line.h"
#include "ports/line_text.h"
#include "sensors/models.h"

enum { REQUEST_BYTES = 8 };

/* The system wakes a program late, and a USB adapter tells late that a request has left. */
enum { LATENESS_US = 5000 };

const fathom_line_settings_t *scan_listen_line(void)
{
    return &model_with(DECODE_STREAM_ONE | DECODE_STREAM_FOUR)->line;
}

static bool is_of(const model_t *model, const fathom_line_settings_t *line)
{
    return line->baud == model->line.baud && line->parity == model->line.parity;
}

uint8_t scan_factory_parity(uint32_t baud)
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

static uint32_t request_us(const fathom_line_settings_t *line)
{
    return (uint32_t)(REQUEST_BYTES * fathom_character_bits(line) * UINT32_C(1000000) / line->baud);
}

uint32_t scan_addresses(const scan_plan_t *plan) { return (uint32_t)(plan->last - plan->first + 1); }

uint32_t scan_probe_us(const scan_plan_t *plan, const fathom_line_settings_t *line)
{
    /* The silence before the next request has passed with the time-out. An address that is asked again is left alone
     * before for as long as it may still answer. */
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
        sum_us += (uint64_t)scan_probe_us(plan, &plan->settings[i]) * scan_addresses(plan);
        if (scan_has_dyp(&plan->settings[i])) sum_us += scan_any_us(plan);
    }
    return sum_us;
}
