/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_POSIX_H
#define FATHOM_POSIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/engine/modbus.h"
#include "fathom/engine/wait.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The HAL (hal.h) on a Linux tty, with a clock and a wait that uses no processor time.
 *
 * A port is a tty: /dev/ttyUSB0, /dev/ttyS1, /dev/ttyAMA0, or a pseudo terminal. "The driver" is here the driver
 * of the kernel for this tty. The port never allocates memory, and keeps no state outside the struct that the caller
 * passes to it. Only fathom_posix_wait() waits. All other functions return at once, except that the driver may need a
 * few milliseconds to open or close a USB port. The section "Many lines" of include/COST.md has the processor time of
 * programs with 1 to 256 ports.
 *
 * @code
 * static fathom_posix_uart_t port;          // these three at file scope
 * static fathom_uart_t uart;
 * static fathom_clock_t hal_clock;
 *
 * const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
 * if (fathom_posix_open(&port, "/dev/ttyUSB0", &settings) != FATHOM_POSIX_OK) {
 *     fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
 *     return 1;
 * }
 * uart = fathom_posix_uart(&port);          // must stay valid as long as the line
 * hal_clock = fathom_posix_clock();
 * // line and driver are initialised with &uart and &hal_clock (line.h)
 * status = fathom_wait(&sensor, &sample, fathom_posix_wait, &port);
 * fathom_posix_close(&port);
 * @endcode
 *
 * 1. **Threads.** Call the functions of one port from one thread at a time. Different ports are independent.
 *
 * 2. **Memory.** A port holds no pointer to other memory. Do not move or copy an open port, because the result of
 *    fathom_posix_uart() contains a pointer to it.
 *
 * 3. **Single bytes.** The port reports nothing about single bytes: it never sets a flag `FATHOM_RX_...`. A tty has no
 *    time stamps. Its error marks (PARMRK) cannot be trusted, because the drivers of the most common USB adapters
 *    (ftdi_sio, pl2303) give one mark to all bytes of a USB packet. A spike on the line before a response would then
 *    invalidate the whole response. The port delivers a byte with wrong parity like any other byte, so only checksums
 *    find it. For diagnosis, fathom_posix_line_errors() returns the counts of the driver.
 *
 * 4. **RS-485.** The port does not drive an RS-485 transceiver. The adapter does this, or else the driver. Configure
 *    the driver in the device tree (`linux,rs485-enabled-at-boot-time`) or by fathom_posix_set_rs485(). If an adapter
 *    needs RTS to switch its direction and its driver cannot do this, the adapter cannot be used.
 *
 * 5. **USB latency.** The port does not change the latency of a USB adapter. An FTDI chip holds bytes back for up to
 *    16 ms. `setserial /dev/ttyUSB0 low_latency` reduces this to 1 ms.
 *
 * 6. **Settings.** The port has 8 data bits and no flow control. It ignores the modem lines and does not set RTS and
 *    DTR; most drivers switch both on when the tty is opened. fathom_posix_close() does not restore the former
 *    settings of the tty.
 *
 * 7. **An unplugged adapter.** If the adapter is unplugged, the port is lost. The polls of Fathom's line and sensors
 *    return FATHOM_ERR_PORT, and fathom_posix_error() returns FATHOM_POSIX_ERR_LOST. Call fathom_posix_close(). Then
 *    call fathom_posix_open() on the same struct until it succeeds. The result of fathom_posix_uart() stays valid, and
 *    the line and its sensors continue without a new initialisation. An adapter can come back under another name, but
 *    a path in /dev/serial/by-id stays the same. fathom_loop.h does all this.
 *
 * 8. **Processes.** exec(2) closes the file descriptor of a port. A child of fork(2) without exec(2) keeps the tty and
 *    its lock open.
 */

/**
 * @brief The result of a call on a port. Errors are negative.
 *
 * fathom_posix_error_text() returns the error in words, and for most errors also a remedy.
 */
