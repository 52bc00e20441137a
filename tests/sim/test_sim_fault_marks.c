/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

#include "sim/uart.h"

/* What the host's UART says of the bytes, what its clock says, and what is measured. */

enum { SEEDS = 60 };

#define A16_FRAME  0xFF, 0x02, 0xEF, 0xF0
#define A16_ASKED  0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36
#define A16_ANSWER 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8

/* The one byte of the answer that is marked, and wrong; the others are right. */
static size_t marked_byte(const stage_t *s, uint8_t flag)
{
    const uint8_t answer[] = {A16_ANSWER};
    size_t at = SIZE_MAX;
    assert_int_equal(s->count, 7);
    for (size_t i = 0; i < 7; i++) {
        if (s->flags[i] == 0) {
            assert_int_equal(s->bytes[i], answer[i]);
            continue;
        }
        assert_int_equal(s->flags[i], flag);
        assert_int_not_equal(s->bytes[i], answer[i]);
        assert_int_equal(at, SIZE_MAX);
        at = i;
    }
    assert_true(at < 7);
    return at;
}

static void marked(uint8_t kind, uint8_t flag)
{
    uint32_t places = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        stage_set(&s, A16_MODBUS, seed);
        assert_non_null(fathom_sim_fault_add(&s.fault, kind, ALWAYS, 1));
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        places |= 1u << marked_byte(&s, flag);
        assert_int_equal(s.fault.counters[kind], 1);
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        EXPECT_BYTES(&s, A16_ANSWER);
        for (size_t i = 0; i < 7; i++) assert_int_equal(s.flags[i], 0);
    }
    assert_int_equal(places, 0x7F);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(parity_marks_one_wrong_byte) { marked(FATHOM_SIM_FAULT_PARITY, FATHOM_RX_PARITY); }

TEST(framing_marks_one_wrong_byte) { marked(FATHOM_SIM_FAULT_FRAMING, FATHOM_RX_FRAMING); }

TEST(overrun_loses_one_byte_and_marks_the_next_that_comes)
{
    const uint8_t answer[] = {A16_ANSWER};
    uint32_t places = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        size_t at = 6;
        stage_set(&s, A16_MODBUS, seed);
        ADD(&s, OVERRUN, ALWAYS, 1);
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        assert_int_equal(s.count, 6);
        for (size_t i = 0; i < 6; i++)
            if (s.flags[i] != 0) at = i;
        if (at < 6) assert_int_equal(s.flags[at], FATHOM_RX_OVERRUN);
        assert_memory_equal(s.bytes, answer, at);
        assert_memory_equal(s.bytes + at, answer + at + 1, 6 - at);
        places |= 1u << at;
        assert_int_equal(s.bench.line.counters.overruns, 1);
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        EXPECT_BYTES(&s, A16_ANSWER);
        assert_int_equal(s.flags[0], at == 6 ? FATHOM_RX_OVERRUN : 0);
    }
    assert_int_equal(places, 0x7F);
}

TEST(break_is_a_marked_00_before_the_frame)
{
    stage_t s;
    stage_set(&s, A16_AUTO, 1);
    ADD(&s, BREAK, ALWAYS, 2)->us = 5 * MS;
    stage_wait(&s, 150 * MS);
    EXPECT_BYTES(&s, A16_FRAME);
    stage_wait(&s, 100 * MS);
    EXPECT_BYTES(&s, 0x00, A16_FRAME);
    assert_int_equal(s.flags[0], FATHOM_RX_FRAMING);
    for (size_t i = 1; i < 5; i++) assert_int_equal(s.flags[i], 0);
    assert_in_range(s.end_us[1] - s.end_us[0], 5 * MS + 1041, 5 * MS + 1042);
}

