/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fathom/a16_auto.h"

static fathom_a16_auto_config_t config;
static fathom_a16_auto_t a16;

/* A16 2(4): 1953 mm. Sums by hand: FF + FF + FD = 2FB, FF + FF + FE = 2FC, FF + 0 + 0 = FF, FF + 01 + FF = 1FF,
 * FF + 3F + DF = 21D, FF + 3F + DE = 21C, FF + 01 + F4 = 1F4, FF + 01 + F3 = 1F3. */
static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};
static const uint8_t mm_511[] = {0xFF, 0x01, 0xFF, 0xFF};
static const uint8_t mm_500[] = {0xFF, 0x01, 0xF4, 0xF4};
static const uint8_t mm_499[] = {0xFF, 0x01, 0xF3, 0xF3};
static const uint8_t mm_16350[] = {0xFF, 0x3F, 0xDE, 0x1C};
static const uint8_t mm_16351[] = {0xFF, 0x3F, 0xDF, 0x1D};
static const uint8_t no_object[] = {0xFF, 0xFF, 0xFD, 0xFB};
static const uint8_t interference[] = {0xFF, 0xFF, 0xFE, 0xFC};
static const uint8_t zero[] = {0xFF, 0x00, 0x00, 0xFF};

static void start_at(uint32_t now_us)
{
    rig_start(now_us);
    config.line = &rig.line;
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    rig.sensor = fathom_a16_auto_sensor(&a16);
}

static void start(void) { start_at(RIG_START_US); }

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void send(const uint8_t frame[4]) { rig_send(frame, 4, 500); }

static unsigned counter(unsigned which) { return a16.base.stream.counters[which]; }

/* ---- readings ---- */

TEST(the_example_of_the_datasheet_is_a_sample_with_all_its_members)
{
    send(mm_1953);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(rig.sample.raw, 1953);
    assert_int_equal(rig.sample.kind, FATHOM_TARGET);
    assert_int_equal(rig.sample.model, FATHOM_A16);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig.sample.unit, 0);
    assert_int_equal(rig.sample.probe, 1);
    assert_int_equal(rig.sample.magnitude + rig.sample.precision + rig.sample.ambient, 0);
    assert_false(rig.sample.interference);
    assert_int_equal(rig.sample.time_us, RIG_START_US + RIG_PERIOD_US);
    assert_true(fake_drained(&rig.fake));
}

TEST(a_sample_is_there_5_ms_after_its_last_byte_and_says_when_that_came)
{
    rig_run(20000, 500);
    fake_receive(&rig.fake, 0, mm_1953, 3);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    fake_receive(&rig.fake, 0, mm_1953 + 3, 1);
    const uint32_t came_us = rig.fake.now_us;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += 4999;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1);
    rig.fake.now_us += 1;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_READY);
    assert_int_equal(rig.sample.time_us, came_us);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
}

/* The byte behind it has come in time, but is read only when the silence would have been long enough. */
TEST(a_byte_that_has_come_is_looked_at_before_the_silence)
{
    rig_run(20000, 500);
    fake_receive(&rig.fake, 0, mm_1953, 4);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    fake_receive(&rig.fake, 1042, mm_1953 + 3, 1); /* A7 begins nothing */
    rig_run(20000, 20000);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(counter(FATHOM_STREAM_UNSURE), 1);
}

TEST(every_frame_is_one_sample_in_loops_from_100_us_to_20_ms)
{
    static const uint32_t steps_us[] = {100, 521, 1042, 3333, 10000, 20000};
    for (unsigned i = 0; i != sizeof steps_us / sizeof *steps_us; i++) {
        start();
        for (unsigned n = 1; n <= 20; n++) {
            rig_send(n % 2 != 0 ? mm_1953 : mm_511, 4, steps_us[i]);
            rig_run(steps_us[i],
                    steps_us[i]); /* the last byte came after the last poll, where steps do not divide */
            assert_int_equal(rig.samples, n);
            assert_int_equal(rig.sample.sequence, n);
            assert_int_equal(rig.sample.distance_mm, n % 2 != 0 ? 1953 : 511);
        }
        assert_int_equal(rig.stales + rig.malformed + rig.ports, 0);
    }
}

typedef struct {
    const uint8_t *frame;
    uint8_t kind; /* 0: refused */
    uint16_t raw;
    bool interference;
} reading_t;

