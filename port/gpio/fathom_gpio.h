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

/**
 * @file
 * @brief The HAL (hal.h) on the pins of a Linux board: one line of a GPIO character device, such as /dev/gpiochip0.
 *
 * The port uses version 2 of the interface of the kernel (linux/gpio.h, Linux 5.10). An output is a trigger or a
 * select. An input is a switch or the contact of a relay. An input with edges measures pulses by the time stamps of the
 * kernel (A16 PWM), and wakes a program that sleeps. No function waits or allocates memory. The port needs port/posix.
 *
 * @code
 * static fathom_gpio_t trigger, echo;
 * static fathom_clock_t clock;
 * static fathom_pin_t trigger_pin;
 * static fathom_capture_t capture;
 *
 * if (fathom_gpio_open_output(&trigger, "gpiochip0", 17, true) != FATHOM_GPIO_OK) return 1;
 * if (fathom_gpio_open_edges(&echo, "gpiochip0", 27, FATHOM_GPIO_BIAS_AS_IS) != FATHOM_GPIO_OK) return 1;
 * clock = fathom_posix_clock();                     // the stamps of the kernel are of the same clock, CLOCK_MONOTONIC
 * trigger_pin = fathom_gpio_pin(&trigger);
 * capture = fathom_gpio_capture(&echo);
 * const fathom_output_t output = fathom_output_pin(&trigger_pin);
 * if (fathom_a16_pwm_init(&a16, &capture, &clock, &output, NULL) != FATHOM_OK) return 1;
 * @endcode
 *
 * 1. **Voltage.** The pins of most boards stand 3.3 V and no more. TX of an A16 is 3 V when it is high, and its RX
 *    stands 5 V (A16 1, remark). Connect the contact of a relay to ground or to 3.3 V, never to 5 V.
 *
 * 2. **Accuracy.** A width is as exact as the interrupt handler of the kernel is prompt after each edge. That depends
 *    on the load and the sleep states of the processor and on the driver of the chip; a chip behind I2C or USB gets
 *    time stamps that are milliseconds late. Measure it on the board: `fathom read --stats` prints the spread, and how
 *    much was rejected.
 *
 * 3. **Lost edges.** The queue of the kernel has space for FATHOM_GPIO_QUEUE edges and drops the oldest. The port
 *    detects this by their numbers. It then discards the pulse to which they belonged and all edges up to the next
 *    falling edge: a pulse consists of two edges that followed each other.
 *
 * 4. **Memory and threads.** A pin is in the caller's memory and must not be moved while it is open. Call the functions
 *    of one pin from one thread at a time.
 *
 * 5. **What has run.** Everything has run on system calls that tests replace, and on a PL061 in QEMU with the arm64
 *    kernel of Debian. It has never run on a board.
 */

/** @brief Constants of this port. */
enum {
    FATHOM_GPIO_QUEUE = 64 /**< Number of edges for which the queue of the kernel has space. */
};

/** @brief The result of a call on a pin. Errors are negative. fathom_gpio_error_text() returns the error in words. */
typedef enum {
    FATHOM_GPIO_OK = 0,             /**< Success. */
    FATHOM_GPIO_ERR_ARGUMENT = -1,  /**< A pointer is NULL, the name is empty, or the path is too long. */
    FATHOM_GPIO_ERR_NOT_FOUND = -2, /**< The chip does not exist, or there is none behind this name. */
    FATHOM_GPIO_ERR_PERMISSION =
        -3, /**< The user may not open the chip (the text names the group to join), or programs
                                         may not use this line. */
    FATHOM_GPIO_ERR_IN_USE = -4,     /**< Another program or a driver of the kernel uses this line. */
    FATHOM_GPIO_ERR_NOT_A_CHIP = -5, /**< The path is a file or a device of another kind. */
    FATHOM_GPIO_ERR_NO_LINE = -6,    /**< The chip has fewer lines. The text has their number. */
    FATHOM_GPIO_ERR_UNSUPPORTED =
        -7,                    /**< This line cannot be an output, cannot report edges, or does not have that
                                         resistor; or the kernel is older than 5.10. */
    FATHOM_GPIO_ERR_LOST = -8, /**< The chip was unplugged, or the kernel no longer reads or sets the line. */
    FATHOM_GPIO_ERR_SYSTEM = -9 /**< Any other error of the system. The text has the words of the system. */
} fathom_gpio_status_t;

/**
 * @brief The resistor of an input.
 *
 * Most drivers of chips without resistors accept any of these silently, and the kernel does not report it.
 */
typedef enum {
    FATHOM_GPIO_BIAS_AS_IS = 0,     /**< What the board or the boot loader has set. */
    FATHOM_GPIO_BIAS_PULL_UP = 1,   /**< Pull-up. */
    FATHOM_GPIO_BIAS_PULL_DOWN = 2, /**< Pull-down. */
    FATHOM_GPIO_BIAS_DISABLED = 3   /**< No resistor. */
} fathom_gpio_bias_t;

