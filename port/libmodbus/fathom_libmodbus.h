/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LIBMODBUS_H
#define FATHOM_LIBMODBUS_H

#include <modbus.h>
#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/engine/line_turns.h"
#include "fathom/engine/modbus.h"
#include "fathom/engine/wait.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The Modbus transport (modbus.h) over a modbus_t of libmodbus, RTU or TCP: a line whose UART is the modbus_t.
 *
 * This port is for programs that use libmodbus already, and for sensors behind an Ethernet gateway. The program makes
 * the modbus_t and connects it. Only fathom_libmodbus_wait() waits, and no function allocates memory. The rules of
 * line.h apply here too: queue, time-outs, late and damaged responses, retries, broadcasts, counters. include/COST.md
 * compares Fathom with libmodbus.
 *
 * @code
 * static fathom_libmodbus_t port;
 *
 * modbus_t *const modbus = modbus_new_tcp("192.168.1.20", 502);
 * if (modbus == NULL || modbus_connect(modbus) != 0) return 1;
 * if (fathom_libmodbus_init(&port, modbus, NULL) != FATHOM_OK) return 1;
 * if (fathom_hps167s_init(&gate, &port.modbus, NULL) != FATHOM_OK) return 1;
 * status = fathom_libmodbus_read(&port, fathom_hps167s_sensor(&gate), &sample);
 * @endcode
 *
 * What this port cannot do, because libmodbus (3.1.6 of Debian 12) cannot:
 *
 * 1. **Units.** `submit` returns FATHOM_ERR_UNSUPPORTED for a unit that modbus_set_slave() refuses: 248 to 255 on RTU,
 *    among them FATHOM_MODBUS_ANY_UNIT, and 248 to 254 on TCP, where 255 is the server itself. Later versions accept
 *    more units if the program enables that (modbus_enable_quirks()); this port then accepts them too.
 *
 * 2. **Line settings** of a request (`settings` of fathom_transaction_t). Such a request ends with
 *    FATHOM_ERR_UNSUPPORTED and is not sent. The settings of modbus_new_rtu() are in force.
 *
 * 3. **Unsolicited frames.** The port drops and counts them. For sensors with automatic output and for the protocol
 *    `55 AA`, use fathom_posix.h.
 *
 * 4. **A transceiver that libmodbus switches by RTS** (modbus_rtu_set_rts()). libmodbus sleeps until the request has
 *    left, so fathom_libmodbus_init() refuses it. Let the adapter or the kernel switch the transceiver (TIOCSRS485).
 *
 * 5. **Connecting.** The program does this. modbus_connect() waits.
 *
 * What is different on TCP:
 *
 * 6. **Matching.** Each request has a transaction identifier of its own. The port accepts only a response to the newest
 *    request, from the unit of that request. It drops and counts every other one, whatever it contains: a response to
 *    an earlier request (`late_responses`), with an identifier that this port has not sent (`foreign_responses`), and
 *    from another unit (`other_units`). A unit that did not respond in time gets no request until twice the time-out
 *    has passed. Its response still counts if it arrives in that time and no other request was sent meanwhile.
 *
 * 7. **Whole responses.** The port processes a response when it has arrived completely. Until then the port keeps the
 *    part that has arrived, and SO_RCVLOWAT of the socket keeps poll(2) from waking for less than the rest.
 *
 * 8. **Gateways.** A gateway that waits for a dead unit serves no other unit, often for several seconds. So while the
 *    response to the newest request is pending, the port sends no other one, for at most `hold_us`, even if the time-out
 *    of the request has passed:
 *
 *        request      |unit 9|                                    |unit 1|
 *        gateway             |--- tries unit 9 again --->[0x0B]          [response]
 *        attempt             |-- timeout_us -->| failed
 *        no request          |-- at most hold_us ------->|
 *
 *    Many gateways report nothing about a dead unit. Once the server has let `hold_us` pass without a word, the port lets
 *    one more request leave while a response is pending. If that one has its response in time, the server is not busy
 *    with dead units, and the port does not wait any more. If its response is late, it shows for how long the server was
 *    busy, and the port waits that long and a quarter more from then on, at most `hold_us`. `response_us` is the time
 *    that the newest response took: choose longer time-outs.
 *
 *    A request to a unit that did not respond to its newest request lets other units go first, at most 8 times in a
 *    row. So a healthy unit waits for one dead unit and not for each of them.
 *
 *    The exceptions 0x0A (path unavailable) and 0x0B (target silent) are the gateway's final word, and so is any
 *    exception that the gateway sends as unit 0 or 255, such as 0x06 (busy). The attempt ends at once with
 *    FATHOM_ERR_NO_RESPONSE, because the unit may have executed a write. `gateway_exception` and `gateway_unit` have the
 *    newest one. On RTU they are exceptions like any other.
 *
 * For both:
 *
 * 9. **Broken connection.** The present request ends with FATHOM_ERR_PORT, and so does each later one, until
 *    modbus_close() and modbus_connect() have made a new connection. The port then works again. On TCP the port shuts
 *    the connection down (shutdown(2)) when requests and responses no longer match: the server sent bytes that are no
 *    Modbus, or the system accepted only a part of a request.
 *
 * 10. **What the port uses of libmodbus.** On RTU, requests leave through modbus_send_raw_request(), so a trace
 *     (modbus_set_debug()) shows them. On TCP the port uses only the socket. It reads received bytes from the
 *     descriptor, never by modbus_receive_confirmation(). The response and byte time-outs of the modbus_t are not used.
 *
 * 11. **Threads.** Use a port and its modbus_t from one thread at a time. While no request is queued, the program may
 *     use the modbus_t itself (modbus_read_registers() and so on, which wait).
 */

