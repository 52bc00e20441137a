/* SPDX-License-Identifier: MIT */
#include "read/output.h"

#include <inttypes.h>
#include <string.h>

#include "shared/command.h"
#include "shared/options.h"
#include "shared/timestamp.h"

/* ---- JSON and CSV: the same fields in the same order ---- */

enum { VALUE_TEXT = 48 };

typedef struct {
    const char *name;
    bool is_string;                                                  /* quoted in JSON */
    uint8_t needs;                                                   /* COLUMNS_...; 0: it is always there */
    void (*format)(const reading_t *reading, char text[VALUE_TEXT]); /* leaves text empty for null */
} field_t;

static const char *status_name(const fathom_sample_t *sample)
{
    switch (sample->kind) {
    case FATHOM_TARGET:
        return "target";
    case FATHOM_NO_TARGET:
        return "no_target";
    case FATHOM_NEAR:
        return "too_near";
    case FATHOM_UNKNOWN:
        return "unknown";
    default:
        return "fault";
    }
}

static void put_number(char text[VALUE_TEXT], uint64_t number)
{
    (void)snprintf(text, VALUE_TEXT, "%" PRIu64, number);
}

static void put_string(char text[VALUE_TEXT], const char *string)
{
    (void)snprintf(text, VALUE_TEXT, "%s", string);
}

static void put_sensor(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->model->name);
}

static void put_mode(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->mode->name);
}

static void put_address(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->mode->has_address) put_number(text, reading->sample->address);
}

static void put_probe(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->probe);
}

static void put_sequence(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->sequence);
}

static void put_time(const reading_t *reading, char text[VALUE_TEXT]) { put_number(text, reading->time_us); }

static void put_utc(const reading_t *reading, char text[VALUE_TEXT])
{
    (void)utc_text(reading->utc_us, text);
}

static void put_status(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, status_name(reading->sample));
}

static void put_interference(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->sample->interference ? "true" : "false");
}

static void put_distance(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->sample->kind == FATHOM_TARGET) put_number(text, reading->sample->distance_mm);
}

static void put_raw(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->raw);
}

/* The sample has it times 10000, so four decimals are all of it. */
static void put_magnitude(const reading_t *reading, char text[VALUE_TEXT])
{
    const uint32_t magnitude = reading->sample->magnitude;
    (void)snprintf(text, VALUE_TEXT, "%" PRIu32 ".%04" PRIu32, magnitude / 10000, magnitude % 10000);
}

static void put_ambient(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->ambient);
}

static void put_precision(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->precision);
}

static void put_temperature(const reading_t *reading, char text[VALUE_TEXT])
{
    const reader_temperature_t *const temperature = &reading->reader->temperature;
    if (temperature->is_known) tenths_text(text, VALUE_TEXT, temperature->dc);
}

static void put_alarm(const reading_t *reading, char text[VALUE_TEXT])
{
    static const char *const names[] = {[FATHOM_ALARM_ON] = "on",
                                        [FATHOM_ALARM_OFF] = "off",
                                        [FATHOM_ALARM_UNKNOWN] = "unknown",
                                        [FATHOM_ALARM_NO_RESPONSE] = "no_response"};
    put_string(text, names[reading->result->alarm]);
}

static void put_is_on(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->result->is_on ? "true" : "false");
}

static void put_level(const reading_t *reading, char text[VALUE_TEXT])
{
    const result_t *const result = reading->result;
    if (result->has_level) (void)snprintf(text, VALUE_TEXT, "%" PRId32, result->level.level_mm);
}

static void put_per_mille(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->result->has_level) put_number(text, reading->result->level.per_mille);
}

static void put_volume(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->result->has_level) put_number(text, reading->result->level.volume);
}

static const field_t fields[] = {
    {"sensor", true, 0, put_sensor},
    {"mode", true, 0, put_mode},
    {"address", false, 0, put_address},
    {"probe", false, 0, put_probe},
    {"sequence", false, COLUMNS_READING, put_sequence},
    {"time_us", false, 0, put_time},
    {"utc", true, 0, put_utc},
    {"alarm", true, COLUMNS_ALARM, put_alarm},
    {"is_on", false, COLUMNS_ALARM, put_is_on},
    {"status", true, COLUMNS_READING, put_status},
    {"interference", false, COLUMNS_READING, put_interference},
    {"distance_mm", false, 0, put_distance},
    {"raw", false, COLUMNS_READING, put_raw},
    {"magnitude", false, COLUMNS_OPTICS, put_magnitude},
    {"ambient", false, COLUMNS_OPTICS, put_ambient},
    {"precision", false, COLUMNS_OPTICS, put_precision},
    {"temperature_degc", false, COLUMNS_TEMPERATURE, put_temperature},
    {"level_mm", false, COLUMNS_LEVEL, put_level},
    {"level_per_mille", false, COLUMNS_LEVEL, put_per_mille},
    {"volume", false, COLUMNS_LEVEL, put_volume},
};
enum { FIELDS = sizeof fields / sizeof fields[0] };