static const reading_t readings[] = {
    {mm_511, FATHOM_TARGET, 511, false},
    {mm_16350, FATHOM_TARGET, 16350, false},
    {mm_16351, 0, 0, false},
    {no_object, FATHOM_NO_TARGET, 0xFFFD, false},
    {interference, FATHOM_NO_TARGET, 0xFFFE, true},
    {zero, FATHOM_NO_TARGET, 0, false},
};

TEST(frames_are_target_no_target_or_refused)
{
    for (unsigned i = 0; i != sizeof readings / sizeof *readings; i++) {
        start();
        send(readings[i].frame);
        assert_int_equal(rig.samples, readings[i].kind != 0);
        assert_int_equal(rig.malformed, readings[i].kind == 0);
        assert_int_equal(a16.base.answer.implausible, readings[i].kind == 0);
        if (readings[i].kind == 0) continue;
        assert_int_equal(rig.sample.kind, readings[i].kind);
        assert_int_equal(rig.sample.raw, readings[i].raw);
        assert_int_equal(rig.sample.distance_mm, readings[i].kind == FATHOM_TARGET ? readings[i].raw : 0);
        assert_true(rig.sample.interference == readings[i].interference);
    }
}

TEST(a_window_of_the_users_own_is_kept)
{
    config.window.min_mm = 500;
    config.window.max_mm = 1953;
    start();
    send(mm_499);
    send(mm_16350);
    assert_int_equal(rig.malformed, 2);
    send(mm_500);
    send(mm_1953);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.sample.sequence, 2); /* what was refused has no number */
}

TEST(the_count_of_refused_frames_stops_at_65535)
{
    a16.base.answer.implausible = 65534;
    for (unsigned i = 0; i != 3; i++) {
        send(mm_16351);
        assert_int_equal(rig.malformed, i + 1);
        assert_int_equal(a16.base.answer.implausible, 65535);
    }
}

TEST(a_frame_with_any_wrong_byte_is_no_sample)
{
    for (unsigned at = 0; at != 4; at++) {
        uint8_t frame[4];
        memcpy(frame, mm_1953, 4);
        frame[at] ^= 0x40;
        send(frame);
    }
    assert_int_equal(rig.samples + rig.malformed, 0);
    send(mm_1953);
    assert_int_equal(rig.samples, 1);
}

TEST(the_time_is_the_ports_stamp_where_it_has_one)
{
    static const uint32_t starts_us[] = {1000, UINT32_MAX - 60000, UINT32_MAX - 45000};
    for (unsigned i = 0; i != 3; i++) {
        start_at(starts_us[i]);
        rig_run(40000, 20000);
        const uint32_t came_us = rig.fake.now_us + 7000;
        fake_receive_rx(&rig.fake, 8000, mm_1953, 4, (fathom_rx_t){came_us, FATHOM_RX_TIMED});
        rig_run(20000, 20000);
        assert_int_equal(rig.samples, 1);
        assert_int_equal(rig.sample.time_us, came_us);
    }
}

/* ---- silence and its absence ---- */

/* 511 mm held still is FF FF 01 FF a byte out of step: 65281 mm, with a good sum. */
TEST(with_silence_between_frames_511_mm_is_511_mm)
{
    for (unsigned i = 0; i != 10; i++) {
        send(mm_511);
        assert_int_equal(rig.sample.distance_mm, 511);
    }
    assert_int_equal(rig.samples, 10);
}

static void run_without_gaps(const uint8_t frame[4], unsigned frames)
{
    for (unsigned i = 0; i != frames; i++) {
        fake_trickle(&rig.fake, 0, RIG_BYTE_US, frame, 4);
        rig_run(4 * RIG_BYTE_US, RIG_BYTE_US / 2);
    }
}

TEST(without_silence_511_mm_is_never_shown_and_turns_stale)
{
    fake_receive(&rig.fake, 0, mm_511 + 2, 2); /* it was heard from within a frame on */
    rig_poll();
    run_without_gaps(mm_511, 1000); /* 4.168 s */
    assert_int_equal(rig.samples + rig.malformed, 0);
    assert_int_equal(rig.stales, 2);
    assert_true(counter(FATHOM_STREAM_AMBIGUOUS) > 1000);
}

TEST(without_silence_a_value_with_one_alignment_is_shown)
{
    fake_receive(&rig.fake, 0, mm_1953 + 2, 2);
    rig_poll();
    run_without_gaps(mm_1953, 10);
    assert_int_equal(rig.samples, 8); /* all but the first and the last, which nothing vouches for */
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(counter(FATHOM_STREAM_UNSURE), 1);
}

