/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * Received bytes on a line that sends requests: the echo, the frames, and to which transaction a frame belongs.
 */

/* ---- Bytes that belong to no transaction ---- */

/* Passes on the first `length` bytes in the buffer, as far as the listener has not received them. */
static void pass(fathom_line_t *line, uint8_t length)
{
    const uint8_t passed_count = line->passed_count;
    if (length <= passed_count) return;
    line->passed_count = length;
    fathom_line_pass(line, passed_count, (uint8_t)(length - passed_count));
}

/*
 * Handles the first `length` bytes in the buffer, which belong to no transaction. Returns `length`.
 *
 * If the time-out has passed, the attempt ends here: bytes that begin now are another device's frame or noise, which
 * could otherwise keep the attempt alive without end.
 */
static uint8_t discard(fathom_line_t *line, uint8_t length)
{
    pass(line, length);
    if (!expects_response(line)) fathom_line_note_sender(line, SENDER_BYTES, length);
    /* A complete frame hides no echo; single bytes may. Without a request on the wire none is due. */
    if ((length == 1u) && (line->attempt.copy == COPY_DUE)) line->attempt.copy = COPY_HIDDEN;
    if (is_overtime(line)) fathom_line_end_attempt(line);
    return length;
}

/* The first `length` bytes in the buffer are a response or an echo. The listener's next frame cannot continue across it. */
static uint8_t accept(fathom_line_t *line, uint8_t length)
{
    line->is_after_gap = true;
    return length;
}

/* ---- Received frames ---- */

static void learn_echo(fathom_line_t *line, uint8_t echo)
{
    if (line->parts->find_echo != NULL) line->parts->find_echo(line, echo);
}

/*
 * Assigns a complete frame with a right checksum from `address` to the first transaction that it is a response to.
 * Returns false if there is none. A transaction without an attempt has requested nothing.
 */
static bool serve(fathom_line_t *line, uint8_t address)
{
    const fathom_protocol_t *const protocol = line->protocol;
    for (fathom_transaction_t **link = &line->head; *link != NULL; link = &(*link)->link.next) {
        fathom_transaction_t *const transaction = *link;
        if ((transaction->attempts == 0u) || !is_from_unit_of(transaction, address) ||
            (transaction->protocol->parse_response != protocol->parse_response))
            continue;
        const fathom_status_t status = protocol->parse_response(transaction, line->parts->frame);
        if ((status != FATHOM_OK) && (status != FATHOM_ERR_EXCEPTION)) continue;
        fathom_line_add(line, (uint8_t)-status, 1); /* line.h: the index of the counter is -status. */
        fathom_line_note_sender(line, SENDER_RESPONSE, 0);
        fathom_line_finish(line, link, status);
        return true;
    }
    return false;
}

static void note_unrequested(fathom_line_t *line)
{
    if (line->parts->masters != NULL) line->parts->masters->note_unrequested(line);
}

/* A frame from the unit that the request on the wire was sent to. Returns true if a transaction accepts the frame. */
static bool accept_response(fathom_line_t *line, uint8_t address)
{
    const bool has_no_echo = line->attempt.copy == COPY_DUE;
    /* A second unit may respond as well. */
    if (line->head->address == FATHOM_LINE_ANY_UNIT) fathom_line_quarantine(line);
    note_fault(line, FAULT_UNEXPECTED);
    if ((line->attempt.fault >= FAULT_LOST) || !serve(line, address)) {
        note_unrequested(line);
        return false;
    }
    if (has_no_echo) learn_echo(line, FATHOM_LINE_ECHO_OFF);
    return true;
}

/* A frame from another unit: a late response if the unit is in quarantine, else a foreign frame. Returns true if a
 * transaction accepts the frame. The echo of a cancelled request looks like a late response, once. */
static bool accept_late_response(fathom_line_t *line, uint8_t address)
{
    const fathom_line_masters_t *const masters = line->parts->masters;
    const bool is_claimed = (masters != NULL) && masters->take_answer(line, address);
    const bool is_late = fathom_line_is_quarantined(line, address) && !is_echo_due(line) && !is_claimed;
    if (is_echo_due(line)) line->attempt.copy = COPY_PAST;
    fathom_line_add(line, is_late ? FATHOM_LINE_LATE_RESPONSES : FATHOM_LINE_STRAYS, 1);
    if (!is_late) {
        if (!is_claimed) note_unrequested(line);
        return false;
    }
    line->quarantined_units &= (uint16_t)~fathom_line_units_of(address);
    return serve(line, address);
}

