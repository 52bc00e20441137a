/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/modbus_rtu.h"
#include "line_internal.h"

/*
 * The part of a line for other masters. Another master's request makes the unit respond, and that response may look
 * like the response to a request of ours.
 *
 *     wire     [foreign request]      [response to it]          [our request]
 *     line                     |<- sends nothing ->|<- silence ->|
 *
 *     wire     [our request]   [foreign request]   [a response to either]
 *     attempt               |<------------- timeout_us -------------->| FATHOM_ERR_OTHER_MASTER
 *
 *  - A foreign request is a whole, plausible request frame with a right checksum that is not an echo of ours.
 *  - While the response is due the line sends nothing, at most for the time-out of the first transaction in the queue,
 *    and at most for `busy_us`. The next frame of the unit ends this earlier, because it is the response.
 *  - It can be unclear which frame is the response: our request to the unit is on the wire; or the unit is in quarantine,
 *    so our response may come too; or it has not responded to the foreign request before; or a unit sends by itself. Then
 *    `awaited_unit` is FATHOM_LINE_ANY_UNIT, and only the time ends the wait.
 *  - A unit sends by itself if two frames in a row were requested by no master. One such frame may be the response to a
 *    request that was damaged on its way to us.
 *  - A write of one register (06) is acknowledged by its copy. It counts as a request only while our own, different
 *    request to the unit is on the wire. At other times it counts as nothing.
 *  - If the line had to drop bytes (line.c), a foreign request may have been among them.
 *  - A foreign request does not prolong the quarantine of a unit. Otherwise a master that polls without pause would
 *    keep us silent for ever. In the pauses of such a master our requests leave; if it has none, our wait for silence
 *    ends after `busy_us` (line_request.c).
 */

enum { UNREQUESTED_LIMIT = 2 };

/* ---- The forms of a request ---- */

/*
 * The part recognises Modbus RTU and `55 AA`, whatever the line itself sends, also before its first request. No request
 * of the one looks like one of the other: 170 (AA) is no function of Modbus.
 */
typedef struct {
    uint8_t length;         /* 0: no request begins here; above received_count: more bytes are needed. */
    uint8_t address_offset; /* Of the unit's address in the request. */
    bool is_sum_right;      /* False unless the request is complete. */
} form_t;

enum { DYP_START = 0x55, DYP_SECOND_START = 0xAA, DYP_ADDRESS = 2, DYP_COMMAND = 3 };
enum { READ_INPUT_REGISTERS = 4, LAST_UNIT = 247, SHORT_REQUEST = 8, WRITE_HEAD = 7, WRITE_OVERHEAD = 9 };

static bool is_read(uint8_t function)
{
    return (function == FATHOM_MODBUS_READ_HOLDING_REGISTERS) || (function == READ_INPUT_REGISTERS);
}

/*
 * Returns the length of a request to one unit; no unit responds to a broadcast. A read (03, 04) names 1 to 125 registers
 * and has 8 bytes, like a write of one register (06). A write of many (10) names 1 to 123 registers and carries twice
 * that number of bytes.
 */
static uint8_t modbus_length(const uint8_t *frame, uint8_t have)
{
    if ((frame[0] == FATHOM_MODBUS_BROADCAST) || (frame[0] > LAST_UNIT)) return 0;
    if (have < 2u) return 2;
    const uint8_t function = frame[1];
    if (function == FATHOM_MODBUS_WRITE_SINGLE_REGISTER) return SHORT_REQUEST;
    if (!is_read(function) && (function != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS)) return 0;
    if (have < WRITE_HEAD) return WRITE_HEAD;
    const uint16_t count = (uint16_t)((frame[4] * 256u) + frame[5]);
    if ((count == 0u) || (count > (is_read(function) ? FATHOM_MODBUS_MAX_READ : FATHOM_MODBUS_MAX_WRITE)))
        return 0;
    if (is_read(function)) return SHORT_REQUEST;
    return (frame[6] == (2u * count)) ? (uint8_t)(WRITE_OVERHEAD + frame[6]) : 0u;
}

/* Every command has a request of 5 bytes. A response can begin with the same five bytes; the line then waits for an
 * answer that has passed already, which costs time and no more. */
static uint8_t dyp_length(const uint8_t *frame, uint8_t have)
{
    if (have <= DYP_COMMAND) return DYP_COMMAND + 1;
    return (fathom_dyp_55aa_response_length(frame[DYP_COMMAND]) != 0u) ? (uint8_t)FATHOM_DYP_REQUEST_LENGTH
                                                                       : 0u;
}

