/* SPDX-License-Identifier: MIT */
#include "reading/stats.h"

#include <inttypes.h>

#include "diagnosis/status_word.h"
#include "output/record.h"

#define NUMBER(key, type, member)                                                                            \
    {                                                                                                        \
        key, "", NULL, FIELD_NUMBER, 0, offsetof(type, member)                                               \
    }

static const field_t attempt_fields[] = {
    NUMBER("attempts", counters_t, attempts),
    NUMBER("failed", counters_t, failed),
    NUMBER("readings", counters_t, readings),
    {.key = NULL},
};

enum { MEDIAN = 1 };

static const field_t total_fields[] = {
    NUMBER("requests", account_t, requests),
    NUMBER("skipped_frames", account_t, sum.skipped),
    NUMBER("reconnects", account_t, reconnects),
    {"dropped_spikes", "", NULL, FIELD_NUMBER, MEDIAN, offsetof(account_t, dropped_spikes)},
    {.key = NULL},
};

static const field_t line_fields[] = {
    NUMBER("responses", counts_t, line[FATHOM_LINE_RESPONSES]),
    NUMBER("dropped_bytes", counts_t, line[FATHOM_LINE_DROPPED_BYTES]),
    NUMBER("port_errors", counts_t, line[FATHOM_LINE_PORT_ERRORS]),
    NUMBER("no_responses", counts_t, line[FATHOM_LINE_NO_RESPONSES]),
    NUMBER("damaged_responses", counts_t, line[FATHOM_LINE_CHECKSUM_ERRORS]),
    NUMBER("exceptions", counts_t, line[FATHOM_LINE_EXCEPTIONS]),
    NUMBER("other_responses", counts_t, line[FATHOM_LINE_MALFORMED]),
    NUMBER("late_responses", counts_t, line[FATHOM_LINE_LATE_RESPONSES]),
    NUMBER("unsolicited_frames", counts_t, line[FATHOM_LINE_STRAYS]),
    NUMBER("maybe_unsolicited_responses", counts_t, line[FATHOM_LINE_MAYBE_UNSOLICITED]),
    NUMBER("bad_bytes", counts_t, line[FATHOM_LINE_BAD_BYTES]),
    NUMBER("old_bytes", counts_t, line[FATHOM_LINE_OLD_BYTES]),
    NUMBER("busy_attempts", counts_t, line[FATHOM_LINE_BUSY_ATTEMPTS]),
    NUMBER("other_master_attempts", counts_t, line[FATHOM_LINE_OTHER_MASTERS]),
    NUMBER("other_master_requests", counts_t, line[FATHOM_LINE_FOREIGN_REQUESTS]),
    {.key = NULL},
};

static const field_t stream_fields[] = {
    NUMBER("frames", counts_t, stream[FATHOM_STREAM_FRAMES]),
    NUMBER("missed_frames", counts_t, stream[FATHOM_STREAM_MISSED]),
    NUMBER("ambiguous_frames", counts_t, stream[FATHOM_STREAM_AMBIGUOUS]),
    NUMBER("unsure_frames", counts_t, stream[FATHOM_STREAM_UNSURE]),
    NUMBER("damaged_frames", counts_t, stream[FATHOM_STREAM_DAMAGED]),
    NUMBER("stale", counts_t, stream[FATHOM_STREAM_STALES]),
    NUMBER("bytes", counts_t, stream[FATHOM_STREAM_BYTES]),
    NUMBER("dropped_bytes", counts_t, stream[FATHOM_STREAM_DROPPED_BYTES]),
    {.key = NULL},
};

static const field_t port_fields[] = {
    NUMBER("parity_errors", counts_t, port[PORT_PARITY]),
    NUMBER("framing_errors", counts_t, port[PORT_FRAMING]),
    NUMBER("overruns", counts_t, port[PORT_OVERRUN]),
    NUMBER("breaks", counts_t, port[PORT_BREAKS]),
    {.key = NULL},
};

/* What a sensor that receives requests has besides its attempts. */
typedef struct {
    int64_t responses, failed_requests, timeouts_in_row, backoff_left_us;
} requests_row_t;

