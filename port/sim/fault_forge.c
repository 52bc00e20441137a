/* SPDX-License-Identifier: MIT */
/* Faults that make another frame whose CRC or sum is right. */
#include <string.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "internal/fault_parts.h"

/*
 * Other frames, whose CRC or sum is right. Where they are in a frame:
 *   Modbus   unit, function, ..., CRC (2); of a read: unit, 03, bytes, values, CRC
 *   55 AA    55, AA, address, command, values, sum
 *   stream   FF, values, sum
 */
enum { MODBUS_UNIT = 0, MODBUS_FUNCTION = 1, MODBUS_BYTES = 2, MODBUS_VALUES = 3, CRC = 2 };
enum { DYP_ADDRESS = 2, DYP_COMMAND = 3, DYP_VALUES = 4, STREAM_VALUES = 1, SUM = 1 };

static bool is_modbus(const fathom_sim_frame_t *frame) { return frame->protocol == FATHOM_SIM_MODBUS; }

/* Puts the CRC or sum behind `length` bytes and ends the frame there. */
static void finish(fathom_sim_frame_t *frame, uint8_t length)
{
    if (is_modbus(frame)) {
        const uint16_t crc = fathom_crc16(frame->bytes, length);
        frame->bytes[length] = (uint8_t)(crc & 0xFF);
        frame->bytes[length + 1] = (uint8_t)(crc >> 8);
        frame->length = (uint8_t)(length + CRC);
    } else {
        frame->bytes[length] = fathom_dyp_checksum(frame->bytes, length);
        frame->length = (uint8_t)(length + SUM);
    }
}

/* Bytes before the CRC or sum. */
static uint8_t body(const fathom_sim_frame_t *frame)
{
    return (uint8_t)(frame->length - (is_modbus(frame) ? CRC : SUM));
}

/* One of least..most that it is not now; when it is outside, any of them. */
static void change(fathom_sim_fault_rule_t *rule, uint8_t *byte, uint8_t least, uint8_t most)
{
    const uint8_t was = *byte;
    const bool inside = was >= least && was <= most;
    const uint32_t choices = (uint32_t)(most - least) + (inside ? 0 : 1);
    uint8_t other = (uint8_t)(least + fathom_sim_fault_below(rule, choices));
    if (inside && other >= was) other++;
    *byte = other;
}

/* A value less, or the first one twice where there is no other. */
static uint8_t recount(fathom_sim_frame_t *frame, uint8_t first)
{
    uint8_t length = body(frame);
    const uint8_t bytes = (uint8_t)(length - first);
    if (bytes > 2) return (uint8_t)(length - 2);
    if (bytes == 0) {
        frame->bytes[length++] = 0;
        return length;
    }
    memcpy(frame->bytes + length, frame->bytes + first, 2);
    return (uint8_t)(length + 2);
}

static uint8_t count(fathom_sim_frame_t *frame)
{
    if (!is_modbus(frame))
        return recount(frame, frame->protocol == FATHOM_SIM_DYP ? DYP_VALUES : STREAM_VALUES);
    if (frame->bytes[MODBUS_FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS)
        return recount(frame, body(frame)); /* an exception, an acknowledgement */
    const uint8_t length = recount(frame, MODBUS_VALUES);
    frame->bytes[MODBUS_BYTES] = (uint8_t)(length - MODBUS_VALUES);
    return length;
}

bool fathom_sim_fault_forge(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    uint8_t *const bytes = frame->bytes;
    uint8_t length = body(frame);
    switch (rule->kind) {
    case FATHOM_SIM_FAULT_UNIT:
        change(rule, &bytes[is_modbus(frame) ? MODBUS_UNIT : DYP_ADDRESS], 1, 254);
        break;
    case FATHOM_SIM_FAULT_FUNCTION:
        if (is_modbus(frame))
            change(rule, &bytes[MODBUS_FUNCTION], 1, 127);
        else
            change(rule, &bytes[DYP_COMMAND], 0, 255);
        break;
    case FATHOM_SIM_FAULT_COUNT:
        length = count(frame);
        break;
    case FATHOM_SIM_FAULT_EXCEPTION:
        bytes[MODBUS_FUNCTION] |= FATHOM_MODBUS_EXCEPTION;
        bytes[2] = rule->code != 0 ? rule->code : (uint8_t)(1 + fathom_sim_fault_below(rule, 255));
        length = 3;
        break;
    default:
        return false;
    }
    finish(frame, length);
    return true;
}

uint8_t fathom_sim_fault_unasked(const fathom_sim_fault_t *fault, const fathom_sim_frame_t *frame,
                                 uint8_t *bytes)
{
    fathom_sim_device_t *const device = fault->device;
    if (frame->protocol == FATHOM_SIM_STREAM) return device->model->automatic(device, bytes, frame->now_us);
    /* by the frame, not by the last request: perhaps there was none */
    uint8_t i = 0;
    while (device->protocols[i]->id != frame->protocol) i++;
    return device->protocols[i]->unasked(device, bytes, frame->now_us);
}
