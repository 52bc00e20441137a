/* SPDX-License-Identifier: MIT */
#include <poll.h>
#include <sys/epoll.h>

#include "internal/posix_loop.h"

/* A source of the loop: how it is opened, polled, lost, and when it is due. */

enum { STEADY_US = 1000000, AGAIN_US = 1000, UNWATCHED_US = 10000, TURNS = 16 };

/* What is polled has to be at least every 71 minutes (hal.h), whatever it says. */
#define SELDOM_US (UINT32_MAX / 2)

/* ---- opening and closing ---- */

static void tell(fathom_loop_source_t *source, bool is_open)
{
    const fathom_loop_config_t *const config = &source->loop->config;
    if (config->tell != NULL) config->tell(config->ctx, source, is_open);
}

const char *fathom_loop_error_text(const fathom_loop_source_t *source)
{
    const char *const text = source->kind->error_text != NULL ? source->kind->error_text(source) : "";
    return text[0] != '\0' || source->is_open ? text : "it is lost";
}

static short events_of(const fathom_loop_source_t *source)
{
    return source->kind->events != NULL ? source->kind->events(source) : POLLIN;
}

/* False: the descriptor is not one that epoll waits for: a file, one that it waits for already, or -1; nor has a loop in
 * simulated time any epoll. */
static bool control(fathom_loop_source_t *source, int operation)
{
    struct epoll_event event = {.events = EPOLLET | (uint32_t)source->events, .data.ptr = source};
    return epoll_ctl(source->loop->epoll_fd, operation, source->fd, &event) == 0;
}

static void watch(fathom_loop_source_t *source)
{
    source->fd = source->kind->fd(source);
    source->events = events_of(source);
    source->is_hung_up = false;
    source->is_readable = true; /* perhaps: it became so before it was watched */
    source->is_watched = source->loop->config.sleep != NULL || control(source, EPOLL_CTL_ADD);
}

static void pause_source(fathom_loop_source_t *source, uint64_t now_us)
{
    const fathom_loop_config_t *const config = &source->loop->config;
    const uint32_t longest_us = config->longest_pause_us;
    if (source->pause_us == 0)
        source->pause_us = config->first_pause_us;
    else
        source->pause_us = source->pause_us <= longest_us / 2 ? source->pause_us * 2 : longest_us;
    if (source->pause_us > longest_us) source->pause_us = longest_us;
    fathom_loop_due_at(source, now_us + source->pause_us);
}

/* What the sensors have to say of the time when it was away, or have left from before, is dropped. False: it is lost
 * again already. */
static bool is_well(const fathom_loop_source_t *source)
{
    fathom_sample_t sample;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        fathom_status_t status = FATHOM_OK;
        for (unsigned turn = 0; turn != TURNS && status != FATHOM_PENDING; turn++) {
            status = fathom_poll(&node->sensor, &sample);
            if (status == FATHOM_ERR_PORT) return false;
        }
    }
    return true;
}

void fathom_loop_close(fathom_loop_source_t *source)
{
    if (source->is_watched) (void)control(source, EPOLL_CTL_DEL);
    source->is_watched = false;
    source->is_open = false;
    if (source->kind->close != NULL) source->kind->close(source);
}

void fathom_loop_open(fathom_loop_source_t *source)
{
    const fathom_loop_kind_t *const kind = source->kind;
    source->is_open = kind->open == NULL || kind->open(source);
    const uint64_t now_us = fathom_loop_now_us(source->loop);
    source->opened_us = now_us;
    source->zeros = 0;
    if (source->is_open) {
        watch(source);
        if (!is_well(source)) fathom_loop_close(source);
    }
    if (source->is_open)
        fathom_loop_due_at(source, now_us);
    else
        pause_source(source, now_us);
    tell(source, source->is_open);
}

/* Each sensor is told once; a reading that it still had comes first. */
static void lose(fathom_loop_source_t *source)
{
    const uint64_t now_us = fathom_loop_now_us(source->loop);
    source->is_open = false;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        fathom_sample_t sample;
        for (unsigned turn = 0; turn != TURNS && fathom_poll(&node->sensor, &sample) == FATHOM_OK; turn++)
            node->take(node->ctx, FATHOM_OK, &sample);
        node->take(node->ctx, FATHOM_ERR_PORT, NULL);
    }
    if (now_us - source->opened_us >= STEADY_US) source->pause_us = 0;
    fathom_loop_close(source);
    pause_source(source, now_us);
    tell(source, false);
}

/* ---- polling ---- */

/* FATHOM_PENDING: all is done; FATHOM_OK: there may be more; FATHOM_ERR_PORT: it is lost. */
static fathom_status_t poll_sensor(const fathom_loop_sensor_t *node)
{
    fathom_sample_t sample;
    for (unsigned turn = 0; turn != TURNS; turn++) {
        const fathom_status_t status = fathom_poll(&node->sensor, &sample);
        if (status == FATHOM_PENDING || status == FATHOM_ERR_PORT) return status;
        node->take(node->ctx, status, status == FATHOM_OK ? &sample : NULL);
    }
    return FATHOM_OK;
}

/* The same of all that is there. */
static fathom_status_t poll_source(fathom_loop_source_t *source)
{
    fathom_status_t status = FATHOM_PENDING;
    if (source->kind->poll != NULL && !source->kind->poll(source)) return FATHOM_ERR_PORT;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        const fathom_status_t its = poll_sensor(node);
        if (its == FATHOM_ERR_PORT) return its;
        if (its == FATHOM_OK) status = its;
    }
    return status;
}

static uint32_t due_us(fathom_loop_source_t *source)
{
    uint32_t us = source->kind->due_us != NULL ? source->kind->due_us(source) : FATHOM_NO_DEADLINE;
    uint32_t most_us = SELDOM_US;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        const uint32_t this_us = fathom_due_us(&node->sensor, 1);
        if (this_us < us) us = this_us;
    }
    if (source->is_readable) /* what was not read now will not become ready again */
        most_us = AGAIN_US;
    else if (source->fd >= 0 && !source->is_watched)
        most_us = UNWATCHED_US;
    return us < most_us ? us : most_us;
}

void fathom_loop_turn(fathom_loop_source_t *source)
{
    source->loop->polls++;
    fathom_loop_due_never(source); /* it was woken after it had become due */
    if (!source->is_open) {
        fathom_loop_open(source);
        return;
    }
    const fathom_status_t status = poll_source(source);
    if (status == FATHOM_ERR_PORT) {
        lose(source);
        return;
    }
    /* Who reads without fathom_loop_uart has read all. */
    if (source->inner.read == NULL || !source->is_watched) source->is_readable = false;
    const short events = events_of(source);
    if (source->kind->fd(source) != source->fd) {
        if (source->is_watched)
            (void)control(source, EPOLL_CTL_DEL); /* a closed one has left epoll already */
        watch(source);
    } else if (events != source->events) {
        source->events = events;
        if (source->is_watched) (void)control(source, EPOLL_CTL_MOD);
    }
    if (source->is_due) return; /* one of its sensors has woken it */
    uint32_t us = status == FATHOM_OK ? 0 : due_us(source);
    /* What is never done is not let take all of a processor. */
    if (us != 0)
        source->zeros = 0;
    else if (source->zeros != TURNS)
        source->zeros++;
    else
        us = AGAIN_US;
    fathom_loop_due_at(source, fathom_loop_now_us(source->loop) + us);
}
