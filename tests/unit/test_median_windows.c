/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/processing/median.h"
#include "stream_rig.h"

/*
 * The median against a reference that keeps what came in a list, sorts a copy of it, and has a clock of 64 bits: every
 * window of 3 to 6 of the few values that matter, and random runs with gate, silences and the clock's wrap.
 */
enum { MAX = FATHOM_MEDIAN_MAX_COUNT, FARTHER = 70000, STEPS = 200 };

static struct {
    int32_t list[MAX]; /* mm; the oldest first */
    unsigned have;
    unsigned row;
    unsigned dropped;
    uint64_t last_us;
} reference;

static fathom_median_config_t config;
static fathom_median_t median;
static uint16_t window[MAX];
static uint32_t seed; /* of a random run, or the number of a window */

static void demand(bool is_so)
{
    if (!is_so) fail_msg("with %u in the window and the seed %lu", config.count, (unsigned long)seed);
}

static void start(uint8_t count)
{
    memset(&reference, 0, sizeof reference);
    config.window = window;
    config.count = count;
    assert_int_equal(fathom_median_init(&median, &config), FATHOM_OK);
}

static int32_t middle(void)
{
    int32_t sorted[MAX];
    memcpy(sorted, reference.list, sizeof sorted);
    for (unsigned i = 1; i < reference.have; i++)
        for (unsigned n = i; n != 0 && sorted[n] < sorted[n - 1]; n--) {
            const int32_t other = sorted[n];
            sorted[n] = sorted[n - 1];
            sorted[n - 1] = other;
        }
    return sorted[reference.have % 2 == 1 ? reference.have / 2 : reference.have / 2 - 1];
}

static bool is_spike(int32_t mm)
{
    if (config.gate_mm == 0 || reference.have != config.count) return false;
    const int32_t from_mm = middle();
    if (mm == from_mm) return false;
    if (mm == FARTHER || from_mm == FARTHER) return true;
    return (mm > from_mm ? mm - from_mm : from_mm - mm) > (int32_t)config.gate_mm;
}

/* The median with this one, or -1. */
static int32_t refer(int32_t mm, uint64_t at_us)
{
    if (reference.have != 0 && at_us - reference.last_us > config.unknown_us) {
        reference.have = 0;
        reference.row = 0;
    }
    reference.last_us = at_us;
    if (is_spike(mm)) {
        if (reference.row != config.gate_row) {
            reference.row++;
            reference.dropped++;
            return -1;
        }
        reference.have = 0;
    }
    reference.row = 0;
    if (reference.have == config.count) {
        memmove(reference.list, reference.list + 1, sizeof reference.list - sizeof reference.list[0]);
        reference.have--;
    }
    reference.list[reference.have++] = mm;
    return reference.have == config.count ? middle() : -1;
}

static void compare(int32_t mm, uint64_t at_us)
{
    const int32_t expected = refer(mm, at_us);
    const uint8_t kind = mm == 0 ? FATHOM_NEAR : mm == FARTHER ? FATHOM_NO_TARGET : FATHOM_TARGET;
    fathom_sample_t sample = {.time_us = (uint32_t)at_us, .kind = kind};
    if (kind == FATHOM_TARGET) sample.distance_mm = (uint16_t)mm;
    demand(fathom_median_add_sample(&median, &sample, &sample) == (expected >= 0));
    demand(median.dropped == reference.dropped);
    if (expected < 0) return;
    const uint8_t is = expected == 0 ? FATHOM_NEAR : expected == FARTHER ? FATHOM_NO_TARGET : FATHOM_TARGET;
    demand(sample.kind == is);
    demand(sample.distance_mm == (is == FATHOM_TARGET ? expected : 0));
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

TEST(every_window_of_3_to_6_has_its_median)
{
    static const int32_t values[] = {0, 1, 1000, 65534, FARTHER};
    uint32_t windows = 5 * 5;
    config.unknown_us = UINT32_MAX;
    for (uint8_t count = 3; count <= 6; count++) {
        windows *= 5;
        for (seed = 0; seed != windows; seed++) {
            uint32_t rest = seed;
            start(count);
            for (uint8_t i = 0; i != count; i++, rest /= 5) compare(values[rest % 5], 0);
        }
    }
}

/* Near one place, with spikes, steps and silences. */
static void run(void)
{
    int32_t place_mm = 1000;
    rig_seed(seed);
    config.gate_mm = (uint16_t)(rig_random_below(3) * 50);
    config.gate_row = (uint8_t)(1 + rig_random_below(4));
    config.unknown_us = 1000000 + rig_random_below(2) * 1000000000;
    start((uint8_t)(3 + rig_random_below(13)));
    uint64_t at_us = UINT64_C(0x100000000) - rig_random_below(20000000);
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t dice = rig_random_below(100);
        if (dice == 0) place_mm = (int32_t)(100 + rig_random_below(65000));
        int32_t mm = place_mm + (int32_t)rig_random_below(60);
        if (dice > 95) mm = dice % 2 == 0 ? 0 : FARTHER;
        if (dice > 90 && dice <= 95) mm = (int32_t)(1 + rig_random_below(65534));
        /* up to 300 ms; at times up to 2 s, and exactly unknown_us and one more */
        at_us += rig_random_below(dice == 50 ? 2000000 : 300000);
        if (dice == 51 && config.unknown_us == 1000000) at_us = reference.last_us + 1000000 + i % 2;
        if (dice == 52) { /* nothing came; at once, or 17 minutes later, it is asked for the time */
            at_us += rig_random_below(2000000) + (i % 2) * 1000000000u;
            const bool empties = reference.have != 0 && at_us - reference.last_us > config.unknown_us;
            demand(fathom_median_advance(&median, (uint32_t)at_us) == empties);
            if (empties) reference.have = reference.row = 0;
        }
        compare(mm, at_us);
    }
}

TEST(random_runs_have_the_medians_and_drop_the_spikes_of_a_sorted_list)
{
    const uint32_t seeds = suite_is_long ? 20000 : 2000;
    for (seed = 0; seed != seeds; seed++) run();
}