typedef enum {
    FATHOM_POSIX_OK = 0, /**< Success. */
    FATHOM_POSIX_ERR_ARGUMENT =
        -1, /**< A pointer is NULL, or fathom_posix_open() does not allow the settings. */
    FATHOM_POSIX_ERR_NOT_FOUND =
        -2, /**< The path does not exist, or there is no device behind it (a ttyS without a
                                           UART). */
    FATHOM_POSIX_ERR_PERMISSION =
        -3, /**< The user may not open the path. The text names the group to join. */
    FATHOM_POSIX_ERR_IN_USE =
        -4, /**< Another program, or another port of this program, has locked the tty. */
    FATHOM_POSIX_ERR_NOT_A_TTY = -5, /**< The path is a file, a folder or a device of another kind. */
    FATHOM_POSIX_ERR_REFUSED =
        -6,                     /**< The driver did not keep the settings. The text has both: those that were
                                           requested, and those that the driver set. */
    FATHOM_POSIX_ERR_BUSY = -7, /**< Bytes are still being sent. Try again. */
    FATHOM_POSIX_ERR_LOST = -8, /**< The device was unplugged, or the far end of a pseudo terminal was closed.
                                           Close the port and open it again. */
    FATHOM_POSIX_ERR_CLOSED = -9,       /**< The port is not open. */
    FATHOM_POSIX_ERR_UNSUPPORTED = -10, /**< The driver of this port cannot do this. */
    FATHOM_POSIX_ERR_SYSTEM = -11 /**< Any other error of the system. The text has the words of the system. */
} fathom_posix_status_t;

/** @brief Largest number of bytes in one `write` of fathom_posix_uart(). A line writes at most 255 bytes. */
#define FATHOM_POSIX_WRITE_MAX 256

/** @brief A port, in the caller's memory. All members are private. A port of zeros is a closed port. */
typedef struct {
    /* private */
    int fd; /* -1 if the port is closed */
    bool is_open;
    bool is_lost; /* stays true until the port is opened again */
    bool is_pty;
    bool has_no_lsr;             /* the driver has no TIOCSERGETLSR */
    fathom_line_settings_t line; /* the settings that are in force */
    uint64_t leaving_until_us;   /* the last byte cannot have left the pin before this time */
    /* The bytes of an accepted write that the kernel has not accepted yet stand from pending_at to pending_end. */
    size_t pending_at;
    size_t pending_end;
    uint8_t pending[FATHOM_POSIX_WRITE_MAX];
    fathom_posix_status_t error; /* of the newest call that failed */
    char path[64];               /* for messages; a longer path is cut */
    char text[320];
} fathom_posix_uart_t;

/**
 * @brief Opens a tty exclusively, sets it, reads the settings back, and discards the bytes that arrived before.
 *
 * **Settings.** The port reads the settings back, because a driver may report success without keeping them. For
 * example, an 8250 whose clock is too slow for 230400 baud keeps its old rate and reports success. If the driver does
 * not keep the settings, the result is FATHOM_POSIX_ERR_REFUSED. A rate within 2.5 % counts as kept. There is one
 * exception: a pseudo terminal never keeps PARENB, because it has no wire with a parity bit. The port ignores the
 * parity of a pseudo terminal, which it recognises by the device number (Unix98 slaves have the majors 136 to 143). A
 * pseudo terminal keeps baud rate and stop bits, so the port checks these.
 *
 * **Exclusive.** The port takes a lock by flock(2), as pyserial does with `exclusive=True`, and sets TIOCEXCL against
 * programs that do not lock. TIOCEXCL does not stop a program of root; the lock stops such a program only if it locks
 * too. A pseudo terminal gets the lock only, because TIOCEXCL would outlive a killed program there as long as the
 * master is open. The port does not detect a program that opened the tty earlier and uses neither the lock nor
 * TIOCEXCL.
 *
 * @param port      The port, with any content. Close an open port first; otherwise its file descriptor leaks.
 * @param path      Path of the tty. Used only during the call.
 * @param settings  Baud rate 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 576000 or
 *                  921600; any parity of hal.h; 1 or 2 stop bits. Used only during the call.
 * @return FATHOM_POSIX_OK: the port is open. The tty keeps its settings after fathom_posix_close().
 * @return FATHOM_POSIX_ERR_ARGUMENT, _NOT_FOUND, _PERMISSION, _IN_USE, _NOT_A_TTY, _REFUSED or _SYSTEM: nothing is left
 *         open and the port is closed. fathom_posix_error_text() has the reason.
 */
