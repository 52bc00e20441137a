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

/* Is one of these events there, or has it hung up? */
static bool is_ready(int fd, short events)
{
    struct pollfd entry = {fd, events, 0};
    return poll(&entry, 1, 0) > 0;
}

int fathom_libmodbus_rtu_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_libmodbus_t *const port = ctx;
    const int fd = modbus_get_socket(port->modbus);
    int waiting = 0;
    (void)rx; /* nothing is known of single bytes */
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    if (ioctl(fd, FIONREAD, &waiting) != 0) return fathom_libmodbus_failed(port);
    /* Nothing is waiting: unless it has hung up, which read tells, or bytes have come in this moment. Then read does
     * not wait either. */
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
    const int fd = modbus_get_socket(port->modbus);
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    if (!is_ready(fd, POLLOUT)) return 0; /* a descriptor that waits would */
    const int n = modbus_send_raw_request(port->modbus, bytes, (int)length - CRC_LENGTH);
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
    /* What cannot tell, or is not there any more, is not waited for; read says so. */
    return ioctl(modbus_get_socket(port->modbus), TIOCOUTQ, &leaving) != 0 || leaving == 0;
}