/** @brief Configuration of a port. A member that is 0 takes its default. On TCP only the clock and `hold_us` are used.
 * Read only by fathom_libmodbus_init(). */
typedef struct {
    /** @brief The clock. It must stay valid as long as the port is used. NULL selects CLOCK_MONOTONIC. */
    const fathom_clock_t *clock;

    /** @brief FATHOM_LINE_ECHO_OFF or _ON: whether the RS-485 adapter returns the bytes that are sent. 0: the line
     * finds out. */
    uint8_t echo;

    /** @brief Silence before a request, in microseconds: FATHOM_T3_5_US() of line.h. 0: that of 9600 baud, 4011. */
    uint16_t silence_us;

    /** @brief Silence that ends a frame, in microseconds. 0: 25000, because USB adapters hold bytes back for 16 ms. */
    uint16_t gap_us;

    /** @brief TCP: the longest time for which a response may be pending before the port sends the next request, in
     * microseconds, at most 2^31 - 1 (rule 8). 0: 5 s. */
    uint32_t hold_us;
} fathom_libmodbus_config_t;

/** @brief The number of requests for which a port remembers when it has sent them: a power of 2. */
#define FATHOM_LIBMODBUS_DATED 8u

/** @brief Why the connection is broken. */
typedef enum {
    FATHOM_LIBMODBUS_OK = 0,                 /**< It is not broken. */
    FATHOM_LIBMODBUS_ERR_NOT_CONNECTED = -1, /**< modbus_get_socket() returns -1. */
    FATHOM_LIBMODBUS_ERR_HUNG_UP = -2, /**< The server closed the connection, or the adapter was unplugged. */
    FATHOM_LIBMODBUS_ERR_SYSTEM = -3, /**< Another error of the system, such as ECONNRESET: `system_error`. */
    FATHOM_LIBMODBUS_ERR_NONSENSE = -4, /**< TCP: received bytes are no header of Modbus. */
    FATHOM_LIBMODBUS_ERR_TRUNCATED = -5 /**< The system accepted only a part of a request. */
} fathom_libmodbus_error_t;

/** @brief A port, in the caller's memory. It must not be moved while it is used. A program may read the members whose
 * comment does not say "Private". */
