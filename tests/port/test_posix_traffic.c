/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* TIOCSER_TEMT */
#include <errno.h>
#include <poll.h>
#include <sys/ioctl.h>

#include "posix_driver.h"
#include "posix_rig.h"

/* What drivers do to the bytes. The driver is posix_driver.h's. */

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
