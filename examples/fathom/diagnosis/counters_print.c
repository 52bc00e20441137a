/* SPDX-License-Identifier: MIT */
#include "diagnosis/counters_print.h"

#include <inttypes.h>
#include <string.h>

/* Also the members of the JSON object (counters_member). */
static const char *const line_names[FATHOM_LINE_COUNTERS] = {
    [FATHOM_LINE_RESPONSES] = "responses",
    [FATHOM_LINE_DROPPED_BYTES] = "bytes of no frame",
    [FATHOM_LINE_PORT_ERRORS] = "port errors",
    [FATHOM_LINE_NO_RESPONSES] = "requests without a response",
    [FATHOM_LINE_CHECKSUM_ERRORS] = "damaged responses",
    [FATHOM_LINE_EXCEPTIONS] = "exceptions",
    [FATHOM_LINE_MALFORMED] = "responses that do not fit",
    [FATHOM_LINE_LATE_RESPONSES] = "late responses",
    [FATHOM_LINE_STRAYS] = "unasked frames",
    [FATHOM_LINE_BAD_BYTES] = "bad bytes",
    [FATHOM_LINE_OLD_BYTES] = "old bytes",
    [FATHOM_LINE_BUSY_ATTEMPTS] = "busy lines",
    [FATHOM_LINE_OTHER_MASTERS] = "attempts disturbed by another master",
    [FATHOM_LINE_FOREIGN_REQUESTS] = "requests of other masters",
    [FATHOM_LINE_MAYBE_UNSOLICITED] = "responses that may be unasked",
};

static const char *const stream_names[FATHOM_STREAM_COUNTERS] = {
    [FATHOM_STREAM_FRAMES] = "frames",
    [FATHOM_STREAM_MISSED] = "missed frames",
    [FATHOM_STREAM_AMBIGUOUS] = "ambiguous frames",
    [FATHOM_STREAM_UNSURE] = "unsure frames",
    [FATHOM_STREAM_STALES] = "stale",
    [FATHOM_STREAM_BYTES] = "bytes",
    [FATHOM_STREAM_DROPPED_BYTES] = "dropped bytes",
    [FATHOM_STREAM_DAMAGED] = "damaged frames",
};

static const char *const unit_names[UNIT_COUNTERS] = {
    [UNIT_RESPONSES] = "responses",
    [UNIT_FAILURES] = "failures",
};

static const char *const port_names[PORT_COUNTERS] = {
    [PORT_PARITY] = "parity errors",
    [PORT_FRAMING] = "framing errors",
    [PORT_OVERRUN] = "overruns",
    [PORT_BREAKS] = "breaks",
};

enum { GROUPS = 5 };

typedef struct {
    const char *name;
    const char *const *names;
    const uint64_t *counts;
    size_t count;
    bool is_there; /* it means something for these sensors and this port */
} group_t;

/* Is there a sensor that is asked, or that is not? */
static bool has_some(const account_t *account, bool is_asked)
{
    for (size_t i = 0; i != account->sensor_count; i++)
        if (mode_is_asked(account->sensors[i]->mode) == is_asked) return true;
    return false;
}

static void get_groups(group_t groups[GROUPS], const char *const failure_names[FAILURE_KINDS],
                       const account_t *account)
{
    const counts_t *const total = &account->sum.total;
    const group_t all[GROUPS] = {
        {"failures", failure_names, account->sum.failures, FAILURE_KINDS, true},
        {"line", line_names, total->line, FATHOM_LINE_COUNTERS, true},
        {"stream", stream_names, total->stream, FATHOM_STREAM_COUNTERS, has_some(account, false)},
        {"unit", unit_names, total->unit, UNIT_COUNTERS, has_some(account, true)},
        {"port", port_names, total->port, PORT_COUNTERS, account->has_port},
    };
    memcpy(groups, all, sizeof all);
}