fathom_posix_status_t fathom_posix_open(fathom_posix_uart_t *port, const char *path,
                                        const fathom_line_settings_t *settings);

/**
 * @brief Closes a port.
 *
 * Bytes that have not left yet may be lost or may still leave; this depends on the driver. If that matters, wait until
 * `sent` of fathom_posix_uart() is true, and 1 ms longer for a USB adapter. If the port is closed, failed to open or is
 * all zeros, the function does nothing.
 *
 * @param port  The port, or NULL.
 */
void fathom_posix_close(fathom_posix_uart_t *port);

/**
 * @brief Changes baud rate, parity and stop bits of an open port. Received bytes are kept.
 *
 * @param port      The port.
 * @param settings  As for fathom_posix_open(). Used only during the call.
 * @retval FATHOM_POSIX_OK            The new settings are in force.
 * @retval FATHOM_POSIX_ERR_ARGUMENT  A pointer is NULL, or the settings are not allowed.
 * @retval FATHOM_POSIX_ERR_CLOSED    The port is not open.
 * @retval FATHOM_POSIX_ERR_LOST      The port is lost.
 * @retval FATHOM_POSIX_ERR_BUSY      `sent` is false: the change would damage the bytes that are being sent. Try again.
 * @retval FATHOM_POSIX_ERR_REFUSED   The driver did not keep the settings. The old settings are in force again.
 * @retval FATHOM_POSIX_ERR_SYSTEM    The system reported another error. The old settings are in force again.
 */
fathom_posix_status_t fathom_posix_set_line(fathom_posix_uart_t *port,
                                            const fathom_line_settings_t *settings);

/**
 * @brief How the driver of the kernel drives an RS-485 transceiver whose DE is connected to RTS.
 *
 * If all members are 0, RTS is on while bytes are sent and off otherwise. Whether "on" is a high level at the pin
 * depends on the driver: it is high for a PL011. If nothing leaves the board, try the other value of
 * `rts_off_to_send`.
 */
typedef struct {
    /** @brief True: RTS is off while bytes are sent, and on otherwise. */
    bool rts_off_to_send;
    /** @brief Time from the change of RTS to the first start bit, in milliseconds. A driver may reduce a long delay,
     * mostly one above 100 ms; the call then returns FATHOM_POSIX_ERR_REFUSED. */
    uint8_t before_ms;
    /** @brief Time from the last stop bit to the change of RTS, in milliseconds. Limited like `before_ms`. */
    uint8_t after_ms;
} fathom_posix_rs485_t;

/**
 * @brief Sets how the driver of an open port drives an RS-485 transceiver (TIOCSRS485), and reads it back (TIOCGRS485).
 *
 * The setting stays in force until the next call, also after fathom_posix_set_line() and fathom_posix_close(). The call
 * requests that the UART does not receive what it sends (no SER_RS485_RX_DURING_TX). If the driver ignores that, the
 * result is still FATHOM_POSIX_OK. A line can find out whether there is echo (fathom_line_find_echo() of line.h).
 *
 * @param port   The port.
 * @param rs485  The setting. NULL: the driver no longer changes RTS. Used only during the call.
 * @retval FATHOM_POSIX_OK               The setting is in force.
 * @retval FATHOM_POSIX_ERR_ARGUMENT     `port` is NULL.
 * @retval FATHOM_POSIX_ERR_CLOSED       The port is not open.
 * @retval FATHOM_POSIX_ERR_LOST         The port is lost.
 * @retval FATHOM_POSIX_ERR_BUSY         `sent` is false. Try again.
 * @retval FATHOM_POSIX_ERR_UNSUPPORTED  The driver has no RS-485, like those of USB adapters, most PC ports and pseudo
 *                                       terminals. The text says what to do.
 * @retval FATHOM_POSIX_ERR_REFUSED      The driver set something else. The previous setting is in force again.
 * @retval FATHOM_POSIX_ERR_SYSTEM       The system reported another error. The previous setting is in force.
 */
