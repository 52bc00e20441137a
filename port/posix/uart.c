/* SPDX-License-Identifier: MIT */
/*
 * Opens and closes a tty, and has the UART functions of the HAL on it. The port keeps the part of a request that the
 * kernel has not accepted, and passes it on with the next call.
 */
#define _DEFAULT_SOURCE 1 /* flock, major, the tty ioctls */
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include "internal/posix_port.h"

/* Linux, Documentation/admin-guide/devices.txt: Unix98 pseudo terminal slaves. */
enum { PTY_MAJOR_FIRST = 136, PTY_MAJOR_LAST = 143 };

static uint64_t duration_us(const fathom_line_settings_t *line, size_t length)
{
    return ((uint64_t)length * fathom_character_bits(line) * 1000000u + line->baud - 1) / line->baud;
}

/* Passes bytes to the kernel. Returns the number of bytes that it accepted, or -1 if the port is lost. */
static int hand_over(fathom_posix_uart_t *port, const uint8_t *bytes, size_t length)
{
    ssize_t n;
    do n = write(port->fd, bytes, length);
    while (n < 0 && errno == EINTR);
    if (n < 0 && errno == EAGAIN) return 0;
    if (n < 0) {
        (void)fathom_posix_fail_lost(port, errno);
        return -1;
    }
    const uint64_t now_us = fathom_posix_now_us();
    if (port->leaving_until_us < now_us) port->leaving_until_us = now_us;
    port->leaving_until_us += duration_us(&port->line, (size_t)n);
    return (int)n;
}

void fathom_posix_push(fathom_posix_uart_t *port)
{
    if (port->pending_at == port->pending_end || port->is_lost) return;
    const int n = hand_over(port, port->pending + port->pending_at, port->pending_end - port->pending_at);
    if (n > 0) port->pending_at += (size_t)n;
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_posix_uart_t *const port = ctx;
    (void)rx;
    if (!port->is_open || port->is_lost) return -1;
    fathom_posix_push(port);
    if (port->is_lost) return -1;
    if (capacity == 0) return 0; /* A read(2) of 0 bytes would look like a hang-up. */
    if (capacity > INT16_MAX) capacity = INT16_MAX;

    ssize_t n;
    do n = read(port->fd, bytes, capacity);
    while (n < 0 && errno == EINTR);
    if (n > 0) return (int)n;
    if (n < 0 && errno == EAGAIN) return 0;
    (void)fathom_posix_fail_lost(port, n < 0 ? errno : 0);
    return -1;
}

static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_posix_uart_t *const port = ctx;
    if (!port->is_open || port->is_lost || length > FATHOM_POSIX_WRITE_MAX) return -1;
    fathom_posix_push(port);
    if (port->is_lost) return -1;
    if (port->pending_at != port->pending_end || length == 0) return 0;

    const int n = hand_over(port, bytes, length);
    if (n <= 0) return n;
    port->pending_at = 0;
    port->pending_end = length - (size_t)n;
    memcpy(port->pending, bytes + n, port->pending_end);
    return (int)length;
}

static bool is_sent(fathom_posix_uart_t *port)
{
    if (!port->is_open || port->is_lost) return true;
    fathom_posix_push(port);
    if (port->is_lost) return true;
    if (port->pending_at != port->pending_end || fathom_posix_now_us() < port->leaving_until_us) return false;

    int queued = 0;
    if (ioctl(port->fd, TIOCOUTQ, &queued) != 0) {
        (void)fathom_posix_fail_lost(port, errno);
        return true;
    }
    if (queued != 0) return false;
    if (port->has_no_lsr) return true;
    int status = 0;
    if (ioctl(port->fd, TIOCSERGETLSR, &status) == 0) return (status & TIOCSER_TEMT) != 0;
    port->has_no_lsr = true; /* If the device was unplugged, `read` will report it. */
    return true;
}

static bool uart_sent(void *ctx) { return is_sent(ctx); }

static uint32_t uart_leaves_in_us(void *ctx)
{
    const fathom_posix_uart_t *const port = ctx;
    /* If the kernel has not accepted all bytes, the caller must poll soon, so that the port offers the rest. */
    if (!port->is_open || port->is_lost || port->pending_at != port->pending_end) return 0;
    const uint64_t now_us = fathom_posix_now_us();
    return now_us < port->leaving_until_us ? (uint32_t)(port->leaving_until_us - now_us) : 0;
}

fathom_posix_status_t fathom_posix_idle(fathom_posix_uart_t *port)
{
    /* is_sent() comes first, because it finds a port that was lost just now. */
    const bool sent = is_sent(port);
    const fathom_posix_status_t status = fathom_posix_usable(port);
    if (status != FATHOM_POSIX_OK || sent) return status;
    return fathom_posix_fail(port, FATHOM_POSIX_ERR_BUSY, "bytes are still leaving");
}

