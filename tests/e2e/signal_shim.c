/* SPDX-License-Identifier: MIT */
/* For test_errors.py, to be preloaded: a SIGINT comes when the program has decided to sleep for more than a
 * second and does not sleep yet. */
#define _GNU_SOURCE 1
#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask)
{
    struct timespec left = {0, 0};
    if (limit != NULL) left = *limit;
    if (limit == NULL || left.tv_sec > 0) (void)raise(SIGINT);
    return (int)syscall(SYS_ppoll, entries, count, limit != NULL ? &left : NULL, mask, _NSIG / 8);
}
