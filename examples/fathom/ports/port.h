/* SPDX-License-Identifier: MIT */
#ifndef PORT_H
#define PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"
#include "fathom_loop.h"
#include "ports/adapter.h"
#include "ports/host.h"

/* A port as a user names it, with its settings. */

typedef enum {
    PORT_SERIAL,
    PORT_GATEWAY, /* tcp:HOST[:PORT], a Modbus TCP server */
    PORT_RAW,     /* rtu-tcp:HOST:PORT, a converter that passes the bytes of a serial line */
    PORT_PINS     /* lines of a GPIO chip: the last part of the path begins with gpiochip */
} port_kind_t;

port_kind_t port_kind(const char *path);

/* Returns true if a port of this kind has line settings: else the gateway or the converter has them. */
bool port_has_settings(port_kind_t kind);

/* Returns true if a port of this kind leads to a line, all bytes of which it passes on. */
bool port_has_bytes(port_kind_t kind);

/* The parts of tcp:HOST[:PORT] or rtu-tcp:HOST:PORT. An IPv6 address stands in brackets. */
typedef struct {
    char host[256]; /* DNS allows no longer name */
    char service[6];
} tcp_address_t;

/* Parses the path of a gateway or a converter. Returns NULL, or what is wrong with it. */
const char *tcp_parse(const char *path, tcp_address_t *address);

/* Returns true if both paths lead to the same port, as a link and its target do. A port that does not exist is known by
 * its path only. */
bool port_is_same(const char *one, const char *other);

/* ---- what can be set for a port ---- */

typedef enum {
    /* of a serial port */
    KEY_BAUD,
    KEY_PARITY, /* FATHOM_PARITY_... */
    KEY_STOP_BITS,
    KEY_RS485,  /* 0 or 1: the kernel's driver switches the transceiver */
    KEY_ECHO,   /* fathom_line_parts_t.echo */
    KEY_PIECES, /* 0 or 1: a response may arrive in pieces, with pauses */
    /* of a GPIO chip: lines, by their number on it */
    KEY_TRIGGER, /* of a serial port also, with the number of its chip in the upper 16 bits */
    KEY_PULSE,   /* written echo= */
    KEY_IN,
    KEY_BIAS, /* fathom_gpio_bias_t */
    KEY_NEAR, /* pins_near_t */
    PORT_KEYS
} port_key_t;

typedef struct {
    uint32_t value[PORT_KEYS]; /* 0 unless the user set this key */
    bool has[PORT_KEYS];
} port_keys_t;

/* A port, and the line behind it. port_open() needs the path and, for a serial port, the line. */
typedef struct {
    const char *path;
    fathom_line_settings_t line; /* with which it is opened: those of its slowest sensor */
    bool has_mixed_lines;        /* its sensors have different ones */
    size_t station_count;        /* sensors at it */
    port_keys_t keys; /* that stand behind it; port_options_take() adds the defaults, and sets the rest */
    port_kind_t kind;
    pin_options_t pins;
} port_options_t;

/* Sets what follows from the path and the keys. A serial port uses the defaults for the keys that it does not have. */
void port_options_take(port_options_t *port, const port_keys_t *defaults);

/* Then changes the line settings of one of its sensors by the keys. */
void port_options_line(const port_options_t *port, fathom_line_settings_t *line);

/* ---- the settings of a line in words ---- */

/* The rates that a port can have, and the names of FATHOM_PARITY_NONE, _EVEN and _ODD, as word_find() searches them. */
#define PORT_BAUDS    "9600 19200 38400 57600 115200 230400"
#define PORT_PARITIES "none even odd"

/* Writes "9600 8N1". Returns text. */
enum { LINE_TEXT = 24 };
const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT]);

/* Returns "none", "even" or "odd". */
const char *parity_name(uint8_t parity);

/* ---- what passes ---- */

/*
 * What passed between a line and its port in an attempt: the evidence from which a failure is explained. An attempt
 * begins with listener_forget().
 */
enum { LISTENER_WINDOW = 512, LISTENER_REQUEST = 255 };

