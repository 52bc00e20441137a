/* SPDX-License-Identifier: MIT */
/* bench_far_end COUNT: the far ends of COUNT lines with an HPS-167S, for publish.py. Prints their ports, and ends when
 * the standard input does. Each responds at once. What that costs is no part of what is measured, but takes time of the
 * machine: it is as little as can be. */
#define _GNU_SOURCE 1 /* cfmakeraw, ptsname_r */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/hps167s_registers.h"

enum { LINES_MOST = 256, LINES_PATH = 32, LINES_UNIT = 1 };
enum { REQUEST = 8, RESPONSE = 13, EVENTS = 64 };

/* The distance tells which line it is and how many responses it has sent: two lines that were mixed up, and a response
 * that was lost or came twice, are seen. */
enum { LINES_FIRST_MM = 1000, LINES_RESPONSES = 16 };

typedef struct {
    int master;
    unsigned number;
    size_t have;
    uint8_t bytes[REQUEST];
} end_t;

static end_t ends[LINES_MOST];

static size_t with_crc(uint8_t *frame, size_t length)
{
    const uint16_t crc = fathom_crc16(frame, (uint8_t)length);
    frame[length] = (uint8_t)crc;
    frame[length + 1] = (uint8_t)(crc >> 8);
    return length + 2;
}

/* Opens a pty. A slave of its own stays open, so that no hang-up is seen between two readers. */
static bool open_pty(end_t *end, char *path)
{
    struct termios tty;
    end->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (end->master < 0 || grantpt(end->master) != 0 || unlockpt(end->master) != 0 ||
        ptsname_r(end->master, path, LINES_PATH) != 0)
        return false;
    const int slave = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (slave < 0 || tcgetattr(slave, &tty) != 0) return false;
    cfmakeraw(&tty);
    return tcsetattr(slave, TCSANOW, &tty) == 0;
}

/* Datasheet, command #5: distance, magnitude, its exponent and the ambient light, precision. */
static void respond(end_t *end, unsigned line)
{
    const unsigned distance_mm = LINES_FIRST_MM + line * LINES_RESPONSES + end->number;
    uint8_t frame[RESPONSE] = {
        LINES_UNIT, 3, 8, (uint8_t)(distance_mm >> 8), (uint8_t)distance_mm, 0x16, 0x2E, 0, 1, 0, 5};
    end->number = (end->number + 1) % LINES_RESPONSES;
    const size_t length = with_crc(frame, RESPONSE - 2);
    if (write(end->master, frame, length) != (ssize_t)length)
        (void)fputs("bench_far_end: a response got stuck\n", stderr);
}

static void serve(int epoll_fd)
{
    uint8_t request[REQUEST] = {
        LINES_UNIT, 3, 0, FATHOM_HPS167S_MEASUREMENT, 0, FATHOM_HPS167S_MEASUREMENT_COUNT};
    (void)with_crc(request, REQUEST - 2);
    for (;;) {
        struct epoll_event events[EVENTS];
        const int count = epoll_wait(epoll_fd, events, EVENTS, -1);
        for (int i = 0; i < count; i++) {
            end_t *const end = events[i].data.ptr;
            if (end == NULL) _exit(EXIT_SUCCESS); /* the reader is gone */
            const ssize_t n = read(end->master, end->bytes + end->have, REQUEST - end->have);
            if (n > 0) end->have += (size_t)n;
            if (end->have != REQUEST) continue;
            end->have = 0;
            if (memcmp(end->bytes, request, REQUEST) == 0) respond(end, (unsigned)(end - ends));
        }
    }
}

static bool open_all(int epoll_fd, unsigned count, char (*paths)[LINES_PATH])
{
    for (unsigned n = 0; n != count; n++) {
        struct epoll_event event = {.events = EPOLLIN, .data.ptr = &ends[n]};
        if (!open_pty(&ends[n], paths[n]) || epoll_ctl(epoll_fd, EPOLL_CTL_ADD, ends[n].master, &event) != 0)
            return false;
    }
    return true;
}

static bool fail(const char *what)
{
    (void)fprintf(
        stderr, "bench_far_end: %s: %s; /proc/sys/kernel/pty/max and ulimit -n tell how many there can be\n",
        what, strerror(errno));
    return false;
}

static bool begin(unsigned count, char (*paths)[LINES_PATH])
{
    int pair[2];
    const size_t size = count * sizeof *paths;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return fail("the far end");
    const pid_t pid = fork();
    if (pid < 0) return fail("the far end");
    if (pid == 0) {
        struct epoll_event event = {.events = EPOLLIN, .data.ptr = NULL};
        (void)close(pair[0]);
        const int epoll_fd = epoll_create1(EPOLL_CLOEXEC);
        if (epoll_ctl(epoll_fd, EPOLL_CTL_ADD, pair[1], &event) != 0 || !open_all(epoll_fd, count, paths)) {
            (void)fail("no pty for every line");
            _exit(EXIT_FAILURE);
        }
        if (write(pair[1], paths, size) == (ssize_t)size) serve(epoll_fd);
        _exit(EXIT_FAILURE);
    }
    (void)close(pair[1]); /* the other one stays open as long as this process lives */
    return recv(pair[0], paths, size, MSG_WAITALL) == (ssize_t)size;
}

int main(int argc, char **argv)
{
    static char paths[LINES_MOST][LINES_PATH];
    const long count = argc == 2 ? strtol(argv[1], NULL, 10) : 0;
    if (count < 1 || count > LINES_MOST) {
        (void)fputs("usage: bench_far_end COUNT\n", stderr);
        return 2;
    }
    if (!begin((unsigned)count, paths)) return EXIT_FAILURE;
    for (long i = 0; i != count; i++) (void)puts(paths[i]);
    (void)fflush(stdout);
    while (getchar() != EOF) continue;
    return EXIT_SUCCESS;
}