static form_t form_of(const uint8_t *frame, uint8_t have)
{
    form_t form;
    const bool is_dyp = (frame[0] == DYP_START) && (have > 1u) && (frame[1] == DYP_SECOND_START);
    form.length = is_dyp ? dyp_length(frame, have) : modbus_length(frame, have);
    form.address_offset = is_dyp ? (uint8_t)DYP_ADDRESS : 0u;
    form.is_sum_right =
        (form.length != 0u) && (form.length <= have) &&
        (is_dyp ? fathom_dyp_55aa_is_valid(frame, form.length) : (fathom_crc16(frame, form.length) == 0u));
    return form;
}

/* ---- A foreign request ---- */

/* From now on the unit has to respond to another master. */
static void await(fathom_line_t *line, uint8_t address)
{
    line->awaited_unit = address;
    line->is_answered = false;
    line->awaited_left_us = busy_us(line);
    if (line->head != NULL) line->awaited_left_us = least_us(line->awaited_left_us, line->head->timeout_us);
}

static void note_foreign_request(fathom_line_t *line, uint8_t address)
{
    const bool is_outstanding = expects_unit(line, address);
    const bool is_second = (line->awaited_left_us != 0u) && !line->is_answered;
    const bool is_unclear = is_outstanding || is_second || fathom_line_is_quarantined(line, address) ||
                            (line->unrequested_count == UNREQUESTED_LIMIT);
    fathom_line_add(line, FATHOM_LINE_FOREIGN_REQUESTS, 1);
    if (is_outstanding) note_fault(line, FAULT_CLAIMED);
    await(line, is_unclear ? (uint8_t)FATHOM_LINE_ANY_UNIT : address);
    line->unrequested_count = 0;
    if (line->wait == WAIT_NOISE) line->wait = WAIT_FRAMES;
}

/* Returns true if a frame with a right checksum that has the form of a request, and perhaps of a response, is ours:
 * the echo of the request on the wire or of a cancelled one, a response to us, or the response to another master. */
static bool is_ours(fathom_line_t *line, uint8_t address, bool is_response)
{
    const uint8_t *const frame = line->parts->frame;
    if (expects_response(line) && line->protocol->is_request(line->head, frame, line->attempt.request_length))
        return true;
    if (is_response) return !expects_unit(line, address); /* The copy of a write of one register. */
    if (!is_echo_due(line) || !fathom_line_is_quarantined(line, address)) return false;
    line->attempt.copy = COPY_PAST;
    return true;
}

static uint8_t find_request(fathom_line_t *line, bool is_response)
{
    const uint8_t *const frame = line->parts->frame;
    const uint8_t received_count = line->received_count;
    const form_t form = form_of(frame, received_count);
    if (form.length >
        line->parts->frame_size) { /* A write of many registers that is longer than the buffer. */
        note_foreign_request(line, frame[form.address_offset]);
        return received_count;
    }
    if (form.length > received_count) return form.length;
    if (!form.is_sum_right || is_ours(line, frame[form.address_offset], is_response)) return 0;
    note_foreign_request(line, frame[form.address_offset]);
    return form.length;
}

static void note_lost_bytes(fathom_line_t *line)
{
    if (expects_response(line)) note_fault(line, FAULT_LOST);
    await(line, FATHOM_LINE_ANY_UNIT);
}

/* The acknowledgement of a write of one register equals the request, so it proves nothing: it neither ends the
 * quarantine of the unit nor is it the response that another master waits for. */
static bool is_ambiguous(const fathom_line_t *line)
{
    return form_of(line->parts->frame, line->received_count).is_sum_right;
}

static void note_unrequested(fathom_line_t *line)
{
    if (line->unrequested_count != UNREQUESTED_LIMIT) line->unrequested_count++;
}

static bool take_answer(fathom_line_t *line, uint8_t address)
{
    if (is_ambiguous(line)) return true;
    if (line->awaited_left_us == 0u) return false;
    if (line->awaited_unit == FATHOM_LINE_ANY_UNIT) {
        if (line->is_answered) note_unrequested(line);
        line->is_answered = true;
        return true;
    }
    if (line->awaited_unit != address) return false;
    line->awaited_left_us = 0;
    return true;
}

const fathom_line_masters_t fathom_line_masters = {find_request, note_lost_bytes, take_answer,
                                                   note_unrequested};
