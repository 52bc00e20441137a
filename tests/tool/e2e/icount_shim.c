/* SPDX-License-Identifier: MIT */
/* For test_stats.py, to be preloaded: the port counts line errors, which a pseudo terminal does not. ICOUNT
 * names the counter that goes up by 3 with every look; all begin at 100, as if the port was in use before. */
#define _GNU_SOURCE 1
#include <linux/serial.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

int ioctl(int fd, unsigned long request, ...)
{
    static int looks;
    va_list arguments;
    va_start(arguments, request);
    void *const argument = va_arg(arguments, void *);
    va_end(arguments);
    if (request != TIOCGICOUNT) return (int)syscall(SYS_ioctl, fd, request, argument);
    const char *const name = getenv("ICOUNT");
    const int now = 100 + 3 * looks++;
    struct serial_icounter_struct *const counts = argument;
    memset(counts, 0, sizeof *counts);
    counts->parity = name != NULL && strcmp(name, "parity") == 0 ? now : 100;
    counts->frame = name != NULL && strcmp(name, "framing") == 0 ? now : 100;
    counts->overrun = 100;
    counts->brk = 100;
    return 0;
}
