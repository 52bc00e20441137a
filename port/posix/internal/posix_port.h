/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_PORT_H
#define FATHOM_INTERNAL_POSIX_PORT_H

#include "fathom_posix.h"

/* The functions that the files of this port share. Headers in this folder are not installed. */

/* error.c: each function sets port->error and port->text and returns the error. `code` is an errno. */
fathom_posix_status_t fathom_posix_fail(fathom_posix_uart_t *port, fathom_posix_status_t error,
                                        const char *format, ...) __attribute__((format(printf, 3, 4)));
fathom_posix_status_t fathom_posix_fail_system(fathom_posix_uart_t *port, const char *what, int code);
fathom_posix_status_t fathom_posix_fail_open(fathom_posix_uart_t *port, const char *path, int code);
fathom_posix_status_t fathom_posix_fail_lost(fathom_posix_uart_t *port, int code);

/* error.c: returns FATHOM_POSIX_OK, _ERR_CLOSED or _ERR_LOST. */
fathom_posix_status_t fathom_posix_usable(fathom_posix_uart_t *port);

/* settings.c: returns FATHOM_POSIX_OK or _ERR_ARGUMENT. */
fathom_posix_status_t fathom_posix_check(fathom_posix_uart_t *port, const fathom_line_settings_t *settings);

/* settings.c: sets the tty and reads the settings back. If this fails, the previous settings are restored. */
fathom_posix_status_t fathom_posix_apply(fathom_posix_uart_t *port, const fathom_line_settings_t *settings);

/* uart.c: offers the rest of an accepted write to the kernel. */
void fathom_posix_push(fathom_posix_uart_t *port);

/* uart.c: returns FATHOM_POSIX_OK, _ERR_CLOSED, _ERR_LOST, or _ERR_BUSY while bytes are being sent. */
fathom_posix_status_t fathom_posix_idle(fathom_posix_uart_t *port);

/* bus.c: makes the line of a bus whose port has these settings. `uart` is that of the port, perhaps wrapped. */
void fathom_posix_bus_set_up(fathom_posix_bus_t *bus, const fathom_uart_t *uart,
                             const fathom_line_settings_t *settings);

#endif
