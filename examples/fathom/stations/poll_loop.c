/* SPDX-License-Identifier: MIT */
#include "stations/poll_loop.h"

#include <string.h>

#include "shared/timestamp.h"

enum { TEXT = 512 };

static uint64_t now_us(const poll_loop_t *loop) { return loop->host->now_us(loop->host->ctx); }

static bool is_done(const poll_loop_t *loop, const station_t *station)
{
    const uint32_t count = loop->options.count;
    return count != 0 && station->counters.attempts >= count;
}

static bool is_shared(const poll_loop_t *loop) { return loop->options.station_count > 1; }

static station_t *end_of(poll_loop_t *loop) { return loop->options.stations + loop->options.station_count; }

static bool is_over(const poll_loop_t *loop)
{
    const host_t *const host = loop->host;
    const sensor_options_t *const options = &loop->options;
    const station_t *const end = options->stations + options->station_count;
    const station_t *station = options->stations;
    while (station != end && is_done(loop, station)) station++;
    return host->has_ended(host->ctx) || host->is_output_gone(host->ctx) || loop->user->is_over(loop->ctx) ||
           (loop->is_lost && !options->reconnect) || station == end ||
           (options->duration_us != 0 && poll_loop_time_us(loop) >= options->duration_us);
}

uint64_t poll_loop_time_us(const poll_loop_t *loop) { return now_us(loop) - loop->start_us; }

uint64_t poll_loop_sample_us(const poll_loop_t *loop, const fathom_sample_t *sample)
{
    return time_extend(now_us(loop), sample->time_us) - loop->start_us;
}

/* ---- what was heard, and of whom ---- */

/* A request is about to leave: the listener of its station. The line has put it at the front. */
static listener_t *whose(void *ctx)
{
    poll_loop_t *const loop = ctx;
    for (station_t *station = loop->options.stations; station != end_of(loop); station++)
        if (loop->channel.line.head == &station->reader.unit->request.exchange) return station->listener;
    return NULL;
}

/* The one on this line that has this address; NULL: none. */
static station_t *station_at(poll_loop_t *loop, uint8_t address)
{
    for (station_t *station = loop->options.stations; station != end_of(loop); station++)
        if (station->address == address) return station;
    return NULL;
}

/* A late answer comes while its unit is asked nothing, and perhaps another one is: it explains the failures of the
 * unit that it is from. */
static void take_late(poll_loop_t *loop)
{
    const channel_t *const channel = &loop->channel;
    if (!is_shared(loop) || channel->counters[FATHOM_LINE_LATE_ANSWERS] == 0) return;
    for (station_t *station = loop->options.stations; station != end_of(loop); station++) {
        evidence_t evidence;
        if (channel->listener.now != station->listener) continue;
        listener_judge(station->listener, station->address, &evidence);
        station_t *const other = evidence.foreign != 0 ? station_at(loop, evidence.foreign_address) : NULL;
        counters_take_late(other != NULL ? &other->counters : &station->counters, &loop->channel);
        return;
    }
}

/* Has another sensor of this line answered? */
static bool others_answer(const poll_loop_t *loop, const station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && options->stations[i].counters.readings != 0) return true;
    return false;
}

