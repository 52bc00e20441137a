/* SPDX-License-Identifier: MIT */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "shared/tcp.h"

tcp_t *tcp_open(const char *path, fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    (void)uart;
    memset(port, 0, sizeof *port);
    port->error = FATHOM_POSIX_ERR_UNSUPPORTED;
    (void)snprintf(
        port->text, sizeof port->text,
        "%.100s: this fathom was built without libmodbus, which tcp: needs; install libmodbus-dev and "
        "build it again",
        path);
    return NULL;
}

void tcp_close(tcp_t *tcp) { (void)tcp; }

uint8_t tcp_gateway_exception(const tcp_t *tcp)
{
    (void)tcp;
    return 0;
}
