/* SPDX-License-Identifier: MIT */
/* Sensors on the lines of a GPIO chip: a16:pwm, and how exact --stats says it is; a16:switch and a05:relay; the chip itself;
 * wrong usage. */
#include "sim/pin.h"
#include "tool_bench.h"

#define PWM "a16:pwm@gpiochip0,trigger=17,echo=27"

static fathom_sim_pins_t pins;
static tool_chip_t chip;
static const tool_run_t *last; /* of EXPECT */

/* What happens so long after the begin; 0: nothing does. */
static uint64_t passed_us;
static uint64_t at_us;
static void (*happens)(void);
static uint64_t until_us; /* and when it is away: it comes back */

static void pass(void *ctx, uint32_t max_us)
{
    const uint32_t began_us = bench.clock.now_us;
    fathom_sim_clock_idle(ctx, max_us < 1000 ? max_us : 1000);
    passed_us += bench.clock.now_us - began_us;
    if (at_us != 0 && passed_us >= at_us) {
        at_us = 0;
        happens();
    }
    if (until_us != 0 && passed_us >= until_us) chip.is_away = false;
}

static void take_pins(fathom_sim_device_t *device)
{
    fathom_sim_pins_init(&pins, device, &bench.line, &bench.clock);
    chip.trigger = fathom_sim_rx_pin(&pins);
    chip.capture = fathom_sim_capture(&pins);
    chip.in = fathom_sim_tx_pin(&pins);
}

static void with_a16(uint8_t mode)
{
    bench_a16((fathom_sim_a16_config_t){.mode = mode});
    take_pins(&bench.a16.device);
}

static void with_relay(fathom_sim_a05_config_t config)
{
    config.mode = FATHOM_SIM_A05_RELAY;
    bench_a05(config);
    take_pins(&bench.a05.device);
}

static void see(int32_t mm)
{
    for (int i = 0; i != 4; i++) bench.scene.value[i] = mm;
}

static int set_up(void **state)
{
    bench_begin();
    chip = (tool_chip_t){.path = "gpiochip0"};
    passed_us = 0;
    at_us = 0;
    until_us = 0;
    bench.tool.chip = &chip;
    bench.tool.idle = pass;
    return 0;
}

/* Runs it; `out` has this part so often and no other lines. */
#define EXPECT(exit_status, times, part, ...)                                                                \
    do {                                                                                                     \
        const tool_run_t *const ran = tool_run(&bench.tool, __VA_ARGS__);                                    \
        if (ran->status != (exit_status) || count_of(ran->out, part) != (times) ||                           \
            count_of(ran->out, "\n") != (times))                                                             \
            fail_msg("exit status %d, not %u times '%s':\n%s%s", ran->status, (unsigned)(times), part,       \
                     ran->out, ran->err);                                                                    \
        last = ran;                                                                                          \
    } while (0)

static void expect_err(const char *text)
{
    if (strstr(last->err, text) == NULL) fail_msg("'%s' is not in\n%s%s", text, last->out, last->err);
}

static const suite_t suite = {.set_up = set_up};

/* It starts with the fall of a high pulse. The simulated pulse of 1000 mm has 5750 us, which are 991 mm at 58 us/cm. */
TEST(an_hc_sr04_is_read_with_its_own_scale)
{
    bench_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_PWM, .cycle_us = 50000, .pulse_us = 500});
    take_pins(&bench.a16.device);
    see(1000);
    EXPECT(0, 2, "hc-sr04     991 mm", "read hc-sr04@gpiochip0,trigger=17,echo=27 --count 2");
}

