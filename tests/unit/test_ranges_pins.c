/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_pin.h"
#include "fathom/processing/alarm.h"
#include "fathom/processing/level.h"
#include "fathom/processing/median.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a05_relay_rule.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_switch.h"

/*
 * The range of each member of the configurations of pulses, contacts and of what is made of readings, as the headers
 * state it: init accepts the least and the greatest value, and refuses the two that are beyond. A row without refused
 * values is a member of which every value is allowed.
 */
#define MAX_US          FATHOM_MAX_DURATION_US
#define DC(tenths)      ((uint16_t)(int16_t)(tenths))
#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static fake_t fake;
static fake_pin_t pin;
static fathom_pin_t input;
static uint16_t window[FATHOM_MEDIAN_MAX_COUNT];

static fathom_output_t output;
static const fathom_capture_t *capture;
static const fathom_clock_t *clock_of_all;
static fathom_a16_pwm_config_t pwm;
static fathom_model_facts_t model;
static fathom_a16_switch_config_t of_switch;
static fathom_a05_relay_config_t relay;
static fathom_debounce_config_t debounce;
static fathom_a05_relay_rule_config_t rule;
static fathom_alarm_config_t alarm;
static fathom_median_config_t median;
static fathom_level_config_t tank;

/* What init fills. Its memory is zeroed if it fails. */
static union {
    fathom_a16_pwm_t pwm;
    fathom_a16_switch_t of_switch;
    fathom_a05_relay_t relay;
    fathom_debounce_t debounce;
    fathom_a05_relay_rule_t rule;
    fathom_alarm_t alarm;
    fathom_median_t median;
} driver;

static fathom_status_t init_pwm(void)
{
    return fathom_a16_pwm_init(&driver.pwm, capture, clock_of_all, &output, &pwm);
}
static struct {
    uint32_t cycle_us, no_target_us, stuck_us;
    uint16_t low_us, noise_us;
} pulse;
static fathom_status_t init_pulse(void)
{
    fathom_pulse_meter_t *const meter = &driver.pwm.meter;
    meter->capture = capture;
    meter->trigger.clock = clock_of_all;
    meter->trigger.output = output;
    meter->trigger.period_us = pulse.cycle_us;
    meter->trigger.low_us = pulse.low_us;
    meter->no_target_us = pulse.no_target_us;
    meter->stuck_us = pulse.stuck_us;
    meter->noise_us = pulse.noise_us;
    return fathom_pulse_init(meter);
}
static fathom_status_t init_switch(void)
{
    return fathom_a16_switch_init(&driver.of_switch, &input, clock_of_all, &of_switch);
}
static fathom_status_t init_relay(void)
{
    return fathom_a05_relay_init(&driver.relay, &input, clock_of_all, &relay);
}
static fathom_status_t init_debounce(void) { return fathom_debounce_init(&driver.debounce, &debounce); }
static fathom_status_t init_rule(void) { return fathom_a05_relay_rule_init(&driver.rule, &rule); }
static fathom_status_t init_alarm(void) { return fathom_alarm_init(&driver.alarm, &alarm); }
static fathom_status_t init_median(void) { return fathom_median_init(&driver.median, &median); }
static fathom_status_t check_tank(void) { return fathom_level_check(&tank); }

/* An object with its size, which is zeroed by an init that fails. */
static const struct {
    fathom_status_t (*init)(void);
    size_t size;
} objects[] = {
    {init_pwm, sizeof(fathom_a16_pwm_t)},
    {init_pulse, sizeof(fathom_pulse_meter_t)},
    {init_switch, sizeof(fathom_a16_switch_t)},
    {init_relay, sizeof(fathom_a05_relay_t)},
    {init_debounce, sizeof(fathom_debounce_t)},
    {init_rule, sizeof(fathom_a05_relay_rule_t)},
    {init_alarm, sizeof(fathom_alarm_t)},
    {init_median, sizeof(fathom_median_t)},
    {check_tank, 0},
};

static bool get(void *ctx) { return (void)ctx, false; }

