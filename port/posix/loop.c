/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* ppoll, syscall */
#include "fathom_loop.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
#ifdef SYS_epoll_pwait2
#include <linux/time_types.h>
#endif

#include "internal/posix_loop.h"

enum { FIRST_PAUSE_US = 500000, LONGEST_PAUSE_US = 8000000, EVENTS = 64 };

uint32_t fathom_loop_due_us(const fathom_loop_t *loop)
{
    if (loop->due == NULL) return FATHOM_NO_DEADLINE;
    const uint64_t now_us = fathom_loop_now_us(loop);
    const uint64_t left_us = loop->due->due_us > now_us ? loop->due->due_us - now_us : 0;
    return left_us < FATHOM_NO_DEADLINE ? (uint32_t)left_us : FATHOM_NO_DEADLINE - 1;
}

/* epoll_wait counts milliseconds, and a t3.5 of 1.75 ms would become 1 or 2. */
static int wait_for(fathom_loop_t *loop, struct epoll_event *events, uint32_t max_us)
{
    const bool is_endless = max_us == FATHOM_NO_DEADLINE;
#ifdef SYS_epoll_pwait2
    if (!loop->has_no_pwait2) {
        const struct __kernel_timespec exact = {max_us / 1000000u, (long long)(max_us % 1000000u) * 1000};
        const long count = syscall(SYS_epoll_pwait2, loop->epoll_fd, events, EVENTS,
                                   is_endless ? NULL : &exact, NULL, (size_t)0);
        if (count >= 0 || errno == EINTR) return (int)count;
        loop->has_no_pwait2 = true; /* Linux before 5.11, or a sandbox that does not let it pass */
    }
#endif
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entry = {loop->epoll_fd, POLLIN, 0};
    const int ready = ppoll(&entry, 1, is_endless ? NULL : &limit, NULL);
    if (ready <= 0) return ready;
    return epoll_wait(loop->epoll_fd, events, EVENTS, 0);
}

static void sleep_for(fathom_loop_t *loop, uint32_t max_us)
{
    struct epoll_event events[EVENTS];
    loop->sampled_us = fathom_loop_now_us(loop);
    const int count = wait_for(loop, events, max_us);
    /* After a signal the kernel looks for no events. */
    if (count > 0) loop->sampled_us = fathom_loop_now_us(loop);
    if (count == 0) loop->sampled_us += max_us;
    for (int i = 0; i < count; i++) {
        fathom_loop_source_t *const source = events[i].data.ptr;
        if (source != NULL) {
            if ((events[i].events & (EPOLLHUP | EPOLLERR)) != 0) source->is_hung_up = true;
            fathom_loop_wake(source);
        } else { /* a stop, which has ended this sleep and no other one */
            uint64_t stops;
            const ssize_t taken = read(loop->stop_fd, &stops, sizeof stops);
            (void)taken;
        }
    }
}

void fathom_loop_wake(fathom_loop_source_t *source)
{
    if (!source->is_open) return;
    source->is_readable = true;
    fathom_loop_due_at(source, 0);
}

/* A closed descriptor has left epoll. */
void fathom_loop_renew(fathom_loop_source_t *source) { source->fd = -1; }

void fathom_loop_step(fathom_loop_t *loop, uint32_t max_us)
{
    if (loop->is_in_step) return;
    loop->is_in_step = true;
    const uint32_t due_us = fathom_loop_due_us(loop);
    if (max_us > due_us) max_us = due_us;
    loop->sleeps++;
    if (loop->config.sleep != NULL)
        loop->config.sleep(loop->config.ctx, loop, max_us);
    else
        sleep_for(loop, max_us);
    const uint64_t now_us = fathom_loop_now_us(loop);
    if (loop->config.sleep != NULL) loop->sampled_us = now_us;
    /* One that is due again at once waits for the next step, so that none keeps the others waiting. */
    fathom_loop_source_t *ready = NULL;
    fathom_loop_source_t **last = &ready;
    while (loop->due != NULL && loop->due->due_us <= now_us) {
        fathom_loop_source_t *const source = loop->due;
        fathom_loop_due_never(source);
        source->ready = NULL;
        *last = source;
        last = &source->ready;
    }
    while (ready != NULL) {
        fathom_loop_source_t *const source = ready;
        ready = source->ready;
        fathom_loop_turn(source);
    }
    loop->is_in_step = false;
}

/* A stop ends one run: this one, or where none runs the next one. */
void fathom_loop_run(fathom_loop_t *loop)
{
    if (loop->is_in_step) return;
    while (!__atomic_load_n(&loop->is_stopped, __ATOMIC_SEQ_CST)) fathom_loop_step(loop, FATHOM_NO_DEADLINE);
    __atomic_store_n(&loop->is_stopped, 0, __ATOMIC_SEQ_CST);
}

void fathom_loop_stop(fathom_loop_t *loop)
{
    const uint64_t one = 1;
    const int saved = errno;
    __atomic_store_n(&loop->is_stopped, 1, __ATOMIC_SEQ_CST);
    if (write(loop->stop_fd, &one, sizeof one) < 0) errno = saved; /* full; or -1, in simulated time */
}

int fathom_loop_fd(const fathom_loop_t *loop) { return loop->epoll_fd; }

bool fathom_loop_has(const fathom_loop_t *loop, const fathom_loop_source_t *source)
{
    const fathom_loop_source_t *at = loop->sources;
    while (at != NULL && at != source) at = at->next;
    return at != NULL;
}

void fathom_loop_add(fathom_loop_t *loop, fathom_loop_source_t *source)
{
    if (fathom_loop_has(loop, source)) return;
    source->loop = loop;
    source->next = loop->sources;
    loop->sources = source;
    fathom_loop_open(source);
}

void fathom_loop_remove(fathom_loop_source_t *source)
{
    if (source->loop == NULL) return;
    fathom_loop_source_t **at = &source->loop->sources;
    while (*at != source) at = &(*at)->next;
    *at = source->next;
    fathom_loop_due_never(source);
    if (source->is_open) fathom_loop_close(source);
    source->loop = NULL;
}

void fathom_loop_add_sensor(fathom_loop_source_t *source, fathom_loop_sensor_t *sensor)
{
    fathom_loop_sensor_t **at = &source->sensors;
    while (*at != NULL && *at != sensor) at = &(*at)->next;
    if (*at != NULL) return;
    *at = sensor;
    sensor->next = NULL;
    fathom_loop_wake(source);
}

void fathom_loop_read(fathom_loop_source_t *source, fathom_loop_sensor_t *node, fathom_sensor_t sensor,
                      void (*take)(void *ctx, fathom_status_t status, const fathom_sample_t *sample),
                      void *ctx)
{
    node->sensor = sensor;
    node->take = take;
    node->ctx = ctx;
    fathom_loop_add_sensor(source, node);
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
    loop->sampled_us = fathom_loop_now_us(loop);
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