/* Its trigger rises, so a line that is opened high would start a measurement. That of an A16 falls. */
TEST(the_trigger_is_opened_at_its_idle_level)
{
    static const char *const words[] = {"a16:pwm", "hc-sr04", "a02yymw"};
    for (size_t i = 0; i != sizeof words / sizeof words[0]; i++) {
        (void)set_up(NULL);
        with_a16(FATHOM_SIM_A16_PWM);
        (void)tool_run(&bench.tool, "read %s@gpiochip0,trigger=17,echo=27 --count 1", words[i]);
        assert_int_equal(chip.opened, 1);
        assert_int_equal(chip.asked.idles_low, i == 1);
    }
}

/* ---- A16 controlled, its trigger on a GPIO line and its response on a serial port ---- */

#define CONTROLLED "a16:controlled@line,trigger=gpiochip0/17"

TEST(controlled_is_triggered_by_a_gpio_line)
{
    with_a16(FATHOM_SIM_A16_CONTROLLED);
    EXPECT(0, 3, "1234 mm    1.234 m", "read " CONTROLLED " --count 3");
    assert_int_equal(chip.asked.trigger, 17);
    assert_int_equal(chip.asked.in, -1);
    assert_int_equal(chip.opened, 1);
    assert_int_equal(chip.closed, 1);
    EXPECT(1, 0, "mm", "read a16:controlled@line,trigger=gpiochip1/17 --count 1");
    expect_err("gpiochip1: no such chip");
}

static void drive_nothing(void *ctx, bool level)
{
    (void)ctx;
    (void)level;
}

TEST(a_wire_of_the_trigger_that_is_broken_says_what_to_check)
{
    with_a16(FATHOM_SIM_A16_CONTROLLED);
    chip.trigger = (fathom_pin_t){.set = drive_nothing};
    EXPECT(1, 0, "mm", "read " CONTROLLED " --count 1");
    expect_err("nothing followed the trigger. Check the supply");
}

/* ---- A16 PWM ---- */

TEST(pwm_reads_a_pulse_a_cycle_at_the_lines_that_were_named)
{
    with_a16(FATHOM_SIM_A16_PWM);
    EXPECT(0, 3, "1234 mm    1.234 m", "read " PWM " --count 3");
    assert_string_equal(last->out, "     0.119 s  a16    1234 mm    1.234 m\n" /* 2 + 110 + 7 ms (A16 1) */
                                   "     0.340 s  a16    1234 mm    1.234 m\n" /* and cycles of 221 ms */
                                   "     0.561 s  a16    1234 mm    1.234 m\n");
    assert_int_equal(chip.asked.trigger, 17);
    assert_int_equal(chip.asked.echo, 27);
    assert_int_equal(chip.asked.in, -1);
    assert_int_equal(chip.asked.bias, FATHOM_GPIO_BIAS_AS_IS);
    assert_int_equal(chip.opened, 1);
    assert_int_equal(chip.closed, 1);
}

TEST(pwm_keeps_an_interval)
{
    with_a16(FATHOM_SIM_A16_PWM);
    EXPECT(0, 3, "1234 mm", "read " PWM " --count 3 --interval 1000");
    assert_in_range(last->took_us, 2119000, 2135000);
}

TEST(pwm_reports_the_width_and_what_is_no_distance)
{
    with_a16(FATHOM_SIM_A16_PWM);
    see(4000); /* 23000 us, by A16 1: 4000 mm * 23 / 4 */
    EXPECT(0, 1, "\"status\":\"target\"", "read " PWM " --count 1 --format json");
    assert_non_null(strstr(last->out, "\"mode\":\"pwm\""));
    assert_non_null(strstr(last->out, "\"distance_mm\":4000,\"raw\":23000"));
    with_a16(FATHOM_SIM_A16_PWM);
    see(FATHOM_SIM_NO_TARGET);
    EXPECT(0, 1, "no_target", "read " PWM " --count 1");
    with_a16(FATHOM_SIM_A16_PWM);
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_HIGH);
    EXPECT(0, 1, "fault: the line stays high; check the wire of echo", "read " PWM " --count 1");
    EXPECT(0, 1, "\"status\":\"fault\"", "read " PWM " --count 1 --format json");
}

