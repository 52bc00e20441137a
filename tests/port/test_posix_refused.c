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

/* What another program, or a driver with a mind of its own, leaves behind. */
static void keeps_flow_control(struct termios *tty) { tty->c_cflag |= CRTSCTS; }
static void makes_7_bits_odd(struct termios *tty)
{
    tty->c_cflag = B9600 | CS7 | CREAD | CLOCAL | PARENB | PARODD;
}
static void makes_6_bits_even(struct termios *tty) { tty->c_cflag = B9600 | CS6 | CREAD | CLOCAL | PARENB; }
static void makes_5_bits(struct termios *tty) { tty->c_cflag = B9600 | CS5 | CREAD | CLOCAL; }
static void sets_another_rate(struct termios *tty)
{
    (void)cfsetospeed(tty, B110);
} /* one that we do not name */
static void is_faster(struct termios *tty) { (void)cfsetospeed(tty, B19200); }
static void hears_at_no_rate(struct termios *tty) { (void)cfsetispeed(tty, B0); }
static void minds_xon(struct termios *tty) { tty->c_iflag |= IXON; }
static void translates(struct termios *tty) { tty->c_oflag |= OPOST; }
static void waits_for_two(struct termios *tty) { tty->c_cc[VMIN] = 2; }
static void waits_a_second(struct termios *tty) { tty->c_cc[VTIME] = 10; }

TEST(whatever_else_the_driver_has_set_is_refused_and_named)
{
    static const struct {
        void (*changes)(struct termios *tty);
        const char *says;
    } rows[] = {{keeps_flow_control, "the driver set 9600 8N1 with flow control"},
                {makes_7_bits_odd, "the driver set 9600 7O1"},
                {makes_6_bits_even, "the driver set 9600 6E1"},
                {makes_5_bits, "the driver set 9600 5N1"},
                {sets_another_rate, "asked for raw 9600 8N1, the driver set ? 8N1"},
                {is_faster, "the driver set 19200 8N1"},
                {hears_at_no_rate, "settings refused"},
                {minds_xon, "the driver set 9600 8N1, not raw"},
                {translates, "settings refused"},
                {waits_for_two, "settings refused"},
                {waits_a_second, "settings refused"}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        driver.changes = rows[i].changes;
        driver.sets = 0;
        open_fails(&usual, FATHOM_POSIX_ERR_REFUSED);
        port_rig_says(rows[i].says);
    }
}

TEST(an_einval_of_a_device_that_has_gone_is_that_it_has_gone)
{
    driver.set_error = EINVAL;
    driver.get_error = ENXIO;
    driver.get_error_after = 2; /* what the settings were, twice */
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
}

TEST(an_interrupted_open_is_repeated)
{
    driver.open_interrupts = 3;
    port_rig_open();
    assert_int_equal(driver.open_interrupts, 0);
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
    static const struct {
        int error;
        fathom_posix_status_t is;
    } rows[] = {{ENODEV, FATHOM_POSIX_ERR_NOT_FOUND},   {ENOTDIR, FATHOM_POSIX_ERR_NOT_FOUND},
                {EACCES, FATHOM_POSIX_ERR_PERMISSION},  {EPERM, FATHOM_POSIX_ERR_PERMISSION},
                {EWOULDBLOCK, FATHOM_POSIX_ERR_IN_USE}, {ENOTTY, FATHOM_POSIX_ERR_NOT_A_TTY},
                {EISDIR, FATHOM_POSIX_ERR_NOT_A_TTY},   {EIO, FATHOM_POSIX_ERR_NOT_FOUND}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        driver.open_error = rows[i].error;
        open_fails(&usual, rows[i].is);
    }
    driver.open_error = EMFILE;
    open_fails(&usual, FATHOM_POSIX_ERR_SYSTEM);
    port_rig_says("opening it: Too many open files");
}

TEST(errors_of_the_calls_around_the_settings_are_told_too)
{
    driver.stat_error = EIO;
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
    driver.stat_error = 0;
    driver.flush_error = ENOMEM;
    open_fails(&usual, FATHOM_POSIX_ERR_SYSTEM);
    port_rig_says("flushing it: Cannot allocate memory");
    driver.flush_error = 0;
    driver.get_error = EINVAL; /* some devices give that for ENOTTY */
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_A_TTY);
    driver.get_error = ENODEV;
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
    driver.get_error = ENXIO;
    open_fails(&usual, FATHOM_POSIX_ERR_NOT_FOUND);
}

TEST(what_is_not_given_is_an_argument_error)
{
    fathom_posix_line_errors_t errors;
    assert_int_equal(fathom_posix_open(NULL, rig.pty.path, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_open(&rig.port, NULL, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_open(&rig.port, rig.pty.path, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    fathom_posix_close(NULL);
    port_rig_open();
    assert_int_equal(fathom_posix_set_line(NULL, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_set_line(&rig.port, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_line_errors(NULL, &errors), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_line_errors(&rig.port, NULL), FATHOM_POSIX_ERR_ARGUMENT);
}

TEST(an_adapters_tty_is_taken_exclusively_too)
{
    driver.is_8250 = true;
    driver.is_usb = true;
    port_rig_open();
    assert_int_equal(driver.exclusive, 1);
}

TEST(a_line_that_differs_in_its_stop_bits_alone_is_another)
{
    const fathom_line_settings_t two = {230400, FATHOM_PARITY_NONE, 2};
    port_rig_open();
    const int sets = driver.sets;
    assert_int_equal(rig.uart.set_line(rig.uart.ctx, &port_rig_fast), 1);
    assert_int_equal(driver.sets, sets);
    assert_int_equal(rig.uart.set_line(rig.uart.ctx, &two), 1);
    assert_int_equal(driver.sets, sets + 1);
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
