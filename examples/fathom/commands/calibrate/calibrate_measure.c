/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_measure.h"

#include <inttypes.h>
#include <stdlib.h>

#include "commands/calibrate/calibrate_plan.h"

enum {
    /* The slowest sensor measures six times a second (table 1), so one sample may come from before the write. */
    AFTER_WRITE_US = 1000000,
    /* If a filter has a time constant of 2 s, two batches that differ by 1 mm leave an error of 0.4 mm. */
    REST_US = 2000000,
    MOST_BATCHES = 10,
    MOST_FAILURES_IN_ROW = 5
};

typedef enum {
    BATCH_GOOD,
    BATCH_NO_TARGET,
    BATCH_FAULT,
    BATCH_UNKNOWN,
    BATCH_SPREAD,
    BATCH_UNSETTLED, /* good, but the median differs from that of the batch before */
    BATCH_FAILED     /* no sample could be read; the reason was printed */
} batch_result_t;

static fathom_status_t poll(reader_t *reader, void *ctx)
{
    fathom_sample_t *const sample = ctx;
    return reader_poll(reader, sample);
}

static void print_start(session_t *session)
{
    session_end_task(session);
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: cannot measure: ", session->sensor->name);
}

/* Reads a sample and repeats a failed read. Returns false after printing why there is none. */
static bool read_sample(session_t *session, fathom_sample_t *sample)
{
    for (unsigned failures = 0;;) {
        const fathom_status_t status = session_call(session, poll, sample);
        if (status == FATHOM_OK) return true;
        const bool is_over = status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
        if (!is_over && ++failures != MOST_FAILURES_IN_ROW) continue;
        print_start(session);
        session_explain(session, status);
        (void)fputs("\n", stderr);
        return false;
    }
}

static bool discard_samples(session_t *session, uint32_t for_us)
{
    const host_t *const host = session->port.host;
    const uint64_t end_us = host->now_us(host->ctx) + for_us;
    fathom_sample_t sample;
    do
        if (!read_sample(session, &sample)) return false;
    while (host->now_us(host->ctx) < end_us);
    return true;
}

static int compare(const void *one, const void *other)
{
    const uint16_t a = *(const uint16_t *)one;
    const uint16_t b = *(const uint16_t *)other;
    return (a > b) - (a < b);
}

static batch_result_t read_batch(session_t *session, const calibrate_batch_t *batch,
                                 calibrate_measurement_t *measurement)
{
    uint16_t distances[CALIBRATE_MOST_SAMPLES] = {0};
    for (uint32_t i = 0; i != batch->samples; i++) {
        fathom_sample_t sample;
        if (!read_sample(session, &sample)) return BATCH_FAILED;
        if (sample.kind == FATHOM_NO_TARGET) return BATCH_NO_TARGET;
        if (sample.kind == FATHOM_FAULT) return BATCH_FAULT;
        if (sample.kind != FATHOM_TARGET) return BATCH_UNKNOWN;
        distances[i] = sample.distance_mm;
    }
    qsort(distances, batch->samples, sizeof distances[0], compare);
    measurement->median_mm = distances[batch->samples / 2];
    measurement->spread_mm = (uint32_t)distances[batch->samples - 1] - distances[0];
    return measurement->spread_mm > batch->spread_mm ? BATCH_SPREAD : BATCH_GOOD;
}

static bool agree(const calibrate_measurement_t *one, const calibrate_measurement_t *other)
{
    const uint32_t spread_mm = one->spread_mm > other->spread_mm ? one->spread_mm : other->spread_mm;
    const int32_t apart_mm = one->median_mm - other->median_mm;
    return (apart_mm < 0 ? -apart_mm : apart_mm) <= calibrate_tolerance_mm(spread_mm) / 2;
}

static void print_why(session_t *session, const calibrate_batch_t *batch, batch_result_t why,
                      const calibrate_measurement_t *last)
{
    static const char *const texts[] = {
        [BATCH_NO_TARGET] = "no target in range. Aim the sensor at a flat, light target at a right angle",
        [BATCH_FAULT] = "the sensor reports a fault. Wait until it has warmed up, or power-cycle it",
        [BATCH_UNKNOWN] = "the distance is below the range, 80 mm. Place the target farther away",
        [BATCH_UNSETTLED] = "the median does not settle. Hold the sensor and the target still",
    };
    print_start(session);
    if (why == BATCH_SPREAD)
        (void)fprintf(stderr,
                      "the samples differ by %" PRIu32 " mm, more than --spread %" PRIu32
                      ". Hold the sensor and the target still, use a flat, light target at a right angle, or "
                      "raise --spread",
                      last->spread_mm, batch->spread_mm);
    else
        (void)fputs(texts[why], stderr);
    (void)fputs("\n", stderr);
}

bool calibrate_measure(session_t *session, const calibrate_batch_t *batch, bool is_after_write,
                       calibrate_measurement_t *measurement)
{
    calibrate_measurement_t last = {0, 0};
    batch_result_t why = BATCH_GOOD;
    bool has_last = false;
    session_begin_task(session, "measuring");
    if (is_after_write && !discard_samples(session, AFTER_WRITE_US)) return false;
    for (unsigned batches = 0; batches != MOST_BATCHES; batches++) {
        if (batches != 0 && !discard_samples(session, REST_US)) return false;
        calibrate_measurement_t now = {0, 0};
        const batch_result_t result = read_batch(session, batch, &now);
        if (result == BATCH_FAILED) return false;
        if (result == BATCH_GOOD && has_last && agree(&last, &now)) {
            *measurement = now;
            if (last.spread_mm > now.spread_mm) measurement->spread_mm = last.spread_mm;
            session_end_task(session);
            return true;
        }
        if (result != BATCH_GOOD)
            why = result;
        else if (has_last)
            why = BATCH_UNSETTLED;
        has_last = result == BATCH_GOOD;
        last = now;
    }
    print_why(session, batch, why, &last);
    return false;
}
