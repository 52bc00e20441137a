/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* ppoll, syscall */
#include "fathom_loop.h"

#include <errno.h>
#include <linux/time_types.h>
#include <poll.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "internal/posix_loop.h"

enum { FIRST_PAUSE_US = 500000, LONGEST_PAUSE_US = 8000000, STEADY_US = 1000000, AGAIN_US = 1000 };
enum { TURNS = 16, EVENTS = 64 };

uint64_t fathom_loop_now_us(const fathom_loop_t *loop)
{
    return loop->config.now_us != NULL ? loop->config.now_us(loop->config.ctx) : fathom_posix_now_us();
}

/* ---- opening and closing ---- */

static void tell(fathom_loop_source_t *source, bool is_open)
{
    const fathom_loop_config_t *const config = &source->loop->config;
    if (config->tell != NULL) config->tell(config->ctx, source, is_open);
}

const char *fathom_loop_error_text(const fathom_loop_source_t *source)
{
    if (source->kind->error_text != NULL) return source->kind->error_text(source);
    return source->is_open ? "" : "it is lost";
}

/* What is waited for. A descriptor that epoll does not take (a file) is always ready, and needs no waiting. */
static void watch(fathom_loop_source_t *source, int operation)
{
    struct epoll_event event = {.events = EPOLLET | (uint32_t)source->events, .data.ptr = source};
    if (source->fd < 0 || source->loop->config.sleep != NULL) return;
    (void)epoll_ctl(source->loop->epoll_fd, operation, source->fd, &event);
}

static void pause_source(fathom_loop_source_t *source, uint64_t now_us)
{
    const fathom_loop_config_t *const config = &source->loop->config;
    source->pause_us = source->pause_us == 0 ? config->first_pause_us : source->pause_us * 2;
    if (source->pause_us > config->longest_pause_us) source->pause_us = config->longest_pause_us;
    fathom_loop_due_at(source, now_us + source->pause_us);
}

static void open_source(fathom_loop_source_t *source)
{
    const fathom_loop_kind_t *const kind = source->kind;
    source->is_open = kind->open == NULL || kind->open(source);
    const uint64_t now_us = fathom_loop_now_us(source->loop);
    if (!source->is_open) {
        pause_source(source, now_us);
        tell(source, false);
        return;
    }
    source->fd = kind->fd(source);
    source->events = kind->events != NULL ? kind->events(source) : POLLIN;
    source->opened_us = now_us;
    source->is_readable = true; /* perhaps: it became so before it was watched */
    watch(source, EPOLL_CTL_ADD);
    fathom_loop_due_at(source, now_us);
    tell(source, true);
}

static void close_source(fathom_loop_source_t *source)
{
    if (!source->is_open) return;
    watch(source, EPOLL_CTL_DEL);
    source->is_open = false;
    if (source->kind->close != NULL) source->kind->close(source);
}

/* Each sensor is told once; a reading that it still had comes first. */
static void lose_source(fathom_loop_source_t *source)
{
    const uint64_t now_us = fathom_loop_now_us(source->loop);
    for (fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        fathom_sample_t sample;
        while (fathom_poll(&node->sensor, &sample) == FATHOM_READY)
            node->take(node->ctx, FATHOM_READY, &sample);
        node->take(node->ctx, FATHOM_ERR_PORT, NULL);
    }
    if (now_us - source->opened_us >= STEADY_US) source->pause_us = 0;
    close_source(source);
    pause_source(source, now_us);
    tell(source, false);
}

/* ---- polling ---- */

/* False: the port is lost. */
static bool poll_sensor(const fathom_loop_sensor_t *node)
{
    fathom_sample_t sample;
    for (unsigned turn = 0; turn != TURNS; turn++) {
        const fathom_status_t status = fathom_poll(&node->sensor, &sample);
        if (status == FATHOM_PENDING) return true;
        if (status == FATHOM_ERR_PORT) return false;
        node->take(node->ctx, status, status == FATHOM_READY ? &sample : NULL);
    }
    return true;
}

static bool poll_source(fathom_loop_source_t *source)
{
    if (source->kind->poll != NULL && !source->kind->poll(source)) return false;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next)
        if (!poll_sensor(node)) return false;
    return true;
}

static uint32_t due_us(fathom_loop_source_t *source)
{
    uint32_t least_us = source->kind->due_us != NULL ? source->kind->due_us(source) : FATHOM_NO_DEADLINE;
    for (const fathom_loop_sensor_t *node = source->sensors; node != NULL; node = node->next) {
        const uint32_t this_us = fathom_due_us(&node->sensor, 1);
        if (this_us < least_us) least_us = this_us;
    }
    /* What was not read now will not become ready again. */
    return source->is_readable && source->fd >= 0 && least_us > AGAIN_US ? AGAIN_US : least_us;
}

static void turn(fathom_loop_source_t *source)
{
    source->loop->polls++;
    if (!source->is_open) {
        open_source(source);
        return;
    }
    const bool had_come = source->is_readable;
    if (!poll_source(source)) {
        lose_source(source);
        return;
    }
    if (source->inner.read == NULL || !had_come) source->is_readable = false;
    const short events = source->kind->events != NULL ? source->kind->events(source) : POLLIN;
    if (events != source->events) {
        source->events = events;
        watch(source, EPOLL_CTL_MOD);
    }
    const uint32_t least_us = due_us(source);
    if (least_us == FATHOM_NO_DEADLINE)
        fathom_loop_due_never(source);
    else
        fathom_loop_due_at(source, fathom_loop_now_us(source->loop) + least_us);
}

/* ---- the loop ---- */

