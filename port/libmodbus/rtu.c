/* SPDX-License-Identifier: MIT */
/*
 * The UART functions of the HAL on a modbus_t of RTU. Requests leave through libmodbus; received bytes are read from
 * the descriptor.
 */
#define _DEFAULT_SOURCE 1 /* FIONREAD */
#include <errno.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "internal/libmodbus_port.h"

enum { CRC_LENGTH = 2 };

/* Returns true if one of these events is pending, or if the descriptor has hung up. */
static bool is_ready(int fd, short events)
{
    struct pollfd entry = {fd, events, 0};
    return poll(&entry, 1, 0) > 0;
}

int fathom_libmodbus_rtu_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_libmodbus_t *const port = ctx;
    const int fd = modbus_get_socket(port->handle);
    int waiting = 0;
    (void)rx; /* Nothing is known about single bytes. */
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    if (ioctl(fd, FIONREAD, &waiting) != 0) return fathom_libmodbus_failed(port);
    /* If no byte waits, read(2) could block, unless the descriptor has hung up or bytes arrived just now. poll(2) shows
     * both. */
    if (waiting == 0 && !is_ready(fd, POLLIN)) return 0;
    if (waiting != 0 && (size_t)waiting < capacity) capacity = (size_t)waiting;
    const ssize_t n = read(fd, bytes, capacity);
    if (n < 0) return fathom_libmodbus_failed(port);
    if (n == 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_HUNG_UP);
    fathom_libmodbus_works(port);
    return (int)n;
}

int fathom_libmodbus_rtu_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_libmodbus_t *const port = ctx;
    const int fd = modbus_get_socket(port->handle);
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    if (!is_ready(fd, POLLOUT)) return 0; /* A blocking descriptor would wait here. */
    const int n = modbus_send_raw_request(port->handle, bytes, (int)length - CRC_LENGTH);
    if (n == (int)length) {
        fathom_libmodbus_works(port);
        return n;
    }
    if (n < 0 && errno != EMBBADDATA) return fathom_libmodbus_failed(port);
    return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_TRUNCATED);
}

bool fathom_libmodbus_rtu_sent(void *ctx)
{
    const fathom_libmodbus_t *const port = ctx;
    int leaving = 0;
    /* If the descriptor cannot report this or was closed, nothing waits for it; `read` returns the error. */
    return ioctl(modbus_get_socket(port->handle), TIOCOUTQ, &leaving) != 0 || leaving == 0;
}
