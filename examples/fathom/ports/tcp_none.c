/* SPDX-License-Identifier: MIT */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "ports/tcp.h"

tcp_t *tcp_begin(const char *path, unsigned turn, fathom_posix_uart_t *port)
{
    (void)turn;
    memset(port, 0, sizeof *port);
    port->error = FATHOM_POSIX_ERR_UNSUPPORTED;
    (void)snprintf(
        port->text, sizeof port->text,
        "%.100s: this fathom was built without libmodbus, which tcp: needs; install libmodbus-dev and "
        "build it again",
        path);
    return NULL;
}

tcp_t *tcp_open(const char *path, fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    (void)uart;
    return tcp_begin(path, 0, port);
}

fathom_status_t tcp_go_on(tcp_t *tcp, fathom_uart_t *uart)
{
    (void)tcp;
    (void)uart;
    return FATHOM_ERR_PORT;
}

void tcp_close(tcp_t *tcp) { (void)tcp; }

uint8_t tcp_gateway_exception(const tcp_t *tcp)
{
    (void)tcp;
    return 0;
}