uint32_t fathom_loop_due_us(const fathom_loop_t *loop)
{
    if (loop->due == NULL) return FATHOM_NO_DEADLINE;
    const uint64_t now_us = fathom_loop_now_us(loop);
    const uint64_t left_us = loop->due->due_us > now_us ? loop->due->due_us - now_us : 0;
    return left_us < FATHOM_NO_DEADLINE ? (uint32_t)left_us : FATHOM_NO_DEADLINE - 1;
}

/* epoll_wait counts milliseconds, and a t3.5 of 1.75 ms would become 1 or 2. */
static int wait_for(const fathom_loop_t *loop, struct epoll_event *events, uint32_t max_us)
{
    const bool is_endless = max_us == FATHOM_NO_DEADLINE;
#ifdef SYS_epoll_pwait2
    const struct __kernel_timespec exact = {max_us / 1000000u, (long long)(max_us % 1000000u) * 1000};
    const long count = syscall(SYS_epoll_pwait2, loop->epoll_fd, events, EVENTS, is_endless ? NULL : &exact,
                               NULL, (size_t)0);
    if (count >= 0 || errno != ENOSYS) return (int)count;
#endif
    /* Before Linux 5.11. */
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entry = {loop->epoll_fd, POLLIN, 0};
    if (ppoll(&entry, 1, is_endless ? NULL : &limit, NULL) <= 0) return 0;
    return epoll_wait(loop->epoll_fd, events, EVENTS, 0);
}

static void sleep_for(const fathom_loop_t *loop, uint32_t max_us)
{
    struct epoll_event events[EVENTS];
    const int count = wait_for(loop, events, max_us);
    for (int i = 0; i < count; i++)
        if (events[i].data.ptr != NULL) fathom_loop_wake(events[i].data.ptr);
}

void fathom_loop_wake(fathom_loop_source_t *source)
{
    if (!source->is_open) return;
    source->is_readable = true;
    fathom_loop_due_at(source, 0);
}

void fathom_loop_step(fathom_loop_t *loop, uint32_t max_us)
{
    const uint32_t due_us = fathom_loop_due_us(loop);
    if (max_us > due_us) max_us = due_us;
    loop->sleeps++;
    if (loop->config.sleep != NULL)
        loop->config.sleep(loop->config.ctx, loop, max_us);
    else
        sleep_for(loop, max_us);
    const uint64_t now_us = fathom_loop_now_us(loop);
    /* One that is due again at once waits for the next step, so that none keeps the others waiting. */
    fathom_loop_source_t *ready = NULL;
    while (loop->due != NULL && loop->due->due_us <= now_us) {
        fathom_loop_source_t *const source = loop->due;
        fathom_loop_due_never(source);
        source->ready = ready;
        ready = source;
    }
    while (ready != NULL) {
        fathom_loop_source_t *const source = ready;
        ready = source->ready;
        turn(source);
    }
}

void fathom_loop_run(fathom_loop_t *loop)
{
    while (!loop->is_stopped) fathom_loop_step(loop, FATHOM_NO_DEADLINE);
}

void fathom_loop_stop(fathom_loop_t *loop)
{
    const uint64_t one = 1;
    const int saved = errno;
    loop->is_stopped = 1;
    if (loop->stop_fd >= 0 && write(loop->stop_fd, &one, sizeof one) < 0) errno = saved;
}

int fathom_loop_fd(const fathom_loop_t *loop) { return loop->epoll_fd; }

void fathom_loop_add(fathom_loop_t *loop, fathom_loop_source_t *source)
{
    source->loop = loop;
    source->next = loop->sources;
    loop->sources = source;
    open_source(source);
}

void fathom_loop_remove(fathom_loop_source_t *source)
{
    fathom_loop_source_t **at = &source->loop->sources;
    while (*at != source) at = &(*at)->next;
    *at = source->next;
    close_source(source);
    fathom_loop_due_never(source);
}

void fathom_loop_add_sensor(fathom_loop_source_t *source, fathom_loop_sensor_t *sensor)
{
    fathom_loop_sensor_t **at = &source->sensors;
    while (*at != NULL) at = &(*at)->next;
    *at = sensor;
    sensor->next = NULL;
    if (source->is_open) fathom_loop_wake(source);
}

fathom_posix_status_t fathom_loop_init(fathom_loop_t *loop, const fathom_loop_config_t *config)
{
    struct epoll_event event = {.events = EPOLLIN};
    if (loop == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    memset(loop, 0, sizeof *loop);
    loop->epoll_fd = loop->stop_fd = -1;
    if (config != NULL) loop->config = *config;
    if (loop->config.first_pause_us == 0) loop->config.first_pause_us = FIRST_PAUSE_US;
    if (loop->config.longest_pause_us == 0) loop->config.longest_pause_us = LONGEST_PAUSE_US;
    if (loop->config.sleep != NULL) return FATHOM_POSIX_OK;
    loop->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
    loop->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (loop->epoll_fd >= 0 && loop->stop_fd >= 0 &&
        epoll_ctl(loop->epoll_fd, EPOLL_CTL_ADD, loop->stop_fd, &event) == 0)
        return FATHOM_POSIX_OK;
    fathom_loop_deinit(loop);
    return FATHOM_POSIX_ERR_SYSTEM;
}

void fathom_loop_deinit(fathom_loop_t *loop)
{
    while (loop->sources != NULL) fathom_loop_remove(loop->sources);
    if (loop->stop_fd >= 0) (void)close(loop->stop_fd);
    if (loop->epoll_fd >= 0) (void)close(loop->epoll_fd);
    loop->epoll_fd = loop->stop_fd = -1;
}
