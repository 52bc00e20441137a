/* SPDX-License-Identifier: MIT */
#include "decode_frame.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>

#include "fathom/modbus_rtu.h"

enum { FUNCTION = 1, SIZE = 2, FIRST = 2, COUNT = 4, VALUE = 4, MANY_VALUES = 7 };
enum {
    READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS,
    WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER,
    WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS
};

static uint32_t get32(const uint8_t *at) { return (uint32_t)decode_get16(at) << 16 | decode_get16(at + 2); }

/* Of a measurement (#5). */
enum { MAX_EXPONENT = 16, MIN_MM = 80, MAX_MM = 30000, OVER_RANGE = 65530, ALL_ONES = 0xFFFF };

static int32_t signed16(uint16_t value) { return value < 0x8000 ? value : (int32_t)value - 0x10000; }

/* ---- what the answers carry ---- */

static bool is_date(const uint8_t *at) { return at[1] != 0 && at[1] <= 12 && at[2] != 0 && at[2] <= 31; }

static void put_date(decode_meaning_t *meaning, const uint8_t *at)
{
    decode_field_t *const field =
        decode_string(meaning, "date", "%04u-%02u-%02u", 2000u + at[0], (unsigned)at[1], (unsigned)at[2]);
    if (!is_date(at)) field->note = "no date";
}

static void put_version(decode_meaning_t *meaning, const uint8_t *values)
{
    put_date(meaning, values);
    decode_string(meaning, "version", "%u.%u.%u", values[3], values[4], values[5]);
}

static const char *baud_name(uint16_t code)
{
    static const char *const names[] = {[1] = "19200", [2] = "57600", [3] = "115200", [4] = "230400"};
    return code != 0 && code < sizeof names / sizeof names[0] ? names[code] : NULL;
}

static void put_baud(decode_meaning_t *meaning, uint16_t code)
{
    decode_number(meaning, "baud code", code, "")->note = baud_name(code) != NULL ? NULL : "no code of #9";
    decode_string(meaning, "baud rate", "%s", baud_name(code) != NULL ? baud_name(code) : "19200")
        ->is_number = true;
}

static void put_switch(decode_meaning_t *meaning, const char *name, uint16_t value)
{
    decode_field_t *const field = decode_string(meaning, name, "%s", value == 0 ? "off" : "on");
    if (value != 0 && value != 0xFF) {
        (void)snprintf(field->value, sizeof field->value, "0x%04X", value);
        field->note = "not 00 or FF";
    }
}

static void put_reconnect(decode_meaning_t *meaning, uint32_t ms)
{
    decode_field_t *const field = decode_number(meaning, "reconnect time", ms, "ms");
    if (ms % 18 != 0) field->note = "no multiple of 18";
}

static void put_configuration(decode_meaning_t *meaning, const uint8_t *values)
{
    put_switch(meaning, "termination", values[0]);
    put_switch(meaning, "continuous output", values[1]);
    decode_number(meaning, "warm-up", values[2], "s");
    put_reconnect(meaning, get32(values + 3));
    put_baud(meaning, values[7]);
}

static void put_details(decode_meaning_t *meaning, const uint8_t *values)
{
    enum { UUID = 1, DATE = 17, MAJOR = 20, MINOR = 21, BYTES = 16 };
    char uuid[2 * BYTES + 1];
    for (size_t i = 0; i != BYTES; i++) (void)snprintf(uuid + 2 * i, 3, "%02X", values[UUID + i]);
    decode_field_t *const ack = decode_string(meaning, "ACK", "%02X", values[0]);
    if (values[0] != 0xB0) ack->note = "not B0";
    decode_string(meaning, "UUID", "%s", uuid);
    put_date(meaning, values + DATE);
    decode_string(meaning, "version", "%u.%u", values[MAJOR], values[MINOR]);
}

/* Whole degrees; the scale is not in the datasheet. */
static void put_temperature(decode_meaning_t *meaning, const uint8_t *values)
{
    const int32_t degrees_f = signed16(decode_get16(values));
    const int32_t ninths = (degrees_f - 32) * 50; /* of a tenth of a degree Celsius */
    const int32_t tenths = (ninths + (ninths < 0 ? -4 : 4)) / 9;
    decode_number(meaning, "temperature", degrees_f, "F");
    decode_decimal(meaning, "temperature", tenths, 1, "C");
}

