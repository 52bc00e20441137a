/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_plan.h"

#include "fathom/engine/line.h"
#include "ports/line_text.h"
#include "sensors/dyp.h"
#include "sensors/hps167s/hps167s.h"

const fathom_line_settings_t scan_dyp_line = DYP_LINE;
const fathom_line_settings_t scan_hps167s_line = HPS167S_LINE;

enum { REQUEST_BYTES = 8 };

/* The system wakes a program late, and a USB adapter tells late that a request has left. */
enum { LATENESS_US = 5000 };

uint8_t scan_factory_parity(uint32_t baud)
{
    return baud == scan_dyp_line.baud ? scan_dyp_line.parity : scan_hps167s_line.parity;
}

bool scan_is_dyp_line(const fathom_line_settings_t *line)
{
    return line->baud == scan_dyp_line.baud && line->parity == scan_dyp_line.parity;
}

uint32_t scan_timeout_us(const scan_plan_t *plan, const fathom_line_settings_t *line)
{
    if (plan->timeout_us != 0) return plan->timeout_us;
    return scan_is_dyp_line(line) ? SCAN_DYP_TIMEOUT_US : SCAN_TIMEOUT_US;
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
    return scan_timeout_us(plan, &scan_dyp_line) + 2 * SCAN_ANY_TIMEOUT_US + LATENESS_US;
}

uint64_t scan_plan_us(const scan_plan_t *plan)
{
    uint64_t sum_us = plan->listen_us;
    for (uint8_t i = 0; i != plan->setting_count; i++) {
        sum_us += (uint64_t)scan_probe_us(plan, &plan->settings[i]) * scan_addresses(plan);
        if (scan_is_dyp_line(&plan->settings[i])) sum_us += scan_any_us(plan);
    }
    return sum_us;
}
