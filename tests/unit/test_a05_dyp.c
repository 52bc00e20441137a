/* SPDX-License-Identifier: MIT */
#include "fathom/a05_dyp.h"
#include "line_bench.h"

/* An A05 that answers the frames 55 AA (A05 2), over a line on the fake UART. SUM is the low byte of the sum of all
 * before it, and 55 + AA = FF. */
enum { STEP_US = 200, GUARD = 0xA5 };

/* A05 2(3)3 with the sum put right, and 2(3)4. */
static const uint8_t ask_all[] = {0x55, 0xAA, 0x01, 0x01, 0x01};
static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
static const uint16_t four_mm[] = {1000, 2000, 1953, 3562};

static fathom_a05_dyp_config_t config;
static fathom_a05_dyp_t a05;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static int set_up_a05(void **state)
{
    set_up(state);
    memset(&config, 0, sizeof config);
    config.line = &bench.line;
    memset(&a05, 0x5A, sizeof a05);
    return 0;
}

static const suite_t suite = {.set_up = set_up_a05};

static void start(void)
{
    assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_READY);
    sensor = fathom_a05_dyp_sensor(&a05);
}

static fathom_status_t poll_once(void)
{
    uint8_t untouched[sizeof sample];
    memset(&sample, GUARD, sizeof sample);
    memset(untouched, GUARD, sizeof untouched);
    const fathom_status_t status = fathom_poll(&sensor, &sample);
    if (status != FATHOM_READY) assert_memory_equal(&sample, untouched, sizeof untouched);
    return status;
}

static void assert_nothing_for(uint32_t us)
{
    for (uint32_t passed_us = 0; passed_us < us; passed_us += STEP_US) {
        bench.fake.now_us += STEP_US;
        assert_int_equal(poll_once(), FATHOM_PENDING);
    }
}

/* Goes on until the request after `written` others is on its way; returns when that was. */
static uint32_t until_written(size_t written)
{
    for (uint32_t i = 0; bench.fake.written <= written; i++) {
        assert_true(i < 100000);
        assert_nothing_for(STEP_US);
    }
    return bench.fake.writes[written].at_us;
}

/* The status that comes next, within `us`. */
static fathom_status_t next_within(uint32_t us)
{
    for (uint32_t passed_us = 0; passed_us < us; passed_us += STEP_US) {
        const fathom_status_t status = poll_once();
        if (status != FATHOM_PENDING) return status;
        bench.fake.now_us += STEP_US;
    }
    return FATHOM_PENDING;
}

/* ---- all probes ---- */

TEST(four_samples_share_sequence_and_time)
{
    start();
    for (unsigned answer = 1; answer <= 3; answer++) {
        until_written(answer - 1);
        assert_memory_equal(bench.fake.writes[answer - 1].bytes, ask_all, sizeof ask_all);
        assert_nothing_for(205000);
        receive(four, sizeof four);
        const uint32_t heard_us = bench.fake.now_us;
        for (unsigned probe = 1; probe <= 4; probe++) {
            if (probe != 1) assert_int_equal(fathom_due_us(&sensor, 1), 0);
            assert_int_equal(poll_once(), FATHOM_READY);
            assert_int_equal(sample.probe, probe);
            assert_int_equal(sample.sequence, answer);
            assert_int_equal(sample.time_us, heard_us);
            assert_int_equal(sample.raw, four_mm[probe - 1]);
            assert_int_equal(sample.distance_mm, four_mm[probe - 1]);
            assert_int_equal(sample.kind, FATHOM_TARGET);
            assert_int_equal(sample.model, FATHOM_A05);
            assert_int_equal(sample.unit, 1);
            bench.fake.now_us += STEP_US;
        }
        assert_nothing_for(1000);
    }
}

TEST(every_choice_of_several_probes_measures_all_and_hands_over_the_wanted)
{
    for (uint8_t probes = 1; probes != 16; probes++) {
        if ((probes & (probes - 1)) == 0) continue;
        set_up_a05(state);
        config.probes = probes;
        start();
        until_written(0);
        assert_memory_equal(bench.fake.writes[0].bytes, ask_all, sizeof ask_all);
        assert_nothing_for(205000);
        receive(four, sizeof four);
        for (uint8_t probe = 1; probe <= 4; probe++) {
            if ((probes >> (probe - 1) & 1) == 0) continue;
            assert_int_equal(poll_once(), FATHOM_READY);
            assert_int_equal(sample.probe, probe);
            assert_int_equal(sample.distance_mm, four_mm[probe - 1]);
        }
        assert_nothing_for(1000);
    }
}

