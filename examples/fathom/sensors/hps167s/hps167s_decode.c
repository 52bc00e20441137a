/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/codec/modbus_rtu.h"
#include "sensors/hps167s/hps167s.h"

enum { MANY_SIZE = 6 };
enum {
    READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS,
    WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER,
    WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS
};

/* ---- what the responses carry ---- */

static void put_date(decode_meaning_t *meaning, uint16_t year, uint8_t month, uint8_t day)
{
    decode_field_t *const field =
        decode_string(meaning, "date", "%04u-%02u-%02u", (unsigned)year, (unsigned)month, (unsigned)day);
    if (!fathom_hps167s_is_date(month, day)) field->note = "no date";
}

static void put_version(decode_meaning_t *meaning, const uint16_t *registers)
{
    fathom_hps167s_version_t is;
    fathom_hps167s_decode_version(registers, &is);
    put_date(meaning, is.year, is.month, is.day);
    decode_string(meaning, "version", "%u.%u.%u", is.major, is.minor, is.revision);
}

static void put_baud(decode_meaning_t *meaning, uint16_t code)
{
    const uint32_t baud = fathom_hps167s_baud(code);
    const bool has_rate = fathom_hps167s_baud_code(baud) == code;
    decode_number(meaning, "baud code", code, "")->note = has_rate ? NULL : "no code of #9";
    decode_number(meaning, "baud rate", baud, "");
}

static void put_switch(decode_meaning_t *meaning, const char *name, uint16_t value)
{
    decode_field_t *const field =
        decode_string(meaning, name, "%s", value == FATHOM_HPS167S_OFF ? "off" : "on");
    if (value != FATHOM_HPS167S_OFF && value != FATHOM_HPS167S_ON) {
        (void)snprintf(field->value, sizeof field->value, "0x%04X", value);
        field->note = "not 00 or FF";
    }
}

static void put_reconnect(decode_meaning_t *meaning, uint32_t ms)
{
    decode_field_t *const field = decode_number(meaning, "reconnect time", ms, "ms");
    if (ms % FATHOM_HPS167S_RECONNECT_STEP_MS != 0) field->note = "no multiple of 18";
}

static void put_configuration(decode_meaning_t *meaning, const uint16_t *registers)
{
    fathom_hps167s_configuration_t is;
    fathom_hps167s_decode_configuration(registers, false, &is);
    put_switch(meaning, "termination", fathom_hps167s_get_byte(registers, FATHOM_HPS167S_TERMINATION_BYTE));
    put_switch(meaning, "continuous output",
               fathom_hps167s_get_byte(registers, FATHOM_HPS167S_MEASURES_BYTE));
    decode_number(meaning, "warm-up", is.warm_up_s, "s");
    put_reconnect(meaning, is.reconnect_time_ms);
    put_baud(meaning, is.baud_code);
}

static void put_details(decode_meaning_t *meaning, const uint16_t *registers)
{
    fathom_hps167s_details_t is;
    char uuid[2 * FATHOM_HPS167S_UUID_LENGTH + 1];
    fathom_hps167s_decode_details(registers, &is);
    for (size_t i = 0; i != sizeof is.uuid; i++) (void)snprintf(uuid + 2 * i, 3, "%02X", is.uuid[i]);
    decode_field_t *const ack =
        decode_string(meaning, "ACK", "%02X", fathom_hps167s_get_byte(registers, FATHOM_HPS167S_ACK_BYTE));
    if (!fathom_hps167s_may_be_details(registers)) ack->note = "not B0";
    decode_string(meaning, "UUID", "%s", uuid);
    put_date(meaning, is.year, is.month, is.day);
    decode_string(meaning, "version", "%u.%u", is.major, is.minor);
}

/* Whole degrees; the scale is not in the datasheet. */
static void put_temperature(decode_meaning_t *meaning, const uint16_t *registers)
{
    const int16_t fahrenheit = fathom_hps167s_to_signed(registers[0]);
    decode_number(meaning, "temperature", fahrenheit, "F");
    decode_decimal(meaning, "temperature", fathom_hps167s_temperature_dc(fahrenheit, 1), 1, "C");
}

/* What there is to say of a distance beside an exponent that is right. */
static const char *distance_note(const uint16_t *registers)
{
    const uint16_t apart[] = {registers[0], registers[1], registers[2] & 0x00FF, registers[3]};
    fathom_sample_t sample;
    if (fathom_hps167s_decode(apart, &sample) != FATHOM_OK)
        return registers[0] == UINT16_MAX ? "no distance, and not the abnormal packet"
                                          : "no distance that it can mean";
    switch (sample.kind) {
    case FATHOM_FAULT:
        return "the abnormal packet: the sensor has failed";
    case FATHOM_NO_TARGET:
        return "no target: out of range, or too weak";
    case FATHOM_UNKNOWN:
        return "below its range of 80 mm and more";
    default:
        return NULL;
    }
}

