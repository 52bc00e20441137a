/* SPDX-License-Identifier: MIT */
#include "commands/read/output.h"

#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "commands/read/fields.h"

/* ---- text, for people ---- */

/* Where there is no distance. */
static void write_kind(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = reading->sample;
    if (sample->kind == FATHOM_NO_TARGET)
        (void)fprintf(to, "no target in range%s", sample->interference ? " (interference)" : "");
    else if (sample->kind == FATHOM_NEAR)
        (void)fputs(fields_is_contact(reading) ? "near" : "nearer than it can measure", to);
    else if (sample->kind == FATHOM_FAR)
        (void)fputs("far", to);
    else if (sample->kind == FATHOM_UNKNOWN && reading->reader->meter != NULL)
        (void)fprintf(to, "unknown: only pulses shorter than the sensor's; the longest has %" PRIu32 " us",
                      sample->raw);
    else if (sample->kind == FATHOM_UNKNOWN)
        (void)fprintf(to, "unknown: the value %" PRIu32 "%s", sample->raw,
                      reading->model->has_optics ? "" : " has been given no meaning (--means)");
    else if (reading->reader->meter == NULL)
        (void)fputs("fault: the sensor says that it has failed", to);
    else if (sample->raw == 0)
        (void)fputs("fault: the line stays high; check the wire of echo", to);
    else
        (void)fprintf(to, "fault: a pulse of %" PRIu32 " us, longer than any of the sensor", sample->raw);
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
        fields_magnitude(sample, magnitude);
        (void)fprintf(to, "  magnitude %s  ambient %u  precision %u", magnitude, sample->ambient,
                      sample->precision);
    }
    char temperature[VALUE_TEXT];
    fields_temperature(reading->reader, temperature);
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
                  (unsigned)(reading->time_us / 1000u % 1000u), reading->label);
    if (reading->model->probes > 1 && fields_has_probe(reading))
        (void)fprintf(to, " probe %u", reading->sample->probe);
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
    {"text", false, false, NULL, write_text},
    {"json", true, true, NULL, fields_json},
    {"csv", false, true, fields_begin_csv, fields_csv},
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
