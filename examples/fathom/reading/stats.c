/* SPDX-License-Identifier: MIT */
/* The counters of a run, and of a sensor. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "reading/fields.h"

/* ---- pulses ---- */

static int64_t tenths(double value) { return (int64_t)(value * 10 + 0.5); }

/* Takes them: they begin again. */
static pulses_t take_pulses(sensor_t *sensor)
{
    pulses_t pulses = sensor->pulses;
    const int64_t count = pulses.distances;
    const double deviation_us = count > 1 ? sqrt(pulses.squares / (double)(count - 1)) : 0;
    pulses.mean_dus = tenths(pulses.mean_us);
    pulses.deviation_dus = tenths(deviation_us);
    pulses.deviation_dmm = tenths(deviation_us * 4 / 23); /* A16 1: T / 57.5 cm */
    if (count < 2) pulses.deviation_dus = pulses.deviation_dmm = NO_VALUE;
    if (count == 0) pulses.min_us = pulses.max_us = pulses.mean_dus = NO_VALUE;
    sensor->pulses = (pulses_t){.distances = 0};
    return pulses;
}

/* ---- the rows ---- */

/* Columns: the parts of an account. */
enum {
    ATTEMPTS = 1,
    TOTALS = 2,
    MEDIAN = 4,
    LINE = 8,
    STREAM = 16,
    PORT = 32,
    REQUESTS = 64,
    RESPONSE = 128
};

#define FIELD(key, part, type, member)                                                                       \
    {                                                                                                        \
        key, "", NULL, FIELD_NUMBER, part, offsetof(type, member)                                            \
    }
#define COUNT(key, part, member) FIELD(key, part, account_t, member)

static const field_t fields[] = {
    COUNT("attempts", ATTEMPTS, sum.attempts),
    COUNT("failed", ATTEMPTS, sum.failed),
    COUNT("readings", ATTEMPTS, sum.readings),

    COUNT("requests", TOTALS, requests),
    COUNT("skipped_frames", TOTALS, sum.skipped),
    COUNT("reconnects", TOTALS, reconnects),
    COUNT("dropped_spikes", TOTALS | MEDIAN, dropped_spikes),

    COUNT("responses", LINE, sum.total.line[FATHOM_LINE_RESPONSES]),
    COUNT("dropped_bytes", LINE, sum.total.line[FATHOM_LINE_DROPPED_BYTES]),
    COUNT("port_errors", LINE, sum.total.line[FATHOM_LINE_PORT_ERRORS]),
    COUNT("no_responses", LINE, sum.total.line[FATHOM_LINE_NO_RESPONSES]),
    COUNT("damaged_responses", LINE, sum.total.line[FATHOM_LINE_CHECKSUM_ERRORS]),
    COUNT("exceptions", LINE, sum.total.line[FATHOM_LINE_EXCEPTIONS]),
    COUNT("other_responses", LINE, sum.total.line[FATHOM_LINE_MALFORMED]),
    COUNT("late_responses", LINE, sum.total.line[FATHOM_LINE_LATE_RESPONSES]),
    COUNT("unsolicited_frames", LINE, sum.total.line[FATHOM_LINE_STRAYS]),
    COUNT("maybe_unsolicited_responses", LINE, sum.total.line[FATHOM_LINE_MAYBE_UNSOLICITED]),
    COUNT("bad_bytes", LINE, sum.total.line[FATHOM_LINE_BAD_BYTES]),
    COUNT("old_bytes", LINE, sum.total.line[FATHOM_LINE_OLD_BYTES]),
    COUNT("busy_attempts", LINE, sum.total.line[FATHOM_LINE_BUSY_ATTEMPTS]),
    COUNT("other_master_attempts", LINE, sum.total.line[FATHOM_LINE_OTHER_MASTERS]),
    COUNT("other_master_requests", LINE, sum.total.line[FATHOM_LINE_FOREIGN_REQUESTS]),

    COUNT("frames", STREAM, sum.total.stream[FATHOM_STREAM_FRAMES]),
    COUNT("missed_frames", STREAM, sum.total.stream[FATHOM_STREAM_MISSED]),
    COUNT("ambiguous_frames", STREAM, sum.total.stream[FATHOM_STREAM_AMBIGUOUS]),
    COUNT("unsure_frames", STREAM, sum.total.stream[FATHOM_STREAM_UNSURE]),
    COUNT("damaged_frames", STREAM, sum.total.stream[FATHOM_STREAM_DAMAGED]),
    COUNT("stale", STREAM, sum.total.stream[FATHOM_STREAM_STALES]),
    COUNT("bytes", STREAM, sum.total.stream[FATHOM_STREAM_BYTES]),
    COUNT("dropped_bytes", STREAM, sum.total.stream[FATHOM_STREAM_DROPPED_BYTES]),

    COUNT("parity_errors", PORT, sum.total.port[PORT_PARITY]),
    COUNT("framing_errors", PORT, sum.total.port[PORT_FRAMING]),
    COUNT("overruns", PORT, sum.total.port[PORT_OVERRUN]),
    COUNT("breaks", PORT, sum.total.port[PORT_BREAKS]),

    COUNT("responses", REQUESTS, sum.total.unit[UNIT_RESPONSES]),
    COUNT("failed_requests", REQUESTS, sum.total.unit[UNIT_FAILURES]),
    COUNT("timeouts_in_row", REQUESTS, timeouts_in_row),
    COUNT("backoff_left_us", REQUESTS, backoff_left_us),

    COUNT("response_min_us", RESPONSE, response_min_us),
    COUNT("response_mean_us", RESPONSE, response_mean_us),
    COUNT("response_max_us", RESPONSE, response_max_us),
    {.key = NULL},
};