static void put_measurement(decode_meaning_t *meaning, const uint16_t *registers)
{
    const uint16_t magnitude = registers[1];
    const uint8_t exponent = fathom_hps167s_get_byte(registers, FATHOM_HPS167S_EXPONENT_BYTE);
    decode_number(meaning, "distance", registers[0], "mm")->note = distance_note(registers);
    if (exponent <= FATHOM_HPS167S_MAX_EXPONENT)
        decode_decimal(meaning, "magnitude", (int64_t)((uint64_t)magnitude << exponent), 4, "");
    else
        decode_string(meaning, "magnitude", "%u << %u", magnitude, exponent)->note =
            "the exponent is over 16";
    decode_number(meaning, "ambient", registers[2] & 0x00FF, "");
    decode_number(meaning, "precision", registers[3], "");
}

static void put_reset(decode_meaning_t *meaning, const uint16_t *registers)
{
    if (registers[0] == FATHOM_HPS167S_RESET_DONE)
        decode_string(meaning, "result", "success");
    else
        decode_number(meaning, "error code", registers[0], "");
}

/* ---- which of the responses of one shape it can be ---- */

static bool is_version(const uint16_t *registers)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_decode_version(registers, &version);
    return fathom_hps167s_is_date(version.month, version.day);
}

static bool is_measurement(const uint16_t *registers)
{
    fathom_sample_t sample;
    return fathom_hps167s_decode(registers, &sample) == FATHOM_OK;
}

/* Colder than -50 degrees C or hotter than 150 no sensor speaks. */
static bool is_temperature(const uint16_t *registers)
{
    const int32_t temperature_dc = fathom_hps167s_temperature_dc(fathom_hps167s_to_signed(registers[0]), 1);
    return temperature_dc >= -500 && temperature_dc <= 1500;
}

static bool is_reset(const uint16_t *registers) { return registers[0] <= UINT8_MAX; }

/* ---- what is written ---- */

static void write_seconds(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "warm-up", value, "s");
    if (value > UINT8_MAX) field->note = "more than the 255 that #2 can report";
}

static void write_address(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "new address", value, "");
    if (value < 1 || value > FATHOM_HPS167S_MAX_ADDRESS) field->note = "not from 1 to 32";
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
    decode_number(meaning, "offset", fathom_hps167s_to_signed(value), "mm");
}

static void write_load(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_string(
        meaning, "settings", "%s", value == FATHOM_HPS167S_USER ? "of the user" : "of the factory");
    if (value == FATHOM_HPS167S_USER || value == FATHOM_HPS167S_FACTORY) return;
    (void)snprintf(field->value, sizeof field->value, "0x%04X", value);
    field->note = "not 00 or FF";
}

static void write_filter(decode_meaning_t *meaning, uint16_t value)
{
    const int16_t sensitivity = fathom_hps167s_to_signed(value);
    decode_field_t *const field = decode_number(meaning, "filter sensitivity", sensitivity, "");
    if (sensitivity < -FATHOM_HPS167S_MAX_FILTER || sensitivity > FATHOM_HPS167S_MAX_FILTER)
        field->note = "outside the recommended -100..100";
}

/* ---- the commands ---- */

typedef struct {
    uint8_t number;
    uint8_t function;
    uint16_t address;
    uint8_t registers;
    const char *name;
    const char *source;
    bool (*is_likely)(const uint16_t *registers);                           /* is this its response? */
    void (*response)(decode_meaning_t *meaning, const uint16_t *registers); /* of a read */
    void (*write)(decode_meaning_t *meaning, uint16_t value);
} command_row_t;

