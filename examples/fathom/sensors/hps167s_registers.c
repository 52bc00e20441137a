/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "fathom/codec/hps167_frames.h"
#include "fathom/codec/modbus_rtu.h"
#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"
#include "output/words.h"
#include "sensors/decoding.h"
#include "sensors/driver.h"

/* The commands of the HPS-167S (3, #1 to #15), its settings, and what a scan reads. */

enum {
    READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS,
    WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER,
    WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS
};

/* ---- texts of values ---- */

/* "2.1.0 of 2020-09-27" */
static void print_version(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_decode_version(registers, &version);
    (void)snprintf(text, SETTING_TEXT, "%u.%u.%u of %04u-%02u-%02u", version.major, version.minor,
                   version.revision, version.year, version.month, version.day);
}

static void print_details(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_details_t details;
    fathom_hps167s_decode_details(registers, &details);
    (void)snprintf(text, SETTING_TEXT, "%u.%u of %04u-%02u-%02u", details.major, details.minor, details.year,
                   details.month, details.day);
}

static void print_uuid(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_details_t details;
    fathom_hps167s_decode_details(registers, &details);
    for (size_t i = 0; i != FATHOM_HPS167S_UUID_LENGTH; i++)
        (void)snprintf(text + 2 * i, SETTING_TEXT - 2 * i, "%02x", details.uuid[i]);
}

static void print_temperature(char text[SETTING_TEXT], const uint16_t *registers)
{
    const int16_t fahrenheit = fathom_hps167s_to_signed(registers[0]);
    decimal_text(text, fathom_hps167s_temperature_dc(fahrenheit, 1), 1);
}

static void print_baud(char text[SETTING_TEXT], const uint16_t *registers)
{
    const uint8_t code = fathom_hps167s_get_byte(registers, FATHOM_HPS167S_BAUD_BYTE);
    (void)snprintf(text, SETTING_TEXT, "%" PRIu32, fathom_hps167s_baud(code));
}

static const char *note_baud_code(int64_t code)
{
    const bool has_rate = fathom_hps167s_baud_code(fathom_hps167s_baud((uint16_t)code)) == code;
    return has_rate ? NULL : "no code of #9: 19200";
}

static const char *note_load(int64_t value)
{
    return value == FATHOM_HPS167S_FACTORY ? "the factory settings" : NULL;
}

static const char *note_filter(int64_t value)
{
    const bool is_recommended = value >= -FATHOM_HPS167S_MAX_FILTER && value <= FATHOM_HPS167S_MAX_FILTER;
    return is_recommended ? NULL : "outside the recommended -100..100";
}

/* ---- the settings ---- */

#define KEPT       "kept in flash"
#define NEXT_POWER "from the next power-on; " KEPT

static const char *const off_on[] = {"off", "on", NULL};
static const char *const rates[] = {"19200", "57600", "115200", "230400",
                                    NULL}; /* in the order of their codes */
static const char *const user[] = {"user", NULL};

