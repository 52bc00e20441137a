/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
} stage_t;

static void set(stage_t *stage, uint8_t mode)
{
    fathom_sim_a16_config_t config = {.mode = mode, .linger_us = 1};
    bench_init(&stage->bench, &bench_9600);
    stage->fixed.value[0] = 751;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_a16_init(&stage->a16, &config);
    bench_attach(&stage->bench, &stage->a16.device);
}

static const uint8_t ask_realtime[] = {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36};
#define ANSWER 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8

static const suite_t suite = {BENCH_ROUNDS};

/* ---- what is no request ---- */

TEST(every_flipped_bit_is_met_with_silence)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    for (size_t bit = 0; bit < 64; bit++) {
        uint8_t bytes[8];
        memcpy(bytes, ask_realtime, 8);
        bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ (1u << (bit % 8)));
        bench_ask(&s.bench, bytes, 8, 200 * MS);
    }
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.crc_errors, 64);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT(&s.bench, ANSWER);
}

TEST(every_torn_off_request_is_met_with_silence)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    for (size_t length = 1; length < 8; length++) bench_ask(&s.bench, ask_realtime, length, 200 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.crc_errors, 7);
    assert_int_equal(s.a16.device.counters.requests, 0);
}

TEST(garbage_of_any_length_is_met_with_silence)
{
    uint8_t garbage[256];
    uint32_t random = 1;
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    for (size_t length = 1; length <= 256; length++) {
        for (size_t i = 0; i < length; i++) {
            random = (uint32_t)(random * UINT32_C(1103515245) + 12345u);
            garbage[i] = (uint8_t)(random >> 16);
        }
        bench_ask(&s.bench, garbage, length, 5 * MS);
    }
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.crc_errors, 255);
    assert_int_equal(s.a16.device.counters.torn, 1); /* 256 bytes are longer than any frame */
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT(&s.bench, ANSWER);
}

TEST(a_right_crc_does_not_make_a_request_of_another_length)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    ASK(&s.bench, 200 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0x00, 0x36, 0x5F); /* 9 bytes */
    ASK(&s.bench, 200 * MS, 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8);             /* an answer, 7 bytes */
    ASK(&s.bench, 200 * MS, 0x01, 0x83, 0x02, 0xC0, 0xF1);                         /* an exception */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.unserved, 3);
    assert_int_equal(s.a16.device.counters.measurements, 0);
}

TEST(the_crc_of_nothing_is_no_broadcast)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    ASK(&s.bench, 10 * MS, 0xFF, 0xFF);       /* the CRC of no bytes is FF FF */
    ASK(&s.bench, 10 * MS, 0x01, 0x7E, 0x80); /* an address and its CRC */
    assert_int_equal(s.a16.device.counters.crc_errors, 2);
    assert_int_equal(s.a16.device.counters.requests, 0);
    bench_wait(&s.bench, 1000 * MS);
    assert_true(s.a16.device.counters.automatic >= 10);
}

TEST(frames_are_divided_by_t35_and_an_a16_minds_no_shorter_gap)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    for (size_t first = 1; first < 8; first++) {
        bench_ask(&s.bench, ask_realtime, first, 3600); /* t3.5 is 3645.8 us */
        bench_ask(&s.bench, ask_realtime + first, 8 - first, 200 * MS);
        EXPECT(&s.bench, ANSWER);
        bench_ask(&s.bench, ask_realtime, first, 3700);
        bench_ask(&s.bench, ask_realtime + first, 8 - first, 200 * MS);
        EXPECT_SILENCE(&s.bench);
    }
    assert_int_equal(s.a16.device.counters.crc_errors, 14);
}

/* ---- half-duplex ---- */

TEST(a_device_hears_nothing_while_it_serves_a_request)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS);
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS); /* it is measuring */
    assert_int_equal(s.a16.device.counters.unheard, 8);
    bench_wait(&s.bench, 500 * MS);
    EXPECT(&s.bench, ANSWER); /* one */
    assert_int_equal(s.a16.device.counters.requests, 1);
}

TEST(a_frame_that_ends_before_the_answer_does_not_open_its_ears)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    s.bench.line.full_duplex = true;
    bench_wait(&s.bench, 89 * MS); /* the request is known at 101 ms, in the frame of 100..104.2 */
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS);
    assert_int_equal(s.bench.heard, 4);
    assert_int_equal(s.a16.device.counters.requests, 1);
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS); /* before the answer */
    assert_int_equal(s.a16.device.counters.unheard, 8);
    bench_wait(&s.bench, 500 * MS);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0, ANSWER);
    assert_int_equal(s.a16.device.counters.requests, 1);
}

