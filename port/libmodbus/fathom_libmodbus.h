/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LIBMODBUS_H
#define FATHOM_LIBMODBUS_H

#include <modbus.h>
#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The Modbus transport (modbus.h) over a modbus_t of libmodbus, RTU or TCP, that the program has made and connected:
 * for programs that use libmodbus already, and for sensors behind an Ethernet gateway.
 *
 *     modbus_t *const modbus = modbus_new_tcp("192.168.1.20", 502);
 *     if (modbus == NULL || modbus_connect(modbus) != 0) return 1;
 *     const fathom_clock_t clock = fathom_posix_clock();
 *     const fathom_libmodbus_config_t config = {.clock = &clock};
 *     static fathom_libmodbus_t port;
 *     if (fathom_libmodbus_init(&port, modbus, &config) != FATHOM_OK) return 1;
 *     const fathom_modbus_t transport = fathom_libmodbus(&port);
 *     ... .modbus = &transport in the configs of as many drivers as there are sensors ...
 *     ... fathom_wait(&sensor, &sample, fathom_libmodbus_wait, &port) ...
 *
 * What it cannot do, because libmodbus cannot (3.1.6, which Debian 12 has):
 *  - Units that modbus_set_slave refuses: submit returns FATHOM_ERR_UNSUPPORTED. These are 248..255 on RTU (so
 *    FATHOM_MODBUS_ANY_UNIT is among them) and 248..254 on TCP, where 255 is the server itself. Later versions take
 *    more of them if the program asks for it (modbus_enable_quirks), and then so does this.
 *  - Line settings of a request (fathom_transaction_t.settings): it ends with FATHOM_ERR_UNSUPPORTED, and nothing was
 *    sent. What modbus_new_rtu was given holds.
 *  - Listening to unsolicited frames: they are dropped and counted. Sensors that send by themselves, and the protocol
 *    55 AA, need fathom_posix.h.
 *  - A transceiver that libmodbus switches with RTS (modbus_rtu_set_rts): it sleeps until the request has left, so
 *    fathom_libmodbus_init refuses it. Let the adapter or the kernel switch it (TIOCSRS485).
 *  - Connecting: that is the program's, and modbus_connect waits.
 *
 * What it uses of libmodbus. On RTU, requests leave through modbus_send_raw_request, so that a trace
 * (modbus_set_debug) shows them. What comes in is read from the descriptor as far as it is there (FIONREAD), and
 * never by modbus_receive_confirmation: that waits for what the first bytes promise, takes noise for them, and
 * throws away another unit's response without saying whose it was. On TCP the port uses the connection alone:
 * modbus_send_raw_request gives every request the transaction 0, by which a late response looks like the one that is
 * due, and modbus_receive_confirmation does not look at the length in the header, so that one response with a wrong
 * length puts all that follow out of step.
 *
 * What it does, besides what line.h says, which holds here too (queue, time-outs, late and damaged responses, retries,
 * broadcasts, counters):
 *  - On TCP every request has a transaction identifier of its own, and only the response to the last request that
 *    was sent is taken. A response to an earlier one is dropped and counted (late_responses), whatever it contains. A
 *    unit that did not respond in time gets no request until twice the time-out has passed, while others do; its
 *    response still counts if it comes in that time and no other unit got a request meanwhile.
 *  - On TCP a response is looked at when all of it is there; until then the port keeps what has come, and SO_RCVLOWAT
 *    of the socket keeps poll(2) from waking for less than the rest.
 *  - On TCP a gateway's exceptions 0x0A (path unavailable) and 0x0B (target silent) are no response of the unit: the
 *    request ends with FATHOM_ERR_NO_RESPONSE when its time-out is over. gateway_exception has the last one. Over RTU
 *    they are exceptions like any other.
 *  - On TCP a response from another unit than the request was for is not taken.
 *
 * A broken connection: what is under way ends with FATHOM_ERR_PORT, and so does every request until modbus_close and
 * modbus_connect have made a new one; then it goes on by itself. On TCP the port shuts the connection down
 * (shutdown(2)) where requests and responses have got out of step: the server sent what is no Modbus, or the system
 * took a part of a request.
 *
 * Time-outs on TCP should be longer than the gateway's own, which is often 1 s: a gateway that still waits for a
 * dead unit does not serve the others either.
 *
 * Memory: the port is the caller's, allocates nothing and may not be moved in use; modbus and clock outlive it. The
 * response and byte time-outs of the modbus_t are not used. Threads: one at a time for a port and its modbus_t. The
 * program may use the modbus_t itself (modbus_read_registers and so on, which wait) while no request is queued.
 */

