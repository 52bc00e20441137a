/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_auto.h"
#include "line_conversation.h"

/* A program that sleeps for as long as fathom_line_due_us says makes progress with every sleep. */

static const suite_t suite = {.set_up = set_up};

/* Of a response that began in time half has come when the time-out is over: what is next is a byte, or the gap. */
TEST(a_response_that_has_begun_when_its_time_is_over_is_waited_for_until_the_gap)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    receive(response_1_754, 4);
    run_in_steps(3000, 1000);
    expect(FATHOM_PENDING);
    assert_in_range(due(), 1, GAP_US);
    deliver(response_1_754 + 4, 3);
    expect_mm(754);
}

TEST(a_response_that_has_broken_off_when_its_time_is_over_ends_when_it_is_due)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    receive(response_1_754, 4);
    run_in_steps(3000, 1000);
    expect(FATHOM_PENDING);
    const uint32_t due_us = due();
    run_in_steps(due_us, due_us);
    expect(FATHOM_ERR_CHECKSUM);
}

TEST(where_nothing_is_due_no_time_that_passes_brings_it_nearer)
{
    poll_line();
    for (uint32_t passed_us = 1; passed_us < 2000000000; passed_us *= 10) {
        expect_due(FATHOM_NO_DEADLINE);
        bench.fake.now_us += passed_us;
    }
}

/* A request that does not wait: between the poll that sees it leave and the next one it is due at once. */
TEST(without_a_time_out_it_is_due_at_once)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    for (unsigned i = 0; status_of(&bench.request) == FATHOM_PENDING && due() != 0; i++) {
        assert_true(i < 100);
        const uint32_t due_us = due();
        run_in_steps(due_us, due_us);
    }
    expect(FATHOM_PENDING);
    assert_int_equal(bench.request.transaction.attempts, 1);
    run_in_steps(1, 1);
    expect(FATHOM_ERR_NO_RESPONSE);
}

/* ---- while the request leaves; hal.h: leaves_in_us ---- */

#define BEGINS_TO_SEND(in_us) LEAVES_IN(in_us), QUEUE(A, 1), SENT(0, T3_5_US + 200)

static const conversation_t conversations[] = {
    /* "from now": also where much time has passed since the last poll; then the line has seen that the request has left */
    ROW("a_port_that_says_when_the_request_has_left_is_asked_again_right_then", COUNTS(0),
        BEGINS_TO_SEND(8 * BYTE_US), DUE(8 * BYTE_US), PASS(3 * BYTE_US), LEAVES_IN(5 * BYTE_US),
        DUE(5 * BYTE_US), POLL_AFTER(5 * BYTE_US), DUE(TIMEOUT_US)),
    /* the caller holds TX low, and what would end the wait is the other end of the break */
    ROW("in_a_break_nothing_is_due_but_the_end_of_the_wait", COUNTS(0), HOLD(true), QUEUE(A, 1), DUE(0), POLL,
        DUE(1000000)),
    /* 255 bytes of 11 bits at 9600 baud are 292 ms */
    ROW("a_long_request_may_take_longer_than_65_ms", COUNTS(0), BEGINS_TO_SEND(8 * BYTE_US),
        LEAVES_IN(292188), DUE(292188)),
    ROW("a_port_that_does_not_know_when_the_request_has_left_is_asked_each_millisecond", COUNTS(0),
        QUEUE(A, 1), SENT(0, T3_5_US + 200), POLL, DUE(1000), PASS(400), DUE(600)),
    /* "0: they have left, or should have; as long as `sent` is false all the same, the line looks each millisecond": a
     * microsecond that was rounded away is no busy loop */
    ROW("a_port_that_says_0_while_it_sends_all_the_same_is_asked_each_millisecond", COUNTS(0),
        BEGINS_TO_SEND(0), NEVER_SENT(true), POLL_AFTER(1000), DUE(1000), POLL_AFTER(1000), DUE(1000),
        POLL_AFTER(1000), DUE(1000), NEVER_SENT(false), POLL_AFTER(8 * BYTE_US), DUE(TIMEOUT_US)),
    /* bytes of the port may keep it from taking the request */
    ROW("a_port_that_takes_no_request_is_asked_again_when_it_has_sent", COUNTS(0), LEAVES_IN(3 * BYTE_US),
        PORT_REFUSES(true), QUEUE(A, 1), WAIT(T3_5_US + 200), DUE(3 * BYTE_US), PORT_REFUSES(false),
        POLL_AFTER(3 * BYTE_US), WRITTEN(1)),
    /* the next request needs a silence of 3646 us, and an empty frame */
    ROW("with_a_part_of_a_late_response_the_next_request_is_due_after_the_gap",
        COUNTS(.no_responses = 1, .dropped = 4), QUEUE(A, 1), POLL_AFTER(T3_5_US), POLL_AFTER(8 * BYTE_US),
        DUE(TIMEOUT_US), POLL_AFTER(TIMEOUT_US), FAILS(A, NO_RESPONSE), ARRIVE("01 03 02 02"), POLL,
        QUEUE(B, 2), DUE(GAP_US), POLL_AFTER(GAP_US - 1), WRITTEN(1), POLL_AFTER(1), WRITTEN(2)),
};
CONVERSATIONS(set_up, conversations)

