/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include "reading/loop.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "output/words.h"

/*
 * ALARM_US: the latest time at which the loop notices that an alarm had no distance for too long.
 * AGAIN_US, CONNECTION_US: when a sensor that ends, and a connection that is not established yet, are polled again.
 */
enum { ALARM_US = 100000, AGAIN_US = 1000, CONNECTION_US = 500000, TEXT = 512 };

uint64_t loop_now_us(const loop_t *loop) { return loop->host->now_us(loop->host->ctx); }

uint64_t loop_time_us(const loop_t *loop) { return loop_now_us(loop) - loop->start_us; }

void loop_stop(loop_t *loop) { loop->is_stopped = true; }

static bool is_over_time(const loop_t *loop)
{
    return loop->site.duration_us != 0 && loop_time_us(loop) >= loop->site.duration_us;
}

/* Returns true if the loop has to end, whatever is left to read. */
static bool is_over(const loop_t *loop)
{
    const host_t *const host = loop->host;
    return loop->is_stopped || host->has_ended(host->ctx) || host->is_output_gone(host->ctx) ||
           is_over_time(loop);
}

/* Returns true if a line is read, or will be. */
static bool has_lines(const loop_t *loop)
{
    const line_t *line = loop->site.lines;
    while (line != NULL && line->state >= LINE_ENDING) line = line->next;
    return line != NULL;
}

/* ---- what the sink gets ---- */

static void notify(const loop_t *loop, notice_kind_t kind, const sensor_t *sensor, const char *text)
{
    const notice_t notice = {kind, sensor, text};
    loop->sink->notice(loop->ctx, &notice);
}

static void notify_port(line_t *line, notice_kind_t kind, const char *before, const char *text)
{
    char whole[TEXT];
    (void)snprintf(whole, sizeof whole, "%s: %s", before, text);
    notify(line->loop, kind, NULL, whole);
}

void notice_print(void *ctx, const notice_t *notice)
{
    const sensor_t *const sensor = notice->sensor;
    (void)ctx;
    (void)fprintf(stderr, "fathom: %s%s%s\n", sensor != NULL ? sensor->name : "", sensor != NULL ? ": " : "",
                  notice->text);
}

static void pass(const loop_t *loop, reading_t reading)
{
    const host_t *const host = loop->host;
    const uint64_t now_us = loop_now_us(loop);
    const uint64_t then_us = time_extend(now_us, reading.result->sample.time_us);
    reading.time_us = then_us - loop->start_us;
    reading.utc_us = utc_before(host->utc_us(host->ctx), now_us - then_us);
    loop->sink->reading(loop->ctx, &reading);
}

/* failure: NULL if the port is waited for. probe: 0 if the failure is not of one alone. */
static void report_failure(const loop_t *loop, sensor_t *sensor, const failure_t *failure, size_t kind,
                           uint8_t probe)
{
    const result_t result = {.sample = {.time_us = (uint32_t)loop_now_us(loop),
                                        .kind = FATHOM_UNKNOWN,
                                        .address = sensor->address,
                                        .probe = sensor->model->probes == 1 ? 1 : probe}};
    pass(loop, (reading_t){.sensor = sensor,
                           .status = failure != NULL ? failure->status : FATHOM_ERR_PORT,
                           .failure = status_word_of_failure(kind),
                           .evidence = failure,
                           .result = &result});
}

/* ---- results: a median, then a level or an alarm ---- */

/* Starts to compute results, before the first sample. The first state of an alarm is reported when a distance decides it,
 * or unknown_us after the start. */
static void results_start(sensor_t *sensor, uint32_t now_us)
{
    const results_config_t *const config = &sensor->processing;
    for (size_t p = 0; p != FATHOM_DYP_PROBES; p++) {
        result_probe_t *const probe = &sensor->probes[p];
        const fathom_median_config_t median = {.window = probe->window,
                                               .unknown_us = config->unknown_us,
                                               .gate_mm = config->gate_mm,
                                               .count = config->median};
        memset(probe, 0, sizeof *probe);
        if (config->median != 0) (void)fathom_median_init(&probe->median, &median);
        if (!config->has_alarm) continue;
        (void)fathom_alarm_init(&probe->alarm, &config->alarm);
        (void)fathom_alarm_add_status(&probe->alarm, FATHOM_PENDING, now_us);
        probe->began_us = now_us;
    }
}

