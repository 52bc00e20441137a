/* SPDX-License-Identifier: MIT */
#include "reading/loop.h"

#include <string.h>

#include "reading/attempt.h"
#include "reading/line.h"

/* The latest time at which the loop notices that an alarm had no distance for too long. */
enum { ALARM_US = 100000 };

void loop_stop(loop_t *loop) { loop->is_stopped = true; }

static uint32_t pass_alarms(loop_t *loop)
{
    const results_to_t to = attempt_results(loop);
    const uint32_t now_us = (uint32_t)loop_now_us(loop);
    uint32_t due_us = FATHOM_NO_DEADLINE;
    for (size_t i = 0; i != loop->site.sensor_count; i++) {
        sensor_t *const sensor = loop->site.sensors[i];
        if (!sensor->processing.has_alarm) continue;
        due_us = ALARM_US;
        if (!attempt_was_last(loop, sensor)) results_pass(sensor, now_us, &to);
    }
    return due_us;
}

static void start_lines(loop_t *loop);

static uint32_t sleep_us(loop_t *loop)
{
    const uint64_t duration_us = loop->site.duration_us;
    const uint32_t tick_us = loop->sink->tick(loop->ctx);
    if (loop->has_new) start_lines(loop);
    const uint32_t alarm_us = pass_alarms(loop);
    const uint32_t longest_us = tick_us < alarm_us ? tick_us : alarm_us;
    const uint64_t time_us = loop_time_us(loop);
    const uint64_t left_us = time_us < duration_us ? duration_us - time_us : 0;
    return duration_us != 0 && longest_us > left_us ? (uint32_t)left_us : longest_us;
}

/* A source may not be removed while the sources are polled. */
static void remove_left(loop_t *loop)
{
    if (!loop->has_left) return;
    loop->has_left = false;
    for (line_t *line = loop->site.lines; line != NULL; line = line->next)
        if (line->is_left) line_remove(line);
}

void loop_run(loop_t *loop)
{
    while (!loop_is_over(loop)) {
        const uint32_t longest_us = sleep_us(loop);
        if (!loop->is_stopped) fathom_loop_step(&loop->sources, longest_us);
        remove_left(loop);
    }
}

/* ---- open and close ---- */

void loop_init(loop_t *loop, const host_t *host, const sink_t *sink, void *ctx)
{
    memset(loop, 0, sizeof *loop);
    loop->host = host;
    loop->start_us = loop_now_us(loop);
    loop->sink = sink;
    loop->ctx = ctx;
}

static void prepare_sensors(loop_t *loop, const line_t *line)
{
    const uint32_t now_us = (uint32_t)loop_now_us(loop);
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        sensor->is_named = loop->site.sensor_count > 1 || sensor->has_own_name;
        results_start(sensor, now_us);
    }
}

static void start_lines(loop_t *loop)
{
    const host_t *const host = loop->host;
    loop->has_new = false;
    loop->lines_left = 0;
    for (line_t *line = loop->site.lines; line != NULL; line = line->next)
        if (!line->is_done) loop->lines_left++;
    for (line_t *line = loop->site.lines; line != NULL && !host->has_ended(host->ctx); line = line->next) {
        if (line->loop != NULL) continue;
        prepare_sensors(loop, line);
        line_start(line, loop);
    }
    remove_left(loop);
}

static void number_sensors(loop_t *loop)
{
    for (size_t i = 0; i != loop->site.sensor_count; i++) loop->site.sensors[i]->number = i;
}

bool loop_open(loop_t *loop)
{
    const host_t *const host = loop->host;
    number_sensors(loop);
    if (fathom_loop_init(&loop->sources, &host->loop) != FATHOM_POSIX_OK) {
        const notice_t notice = {NOTICE_GIVEN_UP, NULL,
                                 "the system has no descriptor left; end other programs"};
        loop->sink->notice(loop->ctx, &notice);
        return false;
    }
    host->attend(host->ctx, &loop->sources);
    start_lines(loop);
    return loop->lines_left != 0;
}

/* Waits until the sensors have left their devices as they were, at most TIMES. */
static void end_sensors(loop_t *loop)
{
    enum { TIMES = 1000, AGAIN_US = 1000 };
    const host_t *const host = loop->host;
    bool has_ended = false;
    for (unsigned times = 0; times != TIMES && !has_ended; times++) {
        if (times != 0) host->wait(host->ctx, -1, 0, AGAIN_US, false);
        has_ended = true;
        for (line_t *line = loop->site.lines; line != NULL; line = line->next)
            if (!line_end_sensors(line)) has_ended = false;
    }
}

void loop_close(loop_t *loop)
{
    end_sensors(loop);
    fathom_loop_deinit(&loop->sources);
}

void loop_deinit(loop_t *loop) { site_free(&loop->site); }

/* ---- another site ---- */

bool loop_set_site(loop_t *loop, site_t *site, bool is_urgent, site_t *old)
{
    site_keep(site, &loop->site);
    bool is_busy = false;
    for (const line_t *line = loop->site.lines; line != NULL; line = line->next)
        if (line_is_busy(line)) is_busy = true;
    if (is_busy && !is_urgent) {
        site_keep(&loop->site, site);
        return false;
    }
    for (line_t *line = loop->site.lines; line != NULL; line = line->next) {
        if (line->loop == NULL) continue;
        (void)line_end_sensors(line);
        line_remove(line);
    }
    *old = loop->site;
    loop->site = *site;
    *site = (site_t){.lines = NULL};
    number_sensors(loop);
    loop->has_new = true;
    return true;
}

/* ---- what it was like ---- */

bool loop_is_lost(const loop_t *loop)
{
    for (const line_t *line = loop->site.lines; line != NULL; line = line->next)
        if (line->is_lost) return true;
    return false;
}

static bool is_good(const line_t *line, bool is_over_time)
{
    for (const sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        if (sensor->counters.failed != 0) return false;
        if (sensor->has_good) continue;
        if (sensor->counters.readings != 0 || (is_over_time && !line->is_lost)) return false;
    }
    return true;
}

bool loop_is_good(const loop_t *loop)
{
    const uint64_t duration_us = loop->site.duration_us;
    const bool is_over_time = duration_us != 0 && loop_time_us(loop) >= duration_us;
    for (const line_t *line = loop->site.lines; line != NULL; line = line->next)
        if (!is_good(line, is_over_time)) return false;
    return !loop->has_failed;
}

static void add_line(account_t *account, line_t *line)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        /* The first sensor gets what the line counted; the sums are right nevertheless. */
        if (sensor->reader != NULL)
            (void)counters_take(&sensor->counters, &line->counts, &line->port, sensor->reader);
        counters_add(&account->sum, &sensor->counters);
        account->requests += sensor->listener != NULL ? sensor->listener->requests : 0;
    }
    if (line->counts.is_there) account->has_port = true;
}

void loop_account(loop_t *loop, account_t *account)
{
    *account = (account_t){.sensors = loop->site.sensors, .sensor_count = loop->site.sensor_count};
    for (line_t *line = loop->site.lines; line != NULL; line = line->next) add_line(account, line);
    account->reconnects = loop->reconnects;
    account->time_us = loop_time_us(loop);
    for (size_t i = 0; i != loop->site.sensor_count; i++) {
        const sensor_t *const sensor = loop->site.sensors[i];
        if (sensor->processing.median != 0) account->has_median = true;
        account->dropped_spikes += results_dropped(sensor);
    }
}
