/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * The transaction that is next goes to the front and out. A port that takes nothing, perhaps because of the settings,
 * is tried again by the next poll, for FATHOM_LINE_SEND_US at most.
 */
fathom_status_t fathom_line_send(fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->config->uart;
    fathom_transaction_t *const x = line->kind->next(line);
    if (x == NULL) return FATHOM_PENDING;
    *fathom_line_find(line, x) = x->link.next;
    x->link.next = line->head;
    line->head = x;
    uint8_t length = 0;
    int n = 1;
    if (x->line_settings != NULL)
        n = (uart->set_line != NULL) ? uart->set_line(uart->ctx, x->line_settings) : -1;
    if (n < 0) {
        fathom_line_finish(line, &line->head, FATHOM_ERR_UNSUPPORTED);
        return FATHOM_PENDING;
    }
    if (n != 0) {
        length = x->protocol->encode(x, line->config->frame);
        n = uart->write(uart->ctx, line->config->frame, length);
        if ((n != 0) && (n != (int)length)) return fathom_line_broken(line);
    }
    if (n != 0) {
        x->attempts++;
        line->protocol = x->protocol;
        if ((x->address != FATHOM_LINE_ALL_UNITS) || x->protocol->zero_answers) line->sent = length;
        forget(line, ECHO_DUE);
        line->state = (uint8_t)(SENDING | ((unsigned)(line->known & FATHOM_LINE_ECHO_OFF) * ECHOED));
    } else if (line->state == IDLE) {
        line->state = REFUSED;
    } else {
        return (line->left_us != 0u) ? FATHOM_PENDING : fathom_line_broken(line);
    }
    line->left_us = FATHOM_LINE_SEND_US;
    return FATHOM_PENDING;
}
