/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ftruncate */
#include "cli/command.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio_ext.h>
#include <sys/stat.h>
#include <unistd.h>

/* Of a file: where it ends. */
static off_t end_of_output(void)
{
    struct stat is;
    return fstat(STDOUT_FILENO, &is) == 0 && S_ISREG(is.st_mode) ? is.st_size : -1;
}

/* A disk that is full takes a part of a row. It is taken back, unless another program has added to the file since. */
static void take_back(off_t before, size_t length)
{
    const off_t now = end_of_output();
    __fpurge(stdout); /* the other part */
    if (before >= 0 && now > before && now - before < (off_t)length && ftruncate(STDOUT_FILENO, before) != 0)
        return;
}

int output_flush(void)
{
    const size_t length = __fpending(stdout);
    const off_t before = end_of_output();
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return 0;
    const int error = errno != 0 ? errno : EIO;
    take_back(before, length);
    return error;
}