fathom_posix_status_t fathom_posix_set_rs485(fathom_posix_uart_t *port, const fathom_posix_rs485_t *rs485);

/**
 * @brief Returns the UART functions (hal.h) of an open port.
 *
 * If the port is closed or lost, `read`, `write` and `set_break` return -1. The line and the sensors report that as
 * FATHOM_ERR_PORT.
 *
 * - **read** returns -1 after the tty has hung up or its device was unplugged, until the port is closed and opened
 *   again (rule 7). Signals do not disturb a read.
 * - **write** accepts 1 to FATHOM_POSIX_WRITE_MAX bytes. If `length` is larger, it returns -1 and changes nothing. If
 *   the queue of the kernel (4 KiB for most UARTs) is nearly full, the kernel may accept only the beginning of a
 *   request. The port then keeps the rest, and `write` returns `length`. The next call of `read`, `write`, `sent` or
 *   fathom_posix_wait() for which the kernel has space passes the rest on. Until then another `write` returns 0. There
 *   is no gap on the wire if one of these calls comes before the queue of the kernel is empty.
 * - **sent** is true when three conditions hold: the queue of the kernel is empty; the transmitter of a real UART is
 *   empty too (TIOCSERGETLSR, if the driver has it); and the time that the bytes need at the set rate has passed since
 *   `write`. The third condition is necessary for two reasons. The driver of a USB adapter knows only its own queue,
 *   not that of the chip, and a pseudo terminal is always empty at once. An adapter begins when the next USB frame has
 *   reached it, every 1 ms at full speed, so `sent` may be true up to 1 ms early. An FTDI chip reports its state in
 *   status packets, up to 16 ms late. `sent` is true for a lost or closed port, so that no caller waits; `read` and
 *   `write` return the error.
 * - **leaves_in_us** returns the rest of the time of the third condition. If the kernel has not accepted all bytes
 *   yet, or if an adapter needs longer, it returns 0, so that the caller polls soon.
 * - **set_break** returns 0 while bytes are still being sent. After that it calls TIOCSBRK or TIOCCBRK. Not every
 *   adapter can send a break, and most drivers do not report that. If the driver reports it, `set_break` returns -1,
 *   fathom_posix_error() returns FATHOM_POSIX_ERR_UNSUPPORTED, and the port stays usable. On a pseudo terminal the port
 *   writes a byte 0 instead, because a received break reads as such a byte.
 * - **set_line** returns 1 if the settings are in force already, also if the port is closed or lost. Otherwise it calls
 *   fathom_posix_set_line(). If the result is -1, fathom_posix_error() has the reason.
 *
 * @param port  The port. It must stay valid, and must not be moved, as long as the functions are used.
 * @return The UART, by value. A line needs it in memory that stays valid.
 */
fathom_uart_t fathom_posix_uart(fathom_posix_uart_t *port);

/**
 * @brief Returns the error of the newest call that failed on this port, or FATHOM_POSIX_OK if none failed.
 *
 * These calls set it: fathom_posix_open(), fathom_posix_set_line(), fathom_posix_set_rs485(),
 * fathom_posix_line_errors(), `set_line` and `set_break`. `read`, `write`, `sent` and fathom_posix_wait() set it to
 * FATHOM_POSIX_ERR_LOST. Two kinds of failed calls do not set it: calls on a port that is lost already, and
 * fathom_posix_line_errors() with NULL. Only fathom_posix_open() clears it.
 */
fathom_posix_status_t fathom_posix_error(const fathom_posix_uart_t *port);

/**
 * @brief Returns the same error in words: one line without a line feed, such as
 * "/dev/ttyUSB0: permission denied: ...".
 *
 * If nothing has failed, the text is "". The text stands in the port. It is valid until the next call that fails, or
 * until fathom_posix_open().
 */
