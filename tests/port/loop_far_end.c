/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* kill */
#include "loop_far_end.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "suite.h"

enum { REQUEST = 8, WATCHDOG_S = 60 };

/* HPS-167S table 18: 2083 mm and what stands beside it; the CRC by hand. */
static const uint8_t response[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                   0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

static void serve(const posix_pty_t *ptys, unsigned count, unsigned late_ms)
{
    static struct pollfd entries[FAR_END_MOST];
    static size_t have[FAR_END_MOST];
    uint8_t bytes[REQUEST];
    for (unsigned i = 0; i != count; i++) entries[i] = (struct pollfd){ptys[i].master, POLLIN, 0};
    for (;;) {
        if (poll(entries, count, -1) <= 0) continue;
        for (unsigned i = 0; i != count; i++) {
            const ssize_t n = entries[i].revents != 0 ? read(entries[i].fd, bytes, REQUEST - have[i]) : 0;
            have[i] += n > 0 ? (size_t)n : 0;
            if (have[i] != REQUEST) continue;
            have[i] = 0;
            if (late_ms != 0) (void)poll(NULL, 0, (int)late_ms);
            if (write(entries[i].fd, response, sizeof response) != (ssize_t)sizeof response) _exit(1);
        }
    }
}

pid_t far_end_begin(const posix_pty_t *ptys, unsigned count, unsigned late_ms)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        (void)alarm(WATCHDOG_S); /* a child does not inherit it */
        serve(ptys, count, late_ms);
    }
    return child;
}

void far_end_end(pid_t child)
{
    int status = 0;
    assert_int_equal(kill(child, SIGTERM), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}
