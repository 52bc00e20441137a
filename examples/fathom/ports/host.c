/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ppoll */
#include "ports/host.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <time.h>
#include <unistd.h>

#include "ports/adapter.h"

/* ---- signals ---- */

/* A byte in this pipe ends every sleep, also a sleep that begins just after the signal. */
static int wake[2];
static volatile sig_atomic_t ended;
static volatile sig_atomic_t has_signal; /* that of host_watch_signal() */
static bool output_gone;

static void ring(void)
{
    const int saved = errno;
    if (write(wake[1], "", 1) < 0) errno = saved; /* a full pipe wakes as well */
}

static void on_end(int number)
{
    (void)number;
    ended = 1;
    ring();
}

static void on_signal(int number)
{
    (void)number;
    has_signal = 1;
    ring();
}

static void handle(int number, void (*handler)(int))
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    /* Without SA_RESTART, so that a signal also ends a write to an output without a reader. */
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, NULL);
}

/* SIGHUP ends the command unless nohup ignores it. Broken and limited outputs are reported by write errors. */
static bool begin(void *ctx)
{
    struct sigaction old;
    (void)ctx;
    if (pipe(wake) != 0) {
        (void)fprintf(stderr, "fathom: %s\n", strerror(errno));
        return false;
    }
    for (int i = 0; i != 2; i++) {
        (void)fcntl(wake[i], F_SETFL, O_NONBLOCK);
        (void)fcntl(wake[i], F_SETFD, FD_CLOEXEC);
    }
    handle(SIGINT, on_end);
    handle(SIGTERM, on_end);
    if (sigaction(SIGHUP, NULL, &old) == 0 && old.sa_handler != SIG_IGN) handle(SIGHUP, on_end);
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    return true;
}

void host_watch_signal(int number) { handle(number, on_signal); }

bool host_had_signal(void)
{
    const bool had = has_signal != 0;
    has_signal = 0;
    return had;
}

static bool has_ended(void *ctx)
{
    (void)ctx;
    return ended != 0;
}

static bool is_output_gone(void *ctx)
{
    (void)ctx;
    return output_gone;
}

/* A signal that ended the command goes on to end every sleep; any other one ends a single sleep. */
static void drain(void)
{
    char bytes[16];
    if (read(wake[0], bytes, sizeof bytes) > 0 && ended != 0) ring();
}

/* ---- ports ---- */

static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    (void)ctx;
    if (fathom_posix_open(port, path, settings) != FATHOM_POSIX_OK) return false;
    *uart = fathom_posix_uart(port);
    return true;
}

static void close_port(void *ctx, fathom_posix_uart_t *port)
{
    (void)ctx;
    fathom_posix_close(port);
}

static bool open_pins(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins)
{
    (void)ctx;
    return pins_open(pins, chip, wanted);
}

static void close_pins(void *ctx, pins_t *pins)
{
    (void)ctx;
    pins_close(pins);
}

/* ---- time ---- */

static uint64_t now_us(void *ctx)
{
    (void)ctx;
    return fathom_posix_now_us();
}

static uint64_t utc_us(void *ctx)
{
    struct timespec now = {0, 0};
    (void)ctx;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static void wait_for(void *ctx, int fd, short events, uint32_t max_us, bool watch_output)
{
    /* ppoll, because a silence of 1.75 ms does not fit whole milliseconds. */
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entries[] = {{fd, events, 0}, {wake[0], POLLIN, 0}, {STDOUT_FILENO, 0, 0}};
    (void)ctx;
    if (ppoll(entries, watch_output ? 3 : 2, max_us == FATHOM_NO_DEADLINE ? NULL : &limit, NULL) <= 0) return;
    if ((entries[1].revents & POLLIN) != 0) drain();
    if ((entries[2].revents & (POLLERR | POLLHUP)) != 0) output_gone = true;
}

/* ---- the same in a loop ---- */

static int wake_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return wake[0];
}

static bool poll_wake(fathom_loop_source_t *source)
{
    (void)source;
    drain();
    return true;
}

static int output_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return STDOUT_FILENO;
}

/* A lost reader is reported without being asked for. */
static short output_events(const fathom_loop_source_t *source)
{
    (void)source;
    return 0;
}

static bool poll_output(fathom_loop_source_t *source)
{
    struct pollfd entry = {STDOUT_FILENO, 0, 0};
    (void)source;
    if (poll(&entry, 1, 0) > 0 && (entry.revents & (POLLERR | POLLHUP)) != 0) output_gone = true;
    return true;
}

/* epoll refuses a file, which has no reader that could go away. */
static bool has_reader(void)
{
    struct epoll_event event = {0};
    const int fd = epoll_create1(EPOLL_CLOEXEC);
    const bool has = fd >= 0 && epoll_ctl(fd, EPOLL_CTL_ADD, STDOUT_FILENO, &event) == 0;
    if (fd >= 0) (void)close(fd);
    return has;
}

static void attend(void *ctx, fathom_loop_t *loop)
{
    static const fathom_loop_kind_t wakes = {.fd = wake_fd, .poll = poll_wake};
    static const fathom_loop_kind_t outputs = {.fd = output_fd, .events = output_events, .poll = poll_output};
    static fathom_loop_source_t sources[2];
    (void)ctx;
    memset(sources, 0, sizeof sources);
    sources[0].kind = &wakes;
    sources[1].kind = &outputs;
    fathom_loop_add(loop, &sources[0]);
    if (has_reader()) fathom_loop_add(loop, &sources[1]);
    adapter_watch(loop);
}

const host_t host_posix = {.open = open_port,
                           .close = close_port,
                           .open_pins = open_pins,
                           .close_pins = close_pins,
                           .now_us = now_us,
                           .utc_us = utc_us,
                           .begin = begin,
                           .has_ended = has_ended,
                           .is_output_gone = is_output_gone,
                           .wait = wait_for,
                           .attend = attend};