/* #5: all ones in distance, ambient and precision, and magnitude 0. */
static bool is_abnormal(const uint8_t *values)
{
    return decode_get16(values) == ALL_ONES && decode_get16(values + 2) == 0 && values[5] == 0xFF &&
           decode_get16(values + 6) == ALL_ONES;
}

static void put_measurement(decode_meaning_t *meaning, const uint8_t *values)
{
    const uint16_t distance = decode_get16(values);
    const uint16_t magnitude = decode_get16(values + 2);
    const uint16_t precision = decode_get16(values + 6);
    decode_field_t *const field = decode_number(meaning, "distance", distance, "mm");
    if (is_abnormal(values))
        field->note = "the abnormal packet: the sensor has failed";
    else if (distance == ALL_ONES)
        field->note = "no distance, and not the abnormal packet";
    else if (distance >= OVER_RANGE)
        field->note = "no target: out of range, or too weak";
    else if (distance == 0 || distance > MAX_MM)
        field->note = "no distance that it can mean";
    else if (distance < MIN_MM)
        field->note = "below its range of 80 mm and more";
    if (values[4] <= MAX_EXPONENT)
        decode_decimal(meaning, "magnitude", (int64_t)((uint64_t)magnitude << values[4]), 4, "");
    else
        decode_string(meaning, "magnitude", "%u << %u", magnitude, values[4])->note =
            "the exponent is over 16";
    decode_number(meaning, "ambient", values[5], "");
    decode_number(meaning, "precision", precision, "");
}

static void put_reset(decode_meaning_t *meaning, const uint8_t *values)
{
    const uint16_t result = decode_get16(values);
    if (result == 1)
        decode_string(meaning, "result", "success");
    else
        decode_number(meaning, "error code", result, "");
}

/* ---- which of the answers of one shape it can be ---- */

/* As a driver tells #2 from #5: the figures that it must have. */
static bool is_configuration(const uint8_t *values)
{
    const bool is_switch = (values[0] == 0 || values[0] == 0xFF) && (values[1] == 0 || values[1] == 0xFF);
    return is_switch && !is_abnormal(values);
}

static bool is_measurement(const uint8_t *values)
{
    const uint16_t distance = decode_get16(values);
    const bool is_over = distance >= OVER_RANGE && distance != ALL_ONES;
    return is_abnormal(values) ||
           ((is_over || (distance != 0 && distance <= MAX_MM)) && values[4] <= MAX_EXPONENT);
}

/* Colder than -50 degrees C or hotter than 150 no sensor speaks. */
static bool is_temperature(const uint8_t *values)
{
    const int32_t degrees_f = signed16(decode_get16(values));
    return degrees_f >= -58 && degrees_f <= 302;
}

static bool is_reset(const uint8_t *values) { return values[0] == 0; }

static bool is_details(const uint8_t *values) { return values[0] == 0xB0; }

/* ---- what is written ---- */

static void write_seconds(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "warm-up", value, "s");
    if (value > 255) field->note = "more than the 255 that #2 can report";
}

static void write_address(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "new address", value, "");
    if (value < 1 || value > 32) field->note = "not from 1 to 32";
}

static void write_output(decode_meaning_t *meaning, uint16_t value)
{
    put_switch(meaning, "continuous measurement", value);
}

static void write_termination(decode_meaning_t *meaning, uint16_t value)
{
    put_switch(meaning, "termination", value);
}

static void write_offset(decode_meaning_t *meaning, uint16_t value)
{
    decode_number(meaning, "offset", signed16(value), "mm");
}

static void write_load(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field =
        decode_string(meaning, "settings", "%s", value == 0 ? "of the user" : "of the factory");
    if (value == 0 || value == 0xFF) return;
    (void)snprintf(field->value, sizeof field->value, "0x%04X", value);
    field->note = "not 00 or FF";
}

static void write_filter(decode_meaning_t *meaning, uint16_t value)
{
    const int32_t sensitivity = signed16(value);
    decode_field_t *const field = decode_number(meaning, "filter sensitivity", sensitivity, "");
    if (sensitivity < -100 || sensitivity > 100) field->note = "outside the recommended -100..100";
}

/* ---- the commands ---- */