static void get_failure_names(const char *names[FAILURE_KINDS])
{
    for (size_t i = 0; i != FAILURE_KINDS; i++) names[i] = counters_failure_name(i);
}

/* ---- for people ---- */

static bool print(FILE *to, const uint64_t *counts, const char *const *names, size_t count, bool is_first)
{
    for (size_t i = 0; i != count; i++) {
        if (counts[i] == 0 || names[i] == NULL) continue;
        (void)fprintf(to, "%s%s %" PRIu64, is_first ? "fathom: line: " : ", ", names[i], counts[i]);
        is_first = false;
    }
    return is_first;
}

/* of: "" or "a16:1: ". */
static void print_attempts(const counters_t *counters, FILE *to, const char *of, const char *gap)
{
    (void)fprintf(to, "fathom: %s%sattempts %" PRIu64 ", failed %" PRIu64 ", readings %" PRIu64, of, gap,
                  counters->attempts, counters->failed, counters->readings);
}

/* Time-outs in a row, and for how long the driver leaves it alone because of them. */
static void print_back_off(const sensor_t *sensor, FILE *to)
{
    (void)fprintf(to, ", time-outs in a row %u, left alone for %.1f s",
                  reader_facts(sensor->reader).timeouts_in_row,
                  reader_facts(sensor->reader).backoff_left_us / 1000000.0);
}

void counters_print(const account_t *account, FILE *to)
{
    const counts_t *const total = &account->sum.total;
    print_attempts(&account->sum, to, "", "");
    (void)fputs("\n", to);
    for (size_t i = 0; i != account->sensor_count && account->sensor_count > 1; i++) {
        const sensor_t *const sensor = account->sensors[i];
        print_attempts(&sensor->counters, to, sensor->name, ": ");
        if (reader_facts(sensor->reader).timeouts_in_row != 0) print_back_off(sensor, to);
        (void)fputs("\n", to);
    }
    bool is_empty = print(to, total->stream, stream_names, FATHOM_STREAM_COUNTERS, true);
    is_empty = print(to, total->line, line_names, FATHOM_LINE_COUNTERS, is_empty);
    if (!is_empty) (void)fputs("\n", to);
}

static double mean_us(const counters_t *counters)
{
    return (double)counters->time_sum_us / (double)counters->timed;
}

static void print_time(const counters_t *counters, FILE *to, const char *start)
{
    if (counters->timed == 0) return;
    (void)fprintf(to, "%stime to answer: shortest %.1f ms, mean %.1f ms, longest %.1f ms", start,
                  counters->time_min_us / 1000.0, mean_us(counters) / 1000.0, counters->time_max_us / 1000.0);
}

static void print_unit(const sensor_t *sensor, FILE *to)
{
    const uint64_t *const unit = sensor->counters.total.unit;
    print_attempts(&sensor->counters, to, sensor->name, ": ");
    (void)fprintf(to, ", responses %" PRIu64 ", failures %" PRIu64, unit[UNIT_RESPONSES],
                  unit[UNIT_FAILURES]);
    print_back_off(sensor, to);
    print_time(&sensor->counters, to, ", ");
    (void)fputs("\n", to);
}

void counters_print_all(const account_t *account, FILE *to)
{
    group_t groups[GROUPS];
    const char *failure_names[FAILURE_KINDS];
    get_failure_names(failure_names);
    get_groups(groups, failure_names, account);
    print_attempts(&account->sum, to, "", "");
    (void)fprintf(to, "\nfathom: requests %" PRIu64 ", skipped frames %" PRIu64 ", reconnects %" PRIu64 "\n",
                  account->requests, account->sum.skipped, account->reconnects);
    for (size_t g = 0; g != GROUPS; g++) {
        const group_t *const group = &groups[g];
        const char *gap = ": ";
        if (!group->is_there) continue;
        (void)fprintf(to, "fathom: %s", group->name);
        for (size_t i = 0; i != group->count; i++) {
            if (group->names[i] == NULL) continue;
            (void)fprintf(to, "%s%s %" PRIu64, gap, group->names[i], group->counts[i]);
            gap = ", ";
        }
        (void)fputs("\n", to);
    }
    for (size_t i = 0; i != account->sensor_count; i++)
        if (mode_is_asked(account->sensors[i]->mode)) print_unit(account->sensors[i], to);
}

