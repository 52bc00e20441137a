/* SPDX-License-Identifier: MIT */
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "fathom/sensor/a16_rs232.h"
#include "sensors/decoding.h"
#include "sensors/driver.h"

/* The registers of the sensors of DYP (A16 6(3), A05 3(3)), their frames, and what these mean. */

enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };
enum { PROBES = FATHOM_DYP_PROBES };

/* ---- the meaning of a value ---- */

/* The special values are not in the datasheets of A16 and A05, but in those of their family. */
enum { NO_TARGET = 0xFFFD, INTERFERENCE = 0xFFFE, REFUSED = 0xFFFF };

static bool is_likely_distance(const model_t *model, uint16_t value)
{
    return value <= model->max_mm || value == NO_TARGET || value == INTERFERENCE;
}

const char *model_value_status(const model_t *model, uint16_t value, int64_t *distance_mm)
{
    const bool is_target = value != 0 && value <= model->max_mm;
    *distance_mm = is_target ? value : NO_VALUE;
    if (is_target) return "target";
    return value == NO_TARGET || value == INTERFERENCE ? "no_target" : "unknown";
}

static const char *note_distance(int64_t value)
{
    switch (value) {
    case 0:
        return "unknown: no target, or something at the probe; see --means of fathom read";
    case NO_TARGET:
        return "no target";
    case INTERFERENCE:
        return "no target: interference by another unit";
    case REFUSED:
        return "refused: no distance, and no value of the family";
    default:
        return NULL;
    }
}

/* ---- the settings ---- */

#define EFFECT     "at once; whether it is kept over power-off is not in the datasheet"
#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

const setting_t a16_settings[] = {
    {"address", "Modbus address (register 0x0200)", .read_at = DYP_ADDRESS, .write_at = DYP_ADDRESS,
     .effect = EFFECT, .least = 1, .most = DYP_MAX_ADDRESS, .has_zero = true, .moves = true,
     .is_never_blind = true},
    {"operating-mode", "the register alone (0x0202); automatic-output restarts the automatic output",
     SETTING_PRESENT, .write_at = FATHOM_A16_REGISTER_OPERATING_MODE,
     .words = WORDS("controlled", "automatic"),
     .effect = "at once; not kept over power-off. Any further command stops the automatic output again"},
    {"automatic-output", "RS232 variant: restarts the output that a Modbus command has stopped (0x0202)",
     SETTING_PRESENT, .words = WORDS("on"), .effect = "at once; any further Modbus command stops it again",
     .confirmed = "frames are received",
     .unconfirmed = "no frame was received in 10 s; only the RS232 variant sends automatically"},
    {"switch-polarity", "switch variant: the level when something is nearer than the threshold (0x0205)",
     .read_at = FATHOM_A16_REGISTER_SWITCH_POLARITY, .write_at = FATHOM_A16_REGISTER_SWITCH_POLARITY,
     .is_of_variant = true, .effect = EFFECT, .words = WORDS("negative", "positive")},
    {"switch-threshold", "switch variant: the distance at which it switches (0x0206)",
     .read_at = FATHOM_A16_REGISTER_SWITCH_THRESHOLD, .write_at = FATHOM_A16_REGISTER_SWITCH_THRESHOLD,
     .is_of_variant = true, .unit = "mm", .effect = EFFECT, .least = 1, .most = FATHOM_A16_MAX_MM},
    {"automatic-value", "RS232 variant: the distance that the automatic output sends (0x0207)",
     .read_at = FATHOM_A16_REGISTER_AUTOMATIC_VALUE, .write_at = FATHOM_A16_REGISTER_AUTOMATIC_VALUE,
     .is_of_variant = true, .effect = EFFECT, .words = WORDS("processed", "real-time")},
    {"distance", "the processed distance (0x0100)", SETTING_PRESENT, .read_at = FATHOM_A16_REGISTER_PROCESSED,
     .unit = "mm", .note = note_distance},
    {"real-time-distance", "the newest measurement (0x0101)", SETTING_PRESENT,
     .read_at = FATHOM_A16_REGISTER_REAL_TIME, .unit = "mm", .note = note_distance},
    {.name = NULL},
};

