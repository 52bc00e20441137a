/* SPDX-License-Identifier: MIT */
/* a16:switch and a05:relay on a line of a GPIO chip. */
#include "pins_bench.h"

static const suite_t suite = {.set_up = set_up};

/* ---- switch and relay ---- */

static void come_near(void) { see(500); }

TEST(a_switch_says_near_and_far)
{
    with_a16(FATHOM_SIM_A16_SWITCH);
    see(3000);
    at_us = 4000000;
    happens = come_near;
    EXPECT(0, 2, "s  a16  ", "read a16:switch@gpiochip0,in=6,bias=down --duration 10");
    assert_non_null(strstr(last->out, "s  a16  far\n"));
    assert_non_null(strstr(last->out, "s  a16  near\n"));
    assert_int_equal(chip.asked.in, 6);
    assert_int_equal(chip.asked.bias, FATHOM_GPIO_BIAS_PULL_DOWN);
    assert_int_equal(chip.asked.trigger, -1);
    assert_int_equal(chip.asked.echo, -1);
}

TEST(a_switch_repeats_its_state_and_has_no_distance)
{
    with_a16(FATHOM_SIM_A16_SWITCH);
    see(3000);
    EXPECT(0, 5, "far", "read a16:switch@gpiochip0,in=6 --interval 1000 --count 5");
    assert_in_range(last->took_us, 4000000, 4200000);
    EXPECT(0, 1, "\"status\":\"far\",\"interference\":false,\"distance_mm\":null",
           "read a16:switch@gpiochip0,in=6 --count 1 --format json");
    see(500);
    fathom_sim_clock_advance(&bench.clock, 5000000);
    EXPECT(0, 1, "\"status\":\"near\",\"interference\":false,\"distance_mm\":null,\"raw\":1",
           "read a16:switch@gpiochip0,in=6 --count 1 --format json");
}

/* The contact goes to ground: it conducts, and the input is low, when something is near (A05 4). */
TEST(a_relay_that_pulls_down_is_near_when_it_is_low)
{
    with_relay((fathom_sim_a05_config_t){.bounces = 10});
    see(3000);
    at_us = 4000000;
    happens = come_near;
    EXPECT(0, 2, "s  a05  ", "read a05:relay@gpiochip0,in=5,bias=up --duration 10");
    assert_non_null(strstr(last->out, "s  a05  far\n"));
    assert_non_null(strstr(last->out, "s  a05  near\n"));
    assert_int_equal(chip.asked.in, 5);
    assert_int_equal(chip.asked.bias, FATHOM_GPIO_BIAS_PULL_UP);
    EXPECT(0, 1, "\"probe\":null", "read a05:relay@gpiochip0,in=5,bias=up --count 1 --format json");
    assert_non_null(strstr(last->out, "\"status\":\"near\""));
    assert_non_null(strstr(last->out, "\"raw\":0"));
}

static bool get_inverted(void *ctx)
{
    const fathom_pin_t pin = fathom_sim_tx_pin(&pins);
    return !pin.get(pin.ctx);
}

/* The contact goes to ground or to the supply, is normally open or normally closed, and near= says which level is near.
 * Register 0x0205 of a switch may be 0. */
TEST(near_is_the_level_of_the_contact_unless_the_user_names_it)
{
    static const struct {
        bool is_closed, is_inverted;
        const char *seen, *keys;
    } rows[] = {
        {false, true, "near", "bias=down"},       {true, false, "near", "bias=up,near=high"},
        {true, false, "far", "bias=up,near=low"}, {true, true, "near", "bias=down,near=low"},
        {true, true, "far", "bias=down"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)set_up(NULL);
        with_relay((fathom_sim_a05_config_t){.normally_closed = rows[i].is_closed});
        if (rows[i].is_inverted) chip.in.get = get_inverted;
        see(500);
        fathom_sim_clock_advance(&bench.clock, 5000000);
        EXPECT(0, 1, rows[i].seen, "read a05:relay@gpiochip0,in=5,%s --count 1", rows[i].keys);
    }
    (void)set_up(NULL);
    with_a16(FATHOM_SIM_A16_SWITCH);
    see(500);
    fathom_sim_clock_advance(&bench.clock, 5000000);
    EXPECT(0, 1, "near", "read a16:switch@gpiochip0,in=6,near=high --count 1");
    EXPECT(0, 1, "far", "read a16:switch@gpiochip0,in=6,near=low --count 1");
}

static bool get_noise(void *ctx) { return (bench.clock.now_us / 7000) % 2 != 0; }

TEST(a_level_that_does_not_stand_still_says_what_to_check)
{
    with_relay((fathom_sim_a05_config_t){0});
    chip.in.get = get_noise;
    EXPECT(1, 0, "far", "read a05:relay@gpiochip0,in=5 --count 1");
    expect_err(
        "attempt 1: no reading from a05 at gpiochip0: the level is not stable. Check for a loose wire");
    expect_err("bias=up, bias=down");
}

TEST(watch_has_a_lane_of_near_and_far)
{
    with_relay((fathom_sim_a05_config_t){0});
    see(3000);
    at_us = 4000000;
    happens = come_near;
    const tool_run_t *const run =
        tool_run(&bench.tool, "watch a05:relay@gpiochip0,in=5,bias=up --duration 8");
    assert_int_equal(run->status, 0);
    assert_int_equal(count_of(run->out, "probe"), 0); /* it is all probes' */
    const char *const near = strstr(run->out, "near");
    const char *const far = strstr(run->out, "far");
    assert_non_null(near);
    assert_non_null(far);
    assert_true(far < near);
    assert_null(strstr(near, "far")); /* and so it stays */
}
