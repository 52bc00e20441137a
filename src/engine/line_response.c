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
 * Handles the first `length` bytes in the buffer, which belong to no transaction.
 *
 * If the time-out has passed, the attempt ends here: bytes that begin now are another device's frame or noise, which
 * could otherwise keep the attempt alive without end.
 */
static void discard(fathom_line_t *line, uint8_t length)
{
    pass(line, length);
    if (!expects_response(line)) {
        fathom_line_note_sender(line, SENDER_BYTES, length);
        return;
    }
    /* A complete frame hides no echo; single bytes may. */
    if ((length == 1u) && (line->attempt.copy == COPY_DUE)) line->attempt.copy = COPY_HIDDEN;
    if (is_overtime(line)) fathom_line_end_attempt(line);
}

/* ---- Echo ---- */

/*
 * Many RS-485 adapters receive what they send. The echo arrives before the response and ends before it.
 *
 *     read    sent [request]
 *             wire [request][response]      differ: the first is the echo, the second is the response
 *
 *     write   sent [request]
 *             wire [request]                is this the echo, or the response of a unit without an echo?
 *             wire [request][request]       the echo and the response
 *
 *  - While echo is unknown, received bytes that equal the request are accepted as the echo, once per attempt
 *    (COPY_PAST). A write whose only received bytes equal its request therefore ends with FATHOM_ERR_ECHO.
 *  - If it is known that there is no echo, `copy` is COPY_PAST from the start, and the copy is the response.
 *  - The line learns ECHO_ON from an echo that cannot be a response: the bytes of the request form no response frame.
 *  - The line learns ECHO_OFF from a response without an echo before it. Noise before it proves nothing, because a
 *    damaged echo looks like noise (COPY_HIDDEN).
 *  - The bytes of a request can also begin with a shorter response frame, so a response of the request's length, or one
 *    byte less, can be the echo. A response of any other length cannot.
 *  - Once the time-out has passed, a second copy is discarded. Otherwise endless copies would keep the attempt alive.
 */
static bool can_be_echo(const fathom_line_t *line, uint8_t response_length)
{
    if (!expects_response(line)) return false;
    if (response_length == 0u) return true;
    return (line->attempt.copy != COPY_PAST) && ((response_length == line->attempt.request_length) ||
                                                 ((response_length + 1) == line->attempt.request_length));
}

/*
 * Returns true if the received bytes are the echo, or the beginning of it. `response_length` is the length of the
 * complete response frame with a right checksum at the beginning of the buffer, or 0.
 */
static bool is_echo(const fathom_line_t *line, uint8_t response_length)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->parts->frame;
    const uint8_t request_length = line->attempt.request_length;
    if (!can_be_echo(line, response_length)) return false;
    if (!protocol->is_request(line->head, frame, line->received_count)) return false;
    return (line->received_count < request_length) || (protocol->check(frame, request_length) == 0u);
}

static void learn_echo(fathom_line_t *line, uint8_t echo)
{
    if (line->parts->find_echo != NULL) line->parts->find_echo(line, echo);
}

/* ---- Received frames ---- */

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
        fathom_line_add(line, (status == FATHOM_OK) ? FATHOM_LINE_RESPONSES : FATHOM_LINE_EXCEPTIONS, 1);
        fathom_line_note_sender(line, SENDER_RESPONSE, 0);
        if (line->sender != SENDER_NONE) fathom_line_add(line, FATHOM_LINE_MAYBE_UNSOLICITED, 1);
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
    const bool is_late = is_quarantined(line, address) && !is_echo_due(line) && !is_claimed;
    if (is_echo_due(line)) line->attempt.copy = COPY_PAST;
    fathom_line_add(line, is_late ? FATHOM_LINE_LATE_RESPONSES : FATHOM_LINE_STRAYS, 1);
    if (!is_late) {
        if (!is_claimed) note_unrequested(line);
        return false;
    }
    line->quarantined_units &= (uint16_t)~units_of(address);
    return serve(line, address);
}

static bool accept_frame(fathom_line_t *line)
{
    const uint8_t address = line->parts->frame[line->protocol->address_offset];
    return expects_unit(line, address) ? accept_response(line, address) : accept_late_response(line, address);
}

/* ---- Scanning ---- */