static void report_result(loop_t *loop, sensor_t *sensor, result_t *result)
{
    const results_config_t *const config = &sensor->processing;
    const fathom_sample_t *const sample = &result->sample;
    result->has_level =
        config->has_level && sample->kind == FATHOM_TARGET &&
        fathom_level_from_distance(&config->tank, sample->distance_mm, &result->level) == FATHOM_OK;
    pass(loop, (reading_t){.sensor = sensor, .status = FATHOM_OK, .result = result});
}

static void report_change(loop_t *loop, sensor_t *sensor, result_t *result)
{
    result_probe_t *const probe = &sensor->probes[result->sample.probe - 1];
    probe->is_known = true;
    result->alarm = probe->alarm.state;
    result->is_on = fathom_alarm_is_on(&probe->alarm);
    report_result(loop, sensor, result);
}

/* Tells the alarm what was received at now_us instead of a distance. */
static void add_status(loop_t *loop, sensor_t *sensor, uint8_t number, fathom_status_t status,
                       uint32_t now_us)
{
    result_probe_t *const probe = &sensor->probes[number - 1];
    result_t result = {.sample = {.time_us = now_us,
                                  .kind = FATHOM_UNKNOWN,
                                  .model = (uint8_t)sensor->model->id,
                                  .address = sensor->address,
                                  .probe = number}};
    const bool has_changed = fathom_alarm_add_status(&probe->alarm, status, now_us);
    const bool is_late =
        !probe->is_known && fathom_elapsed_us(now_us, probe->began_us) > probe->alarm.config.unknown_us;
    if (has_changed || is_late) report_change(loop, sensor, &result);
}

/* Computes the median. False: there is none yet. A sample that the median ignores stays as it is. */
static bool add_to_median(result_probe_t *probe, fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_UNKNOWN || sample->kind == FATHOM_FAULT) return true;
    const bool has_median = fathom_median_add_sample(&probe->median, sample, sample);
    probe->dropped += probe->median.dropped;
    probe->median.dropped = 0;
    return has_median;
}

static void results_sample(loop_t *loop, sensor_t *sensor, const fathom_sample_t *sample)
{
    const results_config_t *const config = &sensor->processing;
    result_probe_t *const probe = &sensor->probes[sample->probe - 1];
    result_t result = {.sample = *sample};
    const bool has_result = config->median == 0 || add_to_median(probe, &result.sample);
    if (has_result && (!config->has_alarm || config->has_readings)) report_result(loop, sensor, &result);
    if (!config->has_alarm) return;
    if (!has_result)
        add_status(loop, sensor, sample->probe, FATHOM_OK, sample->time_us);
    else if (fathom_alarm_add_sample(&probe->alarm, &result.sample))
        report_change(loop, sensor, &result);
}

/* A response whose value of one probe was refused is a response of all probes. */
static void results_status(loop_t *loop, sensor_t *sensor, fathom_status_t status)
{
    if (!sensor->processing.has_alarm) return;
    const uint32_t now_us = (uint32_t)loop_now_us(loop);
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        if (sensor_has_probe(sensor, probe)) add_status(loop, sensor, probe, status, now_us);
}

/* ---- what was received, and from whom ---- */

static bool is_shared(const line_t *line) { return line->settings.station_count > 1; }

/* The listener of the sensor whose request is about to be sent, which the line has put first. */
static listener_t *find_listener(void *ctx)
{
    const line_t *const line = ctx;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (reader_has_sent(sensor->reader, line->port.line.head)) return sensor->listener;
    return NULL;
}

/* Returns the sensor that sends with this address on the line; NULL: none. */
static sensor_t *sensor_at(const line_t *line, uint8_t address)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (sensor->mode->has_address && sensor->address == address) return sensor;
    return NULL;
}

/* Counts late responses for the sensor that sent them: they explain its failures, and not those of the sensor whose
 * request is pending. */
