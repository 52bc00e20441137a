/* SPDX-License-Identifier: MIT */
/*
 * The errors of a port: each function stores an error and its text in the port and returns the error. The texts name
 * what failed, why, and what to try.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

#include "internal/describe.h"
#include "internal/posix_port.h"

fathom_posix_status_t fathom_posix_error(const fathom_posix_uart_t *port) { return port->error; }

const char *fathom_posix_error_text(const fathom_posix_uart_t *port) { return port->text; }

fathom_posix_status_t fathom_posix_fail(fathom_posix_uart_t *port, fathom_posix_status_t error,
                                        const char *format, ...)
{
    va_list arguments;
    /* The path is far shorter than the text, so `head` is less than the size. */
    const int head =
        snprintf(port->text, sizeof port->text, "%s: ", port->path[0] != 0 ? port->path : "serial port");
    va_start(arguments, format);
    /* clang-tidy 14 forgets the line above when it checks several files. */
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    (void)vsnprintf(port->text + head, sizeof port->text - (size_t)head, format, arguments);
    va_end(arguments);
    port->error = error;
    return error;
}

fathom_posix_status_t fathom_posix_fail_lost(fathom_posix_uart_t *port, int code)
{
    char text[80];
    port->is_lost = true;
    return fathom_posix_fail(port, FATHOM_POSIX_ERR_LOST,
                             "the device was unplugged or its far end closed (%s)",
                             code != 0 ? fathom_posix_words(code, text, sizeof text) : "hang-up");
}

fathom_posix_status_t fathom_posix_fail_system(fathom_posix_uart_t *port, const char *what, int code)
{
    char text[80];
    const bool is_gone = code == EIO || code == ENXIO || code == ENODEV;
    if (is_gone && port->is_open) return fathom_posix_fail_lost(port, code);
    if (is_gone)
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_NOT_FOUND,
                                 "%s: %s: there is no UART behind this name, or it was unplugged", what,
                                 fathom_posix_words(code, text, sizeof text));
    return fathom_posix_fail(port, FATHOM_POSIX_ERR_SYSTEM, "%s: %s", what,
                             fathom_posix_words(code, text, sizeof text));
}

fathom_posix_status_t fathom_posix_usable(fathom_posix_uart_t *port)
{
    if (!port->is_open) return fathom_posix_fail(port, FATHOM_POSIX_ERR_CLOSED, "the port is not open");
    return port->is_lost ? FATHOM_POSIX_ERR_LOST : FATHOM_POSIX_OK;
}

static fathom_posix_status_t fail_permission(fathom_posix_uart_t *port, const char *path)
{
    char text[sizeof port->text];
    return fathom_posix_fail(port, FATHOM_POSIX_ERR_PERMISSION, "%s",
                             fathom_posix_describe_denied(path, "dialout", text, sizeof text));
}

fathom_posix_status_t fathom_posix_fail_open(fathom_posix_uart_t *port, const char *path, int code)
{
    switch (code) {
    case ENOENT:
    case ENOTDIR:
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_NOT_FOUND,
                                 "no such device; is it plugged in? /dev/serial/by-id lists what is%s",
                                 path[0] == '/' || path[0] == '.' ? "" : ", and a path begins with /dev/");
    case ENXIO:
    case ENODEV:
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_NOT_FOUND, "there is no device behind this name");
    case EACCES:
    case EPERM:
        return fail_permission(port, path);
    case EBUSY:
    case EWOULDBLOCK:
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_IN_USE,
                                 "in use by another program; `fuser -v %s` tells which", port->path);
    case ENOTTY:
    case EISDIR:
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_NOT_A_TTY, "not a serial port");
    default:
        return fathom_posix_fail_system(port, "opening it", code);
    }
}