static const field_t request_fields[] = {
    NUMBER("responses", requests_row_t, responses),
    NUMBER("failed_requests", requests_row_t, failed_requests),
    NUMBER("timeouts_in_row", requests_row_t, timeouts_in_row),
    NUMBER("backoff_left_us", requests_row_t, backoff_left_us),
    {.key = NULL},
};

/* The time from a request to its response. */
typedef struct {
    int64_t min_us, mean_us, max_us;
} response_row_t;

static const field_t response_fields[] = {
    NUMBER("response_min_us", response_row_t, min_us),
    NUMBER("response_mean_us", response_row_t, mean_us),
    NUMBER("response_max_us", response_row_t, max_us),
    {.key = NULL},
};

static requests_row_t requests_of(const sensor_t *sensor)
{
    const reader_facts_t facts = reader_facts(sensor->reader);
    const uint64_t *const unit = sensor->counters.total.unit;
    return (requests_row_t){.responses = (int64_t)unit[UNIT_RESPONSES],
                            .failed_requests = (int64_t)unit[UNIT_FAILURES],
                            .timeouts_in_row = facts.timeouts_in_row,
                            .backoff_left_us = facts.backoff_left_us};
}

static response_row_t response_of(const counters_t *counters)
{
    if (counters->timed == 0) return (response_row_t){NO_VALUE, NO_VALUE, NO_VALUE};
    return (response_row_t){.min_us = counters->time_min_us,
                            .mean_us = (int64_t)(counters->time_sum_us / counters->timed),
                            .max_us = counters->time_max_us};
}

/* ---- groups of counters ---- */

enum { GROUPS = 3 };

typedef struct {
    const char *name;
    const field_t *fields;
    bool is_there; /* these sensors, or this port, have such counters */
} group_t;

static bool has_listener(const account_t *account)
{
    for (size_t i = 0; i != account->sensor_count; i++)
        if (!mode_is_asked(account->sensors[i]->mode)) return true;
    return false;
}

static void list_groups(const account_t *account, group_t groups[GROUPS])
{
    groups[0] = (group_t){"line", line_fields, true};
    groups[1] = (group_t){"stream", stream_fields, has_listener(account)};
    groups[2] = (group_t){"port", port_fields, account->has_port};
}

/* ---- text ---- */

static void print_record(FILE *to, const char *before, const field_t *fields, const void *record,
                         unsigned columns)
{
    (void)record_print(to, before, fields, record, columns, false);
}

static void print_attempts(const sensor_t *sensor, FILE *to)
{
    (void)fprintf(to, "fathom: %s: ", sensor->name);
    (void)record_print(to, "", attempt_fields, &sensor->counters, 0, false);
}

void stats_print_short(const account_t *account, FILE *to)
{
    const char *before = "fathom: line: ";
    print_record(to, "fathom: ", attempt_fields, &account->sum, 0);
    (void)fputs("\n", to);
    for (size_t i = 0; i != account->sensor_count && account->sensor_count > 1; i++) {
        const sensor_t *const sensor = account->sensors[i];
        const requests_row_t requests = requests_of(sensor);
        print_attempts(sensor, to);
        if (requests.timeouts_in_row != 0) print_record(to, ", ", request_fields, &requests, 0);
        (void)fputs("\n", to);
    }
    if (record_print(to, before, stream_fields, &account->sum.total, 0, true)) before = ", ";
    if (record_print(to, before, line_fields, &account->sum.total, 0, true)) before = ", ";
    if (before[0] == ',') (void)fputs("\n", to);
}

static void print_failures(const account_t *account, FILE *to)
{
    const char *before = "fathom: failures: ";
    for (size_t i = 0; i != FAILURE_KINDS; i++) {
        if (status_word_of_failure(i) == NULL || account->sum.failures[i] == 0) continue;
        (void)fprintf(to, "%s%s %" PRIu64, before, status_word_of_failure(i), account->sum.failures[i]);
        before = ", ";
    }
    if (before[0] == ',') (void)fputs("\n", to);
}

