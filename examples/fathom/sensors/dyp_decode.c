/* SPDX-License-Identifier: MIT */
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "sensors/dyp.h"

enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };
enum { PROBES = FATHOM_DYP_PROBES };

static const char *const probe_names[PROBES] = {"probe 1", "probe 2", "probe 3", "probe 4"};

/* ---- values ---- */

/* Returns true for a distance of the sensor and for the special values of its family. */
static bool is_likely_distance(const model_t *model, uint16_t value)
{
    return value <= model->max_mm || value == 0xFFFD || value == 0xFFFE;
}

static bool is_distance(const setting_t *setting) { return setting->unit != NULL && setting->set == NULL; }

/* The special values are not in the datasheets of A16 and A05, but in those of their family. */
static void put_distance(decode_meaning_t *meaning, const char *name, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, name, value, "mm");
    switch (value) {
    case 0:
        decode_remark(field, "unknown: no target, or something at the probe; see --means of fathom read");
        break;
    case 0xFFFD:
        decode_remark(field, "no target");
        break;
    case 0xFFFE:
        decode_remark(field, "no target: interference by another unit");
        break;
    case 0xFFFF:
        decode_remark(field, "refused: no distance, and no value of the family");
        break;
    default:
        break;
    }
}

static void put_value(decode_meaning_t *meaning, const setting_t *setting, uint16_t value)
{
    if (is_distance(setting))
        put_distance(meaning, setting->name, value);
    else
        decode_setting(meaning, setting, value);
}

static void put_probes(decode_meaning_t *meaning, uint8_t first, const uint16_t *values, uint8_t count)
{
    for (uint8_t i = 0; i != count; i++) put_distance(meaning, probe_names[first + i], values[i]);
}

/* ---- Modbus ---- */

/* The row of the distances of all probes, of a sensor that has several. */
static bool is_of_probes(const model_t *model, const setting_t *setting)
{
    return model->probes > 1 && setting->read_at == model->probe_registers[0];
}

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

static void guess_probes(decode_frame_t *frame, const model_t *model, const uint16_t *values, uint8_t count)
{
    for (uint8_t i = 0; i != count && !frame->is_sure; i++)
        if (!is_likely_distance(model, values[i])) return;
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, model->register_source,
                    count == 1 ? "if a probe was read" : "if %u probes were read", count);
    static const char *const names[PROBES] = {"first", "second", "third", "fourth"};
    for (uint8_t i = 0; i != count; i++) put_distance(meaning, count == 1 ? "distance" : names[i], values[i]);
}

/* The request is not known: prints each value that the response can be. */
static void guess(decode_frame_t *frame, const model_t *model)
{
    const uint8_t count = (uint8_t)(frame->bytes[DECODE_AT_SIZE] / 2);
    uint16_t values[PROBES];
    if (count == 0 || count > model->probes) return;
    for (uint8_t i = 0; i != count; i++) values[i] = decode_get16(frame->bytes + DECODE_AT_SIZE + 1 + 2 * i);
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++) {
        if (setting->read_at == 0) continue;
        const bool is_likely =
            is_distance(setting) ? is_likely_distance(model, values[0]) : setting_can_be(setting, values[0]);
        if (is_of_probes(model, setting))
            guess_probes(frame, model, values, count);
        else if (count == 1 && (frame->is_sure || is_likely))
            put_value(decode_mean(frame, model->name, model->register_source, "if 0x%04X was read: %s",
                                  setting->read_at, setting->name),
                      setting, values[0]);
    }
}

/* Returns true if the frame has values, and not the registers that they are in. */
static bool is_read_response(const decode_frame_t *frame)
{
    return frame->piece->direction == DECODE_RESPONSE && frame->bytes[DECODE_AT_FUNCTION] == READ;
}

