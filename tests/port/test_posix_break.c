/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "posix_driver.h"
#include "posix_rig.h"

/* set_break: the trigger of modules whose RX pin is our TX. The driver is posix_driver.h's. */

static fathom_uart_t open_wire(void)
{
    driver.is_8250 = true;
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    return fathom_posix_uart(&rig.port);
}

TEST(a_break_begins_and_ends_when_it_is_told_to)
{
    const fathom_uart_t uart = open_wire();
    assert_int_equal(uart.set_break(uart.ctx, true), 1);
    assert_int_equal(driver.breaks, 1);
    assert_int_equal(uart.set_break(uart.ctx, false), 1);
    assert_int_equal(driver.breaks, 0);
}

TEST(bytes_that_are_leaving_come_first)
{
    const fathom_uart_t uart = open_wire();
    driver.queued = 3;
    assert_int_equal(uart.set_break(uart.ctx, true), 0);
    assert_int_equal(driver.break_calls, 0);
    driver.queued = 0;
    assert_int_equal(uart.set_break(uart.ctx, true), 1);
}

TEST(a_device_that_has_gone_is_a_broken_port)
{
    const fathom_uart_t uart = open_wire();
    driver.break_error = EIO;
    assert_int_equal(uart.set_break(uart.ctx, true), -1);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
    driver.break_error = 0;
    assert_int_equal(uart.set_break(uart.ctx, true), -1); /* until it is opened again */
    assert_int_equal(driver.break_calls, 1);
}

/* The usb-serial core of Linux returns ENOTTY for an adapter whose driver has no break_ctl. */
TEST(a_driver_without_breaks_is_not_a_lost_port)
{
    static const int errors[] = {ENOTTY, EINVAL, EOPNOTSUPP, ENOSYS};
    for (size_t i = 0; i != sizeof errors / sizeof *errors; i++) {
        const fathom_uart_t uart = open_wire();
        uint8_t byte = 0;
        fathom_rx_t rx = {0, 0};
        driver.break_error = errors[i];
        assert_int_equal(uart.set_break(uart.ctx, true), -1);
        assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_UNSUPPORTED);
        assert_non_null(strstr(fathom_posix_error_text(&rig.port), "break"));
        assert_int_equal(uart.read(uart.ctx, &byte, 1, &rx), 0);
        assert_int_equal(uart.write(uart.ctx, (const uint8_t[]){0x55}, 1), 1);
        fathom_posix_close(&rig.port);
    }
}

TEST(a_break_that_fails_once_is_not_a_lost_port)
{
    const fathom_uart_t uart = open_wire();
    driver.break_error = ETIMEDOUT;
    assert_int_equal(uart.set_break(uart.ctx, true), -1);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_SYSTEM);
    driver.break_error = 0;
    assert_int_equal(uart.set_break(uart.ctx, true), 1);
}

TEST(a_port_that_is_closed_is_broken_too)
{
    const fathom_uart_t uart = open_wire();
    fathom_posix_close(&rig.port);
    assert_int_equal(uart.set_break(uart.ctx, true), -1);
}

TEST(on_a_pseudo_terminal_a_zero_stands_for_it)
{
    uint8_t bytes[4] = {0xA5, 0xA5, 0xA5, 0xA5};
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    const fathom_uart_t uart = fathom_posix_uart(&rig.port);
    assert_int_equal(uart.set_break(uart.ctx, true), 1);
    assert_int_equal(posix_pty_receive(&rig.pty, bytes, sizeof bytes), 1);
    assert_int_equal(bytes[0], 0);
    while (!uart.sent(uart.ctx)) continue;
    assert_int_equal(uart.set_break(uart.ctx, false), 1);
    assert_int_equal(driver.break_calls, 0);
}

EACH_BEGINS((posix_driver_reset(), (void)port_rig_set_up(state)))
static const suite_t suite = PORT_RIG_SUITE(begins);