typedef struct listener listener_t;
struct listener {
    /* Of a port with several sensors that get requests: returns the listener of the sensor whose request is about to
     * leave, which stores what passes until the next request. NULL: the port's own listener stores all. */
    listener_t *(*whose)(void *ctx);
    void *ctx;
    listener_t *now; /* the listener that stores at present; NULL: the port's own */

    uint8_t window[LISTENER_WINDOW]; /* the first bytes that were received in this attempt */
    uint16_t have;                   /* bytes in `window` */
    uint8_t piece[64];               /* the beginning of a response that broke off in the previous attempt */
    uint8_t piece_length;            /* 0: there is none, or a request was sent since */
    uint32_t last_us;                /* the time of the newest byte */
    uint32_t pieces_us;              /* the rest came this time after the beginning; 0: it did not */
    uint32_t bytes;                  /* received in this attempt */
    uint32_t slowest_us;             /* the longest time in this attempt from a request to a later byte */
    uint8_t request[LISTENER_REQUEST]; /* the newest one */
    uint8_t request_length;            /* 0: none was sent */
    uint32_t asked_us;                 /* the time of the newest request */
    bool has_asked;                    /* a request was sent in this attempt */
    uint8_t
        word; /* the exception that a gateway reported about this attempt, or after the previous one; 0: none */
    bool is_word_late; /* it arrived after the previous attempt */
    uint64_t requests; /* since the start */
};

/* What the window holds. A frame counts if its checksum is right. */
typedef struct {
    uint32_t bytes;   /* received, also those that the window had no place for */
    uint32_t echoes;  /* copies of the newest request */
    bool is_zeros;    /* the window has bytes 00 and no others */
    uint32_t rest;    /* bytes of the window that are neither echo nor frame */
    uint32_t own;     /* responses of the unit of the request, ... */
    uint32_t fitting; /* ... and those of them whose length fits the request */
    bool headless;    /* the window has a response whose first bytes are missing or wrong, and no whole one */
    uint32_t foreign; /* frames of other units, ... */
    uint8_t foreign_address; /* ... and the first of these units */
    uint32_t masters;        /* requests of another master, ... */
    uint8_t masters_address; /* ... and the unit that the first of them asked */
    uint32_t streamed_a16;   /* frames FF..SUM, at least two in a row, of a sensor that sends automatically */
    uint32_t streamed_a05;
    uint32_t part;      /* bytes of a response that broke off at the end of the window */
    uint32_t pieces_us; /* the pause between such a beginning, in an earlier attempt, and its rest; 0: none */
    bool is_mbap;       /* the window begins with a frame of Modbus TCP */
    uint8_t word;       /* the exception of a gateway, such as that the unit does not respond; 0: none */
    uint32_t slowest_us;
} evidence_t;

/* Starts an attempt: discards what was received. */
void listener_forget(listener_t *listener);

/* Stores a request, and received bytes. */
void listener_sent(listener_t *listener, const uint8_t *request, uint8_t length, uint32_t now_us);
void listener_received(listener_t *listener, const uint8_t *bytes, uint32_t count, uint32_t now_us);

/* Stores the final word of a gateway about the newest request. */
void listener_word(listener_t *listener, uint8_t exception);

/* Fills in the evidence. `address` is the unit of the request; 0: there was no request. */
void listener_judge(const listener_t *listener, uint8_t address, evidence_t *evidence);

/* ---- an open port: a tty and a connection to a Modbus TCP server have a line and a Modbus client ---- */

/* Why a port is not open. */
typedef enum {
    PORT_OK,
    PORT_ABSENT, /* nothing is there, but something may come */
    PORT_LOST,   /* the port was open */
    PORT_FAILED
} port_error_t;

/* When an adapter was just plugged in, the system needs a moment, and other programs (modem managers) try it first. So a
 * user gets a message about a present port when it could not be opened this often. */
enum { PORT_TRIES = 3 };

typedef struct port_driver port_driver_t;

