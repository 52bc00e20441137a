/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_GPIO_CHIP_H
#define FATHOM_TESTS_GPIO_CHIP_H

#include "suite.h"

#include <linux/gpio.h>

#include "fathom_gpio.h"

/*
 * A GPIO chip as the kernel has it, /dev/gpiochip0, whose edges come at times that the test chooses. Link with
 * -Wl,--wrap= each of open ioctl read close. All other paths and descriptors are left alone.
 *
 * Events as gpiolib makes them (linereq_put_event()): each has the next number of its line, from 1; a full queue drops
 * the oldest.
 */
enum { CHIP_LINES = 54, CHIP_OPEN_LINES = 4 };

typedef struct {
    int fd; /* 0: closed */
    struct gpio_v2_line_request request;
    bool level;
    unsigned sets;          /* of an output */
    uint32_t last_seqno;    /* of an event that was made */
    unsigned first, events; /* in the queue */
    struct gpio_v2_line_event queue[FATHOM_GPIO_QUEUE];
} chip_line_t;

/* 0: what a chip does. An error is an errno. */
typedef struct {
    int open_error, chip_error, info_error, request_error, level_error, set_error, read_error;
    int interrupts;    /* so many of the wrapped calls that it gets give EINTR first */
    int short_read;    /* a read gives so many bytes */
    bool is_rigid;     /* a line's descriptor takes no F_SETFL */
    bool is_endless;   /* each read of an event finds another rise, at the same time */
    int open_flags;    /* as it was opened */
    int open_chips;    /* now */
    unsigned opened;   /* lines so far */
    unsigned refused;  /* requests */
    char consumer[32]; /* who has the lines */
    chip_line_t
        lines[CHIP_OPEN_LINES]; /* in the order in which they were opened; a closed one's place is free */
} gpio_chip_t;

extern gpio_chip_t chip;

/* Nothing special any more. */
void chip_reset(void);

/* An edge of an open line. */
void chip_edge(chip_line_t *line, bool high, uint64_t time_us);

/* An event that the queue has lost: the level and the number are those after it. */
void chip_lose(chip_line_t *line, bool high);

/* Fails the test unless the text of the last failure contains `text`. */
static inline void gpio_says(const fathom_gpio_t *gpio, const char *text)
{
    if (strstr(fathom_gpio_error_text(gpio), text) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", fathom_gpio_error_text(gpio), text);
}

#endif
