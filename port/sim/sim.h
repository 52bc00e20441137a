/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_H
#define FATHOM_SIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "device.h"
#include "fathom/hal.h"
#include "wire.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A line with simulated sensors on it, seen from the host's end. It does no I/O, has no clock and allocates
 * nothing: its owner passes the time to every call. uart.h makes a HAL of it, pty.h a serial port of Linux.
 *
 * Time is true to the bit: what the host sends takes its time on the wire, a device knows that a request has
 * ended after t3.5 of silence, works, and its response arrives byte by byte. Between two calls nothing
 * happens; a call first runs through everything that was due until its `now_us`, in the order of time. So a
 * slow caller loses no precision, only bytes: the host's buffer holds FATHOM_SIM_QUEUE of them, and what
 * finds it full is lost and counted, as in a UART.
 *
 * All times are the caller's clock: us, 32 bits, may wrap. Call something at least every 30 minutes; a time
 * that is earlier than the last one changes nothing.
 *
 * Limits: a device hears a byte whole or not at all; a wrong rate is a garbled byte, never more or fewer.
 * Not thread safe.
 */
typedef struct {
    uint32_t from_host;  /* bytes that the host sent */
    uint32_t to_host;    /* bytes that reached it */
    uint32_t overruns;   /* bytes lost because the host did not read, or marked so by a fault */
    uint32_t collisions; /* bytes that began while another device sent (two-wire lines) */
} fathom_sim_line_counters_t;

typedef struct {
    uint32_t end_us;
    uint8_t byte;
    uint8_t flags; /* FATHOM_RX_... */
} fathom_sim_arrival_t;

typedef struct fathom_sim_line {
    /* the caller's to change after init */
    /* RS-232 and logic level: a wire each way. false: RS-485, all hear all. Set it before the first device is
     * attached */
    bool full_duplex;
    bool echo; /* the host hears itself (RS-485 without receiver disable); at any time */
    fathom_sim_line_counters_t counters;

    /* the line's */
    struct fathom_sim_line *next; /* on a clock (uart.h) */
    fathom_sim_device_t *devices;
    fathom_line_settings_t settings;
    uint32_t now_us;
    bool in_break;       /* of the host */
    uint32_t arrived_us; /* end of the last byte that reached the host */
    bool quiet;          /* t3.5 has passed since */
    bool lost;           /* bytes were lost before the next one */
    uint16_t first;      /* of `arrivals` */
    uint16_t waiting;
    fathom_sim_sender_t host;
    fathom_sim_arrival_t arrivals[FATHOM_SIM_QUEUE];
} fathom_sim_line_t;

/* An empty line; `settings` are the host's. */
void fathom_sim_line_init(fathom_sim_line_t *line, const fathom_line_settings_t *settings, uint32_t now_us);

/* Hangs a device on the line and powers it on. The device is the caller's, outlives the line or is taken off
 * it, and hangs on one line only. Its own settings may differ from the host's: then they do not understand
 * each other. Detaching cuts it off in mid-byte; one that is not there is no error. */
void fathom_sim_attach(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_detach(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t now_us);

/* Takes the power from a device that hangs on the line for `off_us` (up to 30 minutes; 0: it comes back at
 * once), in mid-byte if need be. What is kept by its datasheet is there afterwards, the rest is as at the
 * beginning. fault.h has the same as an accident, at the end of a frame. */
void fathom_sim_power_cycle(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t off_us,
                            uint32_t now_us);

/* Changes the host's settings, to a rate that wire.h allows; bytes that are on their way keep the old ones. */
void fathom_sim_set_line(fathom_sim_line_t *line, const fathom_line_settings_t *settings, uint32_t now_us);

/* Host to devices: the bytes leave from now on (or behind those that still do) without a gap. Returns how
 * many were taken: less than `count` when more than FATHOM_SIM_QUEUE would wait. */
size_t fathom_sim_receive(fathom_sim_line_t *line, const uint8_t *bytes, size_t count, uint32_t now_us);

/* Bytes of the host that have not left yet: FATHOM_SIM_QUEUE less this many will be taken. */
size_t fathom_sim_queued(fathom_sim_line_t *line, uint32_t now_us);

/*
 * The host holds its TX low (true), or lets it go: an edge at the RX pin of every device, and one damaged byte to those
 * that listen. While it lasts no bytes of the host are taken. Of a two-wire line it disturbs what the host sends to
 * the devices, and nothing else.
 */
void fathom_sim_break(fathom_sim_line_t *line, bool on, uint32_t now_us);

/* Has the last stop bit left that the host sent? */
bool fathom_sim_sent(fathom_sim_line_t *line, uint32_t now_us);

/* How long until that, in microseconds; 0: it has. */
uint32_t fathom_sim_leaves_in_us(fathom_sim_line_t *line, uint32_t now_us);

/* Devices to host: up to `capacity` bytes whose last bit has arrived by now. */
size_t fathom_sim_transmit(fathom_sim_line_t *line, uint32_t now_us, uint8_t *bytes, size_t capacity);

/*
 * The same with what a good UART knows of them, by the rules of fathom_uart_t.read: `knows` is the set of
 * FATHOM_RX_... to report; what is not in it is not reported and does not divide the bytes. A byte that collided
 * with another or came at another rate is garbled and marked FATHOM_RX_FRAMING; silence is t3.5 without a byte.
 */
size_t fathom_sim_transmit_timed(fathom_sim_line_t *line, uint32_t now_us, uint8_t *bytes, size_t capacity,
                                 uint8_t knows, fathom_rx_t *rx);

/* Time until something can happen without the host's doing (at times earlier than anything is seen);
 * FATHOM_NO_DEADLINE: never. Bytes that wait to be read do not count. */
uint32_t fathom_sim_due_us(fathom_sim_line_t *line, uint32_t now_us);

/* Lets the time come; every function above does that too. */
void fathom_sim_run(fathom_sim_line_t *line, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
