/* SPDX-License-Identifier: MIT */
/* The sketch hps167s_rs485 against the simulated HPS-167S behind a transceiver. */
#include <stdio.h>
#include <string.h>

#include "suite.h"

#include "board.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

/* 19200 8E1: 11 bits of 104 cycles of 8, the divider that UBRR0 = 103 with U2X0 makes (ATmega328P 20.3.1, 20.10). */
enum { UBRR = 103, CHARACTER_CYCLES = 11 * 8 * (UBRR + 1), REQUEST = 8 };
/* `sent` is true 93 bits and 9 us after write, at a true 19200: 4.853 ms; 8 characters by this divider take 4.576 ms.
 * That is 277 us, to which write itself adds 50 and a round of the loop up to 90. */
enum { MOST_LATE_US = 420 };
enum { A_SECOND_US = 1000000 };

typedef struct {
    board_t board;
    fathom_sim_line_t line;
    fathom_sim_hps167s_t hps;
    fathom_sim_fixed_t scene;
    bool led;
    uint32_t led_changes;
} bench_t;

static void on_led(void *ctx, bool high)
{
    bench_t *const bench = (bench_t *)ctx;
    bench->led = high;
    bench->led_changes++;
}

/* slow: the loop comes round every 20 ms. by_timer: Timer0 drops driver-enable. */
static void begin(bench_t *bench, const char *image, bool slow, bool by_timer)
{
    static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    memset(bench, 0, sizeof *bench);
    bench->scene.value[0] = 500;
    assert_true(board_start(&bench->board, image));
    board_drive(&bench->board, 'B', 0, slow);     /* pin 8 */
    board_drive(&bench->board, 'B', 1, by_timer); /* pin 9 */
    board_watch(&bench->board, 'B', 5, false, on_led, bench);
    fathom_sim_line_init(&bench->line, &settings, bench->board.clock.now_us);
    const fathom_sim_hps167s_config_t config = {.scene = fathom_sim_fixed(&bench->scene)};
    fathom_sim_hps167s_init(&bench->hps, &config);
    fathom_sim_attach(&bench->line, &bench->hps.device, bench->board.clock.now_us);
    board_join_line(&bench->board, &bench->line);
    board_join_driver(&bench->board, 'D', 2);
}

static void expect_reading(bench_t *bench, unsigned expected)
{
    const board_record_t *const record = board_next_record(&bench->board, A_SECOND_US);
    assert_non_null(record);
    assert_int_equal(record->kind, 1);
    assert_int_equal(record->bytes[0] << 8 | record->bytes[1], expected);
}

/* Drops what was measured before the scene changed. */
static void settle(bench_t *bench)
{
    board_run_us(&bench->board, 60000);
    bench->board.taken = bench->board.recorded;
}

TEST(the_led_shows_what_is_nearer_than_a_meter)
{
    bench_t bench;
    begin(&bench, "hps167s_rs485", false, false);
    board_run_us(&bench.board, 100000);
    assert_true(bench.led);
    bench.scene.value[0] = 1000;
    board_run_us(&bench.board, 60000);
    assert_false(bench.led);
    bench.scene.value[0] = 999;
    board_run_us(&bench.board, 60000);
    assert_true(bench.led);
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    board_run_us(&bench.board, 60000);
    assert_false(bench.led);
    assert_int_equal(bench.led_changes, 4);

    fathom_sim_detach(&bench.line, &bench.hps.device, bench.board.clock.now_us);
    board_plan(&bench.board);
    board_run_us(&bench.board, 3 * A_SECOND_US / 2);
    assert_in_range(bench.led_changes, 5, 7); /* it blinks: no answer within 500 ms, again and again */
    assert_int_equal(bench.hps.device.counters.crc_errors, 0);
    board_end(&bench.board);
}

TEST(the_line_is_19200_8e1)
{
    bench_t bench;
    begin(&bench, "hps167s_rs485", false, false);
    board_run_us(&bench.board, 50000);
    const uint8_t *const data = bench.board.avr->data;
    assert_int_equal(data[0xC2], 0x26); /* UCSR0C: UPM01 (even), UCSZ01, UCSZ00 (8 bits), one stop bit */
    assert_int_equal(data[0xC4] | data[0xC5] << 8, UBRR);
    assert_int_equal(data[0xC0] & 0x02, 0x02); /* UCSR0A: U2X0 */
    assert_int_equal(bench.hps.device.counters.wrong_settings, 0);
    assert_true(bench.hps.device.counters.answered > 0);
    board_end(&bench.board);
}