TEST(a_request_that_begins_during_an_answer_is_lost_with_it)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    bench_ask(&s.bench, ask_realtime, 8, 5 * MS);
    while (s.bench.heard < 3) bench_wait(&s.bench, 100);
    bench_ask(&s.bench, ask_realtime, 8, 500 * MS);
    assert_int_equal(s.bench.heard, 7);
    assert_int_equal(s.a16.device.counters.requests, 1);
    assert_true(s.a16.device.counters.unheard >= 3);
    assert_true(s.a16.device.counters.unheard < 8); /* the rest was heard, and is no frame */
    assert_int_equal(s.a16.device.counters.crc_errors + s.a16.device.counters.torn, 1);
    assert_true(s.bench.line.counters.collisions >= 4);
    assert_memory_not_equal(s.bench.bytes, ((const uint8_t[]){ANSWER}), 7); /* the host hears a mess */
}

TEST(an_automatic_frame_deafens_a_device_on_two_wires)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO); /* full_duplex stays false */
    bench_wait(&s.bench, 95 * MS);
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS); /* the frame begins in the middle of it */
    assert_int_equal(s.a16.device.counters.requests, 0);
    assert_true(s.a16.device.counters.unheard >= 3);
    assert_int_equal(s.a16.device.counters.torn, 1);
    assert_int_equal(s.a16.device.counters.crc_errors, 0);
    bench_ask(&s.bench, ask_realtime, 8, 20 * MS); /* between two frames it hears */
    assert_int_equal(s.a16.device.counters.requests, 1);
}

TEST(the_host_hears_itself_only_with_echo)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.bench.line.echo = true;
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT(&s.bench, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36, ANSWER);
}

/* ---- time ---- */

TEST(sent_turns_true_with_the_last_stop_bit)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    assert_true(fathom_sim_sent(&s.bench.line, s.bench.now_us));
    const uint32_t end_us = bench_say(&s.bench, ask_realtime, 8);
    assert_false(fathom_sim_sent(&s.bench.line, end_us - 1));
    assert_true(fathom_sim_sent(&s.bench.line, end_us));
    assert_int_equal(s.bench.line.counters.from_host, 8);
}

TEST(due_leads_from_event_to_event_and_ends)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    assert_int_equal(fathom_sim_due_us(&s.bench.line, s.bench.now_us), FATHOM_NO_DEADLINE);
    bench_say(&s.bench, ask_realtime, 8);
    size_t steps = 0;
    for (;; steps++) {
        const uint32_t due_us = fathom_sim_due_us(&s.bench.line, s.bench.now_us);
        if (due_us == FATHOM_NO_DEADLINE) break;
        assert_true(due_us > 0); /* never "now" without progress */
        const size_t before = s.bench.heard;
        bench_wait(&s.bench, due_us);
        assert_true(s.bench.heard - before <= 1);
        assert_true(steps < 100);
    }
    EXPECT(&s.bench, ANSWER);
    assert_int_equal(steps, 8 + 1 + 1 + 7); /* bytes, t3.5, the answer, its bytes */
}

TEST(one_jump_and_many_steps_tell_the_same)
{
    stage_t jump, step;
    set(&jump, FATHOM_SIM_A16_AUTO);
    set(&step, FATHOM_SIM_A16_AUTO);
    jump.bench.line.full_duplex = step.bench.line.full_duplex = true;
    bench_say(&jump.bench, ask_realtime, 8);
    bench_say(&step.bench, ask_realtime, 8);
    bench_wait(&jump.bench, 500 * MS);
    for (int i = 0; i < 5000; i++) bench_wait(&step.bench, 100);
    assert_int_equal(jump.bench.heard, step.bench.heard);
    assert_true(jump.bench.heard >= 7);
    assert_memory_equal(jump.bench.bytes, step.bench.bytes, jump.bench.heard);
    assert_memory_equal(jump.bench.end_us, step.bench.end_us, jump.bench.heard * sizeof(uint32_t));
}

TEST(a_time_that_goes_back_changes_nothing)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    bench_wait(&s.bench, 150 * MS);
    assert_int_equal(s.bench.heard, 4);
    fathom_sim_run(&s.bench.line, s.bench.now_us - 100 * MS);
    fathom_sim_run(&s.bench.line, s.bench.now_us - UINT32_C(1800000000));
    assert_int_equal(s.a16.device.counters.automatic, 1);
    bench_wait(&s.bench, 100 * MS);
    assert_int_equal(s.bench.heard, 8);
}

