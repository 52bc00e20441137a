/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_POSIX_PTY_H
#define FATHOM_TESTS_POSIX_PTY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* A pseudo terminal whose slave is the port under test, and what else the tests of the port share. Each of
 * these fails the test when the system does not do its part. */
typedef struct {
    int master; /* non-blocking */
    char path[64];
} posix_pty_t;

/* No wait of a test is longer: a limit for a machine that is very busy, not a time that is ever needed. */
enum { POSIX_LIMIT_MS = 10000 };

void posix_pty_open(posix_pty_t *pty);
/* path is one that no terminal has, from then on. */
void posix_pty_close(posix_pty_t *pty);

/* Sends all bytes to the slave. */
void posix_pty_send(const posix_pty_t *pty, const uint8_t *bytes, size_t length);

/* Takes what the slave has written, once; 0 when there is none. */
size_t posix_pty_receive(const posix_pty_t *pty, uint8_t *bytes, size_t capacity);

/* Takes `length` bytes that the slave has written or writes now, and fails if more have come by then. */
void posix_pty_receive_all(const posix_pty_t *pty, uint8_t *bytes, size_t length);

/* Waits for poll(2)'s `events`; false after POSIX_LIMIT_MS. */
bool posix_wait_for(int fd, short events);

/* Open file descriptors of this process. */
unsigned posix_count_fds(void);

/* Runs `body` in a child, without privileges when this is root, and returns its exit status; 255: it did not exit. */
int posix_run_unprivileged(int (*body)(void *), void *arg);

/* Ends the program with a signal when a test hangs. */
void posix_start_watchdog(unsigned round);

#endif
