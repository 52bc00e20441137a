/* SPDX-License-Identifier: MIT */
/* The messages of fathom publish that wait for the broker: in order, within their bounds, and what was dropped is counted. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>

#include "mqtt/queue.h"

enum { MOST = 4, BYTES = 4096 };

static queue_t queue;
static streams_t streams;
static stream_t *tank;
static stream_t *gate;

static int set_up(void **state)
{
    memset(&queue, 0, sizeof queue);
    queue_set_bounds(&queue, MOST, BYTES);
    tank = streams_want(&streams, "mill/tank", STREAM_READINGS, NULL);
    gate = streams_want(&streams, "mill/gate", STREAM_READINGS, NULL);
    return 0;
}

static int tear_down(void **state)
{
    queue_free(&queue);
    streams_free(&streams);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void put(stream_t *stream, const char *text) { queue_put(&queue, stream, ++stream->seq, text); }

static void expect(const stream_t *stream, uint64_t time_us, const char *expected)
{
    message_t *const message = queue_take(&queue);
    assert_non_null(message);
    assert_ptr_equal(message->stream, stream);
    assert_int_equal(message->time_us, time_us);
    assert_string_equal(message->text, expected);
    free(message);
}

TEST(what_was_put_in_first_comes_out_first)
{
    assert_null(queue_take(&queue));
    put(tank, "one");
    put(gate, "two");
    put(tank, "");
    expect(tank, 1, "one");
    put(gate, "three");
    expect(gate, 1, "two");
    expect(tank, 2, "");
    expect(gate, 2, "three");
    assert_null(queue_take(&queue));
    put(tank, "four");
    expect(tank, 3, "four");
    assert_int_equal(queue.dropped, 0);
    assert_int_equal(queue.used, 0);
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
    assert_null(queue_take(&queue));
}

/* Three messages of 400 bytes, and the 0 at the end of each, take exactly as many bytes; one byte less is too few. */
TEST(the_bytes_are_a_bound_too)
{
    enum { THREE = 3 * (401 + sizeof(message_t)) };
    char text[401] = "";
    memset(text, 'x', 400);
    queue_set_bounds(&queue, 100, THREE);
    for (int i = 0; i != 3; i++) put(tank, text);
    assert_int_equal(queue.dropped, 0);
    queue_set_bounds(&queue, 100, THREE - 1);
    assert_int_equal(queue.dropped, 1);
    put(gate, "short");
    assert_int_equal(queue.dropped, 1);
    put(tank, text);
    assert_int_equal(queue.dropped, 2);
    expect(tank, 3, text);
    expect(gate, 1, "short");
    expect(tank, 4, text);
    assert_null(queue_take(&queue));
}

TEST(other_bounds_keep_what_fits)
{
    put(tank, "1");
    put(gate, "2");
    put(tank, "3");
    queue_set_bounds(&queue, 2, BYTES);
    assert_int_equal(tank->dropped, 1);
    assert_int_equal(queue.dropped, 1);
    queue_set_bounds(&queue, 10, 2 * BYTES);
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