/* ---- for programs ---- */

static void print_name(FILE *to, const char *name)
{
    char member[COUNTERS_MEMBER];
    (void)fprintf(to, "\"%s\":", counters_member(name, member));
}

static void print_json_attempts(const counters_t *counters, FILE *to)
{
    (void)fprintf(to, "\"attempts\":%" PRIu64 ",\"failed\":%" PRIu64 ",\"readings\":%" PRIu64,
                  counters->attempts, counters->failed, counters->readings);
}

static void print_json_time(const counters_t *counters, FILE *to)
{
    if (counters->timed != 0)
        (void)fprintf(to,
                      ",\"response_us\":{\"responses\":%" PRIu64 ",\"min\":%" PRIu32
                      ",\"mean\":%.0f,\"max\":%" PRIu32 "}",
                      counters->timed, counters->time_min_us, mean_us(counters), counters->time_max_us);
    else
        (void)fputs(",\"response_us\":null", to);
}

static void print_json_group(const group_t *group, FILE *to)
{
    const char *gap = "{";
    (void)fputs(",", to);
    print_name(to, group->name);
    if (!group->is_there) {
        (void)fputs("null", to);
        return;
    }
    for (size_t i = 0; i != group->count; i++) {
        if (group->names[i] == NULL) continue;
        (void)fputs(gap, to);
        print_name(to, group->names[i]);
        (void)fprintf(to, "%" PRIu64, group->counts[i]);
        gap = ",";
    }
    (void)fputs("}", to);
}

static void print_json_unit(const sensor_t *sensor, FILE *to)
{
    const uint64_t *const counts = sensor->counters.total.unit;
    (void)fprintf(to, "{\"name\":\"%s\",\"sensor\":\"%s\",\"mode\":\"%s\",\"address\":%u,", sensor->name,
                  sensor->model->name, sensor->mode->name, sensor->address);
    print_json_attempts(&sensor->counters, to);
    (void)fprintf(to,
                  ",\"responses\":%" PRIu64 ",\"failures\":%" PRIu64
                  ",\"timeouts_in_row\":%u,\"backoff_left_us\":%" PRIu32,
                  counts[UNIT_RESPONSES], counts[UNIT_FAILURES], reader_facts(sensor->reader).timeouts_in_row,
                  reader_facts(sensor->reader).backoff_left_us);
    print_json_time(&sensor->counters, to);
    (void)fputs("}", to);
}

void counters_print_json(const account_t *account, FILE *to)
{
    group_t groups[GROUPS];
    const char *failure_names[FAILURE_KINDS];
    get_failure_names(failure_names);
    get_groups(groups, failure_names, account);
    (void)fprintf(to, "{\"time_us\":%" PRIu64 ",", account->time_us);
    print_json_attempts(&account->sum, to);
    (void)fprintf(to, ",\"requests\":%" PRIu64 ",\"skipped_frames\":%" PRIu64 ",\"reconnects\":%" PRIu64,
                  account->requests, account->sum.skipped, account->reconnects);
    if (account->has_median) (void)fprintf(to, ",\"dropped_spikes\":%" PRIu64, account->dropped_spikes);
    for (size_t g = 0; g != GROUPS; g++) print_json_group(&groups[g], to);
    print_json_time(&account->sum, to);
    (void)fputs(",\"units\":[", to);
    const char *gap = "";
    for (size_t i = 0; i != account->sensor_count; i++) {
        if (!mode_is_asked(account->sensors[i]->mode)) continue;
        (void)fputs(gap, to);
        print_json_unit(account->sensors[i], to);
        gap = ",";
    }
    (void)fputs("]}\n", to);
}
