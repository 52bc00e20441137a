/* SPDX-License-Identifier: MIT */
#include "stations/poll_loop.h"

#include <string.h>

#include "read/output.h"

enum { TEXT = 512 };

static uint64_t now_us(const session_t *session) { return session->host->now_us(session->host->ctx); }

static bool is_done(const session_t *session, const station_t *station)
{
    const uint32_t count = session->options.count;
    return count != 0 && station->tally.attempts >= count;
}

static bool is_shared(const session_t *session) { return session->options.station_count > 1; }

static station_t *end_of(session_t *session)
{
    return session->options.stations + session->options.station_count;
}

static bool is_over(const session_t *session)
{
    const host_t *const host = session->host;
    const session_options_t *const options = &session->options;
    const station_t *const end = options->stations + options->station_count;
    const station_t *station = options->stations;
    while (station != end && is_done(session, station)) station++;
    return host->has_ended(host->ctx) || host->is_output_gone(host->ctx) ||
           session->user->is_over(session->ctx) || (session->is_lost && !options->reconnect) ||
           station == end || (options->duration_us != 0 && session_time_us(session) >= options->duration_us);
}

uint64_t session_time_us(const session_t *session) { return now_us(session) - session->start_us; }

uint64_t session_sample_us(const session_t *session, const fathom_sample_t *sample)
{
    return time_extend(now_us(session), sample->time_us) - session->start_us;
}

/* ---- what was heard, and of whom ---- */

/* A request is about to leave: whose is it? The line has put it at the front. */
static ear_t *whose(void *ctx)
{
    session_t *const session = ctx;
    for (station_t *station = session->options.stations; station != end_of(session); station++)
        if (session->channel.line.head == &station->reader.unit->request.exchange) return station->ear;
    return NULL;
}

/* The one on this line that has this address; NULL: none. */
static station_t *station_at(session_t *session, uint8_t address)
{
    for (station_t *station = session->options.stations; station != end_of(session); station++)
        if (station->address == address) return station;
    return NULL;
}

/* A late answer comes while its unit is asked nothing, and perhaps another one is: it explains the failures of the
 * unit that it is from. */
static void take_late(session_t *session)
{
    const channel_t *const channel = &session->channel;
    if (!is_shared(session) || channel->counters[FATHOM_LINE_LATE_ANSWERS] == 0) return;
    for (station_t *station = session->options.stations; station != end_of(session); station++) {
        evidence_t evidence;
        if (channel->ear.now != station->ear) continue;
        ear_judge(station->ear, station->address, &evidence);
        station_t *const other = evidence.foreign != 0 ? station_at(session, evidence.foreign_address) : NULL;
        tally_take_late(other != NULL ? &other->tally : &station->tally, &session->channel);
        return;
    }
}

/* Has another sensor of this line answered? */
static bool others_answer(const session_t *session, const station_t *station)
{
    const session_options_t *const options = &session->options;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && options->stations[i].tally.readings != 0) return true;
    return false;
}

