/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a05_dyp.h"
#include "line_bench.h"

/* a05_dyp.h: its time-outs and paces, by default and as the config says, of everything that it asks. The line has 9600
 * 8N1 and keeps 3646 us of silence before a request. */

static fathom_a05_dyp_config_t config;
static fathom_a05_dyp_t a05;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static int set_up_a05(void **state)
{
    set_up(state);
    memset(&config, 0, sizeof config);
    return 0;
}

static const suite_t suite = {.set_up = set_up_a05};

static void start(void)
{
    memset(&a05, 0xA5, sizeof a05);
    assert_int_equal(fathom_a05_dyp_init(&a05, &bench.line, &config), FATHOM_OK);
    sensor = fathom_a05_dyp_sensor(&a05);
}

static fathom_status_t measure(void) { return fathom_poll(&sensor, &sample); }
static fathom_status_t set_address(void) { return fathom_a05_dyp_broadcast_address(&a05, 7); }

static fathom_a05_dyp_find_t find;

static fathom_status_t find_address(void)
{
    uint8_t address;
    return fathom_a05_dyp_find(&find, &bench.line, &address);
}

static fathom_status_t after(uint32_t us, fathom_status_t (*command)(void))
{
    bench.fake.now_us += us;
    return command();
}

/* Runs until the next request is on the wire, and then until it has left. */
static void is_sent(fathom_status_t (*command)(void))
{
    const size_t before = bench.fake.written;
    for (unsigned i = 0; bench.fake.written == before; i++) {
        assert_true(i < 20000);
        assert_int_equal(after(100, command), FATHOM_PENDING);
    }
    assert_int_equal(after(5 * BYTE_US, command), FATHOM_PENDING);
}

/* It fails so long after it has left, and not before. */
static void is_silent_for(uint32_t us, fathom_status_t (*command)(void))
{
    assert_int_equal(after(us - 1, command), FATHOM_PENDING);
    assert_int_equal(after(1, command), FATHOM_ERR_NO_RESPONSE);
}

/* "timeout_us; 0: 500 ms for all probes, 200 ms for one". */
TEST(all_probes_have_500_ms_and_one_has_200)
{
    start();
    is_sent(measure);
    is_silent_for(500000, measure);
    set_up_a05(state);
    config.probes = 4;
    start();
    is_sent(measure);
    is_silent_for(200000, measure);
    set_up_a05(state);
    config.modbus.timeout_us = 123456;
    start();
    is_sent(measure);
    is_silent_for(123456, measure);
}

/* FATHOM_A05_DYP_ALL_PROBES_US, FATHOM_A05_DYP_ONE_PROBE_US: "from one command to the next, at least", and no longer.
 * The pace counts from the poll in which the request went out. */
static void is_asked_every(uint32_t us, const uint8_t *response, size_t length)
{
    start();
    is_sent(measure);
    receive(response, length);
    assert_int_equal(after(0, measure), FATHOM_OK);
    while (measure() == FATHOM_OK) {
    }
    /* what one call submits the line sends in the next */
    assert_int_equal(after(us - 5 * BYTE_US - 1, measure), FATHOM_PENDING);
    assert_int_equal(after(0, measure), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(after(1, measure), FATHOM_PENDING);
    assert_int_equal(after(0, measure), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, 2);
}

TEST(all_probes_are_asked_every_250_ms_and_one_every_100)
{
    static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07,
                                   0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
    static const uint8_t first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};
    is_asked_every(250000, four, sizeof four);
    set_up_a05(state);
    config.probes = 1;
    is_asked_every(100000, first_1953, sizeof first_1953);
}

/* "command_timeout_us: of whatever else is asked; 0: 1 s". The first request of a setting is one. */
TEST(a_command_has_1_s_or_what_the_config_says)
{
    start();
    is_sent(set_address);
    is_silent_for(1000000, set_address);
    set_up_a05(state);
    config.modbus.command_timeout_us = 345678;
    start();
    is_sent(set_address);
    is_silent_for(345678, set_address);
}

/* The command itself is acknowledged at once or not at all: the time of one probe is enough. Address 1 answers with
 * 1953 mm, 7 does not, and then 7 is set. */
TEST(setting_the_address_is_waited_for_as_one_probe_is)
{
    static const uint8_t first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};
    static const uint8_t set_7[] = {0x55, 0xAA, 0x07, 0x03, 0x09};
    config.modbus.command_timeout_us = 300000;
    start();
    is_sent(set_address);
    receive(first_1953, sizeof first_1953);
    is_sent(set_address); /* 7 is asked */
    assert_int_equal(after(300000, set_address), FATHOM_PENDING);
    is_sent(set_address);
    assert_memory_equal(bench.fake.writes[2].bytes, set_7, sizeof set_7);
    assert_int_equal(after(199999, set_address), FATHOM_PENDING);
    assert_int_equal(counter(FATHOM_LINE_NO_RESPONSES), 1);
    assert_int_equal(after(1, set_address), FATHOM_PENDING);
    assert_int_equal(counter(FATHOM_LINE_NO_RESPONSES), 2);
}

TEST(finding_ends_if_the_line_is_initialised_again)
{
    memset(&find, 0, sizeof find);
    is_sent(find_address);
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    assert_int_equal(find_address(), FATHOM_ERR_CANCELLED);
    is_sent(find_address); /* again */
    is_silent_for(200000, find_address);
}
