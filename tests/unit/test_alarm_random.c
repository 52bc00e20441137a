/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/processing/alarm.h"
#include "stream_rig.h"

/*
 * The alarm against a reference that keeps all distances since the last silence in a list, looks through it anew each
 * time, and has a clock of 64 bits: random distances, faults, errors and silences up to 17 minutes, across the wrap.
 */
enum { STEPS = 60, BETWEEN = 0, MINUTES_17 = 1020000000 }; /* twice that is less than 35 minutes */

static struct {
    uint64_t at_us[STEPS];
    uint8_t side[STEPS];
    unsigned count;
    uint64_t distance_us; /* of the last one, or of the first call */
    bool is_started;
    bool responds;
    uint8_t known; /* ON or OFF, the last */
    uint8_t state;
} reference;

static fathom_alarm_config_t config;
static fathom_alarm_t alarm;
static uint32_t seed;

static void demand(bool is_so)
{
    if (!is_so) fail_msg("with the seed %lu", (unsigned long)seed);
}

static void refer_silence(uint64_t at_us)
{
    if (!reference.is_started) reference.distance_us = at_us;
    reference.is_started = true;
    if (at_us - reference.distance_us <= config.unknown_us) return;
    reference.count = 0;
    reference.state = reference.responds ? FATHOM_ALARM_UNKNOWN : FATHOM_ALARM_NO_RESPONSE;
}

static uint8_t side_of(uint8_t kind, uint16_t mm)
{
    /* What is no distance is beyond all of them. */
    const int32_t at_mm = kind == FATHOM_TARGET ? mm : kind == FATHOM_NEAR ? -1 : 65536;
    const int32_t sign = config.when == FATHOM_NEAR ? 1 : -1;
    if (sign * at_mm < sign * (int32_t)config.on_mm) return FATHOM_ALARM_ON;
    return sign * at_mm > sign * (int32_t)config.off_mm ? FATHOM_ALARM_OFF : BETWEEN;
}

static void refer_distance(uint8_t side, uint64_t at_us)
{
    refer_silence(at_us);
    reference.distance_us = at_us;
    reference.responds = true;
    reference.at_us[reference.count] = at_us;
    reference.side[reference.count++] = side;
    unsigned first = reference.count;
    while (first != 0 && reference.side[first - 1] == side) first--;
    const uint64_t held_us = at_us - reference.at_us[first];
    if (side == FATHOM_ALARM_ON && held_us >= config.on_hold_us) reference.known = reference.state = side;
    if (side == FATHOM_ALARM_OFF && held_us >= config.off_hold_us) reference.known = reference.state = side;
    if (side == BETWEEN) reference.state = reference.known;
}

static void distance(uint64_t at_us)
{
    static const uint8_t kinds[] = {FATHOM_NEAR, FATHOM_FAR, FATHOM_NO_TARGET};
    fathom_sample_t sample = {.time_us = (uint32_t)at_us, .kind = FATHOM_TARGET};
    sample.distance_mm = (uint16_t)(497 + rig_random_below(7));
    if (rig_random_below(8) == 0) sample.kind = kinds[rig_random_below(3)];
    const uint8_t before = reference.state;
    if (sample.kind == FATHOM_NO_TARGET && config.no_target_is_unknown) {
        reference.responds = true;
        refer_silence(at_us);
    } else {
        refer_distance(side_of(sample.kind, sample.distance_mm), at_us);
    }
    demand(fathom_alarm_add_sample(&alarm, &sample) == (reference.state != before));
}

static void other(uint64_t at_us)
{
    static const fathom_status_t statuses[] = {FATHOM_PENDING, FATHOM_PENDING, FATHOM_OK,
                                               FATHOM_ERR_NO_RESPONSE, FATHOM_ERR_EXCEPTION};
    const uint8_t before = reference.state;
    const uint32_t which = rig_random_below(6);
    bool changes;
    if (which == 2 || which >= 4) reference.responds = true;
    if (which == 3) reference.responds = false;
    refer_silence(at_us);
    if (which == 5) {
        const fathom_sample_t fault = {.time_us = (uint32_t)at_us, .kind = FATHOM_FAULT};
        changes = fathom_alarm_add_sample(&alarm, &fault);
    } else {
        changes = fathom_alarm_add_status(&alarm, statuses[which], (uint32_t)at_us);
    }
    demand(changes == (reference.state != before));
}

static uint8_t any_side(void) { return rig_random_below(2) == 0 ? FATHOM_ALARM_ON : FATHOM_ALARM_OFF; }

static void start(void)
{
    const uint16_t apart_mm = (uint16_t)rig_random_below(4);
    memset(&config, 0, sizeof config);
    config.when = rig_random_below(2) == 0 ? FATHOM_NEAR : FATHOM_FAR;
    config.on_mm = config.off_mm = 499;
    if (config.when == FATHOM_NEAR)
        config.off_mm = (uint16_t)(config.off_mm + apart_mm);
    else
        config.on_mm = (uint16_t)(config.on_mm + apart_mm);
    config.on_hold_us = rig_random_below(3) * 1000000;
    config.off_hold_us = rig_random_below(3) * 1000000;
    config.unknown_us = rig_random_below(4) == 0 ? MINUTES_17 : 2000000;
    config.no_target_is_unknown = rig_random_below(2) == 0;
    config.if_unknown = any_side();
    config.if_no_response = any_side();
    assert_int_equal(fathom_alarm_init(&alarm, &config), FATHOM_OK);
    memset(&reference, 0, sizeof reference);
    reference.state = FATHOM_ALARM_UNKNOWN;
    reference.known = config.if_unknown;
}

static bool is_on(void)
{
    if (reference.state == FATHOM_ALARM_UNKNOWN) return config.if_unknown == FATHOM_ALARM_ON;
    if (reference.state == FATHOM_ALARM_NO_RESPONSE) return config.if_no_response == FATHOM_ALARM_ON;
    return reference.state == FATHOM_ALARM_ON;
}

/* How often each state was there, so that a run that never leaves one is seen. */
static unsigned long seen[FATHOM_ALARM_NO_RESPONSE + 1];

static void run(void)
{
    rig_seed(seed);
    start();
    uint64_t at_us = UINT64_C(0x100000000) - rig_random_below(20000000);
    uint32_t others = 1; /* of ten things that come; changes every now and then */
    for (unsigned i = 0; i != STEPS; i++) {
        if (rig_random_below(10) == 0) others = 1 + rig_random_below(9);
        /* whole half seconds, so that every limit is met exactly; at times one us off it */
        at_us += rig_random_below(4) * 500000 + (rig_random_below(10) == 0);
        if (rig_random_below(15) == 0) at_us += rig_random_below(MINUTES_17);
        if (rig_random_below(10) < others)
            other(at_us);
        else
            distance(at_us);
        demand(alarm.state == reference.state && fathom_alarm_is_on(&alarm) == is_on());
        seen[reference.state]++;
    }
}

TEST(random_runs_have_the_states_of_a_list_that_is_looked_through)
{
    const uint32_t seeds = suite_is_long ? 50000 : 5000;
    memset(seen, 0, sizeof seen);
    for (seed = 0; seed != seeds; seed++) run();
    for (unsigned i = FATHOM_ALARM_ON; i <= FATHOM_ALARM_NO_RESPONSE; i++)
        assert_true(seen[i] > seeds * (STEPS / 20));
}