const setting_t a05_settings[] = {
    {"address", "Modbus address (register 0x0200), also of 55 AA", .read_at = DYP_ADDRESS,
     .write_at = DYP_ADDRESS, .effect = EFFECT, .least = 1, .most = DYP_MAX_ADDRESS, .has_zero = true,
     .moves = true, .is_never_blind = true},
    {"every-address", "the same by 55 AA 03, which EVERY A05 on the line obeys; with --mode dyp",
     SETTING_PRESENT, .mode = "dyp", .effect = EFFECT, .least = 1, .most = DYP_MAX_ADDRESS, .moves = true,
     .is_never_blind = true},
    {"distances", "of the four probes (0x0106 to 0x0109)", SETTING_PRESENT, .read_at = FATHOM_A05_REGISTERS,
     .unit = "mm", .note = note_distance},
    {.name = NULL},
};

static bool is_distance(const setting_t *setting) { return setting->unit != NULL && setting->effect == NULL; }

/* ---- reading a setting ---- */

static fathom_status_t get_register(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    uint16_t value = 0;
    const fathom_status_t status = fathom_dyp_modbus_get_register(reader->dyp, setting->read_at, &value);
    if (status != FATHOM_OK) return status;
    if (setting->moves && value > UINT8_MAX) return FATHOM_ERR_MALFORMED;
    return setting_print(setting, &value, text);
}

static void print_sample(char text[SETTING_TEXT], const fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_TARGET)
        (void)snprintf(text, SETTING_TEXT, "%u", sample->distance_mm);
    else if (sample->kind == FATHOM_NO_TARGET)
        (void)snprintf(text, SETTING_TEXT, "%s", sample->interference ? "interference" : "no_target");
    else
        (void)snprintf(text, SETTING_TEXT, "unknown value %u", (unsigned)sample->raw);
}

fathom_status_t a16_get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    if (!is_distance(setting)) return get_register(reader, setting, text);
    const bool is_real_time = setting->read_at == FATHOM_A16_REGISTER_REAL_TIME;
    fathom_sample_t sample;
    const fathom_status_t status = fathom_a16_modbus_measure(
        &reader->driver.a16_modbus, is_real_time ? FATHOM_REAL_TIME : FATHOM_PROCESSED, &sample);
    if (status == FATHOM_OK) print_sample(text, &sample);
    return status;
}

/* All probes in one text: the samples of one response. */
fathom_status_t a05_get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    if (!is_distance(setting)) return get_register(reader, setting, text);
    fathom_sample_t sample;
    fathom_status_t status = reader_poll(reader, &sample);
    if (status == FATHOM_PENDING || (status < 0 && status != FATHOM_ERR_MALFORMED)) return status;
    for (size_t length = 0; length < SETTING_TEXT; status = reader_poll(reader, &sample)) {
        char one[SETTING_TEXT] = "no distance";
        if (status == FATHOM_OK) print_sample(one, &sample);
        length +=
            (size_t)snprintf(text + length, SETTING_TEXT - length, "%s%s", length != 0 ? ", " : "", one);
        if (!reader_has_more(reader)) break;
    }
    return FATHOM_OK;
}

/* ---- writing a setting ---- */

static fathom_status_t set_register(reader_t *reader, const setting_t *setting, int32_t value)
{
    fathom_dyp_modbus_t *const dyp = reader->dyp;
    if (setting->moves && value == 0) return fathom_dyp_modbus_set_address_0(dyp);
    if (setting->moves) return fathom_dyp_modbus_set_address(dyp, (uint8_t)value);
    return setting->read_at != 0 ? fathom_dyp_modbus_set_register(dyp, setting->write_at, (uint16_t)value)
                                 : fathom_dyp_modbus_write_register(dyp, setting->write_at, (uint16_t)value);
}

/* The first frame of the automatic output is the result. */
static fathom_status_t restart_automatic_output(reader_t *reader)
{
    static fathom_a16_auto_t automatic;
    static fathom_a16_rs232_t rs232;
    static bool is_started;
    fathom_sample_t sample;
    if (!is_started) {
        const fathom_a16_auto_config_t config = {.gap_us = PORT_STREAM_GAP_US};
        if (fathom_a16_auto_init(&automatic, reader->line, &config) != FATHOM_OK) return FATHOM_ERR_ARGUMENT;
        fathom_a16_rs232_init(&rs232, &reader->driver.a16_modbus, &automatic);
    }
    const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&rs232, &sample);
    is_started = status == FATHOM_PENDING;
    return status;
}

