/* SPDX-License-Identifier: MIT */
#include "reading/fields.h"

#include "diagnosis/counters.h"
#include "output/words.h"

typedef struct {
    const char *sensor, *model, *mode, *utc, *alarm, *status;
    int64_t address, probe, sequence, time_us, is_on, interference, distance_mm, raw;
    int64_t magnitude, ambient, precision, temperature_dc, level_mm, level_per_mille, volume;
} row_t;

#define AT(member) offsetof(row_t, member)
enum {
    ROW = COLUMNS_ROW,
    SAMPLE = COLUMNS_ROW | COLUMNS_READING,
    OPTICS = COLUMNS_OPTICS,
    TEMPERATURE = COLUMNS_TEMPERATURE,
    LEVEL = COLUMNS_LEVEL
};
static const field_t fields[] = {
    {"name", "", "Name of the sensor; a16:1 unless the user chose one", FIELD_WORD, ROW, AT(sensor)},
    {"model", "", "Model of the sensor: a16, a05 or hps167s", FIELD_WORD, ROW, AT(model)},
    {"mode", "", "Mode in which the sensor is read", FIELD_WORD, ROW, AT(mode)},
    {"address", "", "Address; null in a mode without addresses", FIELD_NUMBER, ROW, AT(address)},
    {"probe", "", "Probe, from 1; null if a failure concerns all probes", FIELD_NUMBER, ROW, AT(probe)},
    {"sequence", "", "Number of the response, the same for all its probes", FIELD_NUMBER, SAMPLE,
     AT(sequence)},
    {"time_us", "us", "Time since the start of the program", FIELD_NUMBER, ROW, AT(time_us)},
    {"utc", "", "Date and time of the reading", FIELD_WORD, 0, AT(utc)},
    {"alarm", "", "State of the alarm: on, off, unknown or no_response", FIELD_WORD, COLUMNS_ALARM,
     AT(alarm)},
    {"is_on", "", "Whether the alarm is on, also if it is unknown", FIELD_FLAG, COLUMNS_ALARM, AT(is_on)},
    {"status", "", "Kind of the reading or of the failure", FIELD_WORD, COLUMNS_READING, AT(status)},
    {"interference", "", "Whether interference hides the target", FIELD_FLAG, SAMPLE, AT(interference)},
    {"distance_mm", "mm", "Distance; null unless status is target", FIELD_NUMBER, COLUMNS_DISTANCE,
     AT(distance_mm)},
    {"raw", "", "Value that the sensor sent", FIELD_NUMBER, SAMPLE, AT(raw)},
    {"magnitude", "", "Strength of the reflected light (hps167s)", FIELD_TEN_THOUSANDTHS, OPTICS,
     AT(magnitude)},
    {"ambient", "", "Ambient infrared light (hps167s)", FIELD_NUMBER, OPTICS, AT(ambient)},
    {"precision", "", "Precision; less is better (hps167s)", FIELD_NUMBER, OPTICS, AT(precision)},
    {"temperature_degc", "degC", "Temperature; null if older than three periods", FIELD_TENTHS, TEMPERATURE,
     AT(temperature_dc)},
    {"level_mm", "mm", "Level in the tank", FIELD_NUMBER, LEVEL, AT(level_mm)},
    {"level_per_mille", "1/1000", "Level as a part of the height", FIELD_NUMBER, LEVEL, AT(level_per_mille)},
    {"volume", "", "Volume in the unit of the capacity", FIELD_NUMBER, LEVEL, AT(volume)},
    {.key = NULL},
};
#undef AT

unsigned sensor_columns(const sensor_t *sensor)
{
    const results_config_t *const processing = &sensor->processing;
    const unsigned row = COLUMNS_ROW | COLUMNS_DISTANCE | (processing->has_level ? COLUMNS_LEVEL : 0);
    if (processing->has_alarm) return COLUMNS_ALARM | row;
    const bool has_temperature =
        sensor->settings.temperature_us != 0 && (sensor->mode->takes & READER_TAKES_TEMPERATURE) != 0;
    return COLUMNS_READING | row | (sensor->model->has_optics ? COLUMNS_OPTICS : 0) |
           (has_temperature ? COLUMNS_TEMPERATURE : 0);
}

bool reading_has_probe(const reading_t *reading)
{
    return !sensor_is_contact(reading->sensor) || reading->sensor->model->probes == 1;
}

const char *reading_status(const reading_t *reading)
{
    return reading->failure != NULL ? reading->failure
                                    : status_word(reading->sensor->mode, reading->result->sample.kind);
}

/* Values of a failed attempt are null. */
static void fill_sample(row_t *row, const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const bool is_good = reading->failure == NULL;
    const reader_facts_t facts = reader_facts(reading->sensor->reader);
    row->sequence = is_good ? sample->sequence : NO_VALUE;
    row->interference = is_good ? sample->interference : NO_VALUE;
    row->distance_mm = is_good && sample->kind == FATHOM_TARGET ? sample->distance_mm : NO_VALUE;
    row->raw = is_good ? sample->raw : NO_VALUE;
    row->magnitude = is_good ? sample->magnitude : NO_VALUE;
    row->ambient = is_good ? sample->ambient : NO_VALUE;
    row->precision = is_good ? sample->precision : NO_VALUE;
    row->temperature_dc = is_good && facts.has_temperature ? facts.temperature_dc : NO_VALUE;
}

static void fill(row_t *row, const reading_t *reading, char utc[UTC_TEXT])
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const result_t *const result = reading->result;
    const bool has_level = reading->failure == NULL && result->has_level;
    row->sensor = reading->sensor->name;
    row->model = reading->sensor->model->name;
    row->mode = reading->sensor->mode->name;
    row->utc = utc_text(reading->utc_us, utc);
    row->alarm = alarm_word(result->alarm);
    row->status = reading_status(reading);
    row->address = reading->sensor->mode->has_address ? sample->address : NO_VALUE;
    row->probe = sample->probe != 0 && reading_has_probe(reading) ? sample->probe : NO_VALUE;
    row->time_us = (int64_t)reading->time_us;
    row->is_on = result->is_on;
    row->level_mm = has_level ? result->level.level_mm : NO_VALUE;
    row->level_per_mille = has_level ? result->level.per_mille : NO_VALUE;
    row->volume = has_level ? result->level.volume : NO_VALUE;
    fill_sample(row, reading);
}

void reading_json(json_t *json, const reading_t *reading, unsigned columns)
{
    char utc[UTC_TEXT];
    row_t row;
    fill(&row, reading, utc);
    record_json(json, fields, &row, columns);
}

void reading_json_line(FILE *to, const reading_t *reading)
{
    char utc[UTC_TEXT];
    row_t row;
    fill(&row, reading, utc);
    record_json_line(to, fields, &row, sensor_columns(reading->sensor));
}

void reading_csv_header(FILE *to, unsigned columns) { record_csv(to, fields, NULL, columns, columns); }

void reading_csv(FILE *to, const reading_t *reading, unsigned columns)
{
    char utc[UTC_TEXT];
    row_t row;
    fill(&row, reading, utc);
    record_csv(to, fields, &row, sensor_columns(reading->sensor), columns);
}

void reading_help(FILE *to)
{
    (void)fputs("\nFields of json and csv, in this order; null is empty in csv:\n\n", to);
    record_help(to, fields);
    (void)fputs("\nWords of 'status', for a reading or a failed attempt:\n\n", to);
    status_words_help(to);
}
