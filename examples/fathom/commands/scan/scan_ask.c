/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_ask.h"

#include <string.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/modbus_client.h"

enum { SET_LINE_POLL_US = 1000 };

bool scan_is_answered(fathom_status_t status)
{
    return status == FATHOM_OK || status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_MALFORMED;
}

static uint32_t now_us(const scan_wire_t *wire) { return wire->clock->now_us(wire->clock->ctx); }

static bool wait_for_line(const scan_wire_t *wire, uint32_t max_us)
{
    const uint32_t due_us = fathom_line_due_us(wire->line);
    return wire->wait(wire->ctx, due_us < max_us ? due_us : max_us);
}

/* Listens with the line as it is. */
static fathom_status_t listen(const scan_wire_t *wire, uint32_t us, void (*each)(void *ctx), void *ctx)
{
    const uint32_t began_us = now_us(wire);
    for (;;) {
        if (fathom_line_poll(wire->line) != FATHOM_PENDING) return FATHOM_ERR_PORT;
        if (each != NULL) each(ctx);
        const uint32_t passed_us = fathom_elapsed_us(now_us(wire), began_us);
        if (passed_us >= us) return FATHOM_OK;
        if (!wait_for_line(wire, us - passed_us)) return FATHOM_ERR_CANCELLED;
    }
}

fathom_status_t scan_hear(const scan_wire_t *wire, const fathom_line_settings_t *line, uint32_t us,
                          void (*each)(void *ctx), void *ctx)
{
    const fathom_uart_t *const uart = wire->line->parts->uart;
    for (;;) {
        const int is_set = uart->set_line != NULL ? uart->set_line(uart->ctx, line) : -1;
        if (is_set < 0) return FATHOM_ERR_UNSUPPORTED;
        if (is_set > 0) break;
        if (!wire->wait(wire->ctx, SET_LINE_POLL_US)) return FATHOM_ERR_CANCELLED;
    }
    listener_forget(wire->listener);
    return listen(wire, us, each, ctx);
}

/* At 0 an A16 or A05 may be, and an HPS-167S, to which it is a broadcast, has none of their registers. */
static bool is_harmless(const scan_request_t *request)
{
    enum { FIRST_OF_DYP = 0x0100 };
    const bool is_to_all =
        request->address == FATHOM_LINE_ALL_UNITS && (request->is_dyp || request->first < FIRST_OF_DYP);
    return request->first != FATHOM_HPS167S_RESET && request->count <= SCAN_REGISTERS && !is_to_all;
}

static fathom_status_t wait_for_response(const scan_wire_t *wire, fathom_modbus_request_t *pending)
{
    const fathom_transaction_t *const transaction = &pending->transaction;
    for (;;) {
        (void)fathom_line_poll(wire->line); /* a broken port ends the transaction */
        if (transaction->status != FATHOM_PENDING) return transaction->status;
        if (!wait_for_line(wire, FATHOM_NO_DEADLINE)) fathom_line_cancel(wire->line, &pending->transaction);
        if (transaction->status != FATHOM_PENDING) return transaction->status;
    }
}

void scan_ask(const scan_wire_t *wire, const scan_request_t *request, scan_response_t *response)
{
    fathom_modbus_request_t pending;
    memset(&pending, 0, sizeof pending);
    memset(response, 0, sizeof *response);
    response->status = FATHOM_ERR_ARGUMENT;
    if (!is_harmless(request)) return;
    pending.transaction.timeout_us = request->timeout_us;
    pending.transaction.line_settings = request->line;
    fathom_modbus_read_holding_registers(&pending.message, request->address, request->first, request->count,
                                         response->values);
    listener_forget(wire->listener);
    const fathom_modbus_t modbus = fathom_modbus_client_with_zero(wire->line);
    response->status = request->is_dyp ? fathom_dyp_client_submit(wire->line, &pending)
                                       : modbus.submit(modbus.line, &pending);
    if (response->status == FATHOM_PENDING) response->status = wait_for_response(wire, &pending);
    response->address = pending.message.head[0];
    if (scan_is_answered(response->status) && request->linger_us != 0) {
        const fathom_status_t heard = listen(wire, request->linger_us, NULL, NULL);
        if (heard != FATHOM_OK) response->status = heard;
    }
    listener_judge(wire->listener, request->address, &response->evidence);
}