static const command_row_t rows[] = {
    {1, READ, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT, "interface version", "HPS tables 9, 10",
     is_version, put_version, NULL},
    {2, READ, FATHOM_HPS167S_CONFIGURATION, FATHOM_HPS167S_CONFIGURATION_COUNT, "interface configuration",
     "HPS tables 11, 12", fathom_hps167s_may_be_configuration, put_configuration, NULL},
    {3, READ, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT, "sensor details", "HPS tables 13, 14",
     fathom_hps167s_may_be_details, put_details, NULL},
    {4, READ, FATHOM_HPS167S_TEMPERATURE, 1, "AFE temperature", "HPS tables 15, 16", is_temperature,
     put_temperature, NULL},
    {5, READ, FATHOM_HPS167S_MEASUREMENT, FATHOM_HPS167S_MEASUREMENT_COUNT, "single measurement",
     "HPS tables 17, 18", is_measurement, put_measurement, NULL},
    {6, READ, FATHOM_HPS167S_RESET, 1, "factory reset of the interface", "HPS tables 19, 20", is_reset,
     put_reset, NULL},
    {7, WRITE, FATHOM_HPS167S_WARM_UP, 1, "warm-up time", "HPS tables 21, 22", NULL, NULL, write_seconds},
    {8, WRITE, FATHOM_HPS167S_ADDRESS, 1, "address", "HPS tables 23, 24", NULL, NULL, write_address},
    {9, WRITE, FATHOM_HPS167S_BAUD, 1, "baud rate", "HPS tables 25, 26", NULL, NULL, put_baud},
    {10, WRITE, FATHOM_HPS167S_MEASURES, 1, "measurement after power-on", "HPS tables 27, 28", NULL, NULL,
     write_output},
    {11, WRITE, FATHOM_HPS167S_TERMINATION, 1, "termination resistor", "HPS tables 29, 30", NULL, NULL,
     write_termination},
    {12, WRITE, FATHOM_HPS167S_OFFSET, 1, "distance offset", "HPS tables 31, 32", NULL, NULL, write_offset},
    {13, WRITE, FATHOM_HPS167S_LOAD, 1, "load settings", "HPS tables 33, 34", NULL, NULL, write_load},
    {14, WRITE, FATHOM_HPS167S_FILTER, 1, "filter sensitivity", "HPS tables 35, 36", NULL, NULL,
     write_filter},
    {15, WRITE_MANY, FATHOM_HPS167S_RECONNECT, FATHOM_HPS167S_RECONNECT_COUNT, "reconnect time",
     "HPS tables 37, 38", NULL, NULL, NULL},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

/* The registers behind the length byte of a response or of a write of many. */
static void get_registers(const uint8_t *size, uint8_t count,
                          uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS])
{
    for (uint8_t i = 0; i != count; i++) registers[i] = decode_get16(size + 1 + 2 * i);
}

static void command_known(decode_frame_t *frame, const command_row_t *row, const uint8_t *request)
{
    const bool is_response = frame->piece->direction == DECODE_RESPONSE;
    decode_meaning_t *const meaning =
        decode_mean(frame, "hps167s", row->source, "#%u %s", row->number, row->name);
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS] = {0};
    if (row->function != WRITE && decode_get16(request + DECODE_AT_COUNT) != row->registers) {
        decode_note(frame, "hps167s: #%u has %u registers, not %u; it refuses this", row->number,
                    row->registers, decode_get16(request + DECODE_AT_COUNT));
        return;
    }
    if (row->function == READ && is_response) {
        get_registers(frame->bytes + DECODE_AT_SIZE, row->registers, registers);
        row->response(meaning, registers);
    }
    if (row->function == WRITE) row->write(meaning, decode_get16(frame->bytes + DECODE_AT_VALUE));
    if (row->function == WRITE_MANY && !is_response) {
        get_registers(frame->bytes + MANY_SIZE, row->registers, registers);
        put_reconnect(meaning, fathom_hps167s_decode_reconnect_time(registers[0], registers[1], false));
    }
    if (row->address == FATHOM_HPS167S_RESET && !is_response)
        decode_note(frame, "hps167s: resets the device");
    if (row->address == FATHOM_HPS167S_LOAD &&
        decode_get16(frame->bytes + DECODE_AT_VALUE) == FATHOM_HPS167S_FACTORY)
        decode_note(frame, "hps167s: resets the device's settings");
}

/* A response whose request is not known: is it this command's? */
static void command_guessed(decode_frame_t *frame, const command_row_t *row)
{
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS];
    if (2 * row->registers != frame->bytes[DECODE_AT_SIZE]) return;
    get_registers(frame->bytes + DECODE_AT_SIZE, row->registers, registers);
    if (frame->is_sure || row->is_likely(registers))
        row->response(
            decode_mean(frame, "hps167s", row->source, "if #%u was asked: %s", row->number, row->name),
            registers);
}

void hps167s_decode(decode_frame_t *frame, const uint8_t *request)
{
    for (size_t i = 0; i != ROWS; i++) {
        const command_row_t *const row = &rows[i];
        if (row->function != frame->bytes[DECODE_AT_FUNCTION]) continue;
        if (request == NULL)
            command_guessed(frame, row);
        else if (decode_get16(request + DECODE_AT_FIRST) == row->address)
            command_known(frame, row, request);
    }
}

/*
 * A read of 0x0009 is command #6. The datasheet does not say what a read with another count, from a lower register or by
 * function 4 does, so each read that includes 0x0009 counts. #3 and #5 include it and are known to be harmless.
 */
const char *hps167s_read_changes(const uint8_t *request)
{
    const bool is_holding = request[DECODE_AT_FUNCTION] == FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    const uint16_t first = decode_get16(request + DECODE_AT_FIRST);
    const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
    const bool is_known =
        is_holding && ((first == FATHOM_HPS167S_DETAILS && count == FATHOM_HPS167S_DETAILS_COUNT) ||
                       (first == FATHOM_HPS167S_MEASUREMENT && count == FATHOM_HPS167S_MEASUREMENT_COUNT));
    if (is_known || first > FATHOM_HPS167S_RESET || (uint32_t)first + count <= FATHOM_HPS167S_RESET)
        return NULL;
    return "a read of 0x0009 resets an HPS-167S: address 1, 19200 8E1, warm-up and termination as from the "
           "factory";
}