typedef struct {
    uint8_t number;
    uint8_t function;
    uint16_t address;
    uint8_t registers;
    const char *name;
    const char *source;
    bool (*is_likely)(const uint8_t *values);                         /* is this its answer? */
    void (*answer)(decode_meaning_t *meaning, const uint8_t *values); /* of a read */
    void (*write)(decode_meaning_t *meaning, uint16_t value);
} command_row_t;

static const command_row_t rows[] = {
    {1, READ, 0x0001, 3, "interface version", "HPS tables 9, 10", is_date, put_version, NULL},
    {2, READ, 0x0002, 4, "interface configuration", "HPS tables 11, 12", is_configuration, put_configuration,
     NULL},
    {3, READ, 0x0003, 11, "sensor details", "HPS tables 13, 14", is_details, put_details, NULL},
    {4, READ, 0x0004, 1, "AFE temperature", "HPS tables 15, 16", is_temperature, put_temperature, NULL},
    {5, READ, 0x0008, 4, "single measurement", "HPS tables 17, 18", is_measurement, put_measurement, NULL},
    {6, READ, 0x0009, 1, "factory reset of the interface", "HPS tables 19, 20", is_reset, put_reset, NULL},
    {7, WRITE, 0x000A, 1, "warm-up time", "HPS tables 21, 22", NULL, NULL, write_seconds},
    {8, WRITE, 0x0010, 1, "address", "HPS tables 23, 24", NULL, NULL, write_address},
    {9, WRITE, 0x0011, 1, "baud rate", "HPS tables 25, 26", NULL, NULL, put_baud},
    {10, WRITE, 0x0012, 1, "measurement after power-on", "HPS tables 27, 28", NULL, NULL, write_output},
    {11, WRITE, 0x0013, 1, "termination resistor", "HPS tables 29, 30", NULL, NULL, write_termination},
    {12, WRITE, 0x0014, 1, "distance offset", "HPS tables 31, 32", NULL, NULL, write_offset},
    {13, WRITE, 0x0015, 1, "load settings", "HPS tables 33, 34", NULL, NULL, write_load},
    {14, WRITE, 0x0016, 1, "filter sensitivity", "HPS tables 35, 36", NULL, NULL, write_filter},
    {15, WRITE_MANY, 0x0020, 2, "reconnect time", "HPS tables 37, 38", NULL, NULL, NULL},
};
enum { ROWS = sizeof rows / sizeof rows[0], RESET = 6, LOAD = 13 };

static void command_known(decode_frame_t *frame, const command_row_t *row, const uint8_t *request)
{
    const bool is_answer = frame->piece->direction == DECODE_ANSWER;
    decode_meaning_t *const meaning =
        decode_mean(frame, "hps167s", row->source, "#%u %s", row->number, row->name);
    if (row->function != WRITE && decode_get16(request + COUNT) != row->registers) {
        decode_note(frame, "hps167s: #%u has %u registers, not %u; it refuses this", row->number,
                    row->registers, decode_get16(request + COUNT));
        return;
    }
    if (row->function == READ && is_answer) row->answer(meaning, frame->bytes + SIZE + 1);
    if (row->function == WRITE) row->write(meaning, decode_get16(frame->bytes + VALUE));
    if (row->function == WRITE_MANY && !is_answer) put_reconnect(meaning, get32(frame->bytes + MANY_VALUES));
    if (row->number == RESET && !is_answer) decode_note(frame, "hps167s: resets the device");
    if (row->number == LOAD && decode_get16(frame->bytes + VALUE) == 0xFF)
        decode_note(frame, "hps167s: resets the device's settings");
}

void decode_hps167s(decode_frame_t *frame, const uint8_t *request)
{
    for (size_t i = 0; i != ROWS; i++) {
        const command_row_t *const row = &rows[i];
        if (row->function != frame->bytes[FUNCTION]) continue;
        if (request == NULL && 2 * row->registers == frame->bytes[SIZE] &&
            (frame->is_sure || row->is_likely(frame->bytes + SIZE + 1)))
            row->answer(
                decode_mean(frame, "hps167s", row->source, "if #%u was asked: %s", row->number, row->name),
                frame->bytes + SIZE + 1);
        if (request != NULL && decode_get16(request + FIRST) == row->address)
            command_known(frame, row, request);
    }
}
