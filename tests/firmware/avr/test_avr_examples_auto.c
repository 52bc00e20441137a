/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "suite.h"

#include "board.h"

/* The image of examples/avr/a16_a05_auto.c: an A16 and an A05 that send by themselves, each on a line of its own; a
 * multiplexer gives one of them to RXD, chosen by PD4. */
enum { PATIENCE_US = 6000000 };

static fathom_sim_line_t a16_line, a05_line;
static fathom_sim_a16_t a16;
static fathom_sim_a05_t a05;
static fathom_sim_fixed_t a16_scene, a05_scene;
static unsigned turns;

/* What the line has brought while no driver listened is gone. */
static void forget(fathom_sim_line_t *line)
{
    uint8_t bytes[16];
    while (fathom_sim_transmit(line, board.clock.now_us, bytes, sizeof bytes) != 0) continue;
    line->lost = false; /* no UART was there to lose them */
}

static void on_select(void *ctx, bool high)
{
    fathom_sim_line_t *const line = high ? &a05_line : &a16_line;
    turns++;
    board_sync();
    forget(line);
    board_join_line(line);
}

static void start(uint32_t a16_period_us, uint32_t a05_period_us)
{
    board_start("a16_a05_auto");
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_UART,
                                                         .scene = fathom_sim_fixed(&a16_scene),
                                                         .period_us = a16_period_us});
    fathom_sim_a05_init(&a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO,
                                                         .scene = fathom_sim_fixed(&a05_scene),
                                                         .period_us = a05_period_us});
    board_attach(&a16_line, &a16.device, true);
    board_attach(&a05_line, &a05.device, true);
    board_join_line(&a16_line);
    board_join_line(&a05_line);
    turns = 0;
    assert_non_null(board_watch('D', 4, true, on_select, NULL));
}

static int set_up(void **state)
{
    a16_scene.value[0] = 1234;
    memcpy(a05_scene.value, (const int32_t[4]){1000, 2000, 2047, 1339}, sizeof a05_scene.value);
    start(0, 0);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

static void assert_says(const char *expected) { assert_string_equal(board_line(PATIENCE_US), expected); }

TEST(both_are_printed_in_turn)
{
    for (int i = 0; i < 20; i++) {
        assert_says("A16 1234 mm");
        assert_says("A05 1 1000 mm");
        assert_says("A05 2 2000 mm");
        assert_says("A05 3 2047 mm");
        assert_says("A05 4 1339 mm");
    }
    assert_true(turns >= 39);
    /* A round ends with a frame of the A05; it may miss the one before that, while the A16 has its turn. */
    assert_true(board.avr->cycle < 21ull * 600000 * BOARD_CYCLES_PER_US);
}

/* 511 mm held still is FF 01 FF FF, which reads 65281 mm out of step; and these four permuted are four good ones. With
 * each phase of the two periods against each other a turn comes somewhere in the other's frame. */
TEST(a_turn_in_the_middle_of_a_frame_gives_no_wrong_value)
{
    static const uint32_t periods_us[][2] = {
        {13000, 29000}, {17100, 21700}, {33333, 27001}, {100000, 300000}};
    a16_scene.value[0] = 511;
    for (size_t i = 0; i < sizeof periods_us / sizeof *periods_us; i++) {
        start(periods_us[i][0], periods_us[i][1]);
        unsigned of_a16 = 0, of_a05 = 0;
        for (int lines = 0; lines < 200; lines++) {
            static const char *const good[] = {"A16 511 mm", "A05 1 1000 mm", "A05 2 2000 mm",
                                               "A05 3 2047 mm", "A05 4 1339 mm"};
            const char *const text = board_line(PATIENCE_US);
            size_t which = 0;
            while (which < 5 && strcmp(text, good[which]) != 0) which++;
            if (which == 5) print_message("\"%s\"\n", text);
            assert_in_range(which, 0, 4);
            if (which == 0) of_a16++;
            if (which == 4) of_a05++;
        }
        /* One line of the A16 to four of the A05, or to eight where another frame of it came while they left. */
        assert_in_range(of_a16, 200 / 9, 200 / 5 + 1);
        assert_in_range(of_a05, 200 / 5 - 1, 200 / 9 * 2 + 1);
    }
}

/* If frames follow each other without a pause, those of the A05 also have a right sum six bytes late: 1339 2047 1000
 * 2000. A turn between two bytes is not the silence that decides where a frame starts, so bytes arrive but no frame. */
TEST(sensors_that_never_pause_have_an_error_and_no_wrong_value)
{
    a16_scene.value[0] = 511;
    start(4167, 10417); /* 4 and 10 characters of 10 bits at 9600 baud, rounded up */
    for (int lines = 0; lines < 8; lines++) {
        const char *const text = board_line(PATIENCE_US);
        if (strcmp(text, "A16 error -4: damaged") != 0) assert_string_equal(text, "A05 error -4: damaged");
    }
}

TEST(what_is_not_in_range_is_said_for_each_probe)
{
    a16_scene.value[0] = FATHOM_SIM_NO_TARGET;
    a05_scene.value[2] = FATHOM_SIM_INTERFERENCE;
    assert_says("A16 nothing in range");
    assert_says("A05 1 1000 mm");
    assert_says("A05 2 2000 mm");
    assert_says("A05 3 disturbed");
}

static void power_off(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t us)
{
    board_sync();
    fathom_sim_power_cycle(line, device, us, board.clock.now_us);
    board_plan();
}

TEST(a_dead_one_is_said_to_be_silent_and_the_other_goes_on)
{
    assert_says("A16 1234 mm");
    power_off(&a05_line, &a05.device, 20000000);
    unsigned of_a16 = 0, silent = 0;
    const uint64_t begin_cycle = board.avr->cycle;
    while (board.avr->cycle < begin_cycle + 18000000ull * BOARD_CYCLES_PER_US) {
        const char *const text = board_line(PATIENCE_US);
        if (strcmp(text, "A16 1234 mm") == 0)
            of_a16++;
        else if (strcmp(text, "A05 error -7: silent") == 0)
            silent++;
        else
            assert_string_equal(text, "A05 1 1000 mm"); /* no wrong one, and none that is old */
    }
    assert_in_range(of_a16, 15, 18); /* once in a second and a frame */
    assert_in_range(silent, 4, 4);   /* each 4 s */
    /* And when it lives again. */
    unsigned lines = 0;
    while (strcmp(board_line(PATIENCE_US), "A05 4 1339 mm") != 0) assert_true(++lines < 12);
}

TEST(both_dead_are_both_said_to_be_silent)
{
    power_off(&a16_line, &a16.device, 60000000);
    power_off(&a05_line, &a05.device, 60000000);
    for (int i = 0; i < 3; i++) {
        char first[BOARD_LINE];
        strcpy(first, board_line(PATIENCE_US));
        const char *const second = board_line(PATIENCE_US);
        const bool is_a16_first = strcmp(first, "A16 error -7: silent") == 0;
        assert_string_equal(is_a16_first ? first : second, "A16 error -7: silent");
        assert_string_equal(is_a16_first ? second : first, "A05 error -7: silent");
    }
}
