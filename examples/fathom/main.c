/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open, fcntl */
#include <fcntl.h>
#include <unistd.h>

#include "commands/commands.h"

/*
 * A descriptor that is closed at the start would be given to the next file that is opened, and readings would
 * go to the sensor.
 */
static int check_descriptors(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
        if (fcntl(fd, F_GETFD) != -1) continue;
        if (fd == STDOUT_FILENO) {
            (void)fprintf(stderr, "fathom: the standard output is closed, there is nowhere to write to.\n");
            return STATUS_FAILED;
        }
        if (open("/dev/null", O_RDWR) != fd) return STATUS_FAILED;
    }
    return STATUS_OK;
}

int main(int argc, char **argv)
{
    if (check_descriptors() != STATUS_OK) return STATUS_FAILED;
    return run_command(&host_posix, argc, argv);
}
