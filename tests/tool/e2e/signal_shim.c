/* SPDX-License-Identifier: MIT */
/* For test_errors.py, to be preloaded: a SIGINT comes when the program has decided to sleep for more than a
 * second and does not sleep yet. */
#define _GNU_SOURCE 1
#include <dlfcn.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static void before_sleep(const struct timespec *limit)
{
    if (limit == NULL || limit->tv_sec > 0) (void)raise(SIGINT);
}

/* By which port/posix/loop.c calls epoll_pwait2. */
long syscall(long number, ...)
{
    long (*const real)(long, ...) = (long (*)(long, ...))dlsym(RTLD_NEXT, "syscall");
    long words[6];
    va_list arguments;
    va_start(arguments, number);
    for (int i = 0; i != 6; i++) words[i] = va_arg(arguments, long);
    va_end(arguments);
#ifdef SYS_epoll_pwait2
    if (number == SYS_epoll_pwait2) before_sleep((const struct timespec *)words[3]);
#endif
    return real(number, words[0], words[1], words[2], words[3], words[4], words[5]);
}

int ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask)
{
    struct timespec left = {0, 0};
    if (limit != NULL) left = *limit;
    before_sleep(limit);
    return (int)syscall(SYS_ppoll, entries, count, limit != NULL ? &left : NULL, mask, _NSIG / 8);
}
