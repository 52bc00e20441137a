/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "suite.h"

#ifdef __AVR__
#include <avr/io.h>

/* GPIOR0 is a register without a function; simavr_host.c prints what is written to it. */
static int put(char character, FILE *stream)
{
    GPIOR0 = (uint8_t)character;
    return 0;
}

/* A microcontroller is called with no arguments: it runs every suite that it has. */
int main(void)
{
    static FILE console;
    fdev_setup_stream(&console, put, NULL, _FDEV_SETUP_WRITE);
    stdout = stderr = &console;
    return suite_run(0, NULL);
}
#else
/* Of the suites named. Line by line, so that a crash loses nothing. */
int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    return suite_run(argc - 1, argv + 1) != 0;
}
#endif
