/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): clock_gettime */
#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <time.h>

#include "advice.h"
#include "command.h"
#include "events.h"
#include "plug.h"
#include "read_options.h"

typedef struct {
    read_options_t options;
    channel_t channel;
    reader_t reader;
    tally_t tally;
    plug_t plug;
    uint64_t start_us; /* the program's */
    uint64_t next_us;  /* when the present attempt began, or will */
    uint64_t stats_us; /* when all counters are told next */
    bool skipping;     /* the present answer came before it */
    bool answering;    /* the present attempt has begun to hand over an answer, ... */
    bool has_failed;   /* ... or a part of it was an error */
    bool is_lost;      /* the port */
    int output_error;  /* errno */
} session_t;

static uint64_t utc_now_us(void)
{
    struct timespec now = {0, 0};
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

/* Readers of a pipe see each line at once. */
static void flush(session_t *session)
{
    if (fflush(stdout) != 0 || ferror(stdout)) session->output_error = errno != 0 ? errno : EIO;
}

static void write_reading(session_t *session, const fathom_sample_t *sample)
{
    const uint64_t now_us = fathom_posix_now_us();
    const uint64_t time_us = time_extend(now_us, sample->time_us);
    const reading_t reading = {
        .sensor = session->options.sensor,
        .mode = session->options.mode,
        .sample = sample,
        .time_us = time_us - session->start_us,
        .utc_us = utc_now_us() - (now_us - time_us),
    };
    errno = 0;
    session->options.format->write(stdout, &reading);
    flush(session);
    if (session->output_error == 0) session->tally.readings++;
}

static void report_failure(session_t *session, fathom_status_t status)
{
    const uint32_t count = session->options.count;
    failure_t failure = {
        .status = status,
        .sensor = session->options.sensor,
        .reader = &session->reader,
        .channel = &session->channel,
        .tally = &session->tally,
        .address = session->options.reader.address,
        .waits = session->options.reconnect && (count == 0 || session->tally.attempts + 1 < count),
    };
    tally_failure(&session->tally, status, &session->reader);
    ear_judge(&session->channel.ear, session->options.mode->is_asked ? failure.address : 0,
              &failure.evidence);
    session->has_failed = true;
    (void)fprintf(stderr, "fathom: attempt %" PRIu64 ": ", session->tally.attempts + 1);
    advice_print(stderr, &failure);
    (void)fputs("\n", stderr);
}

/* What is heard from now on, and counted, is the next attempt's. */
static void begin_attempt(session_t *session)
{
    tally_begin_attempt(&session->tally);
    ear_forget(&session->channel.ear);
}

static void end_attempt(session_t *session)
{
    const uint64_t now_us = fathom_posix_now_us();
    session->tally.attempts++;
    if (session->has_failed) session->tally.failed++;
    session->has_failed = false;
    session->answering = false;
    session->next_us += session->options.interval_us;
    if (session->next_us < now_us) session->next_us = now_us; /* what is late is not made up for */
    begin_attempt(session);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole answer at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(session_t *session, fathom_status_t status)
{
    if (session->reader.stream == NULL || session->answering) return false;
    const bool is_first = !session->skipping;
    if (is_first) session->skipping = fathom_posix_now_us() < session->next_us;
    if (!session->skipping) return false;
    if (is_first && status != FATHOM_ERR_STALE) session->tally.skipped++;
    session->skipping = reader_has_more(&session->reader);
    begin_attempt(session);
    return true;
}

/* Something other than FATHOM_PENDING. */
static void take_outcome(session_t *session, fathom_status_t status, const fathom_sample_t *sample)
{
    tally_take(&session->tally, &session->channel, &session->reader);
    if (status != FATHOM_ERR_PORT && is_early(session, status)) return;
    if (status == FATHOM_READY && session->reader.unit != NULL && !session->answering)
        tally_time(&session->tally, fathom_elapsed_us(sample->time_us, session->channel.ear.asked_us));
    session->answering = true;
    if (status == FATHOM_READY)
        write_reading(session, sample);
    else
        report_failure(session, status);
    if (status == FATHOM_ERR_PORT || !reader_has_more(&session->reader)) end_attempt(session);
}

static bool is_over(const session_t *session)
{
    const uint32_t count = session->options.count;
    return events_ended() || events_output_gone() || session->output_error != 0 ||
           (session->is_lost && !session->options.reconnect) ||
           (count != 0 && session->tally.attempts >= count);
}

static void tell_stats(const session_t *session)
{
    const read_options_t *const options = &session->options;
    const uint64_t requests = session->channel.ear.requests;
    if (options->format->is_json)
        tally_print_json(&session->tally, stderr, requests, options->mode->is_asked,
                         fathom_posix_now_us() - session->start_us);
    else
        tally_print_all(&session->tally, stderr, requests, options->mode->is_asked);
}

/* Sleeps for max_us at most; tells the counters when it is time for that. */
static void wait_for(session_t *session, int fd, short events, uint32_t max_us)
{
    const uint32_t every_us = session->options.stats_us;
    const uint64_t now_us = fathom_posix_now_us();
    if (every_us != 0) {
        if (now_us >= session->stats_us) {
            tell_stats(session);
            session->stats_us += every_us;
            if (session->stats_us < now_us) session->stats_us = now_us + every_us;
        }
        if (max_us > session->stats_us - now_us) max_us = (uint32_t)(session->stats_us - now_us);
    }
    events_wait(fd, events, max_us, true);
}

/* The port is open: begins to read. False, after saying why. */
static bool begin_reading(session_t *session)
{
    const read_options_t *const options = &session->options;
    const uint16_t sequence = session->reader.sequence != NULL ? *session->reader.sequence : 0;
    if (!options->mode->read(&session->reader, &session->channel, &options->reader)) {
        (void)fprintf(stderr, "fathom: the driver of %s does not take these settings\n",
                      options->sensor->name);
        return false;
    }
    *session->reader.sequence =
        sequence; /* goes on after a loss, so that the gap is not taken for a new start */
    tally_begin_port(&session->tally, &session->channel);
    begin_attempt(session);
    session->next_us = fathom_posix_now_us();
    session->is_lost = false;
    session->skipping = false;
    session->answering = false;
    return true;
}

/* False: it is to end before the port is there. */
static bool wait_for_port(session_t *session)
{
    do wait_for(session, -1, 0, PLUG_RETRY_US);
    while (!is_over(session) && !plug_try(&session->plug, &session->channel, &session->options.line));
    return !is_over(session);
}

static void reconnect(session_t *session)
{
    const adapter_t *const adapter = &session->plug.adapter;
    tally_take(&session->tally, &session->channel, &session->reader);
    channel_close(&session->channel);
    if (adapter->vendor[0] != '\0' && adapter->needs_socket)
        (void)fputs("fathom: this adapter has no serial number of its own: use the same USB socket again\n",
                    stderr);
    if (!wait_for_port(session)) return;
    if (!begin_reading(session)) return;
    session->tally.reconnects++;
    (void)fprintf(stderr, "fathom: %s: it is back; reading goes on\n", plug_path(&session->plug));
}

static void read_all(session_t *session)
{
    while (!is_over(session)) {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(&session->reader.sensor, &sample);
        /* Between two requests a driver has nobody to tell it to, and waiting for the port would not wait. */
        session->is_lost = fathom_posix_error(&session->channel.port) == FATHOM_POSIX_ERR_LOST;
        if (session->is_lost && status == FATHOM_PENDING) status = FATHOM_ERR_PORT;
        if (status == FATHOM_PENDING)
            wait_for(session, fathom_posix_fd(&session->channel.port),
                     fathom_posix_poll_events(&session->channel.port),
                     fathom_due_us(&session->reader.sensor, 1));
        else
            take_outcome(session, status, &sample);
        if (session->is_lost && !is_over(session)) reconnect(session);
    }
}

static int finish(session_t *session)
{
    tally_take(&session->tally, &session->channel, &session->reader);
    /* A signal may have cut a write short: then ending was asked for, and is no failure. */
    if (session->output_error == EINTR && events_ended()) session->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: no reason for words. */
    if (session->output_error == EPIPE || events_output_gone()) return STATUS_FAILED;
    if (session->output_error != 0)
        (void)fprintf(stderr, "fathom: the readings cannot be written: %s\n",
                      strerror(session->output_error));
    if (!session->options.stats || session->options.format->is_json) tally_print(&session->tally, stderr);
    if (session->options.stats) tell_stats(session);
    return session->tally.failed != 0 || session->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

/* False, after saying why: the port cannot be opened, or (is_lost) it was waited for until the user ended that. */
static bool open_first(session_t *session)
{
    const fathom_posix_uart_t *const port = &session->channel.port;
    if (plug_try(&session->plug, &session->channel, &session->options.line)) return true;
    session->is_lost = session->options.reconnect && fathom_posix_error(port) == FATHOM_POSIX_ERR_NOT_FOUND;
    (void)fprintf(stderr, "fathom: %s%s\n", fathom_posix_error_text(port),
                  session->is_lost ? "; waiting until it is there" : "");
    if (!session->is_lost || !wait_for_port(session)) return false;
    (void)fprintf(stderr, "fathom: %s: it is there; reading begins\n", plug_path(&session->plug));
    return true;
}

static int run(int argc, char **argv)
{
    static session_t session; /* all zero, and too large for a small stack */
    const read_options_t *const options = &session.options;
    session.start_us = fathom_posix_now_us();
    if (!read_options(&session.options, argc, argv)) return STATUS_USAGE;
    if (options->wants_help) {
        read_help(stdout);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    if (!events_begin()) return STATUS_FAILED;
    int status = STATUS_FAILED;
    session.stats_us = session.start_us + options->stats_us;
    session.channel.echo = options->echo;
    session.plug.path = options->port;
    if (!open_first(&session)) return session.is_lost ? finish(&session) : STATUS_FAILED;
    if (begin_reading(&session)) {
        errno = 0;
        if (options->format->begin != NULL) options->format->begin(stdout, options->sensor);
        flush(&session);
        read_all(&session);
        status = finish(&session);
    }
    channel_close(&session.channel);
    return status;
}

const command_t read_command = {"read", "reads a sensor on a serial port", read_help, run};
