/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "sim/device.h"
#include "truth.h"

/* The judge must be able to say no: each kind of wrong reading, by hand. */

static truth_t truth;

/* Frame after frame of these probes' values, 1 ms apart. */
static void say(uint32_t now_us, int32_t first, int32_t second)
{
    truth_measured(&truth, 1, first);
    truth_measured(&truth, 2, second);
    assert_non_null(truth_leaves(&truth, now_us));
}

static void begin(uint8_t setting)
{
    truth_init(&truth, setting, 0);
    say(1000, 100, 200);
}

EACH_BEGINS(begin(SOAK_A05_MODBUS))
static const suite_t suite = {.set_up = begins};

static fathom_sample_t sample_of(uint8_t probe, uint16_t raw)
{
    fathom_sample_t sample;
    memset(&sample, 0, sizeof sample);
    sample.model = FATHOM_A05;
    sample.kind = FATHOM_TARGET;
    sample.probe = probe;
    sample.raw = sample.distance_mm = raw;
    return sample;
}

static truth_verdict_t ask(uint8_t probe, uint16_t raw, uint32_t now_us, uint32_t since_us)
{
    const fathom_sample_t sample = sample_of(probe, raw);
    return truth_judge(&truth, &sample, now_us, since_us, false);
}

static truth_verdict_t stream(uint8_t probe, uint16_t raw, uint32_t now_us)
{
    const fathom_sample_t sample = sample_of(probe, raw);
    return truth_judge(&truth, &sample, now_us, 0, true);
}

TEST(what_it_has_said_since_the_request_is_right)
{
    assert_int_equal(ask(1, 100, 1500, 900), TRUTH_RIGHT);
    assert_int_equal(ask(2, 200, 1500, 900), TRUTH_RIGHT);
}

TEST(what_it_has_never_said_is_damaged)
{
    assert_int_equal(ask(1, 101, 1500, 900), TRUTH_DAMAGED);
    assert_int_equal(ask(0, 100, 1500, 900), TRUTH_DAMAGED);
    assert_int_equal(ask(5, 100, 1500, 900), TRUTH_DAMAGED);
}

TEST(what_another_probe_has_said_is_permuted) { assert_int_equal(ask(1, 200, 1500, 900), TRUTH_PERMUTED); }

TEST(what_it_has_said_before_the_request_or_says_later_is_stale)
{
    say(3000, 101, 201);
    assert_int_equal(ask(1, 100, 3500, 2000), TRUTH_STALE);
    assert_int_equal(ask(1, 101, 2900, 2000), TRUTH_STALE);
    assert_int_equal(ask(1, 101, 3500, 2000), TRUTH_RIGHT);
}

TEST(a_stream_gives_each_frame_once_and_none_after_a_newer_one)
{
    begin(SOAK_A05_AUTO);
    say(2000, 101, 201);
    assert_int_equal(stream(1, 101, 2500), TRUTH_RIGHT);
    assert_int_equal(stream(2, 201, 2500), TRUTH_RIGHT);
    assert_int_equal(stream(1, 101, 2600), TRUTH_STALE);
    assert_int_equal(stream(1, 100, 2600), TRUTH_STALE);
}

TEST(the_rest_of_a_sample_has_to_follow_from_its_bits)
{
    truth_init(&truth, SOAK_A05_MODBUS, 0);
    say(1000, 100, FATHOM_SIM_NO_TARGET);
    fathom_sample_t sample = sample_of(1, 100);
    sample.distance_mm = 99;
    assert_int_equal(truth_judge(&truth, &sample, 1500, 900, false), TRUTH_DAMAGED);
    sample = sample_of(1, 100);
    sample.kind = FATHOM_NO_TARGET;
    assert_int_equal(truth_judge(&truth, &sample, 1500, 900, false), TRUTH_DAMAGED);
    sample = sample_of(2, 0xFFFD); /* no object */
    assert_int_equal(truth_judge(&truth, &sample, 1500, 900, false), TRUTH_DAMAGED);
    sample.kind = FATHOM_NO_TARGET;
    sample.distance_mm = 0;
    assert_int_equal(truth_judge(&truth, &sample, 1500, 900, false), TRUTH_RIGHT);
}

TEST(what_does_not_speak_for_the_device_is_not_its_word)
{
    truth_init(&truth, SOAK_A05_MODBUS, 0);
    truth_measured(&truth, 1, 100);
    truth_forget(truth_leaves(&truth, 1000));
    assert_int_equal(ask(1, 100, 1500, 900), TRUTH_DAMAGED);
}

/* 5990 distances, eight units, four probes: 187 frames until one comes again. */
TEST(the_scene_repeats_itself_later_than_the_log_reaches)
{
    static truth_t units[8];
    static uint8_t seen[5990 + 1];
    for (uint8_t i = 0; i < 8; i++) truth_init(&units[i], SOAK_A05_MODBUS, i);
    for (uint32_t look = 0; look < 2 * TRUTH_ROOM * TRUTH_PROBES; look++)
        for (uint8_t i = 0; i < 8; i++) {
            const int32_t mm = truth_look(&units[i], 1);
            assert_in_range(mm, 1, 5990);
            assert_int_equal(seen[mm]++, 0);
        }
}
