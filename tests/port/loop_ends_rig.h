/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_ENDS_RIG_H
#define FATHOM_TESTS_LOOP_ENDS_RIG_H

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "loop_fake.h"
#include "loop_line_rig.h"
#include "posix_time.h"

/* The loop of loop_line_rig.h, and the two ends of a stream: a pin is on one of them. The clock is simulated
 * (posix_time.h), the descriptors are real. Include this file after _DEFAULT_SOURCE. */

enum { SOON_US = 30000, LONG_US = 10000000, MOST_STEPS = 100000 };

static fathom_loop_pin_t pin;
static fake_sensor_t first;
static int ends[2]; /* [0] is the loop's */

static inline void ends_open(void)
{
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends), 0);
}

static inline void ends_close(unsigned i)
{
    if (ends[i] >= 0) (void)close(ends[i]);
    ends[i] = -1;
}

static inline int ends_set_up(void **state)
{
    posix_start_watchdog(0);
    posix_time_begin(true);
    line_rig_begin(NULL);
    ends_open();
    return 0;
}

static inline int ends_tear_down(void **state)
{
    line_rig_end();
    ends_close(0);
    ends_close(1);
    return 0;
}

/* Steps for `us` microseconds. Returns the number of steps. */
static inline unsigned pass(uint64_t us)
{
    const uint64_t until_us = fathom_posix_now_us() + us;
    const uint64_t before = rig.loop.sleeps;
    for (uint64_t now_us; (now_us = fathom_posix_now_us()) < until_us;) {
        fathom_loop_step(&rig.loop, (uint32_t)(until_us - now_us));
        assert_true(rig.loop.sleeps - before < MOST_STEPS); /* a loop that never sleeps stops the clock */
    }
    return (unsigned)(rig.loop.sleeps - before);
}

static inline void send_bytes(size_t length)
{
    static const uint8_t bytes[16];
    assert_int_equal(write(ends[1], bytes, length), length);
}

/* Has a step something to do? */
static inline bool is_ready(void)
{
    struct pollfd entry = {fathom_loop_fd(&rig.loop), POLLIN, 0};
    return poll(&entry, 1, 0) == 1;
}

static inline void add_pin(fathom_loop_pin_t *to, fake_sensor_t *sensor, int fd)
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

static inline int stream_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const ssize_t n = recv(ends[0], bytes, capacity, MSG_DONTWAIT);
    return n == 0 ? -1 : n < 0 ? 0 : (int)n;
}

static inline int stream_fd(const fathom_loop_source_t *source) { return ends[0]; }

/* Reads once. */
static inline bool stream_poll(fathom_loop_source_t *source)
{
    uint8_t bytes[64];
    fathom_rx_t rx = {0, 0};
    const int n = stream.uart.read(stream.uart.ctx, bytes, stream.capacity, &rx);
    if (n > 0) stream.bytes += (unsigned)n;
    stream.is_lost = n < 0;
    return n >= 0;
}

static inline void add_stream(size_t capacity)
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

#endif
