/* SPDX-License-Identifier: MIT */
#include "stations/poll_loop.h"

#include <string.h>

#include "shared/timestamp.h"
#include "stations/poll_attempt.h"

enum { TEXT = 512 };

static bool is_over(const poll_loop_t *loop)
{
    const host_t *const host = loop->host;
    const sensor_options_t *const options = &loop->options;
    const station_t *const end = options->stations + options->station_count;
    const station_t *station = options->stations;
    while (station != end && poll_is_done(loop, station)) station++;
    return host->has_ended(host->ctx) || host->is_output_gone(host->ctx) || loop->user->is_over(loop->ctx) ||
           (loop->is_lost && !options->reconnect) || station == end ||
           (options->duration_us != 0 && poll_loop_time_us(loop) >= options->duration_us);
}

uint64_t poll_loop_time_us(const poll_loop_t *loop) { return poll_now_us(loop) - loop->start_us; }

uint64_t poll_loop_sample_us(const poll_loop_t *loop, const fathom_sample_t *sample)
{
    return time_extend(poll_now_us(loop), sample->time_us) - loop->start_us;
}

/* ---- the loop ---- */

/* Sleeps for max_us at most. */
static void wait_for(poll_loop_t *loop, const fathom_posix_uart_t *port, uint32_t max_us)
{
    const uint64_t duration_us = loop->options.duration_us;
    const uint64_t time_us = poll_loop_time_us(loop);
    const uint64_t left_us = time_us < duration_us ? duration_us - time_us : 0;
    const uint32_t tick_us = loop->user->tick(loop->ctx);
    if (max_us > tick_us) max_us = tick_us;
    if (duration_us != 0 && max_us > left_us) max_us = (uint32_t)left_us;
    loop->host->wait(loop->host->ctx, port, max_us, true);
}

static void tell_remark(poll_loop_t *loop, station_t *station)
{
    const char *const remark = station->reader.remark;
    station->reader.remark = NULL;
    if (remark != NULL) loop->user->remark(loop->ctx, station, remark);
}

/* False: it has nothing to say now. */
static bool poll_station(poll_loop_t *loop, station_t *station)
{
    fathom_posix_uart_t *const port = &loop->channel.port;
    do {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(&station->reader.sensor, &sample);
        tell_remark(loop, station);
        poll_take_late(loop);
        /* Between two requests a driver does not tell it, and waiting for the port would not wait. */
        loop->is_lost = fathom_posix_error(port) == FATHOM_POSIX_ERR_LOST;
        if (loop->is_lost && status == FATHOM_PENDING) status = FATHOM_ERR_PORT;
        if (status == FATHOM_PENDING && station->reader.unit != NULL && channel_is_stuck(&loop->channel))
            status = FATHOM_ERR_NO_RESPONSE;
        if (status == FATHOM_PENDING) return false;
        poll_take_outcome(loop, station, status, &sample);
    } while (!loop->is_lost && reader_has_more(&station->reader));
    return true;
}

/* A station that has nothing left to do is not polled, and asks nothing more. True: one had an outcome. */
static bool poll_all(poll_loop_t *loop)
{
    bool has_come = false;
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++) {
        if (poll_is_done(loop, station)) continue;
        if (poll_station(loop, station)) has_come = true;
        if (loop->is_lost) return true;
    }
    return has_come;
}

static uint32_t due_us(poll_loop_t *loop)
{
    uint32_t soonest_us = FATHOM_NO_DEADLINE;
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++) {
        if (poll_is_done(loop, station)) continue;
        const uint32_t this_us = fathom_due_us(&station->reader.sensor, 1);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

static bool begin_station(poll_loop_t *loop, station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    reader_settings_t settings = options->reading;
    settings.timeout_us = options->timeout_us;
    settings.period_us = options->interval_us;
    settings.line = options->ports[0].has_mixed_lines ? &station->line : NULL;
    settings.backoff_us = poll_is_shared(loop) ? 0 : READER_BACKOFF_US;
    settings.address = station->address;
    settings.retries = options->retries;
    const uint16_t sequence = station->reader.sequence != NULL ? *station->reader.sequence : 0;
    if (!station_begin(station, &loop->channel, &settings)) {
        char text[TEXT];
        station_refusal(station, text, sizeof text);
        loop->user->port(loop->ctx, text, false);
        return false;
    }
    /* Goes on after a loss, so that the gap is not taken for a new start. */
    *station->reader.sequence = sequence;
    station->listener = poll_is_shared(loop) ? &station->own_listener : &loop->channel.listener;
    poll_begin_attempt(station);
    station->next_us = poll_now_us(loop);
    station->skipping = false;
    station->answering = false;
    return true;
}

/* The port is open: begins to read. */
static bool begin_reading(poll_loop_t *loop)
{
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++)
        if (!begin_station(loop, station)) return false;
    loop->channel.listener.whose = poll_is_shared(loop) ? poll_whose : NULL;
    loop->channel.listener.ctx = loop;
    counters_begin_port(&loop->port_counts, &loop->channel);
    loop->is_lost = false;
    return true;
}