TEST(it_works_for_hours_across_every_wrap)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    for (int i = 0; i < 30; i++) { /* 12.5 hours, 10 wraps */
        bench_wait(&s.bench, UINT32_C(1500000000));
        bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
        EXPECT(&s.bench, ANSWER);
    }
}

/* ---- what the host's UART knows ---- */

TEST(a_read_tells_the_silence_before_and_the_time_of_the_last_byte)
{
    const uint8_t knows = FATHOM_RX_TIMED | FATHOM_RX_SILENCE;
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[64];
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    const uint32_t later_us = s.bench.now_us + 250 * MS;
    /* two frames wait; one read does not span the silence between them */
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, later_us, bytes, sizeof bytes, knows, &rx), 4);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED | FATHOM_RX_SILENCE);
    assert_int_equal(fathom_elapsed_us(rx.last_us, s.bench.now_us), 100 * MS + 4167);
    rx = (fathom_rx_t){0, 0};
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, later_us, bytes, 2, knows, &rx), 2);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED | FATHOM_RX_SILENCE);
    rx = (fathom_rx_t){0, 0};
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, later_us, bytes, sizeof bytes, knows, &rx), 2);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED); /* the rest of the same frame */
    assert_int_equal(fathom_elapsed_us(rx.last_us, s.bench.now_us), 200 * MS + 4167);
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, later_us, bytes, sizeof bytes, knows, &rx), 0);
}

TEST(what_it_does_not_know_it_neither_tells_nor_minds)
{
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[64];
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    const uint32_t later_us = s.bench.now_us + 250 * MS;
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, later_us, bytes, sizeof bytes, 0, &rx), 8);
    assert_int_equal(rx.flags, 0);
}

TEST(bytes_that_nobody_reads_are_lost_and_told)
{
    const uint8_t knows = FATHOM_RX_OVERRUN;
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[512];
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    s.bench.now_us += 6550 * MS; /* 65 frames, 260 bytes */
    assert_int_equal(
        fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, sizeof bytes, knows, &rx), 256);
    assert_int_equal(rx.flags, 0);
    assert_int_equal(s.bench.line.counters.overruns, 4);
    assert_int_equal(s.bench.line.counters.to_host, 256);
    s.bench.now_us += 100 * MS;
    assert_int_equal(
        fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, sizeof bytes, knows, &rx), 4);
    assert_int_equal(rx.flags, FATHOM_RX_OVERRUN);
}

/* ---- rates ---- */

TEST(at_another_rate_or_parity_nobody_understands)
{
    const fathom_line_settings_t even = {9600, FATHOM_PARITY_EVEN, 1};
    const fathom_line_settings_t near = {9700, FATHOM_PARITY_NONE, 1};
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    fathom_sim_set_line(&s.bench.line, &bench_19200, s.bench.now_us);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    fathom_sim_set_line(&s.bench.line, &even, s.bench.now_us);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.wrong_settings, 16);
    assert_int_equal(s.a16.device.counters.torn, 2);
    fathom_sim_set_line(&s.bench.line, &near, s.bench.now_us);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT(&s.bench, ANSWER);
}

TEST(a_stream_at_another_rate_is_garbage_with_framing_errors)
{
    const uint8_t knows = FATHOM_RX_FRAMING;
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[8];
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    fathom_sim_set_line(&s.bench.line, &bench_19200, s.bench.now_us);
    s.bench.now_us += 150 * MS;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, 8, knows, &rx), 1);
        assert_int_equal(rx.flags, FATHOM_RX_FRAMING);
        rx.flags = 0;
    }
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, 8, knows, &rx), 0);
}

TEST(a_read_ends_with_a_byte_that_was_heard_wrong)
{
    const uint8_t knows = FATHOM_RX_FRAMING;
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[8];
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    fathom_sim_set_line(&s.bench.line, &bench_19200, s.bench.now_us);
    /* two characters of the frame are over when the host finds the rate */
    s.bench.now_us += 100 * MS + 2200;
    fathom_sim_set_line(&s.bench.line, &bench_9600, s.bench.now_us);
    s.bench.now_us += 10 * MS;
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, 8, knows, &rx), 1);
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, 8, knows, &rx), 1);
    rx.flags = 0;
    assert_int_equal(fathom_sim_transmit_timed(&s.bench.line, s.bench.now_us, bytes, 8, knows, &rx), 2);
    assert_int_equal(rx.flags, 0);
    assert_memory_equal(bytes, ((const uint8_t[]){0xEF, 0xF0}), 2);
}

