/* SPDX-License-Identifier: MIT */
#include "wire_units.h"

#include <assert.h>
#include <string.h>

enum {
    READ = 0x03,
    READ_INPUT = 0x04,
    WRITE = 0x06,
    WRITE_MANY = 0x10,
    VERSION = 0x01,
    POWER_ON_MODE = 0x12
};

static uint8_t index_of(const wire_unit_t *unit) { return (uint8_t)(unit - wire.units); }

static uint16_t word_at(const uint8_t *bytes) { return (uint16_t)(bytes[0] << 8 | bytes[1]); }

static void put_word(uint8_t *bytes, uint16_t value)
{
    bytes[0] = (uint8_t)(value >> 8);
    bytes[1] = (uint8_t)value;
}

/* A distance that no unit has sent lately. A low byte FF would be valid in two alignments of a stream (stream.h). */
static uint16_t issue(const wire_unit_t *unit, uint16_t reg, uint8_t asker)
{
    while (((WIRE_FIRST_MM + wire.issued % WIRE_ISSUES) & 0xFF) == 0xFF) wire.issued++;
    const uint32_t which = wire.issued++ % WIRE_ISSUES;
    wire.issues[which] = (wire_issue_t){wire.now_us, reg, index_of(unit), asker};
    return (uint16_t)(WIRE_FIRST_MM + which);
}

static void send(wire_unit_t *unit, const uint8_t *frame, size_t length)
{
    if (unit->cuts >= length) return;
    length -= unit->cuts;
    wire_send((uint8_t)(WIRE_FIRST_UNIT + index_of(unit)), wire.now_us, frame, length)->is_cut =
        unit->cuts != 0;
    unit->sends_until_us = wire.now_us + length * wire.byte_us;
}

/* ---- HPS-167S ---- */

/* #5: distance, magnitude, exponent, ambient, precision, as in the datasheet's example. */
static uint8_t measurement(const wire_unit_t *unit, uint8_t *frame, uint8_t asker)
{
    const uint8_t example[] = {unit->address, READ, 8, 0, 0, 0xDC, 0xB2, 7, 1, 0, 0};
    memcpy(frame, example, sizeof example);
    put_word(frame + 3, issue(unit, WIRE_MEASUREMENT, asker));
    return wire_seal(frame, sizeof example);
}

/* #1, #2, #5 and #10; silence to all others. Returns 0 if there is no response. */
static uint8_t hps_response(wire_unit_t *unit, uint8_t *frame)
{
    static const uint8_t version[] = {0x14, 0x09, 0x1B, 0x02, 0x01, 0x00};
    const uint8_t *const request = unit->request;
    const uint16_t reg = word_at(request + 2), count = word_at(request + 4);
    frame[0] = unit->address;
    frame[1] = request[1];
    if (request[1] == WRITE && reg == POWER_ON_MODE) {
        unit->measures_after_power_on = count;
        unit->writes++;
        memcpy(frame, request, 6);
        return wire_seal(frame, 6);
    }
    if (request[1] != READ) return 0;
    if (reg == VERSION && count == 3) {
        frame[2] = sizeof version;
        memcpy(frame + 3, version, sizeof version);
        return wire_seal(frame, 3 + sizeof version);
    }
    if (reg == WIRE_CONFIGURATION &&
        count == 4) { /* termination, #10, warm-up 5 s, reconnect time 180 ms, baud code 1 */
        const uint8_t data[] = {8, 0xFF, (uint8_t)unit->measures_after_power_on, 5, 0, 0, 0, 0xB4, 1};
        memcpy(frame + 2, data, sizeof data);
        return wire_seal(frame, 2 + sizeof data);
    }
    return (reg == WIRE_MEASUREMENT && count == 4) ? measurement(unit, frame, unit->asker) : 0;
}

/* ---- A16 and A05 ---- */