/* False: it is to end before the port is there. */
static bool wait_for_port(poll_loop_t *loop)
{
    const fathom_line_settings_t *const line = &loop->options.ports[0].line;
    do wait_for(loop, NULL, USB_ADAPTER_RETRY_US);
    while (!is_over(loop) && !usb_adapter_try(&loop->adapter, &loop->channel, loop->host, line));
    return !is_over(loop);
}

static bool reconnect(poll_loop_t *loop)
{
    const sysfs_adapter_t *const sysfs = &loop->adapter.sysfs;
    char text[TEXT];
    /* All sensors' counters, since those of the line are lost with it. */
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++)
        counters_take(&station->counters, &loop->port_counts, &loop->channel, &station->reader);
    channel_close(&loop->channel);
    if (sysfs->vendor[0] != '\0' && sysfs->needs_socket)
        loop->user->port(
            loop->ctx, "this adapter has no serial number of its own: use the same USB socket again", false);
    if (!wait_for_port(loop)) return true;
    if (!begin_reading(loop)) return false;
    loop->reconnects++;
    (void)snprintf(text, sizeof text, "%s: it is back; reading goes on", usb_adapter_path(&loop->adapter));
    loop->user->port(loop->ctx, text, true);
    return true;
}

bool poll_loop_run(poll_loop_t *loop)
{
    if (!begin_reading(loop)) return false;
    while (!is_over(loop)) {
        const bool has_come = poll_all(loop);
        if (loop->is_lost) {
            if (!is_over(loop) && !reconnect(loop)) return false;
        } else if (!has_come) {
            wait_for(loop, &loop->channel.port, due_us(loop));
        }
    }
    return true;
}

/* ---- begin and end ---- */

void poll_loop_begin(poll_loop_t *loop, const host_t *host, const poll_loop_user_t *user, void *ctx)
{
    memset(loop, 0, sizeof *loop);
    loop->host = host;
    loop->start_us = poll_now_us(loop);
    loop->user = user;
    loop->ctx = ctx;
}

bool poll_loop_open(poll_loop_t *loop)
{
    const sensor_options_t *const options = &loop->options;
    const fathom_posix_uart_t *const port = &loop->channel.port;
    char text[TEXT];
    if (options->port_count > 1) {
        loop->user->port(loop->ctx, "several ports in one command cannot be read yet", false);
        return false;
    }
    loop->channel.echo = options->ports[0].echo;
    loop->channel.rs485 = options->ports[0].rs485;
    loop->adapter.path = options->ports[0].path;
    if (usb_adapter_try(&loop->adapter, &loop->channel, loop->host, &options->ports[0].line)) return true;
    loop->is_lost = options->reconnect && fathom_posix_error(port) == FATHOM_POSIX_ERR_NOT_FOUND;
    (void)snprintf(text, sizeof text, "%s%s", fathom_posix_error_text(port),
                   loop->is_lost ? "; waiting until it is there" : "");
    loop->user->port(loop->ctx, text, false);
    if (!loop->is_lost || !wait_for_port(loop)) return false;
    (void)snprintf(text, sizeof text, "%s: it is there; reading begins", usb_adapter_path(&loop->adapter));
    loop->user->port(loop->ctx, text, true);
    return true;
}

/* Leaves a sensor as it was: ends a break, which not every adapter's driver does when it is closed. */
static void end_station(poll_loop_t *loop, reader_t *reader)
{
    enum { TIMES = 1000, AGAIN_US = 1000 };
    const host_t *const host = loop->host;
    for (unsigned times = 0; reader->end != NULL && times != TIMES; times++) {
        if (reader->end(reader) != FATHOM_PENDING) return;
        host->wait(host->ctx, NULL, AGAIN_US, false);
    }
}

void poll_loop_close(poll_loop_t *loop)
{
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++)
        if (!loop->is_lost) end_station(loop, &station->reader);
    channel_close(&loop->channel);
}

bool poll_loop_is_good(const poll_loop_t *loop)
{
    const sensor_options_t *const options = &loop->options;
    const bool is_over_time =
        options->duration_us != 0 && !loop->is_lost && poll_loop_time_us(loop) >= options->duration_us;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = &options->stations[i];
        if (station->counters.failed != 0) return false;
        if (!station->has_good && (station->counters.readings != 0 || is_over_time)) return false;
    }
    return true;
}

void poll_loop_account(poll_loop_t *loop, account_t *account)
{
    const sensor_options_t *const options = &loop->options;
    *account = (account_t){.stations = options->stations, .station_count = options->station_count};
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++) {
        /* The first station takes what the line has counted; the sums are right all the same. */
        if (station->reader.sequence != NULL)
            counters_take(&station->counters, &loop->port_counts, &loop->channel, &station->reader);
        counters_add(&account->sum, &station->counters);
        account->requests += station->listener != NULL ? station->listener->requests : 0;
    }
    account->reconnects = loop->reconnects;
    account->time_us = poll_loop_time_us(loop);
    account->has_port = loop->port_counts.is_there;
}
