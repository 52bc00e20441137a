/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fathom/a05_auto.h"

static fathom_a05_auto_config_t config;
static fathom_a05_auto_t a05;

/* A05 1(3): 1000, 2000, 1953, 3562 mm. */
static const uint8_t example[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};
static const uint16_t distances[] = {1000, 2000, 1953, 3562};

static void start_at(uint32_t now_us)
{
    rig_start(now_us);
    config.line = &rig.line;
    memset(&a05, 0x5A, sizeof a05);
    assert_int_equal(fathom_a05_auto_init(&a05, &config), FATHOM_READY);
    rig.sensor = fathom_a05_auto_sensor(&a05);
}

static void start(void) { start_at(RIG_START_US); }

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void send(const uint8_t frame[10]) { rig_send(frame, 10, 500); }

/* A05 1(2), by hand: FF, each distance high byte first, the low byte of the sum of all before it. */
static void make(uint8_t frame[10], const uint16_t values[4])
{
    unsigned sum = 0xFF;
    frame[0] = 0xFF;
    for (unsigned i = 0; i != 4; i++) {
        frame[1 + 2 * i] = (uint8_t)(values[i] / 256);
        frame[2 + 2 * i] = (uint8_t)(values[i] % 256);
        sum += values[i] / 256u + values[i] % 256u;
    }
    frame[9] = (uint8_t)(sum % 256);
}

static unsigned counter(unsigned which) { return a05.base.stream.counters[which]; }

/* ---- readings ---- */

TEST(the_example_of_the_datasheet_is_four_samples_of_one_sequence_and_time)
{
    send(example);
    assert_int_equal(rig.samples, 4);
    for (unsigned i = 0; i != 4; i++) {
        const fathom_sample_t *const sample = &rig.last[i];
        assert_int_equal(sample->probe, i + 1);
        assert_int_equal(sample->distance_mm, distances[i]);
        assert_int_equal(sample->raw, distances[i]);
        assert_int_equal(sample->kind, FATHOM_TARGET);
        assert_int_equal(sample->model, FATHOM_A05);
        assert_int_equal(sample->unit, 0);
        assert_int_equal(sample->sequence, 1);
        assert_int_equal(sample->time_us, RIG_START_US + RIG_PERIOD_US);
        assert_int_equal(sample->magnitude + sample->precision + sample->ambient, 0);
        assert_false(sample->interference);
    }
}

TEST(one_poll_gives_one_sample_in_the_order_of_the_probes)
{
    rig_run(10000, 1000);
    fake_receive(&rig.fake, 0, example, 10);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += RIG_GAP_US;
    for (unsigned i = 0; i != 4; i++) {
        assert_int_equal(rig_poll(), FATHOM_READY);
        assert_int_equal(rig.sample.probe, i + 1);
        assert_int_equal(fathom_due_us(&rig.sensor, 1), i != 3 ? 0 : 2000000);
    }
    assert_int_equal(rig_poll(), FATHOM_PENDING);
}

TEST(every_frame_is_four_samples_in_loops_from_100_us_to_20_ms)
{
    static const uint32_t steps_us[] = {100, 521, 1042, 3333, 10000, 20000};
    for (unsigned i = 0; i != sizeof steps_us / sizeof *steps_us; i++) {
        start();
        for (unsigned n = 1; n <= 20; n++) {
            rig_send(example, 10, steps_us[i]);
            rig_run(steps_us[i], steps_us[i]);
            assert_int_equal(rig.samples, 4 * n);
            for (unsigned probe = 0; probe != 4; probe++) {
                assert_int_equal(rig.last[probe].sequence, n);
                assert_int_equal(rig.last[probe].distance_mm, distances[probe]);
            }
        }
        assert_int_equal(rig.stales + rig.malformed + rig.ports, 0);
    }
}

TEST(a_new_frame_does_not_mix_into_the_samples_of_the_old_one)
{
    uint8_t newer[10];
    make(newer, (const uint16_t[]){301, 302, 303, 304});
    rig_run(10000, 1000);
    fake_receive(&rig.fake, 0, example, 10);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += RIG_GAP_US;
    assert_int_equal(rig_poll(), FATHOM_READY);
    rig.fake.now_us += 10000;
    assert_int_equal(rig_poll(), FATHOM_READY);
    fake_receive(&rig.fake, 0, newer, 10);
    assert_int_equal(rig_poll(), FATHOM_READY);
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(rig_poll(), FATHOM_READY);
    assert_int_equal(rig.sample.distance_mm, 3562);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += RIG_GAP_US;
    for (unsigned i = 0; i != 4; i++) {
        assert_int_equal(rig_poll(), FATHOM_READY);
        assert_int_equal(rig.sample.distance_mm, 301 + i);
        assert_int_equal(rig.sample.sequence, 2);
    }
}

TEST(codes_mean_nothing_there_for_their_probe_alone)
{
    uint8_t frame[10];
    make(frame, (const uint16_t[]){0xFFFD, 0xFFFE, 0, 6000});
    send(frame);
    assert_int_equal(rig.samples, 4);
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(rig.last[i].kind, FATHOM_NO_TARGET);
        assert_int_equal(rig.last[i].distance_mm, 0);
        assert_true(rig.last[i].interference == (i == 1));
    }
    assert_int_equal(rig.last[0].raw, 0xFFFD);
    assert_int_equal(rig.last[3].kind, FATHOM_TARGET);
    assert_int_equal(rig.last[3].distance_mm, 6000);
}

/* ---- probes ---- */

