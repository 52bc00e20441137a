/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * The queue, the quarantine, and the end of an attempt. The phases and their events are in src/engine/README.md.
 */

/* ---- The queue ---- */

fathom_transaction_t **fathom_line_find(fathom_line_t *line, const fathom_transaction_t *transaction)
{
    fathom_transaction_t **link = &line->head;
    while ((*link != NULL) && (*link != transaction)) link = &(*link)->link.next;
    return link;
}

void fathom_line_free_wire(fathom_line_t *line, uint8_t next_phase)
{
    line->phase = next_phase;
    line->wait = WAIT_NONE;
    line->attempt.request_length = 0;
    line->attempt.fault = FAULT_NONE;
}

void fathom_line_finish(fathom_line_t *line, fathom_transaction_t **link, fathom_status_t status)
{
    fathom_transaction_t *const transaction = *link;
    if (link == &line->head) {
        line->wait = WAIT_NONE; /* The next transaction begins a wait of its own. */
        if (line->phase >= FATHOM_LINE_PORT_BUSY) fathom_line_free_wire(line, FATHOM_LINE_IDLE);
    }
    *link = transaction->link.next;
    transaction->link.heard_us = fathom_line_last_byte_us(line);
    transaction->status = (int8_t)status;
}

/* ---- The quarantine ---- */

uint16_t fathom_line_units_of(uint8_t address)
{
    return (uint16_t)((address == FATHOM_LINE_ANY_UNIT) ? UINT16_MAX : (1u << (address % 16u)));
}

bool fathom_line_is_quarantined(const fathom_line_t *line, uint8_t address)
{
    return (line->quarantined_units & fathom_line_units_of(address)) != 0u;
}

/*
 * Modbus frames carry no sequence number: a late response looks exactly like the response to the next request of the
 * same shape. So after a failed attempt the line sends this unit nothing until its late response can no longer arrive.
 *
 *     wire        [request]                                   [late response]
 *     attempt               |<---- timeout_us ---->| failed
 *     quarantine                                   |<---- timeout_us ---->|
 *     this unit                                    | no request           | next request
 *     other units                                  | next request at once
 *
 *  - The quarantine belongs to the unit, not to the request: a late exception fits every request with that function,
 *    and a unit that is still busy with request A cannot serve request B.
 *  - The quarantine ends with any frame with a right checksum from that unit, because a unit that gets no request owes
 *    at most one response. Otherwise it ends at twice the time-out after the end of the request.
 *  - One deadline, the latest, serves all units. It cannot move on without end, because a unit in quarantine gets no
 *    request that could extend it. Units with equal addresses modulo 16 share one bit. Both can only delay a request.
 *  - If the response was complete but damaged, it will hardly arrive again: only the rest of the time-out remains. If
 *    it only seemed to begin, it may have been noise, and the real response may still be late: the full time applies.
 *  - While a cancelled request still leaves, the time does not run (move_to() in line.c).
 */
void fathom_line_quarantine(fathom_line_t *line)
{
    const fathom_transaction_t *const transaction = line->head;
    if (!expects_response(line)) return; /* No unit responds to a broadcast. */
    uint32_t duration_us =
        (line->phase == FATHOM_LINE_WAITING) ? response_left_us(line) : transaction->timeout_us;
    if (line->attempt.fault != FAULT_CORRUPT) duration_us += transaction->timeout_us;
    if ((line->quarantined_units == 0u) || (line->quarantine_left_us < duration_us))
        line->quarantine_left_us = duration_us;
    line->quarantined_units |= fathom_line_units_of(transaction->address);
}

/* ---- The end of an attempt ---- */

/* The precedence is that of status.h. */
static fathom_status_t error_of_attempt(const fathom_line_t *line)
{
    if (line->wait == WAIT_SKIPPED) return FATHOM_ERR_LINE_BUSY;
    if (line->attempt.fault == FAULT_CLAIMED) return FATHOM_ERR_OTHER_MASTER;
    if (line->attempt.fault == FAULT_LOST) return FATHOM_ERR_NO_RESPONSE;
    if (line->attempt.fault >= FAULT_TRUNCATED) return FATHOM_ERR_CHECKSUM;
    if (line->attempt.fault == FAULT_UNEXPECTED) return FATHOM_ERR_MALFORMED;
    if ((line->attempt.copy == COPY_PAST) && (line->echo == FATHOM_LINE_ECHO_AUTO)) return FATHOM_ERR_ECHO;
    return FATHOM_ERR_NO_RESPONSE;
}

/* A broadcast is finished; every other attempt has failed. A transaction with retries left stays at the head of the
 * queue; next() in line_request.c has the retry policy. */
void fathom_line_end_attempt(fathom_line_t *line)
{
    if (!expects_response(line)) {
        fathom_line_finish(line, &line->head, FATHOM_OK);
        return;
    }
    const fathom_status_t error = error_of_attempt(line);
    fathom_line_add(line, (uint8_t)-error, 1); /* line.h: the index of the counter is -status. */
    if (line->wait == WAIT_SKIPPED) fathom_line_note_sender(line, SENDER_LOSS, 0);
    fathom_line_quarantine(line);
    fathom_line_free_wire(line, FATHOM_LINE_IDLE);
    if (line->head->attempts > line->head->retries) fathom_line_finish(line, &line->head, error);
}