fathom_posix_status_t fathom_posix_set_line(fathom_posix_uart_t *port, const fathom_line_settings_t *settings)
{
    if (port == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    if (settings == NULL) return fathom_posix_fail(port, FATHOM_POSIX_ERR_ARGUMENT, "no settings were given");
    const fathom_posix_status_t status = fathom_posix_idle(port);
    return status == FATHOM_POSIX_OK ? fathom_posix_apply(port, settings) : status;
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fathom_posix_uart_t *const port = ctx;
    const fathom_line_settings_t *const line = &port->line;
    if (line->baud == settings->baud && line->parity == settings->parity &&
        line->stop_bits == settings->stop_bits)
        return 1;
    const fathom_posix_status_t status = fathom_posix_set_line(port, settings);
    if (status == FATHOM_POSIX_ERR_BUSY) return 0;
    return status == FATHOM_POSIX_OK ? 1 : -1;
}

/* What a driver reports that does not have this ioctl(2). */
static bool is_unsupported(int code)
{
    return code == ENOTTY || code == EINVAL || code == EOPNOTSUPP || code == ENOSYS;
}

static int uart_set_break(void *ctx, bool on)
{
    fathom_posix_uart_t *const port = ctx;
    if (fathom_posix_usable(port) != FATHOM_POSIX_OK) return -1;
    if (!is_sent(port)) return 0;
    /* A pseudo terminal has no wire to hold low. A received break reads as a byte 0 (termios(3), without BRKINT and
     * PARMRK), so the port writes such a byte. */
    if (port->is_pty) return on ? uart_write(ctx, (const uint8_t[]){0}, 1) : 1;
    if (ioctl(port->fd, on ? TIOCSBRK : TIOCCBRK) == 0) return 1;
    if (is_unsupported(errno))
        (void)fathom_posix_fail(port, FATHOM_POSIX_ERR_UNSUPPORTED,
                                "the driver of this port cannot send a break; use another adapter");
    else
        (void)fathom_posix_fail_system(port, "sending a break", errno);
    return -1;
}

fathom_uart_t fathom_posix_uart(fathom_posix_uart_t *port)
{
    const fathom_uart_t uart = {.read = uart_read,
                                .write = uart_write,
                                .sent = uart_sent,
                                .set_line = uart_set_line,
                                .set_break = uart_set_break,
                                .leaves_in_us = uart_leaves_in_us,
                                .ctx = port};
    return uart;
}

/* Sets up the tty after open(2): checks that it is one, locks it, applies the settings, and discards old bytes. */
static fathom_posix_status_t take(fathom_posix_uart_t *port, const char *path,
                                  const fathom_line_settings_t *settings)
{
    struct stat status;
    struct termios tty;
    if (fstat(port->fd, &status) != 0) return fathom_posix_fail_open(port, path, errno);
    if (tcgetattr(port->fd, &tty) != 0) {
        return errno == ENOTTY || errno == EINVAL
                   ? fathom_posix_fail_open(port, path, ENOTTY)
                   : fathom_posix_fail_system(port, "reading its settings", errno);
    }
    const unsigned device = major(status.st_rdev);
    /* A tty is a character device, so st_rdev is its number. */
    port->is_pty = device >= PTY_MAJOR_FIRST && device <= PTY_MAJOR_LAST;

    if (flock(port->fd, LOCK_EX | LOCK_NB) != 0) return fathom_posix_fail_open(port, path, errno);
    /* TIOCEXCL belongs to the tty and ends with its last close. The master of a pseudo terminal delays that close. */
    if (!port->is_pty && ioctl(port->fd, TIOCEXCL) != 0)
        return fathom_posix_fail_system(port, "taking it for this program alone", errno);

    const fathom_posix_status_t result = fathom_posix_apply(port, settings);
    if (result != FATHOM_POSIX_OK) return result;
    if (tcflush(port->fd, TCIFLUSH) != 0) return fathom_posix_fail_system(port, "flushing it", errno);
    return FATHOM_POSIX_OK;
}

fathom_posix_status_t fathom_posix_open(fathom_posix_uart_t *port, const char *path,
                                        const fathom_line_settings_t *settings)
{
    if (port == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    memset(port, 0, sizeof *port);
    port->fd = -1;
    if (path == NULL || settings == NULL)
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_ARGUMENT, "no path or no settings were given");
    strncpy(port->path, path, sizeof port->path - 1);

    /* Without O_NONBLOCK, open(2) waits on a tty that waits for DCD (the line of a modem). */
    do port->fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    while (port->fd < 0 && errno == EINTR);
    if (port->fd < 0) return fathom_posix_fail_open(port, path, errno);

    const fathom_posix_status_t result = take(port, path, settings);
    if (result != FATHOM_POSIX_OK) {
        (void)close(port->fd);
        port->fd = -1;
        return result;
    }
    port->is_open = true;
    return FATHOM_POSIX_OK;
}

void fathom_posix_close(fathom_posix_uart_t *port)
{
    if (port == NULL || !port->is_open) return;
    /* If a child or another program has the tty open too, this is not the last close. */
    if (!port->is_pty) (void)ioctl(port->fd, TIOCNXCL);
    (void)close(port->fd); /* After EINTR Linux has closed the descriptor too. */
    port->fd = -1;
    port->is_open = false;
}

fathom_posix_status_t fathom_posix_line_errors(fathom_posix_uart_t *port, fathom_posix_line_errors_t *errors)
{
    if (port == NULL || errors == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    const fathom_posix_status_t status = fathom_posix_usable(port);
    if (status != FATHOM_POSIX_OK) return status;
    struct serial_icounter_struct counts;
    memset(&counts, 0, sizeof counts);
    if (ioctl(port->fd, TIOCGICOUNT, &counts) != 0) {
        if (!is_unsupported(errno)) return fathom_posix_fail_lost(port, errno);
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_UNSUPPORTED, "this port does not count line errors");
    }
    errors->parity = (uint32_t)counts.parity;
    errors->framing = (uint32_t)counts.frame;
    errors->overrun = (uint32_t)counts.overrun + (uint32_t)counts.buf_overrun;
    errors->breaks = (uint32_t)counts.brk;
    return FATHOM_POSIX_OK;
}
