/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "sensors/a16/a16.h"
#include "sensors/dyp.h"

enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };

static const char name[] = "a16";
static const char source[] = "A16 6(3)";

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

static const register_t registers[] = {
    {0x0100, true, false, DISTANCE, "processed distance", "distance", {NULL, NULL}},
    {0x0101, true, false, DISTANCE, "real-time distance", "distance", {NULL, NULL}},
    {DYP_ADDRESS, true, true, UNIT_ADDRESS, "slave address", "address", {NULL, NULL}},
    {0x0202, false, true, CHOICE, "operating mode", "mode", {"controlled", "automatic"}},
    {0x0205, true, true, CHOICE, "switch output polarity", "polarity", {"negative", "positive"}},
    {0x0206, true, true, DISTANCE, "switch threshold", "threshold", {NULL, NULL}},
    {0x0207, true, true, CHOICE, "data type of the automatic output", "output", {"processed", "real-time"}},
};
enum { REGISTERS = sizeof registers / sizeof registers[0] };

static bool can_hold(const register_t *entry, uint16_t value)
{
    if (entry->kind == CHOICE) return value <= 1;
    return entry->kind == DISTANCE ? dyp_is_likely(value, FATHOM_A16_MAX_MM) : value <= DYP_MAX_ADDRESS;
}

static void put_value(decode_meaning_t *meaning, const register_t *entry, uint16_t value)
{
    if (entry->kind == DISTANCE && !entry->is_writable) {
        dyp_decode_distance(meaning, entry->field, value);
        return;
    }
    if (entry->kind == CHOICE && value <= 1) {
        decode_string(meaning, entry->field, "%s", entry->choices[value]);
        return;
    }
    decode_field_t *const field =
        decode_number(meaning, entry->field, value, entry->kind == DISTANCE ? "mm" : "");
    if (entry->kind == CHOICE) field->note = "not 0 or 1";
    if (entry->kind == UNIT_ADDRESS && value > DYP_MAX_ADDRESS) field->note = "not from 0 to 254";
}

/* Where it was read is not known: everything that it can be. */
static void guess(decode_frame_t *frame)
{
    const uint16_t value = decode_get16(frame->bytes + DECODE_AT_SIZE + 1);
    if (frame->bytes[DECODE_AT_SIZE] != 2) return; /* one register a read */
    for (size_t i = 0; i != REGISTERS; i++) {
        const register_t *const entry = &registers[i];
        if (!entry->is_readable || (!frame->is_sure && !can_hold(entry, value))) continue;
        put_value(decode_mean(frame, name, source, "if 0x%04X was read: %s", entry->address, entry->name),
                  entry, value);
    }
}

static void explain(decode_frame_t *frame, const register_t *entry, const uint8_t *request)
{
    const bool is_write = frame->bytes[DECODE_AT_FUNCTION] == WRITE;
    if (!is_write) {
        decode_meaning_t *const meaning =
            decode_mean(frame, name, source, "0x%04X %s", entry->address, entry->name);
        const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
        if (!entry->is_readable) decode_note(frame, "a16: 0x%04X can be written only", entry->address);
        if (count != 1) decode_note(frame, "a16: a read of several registers is not in its datasheet");
        if (dyp_is_read_response(frame))
            put_value(meaning, entry, decode_get16(frame->bytes + DECODE_AT_SIZE + 1));
        return;
    }
    if (!entry->is_writable) {
        (void)decode_mean(frame, name, source, "0x%04X %s, which can be read only", entry->address,
                          entry->name);
        return;
    }
    put_value(decode_mean(frame, name, source, "set 0x%04X %s", entry->address, entry->name), entry,
              decode_get16(frame->bytes + DECODE_AT_VALUE));
}

void a16_decode(decode_frame_t *frame, const uint8_t *request)
{
    const uint8_t function = frame->bytes[DECODE_AT_FUNCTION];
    if (request == NULL) guess(frame);
    if (request == NULL || (function != READ && function != WRITE)) return;
    for (size_t i = 0; i != REGISTERS; i++)
        if (registers[i].address == decode_get16(request + DECODE_AT_FIRST))
            explain(frame, &registers[i], request);
}

/* Frames that it sends by itself, or when it is triggered. */
void a16_decode_sum(decode_frame_t *frame)
{
    uint16_t value = 0;
    fathom_dyp_stream_decode(frame->bytes, &value, 1);
    dyp_decode_distance(decode_mean(frame, name, "A16 2(3), 3(4), 5(3)", "automatic or controlled output"),
                        "distance", value);
}