TEST(the_gap_that_counts_is_the_configs)
{
    config.gap_us = 25000;
    start();
    assert_int_equal(a16.base.stream.listener.gap_us, 25000);
    rig_run(10000, 500);
    for (unsigned i = 0; i != 5; i++) { /* pauses of 20 ms, which 5000 us would call gaps */
        fake_receive(&rig.fake, 0, mm_511, 4);
        rig_run(20000, 500);
    }
    assert_int_equal(rig.samples, 0);
    rig_run(5500, 500);
    fake_receive(&rig.fake, 0, mm_511, 4);
    rig_poll();
    rig_run(24500, 500);
    assert_int_equal(rig.samples, 0);
    rig_run(500, 500);
    assert_int_equal(rig.samples, 1);
}

/* ---- stale ---- */

TEST(it_is_stale_after_2_s_and_says_so_once_every_2_s)
{
    rig_run(1999000, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 1);
    rig_run(1999000, 1000);
    assert_int_equal(rig.stales, 1);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 2);
    assert_int_equal(counter(FATHOM_STREAM_STALES), 2);
}

TEST(every_good_frame_begins_the_deadline_again)
{
    config.stale_us = 300000;
    start();
    for (unsigned i = 0; i != 5; i++) {
        send(i == 2 ? mm_16351 : mm_1953);
        rig_run(150000, 500);
    }
    assert_int_equal(rig.stales, 0);
    rig_run(149000, 500);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 500);
    assert_int_equal(rig.stales, 1);
    send(mm_1953);
    assert_int_equal(rig.samples, 5);
}

TEST(noise_does_not_keep_it_from_turning_stale)
{
    static const uint8_t noise[] = {0x00, 0xFF, 0x13};
    for (unsigned i = 0; i != 200; i++) {
        fake_receive(&rig.fake, 0, noise, sizeof noise);
        rig_run(10000, 5000);
    }
    assert_int_equal(rig.stales, 1);
    assert_int_equal(counter(FATHOM_STREAM_BYTES), 600);
}

TEST(it_works_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us <= 300000; before_us += 30000) {
        start_at(UINT32_MAX - before_us);
        for (unsigned n = 1; n <= 3; n++) {
            send(mm_511);
            assert_int_equal(rig.samples, n);
            assert_int_equal(rig.sample.time_us, (uint32_t)(n * RIG_PERIOD_US - before_us - 1));
        }
        assert_int_equal(rig.stales, 0);
    }
    start_at(UINT32_MAX - 1000000);
    rig_run(1999000, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 1);
}

/* ---- due ---- */

TEST(it_is_due_when_a_gap_is_seen_and_then_when_it_turns_stale)
{
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 5000);
    rig_run(5000, 5000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1995000);
    rig.fake.now_us += 995000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1000000);
    fake_receive(&rig.fake, 0, mm_1953, 4);
    rig_poll();
    assert_int_equal(rig.samples, 0);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 5000);
    rig.fake.now_us += 5000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    rig_poll();
    assert_int_equal(rig.samples, 1);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 2000000);
    rig.fake.now_us += 2000000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_ERR_STALE);
}

/* ---- the port ---- */

TEST(a_broken_port_is_said_by_every_poll_until_it_works_again)
{
    send(mm_1953);
    rig.fake.read_fails = true;
    for (unsigned i = 0; i != 5; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    rig.fake.read_fails = false;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    send(mm_1953);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.ports, 5);
}

/* ---- setting up ---- */

TEST(no_line_or_a_window_upside_down_is_refused_and_nothing_listens)
{
    fathom_a16_auto_t other;
    fathom_line_listen(&rig.line, NULL);
    config.window.min_mm = 16351;
    assert_int_equal(fathom_a16_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    config.window.min_mm = 500;
    config.window.max_mm = 499;
    assert_int_equal(fathom_a16_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    memset(&config, 0, sizeof config);
    assert_int_equal(fathom_a16_auto_init(&other, &config), FATHOM_ERR_ARGUMENT);
    assert_null(rig.line.listener);
}

TEST(deinit_stops_listening_unless_another_does)
{
    fathom_a16_auto_t other;
    assert_ptr_equal(rig.line.listener, &a16.base.stream.listener);
    assert_int_equal(fathom_a16_auto_init(&other, &config), FATHOM_READY);
    fathom_a16_auto_deinit(&a16);
    assert_ptr_equal(rig.line.listener, &other.base.stream.listener);
    fathom_a16_auto_deinit(&other);
    assert_null(rig.line.listener);
}
