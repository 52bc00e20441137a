/* SPDX-License-Identifier: MIT */
#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_gpio.h"
#include "fathom_loop.h"
#include "fathom_posix.h"

/* The level of `in` that means that something is near. */
typedef enum {
    PINS_NEAR_USUAL = 0, /* with factory settings */
    PINS_NEAR_LOW = 1,
    PINS_NEAR_HIGH = 2
} pins_near_t;

/* Lines of a GPIO chip by their numbers; -1: none. */
typedef struct {
    int32_t trigger; /* to the sensor's RX; an output */
    uint32_t chip;   /* of a serial port: 1 + the number of the chip that has the trigger; 0: no trigger */
    int32_t echo;    /* from the sensor's TX: pulses */
    int32_t in;      /* a switch, or the contact of a relay */
    uint8_t bias;    /* of the inputs; fathom_gpio_bias_t */
    uint8_t near;    /* pins_near_t */
    bool idles_low;  /* a high pulse triggers: the line is opened low */
} pin_options_t;

/* The lines of a GPIO chip that were named, open. A reader uses what the host has set. */
enum { PINS_LINES = 3 };
typedef struct {
    fathom_pin_t trigger;     /* at its idle level */
    fathom_capture_t capture; /* of echo */
    fathom_pin_t in;
    bool wakes; /* a change of `in` ends a sleep */
    pin_options_t wanted;
    volatile uint8_t *missed;        /* edges that must have been missed (edges.h); NULL: not counted */
    uint32_t *lost_events;           /* for which the kernel's queue had no place; NULL: not counted */
    int fd;                          /* that wakes the reader; -1: none */
    fathom_gpio_t lines[PINS_LINES]; /* of a chip of this machine: trigger, echo, in */
} pins_t;

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
    /* Opens lines of a chip. False: one of `lines` has the error, also after it was closed. Do not move *pins. */
    bool (*open_pins)(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins);
    void (*close_pins)(void *ctx, pins_t *pins);
    uint64_t (*now_us)(void *ctx); /* does not wrap */
    uint64_t (*utc_us)(void *ctx); /* since 1970 */
    /* Call it before the first wait. From then on a signal does not kill the command, but has_ended becomes true. Returns
     * false after printing why not. */
    bool (*begin)(void *ctx);
    bool (*has_ended)(void *ctx);
    /* The reader of the standard output went away, as far as a wait has seen. */
    bool (*is_output_gone)(void *ctx);
    /* Sleeps until one of `events` (poll(2)) happens on fd, max_us microseconds passed (FATHOM_NO_DEADLINE: no limit), or
     * a signal came. watch_output: also until the reader of the standard output goes away. */
    void (*wait)(void *ctx, int fd, short events, uint32_t max_us, bool watch_output);
    /* For a loop. `loop` has its clock and sleep if neither the clock nor the ports are the system's, else zeros. attend
     * adds sources to the loop: what else ends its sleep, as that of `wait` with watch_output, and adapter_look(). */
    fathom_loop_config_t loop;
    void (*attend)(void *ctx, fathom_loop_t *loop);
    void *ctx;
} host_t;

extern const host_t host_posix;

/* open_pins and close_pins of host_posix. */
bool pins_open(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins);
void pins_close(void *ctx, pins_t *pins);

/* One signal of a command (SIGUSR1, SIGWINCH, SIGHUP) does not end it from now on: it only ends a sleep. */
void host_watch_signal(int number);

/* Returns true if this signal came since the last call. */
bool host_had_signal(void);

#endif