/* FFFD is no object, FFFE interference of sister models (dyp.h), 0 no object of older firmware; 6001 is outside.
 * FF + 01 + 01 = 101; FF + FD = 1FC; FF + FE = 1FD; 0; 17 + 71 = 88: 01 + FC + FD + 88 = 282. */
TEST(values_mean_what_they_mean_in_the_other_modes)
{
    static const uint8_t odd[] = {0x55, 0xAA, 0x01, 0x01, 0xFF, 0xFD, 0xFF,
                                  0xFE, 0x00, 0x00, 0x17, 0x71, 0x82};
    start();
    until_written(0);
    assert_nothing_for(205000);
    receive(odd, sizeof odd);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.kind, FATHOM_NO_TARGET);
    assert_false(sample.interference);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.kind, FATHOM_NO_TARGET);
    assert_true(sample.interference);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.kind, FATHOM_NO_TARGET);
    assert_int_equal(sample.distance_mm, 0);
    assert_int_equal(poll_once(), FATHOM_ERR_MALFORMED);
    assert_int_equal(a05.base.answer.implausible, 1);
    assert_nothing_for(1000);
}

TEST(the_window_is_the_configs)
{
    config.window.min_mm = 1001;
    config.window.max_mm = 2000;
    start();
    until_written(0);
    assert_nothing_for(205000);
    receive(four, sizeof four);
    assert_int_equal(poll_once(), FATHOM_ERR_MALFORMED);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.probe, 2);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.probe, 3);
    assert_int_equal(poll_once(), FATHOM_ERR_MALFORMED);
    assert_nothing_for(1000);
}

/* ---- one probe ---- */

TEST(one_probe_is_measured_alone)
{
    for (uint8_t probe = 1; probe <= 4; probe++) {
        const uint8_t command = (uint8_t)(0x0F + probe);
        const uint8_t request[] = {0x55, 0xAA, 0x01, command, command}; /* FF + 01 = 100 */
        const uint8_t answer[] = {0x55, 0xAA, 0x01, command, 0x07, 0xA1, (uint8_t)(0xA8 + command)};
        set_up_a05(state);
        config.probes = (uint8_t)(1u << (probe - 1));
        start();
        until_written(0);
        assert_int_equal(bench.fake.writes[0].length, sizeof request);
        assert_memory_equal(bench.fake.writes[0].bytes, request, sizeof request);
        assert_nothing_for(70000);
        receive(answer, sizeof answer);
        assert_int_equal(poll_once(), FATHOM_READY);
        assert_int_equal(sample.probe, probe);
        assert_int_equal(sample.distance_mm, 1953);
        assert_int_equal(sample.sequence, 1);
        assert_nothing_for(1000);
    }
}

/* ---- time ---- */

/* From one command to the next at least 250 ms for all probes, 100 ms for one (A05 2(3)1); the answers are instant. */
static void assert_period(uint8_t probes, uint32_t period_us, uint32_t expected_us)
{
    static const uint8_t first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};
    uint32_t last_us = 0;
    config.probes = probes;
    config.period_us = period_us;
    start();
    for (unsigned n = 0; n != 4; n++) {
        const uint32_t at_us = until_written(n);
        if (n != 0) {
            assert_true(at_us - last_us >= expected_us);
            assert_true(at_us - last_us <= expected_us + 2 * STEP_US);
        }
        last_us = at_us;
        assert_nothing_for(10000);
        if (probes == 0) {
            receive(four, sizeof four);
            for (unsigned i = 0; i != 4; i++) assert_int_equal(poll_once(), FATHOM_READY);
            assert_nothing_for(STEP_US);
            assert_true(fathom_due_us(&sensor, 1) <= expected_us - 10000);
            assert_true(fathom_due_us(&sensor, 1) >= expected_us - 12000);
        } else {
            receive(first_1953, sizeof first_1953);
            assert_int_equal(poll_once(), FATHOM_READY);
        }
    }
}

TEST(commands_keep_the_least_time_between_them)
{
    assert_period(0, 0, 250000);
    set_up_a05(state);
    assert_period(1, 0, 100000);
    set_up_a05(state);
    assert_period(0, 249999, 250000);
    set_up_a05(state);
    assert_period(1, 99999, 100000);
    set_up_a05(state);
    assert_period(0, 300000, 300000);
    set_up_a05(state);
    assert_period(1, 250000, 250000);
}

