/* SPDX-License-Identifier: MIT */
#ifndef CHANNEL_H
#define CHANNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"
#include "fathom_loop.h"
#include "ports/host.h"
#include "ports/listener.h"
#include "ports/tcp.h"

/* A serial port, or a connection to a Modbus TCP server, with a line and a Modbus client on it: what every command
 * that talks to sensors needs. */
typedef struct {
    const host_t *host;
    fathom_posix_uart_t port;
    tcp_t *tcp;   /* then `port` stands in for it (tcp.h); NULL: a serial port, or ... */
    bool is_chip; /* ... pins, for which `port` stands in too: then there are no line and no client */
    pins_t pins;
    fathom_uart_t uart;
    fathom_clock_t clock;
    listener_t listener; /* between uart and port */
    fathom_line_parts_t parts;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_t line;
    fathom_modbus_t modbus;
    /* To be set before it is opened. */
    uint8_t echo; /* fathom_line_parts_t.echo */
    bool rs485;   /* the kernel's driver is to drive the transceiver: RTS is on while bytes leave */
    fathom_loop_source_t
        *source; /* in a loop: it is read only where something has come; NULL: it is not in one */
    uint8_t frame[255];
} channel_t;

/*
 * The silence that ends a frame. A USB adapter holds bytes back for up to 16 ms, and the system may be late too: 25
 * ms, which is less than the pause between two frames of a sensor that sends by itself. Where a sensor is asked
 * nothing hangs on it but how soon a damaged response is given up; there the far end may also be a program,
 * which a busy system interrupts in mid-frame.
 */
enum { CHANNEL_STREAM_GAP_US = 25000, CHANNEL_RESPONSE_GAP_US = 60000 };

/* What a device sends unasked is known before the first request, which leaves room for it (line.h), if so long was
 * listened. */
enum { CHANNEL_UNASKED_US = 66000 };

/* path: of a serial port, or tcp:HOST[:PORT], which is Modbus only. False: channel->port has the error. The channel may
 * not be moved. One that was closed may be opened again. */
bool channel_open(channel_t *channel, const host_t *host, const char *path,
                  const fathom_line_settings_t *settings);
/* The same for lines of a GPIO chip. */
bool channel_open_pins(channel_t *channel, const host_t *host, const char *chip, const pin_options_t *wanted);
void channel_close(channel_t *channel);

/* It is open, and these are the slowest settings that are used on it from now on. */
void channel_suit(channel_t *channel, const fathom_line_settings_t *settings);

/* After each poll: notices that the pins are lost, which only some drivers tell. */
void channel_look(channel_t *channel);

/* The same with a connection, without waiting, as tcp.h's tcp_begin and tcp_go_on. */
bool channel_begin_tcp(channel_t *channel, const host_t *host, const char *path, unsigned turn);
fathom_status_t channel_go_on(channel_t *channel);

/* Asks nothing for so long; what is heard is added to what the last call has heard. A signal ends it. */
void channel_listen(channel_t *channel, uint32_t for_us);

/* Can it hold its TX low? A pseudo terminal has no wire, and a byte stands for each break. */
bool channel_has_break(const channel_t *channel);

#endif