TEST(no_pulse_says_what_to_check)
{
    with_a16(FATHOM_SIM_A16_PWM);
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_LOW);
    EXPECT(1, 0, "mm", "read " PWM " --count 1");
    expect_err("attempt 1: no reading from a16 at gpiochip0: no pulse was received. Check the supply");
    expect_err("line numbers of the chip");
    expect_err("5 V or RS232 destroy a pin for 3.3 V");
}

TEST(a_distance_outside_the_window_is_refused)
{
    with_a16(FATHOM_SIM_A16_PWM);
    EXPECT(1, 0, "mm", "read " PWM " --count 1 --window 2000-3000");
    expect_err("a pulse is no distance from 2000 to 3000 mm");
}

static void spike_of(uint32_t width_us)
{
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_HIGH);
    fathom_sim_clock_advance(&bench.clock, width_us);
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_WHOLE);
}

static void spike(void) { spike_of(99); }

static void cut_with_noise(void)
{
    spike();
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_LOW);
}

static void cut_with_short_pulse(void)
{
    spike_of(1500);
    fathom_sim_tx_wire(&pins, FATHOM_SIM_WIRE_LOW);
}

TEST(noise_is_rejected_and_counted_and_a_short_pulse_is_unknown)
{
    static const struct {
        void (*happens)(void);
        int status;
        unsigned lines;
        const char *out, *err;
    } rows[] = {
        {spike, 0, 1, "1234 mm", "noises 1, faults 0, missed_edges 0, lost_events 0"},
        {cut_with_noise, 1, 0, "mm", "no pulse of the sensor, but 1 shorter ones: noise"},
        {cut_with_short_pulse, 1, 1,
         "unknown: all pulses are too short for the sensor; the longest has 1500 us", "noises 1"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)set_up(NULL);
        with_a16(FATHOM_SIM_A16_PWM);
        at_us = 50000;
        happens = rows[i].happens;
        EXPECT(rows[i].status, rows[i].lines, rows[i].out, "read " PWM " --count 1 --stats");
        expect_err(rows[i].err);
    }
}

/* ---- how exact they are ---- */

static const uint32_t *widths_us; /* of the pulses to come, ended by 0 */
static bool is_armed;

static void arm_widths(void *ctx) { is_armed = true; }

static int take_width(void *ctx, fathom_pulse_t *pulse)
{
    pulse->is_high = false;
    if (!is_armed || *widths_us == 0) return 0;
    is_armed = false;
    pulse->width_us = *widths_us++;
    pulse->end_us = bench.clock.now_us;
    return 1;
}

static void with_widths(const uint32_t *list)
{
    with_a16(FATHOM_SIM_A16_PWM);
    widths_us = list;
    is_armed = false;
    chip.capture = (fathom_capture_t){arm_widths, take_width, NULL};
}

/* 58.8 us for each cm (src/models): 5880 us are 1000 mm. 60 ms are no target. */
TEST(free_running_pulses_are_read_without_a_trigger)
{
    static const uint32_t free_us[] = {5880, 60000, 11760, 0};
    with_widths(free_us);
    EXPECT(0, 3, "jsn-sr04t", "read jsn-sr04t:free@gpiochip0,echo=27 --count 3");
    assert_int_equal(chip.asked.trigger, -1);
    if (strstr(last->out, "1000 mm") == NULL || strstr(last->out, "no_target") == NULL ||
        strstr(last->out, "2000 mm") == NULL)
        fail_msg("%s%s", last->out, last->err);
    assert_refused("read jsn-sr04t:free@gpiochip0,trigger=17,echo=27", "has no trigger=");
}

REFUSES(a_sensor_without_a_line_is_not_simulated, "sim",
        {"hc-sr04",
         "hc-sr04 in mode pwm has GPIO pins and no line to simulate. Connect a module and run 'fathom "
         "read hc-sr04:pwm@gpiochip0,trigger=17,echo=27', or simulate"},
        {"jsn-sr04t::free",
         "jsn-sr04t in mode free has GPIO pins and no line to simulate. Connect a module and "
         "run 'fathom read jsn-sr04t:free@gpiochip0,echo=27', or simulate"})

