/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* rates above 38400, TIOCSER_TEMT */
#include <errno.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>

#include "posix_driver.h"
#include "posix_rig.h"

/* Settings and devices that are refused, and what drivers do to the bytes. The driver is posix_driver.h's. */

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

/* ---- bytes ---- */

TEST(a_read_that_was_interrupted_is_repeated)
{
    port_rig_open();
    driver.read_interrupts = 3;
    assert_int_equal(port_rig_read_one(), 0);
    assert_int_equal(driver.read_interrupts, 0);
}

/* hal.h: the count is an int, which may have 16 bits. */
TEST(no_read_is_for_more_than_an_int_can_count)
{
    static uint8_t bytes[40000];
    port_rig_open();
    assert_int_equal(port_rig_read(bytes, sizeof bytes), 0);
    assert_int_equal(driver.read_most, 32767);
}

TEST(an_unplugged_adapter_fails_reads_for_good)
{
    static const int errors[] = {EIO, ENXIO, ENODEV, EBADF};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        port_rig_open();
        driver.read_error = errors[i];
        assert_true(port_rig_read_one() < 0);
        driver.read_error = 0; /* the same name may be another device by now */
        assert_true(port_rig_read_one() < 0);
        assert_true(port_rig_write_one() < 0);
        assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
        fathom_posix_close(&rig.port);
    }
}

TEST(a_request_taken_in_parts_leaves_whole_through_any_call)
{
    static const char request[] = "0123456789abcdefghij";
    char got[2 * sizeof request];
    port_rig_open();
    driver.write_most = 5;
    assert_int_equal(port_rig_write(request, 20), 20); /* 5 */
    assert_int_equal(port_rig_leaves_in_us(), 0);      /* it is not known yet when the rest follows */
    assert_false(port_rig_sent());                     /* 10 */
    assert_int_equal(port_rig_read(got, 1), 0);        /* 15 */
    assert_int_equal(driver.writes, 3);
    driver.write_most = 4;
    assert_int_equal(port_rig_write(request, 20), 0); /* 19, and busy: one is left */
    driver.write_error = EAGAIN;
    assert_false(port_rig_sent());
    fathom_posix_wait(&rig.port, 1000);
    assert_int_equal(port_rig_write(request, 20), 0);
    driver.write_error = 0;
    driver.write_interrupts = 2;
    fathom_posix_wait(&rig.port, 0); /* 20 */
    driver.write_most = 0;
    assert_int_equal(port_rig_write(request, 20), 20);
    posix_pty_receive_all(&rig.pty, (uint8_t *)got, 40);
    assert_memory_equal(got, request, 20);
    assert_memory_equal(got + 20, request, 20);
}

TEST(a_wait_that_ends_because_there_is_room_has_used_it)
{
    port_rig_open();
    driver.write_most = 2;
    assert_int_equal(port_rig_write("abc", 3), 3);
    driver.write_refusals = 1;
    fathom_posix_wait(&rig.port, FATHOM_NO_DEADLINE); /* refused before it slept */
    assert_int_equal(driver.writes, 3);
    assert_int_equal(fathom_posix_poll_events(&rig.port), POLLIN);
}

TEST(a_write_is_busy_when_the_kernel_takes_nothing)
{
    port_rig_open();
    driver.write_error = EAGAIN;
    assert_int_equal(port_rig_write("abc", 3), 0);
    driver.write_error = 0;
    uint8_t got[4];
    assert_int_equal(posix_pty_receive(&rig.pty, got, sizeof got), 0);
    assert_true(port_rig_sent());
    assert_int_equal(port_rig_write("abc", 3), 3);
}

TEST(a_port_that_is_lost_in_the_middle_of_a_request_says_so)
{
    for (int by = 0; by != 4; by++) {
        port_rig_open();
        driver.write_most = 1;
        assert_int_equal(port_rig_write("abc", 3), 3);
        driver.write_error = EIO;
        if (by == 0) assert_true(port_rig_read_one() < 0);
        if (by == 1) assert_true(port_rig_sent()); /* so that the line does not wait for it */
        if (by == 2) fathom_posix_wait(&rig.port, FATHOM_NO_DEADLINE); /* returns */
        if (by == 3) assert_true(port_rig_write("abc", 3) < 0);
        assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
        const int writes = driver.writes;
        assert_true(port_rig_write("abc", 3) < 0);
        assert_true(port_rig_read_one() < 0);
        assert_int_equal(port_rig_leaves_in_us(), 0);
        fathom_posix_wait(&rig.port, FATHOM_NO_DEADLINE); /* returns */
        assert_int_equal(driver.writes, writes);          /* what was left of it stays */
        driver.write_error = 0;
        fathom_posix_close(&rig.port);
    }
}

/* Past the time that the bytes need at their rate, which is less than 1 ms here. */
static void let_it_leave(void)
{
    assert_int_equal(port_rig_write("abc", 3), 3);
    const uint64_t start_us = fathom_posix_now_us();
    while (fathom_posix_now_us() - start_us < 1000) fathom_posix_wait(&rig.port, 1000);
}

TEST(sent_waits_for_the_kernels_queue_and_for_the_transmitter)
{
    driver.queued = 1;
    port_rig_open();
    let_it_leave();
    assert_false(port_rig_sent());
    assert_int_equal(port_rig_leaves_in_us(), 0); /* should have */
    driver.queued = 0;
    driver.lsr = 0;
    assert_false(port_rig_sent());
    driver.lsr = TIOCSER_TEMT;
    assert_true(port_rig_sent());
}

TEST(sent_does_without_a_transmitter_state_where_there_is_none)
{
    driver.lsr_error = ENOTTY;
    port_rig_open();
    let_it_leave();
    assert_true(port_rig_sent());
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_OK);
}

TEST(sent_on_a_lost_port_does_not_let_the_line_wait)
{
    port_rig_open();
    let_it_leave();
    driver.queue_error = EIO;
    assert_true(port_rig_sent());
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
}

TEST(line_errors_are_the_drivers_counts)
{
    fathom_posix_line_errors_t errors;
    memset(&errors, 0, sizeof errors);
    port_rig_open();
    assert_int_equal(fathom_posix_line_errors(&rig.port, &errors), FATHOM_POSIX_OK);
    assert_int_equal(errors.parity, 11);
    assert_int_equal(errors.framing, 22);
    assert_int_equal(errors.overrun, 33);
    assert_int_equal(errors.breaks, 44);
    static const int uncounted[] = {ENOTTY, EINVAL, EOPNOTSUPP};
    for (int i = 0; i != 3; i++) {
        driver.count_error = uncounted[i];
        assert_int_equal(fathom_posix_line_errors(&rig.port, &errors), FATHOM_POSIX_ERR_UNSUPPORTED);
    }
    driver.count_error = EIO;
    assert_int_equal(fathom_posix_line_errors(&rig.port, &errors), FATHOM_POSIX_ERR_LOST);
    assert_int_equal(errors.parity, 11);
}

EACH_BEGINS((posix_driver_reset(), (void)port_rig_set_up(state)))
static const suite_t suite = PORT_RIG_SUITE(begins);
