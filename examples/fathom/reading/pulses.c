/* SPDX-License-Identifier: MIT */
#include "reading/pulses.h"

#include <string.h>

#include "output/record.h"

static void add_width(pulses_t *pulses, uint32_t width_us)
{
    if (pulses->count++ == 0 || width_us < pulses->least_us) pulses->least_us = width_us;
    if (width_us > pulses->most_us) pulses->most_us = width_us;
    /* Welford's way, which no sum of large squares makes inexact. */
    const double off_us = (double)width_us - pulses->mean_us;
    pulses->mean_us += off_us / (double)pulses->count;
    pulses->squares += off_us * ((double)width_us - pulses->mean_us);
}

void pulses_add(pulses_t *pulses, const reader_counters_t *counted, const fathom_sample_t *sample)
{
    if (sample != NULL && sample->kind == FATHOM_TARGET) add_width(pulses, sample->raw);
    if (sample != NULL && sample->kind == FATHOM_NO_TARGET) pulses->no_targets++;
    if (sample != NULL && sample->kind == FATHOM_FAULT) pulses->faults++;
    pulses->attempt_noises = counted->noises;
    pulses->noises += counted->noises;
    pulses->missed += counted->missed;
    pulses->lost_events += counted->lost_events;
}

/* Newton's way, which needs no further library; to a hundredth of what is measured. */
static double root(double square)
{
    double guess = square > 1 ? square : 1;
    for (unsigned steps = 0; steps != 64; steps++) guess = (guess + square / guess) / 2;
    return guess;
}

static double deviation_us(const pulses_t *pulses)
{
    return pulses->count > 1 ? root(pulses->squares / (double)(pulses->count - 1)) : 0;
}

typedef struct {
    int64_t distances, min_us, max_us, mean_dus, deviation_dus, deviation_dmm;
    int64_t no_targets, noises, faults, missed_edges, lost_events;
} row_t;

#define AT(member) offsetof(row_t, member)
static const field_t fields[] = {
    {"distances", "", NULL, FIELD_NUMBER, 0, AT(distances)},
    {"min_us", "us", NULL, FIELD_NUMBER, 0, AT(min_us)},
    {"max_us", "us", NULL, FIELD_NUMBER, 0, AT(max_us)},
    {"mean_us", "us", NULL, FIELD_TENTHS, 0, AT(mean_dus)},
    {"deviation_us", "us", NULL, FIELD_TENTHS, 0, AT(deviation_dus)},
    {"deviation_mm", "mm", NULL, FIELD_TENTHS, 0, AT(deviation_dmm)},
    {"no_targets", "", NULL, FIELD_NUMBER, 0, AT(no_targets)},
    {"noises", "", NULL, FIELD_NUMBER, 0, AT(noises)},
    {"faults", "", NULL, FIELD_NUMBER, 0, AT(faults)},
    {"missed_edges", "", NULL, FIELD_NUMBER, 0, AT(missed_edges)},
    {"lost_events", "", NULL, FIELD_NUMBER, 0, AT(lost_events)},
    {.key = NULL},
};
#undef AT

static int64_t tenths(double value) { return (int64_t)(value * 10 + 0.5); }

static row_t row_of(const pulses_t *pulses)
{
    const bool is_any = pulses->count != 0;
    const bool has_spread = pulses->count > 1;
    const double deviation = deviation_us(pulses);
    return (row_t){.distances = (int64_t)pulses->count,
                   .min_us = is_any ? pulses->least_us : NO_VALUE,
                   .max_us = is_any ? pulses->most_us : NO_VALUE,
                   .mean_dus = is_any ? tenths(pulses->mean_us) : NO_VALUE,
                   .deviation_dus = has_spread ? tenths(deviation) : NO_VALUE,
                   .deviation_dmm =
                       has_spread ? tenths(deviation * 4 / 23) : NO_VALUE, /* A16 1: T / 57.5 cm */
                   .no_targets = (int64_t)pulses->no_targets,
                   .noises = (int64_t)pulses->noises,
                   .faults = (int64_t)pulses->faults,
                   .missed_edges = (int64_t)pulses->missed,
                   .lost_events = (int64_t)pulses->lost_events};
}

void pulses_print(pulses_t *pulses, const char *name, FILE *to)
{
    const row_t row = row_of(pulses);
    (void)fprintf(to, "fathom: %s: pulses: ", name);
    (void)record_print(to, "", fields, &row, 0, false);
    (void)fputs("\n", to);
    memset(pulses, 0, sizeof *pulses);
}

void pulses_print_json(pulses_t *pulses, const char *name, FILE *to)
{
    const row_t row = row_of(pulses);
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    json_string(&json, "name", name);
    json_begin(&json, "pulses", '{');
    record_json(&json, fields, &row, 0);
    json_end(&json, '}');
    json_end(&json, '}');
    (void)fputs("\n", to);
    memset(pulses, 0, sizeof *pulses);
}
