/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ppoll, pipe2 */
#include "ports/host.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "ports/adapter.h"

/* ---- signals ---- */

/* A byte in this pipe ends every sleep, also a sleep that begins just after the signal. */
static int wake[2];
static volatile sig_atomic_t ended;
static volatile sig_atomic_t watched; /* the number of host_watch_signal() */
static volatile sig_atomic_t has_watched;
static bool output_gone;

static void ring(void)
{
    const int saved = errno;
    if (write(wake[1], "", 1) < 0) errno = saved; /* a full pipe wakes as well */
}

static void on_signal(int number)
{
    if (number == watched)
        has_watched = 1;
    else
        ended = 1;
    ring();
}

/* Without SA_RESTART, so that a signal also ends a write to an output without a reader. */
static void handle(int number)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, NULL);
}

/* SIGHUP ends the command unless nohup ignores it. Broken and limited outputs are reported by write errors. */
static bool begin(void *ctx)
{
    struct sigaction old;
    (void)ctx;
    if (pipe2(wake, O_NONBLOCK | O_CLOEXEC) != 0) {
        (void)fprintf(stderr, "fathom: %s\n", strerror(errno));
        return false;
    }
    handle(SIGINT);
    handle(SIGTERM);
    if (sigaction(SIGHUP, NULL, &old) == 0 && old.sa_handler != SIG_IGN) handle(SIGHUP);
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    return true;
}

void host_watch_signal(int number)
{
    watched = number;
    handle(number);
}

bool host_had_signal(void)
{
    const bool had = has_watched != 0;
    has_watched = 0;
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
    *uart = fathom_posix_uart(port);
    return fathom_posix_open(port, path, settings) == FATHOM_POSIX_OK;
}

static void close_port(void *ctx, fathom_posix_uart_t *port)
{
    (void)ctx;
    fathom_posix_close(port);
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

typedef struct {
    fathom_loop_source_t source;
    int fd;
    short events;
    void (*look)(void);
} event_t;

static int event_fd(const fathom_loop_source_t *source) { return ((const event_t *)source)->fd; }

static short event_events(const fathom_loop_source_t *source) { return ((const event_t *)source)->events; }

static bool poll_event(fathom_loop_source_t *source)
{
    ((const event_t *)source)->look();
    return true;
}

static void look_at_output(void)
{
    struct pollfd entry = {STDOUT_FILENO, 0, 0};
    if (poll(&entry, 1, 0) > 0 && (entry.revents & (POLLERR | POLLHUP)) != 0) output_gone = true;
}

/* Returns STDOUT_FILENO, or -1 if it has no reader that could go away. epoll refuses a file. */
static int output_fd(void)
{
    struct stat status;
    const bool is_known = fstat(STDOUT_FILENO, &status) == 0;
    const bool is_stream = is_known && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
    return is_stream || isatty(STDOUT_FILENO) == 1 ? STDOUT_FILENO : -1;
}

static void attend(void *ctx, fathom_loop_t *loop)
{
    static const fathom_loop_kind_t kind = {.fd = event_fd, .events = event_events, .poll = poll_event};
    static event_t events[3];
    (void)ctx;
    events[0] = (event_t){{.kind = &kind}, wake[0], POLLIN, drain};
    events[1] = (event_t){{.kind = &kind}, output_fd(), 0, look_at_output}; /* a loss needs no event */
    events[2] = (event_t){{.kind = &kind}, adapter_fd(), POLLIN, adapter_look};
    for (size_t i = 0; i != sizeof events / sizeof events[0]; i++)
        if (events[i].fd >= 0) fathom_loop_add(loop, &events[i].source);
}

const host_t host_posix = {.open = open_port,
                           .close = close_port,
                           .open_pins = pins_open,
                           .close_pins = pins_close,
                           .now_us = now_us,
                           .utc_us = utc_us,
                           .begin = begin,
                           .has_ended = has_ended,
                           .is_output_gone = is_output_gone,
                           .wait = wait_for,
                           .attend = attend};
