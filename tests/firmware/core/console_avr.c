/* SPDX-License-Identifier: MIT */
#include "console.h"

#include <avr/io.h>
#include <stdio.h>

/* GPIOR0 is a register without a function; simavr_host.c prints what is written to it. */
static int put(char character, FILE *stream)
{
    (void)stream;
    GPIOR0 = (uint8_t)character;
    return 0;
}

static FILE console;

void console_open(void)
{
    fdev_setup_stream(&console, put, NULL, _FDEV_SETUP_WRITE);
    stdout = stderr = &console;
}
