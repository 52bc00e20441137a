/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

/* The image of examples/avr/hps167s_rs485.c: three LEDs, each lit by a low pin, of what an HPS-167S sees. */
enum { NEAR = 0, FAR = 1, ERROR = 2, LEDS = 3 };
enum { PERIOD_US = 18519 }; /* 54 Hz */

static fathom_sim_line_t line;
static fathom_sim_hps167s_t hps;
static fathom_sim_fixed_t scene;
static bool lit[LEDS];
static uint64_t changed_cycle;

static void changed(void *led, bool high)
{
    *(bool *)led = !high;
    changed_cycle = board.avr->cycle;
}

static void start(uint8_t warm_up_s)
{
    memset(lit, 0, sizeof lit);
    scene.value[0] = 3000;
    board_start("hps167s_rs485");
    fathom_sim_hps167s_init(
        &hps, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&scene), .warm_up_s = warm_up_s});
    board_attach(&line, &hps.device, false);
    board_join_line(&line);
    board_join_driver('D', 2);
    for (uint8_t i = 0; i < LEDS; i++) board_watch('B', i, true, changed, &lit[i]);
}

static int set_up(void **state)
{
    start(0);
    assert_true(board_run_us(200000));
    return 0;
}

static int tear_down(void **state)
{
    assert_false(board.crashed);
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
    board_end();
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void assert_lit(bool near, bool far, bool error)
{
    assert_int_equal(lit[NEAR], near);
    assert_int_equal(lit[FAR], far);
    assert_int_equal(lit[ERROR], error);
}

TEST(far_is_lit_while_nothing_is_near)
{
    assert_lit(false, true, false);
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    assert_true(board_run_us(1000000));
    assert_lit(false, true, false);
}

/* How long until an LED changes, in periods of the sensor, rounded to the nearest. */
static unsigned periods_until_change(void)
{
    const uint64_t begin_cycle = board.avr->cycle;
    changed_cycle = 0;
    for (unsigned ms = 0; changed_cycle == 0 && ms < 1000; ms++) assert_true(board_run_us(1000));
    assert_true(changed_cycle != 0);
    assert_true(board_run_us(1000)); /* The program switches one LED after the other. */
    return (unsigned)((changed_cycle - begin_cycle) / (BOARD_CYCLES_PER_US * PERIOD_US));
}

TEST(near_is_lit_after_three_nearer_ones_and_far_after_five_farther_ones)
{
    scene.value[0] = 1499;
    assert_in_range(periods_until_change(), 2, 3);
    assert_lit(true, false, false);
    scene.value[0] = 1501;
    assert_in_range(periods_until_change(), 4, 5);
    assert_lit(false, true, false);
}

/* Near twice, far once, and so on, by what is measured. */
static int32_t two_of_three(void *ctx, uint8_t probe, uint32_t now_us)
{
    unsigned *const asked = ctx;
    return (*asked)++ % 3 == 2 ? 3000 : 100;
}

TEST(two_nearer_ones_light_nothing)
{
    unsigned asked = 0;
    hps.device.scene = (fathom_sim_scene_t){two_of_three, &asked};
    changed_cycle = 0;
    assert_true(board_run_us(1000000));
    assert_in_range(asked, 50, 54);
    assert_int_equal(changed_cycle, 0);
    assert_lit(false, true, false);
}

TEST(it_asks_54_times_a_second)
{
    const uint32_t before = hps.device.counters.answered;
    assert_true(board_run_us(1000000));
    assert_in_range(hps.device.counters.answered - before, 53, 54);
    assert_int_equal(hps.device.counters.truncated, 0);
    assert_int_equal(hps.device.counters.crc_errors, 0);
    assert_int_equal(hps.device.counters.unserved, 0);
}

TEST(a_dead_sensor_lights_the_error_alone_until_it_answers_again)
{
    /* Beyond its warm-up, 5 s and a time-out, in which silence is no error. */
    assert_true(board_run_us(6000000));
    assert_lit(false, true, false);
    board_sync();
    fathom_sim_power_cycle(&line, &hps.device, 10000000, board.clock.now_us);
    board_plan();
    assert_true(board_run_us(2000000)); /* two attempts of 500 ms each */
    assert_lit(false, false, true);
    assert_true(board_run_us(20000000));
    assert_lit(false, true, false);
}

TEST(a_sensor_that_says_it_is_broken_lights_the_error)
{
    assert_true(board_run_us(6000000));
    scene.value[0] = FATHOM_SIM_FAULT;
    assert_true(board_run_us(100000));
    assert_lit(false, false, true);
    scene.value[0] = 1000;
    assert_true(board_run_us(100000));
    assert_lit(true, false, false);
}

TEST(while_it_warms_up_nothing_is_lit)
{
    start(5);
    for (int i = 0; i < 49; i++) {
        assert_true(board_run_us(100000));
        assert_lit(false, false, false);
    }
    assert_true(board_run_us(2000000));
    assert_lit(false, true, false);
}

TEST(a_single_damaged_response_is_no_error)
{
    assert_true(board_run_us(6000000));
    for (int i = 0; i < 10; i++) {
        /* A byte of noise, somewhere in the cycle. */
        usart_arrive(&board.usart, 0x55, FATHOM_RX_PARITY);
        changed_cycle = 0;
        assert_true(board_run_us(101000));
        assert_lit(false, true, false);
        assert_int_equal(changed_cycle, 0);
    }
}

TEST(it_sleeps_most_of_the_time)
{
    const uint64_t asleep_cycles = board.asleep_cycles;
    const uint64_t begin_cycle = board.avr->cycle;
    assert_true(board_run_us(1000000));
    assert_true((board.asleep_cycles - asleep_cycles) * 10 > (board.avr->cycle - begin_cycle) * 8);
}
