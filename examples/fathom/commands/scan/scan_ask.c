/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/scan/scan.h"
#include "fathom/codec/hps167s_registers.h"

enum { SET_LINE_POLL_US = 1000 };

bool scan_is_answered(fathom_status_t status)
{
    return status == FATHOM_OK || status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_MALFORMED;
}

bool scan_has_ended(fathom_status_t status)
{
    return status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
}

bool scan_is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

static uint64_t now_us(const scan_t *scan) { return scan->host->now_us(scan->host->ctx); }

static bool wait_for_line(scan_t *scan, uint32_t max_us)
{
    const uint32_t due_us = fathom_line_due_us(&scan->channel.line);
    return scan_wait(scan, due_us < max_us ? due_us : max_us);
}

static fathom_status_t listen(scan_t *scan, uint32_t us)
{
    const uint64_t end_us = now_us(scan) + us;
    for (;;) {
        if (fathom_line_poll(&scan->channel.line) != FATHOM_PENDING) return FATHOM_ERR_PORT;
        const uint64_t at_us = now_us(scan);
        if (at_us >= end_us) return FATHOM_OK;
        if (!wait_for_line(scan, (uint32_t)(end_us - at_us))) return FATHOM_ERR_CANCELLED;
    }
}

fathom_status_t scan_hear(scan_t *scan, const fathom_line_settings_t *line, uint32_t us)
{
    const fathom_uart_t *const uart = &scan->channel.uart;
    int is_set = 0;
    while (is_set == 0) {
        is_set = uart->set_line != NULL ? uart->set_line(uart->ctx, line) : -1;
        if (is_set < 0) return FATHOM_ERR_UNSUPPORTED;
        if (is_set == 0 && !scan_wait(scan, SET_LINE_POLL_US)) return FATHOM_ERR_CANCELLED;
    }
    listener_forget(&scan->channel.listener);
    return listen(scan, us);
}

/* An A16 or A05 can have address 0. To an HPS-167S that is a broadcast, but it has none of their registers. */
static bool is_harmless(const scan_request_t *request)
{
    enum { FIRST_OF_DYP = 0x0100 };
    const bool is_to_all =
        request->address == FATHOM_LINE_ALL_UNITS && (request->is_dyp || request->first < FIRST_OF_DYP);
    return request->first != FATHOM_HPS167S_RESET && request->count <= SCAN_REGISTERS && !is_to_all;
}

static void wait_for_response(scan_t *scan, fathom_transaction_t *transaction)
{
    fathom_line_t *const line = &scan->channel.line;
    (void)fathom_line_poll(line); /* a broken port ends the transaction */
    while (transaction->status == FATHOM_PENDING) {
        if (wait_for_line(scan, FATHOM_NO_DEADLINE))
            (void)fathom_line_poll(line);
        else
            fathom_line_cancel(line, transaction);
    }
}

void scan_ask(scan_t *scan, const scan_request_t *request, scan_response_t *response)
{
    channel_t *const channel = &scan->channel;
    fathom_modbus_request_t pending;
    memset(&pending, 0, sizeof pending);
    memset(response, 0, sizeof *response);
    response->status = FATHOM_ERR_ARGUMENT;
    if (!is_harmless(request)) return;
    pending.transaction.timeout_us = request->timeout_us;
    pending.transaction.line_settings = request->line;
    fathom_modbus_read_holding_registers(&pending.message, request->address, request->first, request->count,
                                         response->values);
    listener_forget(&channel->listener);
    response->status = request->is_dyp ? fathom_dyp_client_submit(&channel->line, &pending)
                                       : channel->modbus.submit(&channel->line, &pending);
    if (response->status == FATHOM_PENDING) {
        wait_for_response(scan, &pending.transaction);
        response->status = pending.transaction.status;
    }
    response->address = pending.message.head[0];
    if (scan_is_answered(response->status) && request->linger_us != 0) {
        const fathom_status_t heard = listen(scan, request->linger_us);
        if (heard != FATHOM_OK) response->status = heard;
    }
    listener_judge(&channel->listener, request->address, &response->evidence);
}