static bool is_in(const field_t *field, uint8_t columns) { return (field->needs & columns) == field->needs; }

static void write_json(FILE *to, const reading_t *reading)
{
    for (size_t i = 0; i != FIELDS; i++) {
        char text[VALUE_TEXT] = "";
        if (!is_in(&fields[i], reading->own)) continue;
        fields[i].format(reading, text);
        const char *const quote = fields[i].is_string ? "\"" : "";
        (void)fprintf(to, "%s\"%s\":%s%s%s", i == 0 ? "{" : ",", fields[i].name, quote,
                      text[0] != '\0' ? text : "null", quote);
    }
    (void)fputs("}\n", to);
}

static void begin_csv(FILE *to, uint8_t columns)
{
    for (size_t i = 0; i != FIELDS; i++)
        if (is_in(&fields[i], columns)) (void)fprintf(to, "%s%s", i == 0 ? "" : ",", fields[i].name);
    (void)fputs("\n", to);
}

/* No value holds a comma or a quotation mark. */
static void write_csv(FILE *to, const reading_t *reading)
{
    for (size_t i = 0; i != FIELDS; i++) {
        char text[VALUE_TEXT] = "";
        if (!is_in(&fields[i], reading->columns)) continue;
        if (is_in(&fields[i], reading->own)) fields[i].format(reading, text);
        (void)fprintf(to, "%s%s", i == 0 ? "" : ",", text);
    }
    (void)fputs("\n", to);
}

/* ---- text, for people ---- */

/* Where there is no distance. */
static void write_kind(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = reading->sample;
    if (sample->kind == FATHOM_NO_TARGET)
        (void)fprintf(to, "no target in range%s", sample->interference ? " (interference)" : "");
    else if (sample->kind == FATHOM_NEAR)
        (void)fputs("nearer than it can measure", to);
    else if (sample->kind == FATHOM_UNKNOWN)
        (void)fprintf(to, "unknown: the value %" PRIu32 "%s", sample->raw,
                      reading->model->has_optics ? "" : " has been given no meaning (--means)");
    else
        (void)fputs("fault: the sensor says that it has failed", to);
}

static void write_text_reading(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = reading->sample;
    (void)fputs("  ", to);
    if (sample->kind == FATHOM_TARGET)
        (void)fprintf(to, "%6u mm  %3u.%03u m", sample->distance_mm, sample->distance_mm / 1000u,
                      sample->distance_mm % 1000u);
    else
        write_kind(to, reading);
    if (reading->model->has_optics && sample->kind != FATHOM_FAULT) {
        char magnitude[VALUE_TEXT];
        put_magnitude(reading, magnitude);
        (void)fprintf(to, "  magnitude %s  ambient %u  precision %u", magnitude, sample->ambient,
                      sample->precision);
    }
    char temperature[VALUE_TEXT] = "";
    put_temperature(reading, temperature);
    if (temperature[0] != '\0') (void)fprintf(to, "  %s degC", temperature);
}

/* Is it on where no distance decides it? The user has said so. */
static void write_text_change(FILE *to, const reading_t *reading)
{
    const result_t *const result = reading->result;
    if (result->alarm != FATHOM_ALARM_ON && result->alarm != FATHOM_ALARM_OFF) {
        (void)fprintf(to, ": %s (%s)", result->alarm == FATHOM_ALARM_UNKNOWN ? "not known" : "no response",
                      result->is_on ? "on" : "off");
        return;
    }
    (void)fprintf(to, ": alarm %s, ", result->is_on ? "on" : "off");
    if (reading->sample->kind == FATHOM_TARGET)
        (void)fprintf(to, "%u mm", reading->sample->distance_mm);
    else
        write_kind(to, reading);
}

static void write_text(FILE *to, const reading_t *reading)
{
    const result_t *const result = reading->result;
    (void)fprintf(to, "%6" PRIu64 ".%03u s  %s", reading->time_us / 1000000u,
                  (unsigned)(reading->time_us / 1000u % 1000u), reading->name);
    if (reading->model->probes > 1) (void)fprintf(to, " probe %u", reading->sample->probe);
    if (result->alarm != 0)
        write_text_change(to, reading);
    else
        write_text_reading(to, reading);
    if (result->has_level)
        (void)fprintf(to, "  level %" PRId32 " mm  %u per mille  volume %" PRIu32, result->level.level_mm,
                      result->level.per_mille, result->level.volume);
    (void)fputs("\n", to);
}

/* ---- formats ---- */

static const format_t formats[] = {
    {"text", false, NULL, write_text},
    {"json", true, NULL, write_json},
    {"csv", false, begin_csv, write_csv},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

const format_t *format_find(const char *command, const char *name)
{
    if (name == NULL) return &formats[0];
    for (size_t i = 0; i != FORMATS; i++)
        if (strcmp(name, formats[i].name) == 0) return &formats[i];
    (void)usage_error(command, "there is no format '%s', only text, json, csv", name);
    return NULL;
}
