/* SPDX-License-Identifier: MIT */
#include "decode/decode_frame.h"

#include <stddef.h>

#include "fathom/modbus_rtu.h"

enum { FUNCTION = 1, SIZE = 2, FIRST = 2, COUNT = 4, VALUE = 4 };
enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };
enum { ADDRESS = 0x0200, MAX_ADDRESS = 0xFE };

static const char a16_source[] = "A16 6(3)";
static const char a05_source[] = "A05 3(3)";

/* Has the frame the values of registers in it, not where they are? */
static bool is_read_answer(const decode_frame_t *frame)
{
    return frame->piece->direction == DECODE_ANSWER && frame->bytes[FUNCTION] == READ;
}

/* Is a distance that a sensor of that range sends, or one of its family's words for no target? */
static bool is_likely(uint16_t value, uint16_t far_mm)
{
    return value <= far_mm || value == 0xFFFD || value == 0xFFFE;
}

/* ---- A16 ---- */

enum { A16_FAR_MM = 16350 }; /* the 94 ms of A16 1(3) */

typedef enum { DISTANCE, UNIT_ADDRESS, CHOICE } kind_t;

typedef struct {
    uint16_t address;
    bool is_readable;
    bool is_writable;
    kind_t kind;
    const char *name;
    const char *field;
    const char *choices[2]; /* what 0 and 1 mean */
} register_t;

static const register_t a16_registers[] = {
    {0x0100, true, false, DISTANCE, "processed distance", "distance", {NULL, NULL}},
    {0x0101, true, false, DISTANCE, "real-time distance", "distance", {NULL, NULL}},
    {ADDRESS, true, true, UNIT_ADDRESS, "slave address", "address", {NULL, NULL}},
    {0x0202, false, true, CHOICE, "operating mode", "mode", {"controlled", "automatic"}},
    {0x0205, true, true, CHOICE, "switch output polarity", "polarity", {"negative", "positive"}},
    {0x0206, true, true, DISTANCE, "switch threshold", "threshold", {NULL, NULL}},
    {0x0207, true, true, CHOICE, "data type of the automatic output", "output", {"processed", "real-time"}},
};
enum { A16_REGISTERS = sizeof a16_registers / sizeof a16_registers[0] };

static bool can_hold(const register_t *entry, uint16_t value)
{
    if (entry->kind == CHOICE) return value <= 1;
    return entry->kind == DISTANCE ? is_likely(value, A16_FAR_MM) : value <= MAX_ADDRESS;
}

static void put_value(decode_meaning_t *meaning, const register_t *entry, uint16_t value)
{
    if (entry->kind == DISTANCE && !entry->is_writable) {
        decode_ultrasonic(meaning, entry->field, value);
        return;
    }
    if (entry->kind == CHOICE && value <= 1) {
        decode_string(meaning, entry->field, "%s", entry->choices[value]);
        return;
    }
    decode_field_t *const field =
        decode_number(meaning, entry->field, value, entry->kind == DISTANCE ? "mm" : "");
    if (entry->kind == CHOICE) field->note = "not 0 or 1";
    if (entry->kind == UNIT_ADDRESS && value > MAX_ADDRESS) field->note = "not from 0 to 254";
}

/* Where it was read is not known: everything that it can be. */
static void a16_guess(decode_frame_t *frame)
{
    const uint16_t value = decode_get16(frame->bytes + SIZE + 1);
    if (frame->bytes[SIZE] != 2) return; /* one register a read */
    for (size_t i = 0; i != A16_REGISTERS; i++) {
        const register_t *const entry = &a16_registers[i];
        if (!entry->is_readable || (!frame->is_sure && !can_hold(entry, value))) continue;
        put_value(
            decode_mean(frame, "a16", a16_source, "if 0x%04X was read: %s", entry->address, entry->name),
            entry, value);
    }
}

static void a16_at(decode_frame_t *frame, const register_t *entry, const uint8_t *request)
{
    const bool is_write = frame->bytes[FUNCTION] == WRITE;
    if (!is_write) {
        decode_meaning_t *const meaning =
            decode_mean(frame, "a16", a16_source, "0x%04X %s", entry->address, entry->name);
        const uint16_t count = decode_get16(request + COUNT);
        if (!entry->is_readable) decode_note(frame, "a16: 0x%04X can be written only", entry->address);
        if (count != 1) decode_note(frame, "a16: a read of several registers is not in its datasheet");
        if (is_read_answer(frame)) put_value(meaning, entry, decode_get16(frame->bytes + SIZE + 1));
        return;
    }
    if (!entry->is_writable) {
        (void)decode_mean(frame, "a16", a16_source, "0x%04X %s, which can be read only", entry->address,
                          entry->name);
        return;
    }
    put_value(decode_mean(frame, "a16", a16_source, "set 0x%04X %s", entry->address, entry->name), entry,
              decode_get16(frame->bytes + VALUE));
}