const setting_t hps167s_settings[] = {
    {"interface-version", "of the RS485 interface (#1)", SETTING_VERSION, .read_at = FATHOM_HPS167S_VERSION,
     .print = print_version},
    {"sensor-version", "of the sensor behind it (#3)", SETTING_VERSION, .read_at = FATHOM_HPS167S_DETAILS,
     .print = print_details},
    {"uuid", "the sensor's own number (#3)", SETTING_IDENTITY, .read_at = FATHOM_HPS167S_DETAILS,
     .print = print_uuid},
    {"temperature", "of its analog front end, sent in degrees Fahrenheit (#4)", SETTING_PRESENT,
     .read_at = FATHOM_HPS167S_TEMPERATURE, .unit = "degC", .print = print_temperature},
    {"address", "Modbus address (#8)", .write_at = FATHOM_HPS167S_ADDRESS, .effect = "at once; " KEPT,
     .least = 1, .most = FATHOM_HPS167S_MAX_ADDRESS, .moves = true},
    {"baud", "of the line (#9)", .read_at = FATHOM_HPS167S_CONFIGURATION, .write_at = FATHOM_HPS167S_BAUD,
     .effect = "at once or from the next power-on, the datasheet does not say; " KEPT, .words = rates,
     .first_word = 1, .note = note_baud_code, .moves = true, .is_baud = true, .print = print_baud},
    {"baud-code", "the rate as #2 has it: 1 to 4 by #9, all others mean 19200", SETTING_PRESENT,
     .read_at = FATHOM_HPS167S_CONFIGURATION, .byte = FATHOM_HPS167S_BAUD_BYTE, .size = 1,
     .note = note_baud_code},
    {"warm-up", "time without a response after power-on (#7)", .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_WARM_UP, .byte = FATHOM_HPS167S_WARM_UP_BYTE, .size = 1, .unit = "s",
     .effect = KEPT, .most = 255},
    {"measure-after-power-on", "whether it measures continuously, so that a response is ready sooner (#10)",
     .read_at = FATHOM_HPS167S_CONFIGURATION, .write_at = FATHOM_HPS167S_MEASURES,
     .byte = FATHOM_HPS167S_MEASURES_BYTE, .size = 1, .effect = NEXT_POWER, .is_later = true, .words = off_on,
     .word_step = FATHOM_HPS167S_ON, .has_broadcast = true},
    {"termination", "the termination resistor, on in every unit from the factory (#11)",
     .read_at = FATHOM_HPS167S_CONFIGURATION, .write_at = FATHOM_HPS167S_TERMINATION,
     .byte = FATHOM_HPS167S_TERMINATION_BYTE, .size = 1, .effect = NEXT_POWER, .is_later = true,
     .words = off_on, .word_step = FATHOM_HPS167S_ON, .has_broadcast = true,
     .remark = "the termination resistor is on, as in every sensor from the factory; on a line with several, "
               "switch it off in all but the last"},
    {"reconnect-time", "after this time without data from its sensor it sends abnormal packets (#15)",
     .read_at = FATHOM_HPS167S_CONFIGURATION, .write_at = FATHOM_HPS167S_RECONNECT,
     .byte = FATHOM_HPS167S_RECONNECT_BYTE, .size = 4, .unit = "ms", .effect = KEPT,
     .most = 2147483646 /* 18 * 119304647 */, .step = FATHOM_HPS167S_RECONNECT_STEP_MS},
    {"load-settings",
     "loads the settings that the user has saved (#13); for those of the factory: fathom reset",
     SETTING_PRESENT, .write_at = FATHOM_HPS167S_LOAD, .effect = "at once; kept over power-off",
     .words = user, .note = note_load},
    {"distance-offset",
     "added to what it measures; whether to an earlier offset too is not in the datasheet (#12)",
     .write_at = FATHOM_HPS167S_OFFSET, .unit = "mm", .effect = KEPT, .least = INT16_MIN, .most = INT16_MAX,
     .is_never_blind = true, .risk = "a sensor that has an offset already may add the new one to it"},
    {"filter-sensitivity",
     "larger is steadier and slower; 0 from the factory, -100 to 100 is recommended (#14)",
     .write_at = FATHOM_HPS167S_FILTER, .effect = KEPT, .least = INT16_MIN, .most = INT16_MAX,
     .note = note_filter},
    {.name = NULL},
};

static fathom_status_t read_command(fathom_hps167s_t *sensor, uint16_t command)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    switch (command) {
    case FATHOM_HPS167S_VERSION:
        return fathom_hps167s_get_interface_version(sensor, &version);
    case FATHOM_HPS167S_CONFIGURATION:
        return fathom_hps167s_get_configuration(sensor, &configuration);
    case FATHOM_HPS167S_DETAILS:
        return fathom_hps167s_get_details(sensor, &details);
    default:
        return fathom_hps167s_get_temperature(sensor, &temperature);
    }
}

fathom_status_t hps167s_get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    fathom_hps167s_t *const sensor = &reader->driver.hps167s;
    const fathom_line_settings_t *const line = sensor->unit.line_settings;
    fathom_status_t status = read_command(sensor, setting->read_at);
    if (status == FATHOM_OK) status = setting_print(setting, sensor->values, text);
    /* A code without its own rate shows nothing: the unit has the rate at which it responded. */
    if (status == FATHOM_OK && setting->is_baud && line != NULL &&
        note_baud_code(fathom_hps167s_get_byte(sensor->values, FATHOM_HPS167S_BAUD_BYTE)) != NULL)
        (void)snprintf(text, SETTING_TEXT, "%" PRIu32, line->baud);
    return status;
}