fathom_status_t a16_set(reader_t *reader, const setting_t *setting, int32_t value)
{
    return setting->write_at != 0 ? set_register(reader, setting, value) : restart_automatic_output(reader);
}

fathom_status_t a05_set(reader_t *reader, const setting_t *setting, int32_t value)
{
    return setting->write_at != 0 ? set_register(reader, setting, value)
                                  : fathom_a05_dyp_broadcast_address(&reader->driver.a05_dyp, (uint8_t)value);
}

/* ---- a scan: is it of the family? ---- */

/* FFFB to FFFF and 0 are values for no distance (src/models). The shortest distance of all known modules is
 * the 15 mm of an L07AYYUW (ESPHome pull request 12761). */
enum { LEAST_CODE = 0xFFFB, LEAST_MM = 15 };

/* Devices of others that respond at 0x0100 and 0x0101, and their values there. */
static const struct {
    const char *what;
    uint16_t least[2], most[2]; /* of 0x0100 and 0x0101 */
    bool has_address;           /* 0x0100 is its address */
    bool is_no_distance;        /* no sensor of the family sends both values */
} others[] = {
    /* Public notes on an ES-SM-TH-01: address 1, code 2 for 9600 baud. A code is less than any distance. */
    {"probably a soil probe: 0x0100 is its address, and 0x0101 can be its baud code",
     {0, 0},
     {254, LEAST_MM - 1},
     true,
     true},
    /* Public descriptor of a DH AG-95: 1 starts it, and its force is 20 to 100 percent. */
    {"probably a gripper: 0x0100 can be its start, and 0x0101 its force in percent",
     {0, 20},
     {1, 100},
     false,
     true},
    /* Registers of a Renogy Rover: percent and tenths of a volt. An empty battery of 12 V has 9 V, a full one of 48 V 60. */
    {"perhaps a solar charger: 0x0100 can be a charge in percent, and 0x0101 a voltage",
     {0, 90},
     {100, 600},
     false,
     false},
};

/* Returns what sends these values; NULL: not known. */
static const char *other_of(uint8_t address, uint16_t first, uint16_t second, bool is_no_distance)
{
    for (size_t i = 0; i != sizeof others / sizeof others[0]; i++)
        if (first >= others[i].least[0] && first <= others[i].most[0] && second >= others[i].least[1] &&
            second <= others[i].most[1] && (first == address || !others[i].has_address) &&
            (others[i].is_no_distance || !is_no_distance))
            return others[i].what;
    return NULL;
}

static bool can_be_sent(uint16_t max_mm, uint16_t value)
{
    return value == 0 || value >= LEAST_CODE || (value >= LEAST_MM && value <= max_mm);
}

/* Returns true if one scene can have both values: no distance, or distances that differ by a quarter at most. No source has
 * a limit; the datasheet's examples are 754 and 751 mm. A pair that does not agree costs the word "probably" alone. 0 and
 * FFFF are also what other devices send for a register that they do not use. */
static bool agrees(uint16_t max_mm, uint16_t one, uint16_t other)
{
    const uint32_t longer = one > other ? one : other;
    const uint32_t shorter = one > other ? other : one;
    if (!can_be_sent(max_mm, one) || !can_be_sent(max_mm, other)) return false;
    if (shorter >= LEAST_CODE) return shorter != UINT16_MAX;
    return shorter != 0 && longer < LEAST_CODE && 4 * (longer - shorter) <= longer;
}

void models_name_other(inquiry_t *inquiry)
{
    scan_finding_t *const finding = inquiry->finding;
    if (!inquiry->ask(inquiry, FATHOM_A16_REGISTER_PROCESSED, 1, INQUIRY_MEASURE_US, 1)) return;
    const uint16_t first = inquiry->values[0];
    finding->perhaps =
        "perhaps a fuel gauge (TENET UL212), a gripper, a charger, or a relative without an address "
        "register (djlk-003ab): all respond at 0x0100";
    if (!inquiry->ask(inquiry, FATHOM_A16_REGISTER_REAL_TIME, 1, INQUIRY_MEASURE_US, 1)) return;
    const char *const other = other_of(finding->address, first, inquiry->values[0], false);
    if (other != NULL)
        finding->perhaps = other;
    else if (agrees(FATHOM_A16_MAX_MM, first, inquiry->values[0]))
        finding->perhaps =
            "probably a relative without an address register: 0x0100 and 0x0101 have one distance";
}