/* What others of this line have said late is no evidence of anything else. */
static void judge(session_t *session, const station_t *station, evidence_t *evidence)
{
    ear_judge(station->ear, station->mode->is_asked ? station->address : 0, evidence);
    if (evidence->foreign == 0 || station_at(session, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- attempts ---- */

/* Is there anything to wait for when the port is lost? */
static bool has_more_to_do(const session_t *session, const station_t *station)
{
    const session_options_t *const options = &session->options;
    if (options->count == 0 || station->tally.attempts + 1 < options->count) return true;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && !is_done(session, &options->stations[i])) return true;
    return false;
}

/* Does more than one probe of this sensor speak? */
static bool has_probes(const session_t *session, const station_t *station)
{
    const uint8_t probes = session->options.probes;
    return station->sensor->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

static void report_failure(session_t *session, station_t *station, fathom_status_t status, bool is_first)
{
    failure_t failure = {
        .status = status,
        .sensor = station->sensor,
        .reader = &station->reader,
        .channel = &session->channel,
        .tally = &station->tally,
        .line = &station->line,
        .shared = is_shared(session) ? station->name : NULL,
        .address = station->address,
        .others_answer = others_answer(session, station),
        .waits = session->options.reconnect && has_more_to_do(session, station),
        .is_whole = is_first && !reader_has_more(&station->reader) && has_probes(session, station),
    };
    tally_failure(&station->tally, status, &station->reader);
    judge(session, station, &failure.evidence);
    station->has_failed = true;
    session->user->failure(session->ctx, &failure, station);
}

/* What is heard from now on, and counted, is the next attempt's. */
static void begin_attempt(station_t *station)
{
    tally_begin_attempt(&station->tally);
    ear_forget(station->ear);
}

static void end_attempt(const session_t *session, station_t *station)
{
    const uint64_t now = now_us(session);
    station->tally.attempts++;
    if (station->has_failed) station->tally.failed++;
    station->has_failed = false;
    station->answering = false;
    station->next_us += session->options.interval_us;
    if (station->next_us < now) station->next_us = now; /* what is late is not made up for */
    begin_attempt(station);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole answer at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(const session_t *session, station_t *station, fathom_status_t status)
{
    if (station->reader.is_paced || station->answering) return false;
    const bool is_first = !station->skipping;
    if (is_first) station->skipping = now_us(session) < station->next_us;
    if (!station->skipping) return false;
    if (is_first && status != FATHOM_ERR_STALE) station->tally.skipped++;
    station->skipping = reader_has_more(&station->reader);
    begin_attempt(station);
    return true;
}

/* Something other than FATHOM_PENDING. */
static void take_outcome(session_t *session, station_t *station, fathom_status_t status,
                         const fathom_sample_t *sample)
{
    tally_take(&station->tally, &session->port_counts, &session->channel, &station->reader);
    if (status != FATHOM_ERR_PORT && is_early(session, station, status)) return;
    if (status == FATHOM_READY && station->reader.unit != NULL && !station->answering)
        tally_time(&station->tally, fathom_elapsed_us(sample->time_us, station->ear->asked_us));
    const bool is_first = !station->answering;
    station->answering = true;
    if (status == FATHOM_READY) {
        if (session->user->reading(session->ctx, station, sample)) station->tally.readings++;
        if (sample->kind != FATHOM_UNKNOWN) station->has_good = true;
    } else {
        report_failure(session, station, status, is_first);
    }
    if (status == FATHOM_ERR_PORT || !reader_has_more(&station->reader)) end_attempt(session, station);
}

/* ---- the loop ---- */

/* Sleeps for max_us at most. */
static void wait_for(session_t *session, const fathom_posix_uart_t *port, uint32_t max_us)
{
    const uint64_t duration_us = session->options.duration_us;
    const uint64_t time_us = session_time_us(session);
    const uint64_t left_us = time_us < duration_us ? duration_us - time_us : 0;
    const uint32_t tick_us = session->user->tick(session->ctx);
    if (max_us > tick_us) max_us = tick_us;
    if (duration_us != 0 && max_us > left_us) max_us = (uint32_t)left_us;
    session->host->wait(session->host->ctx, port, max_us, true);
}

/* False: it has nothing to say now. */
static bool poll_station(session_t *session, station_t *station)
{
    fathom_posix_uart_t *const port = &session->channel.port;
    do {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(&station->reader.sensor, &sample);
        take_late(session);
        /* Between two requests a driver has nobody to tell it to, and waiting for the port would not wait. */
        session->is_lost = fathom_posix_error(port) == FATHOM_POSIX_ERR_LOST;
        if (session->is_lost && status == FATHOM_PENDING) status = FATHOM_ERR_PORT;
        if (status == FATHOM_PENDING && station->reader.unit != NULL && channel_is_stuck(&session->channel))
            status = FATHOM_ERR_NO_ANSWER;
        if (status == FATHOM_PENDING) return false;
        take_outcome(session, station, status, &sample);
    } while (!session->is_lost && reader_has_more(&station->reader));
    return true;
}

/* Whoever has nothing left to do is not polled, and asks nothing more. True: somebody had something to say. */
static bool poll_all(session_t *session)
{
    bool has_come = false;
    for (station_t *station = session->options.stations; station != end_of(session); station++) {
        if (is_done(session, station)) continue;
        if (poll_station(session, station)) has_come = true;
        if (session->is_lost) return true;
    }
    return has_come;
}

static uint32_t due_us(session_t *session)
{
    uint32_t soonest_us = FATHOM_NO_DEADLINE;
    for (station_t *station = session->options.stations; station != end_of(session); station++) {
        if (is_done(session, station)) continue;
        const uint32_t this_us = fathom_due_us(&station->reader.sensor, 1);
        if (this_us < soonest_us) soonest_us = this_us;
    }
    return soonest_us;
}

static bool begin_station(session_t *session, station_t *station)
{
    const session_options_t *const options = &session->options;
    const reader_settings_t settings = {
        .timeout_us = options->timeout_us,
        .period_us = options->interval_us,
        .line = options->has_mixed_lines ? &station->line : NULL,
        .backoff_us = is_shared(session) ? 0 : READER_BACKOFF_US,
        .window = options->window,
        .probes = options->probes,
        .address = station->address,
        .retries = options->retries,
    };
    const uint16_t sequence = station->reader.sequence != NULL ? *station->reader.sequence : 0;
    if (!station->mode->read(&station->reader, &session->channel, &settings)) {
        (void)fprintf(stderr, "fathom: the driver of %s does not take these settings\n",
                      station->sensor->name);
        return false;
    }
    /* Goes on after a loss, so that the gap is not taken for a new start. */
    *station->reader.sequence = sequence;
    station->ear = is_shared(session) ? &station->own_ear : &session->channel.ear;
    begin_attempt(station);
    station->next_us = now_us(session);
    station->skipping = false;
    station->answering = false;
    return true;
}

/* The port is open: begins to read. */
static bool begin_reading(session_t *session)
{
    for (station_t *station = session->options.stations; station != end_of(session); station++)
        if (!begin_station(session, station)) return false;
    session->channel.ear.whose = is_shared(session) ? whose : NULL;
    session->channel.ear.ctx = session;
    tally_begin_port(&session->port_counts, &session->channel);
    session->is_lost = false;
    return true;
}

/* False: it is to end before the port is there. */
static bool wait_for_port(session_t *session)
{
    const fathom_line_settings_t *const line = &session->options.line;
    do wait_for(session, NULL, PLUG_RETRY_US);
    while (!is_over(session) && !plug_try(&session->plug, &session->channel, session->host, line));
    return !is_over(session);
}

static bool reconnect(session_t *session)
{
    const adapter_t *const adapter = &session->plug.adapter;
    char text[TEXT];
    /* All sensors' counters, since those of the line are lost with it. */
    for (station_t *station = session->options.stations; station != end_of(session); station++)
        tally_take(&station->tally, &session->port_counts, &session->channel, &station->reader);
    channel_close(&session->channel);
    if (adapter->vendor[0] != '\0' && adapter->needs_socket)
        session->user->port(session->ctx,
                            "this adapter has no serial number of its own: use the same USB socket again",
                            false);
    if (!wait_for_port(session)) return true;
    if (!begin_reading(session)) return false;
    session->reconnects++;
    (void)snprintf(text, sizeof text, "%s: it is back; reading goes on", plug_path(&session->plug));
    session->user->port(session->ctx, text, true);
    return true;
}

bool session_run(session_t *session)
{
    if (!begin_reading(session)) return false;
    while (!is_over(session)) {
        const bool has_come = poll_all(session);
        if (session->is_lost) {
            if (!is_over(session) && !reconnect(session)) return false;
        } else if (!has_come) {
            wait_for(session, &session->channel.port, due_us(session));
        }
    }
    return true;
}

/* ---- begin and end ---- */

void session_begin(session_t *session, const host_t *host, const session_user_t *user, void *ctx)
{
    memset(session, 0, sizeof *session);
    session->host = host;
    session->start_us = now_us(session);
    session->user = user;
    session->ctx = ctx;
}

bool session_open(session_t *session)
{
    const session_options_t *const options = &session->options;
    const fathom_posix_uart_t *const port = &session->channel.port;
    char text[TEXT];
    session->channel.echo = options->echo;
    session->plug.path = options->port;
    if (plug_try(&session->plug, &session->channel, session->host, &options->line)) return true;
    session->is_lost = options->reconnect && fathom_posix_error(port) == FATHOM_POSIX_ERR_NOT_FOUND;
    (void)snprintf(text, sizeof text, "%s%s", fathom_posix_error_text(port),
                   session->is_lost ? "; waiting until it is there" : "");
    session->user->port(session->ctx, text, false);
    if (!session->is_lost || !wait_for_port(session)) return false;
    (void)snprintf(text, sizeof text, "%s: it is there; reading begins", plug_path(&session->plug));
    session->user->port(session->ctx, text, true);
    return true;
}

void session_close(session_t *session) { channel_close(&session->channel); }

bool session_is_good(const session_t *session)
{
    const session_options_t *const options = &session->options;
    const bool is_over_time =
        options->duration_us != 0 && !session->is_lost && session_time_us(session) >= options->duration_us;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = &options->stations[i];
        if (station->tally.failed != 0) return false;
        if (!station->has_good && (station->tally.readings != 0 || is_over_time)) return false;
    }
    return true;
}

void session_account(session_t *session, account_t *account)
{
    const session_options_t *const options = &session->options;
    *account = (account_t){.stations = options->stations, .station_count = options->station_count};
    for (station_t *station = session->options.stations; station != end_of(session); station++) {
        /* Whoever reads first takes what the line has counted; the sums are right all the same. */
        if (station->reader.sequence != NULL)
            tally_take(&station->tally, &session->port_counts, &session->channel, &station->reader);
        tally_add(&account->sum, &station->tally);
        account->requests += station->ear != NULL ? station->ear->requests : 0;
    }
    account->reconnects = session->reconnects;
    account->time_us = session_time_us(session);
    account->has_port = session->port_counts.is_there;
}
