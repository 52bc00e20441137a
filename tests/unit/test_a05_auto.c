/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a05_auto.h"

/* Its four probes, and power-on; test_driver_contract.c has what every listener promises. */

static fathom_a05_auto_config_t config;
static fathom_a05_auto_t a05;
static fake_pin_t pin;
static uint8_t memory; /* of the driver, before init */

/* A05 1(3): 1000, 2000, 1953, 3562 mm. */
static const uint8_t example[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};
static const uint16_t distances[] = {1000, 2000, 1953, 3562};

static void start_at(uint32_t now_us, bool by_pin)
{
    rig_start(now_us);
    fake_pin_init(&pin, &rig.fake);
    pin.level = true;
    config.select = by_pin ? fathom_output_pin(&pin.trigger) : fathom_output_line_break(&rig.line);
    memset(&a05, memory, sizeof a05);
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a05_auto_sensor(&a05);
}

static void start(void) { start_at(RIG_START_US, false); }

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    memory = 0x5A;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void send(uint16_t one, uint16_t two, uint16_t three, uint16_t four)
{
    uint8_t frame[10];
    rig_send(frame, rig_dyp_stream(frame, (const uint16_t[]){one, two, three, four}, 4), 500);
}

/* The example has come, and is there to be taken. */
static void example_is_there(void)
{
    rig_run(10000, 1000);
    fake_receive(&rig.fake, 0, example, 10);
    PENDS(rig_poll());
    rig.fake.now_us += RIG_GAP_US;
}

static void takes(unsigned probe, uint16_t mm, uint16_t sequence)
{
    assert_int_equal(rig_poll(), FATHOM_OK);
    assert_int_equal(rig.sample.probe, probe);
    assert_int_equal(rig.sample.distance_mm, mm);
    assert_int_equal(rig.sample.sequence, sequence);
}

/* ---- readings ---- */

TEST(the_example_of_the_datasheet_is_four_samples_of_one_sequence_and_time)
{
    for (uint16_t n = 1; n <= 3; n++) {
        rig_send(example, 10, 500);
        assert_int_equal(rig.samples, 4 * n);
        for (uint8_t i = 0; i != 4; i++)
            assert_sample(&rig.last[i],
                          (fathom_sample_t){.time_us = RIG_START_US + n * (uint32_t)RIG_PERIOD_US,
                                            .raw = distances[i],
                                            .sequence = n,
                                            .distance_mm = distances[i],
                                            .kind = FATHOM_TARGET,
                                            .model = FATHOM_A05,
                                            .probe = (uint8_t)(i + 1)});
    }
}

TEST(one_poll_gives_one_sample_in_the_order_of_the_probes)
{
    example_is_there();
    for (unsigned i = 0; i != 4; i++) {
        takes(i + 1, distances[i], 1);
        assert_int_equal(fathom_due_us(&rig.sensor, 1), i != 3 ? 0 : 2000000);
    }
    PENDS(rig_poll());
}

TEST(a_value_that_is_no_distance_has_its_meaning_for_its_probe_alone)
{
    static const uint8_t kinds[] = {FATHOM_NO_TARGET, FATHOM_NO_TARGET, FATHOM_UNKNOWN, FATHOM_TARGET};
    send(0xFFFD, 0xFFFE, 0, 6000);
    assert_int_equal(rig.samples, 4);
    for (unsigned i = 0; i != 4; i++) {
        assert_int_equal(rig.last[i].kind, kinds[i]);
        assert_int_equal(rig.last[i].distance_mm, i != 3 ? 0 : 6000);
        assert_int_equal(rig.last[i].interference, i == 1);
    }
    assert_int_equal(rig.last[0].raw, 0xFFFD);
}

