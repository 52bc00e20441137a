/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* struct sigaction, sockets, mkstemp */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "loop_fake.h"
#include "loop_line_rig.h"
#include "posix_time.h"

/* Which descriptors fathom_loop.h waits for, what wakes it, and what ends its sleep. The descriptors are real: a pin is on
 * one of the two ends of a stream. The clock is simulated, so the numbers of polls and steps are exact. A test that waits
 * for another process, a thread or a signal uses the real clock; its only upper limit is the watchdog or 10 s. */

enum { SOON_US = 30000, LONG_US = 10000000, MOST_STEPS = 100000 };

static fathom_loop_pin_t pin, other;
static fake_sensor_t first, second;
static fake_source_t one;
static int ends[2];    /* of a stream; [0] is the loop's */
static int saved = -1; /* standard input */

static void ends_open(void)
{
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends), 0);
}

static void ends_close(unsigned i)
{
    if (ends[i] >= 0) (void)close(ends[i]);
    ends[i] = -1;
}

static int set_up(void **state)
{
    posix_start_watchdog(0);
    posix_time_begin(true);
    line_rig_begin(NULL);
    ends_open();
    return 0;
}

static int tear_down(void **state)
{
    if (saved >= 0) assert_int_equal(dup2(saved, 0), 0);
    if (saved >= 0) (void)close(saved);
    saved = -1;
    line_rig_end();
    ends_close(0);
    ends_close(1);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

/* Steps for `us` microseconds. Returns the number of steps. */
static unsigned pass(uint64_t us)
{
    const uint64_t until_us = fathom_posix_now_us() + us;
    const uint64_t before = rig.loop.sleeps;
    for (uint64_t now_us; (now_us = fathom_posix_now_us()) < until_us;) {
        fathom_loop_step(&rig.loop, (uint32_t)(until_us - now_us));
        assert_true(rig.loop.sleeps - before < MOST_STEPS); /* a loop that never sleeps stops the clock */
    }
    return (unsigned)(rig.loop.sleeps - before);
}

static void send_bytes(size_t length)
{
    static const uint8_t bytes[16];
    assert_int_equal(write(ends[1], bytes, length), length);
}

/* Has a step something to do? */
static bool is_ready(void)
{
    struct pollfd entry = {fathom_loop_fd(&rig.loop), POLLIN, 0};
    return poll(&entry, 1, 0) == 1;
}

static void add_pin(fathom_loop_pin_t *to, fake_sensor_t *sensor, int fd)
{
    fathom_loop_add_pin(&rig.loop, to, fd);
    fake_sensor(sensor, (fake_source_t *)&to->source);
}

/* ---- a source that reads the stream ---- */

typedef struct {
    fathom_loop_source_t source;
    fathom_uart_t uart;
    size_t capacity;
    unsigned bytes;
    bool is_lost;
} stream_t;

static stream_t stream;

static int stream_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const ssize_t n = recv(ends[0], bytes, capacity, MSG_DONTWAIT);
    return n == 0 ? -1 : n < 0 ? 0 : (int)n;
}

static int stream_fd(const fathom_loop_source_t *source) { return ends[0]; }

/* Reads once. */
static bool stream_poll(fathom_loop_source_t *source)
{
    uint8_t bytes[64];
    fathom_rx_t rx = {0, 0};
    const int n = stream.uart.read(stream.uart.ctx, bytes, stream.capacity, &rx);
    if (n > 0) stream.bytes += (unsigned)n;
    stream.is_lost = n < 0;
    return n >= 0;
}

static void add_stream(size_t capacity)
{
    static const fathom_loop_kind_t kind = {.fd = stream_fd, .poll = stream_poll};
    const fathom_uart_t uart = {.read = stream_read};
    memset(&stream, 0, sizeof stream);
    stream.source.kind = &kind;
    stream.source.reads_all = true;
    stream.capacity = capacity;
    stream.uart = fathom_loop_uart(&stream.source, &uart);
    fathom_loop_add(&rig.loop, &stream.source);
    (void)pass(1000);
}

/* ---- pins ---- */

TEST(a_pin_is_polled_when_its_descriptor_becomes_ready_and_not_as_long_as_it_is)
{
    add_pin(&pin, &first, ends[0]);
    assert_int_equal(pass(SOON_US), 2); /* the first poll, and the rest of the time */
    assert_int_equal(first.polls, 1);
    send_bytes(1);
    assert_int_equal(pass(SOON_US), 2); /* the byte, and the rest of the time */
    assert_int_equal(first.polls, 2);   /* though nothing has read it */
    send_bytes(1);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 3);
}

TEST(what_was_there_before_the_pin_was_added_is_seen)
{
    send_bytes(1);
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    assert_true(first.polls >= 1);
}

/* epoll_ctl(2): EPERM. It is polled every 10 ms. */
TEST(a_descriptor_that_epoll_refuses_is_polled_all_the_same)
{
    char path[] = "/tmp/fathom-loop-XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(unlink(path), 0);
    add_pin(&pin, &first, file);
    assert_int_equal(pass(200000), 21);
    assert_int_equal(first.polls, 21); /* at 0, 10, ..., 200 ms */
    pin.fd = ends[0];                  /* one that epoll waits for */
    (void)pass(2 * SOON_US);
    const unsigned polls = first.polls;
    send_bytes(1);
    assert_int_equal(pass(SOON_US), 2);
    assert_int_equal(first.polls, polls + 1);
    fathom_loop_remove(&pin.source);
    (void)close(file);
}

