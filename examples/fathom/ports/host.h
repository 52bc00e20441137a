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
 * What a command needs of the machine that it runs on, besides stdout and stderr: serial ports, the time, sleep, and
 * the wish to end it. host_posix is the tool's. A test has its own, with simulated sensors behind an UART in memory and
 * a clock that moves while a command sleeps, and runs command after command: none of them keeps anything.
 */
typedef struct {
    /* Opens the serial port `path` and sets *uart. False: *port has the error and its text. Where there is no tty,
     * *port stands in for what there is, as tcp.h has it. */
    bool (*open)(void *ctx, const char *path, const fathom_line_settings_t *settings,
                 fathom_posix_uart_t *port, fathom_uart_t *uart);
    void (*close)(void *ctx, fathom_posix_uart_t *port);
    /* Opens lines of a GPIO chip, as pins.h has it. */
    bool (*open_pins)(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins,
                      fathom_posix_uart_t *port);
    void (*close_pins)(void *ctx, pins_t *pins, fathom_posix_uart_t *port);
    uint64_t (*now_us)(void *ctx); /* does not wrap */
    uint64_t (*utc_us)(void *ctx); /* since 1970 */
    /* A command begins to wait: from now on has_ended tells what the user wishes. False after saying why. */
    bool (*begin)(void *ctx);
    bool (*has_ended)(void *ctx);
    bool (*is_output_gone)(void *ctx); /* the reader of the standard output has gone */
    /* For a command with one port at most. Sleeps until *port (NULL: none) has bytes or something to do, max_us microseconds (FATHOM_NO_DEADLINE: no limit)
     * have passed, or the command is to end. watch_output: also until the reader of the standard output goes away. */
    void (*wait)(void *ctx, const fathom_posix_uart_t *port, uint32_t max_us, bool watch_output);
    /* For a loop: its now_us and sleep, where neither the clock nor the ports are the system's; else zeros. And what
     * ends its sleep besides the ports, as that of wait: is added to it. */
    fathom_loop_config_t loop;
    void (*attend)(void *ctx, fathom_loop_t *loop);
    void *ctx;
} host_t;

extern const host_t host_posix;

#endif