/* Each request under one high time of the pin, which ends after the last stop bit and not much later. */
static uint32_t check_driver(const board_t *board, uint32_t most_late_us)
{
    uint32_t most_us = 0;
    uint32_t requests = 0;
    assert_in_range(board->bytes_seen, 10, BOARD_BYTES);
    assert_in_range(board->driver_edges_seen, 4, BOARD_EDGES);
    for (uint32_t byte = 0, edge = 0; byte < board->bytes_seen;) {
        if (!board->bytes[byte].from_here) {
            byte++;
            continue;
        }
        if (byte + REQUEST > board->bytes_seen || edge + 2 > board->driver_edges_seen) break;
        for (uint32_t i = 0; i < REQUEST; i++) {
            const board_byte_t *const sent = &board->bytes[byte + i];
            assert_true(sent->from_here);
            assert_int_equal(sent->end_cycle - sent->begin_cycle, CHARACTER_CYCLES);
            if (i != 0) assert_int_equal(sent->begin_cycle, board->bytes[byte + i - 1].end_cycle);
        }
        const uint64_t end_cycle = board->bytes[byte + REQUEST - 1].end_cycle;
        assert_true(board->driver_edges[edge].high);
        assert_true(board->driver_edges[edge].cycle <= board->bytes[byte].begin_cycle);
        assert_false(board->driver_edges[edge + 1].high);
        assert_true(board->driver_edges[edge + 1].cycle >= end_cycle);
        const uint32_t late_us =
            (uint32_t)((board->driver_edges[edge + 1].cycle - end_cycle) / BOARD_CYCLES_PER_US);
        if (late_us > most_us) most_us = late_us;
        byte += REQUEST;
        edge += 2;
        requests++;
    }
    assert_true(requests > 10);
    assert_true(most_us <= most_late_us);
    assert_int_equal(board->cut_bytes, 0);
    assert_int_equal(board->talked_over, 0);
    return most_us;
}

TEST(driver_enable_covers_each_request_to_its_last_stop_bit)
{
    bench_t bench;
    begin(&bench, "hps167s_rs485", false, false);
    board_run_us(&bench.board, A_SECOND_US);
    printf("figure arduino_driver_late %u us\n", (unsigned)check_driver(&bench.board, MOST_LATE_US));
    assert_true(bench.hps.device.counters.answered > 30);
    board_end(&bench.board);
}

TEST(distances_arrive_as_they_were_sent)
{
    static const uint16_t distances_mm[] = {80, 316, 1953, 9084, 18000};
    bench_t bench;
    begin(&bench, "hps_probe", false, false);
    for (size_t i = 0; i < sizeof distances_mm / sizeof *distances_mm; i++) {
        bench.scene.value[0] = distances_mm[i];
        settle(&bench);
        for (int n = 0; n < 3; n++) expect_reading(&bench, distances_mm[i]);
    }
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    settle(&bench);
    expect_reading(&bench, 65535);
    board_end(&bench.board);
}

TEST(a_loop_of_20_ms_talks_into_the_answers)
{
    bench_t bench;
    begin(&bench, "hps_probe", true, false);
    board_run_us(&bench.board, 2 * A_SECOND_US);
    assert_true(bench.hps.device.counters.answered > 1);
    assert_true(bench.board.talked_over > 0);
    for (uint32_t i = 0; i < bench.board.recorded; i++) /* what it reads nevertheless is true */
        if (bench.board.records[i].kind == 1)
            assert_int_equal(bench.board.records[i].bytes[0] << 8 | bench.board.records[i].bytes[1], 500);
    board_end(&bench.board);
}

TEST(a_loop_of_20_ms_reads_when_timer0_drops_driver_enable)
{
    bench_t bench;
    begin(&bench, "hps_probe", true, true);
    board_run_us(&bench.board, A_SECOND_US);
    /* Timer0 comes every 1024 us. */
    printf("figure arduino_driver_late_by_timer0 %u us\n",
           (unsigned)check_driver(&bench.board, MOST_LATE_US + 1024));
    assert_true(bench.board.recorded > 12);
    for (uint32_t i = 0; i < 12; i++) expect_reading(&bench, 500);
    board_end(&bench.board);
}

TEST(the_wrap_of_micros_disturbs_nothing)
{
    static const uint32_t wrap = UINT32_C(1) << 22; /* of 1024 us */
    bench_t bench;
    begin(&bench, "hps_probe", false, false);
    assert_true(board_run_us(&bench.board, 1500));
    uint8_t *const bytes = board_data(&bench.board, "timer0_overflow_count");
    for (unsigned i = 0; i < 4; i++) bytes[i] = (uint8_t)((wrap - 300) >> (8 * i));
    bench.board.taken = bench.board.recorded;
    for (int n = 0; n < 30; n++) expect_reading(&bench, 500);
    assert_true((bytes[2] & 0x40) != 0); /* 2^22 has been passed */
    check_driver(&bench.board, MOST_LATE_US);
    board_end(&bench.board);
}
