/* SPDX-License-Identifier: MIT */
#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_loop.h"
#include "fathom_posix.h"
#include "ports/pins.h"

/*
 * All that a command needs of the machine besides stdout and stderr: serial ports, GPIO lines, the time, sleep, and the
 * signals that end it. host_posix is the tool's. A test has its own host, with simulated sensors behind a UART in memory
 * and a clock that moves while a command sleeps, and runs command after command; so no command keeps a host's state.
 */
typedef struct {
    /* Opens the serial port `path` and sets *uart. False: *port has the error and its text. */
    bool (*open)(void *ctx, const char *path, const fathom_line_settings_t *settings,
                 fathom_posix_uart_t *port, fathom_uart_t *uart);
    void (*close)(void *ctx, fathom_posix_uart_t *port);
    /* As pins_open() and pins_close(). */
    bool (*open_pins)(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins);
    void (*close_pins)(void *ctx, pins_t *pins);
    uint64_t (*now_us)(void *ctx); /* does not wrap */
    uint64_t (*utc_us)(void *ctx); /* since 1970 */
    /* Call it before the first wait. From then on a signal does not kill the command, but has_ended becomes true. Returns
     * false after printing why not. */
    bool (*begin)(void *ctx);
    bool (*has_ended)(void *ctx);
    bool (*is_output_gone)(
        void *ctx); /* the reader of the standard output went away, as far as a wait has seen */
    /* Sleeps until one of `events` (poll(2)) happens on fd, max_us microseconds passed (FATHOM_NO_DEADLINE: no limit), or
     * a signal came. watch_output: also until the reader of the standard output goes away. */
    void (*wait)(void *ctx, int fd, short events, uint32_t max_us, bool watch_output);
    /* For a loop. `loop` has its clock and sleep if neither the clock nor the ports are the system's, else zeros. attend
     * adds sources to the loop: what else ends its sleep, as that of `wait` with watch_output, and adapter_watch(). */
    fathom_loop_config_t loop;
    void (*attend)(void *ctx, fathom_loop_t *loop);
    void *ctx;
} host_t;

extern const host_t host_posix;

/* One signal of a command (SIGUSR1, SIGWINCH, SIGHUP) does not end it from now on: it only ends a sleep. */
void host_watch_signal(int number);

/* Did this signal come since the last call? */
bool host_had_signal(void);

#endif