/* What others of this line have said late is no evidence of anything else. */
static void judge(poll_loop_t *loop, const station_t *station, evidence_t *evidence)
{
    listener_judge(station->listener, station->mode->is_asked ? station->address : 0, evidence);
    if (evidence->foreign == 0 || station_at(loop, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- attempts ---- */

/* Is there anything to wait for when the port is lost? */
static bool has_more_to_do(const poll_loop_t *loop, const station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    if (options->count == 0 || station->counters.attempts + 1 < options->count) return true;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && !is_done(loop, &options->stations[i])) return true;
    return false;
}

/* Does more than one probe of this sensor speak? */
static bool has_probes(const poll_loop_t *loop, const station_t *station)
{
    const uint8_t probes = loop->options.probes;
    return station->model->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

static void report_failure(poll_loop_t *loop, station_t *station, fathom_status_t status, bool is_first)
{
    failure_t failure = {
        .status = status,
        .model = station->model,
        .reader = &station->reader,
        .channel = &loop->channel,
        .counters = &station->counters,
        .line = &station->line,
        .shared = is_shared(loop) ? station->name : NULL,
        .address = station->address,
        .others_answer = others_answer(loop, station),
        .waits = loop->options.reconnect && has_more_to_do(loop, station),
        .is_whole = is_first && !reader_has_more(&station->reader) && has_probes(loop, station),
    };
    counters_failure(&station->counters, status, &station->reader);
    judge(loop, station, &failure.evidence);
    station->has_failed = true;
    loop->user->failure(loop->ctx, &failure, station);
}

/* What is heard from now on, and counted, is the next attempt's. */
static void begin_attempt(station_t *station)
{
    counters_begin_attempt(&station->counters);
    listener_forget(station->listener);
}

static void end_attempt(const poll_loop_t *loop, station_t *station)
{
    const uint64_t now = now_us(loop);
    station->counters.attempts++;
    if (station->has_failed) station->counters.failed++;
    station->has_failed = false;
    station->answering = false;
    station->next_us += loop->options.interval_us;
    if (station->next_us < now) station->next_us = now; /* what is late is not made up for */
    begin_attempt(station);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole answer at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(const poll_loop_t *loop, station_t *station, fathom_status_t status)
{
    if (station->reader.is_paced || station->answering) return false;
    const bool is_first = !station->skipping;
    if (is_first) station->skipping = now_us(loop) < station->next_us;
    if (!station->skipping) return false;
    if (is_first && status != FATHOM_ERR_STALE) station->counters.skipped++;
    station->skipping = reader_has_more(&station->reader);
    begin_attempt(station);
    return true;
}

/* Something other than FATHOM_PENDING. */
static void take_outcome(poll_loop_t *loop, station_t *station, fathom_status_t status,
                         const fathom_sample_t *sample)
{
    counters_take(&station->counters, &loop->port_counts, &loop->channel, &station->reader);
    if (status != FATHOM_ERR_PORT && is_early(loop, station, status)) return;
    if (status == FATHOM_READY && station->reader.unit != NULL && !station->answering)
        counters_time(&station->counters, fathom_elapsed_us(sample->time_us, station->listener->asked_us));
    const bool is_first = !station->answering;
    station->answering = true;
    if (status == FATHOM_READY) {
        if (loop->user->reading(loop->ctx, station, sample)) station->counters.readings++;
        if (sample->kind != FATHOM_UNKNOWN) station->has_good = true;
    } else {
        report_failure(loop, station, status, is_first);
    }
    if (status == FATHOM_ERR_PORT || !reader_has_more(&station->reader)) end_attempt(loop, station);
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

/* False: it has nothing to say now. */
static bool poll_station(poll_loop_t *loop, station_t *station)
{
    fathom_posix_uart_t *const port = &loop->channel.port;
    do {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(&station->reader.sensor, &sample);
        take_late(loop);
        /* Between two requests a driver does not tell it, and waiting for the port would not wait. */
        loop->is_lost = fathom_posix_error(port) == FATHOM_POSIX_ERR_LOST;
        if (loop->is_lost && status == FATHOM_PENDING) status = FATHOM_ERR_PORT;
        if (status == FATHOM_PENDING && station->reader.unit != NULL && channel_is_stuck(&loop->channel))
            status = FATHOM_ERR_NO_ANSWER;
        if (status == FATHOM_PENDING) return false;
        take_outcome(loop, station, status, &sample);
    } while (!loop->is_lost && reader_has_more(&station->reader));
    return true;
}

/* A station that has nothing left to do is not polled, and asks nothing more. True: one had an outcome. */
static bool poll_all(poll_loop_t *loop)
{
    bool has_come = false;
    for (station_t *station = loop->options.stations; station != end_of(loop); station++) {
        if (is_done(loop, station)) continue;
        if (poll_station(loop, station)) has_come = true;
        if (loop->is_lost) return true;
    }
    return has_come;
}

static uint32_t due_us(poll_loop_t *loop)
{
    uint32_t soonest_us = FATHOM_NO_DEADLINE;
    for (station_t *station = loop->options.stations; station != end_of(loop); station++) {
        if (is_done(loop, station)) continue;
        const uint32_t this_us = fathom_due_us(&station->reader.sensor, 1);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

static bool begin_station(poll_loop_t *loop, station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    const reader_settings_t settings = {
        .timeout_us = options->timeout_us,
        .period_us = options->interval_us,
        .line = options->has_mixed_lines ? &station->line : NULL,
        .backoff_us = is_shared(loop) ? 0 : READER_BACKOFF_US,
        .window = options->window,
        .probes = options->probes,
        .address = station->address,
        .retries = options->retries,
    };
    const uint16_t sequence = station->reader.sequence != NULL ? *station->reader.sequence : 0;
    if (!station_begin(station, &loop->channel, &settings)) return false;
    /* Goes on after a loss, so that the gap is not taken for a new start. */
    *station->reader.sequence = sequence;
    station->listener = is_shared(loop) ? &station->own_listener : &loop->channel.listener;
    begin_attempt(station);
    station->next_us = now_us(loop);
    station->skipping = false;
    station->answering = false;
    return true;
}

/* The port is open: begins to read. */
static bool begin_reading(poll_loop_t *loop)
{
    for (station_t *station = loop->options.stations; station != end_of(loop); station++)
        if (!begin_station(loop, station)) return false;
    loop->channel.listener.whose = is_shared(loop) ? whose : NULL;
    loop->channel.listener.ctx = loop;
    counters_begin_port(&loop->port_counts, &loop->channel);
    loop->is_lost = false;
    return true;
}

/* False: it is to end before the port is there. */
static bool wait_for_port(poll_loop_t *loop)
{
    const fathom_line_settings_t *const line = &loop->options.line;
    do wait_for(loop, NULL, USB_ADAPTER_RETRY_US);
    while (!is_over(loop) && !usb_adapter_try(&loop->adapter, &loop->channel, loop->host, line));
    return !is_over(loop);
}

static bool reconnect(poll_loop_t *loop)
{
    const sysfs_adapter_t *const sysfs = &loop->adapter.sysfs;
    char text[TEXT];
    /* All sensors' counters, since those of the line are lost with it. */
    for (station_t *station = loop->options.stations; station != end_of(loop); station++)
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
    loop->start_us = now_us(loop);
    loop->user = user;
    loop->ctx = ctx;
}

bool poll_loop_open(poll_loop_t *loop)
{
    const sensor_options_t *const options = &loop->options;
    const fathom_posix_uart_t *const port = &loop->channel.port;
    char text[TEXT];
    loop->channel.echo = options->echo;
    loop->adapter.path = options->port;
    if (usb_adapter_try(&loop->adapter, &loop->channel, loop->host, &options->line)) return true;
    loop->is_lost = options->reconnect && fathom_posix_error(port) == FATHOM_POSIX_ERR_NOT_FOUND;
    (void)snprintf(text, sizeof text, "%s%s", fathom_posix_error_text(port),
                   loop->is_lost ? "; waiting until it is there" : "");
    loop->user->port(loop->ctx, text, false);
    if (!loop->is_lost || !wait_for_port(loop)) return false;
    (void)snprintf(text, sizeof text, "%s: it is there; reading begins", usb_adapter_path(&loop->adapter));
    loop->user->port(loop->ctx, text, true);
    return true;
}

void poll_loop_close(poll_loop_t *loop) { channel_close(&loop->channel); }

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
    for (station_t *station = loop->options.stations; station != end_of(loop); station++) {
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