static bool accept_frame(fathom_line_t *line)
{
    const uint8_t address = line->parts->frame[line->protocol->address_offset];
    return expects_unit(line, address) ? accept_response(line, address) : accept_late_response(line, address);
}

/* ---- Scanning ---- */

enum { NEED_MORE = 0 };

/* Less than three bytes are noise: they show no broken response. */
enum { MIN_TRUNCATED = 3 };

/* Returns true if the bytes at the front are a response of the unit that is damaged or broke off. */
static bool is_damaged_response(const fathom_line_t *line, uint8_t frame_length)
{
    return (frame_length != 0u) && (line->received_count >= MIN_TRUNCATED) &&
           expects_unit(line, line->parts->frame[line->protocol->address_offset]);
}

/* Discards one byte, since no valid frame begins at the front of the buffer. */
static uint8_t skip_byte(fathom_line_t *line, uint8_t frame_length, bool is_complete)
{
    if (is_damaged_response(line, frame_length)) {
        /* While the request still leaves, noise is more likely than a response. */
        const bool is_corrupt = is_complete && (line->phase != FATHOM_LINE_SENDING);
        note_fault(line, is_corrupt ? FAULT_CORRUPT : FAULT_TRUNCATED);
    }
    return discard(line, 1);
}

static uint8_t take_echo(fathom_line_t *line, bool is_response)
{
    if (!is_response) learn_echo(line, FATHOM_LINE_ECHO_ON);
    if ((line->attempt.copy == COPY_PAST) && is_overtime(line))
        return discard(line, line->attempt.request_length);
    line->attempt.copy = COPY_PAST;
    fathom_line_note_sender(line, SENDER_ECHO, 0);
    return accept(line, line->attempt.request_length);
}

/* A complete frame with a right checksum that is no echo. */
static uint8_t take_frame(fathom_line_t *line, uint8_t length, bool is_over)
{
    if (line->wait == WAIT_NOISE) line->wait = WAIT_FRAMES;
    if (accept_frame(line)) return accept(line, length);
    if ((length == line->received_count) && !is_over) fathom_line_note_sender(line, SENDER_FRAME, 0);
    return discard(line, length);
}

/*
 * Handles the bytes at the beginning of the buffer, if they can be decided. If `is_over` is true, no byte will complete a
 * frame there. Returns the number of bytes that leave the buffer; 0: more bytes are needed.
 */
static uint8_t take_front(fathom_line_t *line, bool is_over)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->parts->frame;
    const uint8_t received_count = line->received_count;
    /* Without a protocol nothing was ever submitted. */
    if ((protocol == NULL) && (line->parts->masters == NULL)) return discard(line, received_count);

    const uint8_t length = (protocol != NULL) ? protocol->length(frame, received_count) : 0u;
    const bool is_complete = (length != 0u) && (length <= received_count);
    uint8_t frame_length = 0; /* Of a complete frame with a right checksum. */
    if (is_complete && (protocol->check(frame, length) == 0u)) frame_length = length;
    const uint8_t request_length = fathom_line_find_request(line, frame_length != 0u);
    if ((request_length != 0u) && (request_length <= received_count)) return discard(line, request_length);
    const bool can_complete = (length > received_count) && (length <= line->parts->frame_size);
    if (can_complete && !is_over) return NEED_MORE;

    if (fathom_line_is_echo(line, frame_length)) {
        if (line->attempt.request_length <= received_count) return take_echo(line, frame_length != 0u);
        if (!is_over) return NEED_MORE;
    }
    if (frame_length != 0u) return take_frame(line, frame_length, is_over);
    if ((request_length != 0u) && !is_over) return NEED_MORE;
    return skip_byte(line, length, is_complete);
}

static void remove_bytes(fathom_line_t *line, uint8_t length)
{
    uint8_t *const frame = line->parts->frame;
    line->received_count = (uint8_t)(line->received_count - length);
    line->passed_count = (line->passed_count > length) ? (uint8_t)(line->passed_count - length) : 0u;
    for (uint8_t i = 0; i != line->received_count; i++) frame[i] = frame[i + length];
}

/* Passes bytes on before it is known whether a foreign frame begins with them. Only bytes that may be a
 * response to us are held back from the listener. */
static void pass_early(fathom_line_t *line)
{
    if (!expects_response(line) && (line->quarantined_units == 0u)) pass(line, line->received_count);
}

void fathom_line_scan(fathom_line_t *line, bool is_over)
{
    while (line->received_count != 0u) {
        const uint8_t length = take_front(line, is_over);
        if (length == NEED_MORE) break;
        remove_bytes(line, length);
    }
    pass_early(line);
}