/* What is not fitted sends what nothing can mean. */
TEST(every_choice_of_probes_gives_samples_of_those_alone)
{
    for (uint8_t probes = 1; probes <= 15; probes++) {
        uint16_t values[4];
        unsigned fitted = 0;
        for (unsigned i = 0; i != 4; i++) {
            values[i] = (probes >> i & 1) != 0 ? distances[i] : 0xFFFF;
            fitted += probes >> i & 1;
        }
        config.probes = probes;
        start();
        send(values[0], values[1], values[2], values[3]);
        assert_int_equal(rig.samples, fitted);
        assert_int_equal(rig.malformed, 0);
        for (unsigned i = 0; i != 4; i++) {
            const bool is_fitted = (probes >> i & 1) != 0;
            assert_int_equal(rig.last[i].probe, is_fitted ? i + 1 : 0);
            assert_int_equal(rig.last[i].distance_mm, is_fitted ? distances[i] : 0);
        }
    }
}

/* ---- First contact 3: one odd probe does not blind the others ---- */

TEST(between_silences_an_odd_probe_is_refused_alone_and_reported)
{
    static const fathom_model_facts_t model = {.min_mm = 250, .max_mm = 4500};
    config.model = &model;
    for (unsigned i = 0; i != 5; i++) {
        static const uint16_t odd[] = {249, 4501, 0xFFFF, 7000, 250};
        memory = i % 2 == 0 ? 0 : 0x5A;
        start();
        for (unsigned n = 1; n <= 3; n++) {
            send(i == 0 ? odd[i] : 250, i == 1 ? odd[i] : 4500, i == 2 ? odd[i] : 250,
                 i == 3 ? odd[i] : 4500);
            assert_int_equal(rig.samples, n * (i != 4 ? 3 : 4));
            assert_int_equal(rig.malformed, i != 4 ? n : 0);
            assert_int_equal(a05.base.measurement.implausible, i != 4 ? n : 0);
            assert_int_equal(a05.base.measurement.refused_probe, i != 4 ? i + 1 : 0);
            assert_int_equal(a05.base.measurement.refused_raw, i != 4 ? odd[i] : 0);
            assert_int_equal(rig.sample.sequence, n);
        }
        for (unsigned p = 0; p != 4; p++) assert_int_equal(rig.last[p].probe, p != i ? p + 1 : 0);
    }
}

/* 1000 2000 7000 3000 mm, of which the third is out of the window: FF + 03 + E8 + 07 + D0 + 1B + 58 + 0B + B8 = 3F7. */
static const uint8_t odd_third[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x1B, 0x58, 0x0B, 0xB8, 0xF7};

/* Frames without a pause, each taken before the next one comes; what a frame gives is known with the byte behind it. */
static void send_on(unsigned frames, bool after_gap)
{
    if (after_gap) rig_run(10000, 1000);
    for (unsigned n = 0; n != frames; n++) {
        fake_receive(&rig.fake, 0, odd_third, sizeof odd_third);
        rig_run(1000, 1000);
    }
}

TEST(where_the_place_is_not_sure_an_odd_probe_has_all_of_the_frame_refused)
{
    send_on(2, true); /* a silence before the first, and none behind it */
    assert_int_equal(rig.samples, 0);
    assert_int_equal(rig.malformed, 1);
    assert_int_equal(a05.base.measurement.refused_probe, 3);
    assert_int_equal(a05.base.measurement.refused_raw, 7000);
    send_on(1, false); /* the second: one step */
    assert_int_equal(rig.samples, 0);
    assert_int_equal(rig.malformed, 2);
    send_on(3, false); /* three more, in a run in step */
    assert_int_equal(rig.samples, 9);
    assert_int_equal(rig.malformed, 5);
    assert_int_equal(rig.last[2].probe, 0);
    assert_int_equal(rig.last[3].distance_mm, 3000);
}

/* stream.h: silence before it and behind it; two frames without a pause have one each. */
TEST(a_silence_behind_the_second_frame_alone_makes_no_place_sure)
{
    send_on(2, true);
    rig_run(10000, 1000);
    assert_int_equal(rig.malformed, 2);
    assert_int_equal(rig.samples, 0);
}

TEST(an_odd_probe_that_is_not_fitted_is_neither_given_nor_told_in_any_place)
{
    config.probes = 0x0B;
    start();
    send_on(6, true);
    assert_int_equal(rig.samples, 15);
    assert_int_equal(rig.malformed, 0);
}

