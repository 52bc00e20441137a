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

/* What another program, or a driver with a mind of its own, leaves behind. */
static void keeps_flow_control(struct termios *tty) { tty->c_cflag |= CRTSCTS; }
static void makes_7_bits_odd(struct termios *tty)
{
    tty->c_cflag = B9600 | CS7 | CREAD | CLOCAL | PARENB | PARODD;
}
static void makes_6_bits_even(struct termios *tty) { tty->c_cflag = B9600 | CS6 | CREAD | CLOCAL | PARENB; }
static void makes_5_bits(struct termios *tty) { tty->c_cflag = B9600 | CS5 | CREAD | CLOCAL; }
static void is_at_110(struct termios *tty) { (void)cfsetospeed(tty, B110); }
static void is_faster(struct termios *tty) { (void)cfsetospeed(tty, B19200); }
static void hears_at_no_rate(struct termios *tty) { (void)cfsetispeed(tty, B0); }
static void minds_xon(struct termios *tty) { tty->c_iflag |= IXON; }
static void translates(struct termios *tty) { tty->c_oflag |= OPOST; }
static void waits_for_two(struct termios *tty) { tty->c_cc[VMIN] = 2; }
static void waits_a_second(struct termios *tty) { tty->c_cc[VTIME] = 10; }

/* Each driver refuses to open with these settings. */
TEST(a_driver_that_refuses_is_an_error_with_its_reason)
{
    static const fathom_line_settings_t odd = {19200, FATHOM_PARITY_ODD, 1};
    static const fathom_line_settings_t even = {19200, FATHOM_PARITY_EVEN, 1};
    static const fathom_line_settings_t two = {19200, FATHOM_PARITY_NONE, 2};
    enum {
        SYSTEM = FATHOM_POSIX_ERR_SYSTEM,
        REFUSED = FATHOM_POSIX_ERR_REFUSED,
        NOT_FOUND = FATHOM_POSIX_ERR_NOT_FOUND,
        IN_USE = FATHOM_POSIX_ERR_IN_USE,
        NOT_A_TTY = FATHOM_POSIX_ERR_NOT_A_TTY,
        PERMISSION = FATHOM_POSIX_ERR_PERMISSION
    };
    static const struct {
        const fathom_line_settings_t *settings; /* NULL: the usual ones */
        posix_driver_t driver;
        int error;
        const char *says;
    } rows[] = {
        /* settings that did not hold */
        {&port_rig_fast, {.most = B115200}, REFUSED, "asked for raw 230400 8N1, the driver set 9600 8N1"},
        {&odd,
         {.is_8250 = true, .drops_parity = true},
         REFUSED,
         "asked for raw 19200 8O1, the driver set 19200 8N1"},
        {&even,
         {.is_8250 = true, .drops_parity = true},
         REFUSED,
         "asked for raw 19200 8E1, the driver set 19200 8N1"},
        {&two, {.drops_stop = true}, REFUSED, "asked for raw 19200 8N2, the driver set 19200 8N1"},
        {NULL, {.keeps_echo = true}, REFUSED, "not raw"},
        {&port_rig_fast, {.set_error = EINVAL, .most = B115200}, REFUSED, "settings refused"},
        {NULL, {.changes = keeps_flow_control}, REFUSED, "the driver set 9600 8N1 with flow control"},
        {NULL, {.changes = makes_7_bits_odd}, REFUSED, "the driver set 9600 7O1"},
        {NULL, {.changes = makes_6_bits_even}, REFUSED, "the driver set 9600 6E1"},
        {NULL, {.changes = makes_5_bits}, REFUSED, "the driver set 9600 5N1"},
        {NULL, {.changes = is_at_110}, REFUSED, "asked for raw 9600 8N1, the driver set ? 8N1"}, /* no name */
        {NULL, {.changes = is_faster}, REFUSED, "the driver set 19200 8N1"},
        {NULL, {.changes = hears_at_no_rate}, REFUSED, "settings refused"},
        {NULL, {.changes = minds_xon}, REFUSED, "the driver set 9600 8N1, not raw"},
        {NULL, {.changes = translates}, REFUSED, "settings refused"},
        {NULL, {.changes = waits_for_two}, REFUSED, "settings refused"},
        {NULL, {.changes = waits_a_second}, REFUSED, "settings refused"},
        /* calls that fail */
        {NULL, {.open_error = EBUSY}, IN_USE, ""}, /* TIOCEXCL of another program */
        {NULL, {.open_error = EWOULDBLOCK}, IN_USE, ""},
        {NULL, {.open_error = ENXIO}, NOT_FOUND, ""},
        {NULL, {.open_error = ENODEV}, NOT_FOUND, ""},
        {NULL, {.open_error = ENOTDIR}, NOT_FOUND, ""},
        {NULL, {.open_error = EIO}, NOT_FOUND, ""},
        {NULL, {.open_error = EACCES}, PERMISSION, ""},
        {NULL, {.open_error = EPERM}, PERMISSION, ""},
        {NULL, {.open_error = ENOTTY}, NOT_A_TTY, ""},
        {NULL, {.open_error = EISDIR}, NOT_A_TTY, ""},
        {NULL, {.open_error = EMFILE}, SYSTEM, "opening it: Too many open files"},
        {NULL, {.stat_error = EIO}, NOT_FOUND, ""},
        {NULL, {.is_8250 = true, .exclusive_error = EIO}, NOT_FOUND, ""},
        {NULL, {.flush_error = ENOMEM}, SYSTEM, "flushing it: Cannot allocate memory"},
        {NULL, {.set_error = ENOMEM}, SYSTEM, "changing its settings: Cannot allocate memory"},
        {NULL, {.get_error = EINVAL}, NOT_A_TTY, ""}, /* some devices give that for ENOTTY */
        {NULL, {.get_error = ENODEV}, NOT_FOUND, ""},
        {NULL, {.get_error = ENXIO}, NOT_FOUND, ""},
        {NULL, {.get_error = EIO}, NOT_FOUND, "no UART behind this name"}, /* a ttyS without one */
        {NULL, {.get_error = EIO, .get_error_after = 1}, NOT_FOUND, ""},   /* unplugged */
        {NULL, {.get_error = EIO, .get_error_after = 2}, NOT_FOUND, ""},   /* a moment later */
        {NULL, {.set_error = EINVAL, .get_error = ENXIO, .get_error_after = 2}, NOT_FOUND, ""},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        driver = rows[i].driver;
        open_fails(rows[i].settings != NULL ? rows[i].settings : &usual,
                   (fathom_posix_status_t)rows[i].error);
        port_rig_says(rows[i].says);
    }
}

/* The same drivers, where nothing is wrong. */
TEST(a_driver_opens_with_what_it_can_do)
{
    const fathom_line_settings_t slower = {115200, FATHOM_PARITY_NONE, 1};
    const fathom_line_settings_t odd = {19200, FATHOM_PARITY_ODD, 1};
    driver.most = B115200;
    open_fails(&port_rig_fast, FATHOM_POSIX_ERR_REFUSED);
    assert_int_equal(driver.sets, 2); /* and what was before was put back */
    assert_int_equal(open_with(&slower), FATHOM_POSIX_OK);
    fathom_posix_close(&rig.port);
    driver.is_8250 = true;
    assert_int_equal(open_with(&odd), FATHOM_POSIX_OK);
    fathom_posix_close(&rig.port);
    driver.most = 0;
    driver.set_error = EINVAL; /* counts only if the settings did not hold */
    assert_int_equal(open_with(&port_rig_fast), FATHOM_POSIX_OK);
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