/* epoll_ctl(2): EEXIST. */
TEST(a_descriptor_of_two_pins_wakes_one_and_the_other_is_polled)
{
    add_pin(&pin, &first, ends[0]);
    add_pin(&other, &second, ends[0]);
    (void)pass(100000);
    assert_int_equal(first.polls, 1);
    assert_int_equal(second.polls, 11); /* at 0, 10, ..., 100 ms */
    fathom_loop_remove(&other.source);  /* which takes nothing from the first */
    send_bytes(1);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 2);
}

/* ---- bytes ---- */

TEST(what_one_read_does_not_bring_the_next_ones_do)
{
    add_stream(4);
    send_bytes(14);
    assert_int_equal(pass(SOON_US), 5); /* 4, 4, 4 and 2 bytes, and the rest of the time */
    assert_int_equal(stream.bytes, 14);
}

/* Bytes and the hang-up come as one event, and the read of the bytes is short. */
TEST(a_hang_up_right_behind_the_last_bytes_is_seen)
{
    add_stream(64);
    send_bytes(3);
    ends_close(1);
    (void)pass(SOON_US);
    assert_int_equal(stream.bytes, 3);
    assert_true(stream.is_lost);
    assert_int_equal(rig.failed, 1);
}

/* ---- lines ---- */

TEST(a_line_that_is_added_twice_is_refused)
{
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(9600);
    const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    assert_int_equal(fathom_loop_add_line(&rig.loop, &rig.lines[0], rig.ptys[0].path, &settings),
                     FATHOM_POSIX_ERR_ARGUMENT);
    assert_true(rig.lines[0].source.is_open);
}

/* ---- stop, signals, and loops of another kind ---- */

static void on_signal(int number) { fathom_loop_stop(&rig.loop); }

static void signal_soon(void)
{
    struct sigaction action;
    const struct itimerval soon = {{0, SOON_US}, {0, SOON_US}}; /* again and again: one comes in the sleep */
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART; /* even so */
    assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
    assert_int_equal(setitimer(ITIMER_REAL, &soon, NULL), 0);
}

static void no_more_signals(void)
{
    const struct itimerval never = {{0, 0}, {0, 0}};
    assert_int_equal(setitimer(ITIMER_REAL, &never, NULL), 0);
    (void)signal(SIGALRM, SIG_DFL);
    posix_start_watchdog(0);
}

/* Nothing is on the loop, so it sleeps until it is stopped. */
TEST(a_signal_handler_stops_the_run)
{
    signal_soon();
    do fathom_loop_run(&rig.loop);
    while (rig.loop.sleeps == 0); /* a busy machine may stop the loop before it sleeps, but not every time */
    no_more_signals();
    assert_in_range(rig.loop.sleeps, 1, 10);
}

/* An eventfd that is full refuses (eventfd(2): EAGAIN); what a signal handler calls leaves errno alone. */
TEST(a_stop_leaves_errno_alone)
{
    assert_int_equal(eventfd_write(rig.loop.stop_fd, UINT64_MAX - 1), 0);
    errno = 300;
    fathom_loop_stop(&rig.loop);
    assert_int_equal(errno, 300);
    fathom_loop_run(&rig.loop);
    assert_int_equal(rig.loop.sleeps, 0);
}

static void *stop_soon(void *arg)
{
    (void)poll(NULL, 0, SOON_US / 1000);
    fathom_loop_stop(arg);
    return NULL;
}

TEST(another_thread_stops_the_run_again_and_again)
{
    for (unsigned i = 0; i < 3 || rig.loop.sleeps == 0; i++) {
        pthread_t thread;
        assert_int_equal(pthread_create(&thread, NULL, stop_soon, &rig.loop), 0);
        fathom_loop_run(&rig.loop);
        assert_int_equal(pthread_join(thread, NULL), 0);
        assert_true(rig.loop.sleeps <= 3 * (i + 1));
    }
}

TEST(a_loop_of_another_kind_sees_when_a_step_has_something_to_do)
{
    add_pin(&pin, &first, ends[0]);
    first.due_us = 500000;
    (void)pass(1000);
    assert_false(is_ready());
    assert_int_equal(fathom_loop_due_us(&rig.loop), 500000 - 1000);
    send_bytes(1);
    assert_true(is_ready());
    fathom_loop_step(&rig.loop, 0);
    assert_int_equal(first.polls, 2);
    assert_false(is_ready());
}

TEST(a_stop_wakes_a_loop_of_another_kind_once)
{
    fathom_loop_stop(&rig.loop);
    assert_true(is_ready());
    fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE); /* does not sleep */
    assert_false(is_ready());
}

TEST(a_pin_that_is_added_twice_is_there_once)
{
    add_pin(&pin, &first, ends[0]);
    fathom_loop_add_pin(&rig.loop, &pin, ends[0]);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 1);
}

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
/* The system assigns the number of a closed descriptor again at once. */
TEST(another_descriptor_with_the_same_number_is_waited_for)
{
    add_stream(64);
    const int number = ends[0];
    ends_close(0);
    ends_close(1);
    fathom_loop_renew(&stream.source);
    ends_open();
    assert_int_equal(ends[0], number);
    fathom_loop_wake(&stream.source); /* a turn of the source */
    (void)pass(1000);
    assert_false(is_ready());
    send_bytes(3);
    assert_true(is_ready());
    (void)pass(1000);
    assert_int_equal(stream.bytes, 3);
}

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

/* If the chip of a line goes away, the kernel reports EPOLLHUP and EPOLLERR; a level would stay as it was. */
TEST(a_pin_whose_chip_has_gone_is_lost_and_waited_for_again_once_it_is_back)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 5000, .longest_pause_us = 5000});
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    ends_close(1);
    line_rig_until(&first.port_errors, 1);
    assert_string_equal(fathom_loop_error_text(&pin.source), "it is lost");
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
