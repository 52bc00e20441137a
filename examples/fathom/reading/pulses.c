/* SPDX-License-Identifier: MIT */
#include "reading/pulses.h"

#include <inttypes.h>
#include <string.h>

static void take_width(pulses_t *pulses, uint32_t width_us)
{
    if (pulses->count++ == 0 || width_us < pulses->least_us) pulses->least_us = width_us;
    if (width_us > pulses->most_us) pulses->most_us = width_us;
    /* Welford's way, which no sum of large squares makes inexact. */
    const double off_us = (double)width_us - pulses->mean_us;
    pulses->mean_us += off_us / (double)pulses->count;
    pulses->squares += off_us * ((double)width_us - pulses->mean_us);
}

void pulses_take(pulses_t *pulses, const reader_counters_t *counted, const fathom_sample_t *sample)
{
    if (sample != NULL && sample->kind == FATHOM_TARGET) take_width(pulses, sample->raw);
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

static void begin(pulses_t *pulses) { memset(pulses, 0, sizeof *pulses); }

void pulses_print(pulses_t *pulses, const char *name, FILE *to)
{
    const double deviation = deviation_us(pulses);
    (void)fprintf(to, "fathom: %s: pulses: %" PRIu64 " of a distance", name, pulses->count);
    if (pulses->count != 0)
        (void)fprintf(to, ", %" PRIu32 " to %" PRIu32 " us wide, mean %.1f us", pulses->least_us,
                      pulses->most_us, pulses->mean_us);
    if (pulses->count > 1) /* A16 1: S[cm] = T[us] / 57.5 */
        (void)fprintf(to, ", standard deviation %.1f us (%.1f mm)", deviation, deviation * 4 / 23);
    (void)fprintf(to,
                  "; %" PRIu64 " without a target; rejected: noises %" PRIu64 ", faults %" PRIu64
                  ", missed edges %" PRIu64 ", lost events %" PRIu64 "\n",
                  pulses->no_targets, pulses->noises, pulses->faults, pulses->missed, pulses->lost_events);
    begin(pulses);
}

void pulses_print_json(pulses_t *pulses, const char *name, FILE *to)
{
    (void)fprintf(to, "{\"pulses\":\"%s\",\"distances\":%" PRIu64, name, pulses->count);
    if (pulses->count != 0)
        (void)fprintf(
            to, ",\"least_us\":%" PRIu32 ",\"most_us\":%" PRIu32 ",\"mean_us\":%.1f,\"deviation_us\":%.1f",
            pulses->least_us, pulses->most_us, pulses->mean_us, deviation_us(pulses));
    else
        (void)fputs(",\"least_us\":null,\"most_us\":null,\"mean_us\":null,\"deviation_us\":null", to);
    (void)fprintf(to,
                  ",\"no_targets\":%" PRIu64 ",\"noises\":%" PRIu64 ",\"faults\":%" PRIu64
                  ",\"missed_edges\":%" PRIu64 ",\"lost_events\":%" PRIu64 "}\n",
                  pulses->no_targets, pulses->noises, pulses->faults, pulses->missed, pulses->lost_events);
    begin(pulses);
}
