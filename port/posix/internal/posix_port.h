/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_PORT_H
#define FATHOM_INTERNAL_POSIX_PORT_H

#include "fathom_posix.h"

/* What the files of this port share. In a folder of its own so that it is not installed. */

/* error.c: all set port->error and port->text and return the error. `code` is an errno. */
fathom_posix_status_t fathom_posix_fail(fathom_posix_uart_t *port, fathom_posix_status_t error,
                                        const char *format, ...) __attribute__((format(printf, 3, 4)));
fathom_posix_status_t fathom_posix_fail_system(fathom_posix_uart_t *port, const char *what, int code);
fathom_posix_status_t fathom_posix_fail_open(fathom_posix_uart_t *port, const char *path, int code);
fathom_posix_status_t fathom_posix_fail_lost(fathom_posix_uart_t *port, int code);

/* OK, or fails with CLOSED or LOST. */
fathom_posix_status_t fathom_posix_usable(fathom_posix_uart_t *port);

/* Bits of a character, with its start, parity and stop bits. */
static inline unsigned fathom_posix_bits(const fathom_line_settings_t *line)
{
    return 9u + (line->parity != FATHOM_PARITY_NONE ? 1u : 0u) + line->stop_bits;
}

/* settings.c: OK, or fails with ARGUMENT. */
fathom_posix_status_t fathom_posix_check(fathom_posix_uart_t *port, const fathom_line_settings_t *settings);

/* settings.c: sets the tty and reads it back; on failure what it was before is put back. */
fathom_posix_status_t fathom_posix_apply(fathom_posix_uart_t *port, const fathom_line_settings_t *settings);

/* uart.c: offers the kernel the rest of an accepted write. */
void fathom_posix_push(fathom_posix_uart_t *port);

/* uart.c: OK, or fails with CLOSED, LOST, or BUSY while bytes are leaving. */
fathom_posix_status_t fathom_posix_idle(fathom_posix_uart_t *port);

#endif