/* The squares of -10, 0 and 10 by 2: 100, of which the root is 10 us; times 4 / 23 that is 1.74 mm. */
TEST(stats_tell_the_spread_of_the_widths_and_what_was_rejected)
{
    static const uint32_t list[] = {9990, 10000, 10010, 94000, 120000, 0};
    with_widths(list);
    chip.missed = 3;
    chip.lost_events = 5;
    EXPECT(0, 5, "s  a16", "read " PWM " --count 5 --stats");
    expect_err(
        "fathom: a16: pulses: distances 3, min_us 9990, max_us 10010, mean_us 10000.0, deviation_us 10.0, "
        "deviation_mm 1.7, no_targets 1, noises 0, faults 1, missed_edges 3, lost_events 5\n");
    with_widths(list);
    chip.missed = 3;
    chip.lost_events = 5;
    EXPECT(0, 5, "\"mode\":\"pwm\"", "read " PWM " --count 5 --stats --format json");
    expect_err("{\"name\":\"a16\",\"pulses\":{\"distances\":3,\"min_us\":9990,\"max_us\":10010,\"mean_us\":"
               "10000.0,"
               "\"deviation_us\":10.0,\"deviation_mm\":1.7,\"no_targets\":1,\"noises\":0,\"faults\":1,"
               "\"missed_edges\":3,"
               "\"lost_events\":5}}\n");
}

TEST(stats_of_one_pulse_and_of_none_have_no_spread)
{
    static const uint32_t one[] = {10000, 0};
    with_widths(one);
    EXPECT(0, 1, "1739 mm", "read " PWM " --count 1 --stats");
    expect_err("pulses: distances 1, min_us 10000, max_us 10000, mean_us 10000.0, deviation_us -, ");
    static const uint32_t none[] = {0};
    with_widths(none);
    EXPECT(1, 1, "\"status\":\"no_response\",", "read " PWM " --count 1 --stats --format json");
    expect_err("\"distances\":0,\"min_us\":null,\"max_us\":null,\"mean_us\":null,\"deviation_us\":null");
}

/* Each second has its own: 4 pulses of 9000 us in the first, then those of 20000. */
TEST(stats_each_second_begin_anew)
{
    static const uint32_t list[] = {9000, 9000, 9000, 9000, 9000, 20000, 20000, 20000, 20000, 0};
    with_widths(list);
    EXPECT(0, 9, "s  a16", "read " PWM " --count 9 --stats=1");
    expect_err("pulses: distances 5, min_us 9000, max_us 9000,");
    expect_err("pulses: distances 4, min_us 20000, max_us 20000,");
}

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

/* ---- the chip ---- */

static void lose(void) { chip.is_away = true; }

TEST(a_chip_that_goes_ends_the_command)
{
    with_a16(FATHOM_SIM_A16_PWM);
    at_us = 1000000;
    happens = lose;
    const tool_run_t *const run = tool_run(&bench.tool, "read " PWM);
    assert_int_equal(run->status, 1);
    assert_in_range(count_of(run->out, "1234 mm"), 3, 5);
    assert_non_null(strstr(run->err, "the chip has gone"));
}

TEST(a_chip_that_comes_back_is_read_again_with_reconnect)
{
    with_a16(FATHOM_SIM_A16_PWM);
    at_us = 1000000;
    until_us = 3000000;
    happens = lose;
    const tool_run_t *const run = tool_run(&bench.tool, "read " PWM " --reconnect --count 12");
    assert_int_equal(run->status, 1); /* an attempt has failed */
    assert_int_equal(count_of(run->out, "1234 mm"), 11);
    assert_int_equal(chip.opened, 2);
    assert_int_equal(chip.closed, 2);
    assert_non_null(strstr(run->err, "gpiochip0: it is back; reading goes on"));
}

