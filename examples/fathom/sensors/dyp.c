/* SPDX-License-Identifier: MIT */
#include "sensors/dyp.h"

#include <inttypes.h>

#include "fathom/codec/modbus_rtu.h"

/* ---- reading ---- */

static bool open_response(reader_t *reader, fathom_dyp_measurement_t *measurement, uint8_t count,
                          fathom_sensor_t sensor)
{
    reader->sensor = sensor;
    reader->values = measurement->values;
    reader->value_count = count;
    reader->response = measurement;
    reader->window = &measurement->window;
    reader->sequence = &measurement->sequence;
    return true;
}

bool dyp_open_stream(reader_t *reader, fathom_dyp_auto_t *base, fathom_sensor_t sensor)
{
    reader->frames = base->stream.counters;
    return open_response(reader, &base->measurement, (uint8_t)(base->stream.length / 2 - 1), sensor);
}

bool dyp_open_asked(reader_t *reader, fathom_dyp_modbus_t *base, fathom_sensor_t sensor)
{
    reader->unit = &base->unit;
    reader->period_us = &base->unit.pace_us;
    return open_response(reader, &base->measurement, base->count, sensor);
}

/* ---- settings ---- */

void dyp_put_number(char text[SETTING_TEXT], fathom_status_t status, uint32_t number)
{
    if (status == FATHOM_OK) (void)snprintf(text, SETTING_TEXT, "%" PRIu32, number);
}

void dyp_put_distance(char text[SETTING_TEXT], fathom_status_t status, const fathom_sample_t *sample)
{
    if (status != FATHOM_OK) return;
    if (sample->kind == FATHOM_TARGET)
        dyp_put_number(text, status, sample->distance_mm);
    else if (sample->kind == FATHOM_NO_TARGET)
        (void)snprintf(text, SETTING_TEXT, "%s", sample->interference ? "interference" : "no_target");
    else
        (void)snprintf(text, SETTING_TEXT, "unknown value %u", (unsigned)sample->raw);
}

/* ---- scan ---- */

/* FFFD and FFFE are not in the datasheets of A16 and A05, but in those of their family. */
void dyp_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts)
{
    const uint16_t value = finding->value;
    const bool is_target = value != 0 && value <= model->max_mm;
    if (!finding->has_value) return;
    facts->raw = value;
    if (is_target) facts->distance_mm = value;
    facts->status = is_target ? "target" : value == 0xFFFD || value == 0xFFFE ? "no_target" : "unknown";
}

/* ---- decoding ---- */

bool dyp_is_read_response(const decode_frame_t *frame)
{
    return frame->piece->direction == DECODE_RESPONSE &&
           frame->bytes[DECODE_AT_FUNCTION] == FATHOM_MODBUS_READ_HOLDING_REGISTERS;
}

bool dyp_is_likely(uint16_t value, uint16_t far_mm)
{
    return value <= far_mm || value == 0xFFFD || value == 0xFFFE;
}

void dyp_decode_distance(decode_meaning_t *meaning, const char *name, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, name, value, "mm");
    switch (value) { /* not in the datasheets of A16 and A05, but in those of their family */
    case 0:
        field->note = "unknown: no target, or something at the probe; --means of fathom read says which";
        break;
    case 0xFFFD:
        field->note = "no target";
        break;
    case 0xFFFE:
        field->note = "no target: interference by another unit";
        break;
    case 0xFFFF:
        field->note = "refused: no distance, and no value of the family";
        break;
    default:
        break;
    }
}

void dyp_decode_address(decode_meaning_t *meaning, uint16_t value)
{
    decode_field_t *const field = decode_number(meaning, "address", value, "");
    if (value > DYP_MAX_ADDRESS) field->note = "not from 0 to 254";
}
