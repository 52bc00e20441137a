/* SPDX-License-Identifier: MIT */
#include "reading/poll_port.h"

#include "reading/poll_attempt.h"

/* So often in a row its sensors are polled at most, so that none keeps the other ports waiting; so soon again the end of
 * a sensor is looked after, and the time-out of a connection. */
enum { TURNS = 16, AGAIN_US = 1000, CONNECTION_US = 500000, TEXT = 512 };

static poll_port_t *port_of(fathom_loop_source_t *source) { return (poll_port_t *)source; }

static const poll_port_t *const_port_of(const fathom_loop_source_t *source)
{
    return (const poll_port_t *)source;
}

static void tell(const poll_port_t *port, const char *text, poll_port_state_t state)
{
    const poll_loop_t *const loop = port->loop;
    loop->user->port(loop->ctx, text, state);
}

/* The others go on without it. */
static void finish(poll_port_t *port)
{
    if (port->is_done) return;
    port->is_done = true;
    port->loop->ports_left--;
}

/* Since what the line and the port's driver have counted is lost with it. */
static void take_counters(poll_port_t *port)
{
    for (station_t *station = port->stations; station != NULL && port->was_open; station = station->next)
        (void)counters_take(&station->counters, &port->counts, &port->channel, station->reader);
}

static void end_with_counters(poll_port_t *port)
{
    take_counters(port);
    finish(port);
    port->is_left = true;
    port->loop->has_left = true;
}

void poll_port_give_up(poll_port_t *port)
{
    port->loop->has_failed = true;
    end_with_counters(port);
}

/* ---- opening ---- */

bool poll_port_begin_station(poll_port_t *port, station_t *station)
{
    char text[TEXT];
    poll_loop_t *const loop = port->loop;
    reader_settings_t settings = station->settings;
    /* Of one that persists the sensors may become others, and then their lines. */
    settings.line = port->options->has_mixed_lines || loop->options.persists ? &station->line : NULL;
    settings.backoff_us = poll_backoff_us(port);
    settings.address = station->address;
    if (!station_begin(station, &port->channel, &settings)) {
        station_refusal(station, text, sizeof text);
        tell(port, text, POLL_PORT_GIVEN_UP);
        return false;
    }
    if (!port->was_open && station_is_raised(station, text, sizeof text))
        loop->user->remark(loop->ctx, station, text);
    station->listener = poll_listener_of(port, station);
    poll_begin_attempt(station);
    station->next_us = poll_now_us(loop);
    station->skipping = false;
    station->answering = false;
    return true;
}

/* The port is open: begins to read. */
static bool begin_stations(poll_port_t *port)
{
    for (station_t *station = port->stations; station != NULL; station = station->next)
        if (!poll_port_begin_station(port, station)) return false;
    port->channel.listener.whose = poll_is_shared(port) ? poll_whose : NULL;
    port->channel.listener.ctx = port;
    counters_begin_port(&port->counts, &port->channel);
    return true;
}

static fathom_status_t connect_port(poll_port_t *port)
{
    port_settings_t settings = port_options_settings(port->options);
    settings.source = &port->source;
    return port_open(&port->channel, port->loop->host, &settings);
}

static void tell_away(const poll_port_t *port)
{
    const poll_loop_t *const loop = port->loop;
    for (const station_t *station = port->stations; station != NULL; station = station->next)
        if (!poll_is_done(loop, station)) loop->user->away(loop->ctx, station);
}

/* It could not be opened when the command began. With several ports the others show that it is right to wait. */
static void take_absence(poll_port_t *port)
{
    const sensor_options_t *const options = &port->loop->options;
    const bool may_come = port_is_absent(&port->channel) || options->port_count > 1 || options->persists;
    char text[TEXT];
    port->is_lost = true;
    port->waits = options->reconnect && may_come;
    (void)snprintf(text, sizeof text, "%s%s", port_error(&port->channel),
                   port->waits ? "; waiting until it is there" : "");
    tell(port, text, port->waits ? POLL_PORT_WAITED_FOR : POLL_PORT_GIVEN_UP);
    if (!port->waits) poll_port_give_up(port);
}

/* What is there and cannot be opened has to be told some time. */
static void tell_waiting(const poll_port_t *port)
{
    char text[TEXT];
    if (!port->waits || !port_is_overdue(&port->channel)) return;
    (void)snprintf(text, sizeof text, "still waiting: %s", port_error(&port->channel));
    tell(port, text, POLL_PORT_WAITED_FOR);
}

/* How the adapter is found again. */
static void tell_advice(poll_port_t *port)
{
    char text[TEXT];
    const char *const advice = port_advice(&port->channel);
    if (advice == NULL) return;
    (void)snprintf(text, sizeof text, "%s: %s", port_name(&port->channel), advice);
    tell(port, text, POLL_PORT_WAITED_FOR);
}

static void take_failed_try(poll_port_t *port)
{
    if (!port->is_lost) take_absence(port);
    if (port->waits) tell_away(port);
    tell_waiting(port);
    if (port->waits) tell_advice(port);
}

/* False: it cannot be used. */
static bool begin_reading(poll_port_t *port)
{
    if (!begin_stations(port)) {
        poll_port_give_up(port);
        return false;
    }
    if (port->is_lost) {
        char text[TEXT];
        (void)snprintf(text, sizeof text, "%s: %s", port_name(&port->channel),
                       port->was_open ? "it is back; reading goes on" : "it is there; reading begins");
        if (port->was_open) port->loop->reconnects++;
        tell(port, text, POLL_PORT_THERE);
    }
    port->is_lost = false;
    port->was_open = true;
    return true;
}

