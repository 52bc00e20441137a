/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_POSIX_RIG_H
#define FATHOM_TESTS_POSIX_RIG_H

#include <termios.h>

#include "suite.h"

#include "fathom_posix.h"
#include "posix_pty.h"

/* A port on a pseudo terminal. */
typedef struct {
    posix_pty_t pty;
    fathom_posix_uart_t port;
    fathom_uart_t uart;
} port_rig_t;

static port_rig_t rig;

static const fathom_line_settings_t port_rig_fast = {230400, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t usual = {9600, FATHOM_PARITY_NONE, 1};

static inline fathom_posix_status_t open_with(const fathom_line_settings_t *settings)
{
    return fathom_posix_open(&rig.port, rig.pty.path, settings);
}
static inline void port_rig_open(void) { assert_int_equal(open_with(&port_rig_fast), FATHOM_POSIX_OK); }

/* cmocka's fixtures. The port is closed. */
static inline int port_rig_set_up(void **state)
{
    memset(&rig, 0, sizeof rig);
    posix_pty_open(&rig.pty);
    rig.uart = fathom_posix_uart(&rig.port);
    return 0;
}

/* The port is open with port_rig_fast. */
static inline int port_rig_set_up_open(void **state)
{
    (void)port_rig_set_up(state);
    memset(&rig.port, 0xA5, sizeof rig.port); /* any content will do */
    port_rig_open();
    return 0;
}

static inline int port_rig_tear_down(void **state)
{
    fathom_posix_close(&rig.port);
    posix_pty_close(&rig.pty);
    return 0;
}

#define PORT_RIG_SUITE(its_set_up)                                                                           \
    {                                                                                                        \
        .set_up = (its_set_up), .tear_down = port_rig_tear_down, .begin_round = posix_start_watchdog         \
    }

/* As the other end of the pseudo terminal sees it. */
static inline speed_t port_rig_speed(void)
{
    struct termios seen;
    assert_int_equal(tcgetattr(rig.pty.master, &seen), 0);
    return cfgetospeed(&seen);
}

static inline int port_rig_read(void *bytes, size_t capacity)
{
    fathom_rx_t rx = {0, 0};
    const int n = rig.uart.read(rig.uart.ctx, bytes, capacity, &rx);
    assert_int_equal(rx.flags, 0);
    return n;
}

static inline int port_rig_write(const void *bytes, size_t length)
{
    return rig.uart.write(rig.uart.ctx, bytes, length);
}

static inline bool port_rig_sent(void) { return rig.uart.sent(rig.uart.ctx); }
static inline uint32_t port_rig_leaves_in_us(void) { return rig.uart.leaves_in_us(rig.uart.ctx); }

/* Once more, with a byte that is thrown away: what is looked at is the status. */
static inline int port_rig_read_one(void)
{
    uint8_t byte;
    return port_rig_read(&byte, 1);
}
static inline int port_rig_write_one(void) { return port_rig_write("x", 1); }

/* Fails the test unless the port's error text contains `text`. */
static inline void port_rig_says(const char *text)
{
    if (strstr(fathom_posix_error_text(&rig.port), text) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", fathom_posix_error_text(&rig.port), text);
}

#endif
