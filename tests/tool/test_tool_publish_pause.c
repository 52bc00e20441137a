/* SPDX-License-Identifier: MIT */
/* fathom publish and a broker that is not there, or that closes each connection: how long it pauses before it tries again. The
 * broker's port is a real one, on which the test listens or nothing does; the time is the test's. */
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
static int listener;

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
    memset(&settings, 0, sizeof settings);
    (void)strcpy(settings.broker.host, "127.0.0.1");
    (void)strcpy(settings.broker.client_id, "test");
    settings.broker.keep_alive_s = 30;
    listener = refusing_socket(&settings.broker.port);
    time_us = 1000;
    assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_OK);
    broker_begin(&broker, &host, &loop, &settings, NULL, NULL);
    return 0;
}

static int tear_down(void **state)
{
    broker_end(&broker);
    fathom_loop_deinit(&loop);
    return close(listener);
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

/* ---- another client has the same id ---- */

static void step_until(broker_phase_t phase)
{
    for (unsigned turn = 0; broker.phase != phase; turn++) {
        assert_true(turn != PATIENCE);
        fathom_loop_step(&loop, 10000);
        (void)broker_tick(&broker);
    }
}

/* The broker accepts the client, and closes the connection after this time. Returns the pause. */
static uint32_t pause_after_a_close(uint32_t lasts_us)
{
    static const uint8_t accepted[] = {0x20, 2, 0, 0}; /* CONNACK: MQTT 3.1.1, 3.2 */
    uint8_t bytes[256];
    (void)broker_tick(&broker);
    const int fd = accept(listener, NULL, NULL);
    assert_true(fd >= 0 && recv(fd, bytes, sizeof bytes, 0) > 0);
    assert_int_equal(send(fd, accepted, sizeof accepted, 0), sizeof accepted);
    step_until(BROKER_READY);
    time_us += lasts_us;
    (void)broker_tick(&broker);
    (void)close(fd);
    step_until(BROKER_PAUSE);
    return (uint32_t)(broker.until_us - time_us);
}

static void sleep_for(uint32_t us) { time_us += us; }

static void expect_contested(bool is_contested)
{
    assert_int_equal(strstr(broker.reason, "it accepts the client test and soon closes") != NULL,
                     is_contested);
}

/* What the other client does: a connection lasts for the pause of the other one, up to a minute. */
TEST(of_two_clients_with_one_id_each_pauses_longer_until_a_connection_lasts_for_two_minutes)
{
    static const uint32_t longest_ms[TRIES] = {0, 500, 1000, 2000, 4000, 8000, 16000, 32000, 60000, 60000};
    assert_int_equal(listen(listener, 1), 0);
    for (unsigned i = 0; i != TRIES; i++) {
        const uint32_t pause_us = pause_after_a_close(i < 2 ? 9000000 : 60000000);
        assert_in_range(pause_us, longest_ms[i] * 500, longest_ms[i] * 1000);
        expect_contested(i >= 1);
        time_us += pause_us;
    }
    assert_in_range(pause_after_a_close(120000000), 250000, 500000);
    expect_contested(false);
}

/* A broker that was restarted accepts no client for some time. */
TEST(a_broker_that_is_restarted_again_and_again_is_not_contested)
{
    const uint16_t port = settings.broker.port;
    uint16_t refusing_port;
    const int refusing = refusing_socket(&refusing_port);
    assert_int_equal(listen(listener, 1), 0);
    for (unsigned i = 0; i != 3; i++) {
        settings.broker.port = port;
        sleep_for(pause_after_a_close(1000000));
        assert_int_equal(broker.closes, 1);
        settings.broker.port = refusing_port;
        sleep_for(pause_after_a_try());
    }
    (void)close(refusing);
}

TEST(a_client_without_a_sensor_leaves_a_contested_connection_to_the_other_one)
{
    assert_int_equal(listen(listener, 1), 0);
    broker.yields = true;
    sleep_for(pause_after_a_close(1000000));
    sleep_for(pause_after_a_close(1000000));
    sleep_for(3600000000);
    assert_in_range(broker_tick(&broker), 1, 1000000);
    assert_int_equal(broker.phase, BROKER_PAUSE);
    broker.yields = false;
    (void)pause_after_a_close(1000000); /* it connects */
}