static int set_up(void **state)
{
    fake_init(&fake);
    fake_pin_init(&pin, &fake);
    input = (fathom_pin_t){NULL, get, NULL};
    output = fathom_output_pin(&pin.trigger);
    capture = &pin.capture;
    clock_of_all = &fake.clock;
    model = fathom_a16_pwm_model;
    pwm = (fathom_a16_pwm_config_t){.model = &model};
    pulse.cycle_us = 221000;
    pulse.low_us = 2000;
    pulse.noise_us = 2700;
    pulse.no_target_us = 92000;
    pulse.stuck_us = 105000;
    of_switch = (fathom_a16_switch_config_t){0};
    relay = (fathom_a05_relay_config_t){0};
    debounce = (fathom_debounce_config_t){0};
    rule = (fathom_a05_relay_rule_config_t){0};
    alarm = (fathom_alarm_config_t){.when = FATHOM_NEAR,
                                    .on_mm = 500,
                                    .off_mm = 600,
                                    .if_unknown = FATHOM_ALARM_ON,
                                    .if_no_response = FATHOM_ALARM_ON};
    median = (fathom_median_config_t){.window = window, .count = 5};
    tank = (fathom_level_config_t){
        .volume = fathom_tank_upright, .mounting_mm = 2100, .height_mm = 2000, .capacity = 5000};
    memset(&driver, 0x5A, sizeof driver);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

typedef struct {
    const char *name;
    fathom_status_t (*init)(void);
    void *member;
    size_t size;
    uint32_t least;
    uint32_t greatest;
    uint32_t refused[2];
    unsigned refused_count;
} range_t;

#define RANGE(init, member, least, greatest, below, above)                                                   \
    {                                                                                                        \
#member, init, &(member), sizeof(member), least, greatest, {below, above }, 2                        \
    }
#define ANY(init, member, greatest)                                                                          \
    {                                                                                                        \
#member, init, &(member), sizeof(member), 0, greatest, {0, 0 }, 0                                    \
    }

#define CONTACT_TIMES(init, of)                                                                              \
    RANGE(init, of.timing.settle_us, 1, 1999999, 2000000, UINT32_MAX),                                       \
        RANGE(init, of.timing.period_us, 1, MAX_US, MAX_US + 1, FATHOM_NO_DEADLINE),                         \
        RANGE(init, of.timing.interval_us, 1, MAX_US, MAX_US + 1, FATHOM_NO_DEADLINE - 1),                   \
        RANGE(init, of.timing.interval_us, FATHOM_NO_DEADLINE, FATHOM_NO_DEADLINE, MAX_US + 1,               \
              FATHOM_NO_DEADLINE - 1),                                                                       \
        RANGE(init, of.timing.stale_us, 20001, MAX_US, 20000, MAX_US + 1)

static const range_t ranges[] = {
    RANGE(init_pulse, pulse.cycle_us, 105000, MAX_US, 104999, MAX_US + 1),
    RANGE(init_pulse, pulse.low_us, 1, 60000, 60001, UINT16_MAX),
    ANY(init_pulse, pulse.noise_us, UINT16_MAX),
    RANGE(init_pulse, pulse.no_target_us, 2701, 105000, 2700, 105001),
    RANGE(init_pulse, pulse.stuck_us, 92000, 221000, 91999, 221001),
    RANGE(init_pwm, pwm.period_us, 0, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_pwm, model.min_mm, 0, 18000, 18001, UINT16_MAX),
    RANGE(init_pwm, model.max_mm, 1, UINT16_MAX, 0, 0),
    /* 105 ms is the longest pulse of 94 ms. 95 ms are 106 ms, 3 ms are 1 to 14 ms, and 210 ms are 208 to 221 ms. */
    RANGE(init_pwm, model.period_ms, 105, UINT16_MAX, 104, 1),
    RANGE(init_pwm, model.period_ms, 0, 0, 104, 1), /* 221 ms */
    RANGE(init_pwm, model.no_target_ms, 5, 210, 4, 211),
    ANY(init_pwm, model.no_target_ms, 0),
    RANGE(init_pwm, model.trigger_us, 1, 60000, 60001, UINT16_MAX),
    RANGE(init_pwm, model.us_per_dm, 1, UINT16_MAX, 0, 0),
    RANGE(init_pwm, pwm.air_dc, DC(-400), DC(850), DC(-401), DC(851)),
    CONTACT_TIMES(init_switch, of_switch),
    CONTACT_TIMES(init_relay, relay),
    RANGE(init_relay, relay.wiring, 0, 2, 3, UINT8_MAX),
    RANGE(init_relay, relay.level, 0, 2, 3, UINT8_MAX),
    RANGE(init_debounce, debounce.hold_us, 0, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_debounce, debounce.unknown_us, 1, MAX_US, MAX_US + 1, FATHOM_NO_DEADLINE - 1),
    ANY(init_debounce, debounce.unknown_us, FATHOM_NO_DEADLINE),
    ANY(init_debounce, debounce.threshold_mm, UINT16_MAX),
    ANY(init_debounce, debounce.near_count, UINT8_MAX),
    ANY(init_debounce, debounce.far_count, UINT8_MAX),
    RANGE(init_debounce, debounce.equal, 0, 2, 3, UINT8_MAX),
    RANGE(init_rule, rule.hold_us, 1, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_rule, rule.unknown_us, 1, MAX_US, MAX_US + 1, FATHOM_NO_DEADLINE - 1),
    ANY(init_rule, rule.unknown_us, FATHOM_NO_DEADLINE),
    RANGE(init_rule, rule.threshold_mm, 250, 4500, 249, 4501),
    RANGE(init_rule, rule.probes, 1, 15, 16, UINT8_MAX),
    RANGE(init_rule, rule.equal, 0, 2, 3, UINT8_MAX),
    RANGE(init_alarm, alarm.on_hold_us, 0, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_alarm, alarm.off_hold_us, 0, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_alarm, alarm.unknown_us, 0, MAX_US, MAX_US + 1, UINT32_MAX),
    RANGE(init_alarm, alarm.on_mm, 0, 600, 601, UINT16_MAX),
    RANGE(init_alarm, alarm.off_mm, 500, UINT16_MAX, 499, 0),
    RANGE(init_alarm, alarm.if_unknown, 1, 2, 0, 3),
    RANGE(init_alarm, alarm.if_no_response, 1, 2, 0, 3),
    RANGE(init_alarm, alarm.when, FATHOM_NEAR, FATHOM_NEAR, FATHOM_TARGET, FATHOM_UNKNOWN),
    RANGE(init_median, median.count, 3, 15, 2, 16),
    RANGE(init_median, median.unknown_us, 1, MAX_US, MAX_US + 1, FATHOM_NO_DEADLINE - 1),
    ANY(init_median, median.unknown_us, FATHOM_NO_DEADLINE),
    ANY(init_median, median.gate_mm, UINT16_MAX),
    ANY(init_median, median.gate_row, UINT8_MAX),
    RANGE(check_tank, tank.mounting_mm, 1, UINT16_MAX, 0, 0),
    RANGE(check_tank, tank.height_mm, 1, UINT16_MAX, 0, 0),
    RANGE(check_tank, tank.capacity, 1, UINT32_MAX, 0, 0),
    ANY(check_tank, tank.offset_mm, UINT16_MAX),
};

static void put(const range_t *range, uint32_t value)
{
    const uint8_t value8 = (uint8_t)value;
    const uint16_t value16 = (uint16_t)value;
    set_up(NULL);
    if (range->size == sizeof value8)
        memcpy(range->member, &value8, sizeof value8);
    else if (range->size == sizeof value16)
        memcpy(range->member, &value16, sizeof value16);
    else
        memcpy(range->member, &value, sizeof value);
}

static void expect_of(const range_t *range, uint32_t value, fathom_status_t status)
{
    put(range, value);
    if (range->init() != status) fail_msg("%s: %lu", range->name, (unsigned long)value);
}

static void expect_zeroed(fathom_status_t (*init)(void))
{
    const uint8_t *const bytes = (const uint8_t *)&driver;
    for (unsigned i = 0; i != COUNT_OF(objects); i++)
        for (size_t at = 0; objects[i].init == init && at != objects[i].size; at++)
            assert_int_equal(bytes[at], 0);
}

TEST(each_member_has_a_range_that_init_keeps)
{
    for (unsigned i = 0; i != COUNT_OF(ranges); i++) {
        const range_t *const range = &ranges[i];
        expect_of(range, range->least, FATHOM_OK);
        expect_of(range, range->greatest, FATHOM_OK);
        for (unsigned n = 0; n != range->refused_count; n++) {
            expect_of(range, range->refused[n], FATHOM_ERR_ARGUMENT);
            expect_zeroed(range->init);
        }
    }
}

TEST(every_default_is_inside_its_range)
{
    for (unsigned i = 0; i != COUNT_OF(objects); i++) {
        set_up(NULL);
        assert_int_equal(objects[i].init(), FATHOM_OK);
    }
}

TEST(a_missing_function_is_refused)
{
    const fathom_clock_t clock = {NULL, NULL};
    fathom_capture_t partial = pin.capture;
    partial.arm = NULL;
    capture = &partial;
    assert_int_equal(init_pulse(), FATHOM_ERR_ARGUMENT);
    partial = pin.capture;
    partial.take = NULL;
    assert_int_equal(init_pulse(), FATHOM_ERR_ARGUMENT);
    capture = &pin.capture;
    clock_of_all = &clock;
    assert_int_equal(init_pulse(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(init_switch(), FATHOM_ERR_ARGUMENT);
    median.window = NULL;
    assert_int_equal(init_median(), FATHOM_ERR_ARGUMENT);
    tank.volume = NULL;
    assert_int_equal(check_tank(), FATHOM_ERR_ARGUMENT);
}

/* ---- without init ---- */

TEST(what_is_made_of_readings_does_nothing_in_zeroed_memory)
{
    fathom_sample_t sample = {.kind = FATHOM_TARGET, .distance_mm = 300, .probe = 1, .sequence = 1};
    memset(&driver, 0, sizeof driver);
    for (unsigned n = 0; n != 20; n++) {
        assert_false(fathom_debounce_add_sample(&driver.debounce, &sample));
        assert_false(fathom_debounce_advance(&driver.debounce, n));
    }
    assert_int_equal(driver.debounce.level, 0);
    memset(&driver, 0, sizeof driver);
    for (unsigned n = 0; n != 20; n++) {
        sample.sequence = (uint16_t)n;
        assert_false(fathom_a05_relay_rule_add_sample(&driver.rule, &sample));
    }
    assert_int_equal(driver.rule.debounce.level, 0);
    memset(&driver, 0, sizeof driver);
    for (unsigned n = 0; n != 20; n++) {
        assert_false(fathom_alarm_add_sample(&driver.alarm, &sample));
        assert_false(fathom_alarm_add_status(&driver.alarm, FATHOM_ERR_NO_RESPONSE, n));
    }
    assert_int_equal(driver.alarm.state, 0);
    assert_false(fathom_alarm_is_on(&driver.alarm));
    memset(&driver, 0, sizeof driver);
    for (unsigned n = 0; n != 20; n++) {
        assert_false(fathom_median_add_sample(&driver.median, &sample, &sample));
        assert_false(fathom_median_advance(&driver.median, n));
    }
    const fathom_level_config_t none = {0};
    fathom_level_t level;
    assert_int_equal(fathom_level_from_distance(&none, 300, &level), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_level_check(&none), FATHOM_ERR_ARGUMENT);
}

/* ---- a clock that is set back ---- */

TEST(a_clock_that_is_set_back_does_not_end_a_hold_time)
{
    debounce.hold_us = 1000000;
    debounce.near_count = debounce.far_count = 1;
    assert_int_equal(init_debounce(), FATHOM_OK);
    assert_true(fathom_debounce_add_verdict(&driver.debounce, FATHOM_NEAR, 500000));
    assert_false(fathom_debounce_add_verdict(&driver.debounce, FATHOM_FAR, 400000));
    set_up(NULL);
    alarm.on_hold_us = 1000000;
    assert_int_equal(init_alarm(), FATHOM_OK);
    fathom_sample_t near = {.kind = FATHOM_NEAR, .time_us = 500000};
    assert_false(fathom_alarm_add_sample(&driver.alarm, &near));
    near.time_us = 400000;
    assert_false(fathom_alarm_add_sample(&driver.alarm, &near));
    near.time_us = 1500000;
    assert_true(fathom_alarm_add_sample(&driver.alarm, &near));
}
