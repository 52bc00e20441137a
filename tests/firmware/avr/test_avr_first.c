/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

/* examples/avr/first.c, which the first page has: an A16 that sends by itself; its readings and errors leave at TXD. */
enum { PERIOD_US = 100000, STALE_US = 2000000, LINE_US = 300000 };

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_fixed_t scene;

static int set_up(void **state)
{
    scene.value[0] = 1234;
    board_start("first");
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_UART,
                                                         .scene = fathom_sim_fixed(&scene),
                                                         .period_us = PERIOD_US});
    board_attach(&line, &a16.device, true);
    board_join_line(&line);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

TEST(each_distance_is_a_line_of_text)
{
    for (int i = 0; i != 5; i++) assert_string_equal(board_line(LINE_US), "1234 mm");
    scene.value[0] = 65;
    assert_string_equal(board_line(LINE_US), "65 mm");
}

TEST(nothing_in_range_is_no_distance)
{
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    assert_string_equal(board_line(LINE_US), "no distance");
    assert_string_equal(board_line(LINE_US), "no distance");
}

TEST(a_sensor_that_falls_silent_is_an_error_until_it_sends_again)
{
    const char *const error = "error -7"; /* FATHOM_ERR_STALE of status.h */
    assert_string_equal(board_line(LINE_US), "1234 mm");
    board_sync();
    fathom_sim_detach(&line, &a16.device, board.clock.now_us);
    board_plan();
    (void)board_line(LINE_US); /* a frame that was complete, if there is one */
    assert_string_equal(board_line(STALE_US + LINE_US), error);
    assert_string_equal(board_line(STALE_US + LINE_US), error);
    board_sync();
    fathom_sim_attach(&line, &a16.device, board.clock.now_us);
    board_plan();
    assert_string_equal(board_line(LINE_US), "1234 mm");
}