static void explain_probes(decode_frame_t *frame, const model_t *model, uint8_t first, const uint8_t *request)
{
    const uint16_t count = decode_get16(request + DECODE_AT_COUNT);
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const char *const source = model->register_source;
    uint16_t values[PROBES];
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
    if (!is_read_response(frame)) return;
    for (uint8_t i = 0; i != count; i++) values[i] = decode_get16(frame->bytes + DECODE_AT_SIZE + 1 + 2 * i);
    put_probes(meaning, first, values, (uint8_t)count);
}

static void explain_read(decode_frame_t *frame, const model_t *model, const setting_t *setting,
                         const uint8_t *request)
{
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    decode_meaning_t *const meaning =
        decode_mean(frame, model->name, model->register_source, "0x%04X %s", address, setting->name);
    if (setting->read_at == 0) decode_note(frame, "%s: 0x%04X is write-only", model->name, address);
    if (decode_get16(request + DECODE_AT_COUNT) != 1)
        decode_note(frame, "%s: a read of several registers is not in its datasheet", model->name);
    if (is_read_response(frame)) put_value(meaning, setting, decode_get16(frame->bytes + DECODE_AT_SIZE + 1));
}

static void explain_write(decode_frame_t *frame, const model_t *model, const setting_t *setting)
{
    if (setting->write_at == 0)
        (void)decode_mean(frame, model->name, model->register_source, "0x%04X %s, which is read-only",
                          setting->read_at, setting->name);
    else
        put_value(decode_mean(frame, model->name, model->register_source, "set 0x%04X %s", setting->write_at,
                              setting->name),
                  setting, decode_get16(frame->bytes + DECODE_AT_VALUE));
}

void dyp_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request)
{
    const uint8_t function = frame->bytes[DECODE_AT_FUNCTION];
    if (request == NULL) guess(frame, model);
    if (request == NULL || (function != READ && function != WRITE)) return;
    const uint16_t address = decode_get16(request + DECODE_AT_FIRST);
    const uint8_t probe = probe_at(model, address);
    if (probe != PROBES && function == READ) explain_probes(frame, model, probe, request);
    for (const setting_t *setting = model->settings; probe == PROBES && setting->name != NULL; setting++) {
        if (address == 0 || (setting->read_at != address && setting->write_at != address)) continue;
        if (function == READ)
            explain_read(frame, model, setting, request);
        else
            explain_write(frame, model, setting);
    }
}

/* ---- frames with a sum ---- */

static void decode_stream(decode_frame_t *frame, const model_t *model)
{
    uint16_t values[PROBES];
    fathom_dyp_stream_decode(frame->bytes, values, model->probes);
    decode_meaning_t *const meaning = decode_mean(frame, model->name, model->stream_source, "measurement");
    if (model->probes == 1)
        put_distance(meaning, "distance", values[0]);
    else
        put_probes(meaning, 0, values, model->probes);
}

static void decode_set_address(decode_frame_t *frame, const model_t *model)
{
    decode_meaning_t *const meaning = decode_mean(frame, model->name, "A05 2(3)5", "set the address");
    decode_field_t *const field = decode_number(meaning, "address", frame->unit, "");
    if (frame->unit == 0 || frame->unit == FATHOM_DYP_ANY_ADDRESS)
        decode_remark(field, "not from 1 to %u", DYP_MAX_ADDRESS);
    frame->unit = -1; /* every unit that receives it */
    decode_note(frame, "it has no old address in it: every %s on the line obeys", model->name);
}

static void decode_dyp(decode_frame_t *frame, const model_t *model)
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
        uint16_t values[PROBES];
        fathom_dyp_55aa_decode(frame->bytes, values);
        put_probes(decode_mean(frame, model->name, source, "measurement"), first, values, count);
    }
}

void dyp_decode_sum(decode_frame_t *frame, const model_t *model)
{
    if (frame->piece->protocol == DECODE_DYP)
        decode_dyp(frame, model);
    else
        decode_stream(frame, model);
}
