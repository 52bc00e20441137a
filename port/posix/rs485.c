/* SPDX-License-Identifier: MIT */
/*
 * Sets how the driver of the kernel drives an RS-485 transceiver (TIOCSRS485). The setting is read back, and the
 * previous one is restored if the driver did not keep it.
 */
#define _DEFAULT_SOURCE 1 /* the tty ioctls */
#include <errno.h>
#include <linux/serial.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>

#include "internal/posix_port.h"

/* The flags that must be kept: the level of RTS while bytes are sent and otherwise. A driver may add other flags. */
#define LEVELS (SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND | SER_RS485_RTS_AFTER_SEND)

static bool same(const struct serial_rs485 *asked, const struct serial_rs485 *got)
{
    if ((asked->flags & SER_RS485_ENABLED) == 0) return (got->flags & SER_RS485_ENABLED) == 0;
    return (asked->flags & LEVELS) == (got->flags & LEVELS) &&
           asked->delay_rts_before_send == got->delay_rts_before_send &&
           asked->delay_rts_after_send == got->delay_rts_after_send;
}

/* Writes a text like "RTS on while sending, from 1 ms before to 0 ms after". */
static void describe(const struct serial_rs485 *rs485, char *text, size_t capacity)
{
    const char *const sending = (rs485->flags & SER_RS485_RTS_ON_SEND) != 0 ? "on" : "off";
    const bool is_same_after =
        ((rs485->flags & SER_RS485_RTS_ON_SEND) != 0) == ((rs485->flags & SER_RS485_RTS_AFTER_SEND) != 0);
    if ((rs485->flags & SER_RS485_ENABLED) == 0)
        (void)snprintf(text, capacity, "RTS left alone");
    else
        (void)snprintf(text, capacity, "RTS %s while sending%s, from %lu ms before to %lu ms after", sending,
                       is_same_after ? " and otherwise" : "", (unsigned long)rs485->delay_rts_before_send,
                       (unsigned long)rs485->delay_rts_after_send);
}

static fathom_posix_status_t fail(fathom_posix_uart_t *port, int code)
{
    if (code == ENOTTY)
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_UNSUPPORTED,
                                 "the driver of this port does not drive an RS-485 transceiver by RTS; use a "
                                 "UART whose driver does (TIOCSRS485), or an adapter that turns round by "
                                 "itself, and leave RS-485 to it");
    return fathom_posix_fail_system(port, "setting RS-485", code);
}

static fathom_posix_status_t apply(fathom_posix_uart_t *port, const struct serial_rs485 *asked)
{
    struct serial_rs485 before;
    memset(&before, 0, sizeof before);
    if (ioctl(port->fd, TIOCGRS485, &before) != 0) return fail(port, errno);
    struct serial_rs485 given = *asked; /* the kernel writes to it */
    if (ioctl(port->fd, TIOCSRS485, &given) != 0) return fail(port, errno);

    struct serial_rs485 got;
    memset(&got, 0, sizeof got);
    const int code = ioctl(port->fd, TIOCGRS485, &got) != 0 ? errno : 0;
    if (code == 0 && same(asked, &got)) return FATHOM_POSIX_OK;
    (void)ioctl(port->fd, TIOCSRS485, &before);
    if (code != 0) return fail(port, code);
    char asked_text[96];
    char got_text[96];
    describe(asked, asked_text, sizeof asked_text);
    describe(&got, got_text, sizeof got_text);
    return fathom_posix_fail(port, FATHOM_POSIX_ERR_REFUSED,
                             "RS-485 refused: asked for %s, the driver set %s", asked_text, got_text);
}

fathom_posix_status_t fathom_posix_set_rs485(fathom_posix_uart_t *port, const fathom_posix_rs485_t *rs485)
{
    if (port == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    const fathom_posix_status_t status = fathom_posix_idle(port);
    if (status != FATHOM_POSIX_OK) return status;
    struct serial_rs485 asked;
    memset(&asked, 0, sizeof asked);
    if (rs485 != NULL) {
        asked.flags =
            SER_RS485_ENABLED | (rs485->rts_off_to_send ? SER_RS485_RTS_AFTER_SEND : SER_RS485_RTS_ON_SEND);
        asked.delay_rts_before_send = rs485->before_ms;
        asked.delay_rts_after_send = rs485->after_ms;
    }
    return apply(port, &asked);
}