/* The device has its address in 0x0200 and a register of the model. It is certain if it also answered at address 255, or if
 * two registers have the same distance. It is none if it has the values of another device. */
bool dyp_confirm(inquiry_t *inquiry, const model_t *model)
{
    scan_finding_t *const finding = inquiry->finding;
    const uint16_t second = model->scan.second;
    if (finding->is_certain) return true;
    if (inquiry->own == second || !inquiry->ask(inquiry, second, 1, INQUIRY_SLOW_US, 1)) return true;
    const uint16_t value = inquiry->values[0];
    if (second == FATHOM_A16_REGISTER_PROCESSED)
        finding->perhaps = other_of(finding->address, value, finding->value, true);
    finding->is_certain = agrees(model->max_mm, value, finding->value);
    return finding->perhaps == NULL;
}

/* ---- decoding: values ---- */

static const char *const probe_names[PROBES] = {"probe 1", "probe 2", "probe 3", "probe 4"};
static const char *const only_name[] = {"distance"};

static void put_distances(decode_meaning_t *meaning, const char *const *names, const uint16_t *distances,
                          uint8_t count)
{
    for (uint8_t i = 0; i != count; i++) {
        const setting_t distance = {.name = names[i], .unit = "mm", .note = note_distance};
        decode_setting(meaning, &distance, distances[i]);
    }
}

/* ---- Modbus: a response whose request is not known ---- */

static void guess_probes(decode_frame_t *frame, const model_t *model, const uint16_t *distances,
                         uint8_t count)
{
    static const char *const names[PROBES] = {"first", "second", "third", "fourth"};
    for (uint8_t i = 0; i != count && !frame->is_sure; i++)
        if (!is_likely_distance(model, distances[i])) return;
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, model->register_source,
                    count == 1 ? "if a probe was read" : "if %u probes were read", count);
    put_distances(meaning, count == 1 ? only_name : names, distances, count);
}

/* Adds each value that the response can be. */
static void guess(decode_frame_t *frame, const model_t *model)
{
    const uint8_t count = (uint8_t)(frame->bytes[DECODE_AT_SIZE] / 2);
    uint16_t registers[PROBES];
    if (count == 0 || count > model->probes) return;
    decode_registers(frame->bytes + DECODE_AT_DATA, registers, count);
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++) {
        if (setting->read_at == 0) continue;
        const bool is_likely = is_distance(setting) ? is_likely_distance(model, registers[0])
                                                    : setting_can_be(setting, registers[0]);
        if (setting->read_at == model->probe_registers[0])
            guess_probes(frame, model, registers, count);
        else if (count == 1 && (frame->is_sure || is_likely))
            decode_setting(decode_mean(frame, model->name, model->register_source, "if 0x%04X was read: %s",
                                       setting->read_at, setting->name),
                           setting, registers[0]);
    }
}

/* ---- Modbus: a request, and a response to a known request ---- */

/* Returns the probe of a register, from 0 on; PROBES: none. */
static uint8_t probe_at(const model_t *model, uint16_t address)
{
    for (unsigned i = 0; i != MODEL_PROBE_REGISTERS; i++) {
        const uint16_t first = model->probe_registers[i];
        if (first != 0 && address >= first && address < first + model->probes)
            return (uint8_t)(address - first);
    }
    return PROBES;
}

static void explain_probes(decode_frame_t *frame, const model_t *model, uint8_t first, const uint8_t *request)
{
    const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const char *const source = model->register_source;
    uint16_t distances[PROBES];
    if (count == 0 || count > model->probes - first) {
        (void)decode_mean(frame, model->name, source, "0x%04X is %s; a read must not go past the last probe",
                          address, probe_names[first]);
        return;
    }
    decode_meaning_t *const meaning =
        count == 1
            ? decode_mean(frame, model->name, source, "0x%04X distance of %s", address, probe_names[first])
            : decode_mean(frame, model->name, source, "0x%04X distances of probes %u to %u", address,
                          first + 1u, first + (unsigned)count);
    if (frame->piece->direction != DECODE_RESPONSE) return;
    decode_registers(frame->bytes + DECODE_AT_DATA, distances, (uint8_t)count);
    put_distances(meaning, probe_names + first, distances, (uint8_t)count);
}

