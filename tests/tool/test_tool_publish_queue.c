/* SPDX-License-Identifier: MIT */
/* The messages of fathom publish that wait for the broker: in order, within their bounds, and what was dropped is counted. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>

#include "mqtt/queue.h"

enum { MOST = 4, SIZE = 4096 };

static queue_t queue;
static streams_t streams;
static stream_t *tank;
static stream_t *gate;

static int set_up(void **state)
{
    assert_true(queue_begin(&queue, MOST, SIZE));
    tank = streams_want(&streams, "mill/tank", STREAM_READINGS, NULL);
    gate = streams_want(&streams, "mill/gate", STREAM_READINGS, NULL);
    return 0;
}

static int tear_down(void **state)
{
    queue_end(&queue);
    streams_free(&streams);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void put(stream_t *stream, const char *text)
{
    const message_t message = {stream, ++stream->seq, (uint32_t)strlen(text)};
    queue_put(&queue, &message, text);
}

static void expect(const stream_t *stream, uint64_t time_us, const char *expected)
{
    message_t message;
    char text[QUEUE_TEXT];
    assert_true(queue_take(&queue, &message, text));
    assert_ptr_equal(message.stream, stream);
    assert_int_equal(message.time_us, time_us);
    assert_string_equal(text, expected);
}

static void expect_nothing(void)
{
    message_t message;
    char text[QUEUE_TEXT];
    assert_false(queue_take(&queue, &message, text));
}

TEST(what_was_put_in_first_comes_out_first)
{
    expect_nothing();
    put(tank, "one");
    put(gate, "two");
    put(tank, "");
    expect(tank, 1, "one");
    expect(gate, 1, "two");
    expect(tank, 2, "");
    expect_nothing();
    assert_int_equal(queue.dropped, 0);
}

TEST(where_one_more_does_not_fit_the_oldest_is_dropped_and_counted_in_its_stream)
{
    put(tank, "1");
    put(gate, "2");
    put(gate, "3");
    put(gate, "4");
    put(gate, "5");
    put(gate, "6");
    assert_int_equal(queue.count, MOST);
    assert_int_equal(queue.dropped, 2);
    assert_int_equal(tank->dropped, 1);
    assert_int_equal(gate->dropped, 1);
    expect(gate, 2, "3");
    put(tank, "7");
    expect(gate, 3, "4");
    expect(gate, 4, "5");
    expect(gate, 5, "6");
    expect(tank, 2, "7");
    expect_nothing();
}

/* So many bytes as three messages of 400 take, less one: the third one drops the first. */
TEST(the_bytes_are_a_bound_too)
{
    char text[401] = "";
    memset(text, 'x', 400);
    assert_true(queue_resize(&queue, 100, 3 * (400 + QUEUE_OVERHEAD) - 1));
    put(tank, text);
    put(tank, text);
    assert_int_equal(queue.dropped, 0);
    put(gate, "short");
    assert_int_equal(queue.dropped, 0);
    put(tank, text);
    assert_int_equal(queue.dropped, 1);
    expect(tank, 2, text);
    expect(gate, 1, "short");
    expect(tank, 3, text);
    expect_nothing();
}

TEST(exactly_as_many_bytes_as_there_are_fit)
{
    char text[401] = "";
    memset(text, 'x', 400);
    assert_true(queue_resize(&queue, 100, 3 * (400 + QUEUE_OVERHEAD)));
    for (int i = 0; i != 3; i++) put(tank, text);
    assert_int_equal(queue.dropped, 0);
    put(tank, text);
    assert_int_equal(queue.dropped, 1);
}

/* Messages of all lengths, in and out at random, beside a list that has them as well: whatever goes round the end. */
TEST(it_is_a_list_whatever_goes_in_and_out)
{
    enum { ROUNDS = 20000, LIST = 64 };
    static char list[LIST][QUEUE_TEXT];
    size_t count = 0;
    uint64_t dropped = 0;
    srand(18);
    assert_true(queue_resize(&queue, LIST - 1, 5000));
    for (int round = 0; round != ROUNDS; round++) {
        if (rand() % 3 != 0) {
            const size_t length = (size_t)rand() % (QUEUE_TEXT - 1);
            for (size_t i = 0; i != length; i++) list[count][i] = (char)('a' + rand() % 26);
            list[count][length] = '\0';
            put(tank, list[count++]);
        } else if (count != 0) {
            message_t message;
            char text[QUEUE_TEXT];
            assert_true(queue_take(&queue, &message, text));
            assert_string_equal(text, list[0]);
            memmove(list[0], list[1], --count * QUEUE_TEXT);
        }
        for (; dropped != queue.dropped; dropped++) memmove(list[0], list[1], --count * QUEUE_TEXT);
        assert_int_equal(queue.count, count);
        assert_true(queue.used <= queue.size);
    }
    assert_true(dropped > 100);
}

TEST(other_bounds_keep_what_fits)
{
    put(tank, "1");
    put(gate, "2");
    put(tank, "3");
    assert_true(queue_resize(&queue, 2, SIZE));
    assert_int_equal(tank->dropped, 1);
    assert_int_equal(queue.dropped, 1);
    assert_true(queue_resize(&queue, 10, 2 * SIZE));
    put(gate, "4");
    expect(gate, 1, "2");
    expect(tank, 2, "3");
    expect(gate, 2, "4");
    assert_int_equal(queue.dropped, 1);
}

/* ---- streams ---- */

TEST(a_sensor_that_is_named_again_goes_on_with_its_numbers)
{
    tank->seq = 7;
    streams_forget(&streams);
    streams_clean(&streams);
    assert_ptr_equal(streams_want(&streams, "mill/tank", STREAM_READINGS, NULL), tank);
    assert_ptr_not_equal(tank, gate);
    assert_int_equal(tank->seq, 7);
    assert_string_equal(gate->topic, "mill/gate");
}

/* A topic that was never sent is not deleted. */
TEST(a_retained_topic_that_is_not_wanted_any_more_is_deleted_once)
{
    stream_t *const online = streams_want(&streams, "mill/status", STREAM_STATUS, NULL);
    stream_t *const other = streams_want(&streams, "mill/publisher", STREAM_PUBLISHER, NULL);
    tank->is_known = gate->is_known = online->is_known = true;
    assert_null(streams_gone(&streams));
    streams_forget(&streams);
    streams_clean(&streams);
    assert_ptr_equal(streams_gone(&streams), online);
    online->is_known = false;
    assert_null(streams_gone(&streams));
    assert_false(other->is_known);
}

TEST(a_retained_topic_is_due_when_it_is_new_or_of_another_sensor_or_when_the_client_has_just_connected)
{
    static const sensor_t one, two;
    stream_t *const stream = streams_want(&streams, "a", STREAM_AVAILABILITY, &one);
    assert_ptr_equal(streams_due(&streams, STREAM_AVAILABILITY), stream);
    assert_null(streams_due(&streams, STREAM_DISCOVERY));
    stream->is_due = false;
    assert_ptr_equal(streams_want(&streams, "a", STREAM_AVAILABILITY, &one), stream);
    assert_null(streams_due(&streams, STREAM_AVAILABILITY));
    (void)streams_want(&streams, "a", STREAM_AVAILABILITY, &two);
    assert_ptr_equal(streams_due(&streams, STREAM_AVAILABILITY), stream);
    stream->is_due = false;
    streams_repeat(&streams);
    assert_ptr_equal(streams_due(&streams, STREAM_AVAILABILITY), stream);
}
