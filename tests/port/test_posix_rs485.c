/* SPDX-License-Identifier: MIT */
#include <errno.h>

#include "posix_driver.h"
#include "posix_rig.h"

/* What the driver does to the wire. fathom_posix_set_rs485: it turns the transceiver round. set_break: the trigger of
 * modules whose RX pin is our TX. The driver here is posix_driver.h's. */

/* linux/serial.h, as numbers: enabled, RTS on while sending, RTS on otherwise. */
enum { ENABLED = 1, ON_SEND = 2, AFTER_SEND = 4, RX_DURING_TX = 16 };

static const fathom_posix_rs485_t with_delays = {.before_ms = 1, .after_ms = 2};

static void open_wire(void)
{
    driver.is_8250 = true;
    driver.has_rs485 = true;
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
}

static void set_fails(const fathom_posix_rs485_t *rs485, fathom_posix_status_t error)
{
    assert_int_equal(fathom_posix_set_rs485(&rig.port, rs485), error);
    assert_int_equal(fathom_posix_error(&rig.port), error);
}

static void driver_has(uint32_t flags, uint32_t before_ms, uint32_t after_ms)
{
    assert_int_equal(driver.rs485.flags, flags);
    assert_int_equal(driver.rs485.delay_rts_before_send, before_ms);
    assert_int_equal(driver.rs485.delay_rts_after_send, after_ms);
}

TEST(the_driver_is_told_the_level_and_the_delays)
{
    open_wire();
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
    driver_has(ENABLED | ON_SEND, 1, 2);
    const fathom_posix_rs485_t other_way = {.rts_off_to_send = true, .before_ms = 3};
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &other_way), FATHOM_POSIX_OK);
    driver_has(ENABLED | AFTER_SEND, 3, 0);
    assert_int_equal(fathom_posix_set_rs485(&rig.port, NULL), FATHOM_POSIX_OK);
    driver_has(0, 0, 0);
}

TEST(it_is_kept_when_the_line_changes)
{
    open_wire();
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
    assert_int_equal(fathom_posix_set_line(&rig.port, &port_rig_fast), FATHOM_POSIX_OK);
    driver_has(ENABLED | ON_SEND, 1, 2);
    assert_int_equal(driver.rs485_sets, 1);
}

TEST(a_driver_that_has_none_says_what_to_do)
{
    open_wire();
    driver.has_rs485 = false;
    set_fails(&with_delays, FATHOM_POSIX_ERR_UNSUPPORTED);
    port_rig_says("does not drive an RS-485 transceiver by RTS; use a UART whose driver does");
    driver.has_rs485 = true; /* one that tells and does not set, as the 8250s of a PC */
    driver.rs485_error = ENOTTY;
    set_fails(&with_delays, FATHOM_POSIX_ERR_UNSUPPORTED);
    assert_int_equal(port_rig_write_one(), 1); /* the port goes on */
}