static void print_sensor(const sensor_t *sensor, FILE *to)
{
    const requests_row_t requests = requests_of(sensor);
    const response_row_t response = response_of(&sensor->counters);
    print_attempts(sensor, to);
    (void)record_print(to, ", ", request_fields, &requests, 0, true);
    if (sensor->counters.timed != 0) print_record(to, ", ", response_fields, &response, 0);
    (void)fputs("\n", to);
}

/* Counters that are 0 are left out. */
void stats_print(const account_t *account, FILE *to)
{
    group_t groups[GROUPS];
    list_groups(account, groups);
    print_record(to, "fathom: ", attempt_fields, &account->sum, 0);
    (void)fputs("\n", to);
    if (record_print(to, "fathom: ", total_fields, account, 0, true)) (void)fputs("\n", to);
    print_failures(account, to);
    for (size_t i = 0; i != GROUPS; i++) {
        char before[32];
        if (!groups[i].is_there) continue;
        (void)snprintf(before, sizeof before, "fathom: %s: ", groups[i].name);
        if (record_print(to, before, groups[i].fields, &account->sum.total, 0, true)) (void)fputs("\n", to);
    }
    for (size_t i = 0; i != account->sensor_count; i++)
        if (mode_is_asked(account->sensors[i]->mode)) print_sensor(account->sensors[i], to);
}

/* ---- JSON ---- */

static void put_failures(json_t *json, const account_t *account)
{
    json_begin(json, "failures", '{');
    for (size_t i = 0; i != FAILURE_KINDS; i++)
        if (status_word_of_failure(i) != NULL)
            json_value(json, status_word_of_failure(i), "%" PRIu64, account->sum.failures[i]);
    json_end(json, '}');
}

static void put_group(json_t *json, const group_t *group, const account_t *account)
{
    if (!group->is_there) {
        json_string(json, group->name, NULL);
        return;
    }
    json_begin(json, group->name, '{');
    record_json(json, group->fields, &account->sum.total, 0);
    json_end(json, '}');
}

static void put_sensor(json_t *json, const sensor_t *sensor)
{
    const requests_row_t requests = requests_of(sensor);
    const response_row_t response = response_of(&sensor->counters);
    json_begin(json, NULL, '{');
    sensor_json(json, sensor);
    json_value(json, "address", "%u", sensor->address);
    record_json(json, attempt_fields, &sensor->counters, 0);
    record_json(json, request_fields, &requests, 0);
    record_json(json, response_fields, &response, 0);
    json_end(json, '}');
}

void stats_print_json(const account_t *account, FILE *to)
{
    const response_row_t response = response_of(&account->sum);
    group_t groups[GROUPS];
    json_t json = {.to = to};
    list_groups(account, groups);
    json_begin(&json, NULL, '{');
    json_value(&json, "time_us", "%" PRIu64, account->time_us);
    record_json(&json, attempt_fields, &account->sum, 0);
    record_json(&json, total_fields, account, account->has_median ? MEDIAN : 0);
    put_failures(&json, account);
    for (size_t i = 0; i != GROUPS; i++) put_group(&json, &groups[i], account);
    record_json(&json, response_fields, &response, 0);
    json_begin(&json, "sensors", '[');
    for (size_t i = 0; i != account->sensor_count; i++)
        if (mode_is_asked(account->sensors[i]->mode)) put_sensor(&json, account->sensors[i]);
    json_end(&json, ']');
    json_end(&json, '}');
    (void)fputs("\n", to);
}

void stats_json_of_sensor(json_t *json, sensor_t *sensor)
{
    const account_t account = {.sum = sensor->counters, .sensors = &sensor, .sensor_count = 1};
    const response_row_t response = response_of(&sensor->counters);
    group_t groups[GROUPS];
    list_groups(&account, groups);
    record_json(json, attempt_fields, &sensor->counters, 0);
    put_failures(json, &account);
    for (size_t i = 0; i != GROUPS; i++)
        if (groups[i].is_there) put_group(json, &groups[i], &account);
    record_json(json, response_fields, &response, 0);
}
