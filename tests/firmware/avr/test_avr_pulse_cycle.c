/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "suite.h"

#include "board.h"

/*
 * The whole cycle of an A16 with PWM output, by the image of examples/avr/a16_pulse.c: trigger at PB1, pulse at ICP1,
 * a line of text for each. The far end is port/sim's A16.
 */
enum { CYCLE_US = 221000, PATIENCE_US = 1000000 };
enum { EDGES = 64 };

static fathom_sim_line_t line; /* what the simulation hangs the device on; no byte goes there */
static fathom_sim_a16_t a16;
static fathom_sim_pins_t pins;
static fathom_sim_fixed_t scene;

static board_edge_t triggers[EDGES];
static unsigned triggered;

static void on_trigger(void *ctx, bool high)
{
    const board_edge_t edge = {board.avr->cycle, high};
    triggers[triggered++ % EDGES] = edge;
}

static void start(uint32_t no_target_us)
{
    board_start("a16_pulse");
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_PWM,
                                                         .scene = fathom_sim_fixed(&scene),
                                                         .no_target_us = no_target_us});
    board_attach(&line, &a16.device, false);
    fathom_sim_pins_init(&pins, &a16.device, &line, &board.clock);
    board_join_pins(&pins, "B1", "B0", NULL);
    triggered = 0;
    assert_non_null(board_watch('B', 1, true, on_trigger, NULL));
}

static int set_up(void **state)
{
    scene.value[0] = 1000;
    start(0);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

/* The line of the first cycle that begins from now on. */
static void assert_next(const char *expected)
{
    board_line(PATIENCE_US); /* of the cycle under way */
    assert_string_equal(board_line(PATIENCE_US), expected);
}

static void set_wire(fathom_sim_tx_wire_t wire)
{
    fathom_sim_tx_wire(&pins, wire);
    board_plan();
}

TEST(each_distance_is_printed_to_the_mm)
{
    /* The time of flight is mm * 5.75 us (A16 1(4)), and never under 3 ms: 522 mm (A16 1(3)). */
    static const struct {
        int32_t mm;
        const char *text;
    } cases[] = {
        {200, "522 mm"}, /* in the blind zone */
        {500, "522 mm"},
        {522, "522 mm"},
        {523, "523 mm"},
        {1000, "1000 mm"},
        {1739, "1739 mm"},
        {5698, "5698 mm"}, /* 32.77 ms, a whole period of Timer1 */
        {5699, "5699 mm"},
        {12345, "12345 mm"},
        {15000, "15000 mm"}, /* 86.25 ms */
        {FATHOM_SIM_NO_TARGET, "nothing in range"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene.value[0] = cases[i].mm;
        assert_next(cases[i].text);
    }
    assert_int_equal(a16.device.counters.unserved, 0); /* no trigger came too early */
}

TEST(the_trigger_is_low_for_2_ms_once_in_221_ms)
{
    assert_next("1000 mm");
    for (int i = 0; i < 10; i++) assert_string_equal(board_line(PATIENCE_US), "1000 mm");
    assert_true(triggered >= 20);
    uint64_t fell = 0;
    for (unsigned i = 0; i < triggered; i++) {
        const board_edge_t *const edge = &triggers[i];
        if (edge->high) {
            const uint64_t low_us = (edge->cycle - fell) / BOARD_CYCLES_PER_US;
            assert_in_range(low_us, 2000, 2100);
        } else {
            const uint64_t cycle_us = (edge->cycle - fell) / BOARD_CYCLES_PER_US;
            if (fell != 0) assert_in_range(cycle_us, CYCLE_US, CYCLE_US + 100);
            fell = edge->cycle;
        }
    }
}

TEST(a_cut_wire_is_an_error_and_no_reading)
{
    assert_next("1000 mm");
    set_wire(FATHOM_SIM_WIRE_LOW);
    assert_next("error -3: no response");
    assert_string_equal(board_line(PATIENCE_US), "error -3: no response");
    set_wire(FATHOM_SIM_WIRE_WHOLE);
    assert_next("1000 mm");
}

TEST(a_line_that_is_stuck_high_is_a_fault)
{
    assert_next("1000 mm");
    set_wire(FATHOM_SIM_WIRE_HIGH);
    assert_next("sensor fault");
    set_wire(FATHOM_SIM_WIRE_WHOLE);
    assert_next("1000 mm");
}

/* High for so long, now. */
static void noise(uint32_t us)
{
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_HIGH);
    assert_true(board_run_us(us));
    set_wire(FATHOM_SIM_WIRE_WHOLE);
}

TEST(short_pulses_before_the_right_one_are_noise)
{
    assert_next("1000 mm");
    for (int i = 0; i < 5; i++) {
        /* The line came with its pulse, 110 ms after the trigger: the next one falls 105 ms from here. */
        assert_true(board_run_us(120000));
        for (uint32_t us = 100; us <= 2600; us += 500) {
            noise(us);
            assert_true(board_run_us(5000));
        }
        assert_string_equal(board_line(PATIENCE_US), "1000 mm");
    }
}

TEST(a_pulse_of_more_than_105_ms_is_a_fault)
{
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    start(105900);
    assert_next("sensor fault");
    start(104900);
    assert_next("nothing in range");
}

TEST(the_line_of_text_comes_right_after_the_pulse)
{
    assert_next("1000 mm");
    /* 110 ms to the pulse, 5.75 ms of it, 9 characters at 115200 baud: 0.78 ms. */
    const uint64_t fell = triggers[(triggered - 2) % EDGES].cycle;
    assert_false(triggers[(triggered - 2) % EDGES].high);
    assert_in_range((board.bytes[(board.text.seen - 1) % BOARD_BYTES].end_cycle - fell) / BOARD_CYCLES_PER_US,
                    116500, 117000);
}

/* Its UART only prints; a byte of noise on RXD is no reason to stay awake. */
TEST(it_sleeps_also_after_a_byte_of_noise)
{
    static const uint8_t noise = 0x55;
    board_feed(&noise, NULL, 1, board.avr->cycle + 16000, 0);
    assert_true(board_run_us(300000));
    const uint64_t begin_cycle = board.avr->cycle, asleep_cycles = board.asleep_cycles;
    assert_true(board_run_us(1000000));
    const uint64_t cycles = board.avr->cycle - begin_cycle;
    assert_true(board.asleep_cycles - asleep_cycles > cycles / 100 * 95);
}
