/* SPDX-License-Identifier: MIT */
#include "sensors/dyp.h"

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
    reader->dyp = base;
    reader->unit = &base->unit;
    reader->period_us = &base->unit.pace_us;
    return open_response(reader, &base->measurement, base->count, sensor);
}

/* ---- settings ---- */

fathom_status_t dyp_get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    uint16_t value = 0;
    const fathom_status_t status = fathom_dyp_modbus_get_register(reader->dyp, setting->read_at, &value);
    if (status != FATHOM_OK) return status;
    if (setting->moves && value > UINT8_MAX) return FATHOM_ERR_MALFORMED;
    return setting_print(setting, &value, text);
}

fathom_status_t dyp_set(reader_t *reader, const setting_t *setting, int32_t value)
{
    fathom_dyp_modbus_t *const dyp = reader->dyp;
    if (setting->moves && value == 0) return fathom_dyp_modbus_set_address_0(dyp);
    if (setting->moves) return fathom_dyp_modbus_set_address(dyp, (uint8_t)value);
    return setting->read_at != 0 ? fathom_dyp_modbus_set_register(dyp, setting->write_at, (uint16_t)value)
                                 : fathom_dyp_modbus_write_register(dyp, setting->write_at, (uint16_t)value);
}

void dyp_print_distance(char text[SETTING_TEXT], fathom_status_t status, const fathom_sample_t *sample)
{
    if (status != FATHOM_OK) return;
    if (sample->kind == FATHOM_TARGET)
        (void)snprintf(text, SETTING_TEXT, "%u", sample->distance_mm);
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