TEST(a_broken_port_is_said_when_the_samples_that_came_before_are_taken)
{
    example_is_there();
    takes(1, 1000, 1);
    rig.fake.read_fails = true;
    for (unsigned i = 1; i != 4; i++) takes(i + 1, distances[i], 1);
    for (unsigned i = 0; i != 3; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    rig.fake.read_fails = false;
    rig_send(example, 10, 500);
    assert_int_equal(rig.samples, 8);
}

/* ---- power-on: the level of RX in the first second chooses what is sent (A05 1(1)) ---- */

enum { LOW_US = 1500000 };

static void power_on(fathom_dyp_value_t value, fathom_status_t status)
{
    assert_int_equal(fathom_a05_auto_select(&a05, value), status);
}

static bool is_low(void) { return config.select.ctx == &pin.trigger ? !pin.level : rig.fake.in_break; }

TEST(rx_is_low_for_a_second_and_a_half_for_real_time_values)
{
    static const uint32_t starts_us[] = {1000, 0xFFFFFFFFu - 700000};
    for (unsigned i = 0; i != 4; i++) {
        start_at(starts_us[i / 2], i % 2 == 0);
        rig_run(10000, 1000); /* the silence that begins a frame has been seen */
        power_on(FATHOM_REAL_TIME, FATHOM_OK);
        assert_true(is_low());
        assert_int_equal(fathom_due_us(&rig.sensor, 1), LOW_US);
        rig_run(LOW_US - 1000, 1000);
        assert_true(is_low());
        assert_int_equal(fathom_due_us(&rig.sensor, 1), 1000);
        rig.fake.now_us += 700; /* after the last poll */
        assert_int_equal(fathom_due_us(&rig.sensor, 1), 300);
        rig.fake.now_us += i == 0 ? 300 : 301;
        assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
        PENDS(rig_poll());
        assert_false(is_low());
        assert_true(fathom_due_us(&rig.sensor, 1) > 1000);
    }
}

/* "FATHOM_ERR_ARGUMENT: no such value": not 256 either, where an enumeration can hold it at all. */
TEST(a_value_of_256_is_refused)
{
    if (sizeof(fathom_dyp_value_t) != 1) power_on((fathom_dyp_value_t)256, FATHOM_ERR_ARGUMENT);
}

TEST(rx_is_high_for_processed_values)
{
    power_on(FATHOM_PROCESSED, FATHOM_OK);
    assert_int_equal(rig.fake.breaks, 0);
    start_at(RIG_START_US, true);
    pin.level = false;
    power_on(FATHOM_PROCESSED, FATHOM_OK);
    assert_true(pin.level);
}

/* Processed values end a selection of real-time values at once; a busy port does not accept a break. */
TEST(processed_values_end_a_selection_and_a_busy_port_is_said)
{
    power_on(FATHOM_REAL_TIME, FATHOM_OK);
    assert_true(is_low());
    power_on(FATHOM_PROCESSED, FATHOM_OK);
    assert_false(is_low());
    rig.fake.never_sent = true;
    power_on(FATHOM_REAL_TIME, FATHOM_ERR_BUSY);
    assert_false(is_low());
}

TEST(a_port_that_cannot_is_said_and_a_pin_helps)
{
    rig.fake.uart.set_break = NULL;
    power_on(FATHOM_REAL_TIME, FATHOM_ERR_UNSUPPORTED);
    power_on(FATHOM_PROCESSED, FATHOM_ERR_UNSUPPORTED);
    config.select.set = NULL;
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    power_on(FATHOM_REAL_TIME, FATHOM_ERR_UNSUPPORTED);
    power_on(FATHOM_PROCESSED, FATHOM_OK);
    start_at(RIG_START_US, true);
    rig.fake.uart.set_break = NULL;
    power_on(FATHOM_REAL_TIME, FATHOM_OK);
    assert_int_equal(pin.sets, 1);
}
