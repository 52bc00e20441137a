/* SPDX-License-Identifier: MIT */
/* The errors of a connection. The first reason is kept until bytes are sent or received again. */
#include <errno.h>

#include "internal/libmodbus_port.h"

int fathom_libmodbus_broken(fathom_libmodbus_t *port, fathom_libmodbus_error_t error)
{
    if (port->error == FATHOM_LIBMODBUS_OK) port->error = (int8_t)error;
    fathom_libmodbus_note_broken(port);
    return -1;
}

int fathom_libmodbus_failed(fathom_libmodbus_t *port)
{
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return 0;
    /* A tty returns these errors if its adapter was unplugged. */
    if (errno == EIO || errno == ENXIO || errno == ENODEV)
        return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_HUNG_UP);
    if (port->error == FATHOM_LIBMODBUS_OK) port->system_error = errno;
    return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_SYSTEM);
}

void fathom_libmodbus_works(fathom_libmodbus_t *port)
{
    port->error = FATHOM_LIBMODBUS_OK;
    port->system_error = 0;
}

fathom_libmodbus_error_t fathom_libmodbus_error(const fathom_libmodbus_t *port)
{
    return (fathom_libmodbus_error_t)port->error;
}
