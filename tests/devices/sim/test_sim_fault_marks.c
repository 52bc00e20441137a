/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

#include "sim/uart.h"

/* What the host's UART says of the bytes, what its clock says, and what is measured. */

enum { SEEDS = 60 };

/* The one byte of the response that is marked, and wrong; the others are right. */
static size_t marked_byte(uint8_t flag)
{
    uint8_t response[7];
    from_hex(A16_RESPONSE, response, sizeof response);
    size_t at = SIZE_MAX;
    assert_int_equal(bench.heard, 7);
    for (size_t i = 0; i < 7; i++) {
        if (bench.flags[i] == 0) {
            assert_int_equal(bench.bytes[i], response[i]);
            continue;
        }
        assert_int_equal(bench.flags[i], flag);
        assert_int_not_equal(bench.bytes[i], response[i]);
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
        set_faulty(A16_MODBUS, seed);
        assert_non_null(fathom_sim_fault_add(&bench.fault, kind, ALWAYS, 1));
        next(A16_MODBUS);
        places |= 1u << marked_byte(flag);
        assert_int_equal(bench.fault.counters[kind], 1);
        next_is_golden(A16_MODBUS);
        for (size_t i = 0; i < 7; i++) assert_int_equal(bench.flags[i], 0);
    }
    assert_int_equal(places, 0x7F);
}

EACH_BEGINS(set_faulty(A16_AUTO, 1))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(parity_marks_one_wrong_byte) { marked(FATHOM_SIM_FAULT_PARITY, FATHOM_RX_PARITY); }

TEST(framing_marks_one_wrong_byte) { marked(FATHOM_SIM_FAULT_FRAMING, FATHOM_RX_FRAMING); }

TEST(overrun_loses_one_byte_and_marks_the_next_that_comes)
{
    uint8_t response[7];
    from_hex(A16_RESPONSE, response, sizeof response);
    uint32_t places = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        size_t at = 6;
        set_faulty(A16_MODBUS, seed);
        FAULT(OVERRUN, ALWAYS, 1);
        next(A16_MODBUS);
        assert_int_equal(bench.heard, 6);
        for (size_t i = 0; i < 6; i++)
            if (bench.flags[i] != 0) at = i;
        if (at < 6) assert_int_equal(bench.flags[at], FATHOM_RX_OVERRUN);
        assert_memory_equal(bench.bytes, response, at);
        assert_memory_equal(bench.bytes + at, response + at + 1, 6 - at);
        places |= 1u << at;
        assert_int_equal(bench.line.counters.overruns, 1);
        next_is_golden(A16_MODBUS);
        assert_int_equal(bench.flags[0], at == 6 ? FATHOM_RX_OVERRUN : 0);
    }
    assert_int_equal(places, 0x7F);
}

TEST(break_is_a_marked_00_before_the_frame)
{
    FAULT(BREAK, ALWAYS, 2)->us = 5 * MS;
    hear(150, A16_FRAME);
    hear(100, "00" A16_FRAME);
    assert_int_equal(bench.flags[0], FATHOM_RX_FRAMING);
    for (size_t i = 1; i < 5; i++) assert_int_equal(bench.flags[i], 0);
    assert_in_range(bench.end_us[1] - bench.end_us[0], 5 * MS + 1041, 5 * MS + 1042);
}

TEST(marks_move_with_their_bytes)
{
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        set_faulty(A16_AUTO, seed);
        FAULT(PARITY, ALWAYS, 1);
        FAULT(DUPLICATE, ALWAYS, 1);
        FAULT(BREAK, ALWAYS, 1);
        wait_ms(150);
        assert_int_equal(bench.heard, 9);
        assert_int_equal(bench.flags[0], FATHOM_RX_FRAMING);
        static const uint8_t frame[] = {0xFF, 0x02, 0xEF, 0xF0};
        int wrong = 0;
        for (size_t i = 0; i < 8; i++) {
            const bool is_wrong = bench.bytes[1 + i] != frame[i % 4];
            assert_int_equal(bench.flags[1 + i], is_wrong ? FATHOM_RX_PARITY : 0);
            wrong += is_wrong;
        }
        assert_int_equal(wrong, 2);
        assert_int_equal(bench.fault.last_kinds, BIT(PARITY) | BIT(DUPLICATE) | BIT(BREAK));
    }
}

TEST(another_device_takes_a_marked_byte_for_damaged)
{
    fathom_sim_a16_t other;
    set_faulty(A16_MODBUS, 1);
    fathom_sim_a16_init(&other, &(a16_config_t){.address = 2, .mode = FATHOM_SIM_A16_MODBUS});
    attach(&other.device);
    FAULT(FRAMING, ALWAYS, 2);
    next(A16_MODBUS);
    assert_int_equal(other.device.counters.others, 2); /* request and response */
    next(A16_MODBUS);
    assert_int_equal(other.device.counters.others, 3);
    assert_int_equal(other.device.counters.truncated, 1);
}

static fathom_sim_clock_t host_clock;
static fathom_uart_t port;

/* A frame is there, whose last byte ended so long after the beginning by the host's clock; up to 2 us later. */
static void expect_frame_at(uint32_t at_us)
{
    uint8_t bytes[4];
    fathom_rx_t rx = {0, 0};
    assert_int_equal(port.read(port.ctx, bytes, 4, &rx), 4);
    assert_in_range(rx.last_us - bench_start_us, at_us, at_us + 2);
    assert_true(is_hex(bytes, A16_FRAME));
}

