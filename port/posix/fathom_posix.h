/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_POSIX_H
#define FATHOM_POSIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Fathom's HAL on a Linux tty (/dev/ttyUSB0, /dev/ttyS1, /dev/ttyAMA0, a pseudo terminal), a clock, and a
 * wait that uses no CPU.
 *
 *     fathom_posix_uart_t port;
 *     const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
 *     if (fathom_posix_open(&port, "/dev/ttyUSB0", &settings) != FATHOM_POSIX_OK) {
 *         fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
 *         return 1;
 *     }
 *     const fathom_uart_t uart = fathom_posix_uart(&port);
 *     const fathom_clock_t clock = fathom_posix_clock();
 *     ... fathom_wait(&sensor, &sample, fathom_posix_wait, &port) ...
 *     fathom_posix_close(&port);
 *
 * What it does not do:
 *  - It says nothing about single bytes: FATHOM_RX_... is never set. A tty has no time stamps, and its error
 *    marks (PARMRK) cannot be believed: the drivers of the commonest USB adapters (ftdi_sio, pl2303) put one
 *    mark on all bytes of a USB packet, so that a spike on the line before a response would condemn the whole
 *    response. A byte with wrong parity is delivered like any other; checksums have to find it.
 *    fathom_posix_line_errors has the driver's counts, for diagnosis.
 *  - It does not drive an RS-485 transceiver by itself. The adapter does, or the kernel's driver: as the device tree
 *    tells it (`linux,rs485-enabled-at-boot-time`), or fathom_posix_set_rs485.
 *  - It does not make a USB adapter faster. An FTDI chip holds bytes back for up to 16 ms:
 *    `setserial /dev/ttyUSB0 low_latency` makes that 1 ms.
 *  - No flow control, no modem lines, 8 data bits only.
 *
 * Memory: the port is the caller's, holds no pointer to anything else, allocates nothing and may not be
 * moved in use. Threads: one port, one thread at a time; different ports do not know of each other. Nothing
 * but fathom_posix_wait waits (opening or closing a USB port may take the driver some milliseconds).
 */

/* What a call on a port came to. fathom_posix_error_text says it in words, with what to do about it. */
typedef enum {
    FATHOM_POSIX_OK = 0,
    FATHOM_POSIX_ERR_ARGUMENT = -1,     /* a NULL, or settings outside what fathom_posix_open allows */
    FATHOM_POSIX_ERR_NOT_FOUND = -2,    /* no such path, or no device behind it (a ttyS without a UART) */
    FATHOM_POSIX_ERR_PERMISSION = -3,   /* the text names the group to join */
    FATHOM_POSIX_ERR_IN_USE = -4,       /* another program, or another port of this one, has it */
    FATHOM_POSIX_ERR_NOT_A_TTY = -5,    /* a file, a folder, a device of another kind */
    FATHOM_POSIX_ERR_REFUSED = -6,      /* the driver does not do these settings; the text has both */
    FATHOM_POSIX_ERR_BUSY = -7,         /* bytes are still leaving */
    FATHOM_POSIX_ERR_LOST = -8,         /* unplugged, or the far end of a pseudo terminal closed */
    FATHOM_POSIX_ERR_CLOSED = -9,       /* the port is not open */
    FATHOM_POSIX_ERR_UNSUPPORTED = -10, /* this kind of port cannot do that */
    FATHOM_POSIX_ERR_SYSTEM = -11       /* anything else that the system said; the text has its words */
} fathom_posix_status_t;

/* Bytes that one write may have; the HAL asks for 255. */
#define FATHOM_POSIX_WRITE_MAX 256

/* All fields are the port's own. A port of zeros is a closed one. */
typedef struct {
    int fd;
    bool is_open;
    bool is_lost; /* for good, until it is opened again */
    bool is_pty;
    bool has_no_lsr; /* TIOCSERGETLSR has said that it is not there */
    fathom_line_settings_t line;
    uint64_t leaving_until_us; /* before it, the last byte cannot have left the pin */
    size_t pending_at;         /* bytes of an accepted write that the kernel has not taken yet */
    size_t pending_end;
    uint8_t pending[FATHOM_POSIX_WRITE_MAX];
    fathom_posix_status_t error;
    char path[64]; /* for messages; longer ones are cut there */
    char text[320];
} fathom_posix_uart_t;