/* What to do with the bytes at the beginning of the frame buffer. */
enum action { NEED_MORE, DISCARD, FOREIGN_FRAME, ACCEPT };

typedef struct {
    uint8_t action; /* enum action */
    uint8_t length; /* All but NEED_MORE: the number of bytes that leave the buffer, 1 to received_count */
} scan_result_t;

static scan_result_t result(uint8_t action, uint8_t length)
{
    scan_result_t scanned;
    scanned.action = action;
    scanned.length = length;
    return scanned;
}

/* Less than three bytes are noise: they show no broken response. */
enum { MIN_TRUNCATED = 3 };

/* Returns true if the bytes at the front are a response of the unit that is damaged or broke off. */
static bool is_damaged_response(const fathom_line_t *line, uint8_t frame_length)
{
    return (frame_length != 0u) && (line->received_count >= MIN_TRUNCATED) &&
           expects_unit(line, line->parts->frame[line->protocol->address_offset]);
}

/* Skips one byte, since no valid frame begins at the front of the buffer. */
static scan_result_t skip_byte(fathom_line_t *line, uint8_t frame_length, bool is_complete)
{
    if (is_damaged_response(line, frame_length)) {
        /* While the request still leaves, noise is more likely than a response. */
        const bool is_corrupt = is_complete && (line->phase != FATHOM_LINE_SENDING);
        note_fault(line, is_corrupt ? FAULT_CORRUPT : FAULT_TRUNCATED);
    }
    return result(DISCARD, 1);
}

static scan_result_t take_echo(fathom_line_t *line, bool is_response)
{
    if (!is_response) learn_echo(line, FATHOM_LINE_ECHO_ON);
    if ((line->attempt.copy == COPY_PAST) && is_overtime(line))
        return result(DISCARD, line->attempt.request_length);
    line->attempt.copy = COPY_PAST;
    fathom_line_note_sender(line, SENDER_ECHO, 0);
    return result(ACCEPT, line->attempt.request_length);
}

/* Decides about the bytes at the beginning of the buffer. If `is_over` is true, no byte will complete a frame there. */
static scan_result_t examine(fathom_line_t *line, bool is_over)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->parts->frame;
    const uint8_t received_count = line->received_count;
    const fathom_line_masters_t *const masters = line->parts->masters;
    /* Without a protocol nothing was ever submitted. */
    if ((protocol == NULL) && (masters == NULL)) return result(DISCARD, received_count);

    const uint8_t length = (protocol != NULL) ? protocol->length(frame, received_count) : 0u;
    const bool is_complete = (length != 0u) && (length <= received_count);
    const bool is_frame = is_complete && (protocol->check(frame, length) == 0u);
    uint8_t request_length = 0;
    if (masters != NULL) request_length = masters->find_request(line, is_frame);
    if ((request_length != 0u) && (request_length <= received_count)) return result(DISCARD, request_length);
    const bool can_complete = (length > received_count) && (length <= line->parts->frame_size);
    if (can_complete && !is_over) return result(NEED_MORE, 0);

    if (is_echo(line, is_frame ? length : 0u)) {
        if (line->attempt.request_length <= received_count) return take_echo(line, is_frame);
        if (!is_over) return result(NEED_MORE, 0);
    }
    if (is_frame) {
        if (line->wait == WAIT_NOISE) line->wait = WAIT_FRAMES;
        return result(accept_frame(line) ? ACCEPT : FOREIGN_FRAME, length);
    }
    if ((request_length != 0u) && !is_over) return result(NEED_MORE, 0);
    return skip_byte(line, length, is_complete);
}

static void remove_bytes(fathom_line_t *line, uint8_t length)
{
    uint8_t *const frame = line->parts->frame;
    line->received_count = (uint8_t)(line->received_count - length);
    line->passed_count = (uint8_t)rest_us(line->passed_count, length);
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
        const scan_result_t front = examine(line, is_over);
        if (front.action == NEED_MORE) break;
        if (front.action == ACCEPT) {
            line->is_after_gap = true; /* The listener's next frame cannot continue across a response. */
        } else {
            discard(line, front.length);
        }
        remove_bytes(line, front.length);
        if ((front.action == FOREIGN_FRAME) && (line->received_count == 0u) && !is_over)
            fathom_line_note_sender(line, SENDER_FRAME, 0);
    }
    pass_early(line);
}
