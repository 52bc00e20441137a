/* SPDX-License-Identifier: MIT */
#include "reading/line.h"

#include "reading/attempt.h"

/* The most polls of the sensors in a row, so that no line keeps the others waiting; when a sensor that ends, and a
 * connection that is not established yet, are polled again. */
enum { TURNS = 16, AGAIN_US = 1000, CONNECTION_US = 500000, TEXT = 512 };

static line_t *line_of(fathom_loop_source_t *source) { return (line_t *)source; }

static const line_t *const_line_of(const fathom_loop_source_t *source) { return (const line_t *)source; }

static void notify(const line_t *line, const char *text, notice_kind_t kind)
{
    const notice_t notice = {kind, NULL, text};
    line->loop->sink->notice(line->loop->ctx, &notice);
}

static void remark(const line_t *line, const sensor_t *sensor, const char *text)
{
    const notice_t notice = {NOTICE_REMARK, sensor, text};
    line->loop->sink->notice(line->loop->ctx, &notice);
}

/* The other lines go on. */
static void finish(line_t *line)
{
    if (line->is_done) return;
    line->is_done = true;
    line->loop->lines_left--;
}

/* The line's and the port's counters are lost when the port is closed. */
static void save_counters(line_t *line)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL && line->was_open; sensor = sensor->next)
        (void)counters_take(&sensor->counters, &line->counts, &line->port, sensor->reader);
}

static void leave(line_t *line)
{
    save_counters(line);
    finish(line);
    line->is_left = true;
    line->loop->has_left = true;
}

static void give_up(line_t *line)
{
    line->loop->has_failed = true;
    leave(line);
}

/* ---- opening ---- */

/* False: the user knows why the driver does not accept its settings. */
static bool start_sensor(line_t *line, sensor_t *sensor)
{
    char text[TEXT];
    reader_settings_t settings = sensor->settings;
    settings.line = line->settings.has_mixed_lines ? &sensor->line : NULL;
    settings.backoff_us = attempt_backoff_us(line);
    settings.address = sensor->address;
    if (!sensor_start(sensor, &line->port, &settings)) {
        sensor_refusal(sensor, text, sizeof text);
        notify(line, text, NOTICE_GIVEN_UP);
        return false;
    }
    if (!line->was_open && sensor_is_slower(sensor, text, sizeof text)) remark(line, sensor, text);
    sensor->listener = attempt_listener(line, sensor);
    attempt_start(sensor);
    sensor->next_us = loop_now_us(line->loop);
    sensor->skipping = false;
    sensor->answering = false;
    return true;
}

static bool start_sensors(line_t *line)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (!start_sensor(line, sensor)) return false;
    line->port.listener.whose = line->settings.station_count > 1 ? attempt_whose : NULL;
    line->port.listener.ctx = line;
    counters_begin_port(&line->counts, &line->port);
    return true;
}

static fathom_status_t connect_port(line_t *line)
{
    port_settings_t settings = port_options_settings(&line->settings);
    settings.source = &line->source;
    return port_open(&line->port, line->loop->host, &settings);
}

static void report_absence(line_t *line)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (!attempt_was_last(line->loop, sensor)) attempt_absent(line, sensor);
}

/* The port could not be opened when the command began. If there are others, their readings show that it is right to
 * wait. */
static void miss(line_t *line)
{
    const site_t *const site = &line->loop->site;
    const bool may_come = port_is_absent(&line->port) || site->line_count > 1 || site->persists;
    char text[TEXT];
    line->is_lost = true;
    line->waits = site->reconnect && may_come;
    (void)snprintf(text, sizeof text, "%s%s", port_error(&line->port),
                   line->waits ? "; waiting until it is there" : "");
    notify(line, text, line->waits ? NOTICE_WAITING : NOTICE_GIVEN_UP);
    if (!line->waits) give_up(line);
}

/* How the adapter is found again. */
static void notify_advice(line_t *line)
{
    char text[TEXT];
    const char *const advice = port_advice(&line->port);
    if (advice == NULL) return;
    (void)snprintf(text, sizeof text, "%s: %s", port_name(&line->port), advice);
    notify(line, text, NOTICE_WAITING);
}

static void fail_to_open(line_t *line)
{
    if (!line->is_lost) miss(line);
    if (!line->waits) return;
    report_absence(line);
    /* The user has to know, some time, about a port that is there and cannot be opened. */
    if (port_is_overdue(&line->port)) {
        char text[TEXT];
        (void)snprintf(text, sizeof text, "still waiting: %s", port_error(&line->port));
        notify(line, text, NOTICE_WAITING);
    }
    notify_advice(line);
}

/* False: the port cannot be used. */
static bool start_reading(line_t *line)
{
    if (!start_sensors(line)) {
        give_up(line);
        return false;
    }
    if (line->is_lost) {
        char text[TEXT];
        (void)snprintf(text, sizeof text, "%s: %s", port_name(&line->port),
                       line->was_open ? "it is back; reading goes on" : "it is there; reading begins");
        if (line->was_open) line->loop->reconnects++;
        notify(line, text, NOTICE_OPEN);
    }
    line->is_lost = false;
    line->was_open = true;
    return true;
}

