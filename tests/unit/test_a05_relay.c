/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a05_relay.h"

/* What its levels mean; test_driver_contract.c has the rest. */

enum { OPEN = FATHOM_A05_RELAY_NORMALLY_OPEN, CLOSED = FATHOM_A05_RELAY_NORMALLY_CLOSED };
enum { LOW_CONDUCTS = FATHOM_A05_RELAY_CONDUCTS_LOW, HIGH_CONDUCTS = FATHOM_A05_RELAY_CONDUCTS_HIGH };

static void start(uint8_t wiring, uint8_t level_of_it, bool level)
{
    static fathom_a05_relay_t relay;
    rig_start(1000);
    rig.level = level;
    const fathom_a05_relay_config_t config = {.wiring = wiring, .level = level_of_it};
    memset(&relay, 0x5A, sizeof relay);
    assert_int_equal(fathom_a05_relay_init(&relay, &rig.pin, &rig.fake.clock, &config), FATHOM_OK);
    rig.sensor = fathom_a05_relay_sensor(&relay);
}

static void read_as(uint8_t wiring, uint8_t level_of_it, uint8_t low, uint8_t high)
{
    for (unsigned level = 0; level != 2; level++) {
        start(wiring, level_of_it, level != 0);
        rig_run(20 * MS, 1000);
        rig_expect(1, level != 0 ? high : low);
        assert_int_equal(rig.sample.raw, level);
    }
}

TEST(a_normally_closed_contact_that_conducts_is_far)
{
    read_as(CLOSED, 0, FATHOM_FAR, FATHOM_NEAR);
    read_as(CLOSED, HIGH_CONDUCTS, FATHOM_NEAR, FATHOM_FAR);
}

TEST(a_new_level_is_a_sample_of_when_it_was_seen)
{
    start(0, 0, true);
    rig_run(50 * MS, 1000);
    rig_turn(3 * MS);
    rig_run(50 * MS, 1000);
    rig_expect(2, FATHOM_NEAR);
    assert_int_equal(rig.sample.time_us, 1000 + 53 * MS);
    assert_int_equal(rig.sample.distance_mm, 0);
}
