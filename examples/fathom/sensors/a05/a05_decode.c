/* SPDX-License-Identifier: MIT */
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "sensors/a05/a05.h"
#include "sensors/dyp.h"

enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };

static const char name[] = "a05";
static const char source[] = "A05 3(3)";

enum { PROBES = FATHOM_DYP_PROBES, FIRST_PROBE = 0x0106, FIRST_ALIAS = 0x0010 };

static const char *const probe_names[PROBES] = {"probe 1", "probe 2", "probe 3", "probe 4"};

/* 0..3; PROBES: no probe is there */
static uint8_t probe_at(uint16_t address)
{
    if (address >= FIRST_PROBE && address < FIRST_PROBE + PROBES) return (uint8_t)(address - FIRST_PROBE);
    if (address >= FIRST_ALIAS && address < FIRST_ALIAS + PROBES) return (uint8_t)(address - FIRST_ALIAS);
    return PROBES;
}

static void guess(decode_frame_t *frame)
{
    const uint8_t count = (uint8_t)(frame->bytes[DECODE_AT_SIZE] / 2);
    const uint8_t *const values = frame->bytes + DECODE_AT_SIZE + 1;
    bool is_good = count <= PROBES;
    for (uint8_t i = 0; i != count && is_good && !frame->is_sure; i++)
        is_good = dyp_is_likely(decode_get16(values + 2 * i), FATHOM_A05_MAX_MM);
    if (count == 1 && decode_get16(values) <= DYP_MAX_ADDRESS)
        dyp_decode_address(decode_mean(frame, name, source, "if 0x0200 was read: slave address"),
                           decode_get16(values));
    if (!is_good) return;
    decode_meaning_t *const meaning =
        decode_mean(frame, name, source,
                    count == 1 ? "if a probe was read (0x0106..0x0109, 0x0010..0x0013)"
                               : "if %u probes were read (from 0x0106..0x0109 or 0x0010..0x0013)",
                    count);
    static const char *const names[PROBES] = {"first", "second", "third", "fourth"};
    for (uint8_t i = 0; i != count; i++)
        dyp_decode_distance(meaning, count == 1 ? "distance" : names[i], decode_get16(values + 2 * i));
}

static void explain_probes(decode_frame_t *frame, uint8_t first, const uint8_t *request)
{
    const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    if (count == 0 || count > PROBES - first) {
        (void)decode_mean(frame, name, source, "0x%04X is %s, and a read may not go past the last one",
                          address, probe_names[first]);
        return;
    }
    decode_meaning_t *const meaning =
        count == 1 ? decode_mean(frame, name, source, "0x%04X distance of %s", address, probe_names[first])
                   : decode_mean(frame, name, source, "0x%04X distances of probes %u to %u", address,
                                 first + 1u, first + (unsigned)count);
    if (!dyp_is_read_response(frame)) return;
    for (uint8_t i = 0; i != count; i++)
        dyp_decode_distance(meaning, probe_names[first + i],
                            decode_get16(frame->bytes + DECODE_AT_SIZE + 1 + 2 * i));
}

void a05_decode(decode_frame_t *frame, const uint8_t *request)
{
    const uint8_t function = frame->bytes[DECODE_AT_FUNCTION];
    if (request == NULL) guess(frame);
    if (request == NULL || (function != READ && function != WRITE)) return;
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const uint8_t probe = probe_at(address);
    if (address == DYP_ADDRESS) {
        decode_meaning_t *const meaning =
            decode_mean(frame, name, source, "%s0x0200 slave address", function == WRITE ? "set " : "");
        if (function == WRITE) dyp_decode_address(meaning, decode_get16(frame->bytes + DECODE_AT_VALUE));
        if (dyp_is_read_response(frame))
            dyp_decode_address(meaning, decode_get16(frame->bytes + DECODE_AT_SIZE + 1));
    } else if (probe != PROBES && function == READ) {
        explain_probes(frame, probe, request);
    }
}

/* ---- frames with a sum ---- */

/* What it sends by itself. */
static void decode_stream(decode_frame_t *frame)
{
    uint16_t values[PROBES];
    fathom_dyp_stream_decode(frame->bytes, values, PROBES);
    decode_meaning_t *const meaning = decode_mean(frame, name, "A05 1(2)", "automatic output");
    for (uint8_t i = 0; i != PROBES; i++) dyp_decode_distance(meaning, probe_names[i], values[i]);
}

static void decode_set_address(decode_frame_t *frame)
{
    decode_meaning_t *const meaning = decode_mean(frame, name, "A05 2(3)5", "set the address");
    decode_field_t *const field = decode_number(meaning, "new address", frame->unit, "");
    if (frame->unit == 0 || frame->unit == FATHOM_DYP_ANY_ADDRESS) field->note = "not from 1 to 254";
    frame->unit = -1; /* every unit that hears it */
    decode_note(frame, "it has no old address in it: every a05 on the line obeys");
}

static void decode_dyp(decode_frame_t *frame)
{
    const uint8_t command = frame->bytes[3];
    const bool is_response = frame->piece->direction == DECODE_RESPONSE;
    uint16_t values[PROBES];
    frame->unit = frame->bytes[2];
    frame->code = command;
    frame->code_is = "command";
    if (frame->unit == FATHOM_DYP_ANY_ADDRESS && command != FATHOM_DYP_SET_ADDRESS)
        decode_note(frame, "FF is the broadcast address; whether a unit answers it is not in the datasheet");
    const uint8_t count = fathom_dyp_55aa_value_count(command);
    if (command == FATHOM_DYP_SET_ADDRESS) {
        decode_set_address(frame);
    } else if (count == 0) {
        (void)decode_mean(frame, name, "A05 2(3)2", "no command of it");
    } else if (!is_response) {
        if (count == 1)
            (void)decode_mean(frame, name, "A05 2(3)4", "measure with %s",
                              probe_names[command - FATHOM_DYP_FIRST_PROBE]);
        else
            (void)decode_mean(frame, name, "A05 2(3)3", "measure with all probes");
    } else {
        fathom_dyp_55aa_decode(frame->bytes, values);
        decode_meaning_t *const meaning =
            count == 1 ? decode_mean(frame, name, "A05 2(3)4", "one probe has measured")
                       : decode_mean(frame, name, "A05 2(3)3", "all probes have measured");
        const uint8_t first = count == 1 ? (uint8_t)(command - FATHOM_DYP_FIRST_PROBE) : 0;
        for (uint8_t i = 0; i != count; i++) dyp_decode_distance(meaning, probe_names[first + i], values[i]);
    }
}

void a05_decode_sum(decode_frame_t *frame)
{
    if (frame->piece->protocol == DECODE_DYP)
        decode_dyp(frame);
    else
        decode_stream(frame);
}