/*
 * Opens a tty for this program alone, sets it, reads the settings back, and throws away what came before.
 *
 * port: any content; one that is open must be closed first, or its file descriptor is lost.
 * path: used during the call only.
 * settings: baud one of 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 576000,
 *   921600; all parities of hal.h; 1 or 2 stop bits.
 *
 * Settings that a driver took without a word and did not keep are an error (REFUSED): an 8250 whose clock is
 * too slow for 230400 keeps the rate that it had and reports success. A rate within 2.5 % counts as kept.
 * One exception: a pseudo terminal (found by its device number: Unix98 slaves have the majors 136..143) never
 * keeps PARENB. It has no wire on which a parity bit could be right or wrong, so it is let pass there and
 * there only; baud and stop bits are kept by a pseudo terminal and are checked.
 *
 * Alone: by flock(2), which is what pyserial's exclusive=True does, and by TIOCEXCL against those that do not
 * ask for a lock. root is not stopped by TIOCEXCL, but is by the lock. On a pseudo terminal there is only
 * the lock: there TIOCEXCL would outlive a program that was killed, as long as the master is open. A program
 * that had the tty open before and knows neither is not seen.
 *
 * Returns FATHOM_POSIX_OK; or ARGUMENT, NOT_FOUND, PERMISSION, IN_USE, NOT_A_TTY, REFUSED, SYSTEM: then
 * nothing is left open and the port is closed, but has the text. The tty keeps its settings after close.
 */
fathom_posix_status_t fathom_posix_open(fathom_posix_uart_t *port, const char *path,
                                        const fathom_line_settings_t *settings);

/* Closes it. Bytes that have not left may be lost or may still leave, as the driver likes; wait for sent() if
 * that matters. A port that is closed already, failed to open, or is all zeros: nothing happens. */
void fathom_posix_close(fathom_posix_uart_t *port);

/*
 * Changes baud, parity and stop bits of an open port; what was received is kept.
 *
 * Returns FATHOM_POSIX_OK; ARGUMENT; CLOSED; LOST; BUSY while sent() is false, because the bytes that leave
 * would change in flight: try again; REFUSED or SYSTEM: the settings before were put back and hold.
 */
fathom_posix_status_t fathom_posix_set_line(fathom_posix_uart_t *port,
                                            const fathom_line_settings_t *settings);

/*
 * How the kernel's driver drives an RS-485 transceiver whose DE hangs on RTS. Of zeros: RTS is on while bytes leave,
 * and off otherwise. Which level that is at the pin is the driver's: a PL011's is high, others differ. Where nothing
 * leaves the board, try the other one.
 */
typedef struct {
    bool rts_off_to_send; /* the other way round */
    /* From RTS to the first start bit, and from the last stop bit to RTS. What a driver cuts off, mostly above 100, is
     * REFUSED. */
    uint8_t before_ms;
    uint8_t after_ms;
} fathom_posix_rs485_t;

/*
 * Lets the driver of an open port turn the transceiver round (TIOCSRS485), and reads that back (TIOCGRS485). It holds
 * until it is set again, over fathom_posix_set_line and after close. The UART is asked not to hear what it sends (no
 * SER_RS485_RX_DURING_TX), but the driver may leave that: a line finds it out (line.h).
 *
 * rs485: NULL: RTS is left alone again.
 *
 * Returns FATHOM_POSIX_OK; ARGUMENT; CLOSED; LOST; BUSY while sent() is false; UNSUPPORTED where the driver has no
 * RS-485: those of USB adapters, of most PC ports, and pseudo terminals; the text says what to do; REFUSED when the
 * driver has made something else of it; or SYSTEM: then what was before was put back and holds.
 */
fathom_posix_status_t fathom_posix_set_rs485(fathom_posix_uart_t *port, const fathom_posix_rs485_t *rs485);