const char *fathom_posix_error_text(const fathom_posix_uart_t *port);

/** @brief Line errors that the driver has counted since it was loaded. Use differences. The counts may wrap. */
typedef struct {
    /** @brief Bytes with wrong parity. */
    uint32_t parity;
    /** @brief Bytes without a stop bit. The usual cause is another baud rate than that of the device. */
    uint32_t framing;
    /** @brief Losses in the UART, or because the program did not read. */
    uint32_t overrun;
    /** @brief Received breaks. */
    uint32_t breaks;
} fathom_posix_line_errors_t;

/**
 * @brief Reads the line errors that the driver of an open port has counted.
 *
 * @param port    The port.
 * @param errors  Receives the counts, if the result is FATHOM_POSIX_OK.
 * @retval FATHOM_POSIX_OK               `*errors` is set.
 * @retval FATHOM_POSIX_ERR_ARGUMENT     A pointer is NULL.
 * @retval FATHOM_POSIX_ERR_CLOSED       The port is not open.
 * @retval FATHOM_POSIX_ERR_LOST         The port is lost.
 * @retval FATHOM_POSIX_ERR_UNSUPPORTED  The driver does not count. Pseudo terminals do not either.
 */
fathom_posix_status_t fathom_posix_line_errors(fathom_posix_uart_t *port, fathom_posix_line_errors_t *errors);

/** @brief Returns a clock for the HAL: CLOCK_MONOTONIC in microseconds. It wraps as hal.h describes. While the machine
 * is suspended, the clock stands still. */
fathom_clock_t fathom_posix_clock(void);

/**
 * @brief Returns CLOCK_MONOTONIC in microseconds, in 64 bits, which do not wrap. For programs.
 *
 * The low 32 bits are the clock of fathom_posix_clock(), and so of `time_us` of a sample. The age of a sample that is less
 * than 71 minutes old, and the time of the day at which its last byte arrived:
 *
 * @code
 * const uint32_t age_us = (uint32_t)fathom_posix_now_us() - sample.time_us;
 * struct timespec now; // <time.h>
 * clock_gettime(CLOCK_REALTIME, &now);
 * const int64_t unix_us = now.tv_sec * INT64_C(1000000) + now.tv_nsec / 1000 - age_us;
 * @endcode
 */
uint64_t fathom_posix_now_us(void);

/**
 * @brief Sleeps until bytes can be read, the far end has hung up, a signal handler has run, or `max_us` has passed.
 *
 * This is an idle hook for fathom_wait() (wait.h). The port of a bus `bus` is `&bus.port`. The function also returns early if the kernel had space for the rest of a
 * request. If the port is closed or lost, it returns at once: a loop must check the status that the poll functions
 * return, or it uses a whole processor.
 *
 * A signal that arrives directly before the sleep does not shorten it. If a signal handler sets a flag, pass a bounded
 * `max_us`, or call ppoll(2) with fathom_posix_fd(). There is no event for the end of sending. fathom_due_us()
 * therefore returns the time of `leaves_in_us` while a request leaves, and 1 ms after that.
 *
 * @param port    The port, a fathom_posix_uart_t, such as `&bus.port`.
 * @param max_us  Longest sleep in microseconds. FATHOM_NO_DEADLINE: without a limit.
 */
void fathom_posix_wait(void *port, uint32_t max_us);

/**
 * @brief Returns the file descriptor for a poll(2), epoll(7) or select(2) of the program; -1 if the port is closed.
 *
 * Do not read from it or write to it. For several ports use fathom_loop.h. A loop of your own that polls all sensors
 * whenever one port is ready needs about twice the processor time with 32 ports, because nearly all of its reads return
 * nothing. A lost port stays ready: when a poll returns FATHOM_ERR_PORT, close the port, or the loop uses a whole
 * processor.
 */
int fathom_posix_fd(const fathom_posix_uart_t *port);

/** @brief Returns the events of poll(2) to wait for: POLLIN, and also POLLOUT while the port keeps the rest of a
 * request. */