static uint8_t dyp_response(wire_unit_t *unit, uint8_t *frame)
{
    const uint8_t *const request = unit->request;
    const uint16_t reg = word_at(request + 2), count = word_at(request + 4);
    frame[0] = unit->address;
    frame[1] = request[1];
    if (request[1] == WRITE || request[1] == WRITE_MANY) {
        unit->writes++;
        memcpy(frame, request, 6);
        return wire_seal(frame, 6);
    }
    if ((request[1] != READ && request[1] != READ_INPUT) || count == 0 || count > 8) return 0;
    frame[2] = (uint8_t)(2 * count);
    for (uint8_t i = 0; i != count; i++)
        put_word(frame + 3 + 2 * i, issue(unit, (uint16_t)(reg + i), unit->asker));
    return wire_seal(frame, 3 + 2u * count);
}

static uint8_t add_sum(uint8_t *frame, size_t length)
{
    uint8_t sum = 0;
    for (size_t i = 0; i != length; i++) sum = (uint8_t)(sum + frame[i]);
    frame[length] = sum;
    return (uint8_t)(length + 1);
}

/* 01: all probes, the registers 0x0106 to 0x0109. 10 to 13: one of them. */
static uint8_t dyp_55aa_response(wire_unit_t *unit, uint8_t *frame)
{
    const uint8_t command = unit->request[3];
    const uint8_t count = command == 0x01 ? 4 : 1;
    if (command == 0x03) unit->writes++;
    memcpy(frame, unit->request, 4);
    if (command == 0x03) return add_sum(frame, 4);
    if (command != 0x01 && (command < 0x10 || command > 0x13)) return 0;
    const uint16_t first = command == 0x01 ? 0x0106 : (uint16_t)(0x0106 + command - 0x10);
    for (uint8_t i = 0; i != count; i++)
        put_word(frame + 4 + 2 * i, issue(unit, (uint16_t)(first + i), unit->asker));
    return add_sum(frame, 4 + 2u * count);
}

/* Probes 1 to `count`. */
static uint8_t stream_frame(const wire_unit_t *unit, uint8_t *frame, uint8_t count, uint8_t asker)
{
    frame[0] = 0xFF;
    for (uint8_t i = 0; i != count; i++)
        put_word(frame + 1 + 2 * i, issue(unit, (uint16_t)(0x0106 + i), asker));
    return add_sum(frame, 1 + 2u * count);
}

/* ---- All units ---- */

static bool is_for(const wire_unit_t *unit, const wire_frame_t *frame)
{
    uint8_t copy[WIRE_FRAME];
    if (frame->source != WIRE_HOST && frame->source != WIRE_MASTER) return false;
    memcpy(copy, frame->bytes, frame->length);
    switch (unit->kind) {
    case WIRE_HPS167S:
    case WIRE_DYP_MODBUS:
        if (frame->length < 8 || copy[0] != unit->address) return false;
        (void)wire_seal(copy, frame->length - 2u);
        return memcmp(copy, frame->bytes, frame->length) == 0;
    case WIRE_DYP_55AA:
        if (frame->length != 5 || copy[0] != 0x55 || copy[1] != 0xAA) return false;
        (void)add_sum(copy, 4);
        return copy[4] == frame->bytes[4] && (copy[2] == unit->address || copy[2] == 0xFF || copy[3] == 0x03);
    default:
        return false;
    }
}

static bool can_hear(const wire_unit_t *unit, const wire_frame_t *frame)
{
    if (frame->is_hit || unit->is_dead) return false;
    if (unit->sends_until_us != 0 && frame->start_us < unit->sends_until_us + unit->deaf_us) return false;
    return frame->quiet_us >= unit->silence_us;
}

static void serve(wire_unit_t *unit, const wire_frame_t *frame)
{
    memcpy(unit->request, frame->bytes, frame->length);
    unit->asker = frame->source;
    unit->response_us = wire.now_us + unit->answer_us + wire_random((uint32_t)unit->spread_us);
    if (unit->measure_us != 0 && unit->kind == WIRE_HPS167S && word_at(frame->bytes + 2) == WIRE_MEASUREMENT)
        unit->response_us = wire.now_us + unit->measure_us;
    if (wire_one_in(unit->late_one_in)) unit->response_us += unit->late_us;
}