TEST(marks_move_with_their_bytes)
{
    stage_t s;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_set(&s, A16_AUTO, seed);
        ADD(&s, PARITY, ALWAYS, 1);
        ADD(&s, DUPLICATE, ALWAYS, 1);
        ADD(&s, BREAK, ALWAYS, 1);
        stage_wait(&s, 150 * MS);
        assert_int_equal(s.count, 9);
        assert_int_equal(s.flags[0], FATHOM_RX_FRAMING);
        const uint8_t frame[] = {A16_FRAME};
        int wrong = 0;
        for (size_t i = 0; i < 8; i++) {
            const bool is_wrong = s.bytes[1 + i] != frame[i % 4];
            assert_int_equal(s.flags[1 + i], is_wrong ? FATHOM_RX_PARITY : 0);
            wrong += is_wrong;
        }
        assert_int_equal(wrong, 2);
        assert_int_equal(s.fault.last_kinds, BIT(PARITY) | BIT(DUPLICATE) | BIT(BREAK));
    }
}

TEST(another_device_takes_a_marked_byte_for_spoiled)
{
    stage_t s;
    fathom_sim_a16_t other;
    stage_set(&s, A16_MODBUS, 1);
    fathom_sim_a16_init(&other, &(fathom_sim_a16_config_t){.unit = 2, .mode = FATHOM_SIM_A16_MODBUS});
    bench_attach(&s.bench, &other.device);
    ADD(&s, FRAMING, ALWAYS, 2);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    assert_int_equal(other.device.counters.others, 2); /* request and answer */
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    assert_int_equal(other.device.counters.others, 3);
    assert_int_equal(other.device.counters.torn, 1);
}

TEST(the_hosts_clock_jumps_and_the_line_does_not)
{
    stage_t s;
    fathom_sim_clock_t clock;
    fathom_sim_uart_t uart;
    uint8_t bytes[16];
    stage_set(&s, A16_AUTO, 1);
    fathom_sim_clock_init(&clock, bench_start_us, 0);
    fathom_sim_uart_init(&uart, &s.bench.line, &clock);
    const fathom_uart_t port = fathom_sim_uart(&uart);
    const fathom_clock_t hal = fathom_sim_clock(&clock);
    s.fault.clock = &clock;
    ADD(&s, CLOCK_JUMP, ALWAYS, 2);
    fathom_sim_clock_advance(&clock, 150 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 150 * MS);
    fathom_sim_clock_advance(&clock, 100 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 10250 * MS);
    assert_int_equal(HITS(&s, CLOCK_JUMP), 1);
    /* a frame from before and one from after it */
    fathom_rx_t rx = {0, 0};
    assert_int_equal(port.read(port.ctx, bytes, 4, &rx), 4);
    assert_in_range(rx.last_us - bench_start_us, 104166, 104168);
    rx = (fathom_rx_t){0, 0};
    assert_int_equal(port.read(port.ctx, bytes, 16, &rx), 4);
    assert_in_range(rx.last_us - bench_start_us, 10204166, 10204168);
    assert_memory_equal(bytes, ((const uint8_t[]){A16_FRAME}), 4);
    /* the second jump counts from the first */
    fathom_sim_clock_advance(&clock, 100 * MS);
    fathom_sim_clock_jump(&clock, clock.now_us, 5000 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 15350 * MS);
    rx = (fathom_rx_t){0, 0};
    assert_int_equal(port.read(port.ctx, bytes, 16, &rx), 4);
    assert_in_range(rx.last_us - bench_start_us, 10304166, 10304168);
    /* much later the stamps still agree with the clock */
    fathom_sim_fault_enable(&s.fault, false);
    for (int i = 0; i < 5; i++) {
        for (int n = 0; n < 100; n++) {
            fathom_sim_clock_advance(&clock, 10000 * MS);
            while (port.read(port.ctx, bytes, 16, &rx) > 0) rx = (fathom_rx_t){0, 0};
        }
        fathom_sim_clock_advance(&clock, 100 * MS);
        rx = (fathom_rx_t){0, 0};
        assert_int_equal(port.read(port.ctx, bytes, 4, &rx), 4);
        assert_true(fathom_elapsed_us(hal.now_us(hal.ctx), rx.last_us) < 100 * MS);
        while (port.read(port.ctx, bytes, 16, &rx) > 0) rx = (fathom_rx_t){0, 0};
    }
}

