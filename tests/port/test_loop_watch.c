/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* mkstemp, sockets */
#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "loop_ends_rig.h"

/* Which descriptors fathom_loop.h waits for, and which it does not. The descriptors are real. The clock is simulated, so the
 * numbers of polls and steps are exact. */

static fake_source_t one;
static int saved = -1; /* standard input */

static int tear_down(void **state)
{
    if (saved >= 0) {
        assert_int_equal(dup2(saved, 0), 0);
        (void)close(saved);
        saved = -1;
    }
    return ends_tear_down(state);
}

static const suite_t suite = {.set_up = ends_set_up, .tear_down = tear_down};

/* Makes it the descriptor 0, until the test is over. */
static void put_at_0(int fd)
{
    saved = fcntl(0, F_DUPFD_CLOEXEC, 3);
    assert_true(saved >= 0);
    assert_int_equal(dup2(fd, 0), 0);
}

/* ---- what is waited for ---- */

TEST(a_pin_that_was_removed_wakes_nothing)
{
    memset(&pin, 0xA5, sizeof pin); /* any content will do */
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    fathom_loop_remove(&pin.source);
    send_bytes(1);
    assert_false(is_ready());
    add_pin(&pin, &first, ends[0]); /* and it can be added again, as if it had never been there */
    (void)pass(SOON_US);
    const unsigned before = first.polls;
    send_bytes(1);
    assert_true(is_ready());
    assert_int_equal(pass(SOON_US), 2); /* the byte, and the rest of the time */
    assert_int_equal(first.polls, before + 1);
}

/* A program that was started without an input gets 0 when it opens something. */
TEST(the_descriptor_0_is_one_like_any_other)
{
    put_at_0(ends[0]);
    add_pin(&pin, &first, 0);
    assert_int_equal(pass(200000), 2);
    assert_int_equal(first.polls, 1);
    send_bytes(1);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 2);
}

/* -1: the first poll, and no other. */
TEST(a_source_without_a_descriptor_is_woken_by_time_alone)
{
    fake_source(&one);
    one.due_us = FATHOM_NO_DEADLINE;
    fathom_loop_add(&rig.loop, &one.source);
    (void)pass(100000);
    assert_int_equal(one.polls, 1);
    one.due_us = 40000;
    fathom_loop_wake(&one.source);
    (void)pass(100000);
    assert_int_equal(one.polls, 1 + 3); /* the wake, and at 40 and 80 ms */
}

/* A socket with an empty queue can be written to at once. */
TEST(events_that_have_changed_are_waited_for_from_the_next_poll_on)
{
    fake_source(&one);
    one.due_us = FATHOM_NO_DEADLINE;
    one.fd = ends[0];
    fathom_loop_add(&rig.loop, &one.source);
    (void)pass(SOON_US);
    assert_int_equal(one.polls, 1);
    one.events = POLLIN | POLLOUT;
    fathom_loop_wake(&one.source);
    (void)pass(SOON_US);
    assert_int_equal(one.polls, 3); /* the wake, and what can be written to */
    one.events = POLLOUT;
    fathom_loop_wake(&one.source);
    (void)pass(SOON_US);
    const unsigned before = one.polls;
    send_bytes(1); /* which is no event any more */
    (void)pass(SOON_US);
    assert_int_equal(one.polls, before);
}

/* ---- what cannot be waited for ---- */

/* A pin has the descriptor already, epoll_ctl(2): EEXIST. One byte every 10 ms is 20 in 200 ms; 160 are there. */
TEST(a_stream_that_cannot_be_waited_for_is_read_every_10_ms)
{
    add_pin(&pin, &first, ends[0]);
    for (unsigned i = 0; i != 10; i++) send_bytes(16);
    add_stream(1);
    const unsigned before = stream.bytes;
    (void)pass(200000);
    assert_int_equal(stream.bytes - before, 20);
}

/* ---- what has gone and comes back ---- */

TEST(a_pin_whose_chip_is_back_is_waited_for_again)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 5000, .longest_pause_us = 5000});
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    ends_close(1);
    line_rig_until(&first.port_errors, 1);
    const int lost = ends[0];
    ends_open();
    assert_int_equal(dup2(ends[0], lost), lost); /* the pin's descriptor is of a chip again */
    ends_close(0);
    ends[0] = lost;
    line_rig_until(&rig.opened, 2);
    const unsigned failed = rig.failed;
    (void)pass(SOON_US);
    const unsigned before = first.polls;
    send_bytes(1);
    assert_int_equal(pass(SOON_US), 2);
    assert_int_equal(first.polls, before + 1);
    assert_int_equal(rig.failed, failed);
    assert_int_equal(first.port_errors, 1);
}

/* ---- a loop without a config ---- */

TEST(a_loop_without_a_config_tells_nothing_and_goes_on)
{
    static fathom_loop_t loop;
    assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_OK);
    fake_source(&one);
    one.cannot_open = true;
    fathom_loop_add(&loop, &one.source);
    assert_int_equal(fathom_loop_due_us(&loop), 500000);
    fathom_loop_step(&loop, 0);
    assert_int_equal(one.opens, 1);
    fathom_loop_deinit(&loop);
    assert_null(loop.sources);
}

/* ---- the loop's own descriptors ---- */

/* The lowest number that is free. */
static int next_fd(void)
{
    const int fd = fcntl(ends[0], F_DUPFD_CLOEXEC, 0);
    assert_true(fd >= 0);
    (void)close(fd);
    return fd;
}

/* With a limit that lets it have none, and the first of the two. */
TEST(a_loop_that_gets_no_descriptor_says_so_and_keeps_none)
{
    static fathom_loop_t loop;
    struct rlimit usual;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &usual), 0);
    for (unsigned fds = 0; fds != 2; fds++) {
        const int next = next_fd();
        struct rlimit few = usual;
        few.rlim_cur = (rlim_t)next + fds;
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
        const fathom_posix_status_t status = fathom_loop_init(&loop, NULL);
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &usual), 0);
        assert_int_equal(status, FATHOM_POSIX_ERR_SYSTEM);
        assert_int_equal(next_fd(), next);
    }
}

TEST(a_second_deinit_closes_nothing_that_was_opened_since)
{
    static fathom_loop_t loop;
    assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_OK);
    const int number = fathom_loop_fd(&loop);
    fathom_loop_deinit(&loop);
    put_at_0(ends[0]); /* also not 0 */
    const int others = fcntl(ends[0], F_DUPFD_CLOEXEC, number);
    const unsigned before = posix_count_fds();
    fathom_loop_deinit(&loop);
    assert_int_equal(posix_count_fds(), before);
    (void)close(others);
}