static const field_t pulse_fields[] = {
    FIELD("distances", 0, pulses_t, distances),
    FIELD("min_us", 0, pulses_t, min_us),
    FIELD("max_us", 0, pulses_t, max_us),
    {"mean_us", "us", NULL, FIELD_TENTHS, 0, offsetof(pulses_t, mean_dus)},
    {"deviation_us", "us", NULL, FIELD_TENTHS, 0, offsetof(pulses_t, deviation_dus)},
    {"deviation_mm", "mm", NULL, FIELD_TENTHS, 0, offsetof(pulses_t, deviation_dmm)},
    FIELD("no_targets", 0, pulses_t, no_targets),
    FIELD("noises", 0, pulses_t, noises),
    FIELD("faults", 0, pulses_t, faults),
    FIELD("missed_edges", 0, pulses_t, missed_edges),
    FIELD("lost_events", 0, pulses_t, lost_events),
    {.key = NULL},
};

/* The words of the failures are the keys. */
static const field_t *failure_fields(void)
{
    static field_t rows[FAILURE_KINDS + 1];
    field_t *row = rows;
    for (size_t kind = 0; kind != FAILURE_KINDS; kind++)
        if (status_word_of_failure(kind) != NULL)
            *row++ = (field_t)COUNT(status_word_of_failure(kind), 0, sum.failures[kind]);
    return rows;
}

/* ---- text: counters that are 0 are left out ---- */

static void print_line(FILE *to, const char *before, const field_t *rows, const void *record, unsigned part,
                       bool omits_zero)
{
    if (record_print(to, before, rows, record, part, omits_zero)) (void)fputs("\n", to);
}

static void print_sensor(FILE *to, const sensor_t *sensor, const account_t *account)
{
    (void)fprintf(to, "fathom: %s: ", sensor->name);
    (void)record_print(to, "", fields, account, ATTEMPTS, false);
}

void stats_print_short(const account_t *account, FILE *to)
{
    print_line(to, "fathom: ", fields, account, ATTEMPTS, false);
    for (size_t i = 0; i != account->sensor_count && account->sensor_count > 1; i++) {
        const account_t one = account_of(&account->sensors[i], 1);
        print_sensor(to, account->sensors[i], &one);
        if (one.timeouts_in_row != 0) (void)record_print(to, ", ", fields, &one, REQUESTS, false);
        (void)fputs("\n", to);
    }
    const bool has_stream = record_print(to, "fathom: line: ", fields, account, STREAM, true);
    if (record_print(to, has_stream ? ", " : "fathom: line: ", fields, account, LINE, true) || has_stream)
        (void)fputs("\n", to);
}