/** @brief A pin, in the caller's memory. A pin of zeros is closed. A program may read `events` and `lost_events`. */
typedef struct {
    /** @brief Private: the descriptor of the line. */
    int fd;
    /** @brief Private: true while the pin is open. */
    bool is_open;
    /** @brief Private: true if the pin is lost. Stays true until the pin is opened again. */
    bool is_lost;
    /** @brief Private: true for an output. */
    bool is_output;
    /** @brief Private: true for an input with edges. */
    bool has_edges;
    /** @brief Private: the newest level of an input. */
    bool is_high;
    /** @brief Private: the level, for `edges`. */
    fathom_pin_t level;
    /** @brief Private: the edges. */
    fathom_edges_t edges;
    /** @brief Private: the number of the line on the chip. */
    uint32_t line;
    /** @brief Private: the number of the newest event. 0: none yet. */
    uint32_t line_seqno;
    /** @brief Number of edges that were read. Wraps. */
    uint32_t events;
    /** @brief Number of edges for which the queue of the kernel had no space. Wraps. */
    uint32_t lost_events;

    /* private */
    fathom_gpio_status_t error;
    char path[128];
    char text[320];
} fathom_gpio_t;

/**
 * @brief Opens a line of a chip as an output.
 *
 * The kernel reserves the line for this program until fathom_gpio_close(). The level of an output after that depends on
 * the driver; most drivers keep it. If a call fails, nothing is left open, and fathom_gpio_error_text() has the reason.
 *
 * @param gpio  The pin, with any content. Close an open pin first; otherwise its line stays reserved until the program
 *              ends.
 * @param chip  Name of the chip, such as "gpiochip0", or a path. A path has at most 127 characters. Used only during
 *              the call.
 * @param line  Number of the line on the chip, from 0. "GPIO17" of a Raspberry Pi is line 17 of gpiochip0, or of
 *              gpiochip4 on early kernels of a Pi 5.
 * @param high  The first level of the output.
 * @return FATHOM_GPIO_OK, or any error of fathom_gpio_status_t except FATHOM_GPIO_ERR_LOST.
 */
fathom_gpio_status_t fathom_gpio_open_output(fathom_gpio_t *gpio, const char *chip, uint32_t line, bool high);

/**
 * @brief Opens a line of a chip as an input without edges.
 *
 * @param gpio  As for fathom_gpio_open_output().
 * @param chip  As for fathom_gpio_open_output().
 * @param line  As for fathom_gpio_open_output().
 * @param bias  The resistor.
 * @return As for fathom_gpio_open_output().
 */
fathom_gpio_status_t fathom_gpio_open_input(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias);

/**
 * @brief Opens a line of a chip as an input that reports both edges with their times.
 *
 * This is for fathom_gpio_capture(), and for a program that an edge wakes. Not every chip can report edges.
 *
 * @param gpio  As for fathom_gpio_open_output().
 * @param chip  As for fathom_gpio_open_output().
 * @param line  As for fathom_gpio_open_output().
 * @param bias  The resistor.
 * @return As for fathom_gpio_open_output().
 */
fathom_gpio_status_t fathom_gpio_open_edges(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias);

/** @brief Closes a pin and releases its line. If the pin is closed, failed to open or is all zeros, nothing happens. */
void fathom_gpio_close(fathom_gpio_t *gpio);

/**
 * @brief Returns the pin (hal.h) of an open pin: `set` of an output, `get` of an input.
 *
 * For an input with edges `get` also reads the events that have arrived, so that the descriptor is no longer ready. A
 * pin of hal.h cannot fail. If the chip is lost, `set` does nothing, `get` returns the last known level, and
 * fathom_gpio_error() returns FATHOM_GPIO_ERR_LOST.
 *
 * @param gpio  The pin. It must stay valid, and must not be moved, as long as the result is used.
 * @return The pin for the HAL, by value.
 */
fathom_pin_t fathom_gpio_pin(fathom_gpio_t *gpio);

/**
 * @brief Returns the capture (hal.h) of an open pin with edges.
 *
 * - **take** returns a negative number if the chip is lost.
 * - **arm** discards the edges that have arrived, also those in the queue of the kernel.
 *
 * Edges that arrive between two cycles stay in the queue, and the descriptor stays ready. Wait edge-triggered
 * (EPOLLET), as fathom_loop.h does, or call `get` of fathom_gpio_pin().
 *
 * @param gpio  The pin. It must stay valid, and must not be moved, as long as the result is used.
 * @return The capture, by value.
 */
fathom_capture_t fathom_gpio_capture(fathom_gpio_t *gpio);

/** @brief Returns the descriptor for poll(2) and epoll(7), which is readable when edges have arrived. Returns -1 if the
 * pin is closed. */
int fathom_gpio_fd(const fathom_gpio_t *gpio);

/** @brief Returns the error of the newest call that failed on this pin, or FATHOM_GPIO_OK if none failed since it was
 * opened. */
fathom_gpio_status_t fathom_gpio_error(const fathom_gpio_t *gpio);

/** @brief Returns the same error in words, in one line; "" if nothing has failed. The text stands in the pin. */
const char *fathom_gpio_error_text(const fathom_gpio_t *gpio);

#ifdef __cplusplus
}
#endif

#endif
