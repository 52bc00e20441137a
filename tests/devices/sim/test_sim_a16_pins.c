/* SPDX-License-Identifier: MIT */
#include "pin_stage.h"

/* The pins of an A16: pulses, triggers, breaks, and its TX as a UART's. */

static void set(uint8_t mode, int32_t mm, a16_config_t config)
{
    begin(mm);
    add_a16(mode, config);
    take_pins();
}

#define DEFAULTS ((a16_config_t){0})

static void rx(bool high)
{
    const fathom_pin_t pin = fathom_sim_rx_pin(&s.pins);
    pin.set(pin.ctx, high);
}

/* Low for 2 ms. */
static void trigger(void)
{
    rx(false);
    pass_us(2 * MS);
    rx(true);
}

static void arm(void)
{
    const fathom_capture_t capture = fathom_sim_capture(&s.pins);
    capture.arm(capture.ctx);
}

static int take(fathom_pulse_t *pulse)
{
    const fathom_capture_t capture = fathom_sim_capture(&s.pins);
    return capture.take(capture.ctx, pulse);
}

static int brk(bool on) { return s.uart.set_break(s.uart.ctx, on); }

static uint8_t bytes[16]; /* of the last read */
static fathom_rx_t rx_of;

static size_t read_port(void)
{
    rx_of = (fathom_rx_t){0, 0};
    return (size_t)s.uart.read(s.uart.ctx, bytes, sizeof bytes, &rx_of);
}

EACH_BEGINS(set(FATHOM_SIM_A16_PWM, 1000, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

/* ---- PWM: A16 1 ---- */

TEST(a_falling_edge_brings_one_pulse_after_110_ms)
{
    set(FATHOM_SIM_A16_PWM, 1739, DEFAULTS); /* A16 1(4): 10000 us */
    const uint32_t start_us = s.clock.now_us;
    assert_false(level_in(500 * MS));
    trigger();
    pass_us(108 * MS - 1);
    assert_int_equal(edges, 0);
    assert_false(level());
    assert_true(level_in(1));
    assert_true(level_in(9 * MS));
    assert_false(level_in(500 * MS));
    assert_int_equal(edges, 2);
    assert_true(edge_high[0]);
    assert_false(edge_high[1]);
    assert_int_equal(fathom_elapsed_us(edge_us[0], start_us), 610 * MS);
    /* 1739 mm * 5.75 us/mm = 9999.25 us */
    assert_int_equal(fathom_elapsed_us(edge_us[1], edge_us[0]), 9999);
    COUNTED(.measurements = 1);
}

TEST(the_width_follows_the_distance_from_3_to_94_ms)
{
    static const struct {
        int32_t value;
        uint32_t width_us;
    } rows[] = {
        {1, 3000},
        {521, 3000},
        {522, 3002}, /* 3001.5 */
        {15000, 86250},
        {16347, 93995}, /* 93995.25 */
        {16348, 94000},
        {16349, 94000}, /* 94001, 94006.75 */
        {65535, 94000},
        {FATHOM_SIM_NO_TARGET, 94000},
        {FATHOM_SIM_INTERFERENCE, 94000},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        set(FATHOM_SIM_A16_PWM, rows[i].value, DEFAULTS);
        trigger();
        pass_us(300 * MS);
        assert_int_equal(edges, 2);
        assert_int_equal(fathom_elapsed_us(edge_us[1], edge_us[0]), rows[i].width_us);
    }
}

TEST(edges_during_a_cycle_are_ignored_and_counted)
{
    trigger();
    for (int i = 0; i < 10; i++) {
        pass_us(18 * MS);
        trigger();
    } /* 202 ms */
    pass_us(18 * MS);
    rx(false); /* at 220 ms: "must be greater than 220ms" */
    COUNTED(.unserved = 11, .requests = 1);
    rx(true);
    pass_us(1);
    rx(false);
    COUNTED(.requests = 2);
    pass_us(500 * MS);
    assert_int_equal(edges, 4);
}

TEST(times_of_the_pulse_are_options)
{
    set(FATHOM_SIM_A16_PWM, FATHOM_SIM_NO_TARGET,
        (a16_config_t){
            .cycle_us = 150 * MS, .pulse_us = 20 * MS, .no_target_us = 93 * MS, .start_us = 900 * MS});
    trigger();
    pass_us(800 * MS);
    assert_int_equal(edges, 0); /* it was starting */
    pass_us(98 * MS);
    const uint32_t from_us = s.clock.now_us;
    trigger();
    pass_us(149 * MS);
    trigger();
    pass_us(300 * MS);
    assert_int_equal(edges, 4);
    assert_int_equal(fathom_elapsed_us(edge_us[0], from_us), 20 * MS);
    assert_int_equal(fathom_elapsed_us(edge_us[1], from_us), 113 * MS);
}

TEST(the_capture_takes_pulses_that_begin_after_arm_in_their_order)
{
    fathom_pulse_t pulse = {7, 7, false};
    trigger();
    assert_true(level_in(110 * MS));
    arm(); /* within the pulse */
    pass_us(200 * MS);
    assert_int_equal(take(&pulse), 0);
    assert_false(pulse.is_high);
    assert_int_equal(pulse.width_us, 7);
    for (int i = 0; i < 6; i++) { /* one more than there is room for, and one that comes after taking */
        bench.fixed.value[0] = 1000 * (i + 1);
        if (i == 5) assert_int_equal(take(&pulse), 1);
        trigger();
        pass_us(300 * MS);
    }
    assert_int_equal(s.pins.lost, 1);
    assert_int_equal(pulse.width_us, 5750);
    for (int i = 2; i <= 4; i++) {
        assert_int_equal(take(&pulse), 1);
        assert_int_equal(pulse.width_us, 5750 * i);
    }
    assert_int_equal(take(&pulse), 1);
    assert_int_equal(pulse.width_us, 5750 * 6);
    /* 110 ms + 34.5 ms after its trigger, which was 302 ms ago */
    assert_int_equal(fathom_elapsed_us(s.clock.now_us, pulse.end_us), 302 * MS - 144500);
    assert_int_equal(take(&pulse), 0);
}

TEST(a_wire_can_break_stick_and_make_noise)
{
    fathom_pulse_t pulse;
    arm();
    fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_HIGH);
    pass_us(500);
    fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_WHOLE);
    assert_int_equal(take(&pulse), 1);
    assert_int_equal(pulse.width_us, 500);
    trigger();
    assert_true(level_in(109 * MS));
    fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_LOW); /* 1 ms into the pulse */
    assert_false(level());
    assert_int_equal(take(&pulse), 1);
    assert_int_equal(pulse.width_us, 1 * MS);
    pass_us(300 * MS);
    fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_HIGH);
    pass_us(300 * MS);
    trigger();
    pass_us(300 * MS);
    assert_int_equal(take(&pulse), 0);
    assert_true(pulse.is_high);
    assert_int_equal(edges, 5);
}

