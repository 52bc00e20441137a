/* SPDX-License-Identifier: MIT */
/*
 * The sleep of a port, and what a program's own poll(2) needs. The sleep ends when bytes arrive, when the port can take
 * the rest of a request, or when the time has passed.
 */
#define _GNU_SOURCE 1 /* ppoll */
#include <poll.h>
#include <time.h>

#include "internal/posix_port.h"

int fathom_posix_fd(const fathom_posix_uart_t *port) { return port->is_open ? port->fd : -1; }

short fathom_posix_poll_events(const fathom_posix_uart_t *port)
{
    return port->pending_at != port->pending_end ? POLLIN | POLLOUT : POLLIN;
}

void fathom_posix_wait(void *ctx, uint32_t max_us)
{
    fathom_posix_uart_t *const port = ctx;
    if (!port->is_open) return;
    fathom_posix_push(port);
    if (port->is_lost) return;

    /* poll(2) counts whole milliseconds, in which a t3.5 of 1.75 ms would become 1 or 2. */
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entry = {port->fd, fathom_posix_poll_events(port), 0};
    if (ppoll(&entry, 1, max_us == FATHOM_NO_DEADLINE ? NULL : &limit, NULL) > 0 &&
        (entry.revents & POLLOUT) != 0)
        fathom_posix_push(port);
    /* `read` reports a hang-up, after the bytes that arrived before it. */
}
