/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* ptsname_r */
#include "posix_pty.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "suite.h"

enum { UNPRIVILEGED = 65534, WATCHDOG_S = 60 };

void posix_pty_open(posix_pty_t *pty)
{
    pty->master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(pty->master >= 0);
    assert_int_equal(grantpt(pty->master), 0);
    assert_int_equal(unlockpt(pty->master), 0);
    assert_int_equal(ptsname_r(pty->master, pty->path, sizeof pty->path), 0);
    assert_int_equal(fcntl(pty->master, F_SETFL, O_RDWR | O_NONBLOCK), 0);
}

void posix_pty_close(posix_pty_t *pty)
{
    /* The system may give the path to another program at once. */
    strcpy(pty->path, "/dev/pts/closed");
    if (pty->master >= 0) assert_int_equal(close(pty->master), 0);
    pty->master = -1;
}

void posix_pty_send(const posix_pty_t *pty, const uint8_t *bytes, size_t length)
{
    while (length != 0) {
        const ssize_t n = write(pty->master, bytes, length);
        if (n < 0) {
            assert_int_equal(errno, EAGAIN);
            assert_true(posix_wait_for(pty->master, POLLOUT));
        } else {
            bytes += n;
            length -= (size_t)n;
        }
    }
}

size_t posix_pty_receive(const posix_pty_t *pty, uint8_t *bytes, size_t capacity)
{
    const ssize_t n = read(pty->master, bytes, capacity);
    if (n < 0) assert_int_equal(errno, EAGAIN);
    return n < 0 ? 0 : (size_t)n;
}

void posix_pty_receive_all(const posix_pty_t *pty, uint8_t *bytes, size_t length)
{
    uint8_t more;
    for (size_t have = 0; have != length;) {
        assert_true(posix_wait_for(pty->master, POLLIN));
        have += posix_pty_receive(pty, bytes + have, length - have);
    }
    assert_int_equal(posix_pty_receive(pty, &more, 1), 0);
}

bool posix_wait_for(int fd, short events)
{
    struct pollfd entry = {fd, events, 0};
    return poll(&entry, 1, POSIX_LIMIT_MS) == 1 && (entry.revents & events) != 0;
}

unsigned posix_count_fds(void)
{
    DIR *const folder = opendir("/proc/self/fd");
    assert_non_null(folder);
    unsigned count = 0;
    while (readdir(folder) != NULL) count++;
    assert_int_equal(closedir(folder), 0);
    return count;
}

int posix_run_unprivileged(int (*body)(void *), void *arg)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        (void)alarm(WATCHDOG_S); /* a child does not inherit it */
        if (geteuid() == 0 &&
            (setgroups(0, NULL) != 0 || setgid(UNPRIVILEGED) != 0 || setuid(UNPRIVILEGED) != 0))
            _exit(254);
        _exit(body(arg));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 255;
}

void posix_start_watchdog(unsigned round) { (void)alarm(WATCHDOG_S); }
