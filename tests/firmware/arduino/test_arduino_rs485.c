/* SPDX-License-Identifier: MIT */
/* The sketch hps167s_rs485 against the simulated HPS-167S behind a transceiver. */
#include <stdio.h>

#include "suite.h"

#include "wire.h"

/* 19200 8E1: 11 bits of 104 cycles of 8, the divider that UBRR0 = 103 with U2X0 makes (ATmega328P 20.3.1, 20.10). */
enum { UBRR = 103, CHARACTER_CYCLES = 11 * 8 * (UBRR + 1), REQUEST = 8 };
/* `sent` is true 93 bits and 9 us after write, at a true 19200: 4.853 ms; 8 characters by this divider take 4.576 ms.
 * That is 277 us, to which write itself adds 50 and a round of the loop up to 90. */
enum { MOST_LATE_US = 420 };
enum { A_SECOND_US = 1000000 };

static struct {
    fathom_sim_line_t line;
    fathom_sim_hps167s_t hps;
    fathom_sim_fixed_t scene;
    bool led;
    uint32_t led_changes;
} bench;

static const suite_t suite = {.tear_down = board_stop};

static void on_led(void *ctx, bool high)
{
    bench.led = high;
    bench.led_changes++;
}

/* slow: the loop comes round every 20 ms. by_timer: Timer0 drops driver-enable. */
static void begin(const char *image, bool slow, bool by_timer)
{
    memset(&bench, 0, sizeof bench);
    bench.scene.value[0] = 500;
    board_start(image);
    board_drive('B', 0, slow);     /* pin 8 */
    board_drive('B', 1, by_timer); /* pin 9 */
    board_watch('B', 5, false, on_led, NULL);
    fathom_sim_hps167s_init(&bench.hps,
                            &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&bench.scene)});
    board_attach(&bench.line, &bench.hps.device, false);
    board_join_line(&bench.line);
    board_join_driver('D', 2);
}

static void expect_reading(unsigned expected)
{
    const board_record_t *const record = board_next_record(A_SECOND_US);
    assert_non_null(record);
    assert_int_equal(record->kind, 1);
    assert_int_equal(record->bytes[0] << 8 | record->bytes[1], expected);
}

/* Drops what was measured before the scene changed. */
static void settle(void)
{
    board_run_us(60000);
    board.taken = board.recorded;
}

TEST(the_led_shows_what_is_nearer_than_a_meter)
{
    begin("hps167s_rs485", false, false);
    board_run_us(100000);
    assert_true(bench.led);
    bench.scene.value[0] = 1000;
    board_run_us(60000);
    assert_false(bench.led);
    bench.scene.value[0] = 999;
    board_run_us(60000);
    assert_true(bench.led);
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    board_run_us(60000);
    assert_false(bench.led);
    assert_int_equal(bench.led_changes, 4);

    fathom_sim_detach(&bench.line, &bench.hps.device, board.clock.now_us);
    board_plan();
    board_run_us(3 * A_SECOND_US / 2);
    assert_in_range(bench.led_changes, 5, 7); /* it blinks: no response within 500 ms, again and again */
    assert_int_equal(bench.hps.device.counters.crc_errors, 0);
}

TEST(the_line_is_19200_8e1)
{
    begin("hps167s_rs485", false, false);
    board_run_us(50000);
    const uint8_t *const data = board.avr->data;
    assert_int_equal(data[0xC2], 0x26); /* UCSR0C: UPM01 (even), UCSZ01, UCSZ00 (8 bits), one stop bit */
    assert_int_equal(board_number(data + 0xC4, 2), UBRR);
    assert_int_equal(data[0xC0] & 0x02, 0x02); /* UCSR0A: U2X0 */
    assert_int_equal(bench.hps.device.counters.wrong_settings, 0);
    assert_true(bench.hps.device.counters.answered > 0);
}

/* Each request under one high time of the pin, which ends after the last stop bit and not much later. */
static uint32_t check_driver(uint32_t most_late_us)
{
    uint64_t most_us = 0;
    wire_t wire = {0};
    assert_in_range(board.bytes_seen, 10, BOARD_BYTES);
    assert_in_range(board.driver_edges_seen, 4, BOARD_EDGES);
    while (wire_next_request(&wire) && wire.off_cycle != 0) {
        assert_int_equal(wire.end_cycle - wire.begin_cycle, REQUEST * CHARACTER_CYCLES);
        const uint64_t late_us = (wire.off_cycle - wire.end_cycle) / BOARD_CYCLES_PER_US;
        if (late_us > most_us) most_us = late_us;
    }
    assert_true(wire.requests > 10);
    assert_true(most_us <= most_late_us);
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
    return (uint32_t)most_us;
}

TEST(driver_enable_covers_each_request_to_its_last_stop_bit)
{
    begin("hps167s_rs485", false, false);
    board_run_us(A_SECOND_US);
    printf("figure arduino_driver_late %u us\n", (unsigned)check_driver(MOST_LATE_US));
    assert_true(bench.hps.device.counters.answered > 30);
}

TEST(distances_arrive_as_they_were_sent)
{
    static const uint16_t distances_mm[] = {80, 316, 1953, 9084, 18000};
    begin("hps_probe", false, false);
    for (size_t i = 0; i < sizeof distances_mm / sizeof *distances_mm; i++) {
        bench.scene.value[0] = distances_mm[i];
        settle();
        for (int n = 0; n < 3; n++) expect_reading(distances_mm[i]);
    }
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    settle();
    expect_reading(65535);
}

TEST(a_loop_of_20_ms_sends_into_the_responses)
{
    begin("hps_probe", true, false);
    board_run_us(2 * A_SECOND_US);
    assert_true(bench.hps.device.counters.answered > 1);
    assert_true(board.talked_over > 0);
    for (uint32_t i = 0; i < board.recorded; i++) /* what it reads nevertheless is true */
        if (board.records[i].kind == 1)
            assert_int_equal(board.records[i].bytes[0] << 8 | board.records[i].bytes[1], 500);
}

TEST(a_loop_of_20_ms_reads_when_timer0_drops_driver_enable)
{
    begin("hps_probe", true, true);
    board_run_us(A_SECOND_US);
    /* Timer0 comes every 1024 us. */
    printf("figure arduino_driver_late_by_timer0 %u us\n", (unsigned)check_driver(MOST_LATE_US + 1024));
    assert_true(board.recorded > 12);
    for (uint32_t i = 0; i < 12; i++) expect_reading(500);
}

TEST(the_wrap_of_micros_disturbs_nothing)
{
    static const uint32_t wrap = UINT32_C(1) << 22; /* of 1024 us */
    begin("hps_probe", false, false);
    assert_true(board_run_us(1500));
    uint8_t *const bytes = board_data("timer0_overflow_count");
    for (unsigned i = 0; i < 4; i++) bytes[i] = (uint8_t)((wrap - 300) >> (8 * i));
    board.taken = board.recorded;
    for (int n = 0; n < 30; n++) expect_reading(500);
    assert_true((bytes[2] & 0x40) != 0); /* 2^22 has been passed */
    check_driver(MOST_LATE_US);
}