short fathom_posix_poll_events(const fathom_posix_uart_t *port);

/* ---- a port with a line ---- */

/**
 * @brief A tty with a line on it, in the caller's memory: all that a driver needs.
 *
 * Pass `modbus` to the drivers that send Modbus requests, and `line` to those that listen or use the protocol `55 AA`.
 * Several drivers may share one bus. The line is made of parts (line.h) that suit a tty and an unknown adapter: it finds
 * out whether the adapter echoes, names `senders` and `masters`, keeps fathom_silence_us() before a request, ends an
 * incomplete frame after 25 ms, because USB adapters hold bytes back, and counts events in `counters`. A program that needs other parts changes `parts` and
 * calls fathom_line_init() with `&line` and `&parts`, before it initialises a driver.
 *
 * Do not move or copy a bus, because its members point to each other.
 */
typedef struct {
    /** @brief The port. fathom_posix_set_rs485() and fathom_posix_line_errors() may use it. */
    fathom_posix_uart_t port;
    /** @brief The line, initialised. */
    fathom_line_t line;
    /** @brief The Modbus RTU transport over `line`. */
    fathom_modbus_t modbus;
    /** @brief The clock, for drivers that use a pin. */
    fathom_clock_t clock;
    /** @brief The parts of `line`. */
    fathom_line_parts_t parts;
    /** @brief The counters of the line (line.h). The caller may set them to 0. */
    uint16_t counters[FATHOM_LINE_COUNTERS];
    /* private */
    fathom_uart_t uart;
    fathom_line_settings_t settings; /* with which the bus was opened */
    uint8_t frame[255];
} fathom_posix_bus_t;

/**
 * @brief Opens a tty and makes a line of it.
 *
 * @param bus       The bus, with any content. Close an open bus first; otherwise its file descriptor leaks. Drivers of a
 *                  bus that is opened again continue, and the requests that were queued end with FATHOM_ERR_CANCELLED.
 * @param path      Path of the tty, such as "/dev/ttyUSB0". Used only during the call.
 * @param settings  The settings with which the sensors leave the factory (factory_line.h), or those that were set. As for
 *                  fathom_posix_open(). Copied.
 * @return As fathom_posix_open(); FATHOM_POSIX_ERR_ARGUMENT also if `bus` is NULL. If it is not FATHOM_POSIX_OK, the bus
 *         is closed, each driver's init function refuses it with FATHOM_ERR_ARGUMENT, and fathom_posix_bus_error() has
 *         the reason.
 */
fathom_posix_status_t fathom_posix_bus_open(fathom_posix_bus_t *bus, const char *path,
                                            const fathom_line_settings_t *settings);

/** @brief Closes the port of a bus, as fathom_posix_close(). `bus` may be NULL, closed, or all zeros. */
void fathom_posix_bus_close(fathom_posix_bus_t *bus);

/** @brief Returns the newest error of the port in words, as fathom_posix_error_text(). */
const char *fathom_posix_bus_error(const fathom_posix_bus_t *bus);

/**
 * @brief Waits for the next reading or error of a sensor, as fathom_wait(). Uses no processor time while it waits.
 *
 * The driver's header states the longest wait, which is seconds if the sensor does not respond. So use this function for
 * one sensor only. If the bus has several sensors, poll all of them with fathom_poll(), and sleep by
 * fathom_posix_wait() with `&bus.port` and fathom_due_us(): examples/linux/three.c. If the port is closed, or was lost before the call, the call takes
 * one second, so that a program that reads on does not use a whole processor.
 *
 * @param bus     The bus of the sensor.
 * @param sensor  The sensor, such as the result of fathom_hps167s_sensor().
 * @param sample  Written with FATHOM_OK only.
 * @return Any result of fathom_poll() but FATHOM_PENDING. With FATHOM_ERR_PORT, fathom_posix_bus_error() has the reason.
 */
fathom_status_t fathom_posix_bus_read(fathom_posix_bus_t *bus, fathom_sensor_t sensor,
                                      fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
