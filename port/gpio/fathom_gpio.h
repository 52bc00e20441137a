/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_GPIO_H
#define FATHOM_GPIO_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/edges.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Fathom's HAL on the pins of a Linux board: one line of a GPIO character device (/dev/gpiochip0), by version 2 of the
 * kernel's interface (linux/gpio.h, Linux 5.10). An output is a trigger or a select; an input a switch or a relay's
 * contact; with edges it measures pulses by the kernel's time stamps (A16 PWM), and wakes a program that sleeps.
 *
 *     static fathom_gpio_t trigger, echo;
 *     if (fathom_gpio_open_output(&trigger, "gpiochip0", 17, true) != FATHOM_GPIO_OK ||
 *         fathom_gpio_open_edges(&echo, "gpiochip0", 27, FATHOM_GPIO_BIAS_AS_IS) != FATHOM_GPIO_OK) ...
 *     const fathom_clock_t clock = fathom_posix_clock();
 *     const fathom_pin_t trigger_pin = fathom_gpio_pin(&trigger);
 *     const fathom_capture_t capture = fathom_gpio_capture(&echo);
 *     config.pulse.clock = &clock; (the kernel's stamps are of the same: CLOCK_MONOTONIC)
 *     config.pulse.trigger = fathom_output_pin(&trigger_pin);
 *     config.pulse.capture = &capture;
 *
 * Voltage: the pins of most boards take 3.3 V and no more. An A16's TX is 3 V when it is high, and its RX stands 5 V
 * (A16 1, remark); a relay's contact goes to ground or to 3.3 V, never to 5 V.
 *
 * How exact a width is depends on how soon the kernel's interrupt handler runs after each edge: on the processor's
 * load, its sleep states, and the driver of the chip (one behind I2C or USB stamps milliseconds late). Measure it on
 * the board: `fathom read --stats` prints the spread, and how much was rejected.
 *
 * Lost edges: the kernel's queue has place for FATHOM_GPIO_QUEUE, and drops the oldest. Their numbers tell. What they
 * belonged to is given up, and so is all up to the next falling edge: a pulse is one whose two edges came one after the
 * other.
 *
 * Memory: all is the caller's, may not be moved while it is open, and nothing is allocated. One thread at a time.
 * Nothing waits. It needs port/posix beside it.
 *
 * What has run: all of it, on system calls that tests stand in for, and on a PL061 in QEMU, by Debian's kernel for
 * arm64. It has never run on a board.
 */
enum { FATHOM_GPIO_QUEUE = 64 };

typedef enum {
    FATHOM_GPIO_OK = 0,
    FATHOM_GPIO_ERR_ARGUMENT = -1,   /* a NULL, no name, or a path that is too long */
    FATHOM_GPIO_ERR_NOT_FOUND = -2,  /* no such chip, or none behind this name */
    FATHOM_GPIO_ERR_PERMISSION = -3, /* the text names the group to join; or the line is not for programs */
    FATHOM_GPIO_ERR_IN_USE = -4,     /* another program, or a driver of the kernel, has this line */
    FATHOM_GPIO_ERR_NOT_A_CHIP = -5, /* a file, a device of another kind */
    FATHOM_GPIO_ERR_NO_LINE = -6,    /* the chip has fewer lines; the text says how many */
    /* This line cannot be an output, tell edges, or have that resistor; or the kernel is older than 5.10. */
    FATHOM_GPIO_ERR_UNSUPPORTED = -7,
    FATHOM_GPIO_ERR_LOST = -8,  /* the chip has gone, or the kernel does not read or set the line any more */
    FATHOM_GPIO_ERR_SYSTEM = -9 /* anything else that the system said; the text has its words */
} fathom_gpio_status_t;

/* The resistor of an input. AS_IS: what the board or the boot loader has set. Most drivers of chips that have no
 * resistors take any of them without a word: the kernel does not tell. */
typedef enum {
    FATHOM_GPIO_BIAS_AS_IS = 0,
    FATHOM_GPIO_BIAS_PULL_UP = 1,
    FATHOM_GPIO_BIAS_PULL_DOWN = 2,
    FATHOM_GPIO_BIAS_DISABLED = 3
} fathom_gpio_bias_t;

/* All members are the port's own, but the counters. One of zeros is closed. */
typedef struct {
    int fd; /* of the line */
    bool is_open;
    bool is_lost; /* for good, until it is opened again */
    bool is_output;
    bool has_edges;
    bool is_high;       /* an input, when it was looked at last */
    fathom_pin_t level; /* for edges */
    fathom_edges_t edges;
    uint32_t line;        /* its number on the chip */
    uint32_t line_seqno;  /* of the last event; 0: none yet */
    uint32_t events;      /* edges that were read; wraps */
    uint32_t lost_events; /* that the kernel's queue had no room for; wraps */
    fathom_gpio_status_t error;
    char path[128];
    char text[320];
} fathom_gpio_t;

/*
 * chip: "gpiochip0", or a path of up to 127 characters; used during the call only. line: its number on the chip, from 0
 * ("GPIO17" of a Raspberry Pi is line 17 of gpiochip0, or of gpiochip4 on early kernels of a Pi 5). high: the level
 * that an output begins with. The line is taken for this program alone, and given back by fathom_gpio_close; what an
 * output does then is the driver's: mostly it keeps its level.
 *
 * gpio: any content; one that is open must be closed first, or its line stays taken until the program ends.
 *
 * Returns FATHOM_GPIO_OK, or what went wrong: then nothing is left open, and gpio has the text. LOST is no result of
 * these, but of fathom_gpio_error later.
 */
fathom_gpio_status_t fathom_gpio_open_output(fathom_gpio_t *gpio, const char *chip, uint32_t line, bool high);
fathom_gpio_status_t fathom_gpio_open_input(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias);
/* An input that tells both edges with their times: for fathom_gpio_capture, and to be woken. Not all chips can. */
fathom_gpio_status_t fathom_gpio_open_edges(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias);
/* Gives it back. One that is closed, failed to open, or is all zeros: nothing happens. */
void fathom_gpio_close(fathom_gpio_t *gpio);

/*
 * The HAL of an open one, which stays where it is. `set` of an output, `get` of an input; with edges `get` takes the
 * events that have come too, so that the descriptor is not ready any more. A hal.h pin cannot fail: where the chip has
 * gone, `set` does nothing, `get` says what was last, and fathom_gpio_error tells.
 */
fathom_pin_t fathom_gpio_pin(fathom_gpio_t *gpio);

/* Of one with edges. take < 0: the chip has gone. arm forgets what has come, also what is still in the queue. What
 * comes between two cycles stays there, and the descriptor ready: wait edge-triggered (EPOLLET), as fathom_loop.h
 * does, or call `get`. */
fathom_capture_t fathom_gpio_capture(fathom_gpio_t *gpio);

/* For poll(2) and epoll(7): can be read when edges have come. -1: closed. */
int fathom_gpio_fd(const fathom_gpio_t *gpio);

/* Of the last call that failed, and in words: one line, "" when nothing has. */
fathom_gpio_status_t fathom_gpio_error(const fathom_gpio_t *gpio);
const char *fathom_gpio_error_text(const fathom_gpio_t *gpio);

#ifdef __cplusplus
}
#endif

#endif
