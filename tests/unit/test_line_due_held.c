/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/sensor/a16_auto.h"

/* fathom_line_due_us(): "how long from now until poll has something to do if no byte comes", to the microsecond. */

static const suite_t suite = {.set_up = set_up};

static void after(uint32_t us)
{
    bench.fake.now_us += us;
    fathom_line_poll(&bench.line);
}

static uint32_t due_us(void) { return fathom_line_due_us(&bench.line); }

/* Asks unit 1; the request leaves with the last poll. */
static void send(void)
{
    ask(&bench.request, 1, &bench.value, 0);
    after(T3_5_US);
    after(8 * BYTE_US);
    assert_int_equal(due_us(), TIMEOUT_US);
}

/* The same of a late response, while another request waits: that needs a silence of 3646 us, and an empty frame. */
TEST(with_a_part_of_a_late_response_the_next_request_is_due_after_the_gap)
{
    send();
    after(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_RESPONSE);
    receive(response_1_754, 4);
    after(0);
    ask(&bench.other, 2, &bench.other_value, 0);
    assert_int_equal(due_us(), GAP_US);
    after(GAP_US - 1);
    assert_int_equal(bench.fake.written, 1);
    after(1);
    assert_int_equal(bench.fake.written, 2);
}

/* sensor.h: "how long from now until any of the sensors has something to do": a frame that waits cannot be given while
 * the line holds back what came behind it, which may begin the response. */
/* An A16 that sends by itself, which has sent two frames and four bytes that may be a response. */
static fathom_sensor_t held(uint32_t stale_us)
{
    static const uint8_t came[] = {0xFF, 0x07, 0xA1, 0xA7, 0xFF, 0x07, 0xA1, 0xA7, 0x01, 0x03, 0x02, 0x02};
    static fathom_a16_auto_t automatic;
    const fathom_a16_auto_config_t config = {.stale_us = stale_us};
    fathom_sample_t sample;
    send();
    assert_int_equal(fathom_a16_auto_init(&automatic, &bench.line, &config), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&automatic);
    after(10000);
    receive(came, sizeof came);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    return sensor;
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
