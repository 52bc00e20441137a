/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/sensor/a16_modbus.h"

/*
 * line.h, fathom_line_was_polled(): the users of one line poll the line once in each round of the main loop.
 * Here a user is a driver of an A16, and a round is one fathom_poll() of each of them.
 */
enum { UNITS = 8, PERIOD_US = 2000000, LOOP_US = 500 };

static fathom_modbus_t modbus;
static fathom_a16_modbus_t drivers[UNITS];
static fathom_sensor_t sensors[UNITS];
static unsigned readings;

static int set_up_units(void **state)
{
    (void)set_up(state);
    show_empty_port();
    modbus = fathom_modbus_client(&bench.line);
    memset(drivers, 0xA5, sizeof drivers);
    for (uint8_t i = 0; i != UNITS; i++) {
        const fathom_a16_modbus_config_t config = {.modbus.address = (uint8_t)(i + 1),
                                                   .modbus.period_us = PERIOD_US,
                                                   .modbus.timeout_us = TIMEOUT_US};
        assert_int_equal(fathom_a16_modbus_init(&drivers[i], &modbus, &config), FATHOM_OK);
        sensors[i] = fathom_a16_modbus_sensor(&drivers[i]);
    }
    readings = 0;
    return 0;
}

static const suite_t suite = {.set_up = set_up_units};

static fathom_status_t poll_sensor(unsigned i)
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&sensors[i], &sample);
    if (status != FATHOM_OK) return status;
    assert_int_equal(sample.address, i + 1);
    assert_int_equal(sample.distance_mm, 100 + i);
    readings++;
    return status;
}

static void poll_all(fathom_status_t status)
{
    for (unsigned i = 0; i != UNITS; i++) assert_int_equal(poll_sensor(i), status);
}

/* One turn of the main loop. The unit that was sent a request responds at once. */
static void round_after(uint32_t us, bool polls_line)
{
    const size_t written = bench.fake.written;
    bench.fake.now_us += us;
    if (polls_line) (void)poll_line();
    for (unsigned i = 0; i != UNITS; i++) (void)poll_sensor(i);
    if (bench.fake.written == written) return;
    const uint8_t unit = bench.fake.writes[written].bytes[0];
    receive_response(unit, (uint16_t)(99 + unit));
}

static unsigned reads_of(void (*turn)(void))
{
    const unsigned before = bench.fake.reads;
    turn();
    return bench.fake.reads - before;
}

static void a_round(void) { round_after(LOOP_US, false); }

static void a_round_with_a_poll_of_the_line(void) { round_after(LOOP_US, true); }

TEST(a_round_of_eight_units_in_which_nothing_arrives_reads_the_port_once)
{
    a_round(); /* each driver submits its request, and knows the poll of set_up() now */
    for (unsigned turn = 0; turn != 10; turn++) {
        if (bench.fake.first != bench.fake.last) break;
        assert_int_equal(reads_of(a_round), 1);
    }
}

TEST(a_program_may_poll_the_line_itself_and_then_no_unit_does)
{
    a_round_with_a_poll_of_the_line();
    assert_int_equal(reads_of(a_round_with_a_poll_of_the_line), 1);
    assert_int_equal(reads_of(a_round_with_a_poll_of_the_line), 1);
}

TEST(a_program_that_forgets_to_poll_the_line_loses_nothing)
{
    for (unsigned turn = 0; turn != 3; turn++) a_round_with_a_poll_of_the_line();
    for (unsigned turn = 0; readings != UNITS; turn++) {
        assert_true(turn < 1000);
        a_round();
    }
}

/* A request that is submitted now would leave too late in the silence (rule 11). */
TEST(a_poll_of_the_line_before_a_sleep_does_not_count)
{
    a_round();
    for (uint32_t asleep_us = 999; asleep_us <= 1000; asleep_us++) {
        bench.fake.now_us += LOOP_US;
        (void)poll_line();
        bench.fake.now_us += asleep_us;
        const unsigned before = bench.fake.reads;
        (void)poll_sensor(0);
        assert_int_equal(bench.fake.reads, before + (asleep_us == 1000));
    }
}

TEST(a_broken_port_is_reported_to_each_unit_at_each_poll)
{
    a_round();
    bench.fake.read_fails = true;
    for (unsigned turn = 0; turn != 3; turn++) {
        bench.fake.now_us += LOOP_US;
        poll_all(FATHOM_ERR_PORT);
    }
    bench.fake.read_fails = false;
    bench.fake.now_us += LOOP_US;
    for (unsigned i = 0; i != UNITS; i++) assert_int_not_equal(poll_sensor(i), FATHOM_ERR_PORT);
    for (unsigned turn = 0; readings != UNITS; turn++) {
        assert_true(turn < 10000);
        a_round();
    }
}

TEST(a_line_that_is_not_initialised_was_never_polled)
{
    static fathom_line_t blank;
    assert_false(fathom_line_was_polled(&blank, 0));
    assert_false(fathom_line_was_polled(&blank, UINT32_MAX));
}
