/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

/* examples/avr/tank.c: an A16 that sends by itself over a tank; PB5 is high while the volume is over 4500 litres, PB4
 * while it is not known. The sensor is 2300 mm above the bottom, 2000 mm are 5000 litres: at 500 mm the
 * level is 1800 mm, which are 4500 litres, and at 499 mm 1801 mm, which are 4502.5. */
enum { PERIOD_US = 100000, UNKNOWN_US = 2000000, WINDOW = 5, MOST_OF_IT = 3, GATE_ROW = 2 };

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_fixed_t scene;
static bool full, error;

static void changed(void *pin, bool high) { *(bool *)pin = high; }

static int set_up(void **state)
{
    scene.value[0] = 500;
    full = error = false;
    board_start("tank");
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_UART,
                                                         .scene = fathom_sim_fixed(&scene),
                                                         .period_us = PERIOD_US});
    board_attach(&line, &a16.device, true);
    board_join_line(&line);
    board_watch('B', 5, false, changed, &full);
    board_watch('B', 4, false, changed, &error);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

static void assert_pins(bool is_full, bool is_error)
{
    assert_int_equal(full, is_full);
    assert_int_equal(error, is_error);
}

/* So that as many frames have come and were believed: a frame is under way for one period, the value is of the next. */
static void frames(unsigned count) { assert_true(board_run_us((count + 1) * PERIOD_US + 20000)); }

TEST(nothing_is_known_until_the_window_is_full)
{
    assert_true(board_run_us(1000));
    assert_pins(false, true);
    frames(MOST_OF_IT);
    assert_pins(false, true);
    frames(WINDOW);
    assert_pins(false, false);
}

TEST(more_than_4500_litres_is_full_and_the_pin_follows)
{
    frames(WINDOW);
    assert_pins(false, false);
    scene.value[0] = 499;
    frames(MOST_OF_IT);
    assert_pins(true, false);
    scene.value[0] = 500;
    frames(MOST_OF_IT);
    assert_pins(false, false);
}

TEST(a_spike_changes_nothing_and_a_step_is_followed)
{
    frames(WINDOW);
    scene.value[0] = 150;
    assert_true(board_run_us(PERIOD_US));
    scene.value[0] = 500;
    for (unsigned i = 0; i != WINDOW; i++) {
        assert_true(board_run_us(PERIOD_US));
        assert_pins(false, false);
    }
    scene.value[0] = 150;
    frames(GATE_ROW + WINDOW);
    assert_pins(true, false);
}

TEST(nothing_in_range_is_no_level)
{
    scene.value[0] = 400;
    frames(WINDOW);
    assert_pins(true, false);
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    frames(GATE_ROW + WINDOW);
    assert_pins(false, true);
}

TEST(a_silent_sensor_is_no_longer_known_after_2_s_until_it_sends_again)
{
    scene.value[0] = 400;
    frames(WINDOW);
    assert_pins(true, false);
    board_sync();
    fathom_sim_detach(&line, &a16.device, board.clock.now_us);
    board_plan();
    assert_true(board_run_us(UNKNOWN_US - 2 * PERIOD_US));
    assert_pins(true, false);
    assert_true(board_run_us(2 * PERIOD_US));
    assert_pins(false, true);
    board_sync();
    fathom_sim_attach(&line, &a16.device, board.clock.now_us);
    board_plan();
    assert_true(board_run_us(1000000));
    assert_pins(true, false);
}