TEST(without_power_tx_is_low_and_no_edge_is_noticed)
{
    trigger();
    assert_true(level_in(109 * MS));
    fathom_sim_device_power_on(bench.device, bench.line.now_us); /* off and on in no time */
    assert_false(level());
    pass_us(300 * MS);
    assert_int_equal(edges, 2);
    set(FATHOM_SIM_A16_UART, 1000, DEFAULTS);
    assert_true(level());
}

TEST(a_break_a_pin_and_a_byte_are_one_wire)
{
    const fathom_uart_t uart = s.uart;
    const uint8_t byte = 0xFF;
    set(FATHOM_SIM_A16_PWM, 1000, (a16_config_t){.cycle_us = 1});
    assert_int_equal(brk(true), 1);
    assert_int_equal(brk(true), 1);
    COUNTED(.requests = 1);
    pass_us(10);
    rx(false); /* it is low already */
    assert_int_equal(brk(false), 1);
    pass_us(10);
    assert_int_equal(brk(true), 1);
    rx(true);
    pass_us(10);
    COUNTED(.requests = 1);
    assert_int_equal(uart.write(uart.ctx, &byte, 1), 0); /* not in a break */
    assert_int_equal(brk(false), 1);
    assert_int_equal(uart.write(uart.ctx, &byte, 1), 1);
    assert_int_equal(brk(true), 0); /* it is leaving */
    pass_us(2 * MS);
    COUNTED(.requests = 2); /* the start bit */
    assert_int_equal(brk(true), 1);
    COUNTED(.requests = 3, .unserved = NONE);
}

TEST(the_bits_of_a_byte_can_be_seen_at_the_pin)
{
    static const char bits[] = "0111111111"   /* FF */
                               "0111000001"   /* 07 */
                               "0100001011"   /* A1 */
                               "0111001011";  /* A7 */
    set(FATHOM_SIM_A16_UART, 1953, DEFAULTS); /* A16 2(4) */
    pass_us(100 * MS);
    /* in the middle of each bit of 104.17 us; characters are rounded up to 1042, 2084, 3125, 4167 us */
    uint32_t at_us = 0;
    for (uint32_t i = 0; i < 40; i++) {
        const uint32_t middle_us = (uint32_t)((2 * i + 1) * 1000000 / 19200);
        pass_us(middle_us - at_us);
        at_us = middle_us;
        assert_true(level() == (bits[i] == '1'));
    }
    assert_true(level_in(5 * MS));
    assert_int_equal(edges, 0);
}

TEST(parity_and_two_stop_bits_can_be_seen_too)
{
    static const struct {
        fathom_line_settings_t settings;
        uint8_t byte;
        const char *bits;
    } rows[] = {
        {{9600, FATHOM_PARITY_EVEN, 1}, 0x07, "01110000011"},
        {{9600, FATHOM_PARITY_EVEN, 1}, 0x03, "01100000001"},
        {{9600, FATHOM_PARITY_ODD, 1}, 0x07, "01110000001"},
        {{9600, FATHOM_PARITY_ODD, 2}, 0x03, "011000000111"},
        {{9600, FATHOM_PARITY_NONE, 2}, 0x80, "00000000111"},
    };
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        fathom_sim_sender_t sender;
        memset(&sender, 0, sizeof sender);
        fathom_sim_sender_put(&sender, &rows[row].settings, &rows[row].byte, 1, bench_start_us);
        sender.on_wire = true;
        for (uint32_t i = 0; i < strlen(rows[row].bits); i++) {
            const uint32_t at_us = (uint32_t)((2 * i + 1) * 1000000 / 19200);
            assert_true(fathom_sim_sender_level(&sender, bench_start_us + at_us) ==
                        (rows[row].bits[i] == '1'));
        }
    }
}

