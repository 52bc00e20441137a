/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): clock_gettime */
#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <time.h>

#include "advice.h"
#include "command.h"
#include "events.h"
#include "read_options.h"

typedef struct {
    read_options_t options;
    channel_t channel;
    reader_t reader;
    tally_t tally;
    uint64_t start_us; /* the program's */
    uint64_t next_us;  /* when the present attempt began, or will */
    bool skipping;     /* the present answer came before it */
    bool answering;    /* the present attempt has begun to hand over an answer, ... */
    bool has_failed;   /* ... or a part of it was an error */
    bool is_lost;      /* the port, for good */
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
    const failure_t failure = {
        .status = status,
        .sensor = session->options.sensor,
        .mode = session->options.mode,
        .reader = &session->reader,
        .channel = &session->channel,
        .counts = &session->tally.attempt,
        .address = session->options.reader.address,
    };
    session->has_failed = true;
    (void)fprintf(stderr, "fathom: attempt %" PRIu64 ": ", session->tally.attempts + 1);
    advice_print(stderr, &failure);
    (void)fputs("\n", stderr);
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
    tally_begin_attempt(&session->tally);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole answer at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(session_t *session)
{
    if (session->reader.stream == NULL || session->answering) return false;
    if (!session->skipping) session->skipping = fathom_posix_now_us() < session->next_us;
    if (!session->skipping) return false;
    session->skipping = reader_has_more(&session->reader);
    tally_begin_attempt(&session->tally);
    return true;
}

/* Something other than FATHOM_PENDING. */
static void take_outcome(session_t *session, fathom_status_t status, const fathom_sample_t *sample)
{
    tally_take(&session->tally, &session->channel, &session->reader);
    if (status != FATHOM_ERR_PORT && is_early(session)) return;
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
    return events_ended() || events_output_gone() || session->output_error != 0 || session->is_lost ||
           (count != 0 && session->tally.attempts >= count);
}

static void read_all(session_t *session)
{
    while (!is_over(session)) {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(&session->reader.sensor, &sample);
        /* Between two requests a driver has nobody to tell it to, and waiting for the port would not wait. */
        session->is_lost = fathom_posix_error(&session->channel.port) == FATHOM_POSIX_ERR_LOST;
        if (session->is_lost && status == FATHOM_PENDING) status = FATHOM_ERR_PORT;
        if (status != FATHOM_PENDING)
            take_outcome(session, status, &sample);
        else
            events_wait(fathom_posix_fd(&session->channel.port),
                        fathom_posix_poll_events(&session->channel.port),
                        fathom_due_us(&session->reader.sensor, 1), true);
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
    tally_print(&session->tally, stderr);
    return session->tally.failed != 0 || session->output_error != 0 ? STATUS_FAILED : STATUS_OK;
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
    if (!events_begin() || !channel_open(&session.channel, options->port, &options->line))
        return STATUS_FAILED;
    if (!options->mode->read(&session.reader, &session.channel, &options->reader)) {
        (void)fprintf(stderr, "fathom: the driver of %s does not take these settings\n",
                      options->sensor->name);
        channel_close(&session.channel);
        return STATUS_FAILED;
    }
    session.next_us = fathom_posix_now_us();
    errno = 0;
    if (options->format->begin != NULL) options->format->begin(stdout, options->sensor);
    flush(&session);
    read_all(&session);
    channel_close(&session.channel);
    return finish(&session);
}

const command_t read_command = {"read", "reads a sensor on a serial port", read_help, run};