void decode_a16(decode_frame_t *frame, const uint8_t *request)
{
    const uint8_t function = frame->bytes[FUNCTION];
    if (request == NULL) a16_guess(frame);
    if (request == NULL || (function != READ && function != WRITE)) return;
    for (size_t i = 0; i != A16_REGISTERS; i++)
        if (a16_registers[i].address == decode_get16(request + FIRST))
            a16_at(frame, &a16_registers[i], request);
}

/* ---- A05 ---- */

enum { A05_FAR_MM = 6000, PROBES = 4, FIRST_PROBE = 0x0106, FIRST_ALIAS = 0x0010 };

static const char *const probe_names[PROBES] = {"probe 1", "probe 2", "probe 3", "probe 4"};

/* 0..3; PROBES: no probe is there */
static uint8_t probe_at(uint16_t address)
{
    if (address >= FIRST_PROBE && address < FIRST_PROBE + PROBES) return (uint8_t)(address - FIRST_PROBE);
    if (address >= FIRST_ALIAS && address < FIRST_ALIAS + PROBES) return (uint8_t)(address - FIRST_ALIAS);
    return PROBES;
}

static void put_address(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "address", value, "");
    if (value > MAX_ADDRESS) field->note = "not from 0 to 254";
}

static void a05_guess(decode_frame_t *frame)
{
    const uint8_t count = (uint8_t)(frame->bytes[SIZE] / 2);
    const uint8_t *const values = frame->bytes + SIZE + 1;
    bool is_good = count <= PROBES;
    for (uint8_t i = 0; i != count && is_good && !frame->is_sure; i++)
        is_good = is_likely(decode_get16(values + 2 * i), A05_FAR_MM);
    if (count == 1 && decode_get16(values) <= MAX_ADDRESS)
        put_address(decode_mean(frame, "a05", a05_source, "if 0x0200 was read: slave address"),
                    decode_get16(values));
    if (!is_good) return;
    decode_meaning_t *const meaning =
        decode_mean(frame, "a05", a05_source,
                    count == 1 ? "if a probe was read (0x0106..0x0109, 0x0010..0x0013)"
                               : "if %u probes were read (from 0x0106..0x0109 or 0x0010..0x0013)",
                    count);
    static const char *const names[PROBES] = {"first", "second", "third", "fourth"};
    for (uint8_t i = 0; i != count; i++)
        decode_ultrasonic(meaning, count == 1 ? "distance" : names[i], decode_get16(values + 2 * i));
}

static void a05_probes(decode_frame_t *frame, uint8_t first, const uint8_t *request)
{
    const uint16_t count = decode_get16(request + COUNT);
    const uint16_t address = decode_get16(request + FIRST);
    if (count == 0 || count > PROBES - first) {
        (void)decode_mean(frame, "a05", a05_source, "0x%04X is %s, and a read may not go past the last one",
                          address, probe_names[first]);
        return;
    }
    decode_meaning_t *const meaning =
        count == 1
            ? decode_mean(frame, "a05", a05_source, "0x%04X distance of %s", address, probe_names[first])
            : decode_mean(frame, "a05", a05_source, "0x%04X distances of probes %u to %u", address,
                          first + 1u, first + (unsigned)count);
    if (!is_read_answer(frame)) return;
    for (uint8_t i = 0; i != count; i++)
        decode_ultrasonic(meaning, probe_names[first + i], decode_get16(frame->bytes + SIZE + 1 + 2 * i));
}

void decode_a05(decode_frame_t *frame, const uint8_t *request)
{
    const uint8_t function = frame->bytes[FUNCTION];
    if (request == NULL) a05_guess(frame);
    if (request == NULL || (function != READ && function != WRITE)) return;
    const uint16_t address = decode_get16(request + FIRST);
    const uint8_t probe = probe_at(address);
    if (address == ADDRESS) {
        decode_meaning_t *const meaning =
            decode_mean(frame, "a05", a05_source, "%s0x0200 slave address", function == WRITE ? "set " : "");
        if (function == WRITE) put_address(meaning, decode_get16(frame->bytes + VALUE));
        if (is_read_answer(frame)) put_address(meaning, decode_get16(frame->bytes + SIZE + 1));
    } else if (probe != PROBES && function == READ) {
        a05_probes(frame, probe, request);
    }
}