fathom_status_t hps167s_set(reader_t *reader, const setting_t *setting, int32_t value)
{
    fathom_hps167s_t *const sensor = &reader->driver.hps167s;
    switch (setting->write_at) {
    case FATHOM_HPS167S_WARM_UP:
        return fathom_hps167s_set_warm_up_s(sensor, (uint8_t)value);
    case FATHOM_HPS167S_ADDRESS:
        return fathom_hps167s_set_address(sensor, (uint8_t)value);
    case FATHOM_HPS167S_BAUD:
        return fathom_hps167s_set_baud(sensor, fathom_hps167s_baud((uint16_t)(value + setting->first_word)));
    case FATHOM_HPS167S_MEASURES:
        return fathom_hps167s_set_measures_after_power_on(sensor, value != 0);
    case FATHOM_HPS167S_TERMINATION:
        return fathom_hps167s_set_termination(sensor, value != 0);
    case FATHOM_HPS167S_OFFSET:
        return fathom_hps167s_set_distance_offset_mm(sensor, (int16_t)value);
    case FATHOM_HPS167S_LOAD:
        return fathom_hps167s_load_user_settings(sensor);
    case FATHOM_HPS167S_FILTER:
        return fathom_hps167s_set_filter_sensitivity(sensor, (int16_t)value);
    default:
        return fathom_hps167s_set_reconnect_time_ms(sensor, (uint32_t)value);
    }
}

fathom_status_t hps167s_set_all(reader_t *reader, const setting_t *setting, int32_t value)
{
    fathom_hps167s_t *const sensor = &reader->driver.hps167s;
    return setting->write_at == FATHOM_HPS167S_MEASURES
               ? fathom_hps167s_broadcast_measures_after_power_on(sensor, value != 0)
               : fathom_hps167s_broadcast_termination(sensor, value != 0);
}

fathom_status_t hps167s_reset_interface(reader_t *reader)
{
    return fathom_hps167s_restore_factory_settings(&reader->driver.hps167s);
}

fathom_status_t hps167s_reset_sensor(reader_t *reader)
{
    return fathom_hps167s_load_factory_settings(&reader->driver.hps167s);
}

/* ---- decoding: values that no setting has ---- */

static void put_ack(decode_meaning_t *meaning, const uint16_t *registers)
{
    decode_field_t *const ack =
        decode_string(meaning, "ACK", "%02X", fathom_hps167s_get_byte(registers, FATHOM_HPS167S_ACK_BYTE));
    if (!fathom_hps167s_may_be_details(registers)) decode_remark(ack, "not B0");
}

/* As it was sent; the scale is not in the datasheet. */
static void put_fahrenheit(decode_meaning_t *meaning, const uint16_t *registers)
{
    (void)decode_number(meaning, "temperature", fathom_hps167s_to_signed(registers[0]), "degF");
}

/* Returns why a distance is none; NULL: it is one. */
static const char *distance_note(const uint16_t *registers)
{
    static const char *const notes[] = {[FATHOM_FAULT] = "the abnormal packet: the sensor has failed",
                                        [FATHOM_NO_TARGET] = "no target: out of range, or too weak",
                                        [FATHOM_UNKNOWN] = "below its range of 80 mm and more",
                                        [FATHOM_TARGET] = NULL};
    const uint16_t without_exponent[] = {registers[0], registers[1], registers[2] & 0x00FF, registers[3]};
    fathom_sample_t sample;
    if (fathom_hps167s_decode(without_exponent, &sample) == FATHOM_OK) return notes[sample.kind];
    return registers[0] == UINT16_MAX ? "no distance, and not the abnormal packet"
                                      : "no distance that it can mean";
}

static void put_measurement(decode_meaning_t *meaning, const uint16_t *registers)
{
    const uint16_t magnitude = registers[1];
    const uint8_t exponent = fathom_hps167s_get_byte(registers, FATHOM_HPS167S_EXPONENT_BYTE);
    const char *const note = distance_note(registers);
    decode_field_t *const distance = decode_number(meaning, "distance", registers[0], "mm");
    if (note != NULL) decode_remark(distance, "%s", note);
    if (exponent <= FATHOM_HPS167S_MAX_EXPONENT) {
        const uint64_t value = (uint64_t)magnitude << exponent; /* in ten-thousandths */
        decode_string(meaning, "magnitude", "%" PRIu64 ".%04" PRIu64, value / 10000, value % 10000)
            ->is_number = true;
    } else {
        decode_remark(decode_string(meaning, "magnitude", "%u << %u", magnitude, exponent),
                      "the exponent is over 16");
    }
    (void)decode_number(meaning, "ambient", registers[2] & 0x00FF, "");
    (void)decode_number(meaning, "precision", registers[3], "");
}

