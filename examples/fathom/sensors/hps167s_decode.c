/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/codec/modbus_rtu.h"
#include "sensors/hps167s.h"

enum { MANY_SIZE = 6 };
enum {
    READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS,
    WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER,
    WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS
};

/* ---- values that no setting has ---- */

static void put_ack(decode_meaning_t *meaning, const uint16_t *registers)
{
    decode_field_t *const ack =
        decode_string(meaning, "ACK", "%02X", fathom_hps167s_get_byte(registers, FATHOM_HPS167S_ACK_BYTE));
    if (!fathom_hps167s_may_be_details(registers)) decode_remark(ack, "not B0");
}

/* As it was sent; the scale is not in the datasheet. */
static void put_fahrenheit(decode_meaning_t *meaning, const uint16_t *registers)
{
    decode_number(meaning, "temperature", fathom_hps167s_to_signed(registers[0]), "degF");
}

/* Returns why a distance is none; NULL: it is one. */
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
    const char *const note = distance_note(registers);
    decode_field_t *const distance = decode_number(meaning, "distance", registers[0], "mm");
    if (note != NULL) decode_remark(distance, "%s", note);
    if (exponent <= FATHOM_HPS167S_MAX_EXPONENT)
        decode_decimal(meaning, "magnitude", (int64_t)((uint64_t)magnitude << exponent), 4, "");
    else
        decode_remark(decode_string(meaning, "magnitude", "%u << %u", magnitude, exponent),
                      "the exponent is over 16");
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

/* ---- the commands ---- */

typedef struct {
    uint8_t number;
    uint8_t function;
    uint16_t address;
    uint8_t registers;
    const char *name;
    const char *source;
    bool (*is_likely)(const uint16_t *registers); /* the values of a response can be of this command */
    void (*more)(decode_meaning_t *meaning, const uint16_t *registers); /* values that no setting has */
} command_row_t;

static const command_row_t rows[] = {
    {1, READ, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT, "interface version", "HPS tables 9, 10",
     is_version, NULL},
    {2, READ, FATHOM_HPS167S_CONFIGURATION, FATHOM_HPS167S_CONFIGURATION_COUNT, "interface configuration",
     "HPS tables 11, 12", fathom_hps167s_may_be_configuration, NULL},
    {3, READ, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT, "sensor details", "HPS tables 13, 14",
     fathom_hps167s_may_be_details, put_ack},
    {4, READ, FATHOM_HPS167S_TEMPERATURE, 1, "AFE temperature", "HPS tables 15, 16", is_temperature,
     put_fahrenheit},
    {5, READ, FATHOM_HPS167S_MEASUREMENT, FATHOM_HPS167S_MEASUREMENT_COUNT, "single measurement",
     "HPS tables 17, 18", is_measurement, put_measurement},
    {6, READ, FATHOM_HPS167S_RESET, 1, "factory reset of the interface", "HPS tables 19, 20", is_reset,
     put_reset},
    {7, WRITE, FATHOM_HPS167S_WARM_UP, 1, "warm-up time", "HPS tables 21, 22", NULL, NULL},
    {8, WRITE, FATHOM_HPS167S_ADDRESS, 1, "address", "HPS tables 23, 24", NULL, NULL},
    {9, WRITE, FATHOM_HPS167S_BAUD, 1, "baud rate", "HPS tables 25, 26", NULL, NULL},
    {10, WRITE, FATHOM_HPS167S_MEASURES, 1, "measurement after power-on", "HPS tables 27, 28", NULL, NULL},
    {11, WRITE, FATHOM_HPS167S_TERMINATION, 1, "termination resistor", "HPS tables 29, 30", NULL, NULL},
    {12, WRITE, FATHOM_HPS167S_OFFSET, 1, "distance offset", "HPS tables 31, 32", NULL, NULL},
    {13, WRITE, FATHOM_HPS167S_LOAD, 1, "load settings", "HPS tables 33, 34", NULL, NULL},
    {14, WRITE, FATHOM_HPS167S_FILTER, 1, "filter sensitivity", "HPS tables 35, 36", NULL, NULL},
    {15, WRITE_MANY, FATHOM_HPS167S_RECONNECT, FATHOM_HPS167S_RECONNECT_COUNT, "reconnect time",
     "HPS tables 37, 38", NULL, NULL},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

/* The registers behind the length byte of a response or of a write of many. */
static void get_registers(const uint8_t *size, uint8_t count,
                          uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS])
{
    for (uint8_t i = 0; i != count; i++) registers[i] = decode_get16(size + 1 + 2 * i);
}

static void put_response(decode_meaning_t *meaning, const model_t *model, const command_row_t *row,
                         const uint16_t *registers)
{
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++)
        if (setting->read_at == row->address) decode_response(meaning, setting, registers);
    if (row->more != NULL) row->more(meaning, registers);
}

/* The value that a request writes, or that is acknowledged. */
static void put_written(decode_meaning_t *meaning, const model_t *model, const command_row_t *row,
                        const uint16_t *registers)
{
    const uint16_t value = registers[0];
    const int64_t number =
        row->registers == 1 ? value : fathom_hps167s_decode_reconnect_time(value, registers[1], false);
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++) {
        if (setting->write_at != row->address) continue;
        decode_setting(meaning, setting, setting->least < 0 ? fathom_hps167s_to_signed(value) : number);
    }
}

static void command_known(decode_frame_t *frame, const model_t *model, const command_row_t *row,
                          const uint8_t *request)
{
    const bool is_response = frame->piece->direction == DECODE_RESPONSE;
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, row->source, "#%u %s", row->number, row->name);
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS] = {0};
    if (row->function != WRITE && decode_get16(request + DECODE_AT_COUNT) != row->registers) {
        decode_note(frame, "%s: #%u has %u registers, not %u; it refuses this", model->name, row->number,
                    row->registers, decode_get16(request + DECODE_AT_COUNT));
        return;
    }
    if (row->function == READ && is_response) {
        get_registers(frame->bytes + DECODE_AT_SIZE, row->registers, registers);
        put_response(meaning, model, row, registers);
    }
    if (row->function == WRITE) {
        registers[0] = decode_get16(frame->bytes + DECODE_AT_VALUE);
        put_written(meaning, model, row, registers);
    }
    if (row->function == WRITE_MANY && !is_response) {
        get_registers(frame->bytes + MANY_SIZE, row->registers, registers);
        put_written(meaning, model, row, registers);
    }
    if (row->address == FATHOM_HPS167S_RESET && !is_response)
        decode_note(frame, "%s: resets the device", model->name);
    if (row->address == FATHOM_HPS167S_LOAD && registers[0] == FATHOM_HPS167S_FACTORY)
        decode_note(frame, "%s: resets the device's settings", model->name);
}

/* A response whose request is not known. */
static void command_guessed(decode_frame_t *frame, const model_t *model, const command_row_t *row)
{
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS];
    if (2 * row->registers != frame->bytes[DECODE_AT_SIZE]) return;
    get_registers(frame->bytes + DECODE_AT_SIZE, row->registers, registers);
    if (!frame->is_sure && !row->is_likely(registers)) return;
    put_response(decode_mean(frame, model->name, row->source, "if #%u was asked: %s", row->number, row->name),
                 model, row, registers);
}

void hps167s_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request)
{
    for (size_t i = 0; i != ROWS; i++) {
        const command_row_t *const row = &rows[i];
        if (row->function != frame->bytes[DECODE_AT_FUNCTION]) continue;
        if (request == NULL)
            command_guessed(frame, model, row);
        else if (decode_get16(request + DECODE_AT_FIRST) == row->address)
            command_known(frame, model, row, request);
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
