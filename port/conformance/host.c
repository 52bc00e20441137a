/* SPDX-License-Identifier: MIT */
/*
 * The conformance kit on a serial port of this system, TX and RX joined:
 *
 *   fathom_conformance_host /dev/ttyUSB0 [19200 [LATE_MS]]
 *
 * Exit status: 0, all that was seen is kept; 1, some is not; 2, the port cannot be opened, or wrong words.
 */
#include <stdio.h>
#include <stdlib.h>

#include "fathom_conformance.h"
#include "fathom_posix.h"

static void report(void *ctx, const fathom_finding_t *finding)
{
    (void)ctx;
    (void)printf("%-8s  %-16s  %10lu  %-38s  %s\n", fathom_verdict_name(finding->verdict), finding->name,
                 (unsigned long)finding->figure, finding->of, finding->clause);
}

int main(int argc, char **argv)
{
    fathom_posix_uart_t port;
    const unsigned long baud = argc > 2 ? strtoul(argv[2], NULL, 10) : 19200;
    const unsigned long late_ms = argc > 3 ? strtoul(argv[3], NULL, 10) : 20;
    const fathom_line_settings_t line = {(uint32_t)baud, FATHOM_PARITY_NONE, 1};
    if (argc < 2 || argc > 4 || late_ms > 10000) {
        (void)fprintf(stderr, "usage: %s PORT [BAUD [LATE_MS]]\n", argv[0]);
        return 2;
    }
    if (fathom_posix_open(&port, argv[1], &line) != FATHOM_POSIX_OK) {
        (void)fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
        return 2;
    }
    const fathom_uart_t uart = fathom_posix_uart(&port);
    const fathom_clock_t clock = fathom_posix_clock();
    const fathom_conformance_t bench = {
        .uart = &uart,
        .clock = &clock,
        .line = line,
        .other = {baud == 57600 ? 19200 : 57600, FATHOM_PARITY_NONE, 1},
        .longest = 255,
        .late_us = (uint32_t)late_ms * 1000,
        .report = report,
    };
    const unsigned failed = fathom_conformance_run(&bench);
    fathom_posix_close(&port);
    return failed != 0;
}
