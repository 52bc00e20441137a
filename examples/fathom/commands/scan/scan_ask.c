/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/scan/scan.h"
#include "sensors/models.h"

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

fathom_status_t scan_hear(scan_t *scan, const fathom_line_settings_t *line, uint32_t us)
{
    enum { SLICE_US = 100000 };
    const fathom_uart_t *const uart = scan->port.parts.uart;
    int is_set = 0;
    fathom_status_t status = FATHOM_OK;
    while (status == FATHOM_OK && is_set == 0) {
        is_set = uart->set_line != NULL ? uart->set_line(uart->ctx, line) : -1;
        if (is_set == 0) status = port_wait(&scan->port, SET_LINE_POLL_US);
    }
    if (is_set < 0) return FATHOM_ERR_UNSUPPORTED;
    listener_forget(&scan->port.listener);
    for (uint32_t heard_us = 0; status == FATHOM_OK && heard_us < us; heard_us += SLICE_US) {
        scan_show_progress(scan);
        status = port_listen(&scan->port, us - heard_us < SLICE_US ? us - heard_us : SLICE_US);
    }
    return status;
}

static bool is_harmless(const scan_request_t *request)
{
    if (request->is_dyp) return request->address != FATHOM_LINE_ALL_UNITS;
    return request->count <= SCAN_REGISTERS &&
           models_allow_read(request->address, request->first, request->count);
}

void scan_ask(scan_t *scan, const scan_request_t *request, scan_response_t *response)
{
    port_t *const port = &scan->port;
    fathom_modbus_request_t pending;
    memset(&pending, 0, sizeof pending);
    memset(response, 0, sizeof *response);
    response->status = FATHOM_ERR_ARGUMENT;
    if (!is_harmless(request)) return;
    response->status = FATHOM_ERR_CANCELLED;
    if (scan->output_error != 0) return;
    pending.transaction.timeout_us = request->timeout_us;
    pending.transaction.line_settings = request->line;
    fathom_modbus_read_holding_registers(&pending.message, request->address, request->first, request->count,
                                         response->values);
    listener_forget(&port->listener);
    response->status = request->is_dyp ? fathom_dyp_client_submit(&port->line, &pending)
                                       : port->modbus.submit(&port->line, &pending);
    if (response->status == FATHOM_PENDING) response->status = port_finish(port, &pending.transaction);
    response->address = pending.message.head[0];
    if (scan_is_answered(response->status) && request->linger_us != 0) {
        const fathom_status_t heard = port_listen(port, request->linger_us);
        if (heard != FATHOM_OK) response->status = heard;
    }
    listener_judge(&port->listener, request->address, &response->evidence);
}
