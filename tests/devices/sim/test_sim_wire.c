/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

static const fathom_line_settings_t fast = {230400, FATHOM_PARITY_EVEN, 1};
static const fathom_line_settings_t slow = {1200, FATHOM_PARITY_ODD, 2};

TEST(characters_last_what_their_bits_last)
{
    assert_int_equal(fathom_sim_span_us(&bench_9600, 0), 0);
    assert_int_equal(fathom_sim_span_us(&bench_9600, 1), 1042);    /* 10 bits, 1041.67 us */
    assert_int_equal(fathom_sim_span_us(&bench_9600, 96), 100000); /* no error adds up */
    assert_int_equal(fathom_sim_span_us(&bench_19200, 8), 4584);   /* 11 bits, 4583.33 us */
    assert_int_equal(fathom_sim_span_us(&bench_19200, 13), 7448);
    assert_int_equal(fathom_sim_span_us(&fast, 13), 621);
    assert_int_equal(fathom_sim_span_us(&slow, 256), UINT32_C(2560000)); /* 12 bits, the longest there is */
}

TEST(silences_are_those_of_hps_2_2_3)
{
    assert_int_equal(fathom_sim_gap_us(&bench_19200), 860);
    assert_int_equal(fathom_sim_silence_us(&bench_19200), 2006);
    assert_int_equal(fathom_sim_gap_us(&bench_9600), 1563);
    assert_int_equal(fathom_sim_silence_us(&bench_9600), 3646);
    assert_int_equal(fathom_sim_gap_us(&fast), 750);
    assert_int_equal(fathom_sim_silence_us(&fast), 1750);
}

TEST(settings_match_within_a_fortieth_and_whatever_the_stop_bits)
{
    const fathom_line_settings_t near = {9840, FATHOM_PARITY_NONE, 2};
    const fathom_line_settings_t far = {9841, FATHOM_PARITY_NONE, 1};
    const fathom_line_settings_t even = {9600, FATHOM_PARITY_EVEN, 1};
    assert_true(fathom_sim_same_settings(&near, &bench_9600));
    assert_false(fathom_sim_same_settings(&far, &bench_9600));
    assert_false(fathom_sim_same_settings(&even, &bench_9600));
}

TEST(until_is_right_across_the_wrap_and_zero_for_the_past)
{
    assert_int_equal(fathom_sim_until_us(5, UINT32_MAX), 6);
    assert_int_equal(fathom_sim_until_us(UINT32_MAX, 5), 0);
    assert_int_equal(fathom_sim_until_us(7, 7), 0);
    assert_int_equal(fathom_sim_until_us(UINT32_C(0x80000007), 8), INT32_MAX);
}

TEST(a_sender_takes_what_fits_and_goes_on_without_a_gap)
{
    fathom_sim_sender_t sender = {0};
    uint8_t bytes[300] = {0};
    assert_true(fathom_sim_sender_idle(&sender));
    assert_int_equal(fathom_sim_sender_put(&sender, &bench_9600, bytes, 300, 1000), 256);
    assert_int_equal(fathom_sim_sender_put(&sender, &bench_9600, bytes, 1, 1000), 0);
    assert_int_equal(fathom_sim_sender_next_us(&sender), 1000);
    sender.sent = 96; /* 100 ms later */
    assert_int_equal(fathom_sim_sender_next_us(&sender), 101000);
    assert_int_equal(fathom_sim_sender_put(&sender, &bench_9600, bytes, 300, 101500), 96);
    assert_int_equal(fathom_sim_sender_next_us(&sender), 101000);
    sender.on_wire = true;
    assert_int_equal(fathom_sim_sender_next_us(&sender), 102042);
}

TEST(a_pause_is_before_its_byte_and_gone_with_the_next_bytes_from_idle)
{
    fathom_sim_sender_t sender = {0};
    const uint8_t bytes[4] = {0};
    (void)fathom_sim_sender_put(&sender, &bench_9600, bytes, 4, 1000);
    sender.pauses[0] = (fathom_sim_pause_t){5000, 2};
    sender.paused = 1;
    sender.marked = true;
    sender.sent = 1;
    sender.on_wire = true; /* the second byte ends before the pause, 2083.3 us after the beginning */
    assert_int_equal(fathom_sim_sender_next_us(&sender), 3084);
    sender.sent = 2;
    sender.on_wire = false; /* and the third begins after it */
    assert_int_equal(fathom_sim_sender_next_us(&sender), 8084);
    sender.sent = 4;
    (void)fathom_sim_sender_put(&sender, &bench_9600, bytes, 4, 20000);
    sender.sent = 3;
    assert_int_equal(fathom_sim_sender_next_us(&sender), 23125);
    assert_false(sender.marked);
}