typedef struct {
    /** @brief The line, for fathom_line_due_us(). The first member, so that one pointer is both. */
    fathom_line_t line;
    /** @brief The counters of the line (line.h). The caller may set them to 0. */
    uint16_t counters[FATHOM_LINE_COUNTERS];
    /** @brief Private: the parts of the line. */
    fathom_line_parts_t parts;
    /** @brief Private: the UART of the line. */
    fathom_uart_t uart;
    /** @brief The transport over the connection, for drivers. Its `submit` may return FATHOM_ERR_UNSUPPORTED (rule 1). */
    fathom_modbus_t modbus;
    /** @brief Private: the modbus_t. */
    modbus_t *handle;
    /** @brief Private: true for TCP. */
    bool is_tcp;
    /** @brief Private: a fathom_libmodbus_error_t; fathom_libmodbus_error() returns it. */
    int8_t error;
    /** @brief The errno of FATHOM_LIBMODBUS_ERR_SYSTEM. */
    int system_error;

    /** @brief TCP: responses to an earlier request than the newest. Stops at 65535. The caller may set it to 0. */
    uint16_t late_responses;
    /** @brief TCP: responses with an identifier that this port has not sent, or that the server has used. Stops at 65535. The caller may set it to 0. */
    uint16_t foreign_responses;
    /** @brief TCP: responses to the newest request, from another unit. Stops at 65535. The caller may set it to 0. */
    uint16_t other_units;
    /** @brief TCP: final words of a gateway (rule 8). Stops at 65535. The caller may set it to 0. */
    uint16_t gateway_refusals;
    /** @brief TCP: the exception of the newest final word. 0 after a response of `gateway_unit`, and before the first. */
    uint8_t gateway_exception;
    /** @brief TCP: the unit whose request that exception ended. */
    uint8_t gateway_unit;
    /** @brief TCP: the unit of the newest response that was counted in `other_units`. */
    uint8_t other_unit;
    /** @brief TCP: the time from the newest request that was answered until its response or final word, in
     * microseconds, if that time is known. 0: none yet. */
    uint32_t response_us;

    /* private */
    fathom_line_turns_t turns; /* holds requests back (rule 8) */
    uint16_t transaction;      /* of the request that was sent last */
    uint8_t unit;              /* of that request */
    bool is_response_pending;  /* the server may still respond to it */
    bool is_overdue;           /* the attempt has ended without it */
    bool has_held;             /* the server has let hold_us pass without a word */
    bool is_never_busy;        /* a dead unit does not keep the server busy */
    bool is_busy_us_known;     /* it does, for busy_us */
    bool is_crowded;           /* the newest request was sent while another one was pending */
    bool has_unanswered;       /* a request was sent since the newest response */
    uint32_t unanswered_us;    /* when the first of them was sent */
    uint32_t hold_us;
    uint32_t
        busy_us; /* for how long a request without a response keeps the server busy; hold_us until it is known */
    uint8_t overtaken;   /* requests to other units since the newest to one that had not responded */
    uint8_t silent[32];  /* a bit for each unit that did not respond to its newest request */
    uint8_t used;        /* a bit for each request in sent_us: it has its response */
    uint16_t sent_count; /* requests so far; stops at 32768 */
    uint32_t
        sent_us[FATHOM_LIBMODBUS_DATED]; /* when request `transaction` % FATHOM_LIBMODBUS_DATED was sent */
    /* Count of bytes of the next response in adu. Not 0 only if the line has read all of the last response. */
    uint16_t have;
    uint64_t connection; /* the connection that these bytes came from (SO_COOKIE, Linux 4.12) */
    /* The bytes that the line has not read yet stand from adu[at] to adu[end]. */
    uint16_t at;
    uint16_t end;
    uint8_t adu[6 + 1 + 253 + 2]; /* header, unit, PDU, and space for a CRC */

    uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
} fathom_libmodbus_t;