/* What the far end of a connection has shown; all zeros for other ports. */
typedef struct {
    uint8_t other_unit;  /* which responded to the newest request, ... */
    bool has_other_unit; /* ... if that is not the unit of the request */
    bool
        has_other_identifier; /* the server responded to the newest request with another transaction identifier */
    bool is_rtu;              /* what was received of the newest response begins as a frame of Modbus RTU */
    bool is_incomplete;       /* ... but not as a whole response of Modbus TCP */
    bool is_closed;           /* the connection ended while the response to the newest request was pending */
} gateway_t;

/* All zeros before the first port_open(). It may be opened again after port_close(); do not move it. */
typedef struct port {
    const host_t *host;
    port_options_t options;
    port_kind_t kind;
    const char *name; /* its present path */
    port_error_t error;
    char error_text[384]; /* a line of text that names the port; "": it is open */
    uint32_t failures;    /* to open it, in a row and other than PORT_ABSENT */
    uint32_t
        reconnects; /* connections after the far end had closed an idle one; it is kept while the port is closed */
    uint32_t barren;   /* connections in a row over which nothing was received; kept as well */
    adapter_t adapter; /* behind a tty; it is kept while the port is closed */
    fathom_clock_t clock;
    listener_t listener; /* between the line and the port */
    fathom_line_parts_t parts;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_t line;
    fathom_modbus_t modbus;
    pins_t pins;         /* of a GPIO chip */
    fathom_uart_t uart;  /* that the line uses */
    bool has_wire;       /* a byte takes its time; a pseudo terminal has no wire */
    bool watches_output; /* port_wait() also ends when the reader of the standard output goes away */
    gateway_t gateway;
    fathom_posix_uart_t serial;
    bool counts_errors;                /* the driver counts them, ... */
    fathom_posix_line_errors_t errors; /* ... and had counted these when they were taken */
    /* private */
    const port_driver_t *driver;
    fathom_loop_source_t *source;
    fathom_uart_t inner; /* of the driver */
    struct connection *connection;
    bool is_connecting;
    int fd; /* of a connection or a chip */
    short events;
    uint8_t frame[255];
} port_t;

/*
 * The silence that ends a frame. A USB adapter holds bytes back for up to 16 ms, and the system may be late too. The
 * gap of a stream is less than the pause between two frames of a sensor that sends automatically. After a request, the
 * gap decides only how soon a damaged response is given up, and the far end may be a program that a busy system
 * interrupts within a frame.
 */
enum { PORT_STREAM_GAP_US = 25000, PORT_RESPONSE_GAP_US = 60000 };

/* Through a network or another program, bytes come in pieces with pauses: a response until its time-out, and a frame of a
 * sensor that sends by itself up to the longest gap that a listener has. */
enum { PORT_PIECES_GAP_US = 65000 };
bool port_has_pieces(const port_t *port);

/* Returns PORT_STREAM_GAP_US or PORT_PIECES_GAP_US. */
uint16_t port_stream_gap_us(const port_t *port);

/* A command listens this long before its first request, so that the line knows the automatic frames (line.h). */
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

/* Returns the time in us until port_poll() has to be called, whatever the line returns. FATHOM_NO_DEADLINE: none. */
uint32_t port_due_us(const port_t *port);

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
    fathom_status_t (*poll)(port_t *port); /* as port_poll(), also after a read or a write has failed */
    void (*close)(port_t *port);
    void (*start_line)(port_t *port); /* called when the line is initialised; NULL: there is nothing to do */
    void (*note_sent)(port_t *port);  /* called when a request was sent, ... */
    void (*note_read)(port_t *port);  /* ... and after each read; NULL as well */
    uint32_t (*due_us)(const port_t *port); /* as port_due_us(); NULL as well */
};
extern const port_driver_t port_tcp; /* of a gateway and of a converter */

/* Sets the parts of a line that passes all bytes. */
void port_set_line(port_t *port);

/* Stores why the port is not open, and returns FATHOM_ERR_PORT. The text names the port. */
fathom_status_t port_fail(port_t *port, port_error_t error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