TEST(every_choice_of_probes_gives_samples_of_those_alone)
{
    for (uint8_t probes = 1; probes <= 15; probes++) {
        uint16_t values[4];
        uint8_t frame[10];
        unsigned fitted = 0;
        for (unsigned i = 0; i != 4; i++) { /* what is not fitted sends what nothing can mean */
            const bool is_fitted = (probes >> i & 1) != 0;
            values[i] = is_fitted ? distances[i] : 0xFFFF;
            fitted += is_fitted;
        }
        make(frame, values);
        config.probes = probes;
        start();
        send(frame);
        assert_int_equal(rig.samples, fitted);
        assert_int_equal(rig.malformed, 0);
        for (unsigned i = 0; i != 4; i++) {
            const bool is_fitted = (probes >> i & 1) != 0;
            assert_int_equal(rig.last[i].probe, is_fitted ? i + 1 : 0);
            assert_int_equal(rig.last[i].distance_mm, is_fitted ? distances[i] : 0);
        }
    }
}

TEST(a_frame_with_one_value_that_cannot_be_is_refused_whole)
{
    for (unsigned i = 0; i != 4; i++) {
        uint16_t values[4];
        uint8_t frame[10];
        memcpy(values, distances, sizeof values);
        values[i] = 6001;
        make(frame, values);
        start();
        send(frame);
        assert_int_equal(rig.samples, 0);
        assert_int_equal(rig.malformed, 1);
        assert_int_equal(a05.base.answer.implausible, 1);
        send(example);
        assert_int_equal(rig.samples, 4);
        assert_int_equal(rig.sample.sequence, 1);
    }
}

TEST(a_window_of_the_users_own_is_kept)
{
    uint8_t frame[10];
    config.window.min_mm = 250;
    config.window.max_mm = 4500;
    start();
    make(frame, (const uint16_t[]){250, 4500, 250, 4500});
    send(frame);
    assert_int_equal(rig.samples, 4);
    make(frame, (const uint16_t[]){250, 4500, 249, 4500});
    send(frame);
    make(frame, (const uint16_t[]){250, 4501, 250, 4500});
    send(frame);
    assert_int_equal(rig.samples, 4);
    assert_int_equal(rig.malformed, 2);
}

/* ---- silence and its absence ---- */

/* 1000, 2000, 2047, 1339 mm; out of step by six 1339, 2047, 1000, 2000 with the same sum: FF + 03 + E8 + 07 + D0 +
 * 07 + FF + 05 + 3B = 407. */
static const uint8_t permutable[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xFF, 0x05, 0x3B, 0x07};

TEST(with_silence_between_frames_probes_are_not_permuted)
{
    static const uint16_t right[] = {1000, 2000, 2047, 1339};
    for (unsigned n = 0; n != 5; n++) {
        send(permutable);
        for (unsigned i = 0; i != 4; i++) assert_int_equal(rig.last[i].distance_mm, right[i]);
    }
    assert_int_equal(rig.samples, 20);
}

TEST(without_silence_probes_are_not_permuted_and_it_turns_stale)
{
    fake_receive(&rig.fake, 0, permutable + 6, 4);
    rig_poll();
    for (unsigned n = 0; n != 400; n++) { /* 4.168 s */
        fake_trickle(&rig.fake, 0, RIG_BYTE_US, permutable, 10);
        rig_run(10 * RIG_BYTE_US, RIG_BYTE_US);
    }
    assert_int_equal(rig.samples + rig.malformed, 0);
    assert_int_equal(rig.stales, 2);
    assert_true(counter(FATHOM_STREAM_AMBIGUOUS) >= 700);
}

/* ---- stale, due, the port, the clock ---- */

TEST(it_is_stale_after_2_s_or_as_the_config_says_and_once_each_time)
{
    send(example);
    rig_run(1999000, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 1);
    rig_run(2000000, 1000);
    assert_int_equal(rig.stales, 2);
    config.stale_us = 700000;
    start();
    rig_run(699000, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 1);
}

TEST(it_works_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us <= 300000; before_us += 30000) {
        start_at(UINT32_MAX - before_us);
        for (unsigned n = 1; n <= 3; n++) {
            send(example);
            assert_int_equal(rig.samples, 4 * n);
            assert_int_equal(rig.sample.time_us, (uint32_t)(n * RIG_PERIOD_US - before_us - 1));
        }
        assert_int_equal(rig.stales, 0);
    }
}

TEST(a_broken_port_is_said_when_the_samples_that_came_before_are_taken)
{
    rig_run(10000, 1000);
    fake_receive(&rig.fake, 0, example, 10);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += RIG_GAP_US;
    assert_int_equal(rig_poll(), FATHOM_READY);
    rig.fake.read_fails = true;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(rig_poll(), FATHOM_READY);
    for (unsigned i = 0; i != 3; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    rig.fake.read_fails = false;
    send(example);
    assert_int_equal(rig.samples, 8);
}

TEST(the_gap_that_counts_is_the_configs)
{
    assert_int_equal(a05.base.stream.listener.gap_us, 5000);
    config.gap_us = 25000;
    start();
    assert_int_equal(a05.base.stream.listener.gap_us, 25000);
}

/* ---- setting up ---- */

TEST(wrong_arguments_are_refused_and_nothing_listens)
{
    fathom_a05_auto_t other;
    fathom_line_listen(&rig.line, NULL);
    for (unsigned probes = 16; probes != 256; probes++) {
        config.probes = (uint8_t)probes;
        assert_int_equal(fathom_a05_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    }
    config.probes = 0;
    config.window.min_mm = 6001;
    assert_int_equal(fathom_a05_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    memset(&config, 0, sizeof config);
    assert_int_equal(fathom_a05_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    assert_null(rig.line.listener);
}

TEST(deinit_stops_listening)
{
    assert_ptr_equal(rig.line.listener, &a05.base.stream.listener);
    fathom_a05_auto_deinit(&a05);
    assert_null(rig.line.listener);
}