static void print_dropped(FILE *to, const sensor_t *sensor)
{
    for (size_t p = 0; p != FATHOM_DYP_PROBES; p++) {
        if (sensor->probes[p].dropped == 0) continue;
        (void)fprintf(to, "fathom: %s", sensor->name);
        if (sensor->model->probes > 1) (void)fprintf(to, " probe %zu", p + 1);
        (void)fprintf(to, ": spikes dropped %" PRIu64 "\n", sensor->probes[p].dropped);
    }
}

void stats_print(const account_t *account, FILE *to)
{
    print_line(to, "fathom: ", fields, account, ATTEMPTS, false);
    print_line(to, "fathom: ", fields, account, TOTALS | MEDIAN, true);
    print_line(to, "fathom: failures: ", failure_fields(), account, 0, true);
    print_line(to, "fathom: line: ", fields, account, LINE, true);
    if (account->has_stream) print_line(to, "fathom: stream: ", fields, account, STREAM, true);
    print_line(to, "fathom: port: ", fields, account, PORT, true);
    for (size_t i = 0; i != account->sensor_count; i++) {
        const account_t one = account_of(&account->sensors[i], 1);
        if (!mode_is_asked(account->sensors[i]->mode)) continue;
        print_sensor(to, account->sensors[i], &one);
        (void)record_print(to, ", ", fields, &one, REQUESTS | RESPONSE, true);
        (void)fputs("\n", to);
    }
    for (size_t i = 0; i != account->sensor_count; i++) print_dropped(to, account->sensors[i]);
    for (size_t i = 0; i != account->sensor_count; i++) {
        if (!account->sensors[i]->mode->has_pulses) continue;
        const pulses_t pulses = take_pulses(account->sensors[i]);
        (void)fprintf(to, "fathom: %s: ", account->sensors[i]->name);
        print_line(to, "pulses: ", pulse_fields, &pulses, 0, false);
    }
}

/* ---- JSON ---- */

static void put_object(json_t *json, const char *key, const field_t *rows, const void *record, unsigned part)
{
    json_begin(json, key, '{');
    record_json(json, rows, record, part);
    json_end(json, '}');
}

/* Counters with a name of their own. puts_null: also those that these sensors, or this port, do not have. */
static void put_groups(json_t *json, const account_t *account, bool puts_null)
{
    put_object(json, "failures", failure_fields(), account, 0);
    put_object(json, "line", fields, account, LINE);
    if (account->has_stream)
        put_object(json, "stream", fields, account, STREAM);
    else if (puts_null)
        json_string(json, "stream", NULL);
    if (account->has_port)
        put_object(json, "port", fields, account, PORT);
    else if (puts_null)
        json_string(json, "port", NULL);
}

void stats_json_of_sensor(json_t *json, sensor_t *sensor)
{
    const account_t account = account_of(&sensor, 1);
    record_json(json, fields, &account, ATTEMPTS);
    put_groups(json, &account, false);
    record_json(json, fields, &account, RESPONSE);
}

static void put_sensor(json_t *json, sensor_t *sensor)
{
    const account_t account = account_of(&sensor, 1);
    json_begin(json, NULL, '{');
    sensor_json(json, sensor);
    json_value(json, "address", "%u", sensor->address);
    record_json(json, fields, &account, ATTEMPTS | REQUESTS | RESPONSE);
    json_end(json, '}');
}

void stats_print_json(const account_t *account, FILE *to)
{
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    json_value(&json, "time_us", "%" PRId64, account->time_us);
    record_json(&json, fields, account, ATTEMPTS | TOTALS | (account->has_median ? MEDIAN : 0));
    put_groups(&json, account, true);
    record_json(&json, fields, account, RESPONSE);
    json_begin(&json, "sensors", '[');
    for (size_t i = 0; i != account->sensor_count; i++)
        if (mode_is_asked(account->sensors[i]->mode)) put_sensor(&json, account->sensors[i]);
    json_end(&json, ']');
    json_end(&json, '}');
    (void)fputs("\n", to);
    for (size_t i = 0; i != account->sensor_count; i++) {
        if (!account->sensors[i]->mode->has_pulses) continue;
        const pulses_t pulses = take_pulses(account->sensors[i]);
        json = (json_t){.to = to};
        json_begin(&json, NULL, '{');
        json_string(&json, "name", account->sensors[i]->name);
        put_object(&json, "pulses", pulse_fields, &pulses, 0);
        json_end(&json, '}');
        (void)fputs("\n", to);
    }
}