/**
 * @brief Initialises a port.
 *
 * The call sets the modbus_t to MODBUS_ERROR_RECOVERY_NONE: with any other mode, libmodbus sleeps and connects again
 * when sending fails. The modbus_t need not be connected yet.
 *
 * @param port    The port, with any content.
 * @param modbus  The modbus_t. Must stay valid as long as the port is used.
 * @param config  The configuration, read only during the call; its clock must stay valid. NULL selects all defaults.
 * @retval FATHOM_OK               The port is ready. Next, pass `&port->modbus` to the init functions of drivers.
 * @retval FATHOM_ERR_ARGUMENT     `port` or `modbus` is NULL, or a time is out of the range of line.h.
 * @retval FATHOM_ERR_UNSUPPORTED  libmodbus switches a transceiver by RTS (rule 4).
 */
fathom_status_t fathom_libmodbus_init(fathom_libmodbus_t *port, modbus_t *modbus,
                                      const fathom_libmodbus_config_t *config);

/**
 * @brief Returns the UART functions (hal.h) under that transport, for a program that polls a line of its own.
 *
 * For example, a listener on RTU needs a line of its own. The line sees RTU frames on TCP as well. The program must
 * then use neither `port->line` nor `port->modbus`.
 *
 * - **read** returns a negative number when the connection is broken. It never returns a part of a TCP response that
 *   has not arrived completely.
 * - **write** accepts a whole RTU frame with its CRC. libmodbus computes the CRC again on RTU; on TCP it is left out.
 * - **On TCP**, name fathom_line_refusals() as `marks` in the parts of the line, and call fathom_libmodbus_hold() after
 *   fathom_line_init(). Otherwise rule 8 does not apply.
 * - **sent**: on RTU, true if the queue of the kernel is empty; the UART may still hold a few characters. On TCP, true.
 * - **set_line**, **set_break** and **leaves_in_us** are NULL. `sent` is true too soon for a sleep to be useful.
 *
 * @param port  The port, initialised. It must stay valid as long as the functions are used.
 * @return The functions, by value.
 */
fathom_uart_t fathom_libmodbus_uart(fathom_libmodbus_t *port);

/**
 * @brief Holds requests back while a response is pending (rule 8). For a line of the program's own, on TCP.
 *
 * @param port  The port, initialised.
 * @param line  The line on its UART, after fathom_line_init(). It has no other policy (line_turns.h).
 */
void fathom_libmodbus_hold(fathom_libmodbus_t *port, fathom_line_t *line);

/** @brief Returns why the connection is broken: the first failure since bytes were last sent or received. */
fathom_libmodbus_error_t fathom_libmodbus_error(const fathom_libmodbus_t *port);

/**
 * @brief Sleeps until bytes can be read, the connection breaks, a signal handler has run, or `max_us` has passed.
 *
 * This is an idle hook for fathom_wait() (wait.h). If the modbus_t is not connected, or the connection is broken, it
 * returns at once: a loop must check the status that the poll functions return, or it uses a whole processor. For a
 * poll(2) of the program, use modbus_get_socket(), POLLIN and fathom_line_due_us() with `line` of the transport.
 *
 * @param port    The port, a fathom_libmodbus_t.
 * @param max_us  Longest sleep in microseconds. FATHOM_NO_DEADLINE: without a limit.
 */
void fathom_libmodbus_wait(void *port, uint32_t max_us);

/**
 * @brief Waits for the next reading or error of a sensor, as fathom_wait(). Uses no processor time while it waits.
 *
 * The driver's header states the longest wait. If the connection is broken, the call returns FATHOM_ERR_PORT at once.
 *
 * @param port    The port of the sensor.
 * @param sensor  The sensor, such as the result of fathom_hps167s_sensor().
 * @param sample  Written with FATHOM_OK only.
 * @return Any result of fathom_poll() but FATHOM_PENDING.
 */
fathom_status_t fathom_libmodbus_read(fathom_libmodbus_t *port, fathom_sensor_t sensor,
                                      fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
