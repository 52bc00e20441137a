/* SPDX-License-Identifier: MIT */
#include "shared/command.h"

#include <errno.h>
#include <stdarg.h>

int usage_error(const char *command, const char *format, ...)
{
    const char *const gap = command[0] != '\0' ? " " : "";
    va_list arguments;
    (void)fprintf(stderr, "fathom%s%s: ", gap, command);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    (void)fprintf(stderr, "; try: fathom%s%s --help\n", gap, command);
    return STATUS_USAGE;
}

int command_help(const command_t *command)
{
    command->help(stdout);
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

int output_flush(void)
{
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return 0;
    return errno != 0 ? errno : EIO;
}
