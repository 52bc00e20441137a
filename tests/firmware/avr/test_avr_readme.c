/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

/* The README's program for an ATmega328P: an A16 that sends by itself; PB5 is high while something is nearer than
 * 1500 mm, PB4 while that is not known. */
enum { PERIOD_US = 100000, STALE_US = 2000000 };

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_fixed_t scene;
static bool near, error;

static void changed(void *pin, bool high) { *(bool *)pin = high; }

static int set_up(void **state)
{
    scene.value[0] = 1500;
    near = error = false;
    board_start("readme");
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_UART,
                                                         .scene = fathom_sim_fixed(&scene),
                                                         .period_us = PERIOD_US});
    board_attach(&line, &a16.device, true);
    board_join_line(&line);
    board_watch('B', 5, false, changed, &near);
    board_watch('B', 4, false, changed, &error);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

static void assert_pins(bool is_near, bool is_error)
{
    assert_int_equal(near, is_near);
    assert_int_equal(error, is_error);
}

/* So that the next frame has come and was believed: a frame is under way for one period, the value is of the next. */
static void two_frames(void) { assert_true(board_run_us(2 * PERIOD_US + 20000)); }

TEST(nothing_is_known_until_the_first_frame)
{
    assert_true(board_run_us(1000));
    assert_pins(false, true);
    two_frames();
    assert_pins(false, false);
}

TEST(nearer_than_1500_mm_is_near_and_the_pin_follows)
{
    two_frames();
    assert_pins(false, false);
    scene.value[0] = 1499;
    two_frames();
    assert_pins(true, false);
    scene.value[0] = 1500;
    two_frames();
    assert_pins(false, false);
}

TEST(nothing_in_range_is_known_and_not_near)
{
    scene.value[0] = 100;
    two_frames();
    assert_pins(true, false);
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    two_frames();
    assert_pins(false, false);
}

TEST(a_silent_sensor_is_no_longer_near_after_2_s_until_it_sends_again)
{
    scene.value[0] = 100;
    two_frames();
    assert_pins(true, false);
    board_sync();
    fathom_sim_detach(&line, &a16.device, board.clock.now_us);
    board_plan();
    assert_true(board_run_us(STALE_US - 2 * PERIOD_US));
    assert_pins(true, false);
    assert_true(board_run_us(2 * PERIOD_US));
    assert_pins(false, true);
    board_sync();
    fathom_sim_attach(&line, &a16.device, board.clock.now_us);
    board_plan();
    assert_true(board_run_us(1000000));
    assert_pins(true, false);
}
