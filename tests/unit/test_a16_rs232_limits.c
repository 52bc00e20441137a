/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_rs232.h"
#include "line_bench.h"

/* a16_rs232.h: the way back to automatic output, which a frame ends, or return_us without. */

static fathom_modbus_t transport;
static fathom_a16_modbus_t modbus;
static fathom_a16_auto_t automatic;
static fathom_a16_rs232_t rs232;
static fathom_sample_t sample;

static const uint8_t address_is_1[] = {0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84};
static const uint8_t mode_is_1[] = {0x01, 0x06, 0x02, 0x02, 0x00, 0x01, 0xE8, 0x72};

static fathom_status_t after(uint32_t us)
{
    bench.fake.now_us += us;
    return fathom_a16_rs232_return_to_automatic(&rs232, &sample);
}

static void response_when_sent(size_t written, const uint8_t *bytes, size_t length)
{
    for (unsigned i = 0; bench.fake.written != written; i++) {
        assert_true(i < 10000);
        assert_int_equal(after(100), FATHOM_PENDING);
    }
    assert_int_equal(after(8 * BYTE_US), FATHOM_PENDING);
    receive(bytes, length);
    assert_int_equal(after(0), FATHOM_PENDING);
}

static uint32_t begins_us; /* not 0: the clock then */

/* The address has been read and the mode written; from now on it listens. The memory was full of 01, which is true. */
static int set_up_listening(void **state)
{
    const fathom_a16_auto_config_t listening = {.stale_us = 100000000};
    set_up(state);
    if (begins_us != 0) bench.fake.now_us = bench.fake.busy_until_us = begins_us;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    transport = fathom_modbus_client(&bench.line);
    assert_int_equal(fathom_a16_modbus_init(&modbus, &transport, NULL), FATHOM_OK);
    assert_int_equal(fathom_a16_auto_init(&automatic, &bench.line, &listening), FATHOM_OK);
    memset(&rs232, 0x01, sizeof rs232);
    fathom_a16_rs232_init(&rs232, &modbus, &automatic);
    response_when_sent(1, address_is_1, sizeof address_is_1);
    response_when_sent(2, mode_is_1, sizeof mode_is_1);
    assert_memory_equal(bench.fake.writes[1].bytes, mode_is_1, sizeof mode_is_1);
    return 0;
}

static const suite_t suite = {.set_up = set_up_listening};

/* "FATHOM_OK: *sample is the first reading that the sensor has sent by itself". The frame is A16 2(4). */
static void expect_first_reading(void)
{
    static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};
    memset(&sample, 0xA5, sizeof sample);
    assert_int_equal(after(100000), FATHOM_PENDING);
    receive(mm_1953, sizeof mm_1953);
    assert_int_equal(after(100), FATHOM_PENDING);
    assert_int_equal(after(GAP_US), FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.distance_mm, 1953);
    assert_int_equal(sample.model, FATHOM_A16);
}

TEST(the_first_reading_is_handed_over) { expect_first_reading(); }

TEST(the_first_reading_is_handed_over_where_the_clock_wraps_before_it)
{
    begins_us = 1; /* as long before the wrap as listening takes to begin, and 50 ms */
    set_up_listening(state);
    begins_us = (uint32_t)(0u - (rs232.since_us - begins_us) - 50000);
    set_up_listening(state);
    assert_true(rs232.since_us > UINT32_MAX - 60000);
    expect_first_reading();
    begins_us = 0;
}

/* First contact 8: a module that takes the 7.5 s of A16 5(2) for its first frame is waited for. */
TEST(without_a_frame_it_is_unconfirmed_after_10_s)
{
    assert_int_equal(after(9999999), FATHOM_PENDING);
    assert_int_equal(after(1), FATHOM_ERR_UNCONFIRMED);
}

TEST(how_long_it_waits_is_the_callers_to_say)
{
    rs232.return_us = 30000000;
    assert_int_equal(after(29999999), FATHOM_PENDING);
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 1);
    assert_int_equal(after(1), FATHOM_ERR_UNCONFIRMED);
}

/* "How long until that function has something to do if no byte comes", some time after the last call too. */
TEST(the_end_of_listening_is_due_after_return_us)
{
    rs232.return_us = 2000000;
    assert_int_equal(after(10000), FATHOM_PENDING); /* the line has seen a silence */
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 1990000);
    bench.fake.now_us += 70000;
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 1920000);
    bench.fake.now_us += 1919999;
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 1);
    bench.fake.now_us += 1;
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 0);
    bench.fake.now_us += 1000;
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 0);
}

/* A frame whose value is refused ends nothing, and hides no broken port. 3FDF, 16351 mm: FF + 3F + DF = 21D. */
TEST(a_port_that_breaks_after_a_refused_frame_is_said)
{
    static const uint8_t mm_16351[] = {0xFF, 0x3F, 0xDF, 0x1D};
    assert_int_equal(after(100000), FATHOM_PENDING);
    receive(mm_16351, sizeof mm_16351);
    assert_int_equal(after(100), FATHOM_PENDING);
    assert_int_equal(after(GAP_US), FATHOM_PENDING);
    assert_int_equal(automatic.base.measurement.implausible, 1);
    bench.fake.read_fails = true;
    assert_int_equal(after(100), FATHOM_ERR_PORT);
}