static void put_reset(decode_meaning_t *meaning, const uint16_t *registers)
{
    if (registers[0] == FATHOM_HPS167S_RESET_DONE)
        (void)decode_string(meaning, "result", "success");
    else
        (void)decode_number(meaning, "error code", registers[0], "");
}

/* ---- decoding: which of the responses of one shape it can be ---- */

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

/* ---- decoding: the commands ---- */

typedef struct {
    uint8_t number;
    uint8_t function;
    uint16_t address;
    uint8_t registers;
    const char *name;
    const char *source;
    bool (*is_likely)(const uint16_t *registers); /* the values of a response can be of this command */
    void (*more)(decode_meaning_t *meaning, const uint16_t *registers); /* values that no setting has */
} command_t;

static const command_t commands[] = {
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

/* Adds the values of a response, or the value that a write has or acknowledges. */
static void put_values(decode_meaning_t *meaning, const command_t *command, const uint8_t *data)
{
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS];
    decode_registers(data, registers, command->registers);
    for (const setting_t *setting = hps167s_settings; setting->name != NULL; setting++) {
        if (setting->read_at == command->address) decode_response(meaning, setting, registers);
        if (setting->write_at != command->address) continue;
        int64_t value = setting->least < 0 ? fathom_hps167s_to_signed(registers[0]) : registers[0];
        if (command->registers == FATHOM_HPS167S_RECONNECT_COUNT)
            value = fathom_hps167s_decode_reconnect_time(registers[0], registers[1], false);
        decode_setting(meaning, setting, value);
    }
    if (command->more != NULL) command->more(meaning, registers);
}

static void decode_known(decode_frame_t *frame, const model_t *model, const command_t *command,
                         const uint8_t *request)
{
    const bool is_response = frame->piece->direction == DECODE_RESPONSE;
    const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, command->source, "#%u %s", command->number, command->name);
    if (command->function != WRITE && count != command->registers) {
        decode_note(frame, "%s: #%u has %u registers, not %u; it refuses this", model->name, command->number,
                    command->registers, count);
        return;
    }
    if (command->function == WRITE) put_values(meaning, command, frame->bytes + DECODE_AT_VALUE);
    if (command->function == READ && is_response) put_values(meaning, command, frame->bytes + DECODE_AT_DATA);
    if (command->function == WRITE_MANY && !is_response)
        put_values(meaning, command, frame->bytes + DECODE_AT_MANY);
    if (command->address == FATHOM_HPS167S_RESET && !is_response)
        decode_note(frame, "%s: resets the device", model->name);
    if (command->address == FATHOM_HPS167S_LOAD &&
        decode_get16(frame->bytes + DECODE_AT_VALUE) == FATHOM_HPS167S_FACTORY)
        decode_note(frame, "%s: resets the device's settings", model->name);
}

/* A response whose request is not known. */
static void decode_unknown(decode_frame_t *frame, const model_t *model, const command_t *command)
{
    uint16_t registers[FATHOM_HPS167S_MAX_REGISTERS];
    if (2 * command->registers != frame->bytes[DECODE_AT_SIZE]) return;
    decode_registers(frame->bytes + DECODE_AT_DATA, registers, command->registers);
    if (!frame->is_sure && !command->is_likely(registers)) return;
    put_values(decode_mean(frame, model->name, command->source, "if #%u was asked: %s", command->number,
                           command->name),
               command, frame->bytes + DECODE_AT_DATA);
}

void hps167s_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request)
{
    for (size_t i = 0; i != sizeof commands / sizeof commands[0]; i++) {
        const command_t *const command = &commands[i];
        if (command->function != frame->bytes[DECODE_AT_FUNCTION]) continue;
        if (request == NULL)
            decode_unknown(frame, model, command);
        else if (decode_get16(request + DECODE_AT_FIRST) == command->address)
            decode_known(frame, model, command, request);
    }
}

/* HPS-167S table 39. */
const char *hps167s_exception_name(uint8_t code)
{
    static const char *const names[] = {[1] = "illegal function code",
                                        [2] = "illegal start address or register address",
                                        [3] = "illegal register count",
                                        [4] = "device operation failed"};
    return code < sizeof names / sizeof names[0] ? names[code] : NULL;
}