TEST(the_period_is_kept_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 20000; before_us < 600000; before_us += 70000) {
        set_up_a05(state);
        bench.fake.now_us = UINT32_MAX - before_us;
        bench.fake.busy_until_us = bench.fake.now_us;
        assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_READY);
        assert_period(0, 0, 250000);
    }
}

static void assert_time_out(uint8_t probes, uint32_t timeout_us, uint32_t expected_us)
{
    config.probes = probes;
    config.timeout_us = timeout_us;
    start();
    until_written(0);
    assert_nothing_for(5 * BYTE_US + expected_us - 1000);
    assert_int_equal(next_within(2000), FATHOM_ERR_NO_ANSWER);
    assert_nothing_for(1000);
}

TEST(silence_is_said_after_the_time_out)
{
    assert_time_out(0, 0, 500000);
    set_up_a05(state);
    assert_time_out(8, 0, 200000);
    set_up_a05(state);
    assert_time_out(0, 220000, 220000);
    set_up_a05(state);
    assert_time_out(1, 80000, 80000);
}

TEST(retries_are_the_configs)
{
    config.probes = 1;
    config.retries = 2;
    start();
    assert_int_equal(next_within(2000000), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(bench.fake.written, 3);
}

TEST(a_dead_sensor_is_asked_less_often_and_no_less_than_the_config_says)
{
    config.probes = 1;
    config.backoff_us = 300000;
    start();
    for (unsigned n = 0; n != 8; n++) {
        const uint32_t at_us = until_written(n);
        assert_int_equal(next_within(300000), FATHOM_ERR_NO_ANSWER);
        /* 200 ms of time-out and as much of owing; from the third on the pause: 200, then 300 ms after it. */
        if (n >= 4) assert_true(at_us - bench.fake.writes[n - 1].at_us >= 500000);
        if (n >= 1) assert_true(at_us - bench.fake.writes[n - 1].at_us <= 520000);
    }
}

/* ---- errors ---- */

TEST(errors_leave_the_sample_alone_and_the_sensor_goes_on)
{
    uint8_t damaged[sizeof four];
    memcpy(damaged, four, sizeof four);
    damaged[12] = 0x60; /* as A05 2(3)3 prints it */
    start();
    until_written(0);
    assert_nothing_for(205000);
    receive(damaged, sizeof damaged);
    assert_int_equal(next_within(20000), FATHOM_ERR_CHECKSUM);

    until_written(1);
    assert_nothing_for(205000);
    receive(four, 9);
    assert_int_equal(next_within(20000), FATHOM_ERR_CHECKSUM);

    until_written(2);
    bench.fake.read_fails = true;
    assert_int_equal(poll_once(), FATHOM_ERR_PORT);
    assert_int_equal(poll_once(), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;

    until_written(3);
    assert_nothing_for(205000);
    receive(four, sizeof four);
    assert_int_equal(poll_once(), FATHOM_READY);
    assert_int_equal(sample.sequence, 1);
}

TEST(wrong_arguments_are_refused)
{
    config.line = NULL;
    assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    set_up_a05(state);
    config.address = 255;
    assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    set_up_a05(state);
    config.window.min_mm = 6001;
    assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    for (unsigned probes = 16; probes != 256; probes++) {
        set_up_a05(state);
        config.probes = (uint8_t)probes;
        assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    }
}

TEST(address_and_settings_are_the_configs)
{
    static const uint8_t ask_254[] = {0x55, 0xAA, 0xFE, 0x01, 0xFE}; /* FF + FE + 01 = 1FE */
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    config.address = 254;
    config.settings = &settings;
    start();
    until_written(0);
    assert_memory_equal(bench.fake.writes[0].bytes, ask_254, sizeof ask_254);
    assert_int_equal(bench.fake.writes[0].baud, 9600);
}

TEST(deinit_cancels_what_is_under_way)
{
    start();
    until_written(0);
    fathom_a05_dyp_deinit(&a05);
    assert_null(bench.line.head);
    receive(four, sizeof four);
    run(1000);
    for (unsigned i = 0; i != 4; i++) assert_int_equal(a05.values[i], 0x5A5A);
}
