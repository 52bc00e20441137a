/* SPDX-License-Identifier: MIT */
#include "commands/read/output.h"

#include <inttypes.h>
#include <string.h>

#include "diagnosis/status_word.h"

/* ---- text, for people ---- */

/* Writes why a pulse, or a value that the sensor sent, is no distance. */
static void write_reason(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const bool is_pulse = reading->sensor->mode->has_pulses;
    const bool is_unknown = sample->kind == FATHOM_UNKNOWN;
    if (is_unknown && is_pulse)
        (void)fprintf(to, ": all pulses are too short for the sensor; the longest has %" PRIu32 " us",
                      sample->raw);
    else if (is_unknown)
        (void)fprintf(to, ": the value %" PRIu32 "%s", sample->raw,
                      (reading->sensor->mode->takes & READER_TAKES_MEANINGS) != 0
                          ? " has no known meaning (--means)"
                          : "");
    else if (!is_pulse)
        (void)fputs(": the sensor reports a fault", to);
    else if (sample->raw == 0)
        (void)fputs(": the line stays high; check the wire of echo", to);
    else
        (void)fprintf(to, ": a pulse of %" PRIu32 " us is too long for the sensor", sample->raw);
}

/* Writes the status of a reading that has no distance. */
static void write_status(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    (void)fprintf(to, "%s%s", reading_status(reading), sample->interference ? " (interference)" : "");
    if (sample->kind == FATHOM_UNKNOWN || sample->kind == FATHOM_FAULT) write_reason(to, reading);
}

static void write_text_reading(FILE *to, const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const reader_facts_t facts = reader_facts(reading->sensor->reader);
    (void)fputs("  ", to);
    if (sample->kind == FATHOM_TARGET)
        (void)fprintf(to, "%6u mm  %3u.%03u m", sample->distance_mm, sample->distance_mm / 1000u,
                      sample->distance_mm % 1000u);
    else
        write_status(to, reading);
    if (reading->sensor->model->has_optics && sample->kind != FATHOM_FAULT)
        (void)fprintf(to, "  magnitude %" PRIu32 ".%04" PRIu32 "  ambient %u  precision %u",
                      sample->magnitude / 10000, sample->magnitude % 10000, sample->ambient,
                      sample->precision);
    if (facts.has_temperature) (void)fprintf(to, "  %.1f degC", facts.temperature_dc / 10.0);
}

static void write_text_change(FILE *to, const reading_t *reading)
{
    const result_t *const result = reading->result;
    const bool is_known = result->alarm == FATHOM_ALARM_ON || result->alarm == FATHOM_ALARM_OFF;
    (void)fprintf(to, ": alarm %s", alarm_word(result->alarm));
    if (!is_known) {
        (void)fprintf(to, " (%s)", result->is_on ? "on" : "off");
        return;
    }
    (void)fputs(", ", to);
    if (reading->result->sample.kind == FATHOM_TARGET)
        (void)fprintf(to, "%u mm", reading->result->sample.distance_mm);
    else
        write_status(to, reading);
}

static void write_text(FILE *to, const reading_t *reading, unsigned columns)
{
    const result_t *const result = reading->result;
    (void)columns;
    (void)fprintf(to, "%6" PRIu64 ".%03u s  %s", reading->time_us / 1000000u,
                  (unsigned)(reading->time_us / 1000u % 1000u), sensor_label(reading->sensor));
    if (reading->sensor->model->probes > 1 && reading_has_probe(reading))
        (void)fprintf(to, " probe %u", reading->result->sample.probe);
    if (result->alarm != 0)
        write_text_change(to, reading);
    else
        write_text_reading(to, reading);
    if (result->has_level)
        (void)fprintf(to, "  level %" PRId32 " mm  %u per mille  volume %" PRIu32, result->level.level_mm,
                      result->level.per_mille, result->level.volume);
    (void)fputs("\n", to);
}

static void write_json(FILE *to, const reading_t *reading, unsigned columns)
{
    (void)columns;
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    reading_json(&json, reading, sensor_columns(reading->sensor));
    json_end(&json, '}');
    (void)fputc('\n', to);
}

/* ---- formats ---- */

const format_t read_formats[] = {
    [FORMAT_TEXT] = {"text", false, false, NULL, write_text},
    [FORMAT_JSON] = {"json", true, true, NULL, write_json},
    [FORMAT_CSV] = {"csv", false, true, reading_csv_header, reading_csv},
};
