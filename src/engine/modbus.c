/* SPDX-License-Identifier: MIT */
#include "fathom/engine/modbus.h"

static void cancel(void *ctx, fathom_modbus_request_t *request)
{
    fathom_line_cancel(ctx, &request->transaction);
}

static void cancel_unit(void *ctx, uint8_t address) { fathom_line_cancel_unit(ctx, address); }

static fathom_status_t poll(void *ctx, uint32_t since_us)
{
    return fathom_line_was_polled(ctx, since_us) ? FATHOM_PENDING : fathom_line_poll(ctx);
}

static uint32_t due_us(void *ctx) { return fathom_line_due_us(ctx); }

static bool has(void *ctx, const fathom_modbus_request_t *request)
{
    return fathom_line_is_queued(ctx, &request->transaction);
}

fathom_modbus_t fathom_modbus_over_line(fathom_line_t *line,
                                        fathom_status_t (*submit)(void *line,
                                                                  fathom_modbus_request_t *request))
{
    fathom_modbus_t modbus;
    modbus.submit = submit;
    modbus.cancel = cancel;
    modbus.cancel_unit = cancel_unit;
    modbus.poll = poll;
    modbus.due_us = due_us;
    modbus.clock = NULL;
    modbus.ctx = line;
    modbus.has = has;
    modbus.frame_size = 0;
    if (line->parts != NULL) {
        modbus.clock = line->parts->clock;
        modbus.frame_size = line->parts->frame_size;
    }
    return modbus;
}