TEST(the_hosts_clock_jumps_and_the_line_does_not)
{
    fathom_sim_uart_t uart;
    uint8_t bytes[16];
    fathom_sim_clock_init(&host_clock, bench_start_us, 0);
    fathom_sim_uart_init(&uart, &bench.line, &host_clock);
    port = fathom_sim_uart(&uart);
    const fathom_clock_t hal = fathom_sim_clock(&host_clock);
    bench.fault.clock = &host_clock;
    FAULT(CLOCK_JUMP, ALWAYS, 2);
    fathom_sim_clock_advance(&host_clock, 150 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 150 * MS);
    fathom_sim_clock_advance(&host_clock, 100 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 10250 * MS);
    assert_int_equal(HITS(CLOCK_JUMP), 1);
    expect_frame_at(104166); /* from before it, and from after it */
    expect_frame_at(10204166);
    /* the second jump counts from the first */
    fathom_sim_clock_advance(&host_clock, 100 * MS);
    fathom_sim_clock_jump(&host_clock, host_clock.now_us, 5000 * MS);
    assert_int_equal(hal.now_us(hal.ctx) - bench_start_us, 15350 * MS);
    expect_frame_at(10304166);
    /* much later the stamps still agree with the clock */
    fathom_sim_fault_enable(&bench.fault, false);
    fathom_rx_t rx = {0, 0};
    for (int i = 0; i < 5; i++) {
        for (int n = 0; n < 100; n++) {
            fathom_sim_clock_advance(&host_clock, 10000 * MS);
            while (port.read(port.ctx, bytes, 16, &rx) > 0) rx = (fathom_rx_t){0, 0};
        }
        fathom_sim_clock_advance(&host_clock, 100 * MS);
        rx = (fathom_rx_t){0, 0};
        assert_int_equal(port.read(port.ctx, bytes, 4, &rx), 4);
        assert_true(fathom_elapsed_us(hal.now_us(hal.ctx), rx.last_us) < 100 * MS);
        while (port.read(port.ctx, bytes, 16, &rx) > 0) rx = (fathom_rx_t){0, 0};
    }
}

TEST(stuck_says_the_value_of_the_frame_before)
{
    FAULT(STUCK, ALWAYS, 2)->run = 2;
    hear(150, A16_FRAME); /* 751 */
    bench.fixed.value[0] = 1953;
    hear(200, A16_FRAME A16_FRAME);
    assert_int_equal(bench.fault.last_kinds, BIT(STUCK));
    hear(100, "FF 07 A1 A7"); /* A16 2(3) */
    assert_int_equal(HITS(STUCK), 2);
}

TEST(always_stuck_holds_the_first_value)
{
    set_faulty(A05_DYP, 1);
    FAULT(STUCK, ALWAYS, 0)->code = 1; /* probe 1 only */
    next_is_golden(A05_DYP);
    assert_int_equal(HITS(STUCK), 0); /* it says what is there */
    for (int i = 0; i < 3; i++) {
        bench.fixed.value[0]++;
        next_is_golden(A05_DYP);
    }
    assert_int_equal(HITS(STUCK), 3);
    bench.fixed.value[1] = 2001;
    next(A05_DYP);
    assert_int_equal(bench.bytes[7], 0xD1);
}

TEST(no_target_interference_and_fault_are_what_the_sensor_says)
{
    FAULT(NO_TARGET, ALWAYS, 1);
    FAULT(INTERFERENCE, ALWAYS, 2);
    hear(350, "FF FF FD FB FF FF FE FC" A16_FRAME);
    assert_int_equal(HITS(NO_TARGET), 1);
    assert_int_equal(HITS(INTERFERENCE), 1);

    set_faulty(A05_AUTO, 1);
    FAULT(NO_TARGET, ALWAYS, 0)->code = 2; /* 60 - 07 - D0 + FF + FD = 85 */
    hear(350, "FF 03 E8 FF FD 07 A1 0D EA 85");

    set_faulty(HPS167S, 1);
    FAULT(FAULT, ALWAYS, 1);
    FAULT(NO_TARGET, ALWAYS, 2);
    next(HPS167S); /* #5: all FF, and magnitude 00 */
    assert_true(is_hex(bench.bytes, "01 03 08 FF FF 00 00 00 FF FF FF"));
    assert_true(crc_is_right());
    next(HPS167S); /* 65530 */
    assert_true(is_hex(bench.bytes, "01 03 08 FF FA"));
    assert_true(crc_is_right());
    next_is_golden(HPS167S);
    assert_int_equal(HITS(FAULT), 1);
    assert_int_equal(HITS(NO_TARGET), 1);
}

TEST(a_frame_that_measures_nothing_is_not_counted_as_hit)
{
    set_faulty(A16_MODBUS, 1);
    FAULT(NO_TARGET, ALWAYS, 0);
    ask("01 03 02 00 00 01 85 B2", 50); /* the address */
    assert_int_equal(bench.heard, 7);
    assert_int_equal(HITS(NO_TARGET), 0);
    next(A16_MODBUS);
    assert_int_equal(HITS(NO_TARGET), 1);
}