/* Zero-valued members mean the defaults. On TCP only the clock is used. */
typedef struct {
    const fathom_clock_t *clock;
    /* FATHOM_LINE_ECHO_...: whether the RS-485 adapter hands back what is sent. 0: the line finds out. */
    uint8_t echo;
    /* Kept before a request: FATHOM_T3_5_US(baud, bits). 0: that of 9600 baud, 4011. */
    uint16_t silence_us;
    /* A frame is over when nothing came for so long. 0: 25000, since USB adapters hold bytes back for 16 ms. */
    uint16_t gap_us;
} fathom_libmodbus_config_t;

/* Why the connection is broken. */
typedef enum {
    FATHOM_LIBMODBUS_OK = 0,
    FATHOM_LIBMODBUS_ERR_NOT_CONNECTED = -1, /* modbus_get_socket says -1 */
    FATHOM_LIBMODBUS_ERR_HUNG_UP = -2,       /* the server has closed it; the adapter has gone */
    FATHOM_LIBMODBUS_ERR_SYSTEM = -3,        /* what else the system said, such as ECONNRESET: system_error */
    FATHOM_LIBMODBUS_ERR_NONSENSE = -4,      /* TCP: no header of Modbus stood where one should */
    FATHOM_LIBMODBUS_ERR_TRUNCATED = -5      /* the system took a part of a request only */
} fathom_libmodbus_error_t;

/* All but the counters is the port's own. */
typedef struct {
    fathom_line_t line;                      /* first, so that one pointer is both */
    uint16_t counters[FATHOM_LINE_COUNTERS]; /* for the user */
    fathom_line_parts_t parts;
    fathom_uart_t uart;
    modbus_t *modbus;
    bool is_tcp;
    int8_t error;     /* fathom_libmodbus_error_t */
    int system_error; /* errno, with FATHOM_LIBMODBUS_ERR_SYSTEM */

    /* Of TCP. Counters stop at 65535 and may be set to 0. */
    uint16_t late_responses;   /* to another transaction than the last */
    uint16_t gateway_refusals; /* exceptions 0x0A and 0x0B */
    uint8_t gateway_exception; /* the last of them; 0: none yet */
    uint16_t transaction;      /* of the request that was sent last */
    uint16_t have;             /* in adu, of the next response, while the line has read all of the last one */
    uint64_t connection;       /* that it comes from (SO_COOKIE, Linux 4.12) */
    uint16_t at;               /* in adu, what the line has not read yet, ... */
    uint16_t end;              /* ... and its end */
    uint8_t adu[6 + 1 + 253 + 2]; /* header, unit, PDU, and room for a CRC */

    uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
} fathom_libmodbus_t;

/*
 * Makes a port ready. Sets the modbus_t to MODBUS_ERROR_RECOVERY_NONE: with any other, libmodbus sleeps and connects
 * again when sending fails. Whether the modbus_t is connected is not looked at.
 *
 * Returns FATHOM_OK; FATHOM_ERR_ARGUMENT: a pointer is NULL, the clock's too; FATHOM_ERR_UNSUPPORTED: libmodbus is
 * to switch a transceiver with RTS.
 */
fathom_status_t fathom_libmodbus_init(fathom_libmodbus_t *port, modbus_t *modbus,
                                      const fathom_libmodbus_config_t *config);

/* The transport over a port that is ready, by value: keep it as long as the drivers that point to it. Besides what
 * fathom_modbus_t says, submit may return FATHOM_ERR_UNSUPPORTED: modbus_set_slave refuses the unit. */
fathom_modbus_t fathom_libmodbus(fathom_libmodbus_t *port);

/*
 * The HAL under that transport, for a program that polls the line (line.h) itself, as for a listener on RTU: it carries
 * RTU frames on TCP as well. Then neither port->line nor fathom_libmodbus() may be used.
 *
 * read   < 0 when the connection is broken. Never part of a TCP response.
 * write  A whole RTU frame with its CRC, which libmodbus computes again on RTU, and which is left out on TCP.
 * sent   RTU: the kernel's queue is empty; the UART may have some characters left. TCP: true.
 * set_line, set_break, leaves_in_us  NULL; for the last, `sent` is true too soon for a sleep to be worth it.
 */
fathom_uart_t fathom_libmodbus_uart(fathom_libmodbus_t *port);

/* Why the connection is broken: of the first failure since something last went out or came in. */
fathom_libmodbus_error_t fathom_libmodbus_error(const fathom_libmodbus_t *port);

/*
 * Sleeps until bytes can be read, the connection breaks, a signal handler has run, or max_us microseconds
 * (FATHOM_NO_DEADLINE: without limit) have passed: an idle hook for fathom_wait, ctx is the port. While the connection
 * is broken it returns at once, so look at what the poll functions return, or the loop spins.
 *
 * A program's own poll(2) takes modbus_get_socket, POLLIN and the transport's due_us.
 */
void fathom_libmodbus_wait(void *port, uint32_t max_us);

#ifdef __cplusplus
}
#endif

#endif