/* The clock turns to 0 while the request leaves: it stands 256 us before that when it has begun. */
TEST(when_the_request_has_left_is_right_across_the_wrap_of_the_clock)
{
    bench.fake.now_us = (uint32_t)0 - (T3_5_US + 200) - 256;
    play_leaves_in(&(step_t){.us = 8 * BYTE_US});
    ask_1(0);
    expect_written_after(T3_5_US + 200, 1);
    expect_due(8 * BYTE_US);
    bench.fake.now_us += 2 * BYTE_US;
    assert_in_range(bench.fake.now_us, 0, 2 * BYTE_US);
    expect_due(8 * BYTE_US);
    run_in_steps(8 * BYTE_US, 8 * BYTE_US);
    expect_due(TIMEOUT_US);
}

/* ---- bytes that wait ---- */

/* sensor.h: "how long from now until any of the sensors has something to do": a frame that waits cannot be given while
 * the line holds back what came behind it, which may begin the response. This is an A16 that sends by itself. */
static fathom_a16_auto_t automatic;

static fathom_sensor_t listening(uint32_t stale_us, const char *hex)
{
    const fathom_a16_auto_config_t config = {.stale_us = stale_us};
    fathom_sample_t sample;
    ask_1(0);
    run_in_steps(T3_5_US, T3_5_US);
    run_in_steps(8 * BYTE_US, 8 * BYTE_US);
    expect_due(TIMEOUT_US); /* the request has left with the last poll */
    assert_int_equal(fathom_a16_auto_init(&automatic, &bench.line, &config), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&automatic);
    run_in_steps(10000, 10000);
    receive_hex(hex);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    return sensor;
}

/* Two frames and four such bytes. */
static fathom_sensor_t held(uint32_t stale_us)
{
    return listening(stale_us, "FF 07 A1 A7 FF 07 A1 A7 01 03 02 02");
}

TEST(a_frame_that_waits_behind_bytes_that_are_held_is_due_with_their_gap)
{
    const fathom_sensor_t sensor = held(0);
    fathom_sample_t sample;
    assert_int_equal(fathom_due_us(&sensor, 1), GAP_US);
    bench.fake.now_us += GAP_US;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.raw, 1953);
}

/* Nor can it be stale meanwhile. */
TEST(a_frame_that_waits_beyond_its_deadline_is_due_with_the_gap_too)
{
    const fathom_sensor_t sensor = held(5000);
    assert_int_equal(fathom_due_us(&sensor, 1), GAP_US);
}

TEST(a_silence_behind_a_frame_gives_it_also_with_an_open_transaction)
{
    const fathom_sensor_t sensor = listening(0, "FF 02 EF F0");
    fathom_sample_t sample;
    assert_int_equal(fathom_due_us(&sensor, 1), GAP_US);
    bench.fake.now_us += GAP_US;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 751);
}

/* A frame, and 3 ms behind its two bytes more one that the line holds back too, so that the frame's own gap is over. */
static fathom_sensor_t held_later(void)
{
    const fathom_sensor_t sensor = listening(0, "FF 02 EF F0 01 03");
    fathom_sample_t sample;
    bench.fake.now_us += 3000;
    receive_hex("02");
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(bench.line.received_count, 3);
    bench.fake.now_us += 2000;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(fathom_due_us(&sensor, 1), GAP_US - 2000);
    return sensor;
}

TEST(bytes_that_the_line_holds_back_are_no_silence_behind_a_frame)
{
    const fathom_sensor_t sensor = held_later();
    fathom_sample_t sample;
    bench.fake.now_us += GAP_US - 2000; /* it was no response */
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(automatic.base.stream.counters[FATHOM_STREAM_FRAMES], 0);
    assert_int_equal(automatic.base.stream.counters[FATHOM_STREAM_UNSURE], 1);
}

TEST(a_response_right_behind_a_frame_delays_it_and_no_more)
{
    const fathom_sensor_t sensor = held_later();
    fathom_sample_t sample;
    bench.fake.now_us += 1000;
    receive_hex("02 F2 38 A1"); /* 754 mm */
    poll_line();
    expect_mm(754);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 751);
}
