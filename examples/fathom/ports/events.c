/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ppoll */
#include "ports/events.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <time.h>
#include <unistd.h>

#include "fathom/hal.h"

/* A byte in this pipe ends every sleep, also one that begins just after the signal; those of signals that do not end
 * the command are taken out again. */
static int wake[2];
static volatile sig_atomic_t ended;
static volatile sig_atomic_t noted; /* the one that events_note has named */
static bool output_gone;

static void ring(void)
{
    const int saved = errno;
    /* A full pipe wakes as well. */
    if (write(wake[1], "", 1) < 0) errno = saved;
}

static void on_end(int number)
{
    (void)number;
    ended = 1;
    ring();
}

static void on_note(int number)
{
    (void)number;
    noted = 1;
    ring();
}

static void handle(int number, void (*handler)(int))
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    /* No SA_RESTART: a write to an output without a reader must end too. */
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, NULL);
}

bool events_begin(void)
{
    struct sigaction old;
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

void events_note(int number) { handle(number, on_note); }

bool events_noted(void)
{
    const bool has = noted != 0;
    noted = 0;
    return has;
}

bool events_ended(void) { return ended != 0; }

bool events_output_gone(void) { return output_gone; }

/* So that a signal that did not end the command wakes it once; one that did goes on to end every sleep. */
static void drain(void)
{
    char bytes[16];
    if (read(wake[0], bytes, sizeof bytes) > 0 && ended != 0 && write(wake[1], "", 1) < 0) return;
}

void events_wait(int fd, short events, uint32_t max_us, bool watch_output)
{
    /* In whole milliseconds a t3.5 of 1.75 ms would become 1 or 2. */
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entries[] = {{fd, events, 0}, {wake[0], POLLIN, 0}, {STDOUT_FILENO, 0, 0}};
    if (ppoll(entries, watch_output ? 3 : 2, max_us == FATHOM_NO_DEADLINE ? NULL : &limit, NULL) <= 0) return;
    if ((entries[1].revents & POLLIN) != 0) drain();
    if ((entries[2].revents & (POLLERR | POLLHUP)) != 0) output_gone = true;
}

/* ---- the same, in a loop ---- */

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

/* What a lost reader brings is told unasked. */
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

/* A file has no reader that could go; epoll refuses it. */
static bool has_reader(void)
{
    struct epoll_event event = {0};
    const int fd = epoll_create1(EPOLL_CLOEXEC);
    const bool has = fd >= 0 && epoll_ctl(fd, EPOLL_CTL_ADD, STDOUT_FILENO, &event) == 0;
    if (fd >= 0) (void)close(fd);
    return has;
}

void events_attend(fathom_loop_t *loop)
{
    static const fathom_loop_kind_t wakes = {.fd = wake_fd, .poll = poll_wake};
    static const fathom_loop_kind_t outputs = {.fd = output_fd, .events = output_events, .poll = poll_output};
    static fathom_loop_source_t sources[2];
    memset(sources, 0, sizeof sources);
    sources[0].kind = &wakes;
    sources[1].kind = &outputs;
    fathom_loop_add(loop, &sources[0]);
    if (has_reader()) fathom_loop_add(loop, &sources[1]);
}