static void count_late(line_t *line)
{
    const port_t *const port = &line->port;
    if (!is_shared(line) || port->counters[FATHOM_LINE_LATE_RESPONSES] == 0) return;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        evidence_t evidence;
        if (port->listener.now != sensor->listener) continue;
        listener_judge(sensor->listener, sensor->address, &evidence);
        sensor_t *const other = evidence.foreign != 0 ? sensor_at(line, evidence.foreign_address) : NULL;
        counters_take_late(other != NULL ? &other->counters : &sensor->counters, &line->port);
        return;
    }
}

/* Returns true if another sensor on this line gave a reading. */
static bool others_answer(const line_t *line, const sensor_t *sensor)
{
    for (const sensor_t *other = line->sensors; other != NULL; other = other->next)
        if (other != sensor && other->counters.readings != 0) return true;
    return false;
}

/* A late response of another sensor that is read on this line is no evidence of a stranger. */
static void judge(const line_t *line, const sensor_t *sensor, evidence_t *evidence)
{
    listener_judge(sensor->listener, sensor->mode->has_address ? sensor->address : 0, evidence);
    if (evidence->foreign == 0 || sensor_at(line, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- attempts ---- */

/* Returns true if `more` further attempts are the last ones of the sensor (--count). */
static bool is_finished(const loop_t *loop, const sensor_t *sensor, unsigned more)
{
    return loop->site.count != 0 && sensor->counters.attempts + more >= loop->site.count;
}

/* What is received and counted from now on belongs to the next attempt. */
static void start_attempt(sensor_t *sensor)
{
    counters_begin_attempt(&sensor->counters);
    listener_forget(sensor->listener);
}

static void end_attempt(const loop_t *loop, sensor_t *sensor)
{
    const uint64_t now_us = loop_now_us(loop);
    sensor->counters.attempts++;
    if (sensor->has_failed) sensor->counters.failed++;
    sensor->has_failed = false;
    sensor->answering = false;
    sensor->next_us += sensor->settings.period_us;
    if (sensor->next_us < now_us) sensor->next_us = now_us; /* no attempts in a burst after a delay */
    start_attempt(sensor);
}

/*
 * A sensor that sends automatically does not keep the user's interval: the responses between two attempts are dropped as
 * a whole. A driver that sends requests keeps the interval itself.
 */
static bool is_early(const loop_t *loop, sensor_t *sensor, fathom_status_t status)
{
    if (!mode_is_automatic(sensor->mode) || sensor->answering) return false;
    const bool is_first = !sensor->skipping;
    if (is_first) sensor->skipping = loop_now_us(loop) < sensor->next_us;
    if (!sensor->skipping) return false;
    const bool is_late = status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    if (is_first && !is_late) sensor->counters.skipped++;
    sensor->skipping = reader_has_more(sensor->reader);
    start_attempt(sensor);
    return true;
}

/* Returns true if the sensor delivers more than one probe. */
static bool has_probes(const sensor_t *sensor)
{
    const uint8_t probes = sensor->settings.probes;
    return sensor->model->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

static failure_t failure_of(const line_t *line, const sensor_t *sensor, fathom_status_t status)
{
    failure_t failure = {
        .status = status,
        .model = sensor->model,
        .mode = sensor->mode,
        .reader = sensor->reader,
        .port = &line->port,
        .counters = &sensor->counters,
        .line = &sensor->line,
        .shared = line->loop->site.sensor_count > 1 ? sensor->name : NULL,
        .noises = sensor->noises,
        .address = sensor->address,
        .others_answer = others_answer(line, sensor),
        .waits = line->state == LINE_WAITING,
    };
    judge(line, sensor, &failure.evidence);
    return failure;
}

/* is_first: of the outcomes of this attempt. is_known: the user knows it from another sensor on the line. */
static void fail(line_t *line, sensor_t *sensor, fathom_status_t status, bool is_first, bool is_known)
{
    loop_t *const loop = line->loop;
    const reader_t *const reader = sensor->reader;
    failure_t failure = failure_of(line, sensor, status);
    failure.is_whole = is_first && !reader_has_more(reader) && has_probes(sensor);
    failure.is_told = is_known;
    const size_t kind = counters_failure_kind(status, reader);
    sensor->counters.failures[kind]++;
    sensor->has_failed = true;
    report_failure(loop, sensor, &failure, kind,
                   status == FATHOM_ERR_MALFORMED ? reader_facts(reader).refused_probe : 0);
    results_status(loop, sensor, status);
}

/* Good readings do not show that other frames are damaged. */
static void remark_damage(const line_t *line, sensor_t *sensor)
{
    const unsigned share = counters_take_damage(&sensor->counters);
    if (share == 0) return;
    char text[2 * TEXT] = "";
    failure_t failure = failure_of(line, sensor, FATHOM_OK);
    FILE *const to = fmemopen(text, sizeof text - 1, "w");
    if (to == NULL) return;
    failure.damaged = (uint8_t)share;
    advice_print_cause(to, &failure);
    (void)fclose(to);
    notify(line->loop, NOTICE_REMARK, sensor, text);
}

/* An attempt of a sensor that has pulses has ended. sample: NULL unless the status is FATHOM_OK. */
static void pulses_add(pulses_t *pulses, const reader_counters_t *counted, const fathom_sample_t *sample)
{
    pulses->noises += counted->noises;
    pulses->missed_edges += counted->missed;
    pulses->lost_events += counted->lost_events;
    if (sample == NULL) return;
    if (sample->kind == FATHOM_NO_TARGET) pulses->no_targets++;
    if (sample->kind == FATHOM_FAULT) pulses->faults++;
    if (sample->kind != FATHOM_TARGET) return;
    if (pulses->distances++ == 0 || sample->raw < pulses->min_us) pulses->min_us = sample->raw;
    if (sample->raw > pulses->max_us) pulses->max_us = sample->raw;
    /* Welford's way, which no sum of large squares makes inexact. */
    const double off_us = sample->raw - pulses->mean_us;
    pulses->mean_us += off_us / (double)pulses->distances;
    pulses->squares += off_us * (sample->raw - pulses->mean_us);
}

/* An outcome of the driver, which is not FATHOM_PENDING. */
static void take_outcome(line_t *line, sensor_t *sensor, fathom_status_t status,
                         const fathom_sample_t *sample)
{
    loop_t *const loop = line->loop;
    const bool is_good = status == FATHOM_OK;
    const reader_counters_t counted = counters_take(&sensor->counters, &line->port, sensor->reader);
    sensor->noises = counted.noises;
    if (sensor->mode->has_pulses) pulses_add(&sensor->pulses, &counted, is_good ? sample : NULL);
    if (!mode_is_asked(sensor->mode)) remark_damage(line, sensor);
    if (status != FATHOM_ERR_PORT && is_early(loop, sensor, status)) return;
    if (is_good && mode_is_asked(sensor->mode) && !sensor->answering)
        counters_time(&sensor->counters, fathom_elapsed_us(sample->time_us, sensor->listener->asked_us));
    const bool is_first = !sensor->answering;
    sensor->answering = true;
    if (is_good) {
        results_sample(loop, sensor, sample);
        sensor->counters.readings++;
        if (sample->kind != FATHOM_UNKNOWN) sensor->has_good = true;
    } else {
        fail(line, sensor, status, is_first, false);
    }
    if (status == FATHOM_ERR_PORT || !reader_has_more(sensor->reader)) end_attempt(loop, sensor);
}

/* ---- a line ---- */

static line_t *line_of(fathom_loop_source_t *source) { return (line_t *)source; }

static const line_t *const_line_of(const fathom_loop_source_t *source) { return (const line_t *)source; }

static bool is_open(const line_t *line) { return line->state == LINE_READING || line->state == LINE_ENDING; }

/* The first sensor gets what the line and the port have counted; the sums are right nevertheless. */
static void take_counters(line_t *line)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (sensor->reader != NULL) (void)counters_take(&sensor->counters, &line->port, sensor->reader);
}

static void give_up(line_t *line)
{
    line->loop->has_failed = true;
    line->state = LINE_LEFT;
}

/* ---- opening it ---- */

/* The user has to know, once, that the interval is longer than the chosen one. */
static void remark_interval(const line_t *line, sensor_t *sensor)
{
    const uint32_t interval_us = sensor->settings.period_us;
    const uint32_t least_us = reader_facts(sensor->reader).least_period_us;
    char text[TEXT];
    if (interval_us == 0 || interval_us >= least_us || sensor->has_raise_notice) return;
    sensor->has_raise_notice = true;
    (void)snprintf(text, sizeof text,
                   "read every %.4g ms, the shortest interval of this sensor (--interval %" PRIu32 ")",
                   least_us / 1000.0, interval_us / 1000);
    notify(line->loop, NOTICE_REMARK, sensor, text);
}

/* False: the user knows why the driver does not accept its settings. */
static bool start_sensor(line_t *line, sensor_t *sensor)
{
    reader_settings_t settings = sensor->settings;
    settings.line = line->settings.has_mixed_lines ? &sensor->line : NULL;
    /* The longest time for which a sensor that does not respond is left alone: it must not slow down the others. */
    settings.backoff_us = is_shared(line) ? READER_BACKOFF_SHARED_US : READER_BACKOFF_US;
    settings.address = sensor->address;
    if (!reader_open(&sensor->reader, sensor->mode, &line->port, &settings)) {
        notify_port(line, NOTICE_GIVEN_UP, sensor->name, reader_refusal(sensor->reader));
        return false;
    }
    remark_interval(line, sensor);
    if (is_shared(line) && sensor->own_listener == NULL)
        sensor->own_listener = allocate(sizeof *sensor->own_listener);
    sensor->listener = sensor->own_listener != NULL ? sensor->own_listener : &line->port.listener;
    start_attempt(sensor);
    sensor->next_us = loop_now_us(line->loop);
    sensor->skipping = false;
    sensor->answering = false;
    return true;
}

/* Another program at the port is reported once, also if it opens and closes the port again and again. */
static void notify_holder(line_t *line)
{
    char text[TEXT - 64];
    const uint32_t holder = advice_at_opening(text, sizeof text, &line->port);
    if (holder != 0 && holder != line->holder) notify_port(line, NOTICE_REMARK, line->port.name, text);
    if (holder != 0) line->holder = holder;
}

/* False: a driver does not accept its settings. */
static bool start_reading(line_t *line)
{
    bool is_good = true;
    for (sensor_t *sensor = line->sensors; sensor != NULL && is_good; sensor = sensor->next)
        is_good = start_sensor(line, sensor);
    if (!is_good) {
        give_up(line);
        return false;
    }
    line->port.listener.whose = is_shared(line) ? find_listener : NULL;
    line->port.listener.ctx = line;
    if (line->is_lost && line->was_open) line->loop->reconnects++;
    if (line->is_lost)
        notify_port(line, NOTICE_OPEN, line->port.name,
                    line->was_open ? "it is back; reading goes on" : "it is there; reading begins");
    notify_holder(line);
    line->is_lost = false;
    line->was_open = true;
    line->state = LINE_READING;
    return true;
}

/* The port could not be opened when the command began. If there are others, their readings show that it is right to
 * wait. */
static void miss(line_t *line)
{
    const site_t *const site = &line->loop->site;
    const bool may_come = line->port.error == PORT_ABSENT || site->line_count > 1 || site->persists;
    line->is_lost = true;
    if (site->reconnect && may_come) {
        char text[TEXT];
        (void)snprintf(text, sizeof text, "%s; waiting until it is there", line->port.error_text);
        notify(line->loop, NOTICE_WAITING, NULL, text);
        line->state = LINE_WAITING;
    } else {
        notify(line->loop, NOTICE_GIVEN_UP, NULL, line->port.error_text);
        give_up(line);
    }
}

/* How the adapter is found again. */
static void notify_advice(line_t *line)
{
    const char *const advice = adapter_advice(&line->port.adapter);
    if (advice != NULL) notify_port(line, NOTICE_WAITING, line->port.name, advice);
}

static void fail_to_open(line_t *line)
{
    if (!line->is_lost) miss(line);
    if (line->state == LINE_LEFT) return;
    line->state = LINE_WAITING;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (!is_finished(line->loop, sensor, 0))
            report_failure(line->loop, sensor, NULL, (size_t)-FATHOM_ERR_PORT, 0);
    /* The user has to know, some time, about a port that is there and cannot be opened. */
    if (line->port.failures == PORT_TRIES)
        notify_port(line, NOTICE_WAITING, "still waiting", line->port.error_text);
    notify_advice(line);
}

/* The status of a port that was closed or connects. False: it is not open. */
static bool take_port(line_t *line, fathom_status_t status)
{
    if (status == FATHOM_OK) return start_reading(line);
    if (status == FATHOM_PENDING)
        line->state = LINE_CONNECTING;
    else
        fail_to_open(line);
    return status == FATHOM_PENDING;
}

static bool open_line(fathom_loop_source_t *source)
{
    line_t *const line = line_of(source);
    if (line->state >= LINE_ENDING) return false;
    const fathom_status_t status = port_open(&line->port, line->loop->host, &line->settings, source);
    if (take_port(line, status)) return true;
    if (status == FATHOM_OK) port_close(&line->port);
    return false;
}

static void close_line(fathom_loop_source_t *source) { port_close(&line_of(source)->port); }

/* ---- losing it ---- */

/* The attempt of each sensor fails. The line waits if there is anything left to read after that. */
static void lose(line_t *line)
{
    const loop_t *const loop = line->loop;
    bool has_more = false;
    bool is_known = false;
    for (const sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (!is_finished(loop, sensor, 1)) has_more = true;
    line->state = loop->site.reconnect && has_more ? LINE_WAITING : LINE_LEFT;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        if (is_finished(loop, sensor, 0)) continue;
        (void)counters_take(&sensor->counters, &line->port, sensor->reader);
        fail(line, sensor, FATHOM_ERR_PORT, false, is_known);
        end_attempt(loop, sensor);
        is_known = true;
    }
    take_counters(line); /* those of the line and the port are lost when the port is closed */
    if (line->state == LINE_WAITING) notify_advice(line);
}

/* ---- polling it ---- */

static int line_fd(const fathom_loop_source_t *source) { return port_fd(&const_line_of(source)->port); }

static short line_events(const fathom_loop_source_t *source)
{
    return port_events(&const_line_of(source)->port);
}

static void poll_sensor(line_t *line, sensor_t *sensor)
{
    do {
        fathom_sample_t sample;
        const fathom_status_t status = reader_poll(sensor->reader, &sample);
        const char *const text = reader_remark(sensor->reader);
        if (text != NULL) notify(line->loop, NOTICE_REMARK, sensor, text);
        count_late(line);
        /* Between two requests a driver does not report a lost port, and waiting for the port would return at once. */
        line->is_lost = port_poll(&line->port) == FATHOM_ERR_PORT;
        if (status == FATHOM_PENDING || (line->is_lost && status == FATHOM_ERR_PORT)) return;
        take_outcome(line, sensor, status, &sample);
    } while (reader_has_more(sensor->reader));
}

/* A sensor that had all its attempts is not polled, and sends no more requests. */
static void poll_sensors(line_t *line)
{
    bool is_done = true;
    for (sensor_t *sensor = line->sensors; sensor != NULL && !line->is_lost; sensor = sensor->next) {
        if (is_finished(line->loop, sensor, 0)) continue;
        poll_sensor(line, sensor);
        if (!is_finished(line->loop, sensor, 0)) is_done = false;
    }
    if (is_done) line->state = LINE_ENDING;
}

/* Lets the sensors leave their devices as they were before: the driver of some adapters does not end a break when the port
 * is closed. False: call it again. */
static bool end_sensors(line_t *line)
{
    bool has_ended = true;
    for (sensor_t *sensor = line->sensors; sensor != NULL && is_open(line); sensor = sensor->next)
        if (reader_close(sensor->reader) == FATHOM_PENDING) has_ended = false;
    return has_ended;
}

static bool poll_line(fathom_loop_source_t *source)
{
    line_t *const line = line_of(source);
    if (line->state == LINE_CONNECTING && !take_port(line, port_poll(&line->port))) return false;
    if (line->state == LINE_CONNECTING) source->is_readable = false; /* nothing is read yet */
    if (line->state == LINE_READING && !is_over(line->loop)) poll_sensors(line);
    if (line->is_lost && is_open(line)) {
        lose(line);
        return false;
    }
    if (line->state != LINE_ENDING || !end_sensors(line)) return true;
    take_counters(line);
    line->state = LINE_LEFT;
    return false;
}

static uint32_t due_us(fathom_loop_source_t *source)
{
    const line_t *const line = line_of(source);
    uint32_t soonest_us = FATHOM_NO_DEADLINE;
    if (line->state == LINE_CONNECTING) return CONNECTION_US;
    if (line->state != LINE_READING) return AGAIN_US;
    soonest_us = port_due_us(&line->port);
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        if (is_finished(line->loop, sensor, 0)) continue;
        const uint32_t this_us = reader_due_us(sensor->reader);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

/* ---- all lines ---- */

/* Adds a line to the loop's sources, and tries to open its port. */
static void start_line(loop_t *loop, line_t *line)
{
    static const fathom_loop_kind_t kind = {open_line, close_line, line_fd, line_events,
                                            poll_line, due_us,     NULL};
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        sensor->is_named = loop->site.sensor_count > 1 || sensor->has_own_name;
        results_start(sensor, (uint32_t)loop_now_us(loop));
    }
    line->loop = loop;
    line->source.kind = &kind;
    line->state = LINE_WAITING;
    fathom_loop_add(&loop->sources, &line->source);
}

static void start_lines(loop_t *loop)
{
    const host_t *const host = loop->host;
    loop->has_new = false;
    loop->has_alarms = false;
    for (size_t i = 0; i != loop->site.sensor_count; i++)
        if (loop->site.sensors[i]->processing.has_alarm) loop->has_alarms = true;
    for (line_t *line = loop->site.lines; line != NULL && !host->has_ended(host->ctx); line = line->next)
        if (line->state == LINE_NEW) start_line(loop, line);
}

/* Returns the time until it has to be called again. */
static uint32_t pass_alarms(loop_t *loop)
{
    if (!loop->has_alarms) return FATHOM_NO_DEADLINE;
    for (size_t i = 0; i != loop->site.sensor_count; i++) {
        sensor_t *const sensor = loop->site.sensors[i];
        if (!is_finished(loop, sensor, 0)) results_status(loop, sensor, FATHOM_PENDING);
    }
    return ALARM_US;
}

static uint32_t sleep_us(loop_t *loop)
{
    const uint64_t duration_us = loop->site.duration_us;
    uint32_t longest_us = loop->sink->tick(loop->ctx);
    if (loop->has_new) start_lines(loop);
    const uint32_t alarms_us = pass_alarms(loop);
    if (alarms_us < longest_us) longest_us = alarms_us;
    if (duration_us == 0) return longest_us;
    const uint64_t time_us = loop_time_us(loop);
    const uint64_t left_us = time_us < duration_us ? duration_us - time_us : 0;
    return left_us < longest_us ? (uint32_t)left_us : longest_us;
}

void loop_run(loop_t *loop)
{
    while (!is_over(loop) && has_lines(loop)) {
        const uint32_t longest_us = sleep_us(loop);
        if (!loop->is_stopped) fathom_loop_step(&loop->sources, longest_us);
    }
}

void loop_init(loop_t *loop, const host_t *host, const sink_t *sink, void *ctx)
{
    memset(loop, 0, sizeof *loop);
    loop->host = host;
    loop->start_us = loop_now_us(loop);
    loop->sink = sink;
    loop->ctx = ctx;
}

bool loop_open(loop_t *loop)
{
    const host_t *const host = loop->host;
    if (fathom_loop_init(&loop->sources, &host->loop) != FATHOM_POSIX_OK) {
        notify(loop, NOTICE_GIVEN_UP, NULL, "the system has no descriptor left; end other programs");
        return false;
    }
    host->attend(host->ctx, &loop->sources);
    start_lines(loop);
    return has_lines(loop);
}

void loop_check_clock(const loop_t *loop)
{
    const uint64_t utc_us = loop->host->utc_us(loop->host->ctx);
    char utc[UTC_TEXT];
    char text[TEXT];
    if (utc_before(utc_us, 0) != 0) return;
    (void)snprintf(
        text, sizeof text,
        "this machine's clock says %.10s. Until it is set, readings have no date (utc). Set it, for "
        "example by NTP.",
        utc_text(utc_us + 1, utc)); /* 0 has no text */
    notify(loop, NOTICE_REMARK, NULL, text);
}

/* Waits until the sensors have left their devices as they were, at most TIMES. */
void loop_close(loop_t *loop)
{
    enum { TIMES = 1000 };
    const host_t *const host = loop->host;
    bool has_ended = false;
    for (unsigned times = 0; times != TIMES && !has_ended; times++) {
        if (times != 0) host->wait(host->ctx, -1, 0, AGAIN_US, false);
        has_ended = true;
        for (line_t *line = loop->site.lines; line != NULL; line = line->next)
            if (!end_sensors(line)) has_ended = false;
    }
    fathom_loop_deinit(&loop->sources);
}

void loop_deinit(loop_t *loop) { site_free(&loop->site); }

/* Returns true if a request on the line is pending. */
static bool is_busy(const line_t *line)
{
    for (const sensor_t *sensor = line->sensors; sensor != NULL && is_open(line); sensor = sensor->next)
        if (reader_facts(sensor->reader).is_in_progress) return true;
    return false;
}

bool loop_set_site(loop_t *loop, site_t *site, bool is_urgent, site_t *old)
{
    site_keep(site, &loop->site);
    for (const line_t *line = loop->site.lines; line != NULL && !is_urgent; line = line->next)
        if (is_busy(line)) {
            site_keep(&loop->site, site);
            return false;
        }
    for (line_t *line = loop->site.lines; line != NULL; line = line->next) {
        (void)end_sensors(line);
        if (line->source.loop != NULL) fathom_loop_remove(&line->source);
    }
    *old = loop->site;
    loop->site = *site;
    *site = (site_t){.lines = NULL};
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

bool loop_is_good(const loop_t *loop)
{
    for (const line_t *line = loop->site.lines; line != NULL; line = line->next)
        for (const sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
            const bool is_silent = sensor->counters.readings == 0;
            if (sensor->counters.failed != 0) return false;
            if (!sensor->has_good && (!is_silent || (is_over_time(loop) && !line->is_lost))) return false;
        }
    return !loop->has_failed;
}

account_t account_of(sensor_t *const *sensors, size_t count)
{
    account_t account = {.sensors = sensors,
                         .sensor_count = count,
                         .response_min_us = NO_VALUE,
                         .response_mean_us = NO_VALUE,
                         .response_max_us = NO_VALUE};
    counters_t *const sum = &account.sum;
    for (size_t i = 0; i != count; i++) {
        const sensor_t *const sensor = sensors[i];
        const reader_facts_t facts = reader_facts(sensor->reader);
        counters_add(sum, &sensor->counters);
        if (sensor->listener != NULL) account.requests += (int64_t)sensor->listener->requests;
        if (sensor->processing.median != 0) account.has_median = true;
        if (!mode_is_asked(sensor->mode)) account.has_stream = true;
        for (size_t p = 0; p != FATHOM_DYP_PROBES; p++)
            account.dropped_spikes += (int64_t)sensor->probes[p].dropped;
        account.timeouts_in_row = facts.timeouts_in_row;
        account.backoff_left_us = facts.backoff_left_us;
    }
    if (sum->timed == 0) return account;
    account.response_min_us = sum->time_min_us;
    account.response_mean_us = (int64_t)(sum->time_sum_us / sum->timed);
    account.response_max_us = sum->time_max_us;
    return account;
}

void loop_account(loop_t *loop, account_t *account)
{
    for (line_t *line = loop->site.lines; line != NULL; line = line->next) take_counters(line);
    *account = account_of(loop->site.sensors, loop->site.sensor_count);
    account->time_us = (int64_t)loop_time_us(loop);
    account->reconnects = (int64_t)loop->reconnects;
    for (const line_t *line = loop->site.lines; line != NULL; line = line->next) {
        account->reconnects += line->port.reconnects;
        if (line->port.counts_errors) account->has_port = true;
    }
}
