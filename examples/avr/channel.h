/* SPDX-License-Identifier: MIT */
#ifndef CHANNEL_H
#define CHANNEL_H

#include <stdbool.h>

#include "fathom/hal.h"

/*
 * One UART that listens to several sensors in turn, through a multiplexer. Each sensor gets a channel, which is a
 * fathom_uart_t for a line of its own: it passes on what is received while it is selected, and is a silent wire else.
 *
 * What comes first after a change of the select may be the middle of a frame, or half a byte of either sensor. So it
 * is marked as bytes that follow upon lost ones: the stream then believes none of them until it has seen a silence.
 */
typedef struct {
    const fathom_uart_t *uart; /* shared by the channels */
    bool selected;
    bool fresh; /* nothing has been read since it was */
} channel_t;

/* A UART that reads; who listens only needs nothing else of it. */
fathom_uart_t channel_uart(channel_t *channel);

/* Turns from one channel to the other: select.set(to_is_high). What was received and not read is dropped. `from` and
 * `to` may be the same at the beginning. */
void channel_turn(channel_t *from, channel_t *to, const fathom_pin_t *select, bool to_is_high);

#endif