TEST(a_chip_that_is_not_there_and_a_line_in_use_are_told)
{
    with_a16(FATHOM_SIM_A16_PWM);
    chip.is_away = true;
    EXPECT(1, 0, "mm", "read " PWM);
    expect_err("fathom: gpiochip0: no such chip\n");
    chip.is_away = false;
    chip.refusal = "in use by \"spi0 CS0\"";
    EXPECT(1, 0, "mm", "read " PWM);
    expect_err("fathom: gpiochip0: in use by \"spi0 CS0\"\n");
}

TEST(two_sensors_on_one_chip_are_read_in_one_command)
{
    with_a16(FATHOM_SIM_A16_PWM);
    const tool_run_t *const run = tool_run(
        &bench.tool, "read tank=" PWM " door=a05:relay@gpiochip0,in=5,bias=up --interval 300 --count 4");
    assert_int_equal(run->status, 0);
    assert_int_equal(count_of(run->out, "s  tank"), 4);
    assert_int_equal(count_of(run->out, "s  door"), 4);
    assert_int_equal(chip.opened, 2);
}

/* ---- wrong usage ---- */

TEST(what_is_wrong_usage_says_what_to_write)
{
    static const char *const rows[][2] = {
        {"a16:pwm@gpiochip0,trigger=17",
         "a16 in mode pwm needs echo=, such as @gpiochip0,trigger=17,echo=27"},
        {"a16:pwm@gpiochip0,echo=27", "a16 in mode pwm needs trigger=, such"},
        {"a16:switch --port gpiochip0", "a16 in mode switch needs in=, such as @gpiochip0,in=5"},
        {"a16:switch@gpiochip0,in=5,trigger=6", "a16 in mode switch has no trigger="},
        {"a16:pwm@/dev/ttyUSB0",
         "a16 in mode pwm needs GPIO lines, such as a16:pwm@gpiochip0,trigger=17,echo=27"},
        {"a05:relay@/dev/ttyUSB0", "such as a05:relay@gpiochip0,in=5"},
        {"a16:modbus@gpiochip0,in=5", "a16 in mode modbus needs a serial port, and gpiochip0 is a GPIO chip"},
        {"a05:pwm@gpiochip0,in=5", "unknown mode of a05 'pwm'."},
        {"a16:pwm@gpiochip0,trigger=17,echo=17",
         "line 17 of gpiochip0 is used twice, as trigger= and as echo="},
        {"a16:switch@gpiochip0,in=5,bias=sideways", "bias is 'sideways'. It takes as-is, up, down or off."},
        {"a16:switch@gpiochip0,in=5,near=by", "near is 'by'. It takes low or high."},
        {"a16:switch@gpiochip0,in=5,near=", "near is ''."},
        {"a16:controlled@line,trigger=17", "It takes a chip and a line, such as gpiochip0/17."},
        {"a16:controlled@line,trigger=gpiochip0/x", "such as gpiochip0/17."},
        {"a16:auto@line,trigger=gpiochip0/17", "a16 in mode auto has no trigger=. Leave it out."},
        {PWM ",near=high", "a16 in mode pwm reports distances and has no near="},
        {PWM " --probes 1", "--probes"},
        {PWM " --value real-time", "--value"},
    };
    with_a16(FATHOM_SIM_A16_PWM);
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        EXPECT(2, 0, "mm", "read %s", rows[i][0]);
        expect_err(rows[i][1]);
        assert_int_equal(chip.opened, 0);
    }
}

REFUSES(what_asks_and_what_simulates_has_no_pins, "", {"info " PWM, "a16 in mode pwm receives no requests."},
        {"get " PWM, "a16 in mode pwm receives no requests."},
        {"sim a16:pwm", "a16 in mode pwm has GPIO pins and no line"})
