/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* FIONREAD */
#include "libmodbus_rig.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

/* The port keeps half a response until the rest has come. A program that sleeps in poll(2) is not to be woken before all
 * of that is there. Over TCP itself: other sockets know nothing of it. */

static const uint8_t first[] = {RESPONSE(1)};
static const uint8_t second[] = {RESPONSE(2)};

static int set_up(void **state)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t length = sizeof address;
    assert_int_equal(rig_tcp_set_up(state), 0);
    (void)close(modbus_get_socket(rig.modbus));
    (void)close(rig.far);
    const int listener = socket(AF_INET, SOCK_STREAM, 0);
    const int near = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(listener, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(listener, 1), 0);
    assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &length), 0);
    assert_int_equal(connect(near, (const struct sockaddr *)&address, sizeof address), 0);
    rig.far = accept(listener, NULL, NULL);
    assert_true(rig.far >= 0);
    (void)close(listener);
    return modbus_set_socket(rig.modbus, near);
}

static const suite_t suite = {.set_up = set_up, .tear_down = rig_tear_down};

static fathom_status_t poll_once(void)
{
    rig.fake.now_us += 1000;
    (void)fathom_line_poll(rig.transport.line);
    return (fathom_status_t)status();
}

static void ask(void)
{
    rig_ask_three(&rig.request, 1, 0);
    assert_int_equal(poll_once(), FATHOM_PENDING);
}

/* Sends, and waits until so many bytes stand in the port's socket: if they do not, the alarm ends it. */
static void say_and_arrive(const uint8_t *bytes, size_t length, int in_all)
{
    int there = 0;
    rig_say(bytes, length);
    while (there != in_all) assert_int_equal(ioctl(modbus_get_socket(rig.modbus), FIONREAD, &there), 0);
}

/* Would a program that waits for bytes be woken now? */
static bool wakes(void)
{
    struct pollfd entry = {modbus_get_socket(rig.modbus), POLLIN, 0};
    const int n = poll(&entry, 1, 0);
    assert_true(n >= 0);
    return n != 0;
}

TEST(half_a_response_does_not_wake_a_second_time_and_the_rest_does)
{
    for (size_t cut = 1; cut != sizeof first; cut++) {
        if (cut != 1) assert_int_equal(rig_tear_down(NULL) + set_up(NULL), 0);
        ask();
        assert_false(wakes());
        say_and_arrive(first, cut, (int)cut);
        assert_true(wakes()); /* it may be all there is of a connection that ends */
        assert_int_equal(poll_once(), FATHOM_PENDING);
        assert_false(wakes());
        assert_int_equal(poll_once(), FATHOM_PENDING);
        assert_false(wakes());
        say_and_arrive(first + cut, sizeof first - cut, (int)(sizeof first - cut));
        assert_true(wakes());
        assert_int_equal(poll_once(), FATHOM_OK);
        rig_expect_three();
        assert_false(wakes());
    }
}

TEST(after_a_header_alone_it_waits_for_all_that_the_header_tells)
{
    enum { HEADER = 6 };
    ask();
    say_and_arrive(first, 3, 3);
    assert_int_equal(poll_once(), FATHOM_PENDING);
    say_and_arrive(first + 3, HEADER - 3, HEADER - 3);
    assert_true(wakes()); /* until then its length was not known */
    assert_int_equal(poll_once(), FATHOM_PENDING);
    say_and_arrive(first + HEADER, sizeof first - HEADER - 1, sizeof first - HEADER - 1);
    assert_false(wakes());
    say_and_arrive(first + sizeof first - 1, 1, sizeof first - HEADER);
    assert_true(wakes());
    assert_int_equal(poll_once(), FATHOM_OK);
    rig_expect_three();
}

TEST(the_first_byte_of_the_next_response_wakes_again)
{
    ask();
    say_and_arrive(first, 8, 8);
    assert_int_equal(poll_once(), FATHOM_PENDING);
    say_and_arrive(first + 8, sizeof first - 8, sizeof first - 8);
    assert_int_equal(poll_once(), FATHOM_OK);
    ask();
    say_and_arrive(second, 1, 1);
    assert_true(wakes());
    say_and_arrive(second + 1, sizeof second - 1, sizeof second);
    assert_int_equal(poll_once(), FATHOM_OK);
    rig_expect_three();
}

/* More than the system takes at once. The far end knows of no room before the port has read, and all but a few bytes are
 * not enough: on the loopback interface a segment is as large as the memory for all that has come. */
TEST(half_a_response_behind_a_flood_does_not_stop_the_connection)
{
    enum { FLOOD = 20000, MOST_POLLS = 1000000 };
    static const uint8_t late[] = {OTHER(9)};
    static uint8_t flood[FLOOD * sizeof late + sizeof first];
    size_t sent = 0;
    for (size_t i = 0; i != FLOOD; i++) memcpy(flood + i * sizeof late, late, sizeof late);
    memcpy(flood + FLOOD * sizeof late, first, sizeof first);
    ask();
    for (unsigned polls = 0; status() == FATHOM_PENDING && polls != MOST_POLLS; polls++) {
        const ssize_t n = send(rig.far, flood + sent, sizeof flood - sent, MSG_DONTWAIT);
        if (n > 0) sent += (size_t)n;
        (void)fathom_line_poll(rig.transport.line);
    }
    rig_expect_three();
    assert_int_equal(rig.port.foreign_responses, FLOOD);
}

/* A program connects again by itself, though the port was not broken. */
TEST(half_a_response_of_a_connection_before_is_none_of_this_one)
{
    for (size_t cut = 1; cut != sizeof first; cut++) {
        if (cut != 1) assert_int_equal(rig_tear_down(NULL) + set_up(NULL), 0);
        ask();
        say_and_arrive(second, cut, (int)cut);
        assert_int_equal(poll_once(), FATHOM_PENDING);
        rig_connect();
        rig_say(first, sizeof first);
        assert_int_equal(poll_once(), FATHOM_OK);
        rig_expect_three();
    }
}