/* ---- what is measured ---- */

TEST(stuck_says_the_value_of_the_frame_before)
{
    stage_t s;
    stage_set(&s, A16_AUTO, 1);
    ADD(&s, STUCK, ALWAYS, 2)->run = 2;
    stage_wait(&s, 150 * MS);
    EXPECT_BYTES(&s, A16_FRAME); /* 751 */
    s.fixed.value[0] = 1953;
    stage_wait(&s, 200 * MS);
    EXPECT_BYTES(&s, A16_FRAME, A16_FRAME);
    assert_int_equal(s.fault.last_kinds, BIT(STUCK));
    stage_wait(&s, 100 * MS);
    EXPECT_BYTES(&s, 0xFF, 0x07, 0xA1, 0xA7); /* A16 2(3) */
    assert_int_equal(HITS(&s, STUCK), 2);
}

TEST(always_stuck_holds_the_first_value)
{
    stage_t s;
    stage_set(&s, A05_DYP, 1);
    ADD(&s, STUCK, ALWAYS, 0)->code = 1; /* probe 1 only */
    stage_next(&s, A05_DYP);
    expect_golden(&s, A05_DYP);
    assert_int_equal(HITS(&s, STUCK), 0); /* it says what is there */
    for (int i = 0; i < 3; i++) {
        s.fixed.value[0]++;
        stage_next(&s, A05_DYP);
        expect_golden(&s, A05_DYP);
    }
    assert_int_equal(HITS(&s, STUCK), 3);
    s.fixed.value[1] = 2001;
    stage_next(&s, A05_DYP);
    assert_int_equal(s.bytes[7], 0xD1);
}

TEST(no_target_interference_and_fault_are_what_the_sensor_says)
{
    stage_t s;
    stage_set(&s, A16_AUTO, 1);
    ADD(&s, NO_TARGET, ALWAYS, 1);
    ADD(&s, INTERFERENCE, ALWAYS, 2);
    stage_wait(&s, 350 * MS);
    EXPECT_BYTES(&s, 0xFF, 0xFF, 0xFD, 0xFB, 0xFF, 0xFF, 0xFE, 0xFC, A16_FRAME);
    assert_int_equal(HITS(&s, NO_TARGET), 1);
    assert_int_equal(HITS(&s, INTERFERENCE), 1);

    stage_set(&s, A05_AUTO, 1);
    ADD(&s, NO_TARGET, ALWAYS, 0)->code = 2; /* 60 - 07 - D0 + FF + FD = 85 */
    stage_wait(&s, 350 * MS);
    EXPECT_BYTES(&s, 0xFF, 0x03, 0xE8, 0xFF, 0xFD, 0x07, 0xA1, 0x0D, 0xEA, 0x85);

    stage_set(&s, HPS167S, 1);
    ADD(&s, FAULT, ALWAYS, 1);
    ADD(&s, NO_TARGET, ALWAYS, 2);
    stage_next(&s, HPS167S); /* #5: all FF, and magnitude 00 */
    assert_memory_equal(
        s.bytes, ((const uint8_t[]){0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF}), 11);
    assert_true(crc_is_right(s.bytes, s.count));
    stage_next(&s, HPS167S); /* 65530 */
    assert_memory_equal(s.bytes, ((const uint8_t[]){0x01, 0x03, 0x08, 0xFF, 0xFA}), 5);
    assert_true(crc_is_right(s.bytes, s.count));
    stage_next(&s, HPS167S);
    expect_golden(&s, HPS167S);
    assert_int_equal(HITS(&s, FAULT), 1);
    assert_int_equal(HITS(&s, NO_TARGET), 1);
}

TEST(a_frame_that_measures_nothing_is_not_counted_as_hit)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 1);
    ADD(&s, NO_TARGET, ALWAYS, 0);
    stage_ask(&s, LITERAL(0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2), 50 * MS); /* the address */
    assert_int_equal(s.count, 7);
    assert_int_equal(HITS(&s, NO_TARGET), 0);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    assert_int_equal(HITS(&s, NO_TARGET), 1);
}
