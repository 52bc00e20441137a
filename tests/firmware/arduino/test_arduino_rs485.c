/* SPDX-License-Identifier: MIT */
/* The sketch hps167s against the simulated HPS-167S behind a transceiver. */
#include <stdio.h>

#include "suite.h"

#include "console.h"
#include "wire.h"

/* 19200 8E1: 11 bits of 104 cycles of 8, the divider that UBRR0 = 103 with U2X0 makes (ATmega328P 20.3.1, 20.10). */
enum { UBRR = 103, CHARACTER_CYCLES = 11 * 8 * (UBRR + 1), REQUEST = 8 };
/* `sent` is true 93 bits and 9 us after write, at a true 19200: 4.853 ms; 8 characters by this divider take 4.576 ms.
 * That is 277 us, to which write itself adds 50 and a round of the loop up to 90. */
enum { MOST_LATE_US = 420 };
enum { TIMER0_US = 1024 }; /* from one interrupt of Timer0 to the next */
enum {
    ANSWERS_AFTER_US = 2005
}; /* t3.5 at 19200 baud, 8E1: the response begins no earlier (HPS-167S 2.2.3) */
enum { A_SECOND_US = 1000000 };
enum { UNASKED_US = 18519 }; /* 54 times a second */

static struct {
    fathom_sim_line_t line;
    fathom_sim_hps167s_t hps;
    fathom_sim_fixed_t scene;
} bench;

static const suite_t suite = {.tear_down = board_stop};

/* round_ms: the loop comes round so seldom: 0, 20 or 50. unasked_us: the sensor sends by itself so often; 0: never. */
static void begin_with(const char *image, unsigned round_ms, uint32_t unasked_us)
{
    memset(&bench, 0, sizeof bench);
    bench.scene.value[0] = 500;
    board_start(image);
    board_drive('B', 0, round_ms == 20); /* pin 8 */
    board_drive('B', 1, round_ms == 50); /* pin 9 */
    fathom_sim_hps167s_init(
        &bench.hps,
        &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&bench.scene), .unasked_us = unasked_us});
    board_attach(&bench.line, &bench.hps.device, false);
    board_join_line(&bench.line);
    board_join_driver('D', 2);
}

static void begin(const char *image, unsigned round_ms) { begin_with(image, round_ms, 0); }

static void expect_reading(unsigned expected)
{
    const board_record_t *const record = board_next_record(A_SECOND_US);
    assert_non_null(record);
    assert_int_equal(record->kind, 1);
    assert_int_equal(record->bytes[0] << 8 | record->bytes[1], expected);
}

static void expect_error(const char *name)
{
    const board_record_t *const record = board_next_record(2 * A_SECOND_US);
    assert_non_null(record);
    assert_int_equal(record->kind, 2);
    assert_int_equal(record->length, strlen(name));
    assert_memory_equal(record->bytes, name, record->length);
}

/* Drops what was measured before the scene changed. */
static void settle(uint32_t us)
{
    board_run_us(us);
    board.taken = board.recorded;
}

TEST(the_line_is_19200_8e1)
{
    begin("hps167s", 0);
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
    /* A sensor that sends by itself may begin a frame at the same time. It is not a response then. */
    if (bench.hps.unasked_us == 0) assert_int_equal(board.talked_over, 0);
    return (uint32_t)most_us;
}

TEST(driver_enable_covers_each_request_to_its_last_stop_bit)
{
    begin("hps167s", 0);
    board_run_us(A_SECOND_US);
    printf("figure arduino_driver_late %u us\n", (unsigned)check_driver(MOST_LATE_US));
    assert_true(bench.hps.device.counters.answered > 30);
}

TEST(distances_arrive_as_they_were_sent)
{
    static const uint16_t distances_mm[] = {80, 316, 1953, 9084, 18000};
    begin("hps_probe", 0);
    for (size_t i = 0; i < sizeof distances_mm / sizeof *distances_mm; i++) {
        bench.scene.value[0] = distances_mm[i];
        settle(60000);
        for (int n = 0; n < 3; n++) expect_reading(distances_mm[i]);
    }
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    settle(60000);
    expect_reading(0);
}

TEST(a_sensor_that_does_not_respond_is_an_error_with_a_name)
{
    begin("hps_probe", 0);
    expect_reading(500);
    fathom_sim_detach(&bench.line, &bench.hps.device, board.clock.now_us);
    board_plan();
    settle(60000);
    expect_error("NO_RESPONSE");
    assert_int_equal(bench.hps.device.counters.crc_errors, 0);
}

/* So many readings a second, each right, however slow the loop is: driver-enable drops before the response begins. */
static void expect_readings(const char *image, unsigned round_ms, uint32_t unasked_us, uint32_t least,
                            uint32_t most_late_us)
{
    assert_true(most_late_us < ANSWERS_AFTER_US);
    begin_with(image, round_ms, unasked_us);
    settle(2 * A_SECOND_US);
    const uint32_t before = board.recorded;
    board_run_us(A_SECOND_US);
    printf("%s, a round of %u ms, unasked every %u us: %u readings a second, driver-enable late by %u us\n",
           image, round_ms, (unsigned)unasked_us, (unsigned)(board.recorded - before),
           (unsigned)check_driver(most_late_us));
    assert_true(board.recorded - before >= least);
    for (int i = 0; i != 10; i++) expect_reading(500);
    bench.scene.value[0] = 9084;
    settle(200000);
    for (int i = 0; i != 10; i++) expect_reading(9084);
}

/* One reading takes three rounds: the request, the response, the pace. */
TEST(a_loop_of_20_ms_reads) { expect_readings("hps_probe", 20, 0, 15, MOST_LATE_US + TIMER0_US); }

TEST(a_loop_of_20_ms_reads_a_sensor_that_also_sends_by_itself)
{
    expect_readings("hps_probe", 20, UNASKED_US, 10, MOST_LATE_US + TIMER0_US);
}

TEST(a_loop_of_50_ms_reads_a_sensor_that_also_sends_by_itself)
{
    expect_readings("hps_probe", 50, UNASKED_US, 4, MOST_LATE_US + TIMER0_US);
}

/* hps_waits is compiled without the interrupt of Timer0, as for a core that has none. */
TEST(without_timer0_the_write_waits_until_the_request_has_left)
{
    expect_readings("hps_waits", 0, 0, 30, MOST_LATE_US);
    board_end();
    expect_readings("hps_waits", 20, UNASKED_US, 10, MOST_LATE_US);
}

TEST(the_wrap_of_micros_disturbs_nothing)
{
    static const uint32_t wrap = UINT32_C(1) << 22; /* of 1024 us */
    begin("hps_probe", 0);
    assert_true(board_run_us(1500));
    uint8_t *const bytes = board_data("timer0_overflow_count");
    for (unsigned i = 0; i < 4; i++) bytes[i] = (uint8_t)((wrap - 300) >> (8 * i));
    board.taken = board.recorded;
    for (int n = 0; n < 30; n++) expect_reading(500);
    assert_true((bytes[2] & 0x40) != 0); /* 2^22 has been passed */
    check_driver(MOST_LATE_US);
}

TEST(the_sketch_prints_and_loses_no_response)
{
    begin_with("hps167s", 0, UNASKED_US);
    console_join('B', 3, 115200); /* pin 11 */
    for (int n = 0; n != 60; n++) assert_string_equal(console_line(A_SECOND_US), "500");
    assert_true(board.avr->cycle < 2 * (uint64_t)BOARD_HZ);
    assert_int_equal(board.usart.overruns, 0);
    check_driver(MOST_LATE_US + TIMER0_US);
}
