/* SPDX-License-Identifier: MIT */
#ifndef PORT_H
#define PORT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"
#include "fathom_loop.h"
#include "ports/adapter.h"
#include "ports/host.h"
#include "ports/line_text.h"
#include "ports/listener.h"
#include "ports/port_settings.h"

/*
 * A port: a tty, a connection to a Modbus TCP server, or lines of a GPIO chip. Which of them it is, only ports/ knows;
 * the others ask what the port can do. A tty and a connection have a line and a Modbus client.
 */

/* Why a port is not open. */
typedef enum {
    PORT_OK,
    PORT_ABSENT, /* nothing is there, but something may come */
    PORT_LOST,   /* the port was open */
    PORT_FAILED
} port_error_t;

typedef struct port_driver port_driver_t;

/* All zeros before the first port_open(). It may be opened again after port_close(); do not move it. */
typedef struct port {
    const host_t *host;
    port_settings_t settings;
    fathom_clock_t clock;
    listener_t listener; /* between the line and the port */
    fathom_line_parts_t parts;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_t line;
    fathom_modbus_t modbus;
    pins_t pins;         /* of a GPIO chip */
    bool watches_output; /* port_wait() also ends when the reader of the standard output goes away */
    /* private */
    const port_driver_t *driver;
    fathom_posix_uart_t serial;
    adapter_t adapter;         /* behind the tty; it is kept while the port is closed */
    struct tcp *tcp;           /* a connection */
    uint8_t gateway_exception; /* 10 or 11, since the last request; 0: none */
    fathom_uart_t uart;
    port_error_t error;
    bool is_connecting;
    uint32_t failures; /* in a row, other than PORT_ABSENT, to open it */
    uint8_t frame[255];
    char path[320];
    char text[384];
} port_t;

/*
 * The silence that ends a frame. A USB adapter holds bytes back for up to 16 ms, and the system may be late too. The
 * gap of a stream is less than the pause between two frames of a sensor that sends by itself. If a sensor is asked, the
 * gap decides only how soon a damaged response is given up, and the far end may be a program that a busy system
 * interrupts within a frame.
 */
enum { PORT_STREAM_GAP_US = 25000, PORT_RESPONSE_GAP_US = 60000 };

/* So long a command listens before its first request, so that the line knows what a sensor sends by itself (line.h). */
enum { PORT_LISTEN_US = 66000 };

/*
 * Opens a port. A tty whose adapter was known is found again under any name (adapter.h).
 *
 * FATHOM_OK: it is open. FATHOM_PENDING: it connects; call port_poll() when port_fd() is ready for port_events(), and
 * at least twice a second. FATHOM_ERR_PORT: port_error() has the reason.
 */
fathom_status_t port_open(port_t *port, const host_t *host, const port_settings_t *settings);
void port_close(port_t *port);

/* The same, and waits for a connection. A signal ends the wait. False: port_error() has the reason. */
bool port_open_now(port_t *port, const host_t *host, const port_settings_t *settings);

/* Call it after each poll of a sensor. FATHOM_OK: the port is open. FATHOM_PENDING: it connects. FATHOM_ERR_PORT: it is
 * lost, or could not connect. */
fathom_status_t port_poll(port_t *port);
int port_fd(const port_t *port);
short port_events(const port_t *port);

/* Sets the slowest settings that are used on the open port from now on. */
void port_set_slowest(port_t *port, const fathom_line_settings_t *settings);

/* ---- waiting, for a command with one port ---- */

/* Sleeps until the port is ready, at most max_us. FATHOM_OK; FATHOM_ERR_PORT: the port is lost; FATHOM_ERR_CANCELLED:
 * the command has to end. */
fathom_status_t port_wait(port_t *port, uint32_t max_us);

/* Waits for the end of a transaction on the port's line, and returns its status. A signal cancels the transaction. */
fathom_status_t port_finish(port_t *port, fathom_transaction_t *transaction);

/* Listens without a request. What is received is added to port->listener. A signal ends it. Returns as port_wait(). */
fathom_status_t port_listen(port_t *port, uint32_t for_us);

/* ---- properties ---- */

bool port_is_lost(const port_t *port);
bool port_is_absent(const port_t *port); /* it could not be opened, but something may come */
const char *port_error(
    const port_t *port);                   /* why it is not open, as a line of text that names the port; "" */
const char *port_name(const port_t *port); /* its present path */

/* True once, when the port is there but could not be opened three times in a row. When an adapter was just plugged in,
 * the system needs a moment, and other programs (modem managers) try it first. */
bool port_is_overdue(const port_t *port);

/* What a user has to know about finding the adapter again; NULL: nothing. For a port that is lost. */
const char *port_advice(port_t *port);

bool port_has_line(
    const port_t *port); /* a serial line with settings, on which others may send unsolicited */
bool port_has_gateway(const port_t *port); /* the line is the gateway's; requests are Modbus */
bool port_has_pins(const port_t *port);    /* levels and pulses, and no line */
bool port_has_wire(const port_t *port);    /* a byte takes its time; a pseudo terminal has no wire */
bool port_can_break(const port_t *port);   /* it can hold its TX low */

/* The exception 10 or 11 that a gateway sent since the last request; 0: none. */
uint8_t port_gateway_exception(const port_t *port);

/* The counters of the driver. False: it has none. */
bool port_line_errors(port_t *port, fathom_posix_line_errors_t *errors);

/* So long a USB adapter keeps received bytes back, in ms; 0: unknown. */
unsigned port_latency_ms(const port_t *port);

/* "9600 8N1", or "Modbus TCP" if the line is a gateway's. */
const char *port_line_text(const port_t *port, const fathom_line_settings_t *line, char text[LINE_TEXT]);

/* ---- for the drivers in ports/ ---- */

struct port_driver {
    fathom_status_t (*open)(port_t *port); /* as port_open(); sets uart and the parts that differ */
    fathom_status_t (*poll)(port_t *port);
    void (*close)(port_t *port);
    int (*fd)(const port_t *port);
    short (*events)(const port_t *port);
};
extern const port_driver_t port_serial, port_tcp, port_chip;

/* Opens the lines of port->settings.pins as the port's pins. Returns FATHOM_OK, or FATHOM_ERR_PORT with the reason. */
fathom_status_t port_open_pins(port_t *port, const char *chip);

/* Stores why the port is not open, and returns FATHOM_ERR_PORT. port_fail() puts the path before the text. */
fathom_status_t port_set_error(port_t *port, port_error_t error, const char *text);
fathom_status_t port_fail(port_t *port, port_error_t error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
