/* SPDX-License-Identifier: MIT */
#include "reading/poll_loop.h"

#include <string.h>

#include "output/timestamp.h"
#include "reading/poll_attempt.h"
#include "reading/poll_port.h"

uint64_t poll_loop_time_us(const poll_loop_t *loop) { return poll_now_us(loop) - loop->start_us; }

uint64_t poll_loop_sample_us(const poll_loop_t *loop, const fathom_sample_t *sample)
{
    return time_extend(poll_now_us(loop), sample->time_us) - loop->start_us;
}

/* ---- the loop ---- */

static uint32_t sleep_us(poll_loop_t *loop)
{
    const uint64_t duration_us = loop->options.duration_us;
    const uint64_t time_us = poll_loop_time_us(loop);
    const uint64_t left_us = time_us < duration_us ? duration_us - time_us : 0;
    const uint32_t tick_us = loop->user->tick(loop->ctx);
    return duration_us != 0 && tick_us > left_us ? (uint32_t)left_us : tick_us;
}

/* From within a step none may be taken out. */
static void forget_ports(poll_loop_t *loop)
{
    if (!loop->has_left) return;
    loop->has_left = false;
    for (size_t i = 0; i != loop->options.port_count; i++)
        if (loop->ports[i].is_left) poll_port_end(&loop->ports[i]);
}

void poll_loop_run(poll_loop_t *loop)
{
    while (!poll_is_over(loop)) {
        fathom_loop_step(&loop->sources, sleep_us(loop));
        forget_ports(loop);
    }
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

/* In the order in which the user has named them. */
static void share_out(poll_loop_t *loop)
{
    for (size_t i = loop->options.station_count; i != 0; i--) {
        station_t *const station = loop->options.stations[i - 1];
        poll_port_add(&loop->ports[station->port], station);
    }
}

bool poll_loop_open(poll_loop_t *loop)
{
    const host_t *const host = loop->host;
    const sensor_options_t *const options = &loop->options;
    if (fathom_loop_init(&loop->sources, &host->loop) != FATHOM_POSIX_OK) {
        loop->user->port(loop->ctx, "the system has no descriptor left; end other programs",
                         POLL_PORT_GIVEN_UP);
        return false;
    }
    host->attend(host->ctx, &loop->sources);
    share_out(loop);
    loop->ports_left = options->port_count;
    for (size_t i = 0; i != options->port_count && !host->has_ended(host->ctx); i++)
        poll_port_begin(&loop->ports[i], loop, &options->ports[i]);
    forget_ports(loop);
    return loop->ports_left != 0;
}

/* So long at most. */
static void end_stations(poll_loop_t *loop)
{
    enum { TIMES = 1000, AGAIN_US = 1000 };
    const host_t *const host = loop->host;
    bool has_ended = false;
    for (unsigned times = 0; times != TIMES && !has_ended; times++) {
        if (times != 0) host->wait(host->ctx, -1, 0, AGAIN_US, false);
        has_ended = true;
        for (size_t i = 0; i != loop->options.port_count; i++) {
            poll_port_t *const port = &loop->ports[i];
            if (port->was_open && !port->is_lost && !port->is_left && !poll_port_end_stations(port))
                has_ended = false;
        }
    }
}

void poll_loop_close(poll_loop_t *loop)
{
    end_stations(loop);
    fathom_loop_deinit(&loop->sources);
}

bool poll_loop_is_lost(const poll_loop_t *loop)
{
    for (size_t i = 0; i != loop->options.port_count; i++)
        if (loop->ports[i].is_lost) return true;
    return false;
}

bool poll_loop_is_good(const poll_loop_t *loop)
{
    const sensor_options_t *const options = &loop->options;
    const bool is_over_time = options->duration_us != 0 && poll_loop_time_us(loop) >= options->duration_us;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        const bool is_late = is_over_time && !loop->ports[station->port].is_lost;
        if (station->counters.failed != 0) return false;
        if (!station->has_good && (station->counters.readings != 0 || is_late)) return false;
    }
    return !loop->has_failed;
}

void poll_loop_account(poll_loop_t *loop, account_t *account)
{
    const sensor_options_t *const options = &loop->options;
    *account = (account_t){.stations = options->stations, .station_count = options->station_count};
    for (size_t i = 0; i != options->station_count; i++) {
        station_t *const station = options->stations[i];
        poll_port_t *const port = &loop->ports[station->port];
        /* The first station takes what the line has counted; the sums are right all the same. */
        if (station->reader != NULL)
            (void)counters_take(&station->counters, &port->counts, &port->channel, station->reader);
        counters_add(&account->sum, &station->counters);
        account->requests += station->listener != NULL ? station->listener->requests : 0;
        if (port->counts.is_there) account->has_port = true;
    }
    account->reconnects = loop->reconnects;
    account->time_us = poll_loop_time_us(loop);
}
