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
#include "ports/listener.h"
#include "ports/port_options.h"

/* An open port. A tty and a connection to a Modbus TCP server have a line and a Modbus client. */

/* Why a port is not open. */
typedef enum {
    PORT_OK,
    PORT_ABSENT, /* nothing is there, but something may come */
    PORT_LOST,   /* the port was open */
    PORT_FAILED
} port_error_t;

/* When an adapter was just plugged in, the system needs a moment, and other programs (modem managers) try it first. So a
 * user hears of a port that is there when it could not be opened this often. */
enum { PORT_TRIES = 3 };

typedef struct port_driver port_driver_t;

/* All zeros before the first port_open(). It may be opened again after port_close(); do not move it. */
typedef struct port {
    const host_t *host;
    port_options_t options;
    port_kind_t kind;
    const char *name; /* its present path */
    port_error_t error;
    char error_text[384]; /* a line of text that names the port; "": it is open */
    uint32_t failures;    /* to open it, in a row and other than PORT_ABSENT */
    adapter_t adapter;    /* behind a tty; it is kept while the port is closed */
    fathom_clock_t clock;
    listener_t listener; /* between the line and the port */
    fathom_line_parts_t parts;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_t line;
    fathom_modbus_t modbus;
    pins_t pins;                /* of a GPIO chip */
    fathom_uart_t uart;         /* that the line uses */
    bool has_wire;              /* a byte takes its time; a pseudo terminal has no wire */
    bool watches_output;        /* port_wait() also ends when the reader of the standard output goes away */
    uint8_t *gateway_exception; /* 10 or 11, since the newest request, or 0; NULL: no gateway */
    fathom_posix_uart_t serial;
    /* private */
    const port_driver_t *driver;
    fathom_loop_source_t *source;
    fathom_uart_t inner; /* of the driver */
    struct tcp *tcp;     /* a connection */
    bool is_connecting;
    int fd; /* of a connection or a chip */
    short events;
    uint8_t frame[255];
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
 * Opens a port. A tty whose adapter was known is found again under any name (adapter.h). The path has to stay valid.
 * source: the port is read only after this source became ready; NULL: always.
 *
 * FATHOM_OK: it is open. FATHOM_PENDING: it connects; call port_poll() when port_fd() is ready for port_events(), and
 * at least twice a second. FATHOM_ERR_PORT: port->error_text has the reason.
 */
fathom_status_t port_open(port_t *port, const host_t *host, const port_options_t *options,
                          fathom_loop_source_t *source);
void port_close(port_t *port);

/* Opens a port without a source, and waits for a connection. A signal ends the wait. False: see port->error_text. */
bool port_open_now(port_t *port, const host_t *host, const port_options_t *options);

/* Call it after each poll of a sensor. FATHOM_OK: the port is open. FATHOM_PENDING: it connects. FATHOM_ERR_PORT: it is
 * lost, or could not connect. */
fathom_status_t port_poll(port_t *port);
int port_fd(const port_t *port);
short port_events(const port_t *port);

/* ---- waiting, for a command with one port ---- */

/* Sleeps until the port is ready, at most max_us. FATHOM_OK; FATHOM_ERR_PORT: the port is lost; FATHOM_ERR_CANCELLED:
 * the command has to end. */
fathom_status_t port_wait(port_t *port, uint32_t max_us);

/* Waits for the end of a transaction on the port's line, and returns its status. A signal cancels the transaction. */
fathom_status_t port_finish(port_t *port, fathom_transaction_t *transaction);

/* Listens without a request. What is received is added to port->listener. A signal ends it. Returns as port_wait(). */
fathom_status_t port_listen(port_t *port, uint32_t for_us);

/* ---- for the drivers in ports/ ---- */

struct port_driver {
    fathom_status_t (*open)(port_t *port); /* as port_open(); sets inner, name, and the parts that differ */
    fathom_status_t (*poll)(port_t *port);
    void (*close)(port_t *port);
    void (*fail)(port_t *port); /* after a read or a write has failed: stores the error if the port is lost */
};
extern const port_driver_t port_tcp;

/* Stores why the port is not open, and returns FATHOM_ERR_PORT. The text names the port. */
fathom_status_t port_fail(port_t *port, port_error_t error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