static void explain(decode_frame_t *frame, const model_t *model, const setting_t *setting,
                    const uint8_t *request)
{
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const bool is_read = frame->bytes[DECODE_AT_FUNCTION] == READ;
    const bool is_set = !is_read && setting->write_at != 0;
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, model->register_source, "%s0x%04X %s%s", is_set ? "set " : "",
                    address, setting->name, is_read || is_set ? "" : ", which is read-only");
    if (is_set) decode_setting(meaning, setting, decode_get16(frame->bytes + DECODE_AT_VALUE));
    if (!is_read) return;
    if (setting->read_at == 0) decode_note(frame, "%s: 0x%04X is write-only", model->name, address);
    if (decode_get16(request + DECODE_AT_COUNT) != 1)
        decode_note(frame, "%s: a read of several registers is not in its datasheet", model->name);
    if (frame->piece->direction == DECODE_RESPONSE)
        decode_setting(meaning, setting, decode_get16(frame->bytes + DECODE_AT_DATA));
}

void dyp_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request)
{
    const uint8_t function = frame->bytes[DECODE_AT_FUNCTION];
    if (request == NULL) guess(frame, model);
    if (request == NULL || (function != READ && function != WRITE)) return;
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const uint8_t probe = probe_at(model, address);
    if (probe != PROBES && function == READ) explain_probes(frame, model, probe, request);
    for (const setting_t *setting = model->settings; probe == PROBES && setting->name != NULL; setting++)
        if (address != 0 && (setting->read_at == address || setting->write_at == address))
            explain(frame, model, setting, request);
}

/* ---- frames with a sum ---- */

static void decode_stream(decode_frame_t *frame, const model_t *model)
{
    uint16_t distances[PROBES];
    fathom_dyp_stream_decode(frame->bytes, distances, model->probes);
    decode_meaning_t *const meaning = decode_mean(frame, model->name, model->stream_source, "measurement");
    put_distances(meaning, model->probes == 1 ? only_name : probe_names, distances, model->probes);
}

static void decode_set_address(decode_frame_t *frame, const model_t *model)
{
    static const setting_t address = {.name = "address", .least = 1, .most = DYP_MAX_ADDRESS};
    decode_setting(decode_mean(frame, model->name, "A05 2(3)5", "set the address"), &address, frame->unit);
    frame->unit = -1; /* every unit that receives it */
    decode_note(frame, "it has no old address in it: every %s on the line obeys", model->name);
}

static void decode_55aa(decode_frame_t *frame, const model_t *model)
{
    const uint8_t command = frame->bytes[3];
    const uint8_t count = fathom_dyp_55aa_value_count(command);
    const uint8_t first = count == 1 ? (uint8_t)(command - FATHOM_DYP_FIRST_PROBE) : 0;
    const char *const source = count == 1 ? "A05 2(3)4" : "A05 2(3)3";
    frame->unit = frame->bytes[2];
    frame->code = command;
    frame->code_is = "command";
    if (frame->unit == FATHOM_DYP_ANY_ADDRESS && command != FATHOM_DYP_SET_ADDRESS)
        decode_note(frame, "FF is the broadcast address; whether a unit answers it is not in the datasheet");
    if (command == FATHOM_DYP_SET_ADDRESS) {
        decode_set_address(frame, model);
    } else if (count == 0) {
        (void)decode_mean(frame, model->name, "A05 2(3)2", "unknown command");
    } else if (frame->piece->direction != DECODE_RESPONSE) {
        (void)decode_mean(frame, model->name, source, "measure with %s",
                          count == 1 ? probe_names[first] : "all probes");
    } else {
        uint16_t distances[PROBES];
        fathom_dyp_55aa_decode(frame->bytes, distances);
        put_distances(decode_mean(frame, model->name, source, "measurement"), probe_names + first, distances,
                      count);
    }
}

void dyp_decode_sum(decode_frame_t *frame, const model_t *model)
{
    if (frame->piece->protocol == DECODE_DYP)
        decode_55aa(frame, model);
    else
        decode_stream(frame, model);
}