TEST(a_level_that_falls_on_a_uarts_pin_is_a_break_to_the_host)
{
    set(FATHOM_SIM_A16_MODBUS, 1000, DEFAULTS);
    bench.device->tx_is_uart = true;
    fathom_sim_device_set_level(bench.device, false, bench.line.now_us);
    assert_false(level_in(20));
    pass_us(1021);
    assert_int_equal(read_port(), 0);
    pass_us(1);
    assert_int_equal(read_port(), 1);
    assert_true((rx_of.flags & FATHOM_RX_FRAMING) != 0);
    assert_int_equal(bytes[0], 0);
    fathom_sim_device_set_level(bench.device, true, bench.line.now_us);
    pass_us(10 * MS);
    assert_int_equal(read_port(), 0);
    bench.device->tx_is_uart = false;
    fathom_sim_device_set_level(bench.device, false, bench.line.now_us);
    pass_us(10 * MS);
    assert_int_equal(read_port(), 0);
    assert_int_equal(edges, 3);
}

TEST(a_break_damages_the_frame_that_a_device_hears)
{
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}; /* A16 6(4) */
    const fathom_uart_t uart = s.uart;
    set(FATHOM_SIM_A16_MODBUS, 1000, DEFAULTS);
    for (int with_break = 0; with_break < 2; with_break++) {
        assert_int_equal(uart.write(uart.ctx, request, 8), 8);
        pass_us(8334);
        assert_int_equal(brk(with_break != 0), 1);
        pass_us(2 * MS);
        assert_int_equal(brk(false), 1);
        pass_us(500 * MS);
        COUNTED(.answered = 1);
        assert_int_equal(bench.device->counters.truncated, with_break);
    }
}

/* ---- controlled: A16 3 ---- */

TEST(each_edge_brings_one_frame_90_to_110_ms_later)
{
    static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 3(5) */
    uint32_t least_us = UINT32_MAX, most_us = 0;
    set(FATHOM_SIM_A16_CONTROLLED, 1953, DEFAULTS);
    pass_us(500 * MS);
    for (int i = 0; i < 50; i++) {
        const uint32_t from_us = s.clock.now_us;
        assert_int_equal(brk(true), 1);
        pass_us(2 * MS);
        assert_int_equal(brk(false), 1);
        pass_us(118 * MS + 1);
        assert_int_equal(read_port(), 4);
        assert_memory_equal(bytes, mm_1953, 4);
        const uint32_t begin_us = fathom_elapsed_us(rx_of.last_us, from_us) - 4167;
        assert_in_range(begin_us, 90 * MS, 110 * MS);
        if (begin_us < least_us) least_us = begin_us;
        if (begin_us > most_us) most_us = begin_us;
    }
    assert_in_range(least_us, 90 * MS, 92 * MS);
    assert_in_range(most_us, 108 * MS, 110 * MS);
    COUNTED(.answered = 50, .unserved = NONE);
    pass_us(500 * MS);
    trigger();
    pass_us(118 * MS);
    trigger(); /* after 120 ms: "must be greater than 120ms" */
    pass_us(300 * MS);
    COUNTED(.unserved = 1, .answered = 51);
}

static void drop(void *ctx, fathom_sim_frame_t *frame)
{
    assert_false(frame->automatic);
    assert_int_equal(frame->protocol, FATHOM_SIM_STREAM);
    frame->length = 0;
}

TEST(faults_reach_the_frame_that_was_triggered)
{
    static const fathom_sim_faults_t faults = {.outgoing = drop};
    set(FATHOM_SIM_A16_CONTROLLED, 1953, (a16_config_t){.faults = &faults});
    trigger();
    pass_us(300 * MS);
    assert_int_equal(read_port(), 0);
    COUNTED(.answered = 1);
}

/* ---- UART: the select pin, A16 2(2) ---- */

static uint16_t next_value(void)
{
    pass_us(100 * MS);
    assert_int_equal(read_port(), 4);
    return (uint16_t)(bytes[1] * 256 + bytes[2]);
}

TEST(rx_low_sends_the_real_time_value_and_rx_high_the_processed_one)
{
    bench.processed = FIXED(1000);
    set(FATHOM_SIM_A16_UART, 2000, (a16_config_t){.processed = PROCESSED});
    pass_us(50 * MS);
    assert_int_equal(next_value(), 1000);
    rx(false);
    assert_int_equal(next_value(), 2000);
    rx(true);
    assert_int_equal(next_value(), 1000);
    assert_int_equal(brk(true), 1);
    assert_int_equal(next_value(), 2000);
}