/* ---- more than one ---- */

TEST(three_devices_share_a_line_each_at_its_address_and_rate)
{
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps;
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    fathom_sim_a05_config_t a05_config = {.unit = 5, .mode = FATHOM_SIM_A05_MODBUS};
    fathom_sim_hps167s_config_t hps_config = {.unit = 1}; /* the A16's, at another rate */
    fathom_sim_fixed_t second = {{2083, 0, 0, 0}};
    hps_config.scene = fathom_sim_fixed(&second);
    fathom_sim_a05_init(&a05, &a05_config);
    fathom_sim_hps167s_init(&hps, &hps_config);
    bench_attach(&s.bench, &a05.device);
    bench_attach(&s.bench, &hps.device);
    for (int round = 0; round < 3; round++) {
        bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
        EXPECT(&s.bench, ANSWER);
        ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
        EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
        fathom_sim_set_line(&s.bench.line, &bench_19200, s.bench.now_us);
        ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
        EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41);
        fathom_sim_set_line(&s.bench.line, &bench_9600, s.bench.now_us);
    }
    assert_int_equal(s.bench.line.counters.collisions, 0);
    /* on two wires each hears the others' answers too: three from the A05 are frames for somebody else, and
     * so are three of its requests */
    assert_int_equal(s.a16.device.counters.others, 6);
    assert_int_equal(s.a16.device.counters.requests, 3);
    assert_int_equal(hps.device.counters.others, 0); /* those were at another rate */
}

TEST(two_devices_at_one_address_collide)
{
    fathom_sim_a16_t twin;
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    const fathom_sim_a16_config_t config = {.mode = FATHOM_SIM_A16_MODBUS}; /* the same seed: the same time */
    fathom_sim_a16_init(&twin, &config);
    bench_attach(&s.bench, &twin.device);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    assert_int_equal(s.a16.device.counters.answered, 1);
    assert_int_equal(twin.device.counters.answered, 1);
    assert_int_equal(s.bench.line.counters.collisions, 7);
    assert_int_equal(s.bench.heard, 14);
    for (size_t i = 0; i < 14; i++) assert_int_not_equal(s.bench.bytes[i], ((uint8_t[]){ANSWER})[i / 2]);
}

TEST(a_device_that_comes_in_the_middle_of_a_byte_hears_the_next_request)
{
    fathom_sim_a05_t a05;
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    const fathom_sim_a05_config_t config = {.unit = 5, .mode = FATHOM_SIM_A05_MODBUS};
    fathom_sim_a05_init(&a05, &config);
    bench_say(&s.bench, ask_realtime, 8);
    bench_wait(&s.bench, 3600);
    bench_attach(&s.bench, &a05.device);
    bench_wait(&s.bench, 200 * MS);
    EXPECT(&s.bench, ANSWER);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
    bench_say(&s.bench, ask_realtime, 8);
    while (s.bench.heard < 3) bench_wait(&s.bench, 100); /* and once more, in an answer */
    bench_wait(&s.bench, 300);
    fathom_sim_detach(&s.bench.line, &a05.device, s.bench.now_us);
    bench_attach(&s.bench, &a05.device);
    bench_wait(&s.bench, 50 * MS);
    EXPECT(&s.bench, ANSWER);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
}

TEST(a_device_that_is_taken_off_in_mid_answer_leaves_the_others_hearing)
{
    fathom_sim_a05_t a05;
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    const fathom_sim_a05_config_t config = {.unit = 5, .mode = FATHOM_SIM_A05_MODBUS};
    fathom_sim_a05_init(&a05, &config);
    bench_attach(&s.bench, &a05.device);
    ASK(&s.bench, 5 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    while (s.bench.heard < 3) bench_wait(&s.bench, 100);
    bench_wait(&s.bench, 300);
    fathom_sim_detach(&s.bench.line, &a05.device, s.bench.now_us);
    bench_wait(&s.bench, 50 * MS);
    assert_int_equal(s.bench.heard, 3);
    bench_forget(&s.bench);
    bench_ask(&s.bench, ask_realtime, 8, 200 * MS);
    EXPECT(&s.bench, ANSWER);
    /* and it comes back as from power-on */
    bench_attach(&s.bench, &a05.device);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
}