static bool open_port(fathom_loop_source_t *source)
{
    poll_port_t *const port = port_of(source);
    if (port->is_done) return false;
    const fathom_status_t status = connect_port(port);
    port->is_waiting = status == FATHOM_PENDING;
    if (status == FATHOM_ERR_PORT) take_failed_try(port);
    if (status != FATHOM_OK || begin_reading(port)) return status != FATHOM_ERR_PORT;
    port_close(&port->channel);
    return false;
}

/* False: the connection does not come to stand. */
static bool wait_for_connection(poll_port_t *port)
{
    const fathom_status_t status = port_poll(&port->channel);
    port->is_waiting = status == FATHOM_PENDING;
    if (status == FATHOM_ERR_PORT) take_failed_try(port);
    return status == FATHOM_OK ? begin_reading(port) : status == FATHOM_PENDING;
}

static void close_port(fathom_loop_source_t *source) { port_close(&port_of(source)->channel); }

/* ---- losing ---- */

/* Is there anything to wait for, when this attempt has failed? */
static bool has_more_to_do(const poll_port_t *port)
{
    const uint32_t count = port->loop->options.count;
    for (const station_t *station = port->stations; station != NULL; station = station->next)
        if (count == 0 || station->counters.attempts + 1 < count) return true;
    return false;
}

/* Each of its sensors has failed once. */
static void lose(poll_port_t *port)
{
    poll_loop_t *const loop = port->loop;
    bool is_told = false;
    port->waits = loop->options.reconnect && has_more_to_do(port);
    for (station_t *station = port->stations; station != NULL; station = station->next) {
        if (poll_is_done(loop, station)) continue;
        poll_take_loss(port, station, is_told);
        is_told = true;
    }
    take_counters(port);
    if (port->waits)
        tell_advice(port);
    else
        end_with_counters(port);
}

/* ---- polling ---- */

static int source_fd(const fathom_loop_source_t *source) { return port_fd(&const_port_of(source)->channel); }

static short source_events(const fathom_loop_source_t *source)
{
    return port_events(&const_port_of(source)->channel);
}

static void tell_remark(const poll_loop_t *loop, station_t *station)
{
    const char *const remark = reader_remark(station->reader);
    if (remark != NULL) loop->user->remark(loop->ctx, station, remark);
}

/* False: it has nothing to say now. */
static bool poll_station(poll_port_t *port, station_t *station)
{
    do {
        fathom_sample_t sample;
        const fathom_status_t status = reader_poll(station->reader, &sample);
        tell_remark(port->loop, station);
        poll_take_late(port);
        /* Between two requests a driver does not report it, and waiting for the port would not wait. */
        port->is_lost = port_poll(&port->channel) == FATHOM_ERR_PORT;
        if (port->is_lost && (status == FATHOM_PENDING || status == FATHOM_ERR_PORT)) return true;
        if (status == FATHOM_PENDING) return false;
        poll_take_outcome(port, station, status, &sample);
    } while (reader_has_more(station->reader));
    return true;
}

/* A station that has nothing left to do is not polled, and asks nothing more. True: one had an outcome. */
static bool poll_stations(poll_port_t *port)
{
    bool has_come = false;
    bool is_done = true;
    for (station_t *station = port->stations; station != NULL && !port->is_lost; station = station->next) {
        if (poll_is_done(port->loop, station)) continue;
        if (poll_station(port, station)) has_come = true;
        if (!poll_is_done(port->loop, station)) is_done = false;
    }
    if (is_done) finish(port);
    return has_come;
}

static bool poll_port(fathom_loop_source_t *source)
{
    poll_port_t *const port = port_of(source);
    if (port->is_waiting && !wait_for_connection(port)) return false;
    if (port->is_waiting) {
        source->is_readable = false; /* nothing is read yet */
        return true;
    }
    for (unsigned turn = 0; turn != TURNS && !port->is_done && !poll_is_over(port->loop); turn++) {
        const bool has_come = poll_stations(port);
        if (port->is_lost) {
            lose(port);
            return false;
        }
        if (!has_come) break;
    }
    if (port->is_done && !port->is_left && poll_port_end_stations(port)) end_with_counters(port);
    return true;
}

static uint32_t due_us(fathom_loop_source_t *source)
{
    const poll_port_t *const port = port_of(source);
    if (port->is_waiting) return CONNECTION_US;
    uint32_t soonest_us = port->is_done ? AGAIN_US : FATHOM_NO_DEADLINE;
    for (station_t *station = port->stations; station != NULL && !port->is_done; station = station->next) {
        if (poll_is_done(port->loop, station)) continue;
        const uint32_t this_us = reader_due_us(station->reader);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

/* ---- begin and end ---- */

void poll_port_add(poll_port_t *port, station_t *station)
{
    station->next = port->stations;
    port->stations = station;
    port->station_count++;
}

void poll_port_begin(poll_port_t *port, poll_loop_t *loop, const port_options_t *options)
{
    static const fathom_loop_kind_t kind = {open_port, close_port, source_fd, source_events,
                                            poll_port, due_us,     NULL};
    port->loop = loop;
    port->options = options;
    port->source.kind = &kind;
    fathom_loop_add(&loop->sources, &port->source);
}

void poll_port_end(poll_port_t *port)
{
    if (port->source.loop != NULL) fathom_loop_remove(&port->source);
    port->source.loop = NULL;
}

/* Such as a break, which not every adapter's driver ends when it is closed. */
bool poll_port_end_stations(poll_port_t *port)
{
    bool has_ended = true;
    for (station_t *station = port->stations; station != NULL; station = station->next)
        if (reader_close(station->reader) == FATHOM_PENDING) has_ended = false;
    return has_ended;
}
