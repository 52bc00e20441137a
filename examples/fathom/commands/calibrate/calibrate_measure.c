/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_measure.h"

#include <inttypes.h>
#include <stdlib.h>

#include "commands/calibrate/calibrate_plan.h"

/* After a write: of the slowest sensor's six measurements (table 1: 6 to 54 a second) one may have been made before. */
enum { AFTER_WRITE_US = 1000000 };
/* Between two batches. Where a filter settles with a time constant of 2 s, two that differ by 1 mm leave 0.4 mm. */
enum { REST_US = 2000000 };
enum { MOST_BATCHES = 10, MOST_FAILURES_IN_ROW = 5 };

/* Why a batch does not count; FAILED: the line, and all is over. */
typedef enum { BATCH_GOOD, BATCH_NO_TARGET, BATCH_FAULT, BATCH_UNKNOWN, BATCH_SPREAD, BATCH_FAILED } batch_t;

static fathom_status_t poll(reader_t *reader, void *ctx)
{
    fathom_sample_t *const sample = ctx;
    return fathom_poll(&reader->sensor, sample);
}

static void begin_why(const session_t *session)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: it could not be measured: ", session->station->name);
}

/* A sample; what fails on the line is tried again. False after saying why there is none. */
static bool take_sample(session_t *session, fathom_sample_t *sample)
{
    for (unsigned failures = 0;;) {
        const fathom_status_t status = session_call(session, poll, sample);
        if (status == FATHOM_OK) return true;
        const bool is_over = status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
        if (!is_over && ++failures != MOST_FAILURES_IN_ROW) continue;
        begin_why(session);
        if (status == FATHOM_ERR_MALFORMED && !reader_got_unexpected_response(&session->station->reader))
            (void)fputs("it sends values that no measurement has; `fathom read` says which", stderr);
        else
            session_explain(session, status);
        (void)fputs("\n", stderr);
        return false;
    }
}

/* Samples that count for nothing. */
static bool rest(session_t *session, uint32_t rest_us)
{
    const host_t *const host = session->channel.host;
    const uint64_t end_us = host->now_us(host->ctx) + rest_us;
    fathom_sample_t sample;
    do
        if (!take_sample(session, &sample)) return false;
    while (host->now_us(host->ctx) < end_us);
    return true;
}

static int compare(const void *one, const void *other)
{
    const uint16_t a = *(const uint16_t *)one;
    const uint16_t b = *(const uint16_t *)other;
    return (a > b) - (a < b);
}

static batch_t take_batch(session_t *session, const calibrate_batch_t *asked,
                          calibrate_measurement_t *measurement)
{
    uint16_t distances[CALIBRATE_MOST_SAMPLES] = {0};
    for (uint32_t i = 0; i != asked->samples; i++) {
        fathom_sample_t sample;
        if (!take_sample(session, &sample)) return BATCH_FAILED;
        if (sample.kind == FATHOM_NO_TARGET) return BATCH_NO_TARGET;
        if (sample.kind == FATHOM_FAULT) return BATCH_FAULT;
        if (sample.kind != FATHOM_TARGET) return BATCH_UNKNOWN;
        distances[i] = sample.distance_mm;
    }
    qsort(distances, asked->samples, sizeof distances[0], compare);
    measurement->median_mm = distances[asked->samples / 2];
    measurement->spread_mm = (uint32_t)distances[asked->samples - 1] - distances[0];
    return measurement->spread_mm > asked->spread_mm ? BATCH_SPREAD : BATCH_GOOD;
}

static bool agree(const calibrate_measurement_t *one, const calibrate_measurement_t *other)
{
    const uint32_t spread_mm = one->spread_mm > other->spread_mm ? one->spread_mm : other->spread_mm;
    const int32_t apart_mm = one->median_mm - other->median_mm;
    return (apart_mm < 0 ? -apart_mm : apart_mm) <= calibrate_tolerance_mm(spread_mm) / 2;
}

static void explain(const session_t *session, const calibrate_batch_t *asked, batch_t why,
                    const calibrate_measurement_t *last, const calibrate_measurement_t *before)
{
    begin_why(session);
    switch (why) {
    case BATCH_NO_TARGET:
        (void)fputs("no target in range; aim it at a flat, light target, at a right angle", stderr);
        break;
    case BATCH_FAULT:
        (void)fputs(
            "the sensor reports that it has failed; wait until it has warmed up, or switch its power off "
            "and on",
            stderr);
        break;
    case BATCH_UNKNOWN:
        (void)fputs("it measures less than 80 mm, below its range; place the target farther away", stderr);
        break;
    case BATCH_SPREAD:
        (void)fprintf(
            stderr,
            "the samples spread over %" PRIu32 " mm, more than --spread %" PRIu32
            "; hold sensor and target still, use a flat, light target at a right angle, or allow more",
            last->spread_mm, asked->spread_mm);
        break;
    default:
        (void)fprintf(stderr,
                      "it does not come to rest, %" PRId32 " mm after %" PRId32
                      " mm; hold sensor and target still",
                      last->median_mm, before->median_mm);
        break;
    }
    (void)fputs("\n", stderr);
}

bool calibrate_measure(session_t *session, const calibrate_batch_t *asked, bool is_after_write,
                       calibrate_measurement_t *measurement)
{
    calibrate_measurement_t before = {0, 0};
    calibrate_measurement_t last = {0, 0};
    batch_t why = BATCH_GOOD;
    bool has_before = false;
    if (is_after_write && !rest(session, AFTER_WRITE_US)) return false;
    for (unsigned batches = 0; batches != MOST_BATCHES; batches++) {
        if (batches != 0 && !rest(session, REST_US)) return false;
        calibrate_measurement_t now = {0, 0};
        const batch_t batch = take_batch(session, asked, &now);
        if (batch == BATCH_FAILED) return false;
        const bool is_good = batch == BATCH_GOOD;
        if (is_good && has_before && agree(&last, &now)) {
            *measurement = now;
            if (last.spread_mm > now.spread_mm) measurement->spread_mm = last.spread_mm;
            return true;
        }
        if (!is_good || has_before) why = batch; /* good: the two do not agree */
        has_before = is_good;
        before = last;
        last = now;
    }
    explain(session, asked, why, &last, &before);
    return false;
}