void wire_unit_hears(wire_unit_t *unit, const wire_frame_t *frame)
{
    if (!is_for(unit, frame) || !can_hear(unit, frame)) return;
    if (wire_one_in(unit->lost_one_in)) return;
    if (unit->response_us != WIRE_NEVER && unit->when_busy == WIRE_IGNORES) return;
    if (unit->response_us != WIRE_NEVER && unit->when_busy == WIRE_QUEUES)
        unit->queued = *frame;
    else
        serve(unit, frame);
}

static uint8_t response(wire_unit_t *unit, uint8_t *frame)
{
    switch (unit->kind) {
    case WIRE_HPS167S:
        return hps_response(unit, frame);
    case WIRE_DYP_MODBUS:
        return dyp_response(unit, frame);
    case WIRE_DYP_55AA:
        return dyp_55aa_response(unit, frame);
    default:
        return stream_frame(unit, frame, 1, unit->asker);
    }
}

static void respond(wire_unit_t *unit)
{
    uint8_t frame[WIRE_FRAME];
    if (wire.now_us < unit->sends_until_us) { /* the response follows what the unit sends by itself */
        unit->response_us = unit->sends_until_us + 2 * wire.byte_us;
        return;
    }
    unit->response_us = WIRE_NEVER;
    const uint8_t length = response(unit, frame);
    if (unit->queued.length != 0) {
        serve(unit, &unit->queued);
        unit->queued.length = 0;
        unit->response_us += length * wire.byte_us;
    }
    if (length == 0) return;
    send(unit, frame, length);
    unit->responses++;
    /* The next frame that the unit sends by itself keeps 3.5 characters of silence. */
    const wire_us_t rest_us = unit->sends_until_us + 4 * wire.byte_us;
    if (unit->next_frame_us == WIRE_NEVER || unit->next_frame_us >= rest_us) return;
    if (unit->keeps_schedule) unit->delay_us += rest_us - unit->next_frame_us;
    unit->next_frame_us = rest_us;
}

static void send_unsolicited(wire_unit_t *unit)
{
    uint8_t frame[WIRE_FRAME];
    uint8_t length;
    unit->next_frame_us += unit->period_us - unit->delay_us % unit->period_us;
    unit->delay_us = 0;
    if (wire.now_us < unit->sends_until_us) return;
    if (unit->kind == WIRE_HPS167S)
        length = measurement(unit, frame, WIRE_UNSOLICITED);
    else
        length = stream_frame(unit, frame, unit->kind == WIRE_A05_STREAM ? 4 : 1, WIRE_UNSOLICITED);
    send(unit, frame, length);
    unit->unsolicited++;
}

void wire_unit_acts(wire_unit_t *unit)
{
    if (unit->response_us <= unit->next_frame_us)
        respond(unit);
    else
        send_unsolicited(unit);
}

void wire_edge(void)
{
    for (uint8_t i = 0; i != wire.unit_count; i++) {
        wire_unit_t *const unit = &wire.units[i];
        if (unit->kind != WIRE_A16_STREAM || unit->period_us != 0 || unit->is_dead) continue;
        if (unit->response_us != WIRE_NEVER || wire_one_in(unit->lost_one_in)) continue;
        unit->asker = WIRE_HOST;
        unit->response_us = wire.now_us + unit->answer_us + wire_random((uint32_t)unit->spread_us);
        if (wire_one_in(unit->late_one_in)) unit->response_us += unit->late_us;
    }
}

wire_unit_t *wire_add(const wire_unit_t *unit)
{
    assert(wire.unit_count != WIRE_UNITS);
    wire_unit_t *const added = &wire.units[wire.unit_count++];
    *added = *unit;
    if (added->address == 0) added->address = 1;
    added->response_us = WIRE_NEVER;
    added->next_frame_us = WIRE_NEVER;
    added->measures_after_power_on = 0xFF;
    if (added->period_us != 0) added->next_frame_us = wire.now_us + wire_random((uint32_t)added->period_us);
    return added;
}
