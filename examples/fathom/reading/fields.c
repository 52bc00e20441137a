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
    {"utc", "", "Date and time; null if the clock was not set", FIELD_WORD, ROW, AT(utc)},
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
    const bool has_temperature =
        sensor->settings.temperature_us != 0 && (sensor->mode->takes & READER_TAKES_TEMPERATURE) != 0;
    const unsigned row = COLUMNS_ROW | COLUMNS_DISTANCE | (sensor->processing.has_level ? COLUMNS_LEVEL : 0);
    if (sensor->processing.has_alarm) return row | COLUMNS_ALARM;
    return row | COLUMNS_READING | (sensor->model->has_optics ? COLUMNS_OPTICS : 0) |
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
static row_t row_of(const reading_t *reading, char utc[UTC_TEXT])
{
    const sensor_t *const sensor = reading->sensor;
    const result_t *const result = reading->result;
    const fathom_sample_t *const sample = &result->sample;
    const reader_facts_t facts = reader_facts(sensor->reader);
    const bool is_good = reading->failure == NULL;
    const bool has_level = is_good && result->has_level;
    return (row_t){
        .sensor = sensor->name,
        .model = sensor->model->name,
        .mode = sensor->mode->name,
        .utc = utc_text(reading->utc_us, utc),
        .alarm = alarm_word(result->alarm),
        .status = reading_status(reading),
        .address = sensor->mode->has_address ? sample->address : NO_VALUE,
        .probe = sample->probe != 0 && reading_has_probe(reading) ? sample->probe : NO_VALUE,
        .sequence = is_good ? sample->sequence : NO_VALUE,
        .time_us = (int64_t)reading->time_us,
        .is_on = result->is_on,
        .interference = is_good ? sample->interference : NO_VALUE,
        .distance_mm = is_good && sample->kind == FATHOM_TARGET ? sample->distance_mm : NO_VALUE,
        .raw = is_good ? sample->raw : NO_VALUE,
        .magnitude = is_good ? sample->magnitude : NO_VALUE,
        .ambient = is_good ? sample->ambient : NO_VALUE,
        .precision = is_good ? sample->precision : NO_VALUE,
        .temperature_dc = is_good && facts.has_temperature ? facts.temperature_dc : NO_VALUE,
        .level_mm = has_level ? result->level.level_mm : NO_VALUE,
        .level_per_mille = has_level ? result->level.per_mille : NO_VALUE,
        .volume = has_level ? result->level.volume : NO_VALUE,
    };
}

void reading_json(json_t *json, const reading_t *reading, unsigned columns)
{
    char utc[UTC_TEXT];
    const row_t row = row_of(reading, utc);
    record_json(json, fields, &row, columns);
}

void reading_json_line(FILE *to, const reading_t *reading)
{
    char utc[UTC_TEXT];
    const row_t row = row_of(reading, utc);
    record_json_line(to, fields, &row, sensor_columns(reading->sensor));
}

void reading_csv_header(FILE *to, unsigned columns) { record_csv(to, fields, NULL, columns, columns); }

void reading_csv(FILE *to, const reading_t *reading, unsigned columns)
{
    char utc[UTC_TEXT];
    const row_t row = row_of(reading, utc);
    record_csv(to, fields, &row, sensor_columns(reading->sensor), columns);
}

void reading_help(FILE *to)
{
    (void)fputs("\nFields of json and csv, in this order; null is empty in csv:\n\n", to);
    record_help(to, fields);
    (void)fputs("\nWords of 'status', for a reading or a failed attempt:\n\n", to);
    status_words_help(to);
}