/*
 * The HAL functions of an open port (hal.h); `port` must stay where it is as long as they are used. On a
 * closed port read and write return -1.
 *
 * read   < 0 once the tty has hung up or its device has gone, and from then on until the port is closed and
 *        opened again. Signals do not disturb it.
 * write  1..FATHOM_POSIX_WRITE_MAX bytes. When its queue is nearly full (4 KiB on most UARTs), the kernel may
 *        take only the beginning of a request. The port then keeps the rest, write has taken all, and the
 *        rest follows in the next call of read, write, sent or fathom_posix_wait that finds room; until then
 *        another write is busy (0). On the wire there is no gap as long as one of them is called before the
 *        kernel's queue runs dry. More than FATHOM_POSIX_WRITE_MAX: -1, and the port is as before.
 * sent   True when the kernel's queue is empty, a real UART's transmitter is too (TIOCSERGETLSR, where there
 *        is one), and the time that the bytes need at the set rate has passed since write. The last is
 *        there because a USB adapter's driver knows its own queue and not the chip's, and a pseudo terminal
 *        is always empty at once. What remains: an adapter begins when the next USB frame has reached it
 *        (they are 1 ms apart at full speed), and by that much sent may be early; an FTDI chip tells in its
 *        status packets, up to 16 ms late. True on a port that is lost or closed, so that no caller
 *        waits; read and write return the error.
 * leaves_in_us  The last of these three, to the microsecond; 0 where the kernel has not taken all yet, so that it is
 *        offered the rest, and where an adapter takes longer.
 * set_break  TIOCSBRK and TIOCCBRK, when all that was written has left. Not every adapter can; most drivers do not
 *        tell. On a pseudo terminal a byte 0 stands for a break, which is what one that arrives is read as.
 * set_line  fathom_posix_set_line, and nothing at all when the settings hold already; fathom_posix_error has
 *        the reason when it returns -1.
 */
fathom_uart_t fathom_posix_uart(fathom_posix_uart_t *port);

/* Of the last call that failed on this port, or OK: fathom_posix_open, fathom_posix_set_line, fathom_posix_set_rs485,
 * fathom_posix_line_errors, and read, write, sent and fathom_posix_wait for LOST. */
fathom_posix_status_t fathom_posix_error(const fathom_posix_uart_t *port);

/* The same in words, one line without a line feed: "/dev/ttyUSB0: permission denied: ...". "" when
 * nothing has failed. It lies in the port, until the next call that fails or fathom_posix_open. */
const char *fathom_posix_error_text(const fathom_posix_uart_t *port);

/* What the driver has counted since it was loaded: take differences. They may wrap. */
typedef struct {
    uint32_t parity;
    uint32_t framing; /* mostly: another baud rate than the device's */
    uint32_t overrun; /* bytes lost in the UART, or because the program did not read */
    uint32_t breaks;
} fathom_posix_line_errors_t;

/* Returns FATHOM_POSIX_OK and sets `errors`; ARGUMENT, CLOSED, LOST, or UNSUPPORTED on a pseudo terminal and
 * with drivers that do not count. */
fathom_posix_status_t fathom_posix_line_errors(fathom_posix_uart_t *port, fathom_posix_line_errors_t *errors);

/* CLOCK_MONOTONIC in microseconds: for the HAL (it wraps), and in 64 bits for programs (it does not). Time in
 * which the machine was suspended does not count. */
fathom_clock_t fathom_posix_clock(void);
uint64_t fathom_posix_now_us(void);

/*
 * Sleeps until bytes can be read, the far end has hung up, a signal handler has run, or max_us microseconds
 * have passed (FATHOM_NO_DEADLINE: without limit). It is an idle hook for fathom_wait: ctx is the port.
 *
 * port: a fathom_posix_uart_t. When closed or lost it returns at once, so look at what the poll functions
 * return, or the loop spins. It also returns early when it could hand over the rest of a request.
 *
 * A signal that comes just before the sleep begins does not cut it short: a handler that sets a flag needs a
 * bounded max_us, or an own ppoll(2) with fathom_posix_fd. There is no event for "sent": the engines ask
 * to be called every millisecond meanwhile.
 */
void fathom_posix_wait(void *port, uint32_t max_us);

/*
 * For a program's own poll(2), epoll(7) or select(2): the file descriptor, -1 when closed, and the events to wait for:
 * POLLIN, and POLLOUT while the port keeps the rest of a request. Not for reading or writing.
 *
 * For several ports there is such a loop, fathom_loop.h. One of your own that polls all sensors whenever one port has
 * become ready takes about twice the processor time with 32 ports: nearly all of its reads bring nothing. And a port
 * that is lost stays ready: close it when a poll returns FATHOM_ERR_PORT, or the loop spins.
 */
int fathom_posix_fd(const fathom_posix_uart_t *port);
short fathom_posix_poll_events(const fathom_posix_uart_t *port);

#ifdef __cplusplus
}
#endif

#endif