static bool open_line(fathom_loop_source_t *source)
{
    line_t *const line = line_of(source);
    if (line->is_done) return false;
    const fathom_status_t status = connect_port(line);
    line->is_connecting = status == FATHOM_PENDING;
    if (status == FATHOM_ERR_PORT) fail_to_open(line);
    if (status != FATHOM_OK || start_reading(line)) return status != FATHOM_ERR_PORT;
    port_close(&line->port);
    return false;
}

/* False: the connection cannot be established. */
static bool wait_for_connection(line_t *line)
{
    const fathom_status_t status = port_poll(&line->port);
    line->is_connecting = status == FATHOM_PENDING;
    if (status == FATHOM_ERR_PORT) fail_to_open(line);
    return status == FATHOM_OK ? start_reading(line) : status == FATHOM_PENDING;
}

static void close_line(fathom_loop_source_t *source) { port_close(&line_of(source)->port); }

/* ---- losing ---- */

/* Returns true if there is anything left to read after this attempt failed. */
static bool has_more_to_do(const line_t *line)
{
    const uint32_t count = line->loop->site.count;
    for (const sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (count == 0 || sensor->counters.attempts + 1 < count) return true;
    return false;
}

/* Each sensor fails once. */
static void lose(line_t *line)
{
    const loop_t *const loop = line->loop;
    bool is_known = false;
    line->waits = loop->site.reconnect && has_more_to_do(line);
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        if (attempt_was_last(loop, sensor)) continue;
        attempt_lost(line, sensor, is_known);
        is_known = true;
    }
    save_counters(line);
    if (line->waits)
        notify_advice(line);
    else
        leave(line);
}

/* ---- polling ---- */

static int line_fd(const fathom_loop_source_t *source) { return port_fd(&const_line_of(source)->port); }

static short line_events(const fathom_loop_source_t *source)
{
    return port_events(&const_line_of(source)->port);
}

static void pass_remark(const line_t *line, sensor_t *sensor)
{
    const char *const text = reader_remark(sensor->reader);
    if (text != NULL) remark(line, sensor, text);
}

/* True: the sensor had an outcome, or the port is lost. */
static bool poll_sensor(line_t *line, sensor_t *sensor)
{
    do {
        fathom_sample_t sample;
        const fathom_status_t status = reader_poll(sensor->reader, &sample);
        pass_remark(line, sensor);
        attempt_count_late(line);
        /* Between two requests a driver does not report a lost port, and waiting for the port would return at once. */
        line->is_lost = port_poll(&line->port) == FATHOM_ERR_PORT;
        if (line->is_lost && (status == FATHOM_PENDING || status == FATHOM_ERR_PORT)) return true;
        if (status == FATHOM_PENDING) return false;
        attempt_outcome(line, sensor, status, &sample);
    } while (reader_has_more(sensor->reader));
    return true;
}

/* A sensor that had all its attempts is not polled, and sends no more requests. True: a sensor had an outcome. */
static bool poll_sensors(line_t *line)
{
    bool has_outcome = false;
    bool is_done = true;
    for (sensor_t *sensor = line->sensors; sensor != NULL && !line->is_lost; sensor = sensor->next) {
        if (attempt_was_last(line->loop, sensor)) continue;
        if (poll_sensor(line, sensor)) has_outcome = true;
        if (!attempt_was_last(line->loop, sensor)) is_done = false;
    }
    if (is_done) finish(line);
    return has_outcome;
}

static bool poll_line(fathom_loop_source_t *source)
{
    line_t *const line = line_of(source);
    if (line->is_connecting && !wait_for_connection(line)) return false;
    if (line->is_connecting) {
        source->is_readable = false; /* nothing is read yet */
        return true;
    }
    for (unsigned turn = 0; turn != TURNS && !line->is_done && !loop_is_over(line->loop); turn++) {
        const bool has_outcome = poll_sensors(line);
        if (line->is_lost) {
            lose(line);
            return false;
        }
        if (!has_outcome) break;
    }
    if (line->is_done && !line->is_left && line_end_sensors(line)) leave(line);
    return true;
}

static uint32_t due_us(fathom_loop_source_t *source)
{
    const line_t *const line = line_of(source);
    if (line->is_connecting) return CONNECTION_US;
    uint32_t soonest_us = line->is_done ? AGAIN_US : FATHOM_NO_DEADLINE;
    for (sensor_t *sensor = line->sensors; sensor != NULL && !line->is_done; sensor = sensor->next) {
        if (attempt_was_last(line->loop, sensor)) continue;
        const uint32_t this_us = reader_due_us(sensor->reader);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

/* ---- start and end ---- */

void line_start(line_t *line, loop_t *loop)
{
    static const fathom_loop_kind_t kind = {open_line, close_line, line_fd, line_events,
                                            poll_line, due_us,     NULL};
    line->loop = loop;
    line->source.kind = &kind;
    fathom_loop_add(&loop->sources, &line->source);
}

void line_remove(line_t *line)
{
    if (line->source.loop != NULL) fathom_loop_remove(&line->source);
    line->source.loop = NULL;
}

/* The driver of some adapters does not end a break when the port is closed. */
bool line_end_sensors(line_t *line)
{
    bool has_ended = true;
    if (!line->was_open || line->is_lost || line->is_left) return true;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (reader_close(sensor->reader) == FATHOM_PENDING) has_ended = false;
    return has_ended;
}

bool line_is_busy(const line_t *line)
{
    if (line->is_lost || !line->was_open) return false;
    for (const sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (reader_facts(sensor->reader).is_in_progress) return true;
    return false;
}
