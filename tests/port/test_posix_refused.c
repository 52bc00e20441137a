/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* rates above 38400 */
#include <errno.h>
#include <termios.h>

#include "posix_driver.h"
#include "posix_rig.h"

/* Settings and devices that are refused. The driver is posix_driver.h's. */

static void open_fails(const fathom_line_settings_t *settings, fathom_posix_status_t error)
{
    const unsigned before = posix_count_fds();
    assert_int_equal(open_with(settings), error);
    assert_int_equal(fathom_posix_error(&rig.port), error);
    assert_int_equal(posix_count_fds(), before);
    assert_int_equal(fathom_posix_fd(&rig.port), -1);
}

TEST(a_rate_that_the_driver_refused_silently_is_an_error_with_both_rates)
{
    driver.most = B115200;
    open_fails(&port_rig_fast, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for raw 230400 8N1, the driver set 9600 8N1");
    assert_int_equal(driver.sets, 2); /* and what was before was put back */
    const fathom_line_settings_t slower = {115200, FATHOM_PARITY_NONE, 1};
    assert_int_equal(open_with(&slower), FATHOM_POSIX_OK);
}

TEST(a_refused_change_puts_the_line_back_and_the_port_goes_on)
{
    const fathom_line_settings_t slower = {57600, FATHOM_PARITY_NONE, 1};
    driver.most = B115200;
    assert_int_equal(open_with(&slower), FATHOM_POSIX_OK);
    assert_int_equal(fathom_posix_set_line(&rig.port, &port_rig_fast), FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for raw 230400 8N1, the driver set 9600 8N1");
    assert_int_equal(port_rig_speed(), B57600);
    assert_int_equal(port_rig_read_one(), 0);
    assert_int_equal(port_rig_write_one(), 1);
}

TEST(a_dropped_parity_is_refused_where_there_is_a_wire)
{
    const fathom_line_settings_t odd = {19200, FATHOM_PARITY_ODD, 1};
    const fathom_line_settings_t even = {19200, FATHOM_PARITY_EVEN, 1};
    driver.is_8250 = true;
    driver.drops_parity = true;
    open_fails(&odd, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for raw 19200 8O1, the driver set 19200 8N1");
    open_fails(&even, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for raw 19200 8E1, the driver set 19200 8N1");
    driver.drops_parity = false;
    assert_int_equal(open_with(&odd), FATHOM_POSIX_OK);
}

TEST(dropped_stop_bits_are_refused)
{
    const fathom_line_settings_t two = {19200, FATHOM_PARITY_NONE, 2};
    driver.drops_stop = true;
    open_fails(&two, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("asked for raw 19200 8N2, the driver set 19200 8N1");
}

TEST(a_tty_that_does_not_become_raw_is_refused)
{
    driver.keeps_echo = true;
    open_fails(&usual, FATHOM_POSIX_ERR_REFUSED);
    port_rig_says("not raw");
}

TEST(an_einval_counts_only_when_the_settings_did_not_hold)
{
    driver.set_error = EINVAL;
    assert_int_equal(open_with(&port_rig_fast), FATHOM_POSIX_OK);
    fathom_posix_close(&rig.port);
    driver.most = B115200;
    open_fails(&port_rig_fast, FATHOM_POSIX_ERR_REFUSED);
}

TEST(an_interrupted_change_is_repeated)
{
    driver.set_interrupts = 3;
    port_rig_open();
    assert_int_equal(port_rig_speed(), B230400);
    assert_int_equal(driver.sets, 4);
}

TEST(errors_while_opening_are_told_with_the_systems_words)
{
    driver.set_error = ENOMEM;
    open_fails(&usual, FATHOM_POSIX_ERR_SYSTEM);
    port_rig_says("changing its settings: Cannot allocate memory");
    driver.set_error = 0;
    driver.get_error = EIO; /* a ttyS without a UART */
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
    port_rig_says("no UART behind this name");
    for (driver.get_error_after = 1; driver.get_error_after <= 2;) { /* unplugged a moment later */
        const int after = driver.get_error_after;
        open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
        driver.get_error_after = after + 1;
    }
    driver.get_error = 0;
    driver.is_8250 = true;
    driver.exclusive_error = EIO;
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
    driver.open_error = EBUSY; /* TIOCEXCL of another program */
    open_fails(&usual, FATHOM_POSIX_ERR_IN_USE);
    driver.open_error = ENXIO;
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
    driver.open_error = EMFILE;
    open_fails(&usual, FATHOM_POSIX_ERR_SYSTEM);
    port_rig_says("opening it: Too many open files");
}

TEST(a_real_tty_is_taken_exclusively_and_given_back)
{
    port_rig_open();
    fathom_posix_close(&rig.port);
    assert_int_equal(driver.exclusive_calls, 0); /* a pseudo terminal is not */
    driver.is_8250 = true;
    port_rig_open();
    assert_int_equal(driver.exclusive, 1);
    fathom_posix_close(&rig.port);
    assert_int_equal(driver.exclusive, 0);
    assert_int_equal(driver.exclusive_calls, 2);
}

TEST(a_device_that_goes_while_its_line_is_changed_is_lost)
{
    port_rig_open();
    driver.get_error = EIO;
    assert_int_equal(fathom_posix_set_line(&rig.port, &usual), FATHOM_POSIX_ERR_LOST);
    driver.get_error = 0;
    assert_true(port_rig_read_one() < 0);
}

EACH_BEGINS((posix_driver_reset(), (void)port_rig_set_up(state)))
static const suite_t suite = PORT_RIG_SUITE(begins);