TEST(what_a_driver_made_of_it_is_told_and_taken_back)
{
    open_wire();
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
    driver.rs485_delay_most = 100;
    const fathom_posix_rs485_t slow_before = {.before_ms = 101, .after_ms = 100};
    set_fails(&slow_before, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for RTS on while sending, from 101 ms before to 100 ms after, "
                  "the driver set RTS on while sending, from 100 ms before to 100 ms after");
    driver_has(ENABLED | ON_SEND, 1, 2);
    const fathom_posix_rs485_t slow_after = {.rts_off_to_send = true, .before_ms = 100, .after_ms = 101};
    set_fails(&slow_after, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for RTS off while sending, from 100 ms before to 101 ms after");
    driver_has(ENABLED | ON_SEND, 1, 2);
}

TEST(a_level_that_was_not_kept_is_refused)
{
    open_wire();
    driver.rs485_drops = ON_SEND;
    set_fails(&with_delays, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("the driver set RTS off while sending and otherwise, from 1 ms before to 2 ms after");
    driver.rs485_drops = ENABLED;
    set_fails(&with_delays, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("the driver set RTS left alone");
    driver_has(0, 0, 0);
}

TEST(whether_it_hears_itself_is_left_to_the_driver)
{
    open_wire();
    driver.rs485_adds = RX_DURING_TX; /* a driver that cannot help it */
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
    driver_has(ENABLED | ON_SEND | RX_DURING_TX, 1, 2);
}

TEST(a_driver_that_goes_on_after_all_is_refused)
{
    open_wire();
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
    driver.rs485_adds = ENABLED | ON_SEND;
    set_fails(NULL, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says(
        "asked for RTS left alone, the driver set RTS on while sending, from 0 ms before to 0 ms after");
    driver.rs485_adds = ENABLED;
    set_fails(NULL, FATHOM_POSIX_ERR_REFUSED);
}

/* Which level it had before is of no use to one that is left alone. */
TEST(a_driver_that_stops_and_keeps_its_levels_has_stopped)
{
    open_wire();
    driver.rs485_adds = ON_SEND | AFTER_SEND;
    assert_int_equal(fathom_posix_set_rs485(&rig.port, NULL), FATHOM_POSIX_OK);
    driver_has(ON_SEND | AFTER_SEND, 0, 0);
}

TEST(a_driver_that_does_not_take_it_is_told_with_the_systems_words)
{
    open_wire();
    driver.rs485_error = EINVAL;
    set_fails(&with_delays, FATHOM_POSIX_ERR_SYSTEM);
    port_rig_says("setting RS-485: Invalid argument");
}

TEST(a_device_that_goes_is_lost_before_meanwhile_and_after)
{
    for (int after = 0; after <= 1; after++) {
        open_wire();
        driver.rs485_get_error = EIO;
        driver.rs485_get_error_after = after;
        set_fails(&with_delays, FATHOM_POSIX_ERR_LOST);
        assert_true(port_rig_read_one() < 0);
        assert_int_equal(driver.rs485_sets, 2 * after); /* none, or it and what was before */
        fathom_posix_close(&rig.port);
        driver.rs485_get_error = 0;
    }
    open_wire();
    driver.rs485_error = ENODEV;
    set_fails(&with_delays, FATHOM_POSIX_ERR_LOST);
    driver.rs485_error = 0;
    set_fails(&with_delays, FATHOM_POSIX_ERR_LOST); /* until it is opened again */
}

/* Also where that is to be nothing, which is what a read that failed seems to have brought. */
TEST(what_cannot_be_read_back_is_taken_back)
{
    static const fathom_posix_rs485_t *const asked[] = {&with_delays, NULL};
    open_wire();
    const fathom_posix_rs485_t before = {.before_ms = 7, .after_ms = 8};
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &before), FATHOM_POSIX_OK);
    for (unsigned i = 0; i != 2; i++) {
        driver.rs485_get_error = EINVAL;
        driver.rs485_get_error_after = 1;
        set_fails(asked[i], FATHOM_POSIX_ERR_SYSTEM);
        port_rig_says("setting RS-485: Invalid argument");
        driver_has(ENABLED | ON_SEND, 7, 8);
    }
}

TEST(bytes_that_are_leaving_come_before_rs485)
{
    open_wire();
    driver.queued = 1;
    set_fails(&with_delays, FATHOM_POSIX_ERR_BUSY);
    assert_int_equal(driver.rs485_sets, 0);
    driver.queued = 0;
    assert_int_equal(fathom_posix_set_rs485(&rig.port, &with_delays), FATHOM_POSIX_OK);
}

TEST(a_port_that_is_closed_or_none_is_not_set)
{
    assert_int_equal(fathom_posix_set_rs485(NULL, &with_delays), FATHOM_POSIX_ERR_ARGUMENT);
    open_wire();
    fathom_posix_close(&rig.port);
    set_fails(&with_delays, FATHOM_POSIX_ERR_CLOSED);
    assert_int_equal(driver.rs485_sets, 0);
}

/* ---- breaks ---- */

static int set_break(bool on) { return rig.uart.set_break(rig.uart.ctx, on); }

TEST(a_break_begins_and_ends_when_it_is_told_to)
{
    open_wire();
    assert_int_equal(set_break(true), 1);
    assert_int_equal(driver.breaks, 1);
    assert_int_equal(set_break(false), 1);
    assert_int_equal(driver.breaks, 0);
}

TEST(bytes_that_are_leaving_come_before_a_break)
{
    open_wire();
    driver.queued = 3;
    assert_int_equal(set_break(true), 0);
    assert_int_equal(driver.break_calls, 0);
    driver.queued = 0;
    assert_int_equal(set_break(true), 1);
}

TEST(a_break_of_a_device_that_has_gone_is_a_lost_port)
{
    open_wire();
    driver.break_error = EIO;
    assert_int_equal(set_break(true), -1);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
    driver.break_error = 0;
    assert_int_equal(set_break(true), -1); /* until it is opened again */
    assert_int_equal(driver.break_calls, 1);
}

/* The usb-serial core of Linux returns ENOTTY for an adapter whose driver has no break_ctl. */
TEST(a_driver_without_breaks_is_not_a_lost_port)
{
    static const int errors[] = {ENOTTY, EINVAL, EOPNOTSUPP, ENOSYS};
    for (size_t i = 0; i != sizeof errors / sizeof *errors; i++) {
        open_wire();
        driver.break_error = errors[i];
        assert_int_equal(set_break(true), -1);
        assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_UNSUPPORTED);
        port_rig_says("break");
        assert_int_equal(port_rig_read_one(), 0);
        assert_int_equal(port_rig_write_one(), 1);
        fathom_posix_close(&rig.port);
    }
}

TEST(a_break_that_fails_once_is_not_a_lost_port)
{
    open_wire();
    driver.break_error = ETIMEDOUT;
    assert_int_equal(set_break(true), -1);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_SYSTEM);
    driver.break_error = 0;
    assert_int_equal(set_break(true), 1);
}

TEST(a_port_that_is_closed_has_no_break)
{
    open_wire();
    fathom_posix_close(&rig.port);
    assert_int_equal(set_break(true), -1);
}

TEST(on_a_pseudo_terminal_a_zero_stands_for_a_break)
{
    uint8_t bytes[4] = {0xA5, 0xA5, 0xA5, 0xA5};
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    assert_int_equal(set_break(true), 1);
    assert_int_equal(posix_pty_receive(&rig.pty, bytes, sizeof bytes), 1);
    assert_int_equal(bytes[0], 0);
    while (!port_rig_sent()) continue;
    assert_int_equal(set_break(false), 1);
    assert_int_equal(driver.break_calls, 0);
}

EACH_BEGINS((posix_driver_reset(), (void)port_rig_set_up(state)))
static const suite_t suite = PORT_RIG_SUITE(begins);
