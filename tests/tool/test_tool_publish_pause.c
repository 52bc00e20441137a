/* SPDX-License-Identifier: MIT */
/* fathom publish and a broker that is not there: how long it pauses before it tries again. The broker's port is a real one, on
 * which nothing listens; the time is the test's. */
#include "suite.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include "mqtt/broker.h"

enum { PATIENCE = 500, TRIES = 10 };

static fathom_loop_t loop;
static broker_t broker;
static publish_settings_t settings;
static uint64_t time_us;

static uint64_t now_us(void *ctx) { return time_us; }

/* Bound and not listening: none can connect, and no other program gets it. */
static int refusing_socket(uint16_t *port)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&address, size), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
    *port = ntohs(address.sin_port);
    return fd;
}

static int set_up(void **state)
{
    static const host_t host = {.now_us = now_us};
    static int fd;
    memset(&settings, 0, sizeof settings);
    (void)strcpy(settings.broker.host, "127.0.0.1");
    (void)strcpy(settings.broker.client_id, "test");
    settings.broker.keep_alive_s = 30;
    fd = refusing_socket(&settings.broker.port);
    *state = &fd;
    time_us = 1000;
    assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_OK);
    broker_begin(&broker, &host, &loop, &settings, NULL, NULL);
    return 0;
}

static int tear_down(void **state)
{
    broker_end(&broker);
    fathom_loop_deinit(&loop);
    return close(*(int *)*state);
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

/* It is refused, and that takes no time. Returns the pause. */
static uint32_t pause_after_a_try(void)
{
    unsigned turn = 0;
    do {
        assert_true(turn++ != PATIENCE);
        (void)broker_tick(&broker);
        fathom_loop_step(&loop, 10000);
    } while (!__atomic_load_n(&broker.thread_has_ended, __ATOMIC_ACQUIRE));
    return broker_tick(&broker);
}

/* 0.5 s, doubled each time up to a minute; each by a random part shorter, half of it at most. */
TEST(the_pause_grows_from_half_a_second_to_a_minute)
{
    static const uint32_t longest_ms[TRIES] = {500,   1000,  2000,  4000,  8000,
                                               16000, 32000, 60000, 60000, 60000};
    unsigned shorter = 0;
    for (unsigned i = 0; i != TRIES; i++) {
        const uint32_t pause_us = pause_after_a_try();
        assert_in_range(pause_us, longest_ms[i] * 500, longest_ms[i] * 1000);
        if (pause_us < longest_ms[i] * 999) shorter++;
        time_us += pause_us - 1;
        assert_int_equal(broker_tick(&broker), 1);
        assert_int_equal(broker.phase, BROKER_PAUSE);
        time_us++;
    }
    assert_true(shorter > TRIES / 2);
}

TEST(another_configuration_is_tried_at_once)
{
    for (unsigned i = 0; i != 5; i++) time_us += pause_after_a_try();
    (void)pause_after_a_try();
    broker_change(&broker);
    (void)broker_tick(&broker);
    assert_int_equal(broker.phase, BROKER_CONNECTING);
    assert_in_range(pause_after_a_try(), 250000, 500000);
}
