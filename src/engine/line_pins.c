/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_pins.h"

fathom_status_t fathom_output_set_line_break(const void *ctx, uint8_t level)
{
    fathom_line_t *const line = (fathom_line_t *)ctx;
    if (level == FATHOM_OUTPUT_REST) return fathom_output_set_break(line->config->uart, level);
    return fathom_line_break(line, level == FATHOM_OUTPUT_LOW);
}

static fathom_status_t poll(void *ctx) { return fathom_line_poll(ctx); }

static bool is_clear(void *ctx, uint32_t now_us)
{
    const fathom_line_t *const line = ctx;
    return fathom_line_is_idle(line) &&
           fathom_elapsed_us(now_us, fathom_line_heard_us(line)) >= FATHOM_CONTACT_QUIET_US;
}

static uint32_t due_us(void *ctx) { return fathom_line_due_us(ctx); }

fathom_contact_guard_t fathom_contact_line_guard(fathom_line_t *line)
{
    fathom_contact_guard_t guard;
    guard.poll = poll;
    guard.is_clear = is_clear;
    guard.due_us = due_us;
    guard.ctx = line;
    return guard;
}