/*
 * A read of 0x0009 is command #6. The datasheet does not say what a read with another count, from a lower register or by
 * function 4 does, so each read that includes 0x0009 counts. #3 and #5 include it and are known to be harmless.
 */
const char *hps167s_read_changes(uint8_t function, uint16_t first, uint16_t count)
{
    const bool is_details = first == FATHOM_HPS167S_DETAILS && count == FATHOM_HPS167S_DETAILS_COUNT;
    const bool is_measurement_read =
        first == FATHOM_HPS167S_MEASUREMENT && count == FATHOM_HPS167S_MEASUREMENT_COUNT;
    if (function == READ && (is_details || is_measurement_read)) return NULL;
    if (first > FATHOM_HPS167S_RESET || (uint32_t)first + count <= FATHOM_HPS167S_RESET) return NULL;
    return "a read of 0x0009 resets an HPS-167S: address 1, 19200 8E1, warm-up and termination as from the "
           "factory";
}

/* ---- a scan: #1, #2 and #3 ---- */

/* The response of #2 has the shape of a measurement (#5), which may be unsolicited: so two have to agree, and to differ
 * from a measurement between them. */
static bool ask_configuration(inquiry_t *inquiry)
{
    enum { COUNT = FATHOM_HPS167S_CONFIGURATION_COUNT, READS = 3 };
    static const uint16_t reads[READS] = {FATHOM_HPS167S_CONFIGURATION, FATHOM_HPS167S_MEASUREMENT,
                                          FATHOM_HPS167S_CONFIGURATION};
    uint16_t values[READS][COUNT];
    for (uint8_t i = 0; i != READS; i++) {
        if (!inquiry->ask(inquiry, reads[i], COUNT, INQUIRY_MEASURE_US, 2)) return false;
        memcpy(values[i], inquiry->values, sizeof values[i]);
    }
    if (memcmp(values[0], values[2], sizeof values[0]) != 0 ||
        memcmp(values[0], values[1], sizeof values[0]) == 0 ||
        !fathom_hps167s_may_be_configuration(values[0]))
        return false;
    const bool is_on = fathom_hps167s_get_byte(values[0], FATHOM_HPS167S_TERMINATION_BYTE) != 0;
    (void)snprintf(inquiry->finding->termination, SETTING_TEXT, "%s", off_on[is_on]);
    return true;
}

static bool ask_details(inquiry_t *inquiry)
{
    scan_finding_t *const finding = inquiry->finding;
    if (!inquiry->ask(inquiry, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT, INQUIRY_MEASURE_US, 2) ||
        !fathom_hps167s_may_be_details(inquiry->values))
        return false;
    print_details(finding->sensor_version, inquiry->values);
    print_uuid(finding->uuid, inquiry->values);
    return true;
}

bool hps167s_identify(inquiry_t *inquiry)
{
    enum { NEXT_CENTURY = 2100 };
    fathom_hps167s_version_t version;
    if (inquiry->status == FATHOM_ERR_MALFORMED)
        (void)inquiry->ask(inquiry, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT, INQUIRY_MEASURE_US,
                           2);
    if (inquiry->status != FATHOM_OK) return false;
    fathom_hps167s_decode_version(inquiry->values, &version);
    const bool has_version = is_version(inquiry->values) && version.year < NEXT_CENTURY;
    if (has_version) print_version(inquiry->finding->interface_version, inquiry->values);
    const bool has_details = ask_details(inquiry);
    const bool has_configuration = ask_configuration(inquiry);
    return has_version && (has_details || has_configuration);
}

/* ---- a scan: a unit that speaks like an HPS-167 with a UART ---- */

/* A single frame can be chance. */
bool hps167s_is_alike(const uint8_t *bytes, uint16_t count)
{
    enum { LEAST_FRAMES = 2, LENGTH = FATHOM_HPS167_MEASUREMENT_LENGTH };
    unsigned frames = 0;
    for (uint16_t at = 0; at + LENGTH <= count;) {
        const bool is_frame = fathom_hps167_frame_length(bytes + at, LENGTH) == LENGTH &&
                              fathom_hps167_is_valid(bytes + at, LENGTH);
        frames += is_frame;
        at = (uint16_t)(at + (is_frame ? LENGTH : 1));
    }
    return frames >= LEAST_FRAMES;
}
