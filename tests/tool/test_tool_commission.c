/* SPDX-License-Identifier: MIT */
/* Wherever fathom commission is interrupted, no two sensors have the same address, the record shows where each is, and
 * every write was announced. */
#include "commission_bench.h"

#include <string.h>

static const suite_t suite = {.set_up = site_set_up, .tear_down = site_tear_down};

/* The units have the addresses from 2 on; the last one has the termination; each write was made once. */
static void expect_all_hps(size_t count)
{
    for (size_t i = 0; i != count; i++) {
        const fathom_sim_hps167s_t *const hps = &site.unit[i].hps;
        assert_int_equal(hps->device.address, i + 2);
        assert_int_equal(hps->termination, i + 1 == count);
        assert_int_equal(hps->device.counters.flash_writes, i + 1 == count ? 1 : 2);
    }
}

/* ---- all goes well ---- */

TEST(eight_units_from_the_factory_get_the_addresses_from_2_to_9)
{
    add_hps_units(8);
    const tool_run_t *const done = commission("hps167s --addresses 2-9");
    expect(done, 0, "8 of 8 addresses are assigned and verified\n");
    expect_all_hps(8);
    assert_true(site.asked_us[0] > SECOND); /* what came late of a run before has been heard */
    assert_int_equal(site.announced, 15);   /* an address each, and the termination of seven */
    expect(done, 0,
           "hps167s at address 1, UUID " FIRST ": gets address 2\n"
           "  writes termination off (#11)\n"
           "  writes address 2 (#8)\n"
           "  address 2 is done: termination off from the next power-on, 1234 mm\n");
    expect(done, 0, "  writes address 9 (#8)\n  address 9 is done: termination on, 1234 mm\n");
    /* tool_run's clock begins on 2025-11-24 at 16:00 */
    assert_int_equal(strncmp(record_text(), TITLE, strlen(TITLE)), 0);
    assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " done 2025-11-24T16:00:"));
    assert_int_equal(count_of(record_text(), " done "), 8);
}

TEST(a_second_run_writes_nothing)
{
    add_hps_units(2);
    expect(commission("hps167s --addresses 2,3"), 0, "2 of 2");
    expect(commission("hps167s --addresses 2,3"), 0, "2 of 2");
    expect_all_hps(2);
}

TEST(only_the_terminated_address_keeps_its_termination)
{
    add_hps_units(3);
    expect(commission("hps167s --addresses 2-4 --terminated 3"), 0, "3 of 3");
    assert_false(site.unit[0].hps.termination);
    assert_true(site.unit[1].hps.termination);
    assert_false(site.unit[2].hps.termination);
}

TEST(the_last_sensor_may_keep_address_1)
{
    add_hps_units(2);
    expect(commission("hps167s --addresses 7,1 --terminated none"), 0, "2 of 2");
    assert_int_equal(site.device[0]->address, 7);
    assert_int_equal(site.device[1]->address, 1);
    assert_false(site.unit[1].hps.termination);
    assert_int_equal(site.device[1]->counters.flash_writes, 1);
}

TEST(a_value_that_the_sensor_already_has_is_not_written)
{
    add_hps((fathom_sim_hps167s_config_t){.no_termination = true});
    add_hps((fathom_sim_hps167s_config_t){.no_termination = true});
    connect_next();
    expect(commission("hps167s --addresses 2,3"), 0,
           "  writes termination on (#11)\n  writes address 3 (#8)\n");
    assert_int_equal(site.device[0]->counters.flash_writes, 1);
    assert_int_equal(site.device[1]->counters.flash_writes, 2);
}

TEST(sensors_that_send_unsolicited_frames_are_commissioned)
{
    static const uint32_t unasked_us[] = {18500, 26419, 34338, 50176, 66014, 100000, 152000, 192718};
    for (size_t i = 0; i != sizeof unasked_us / sizeof unasked_us[0]; i++) {
        site_begin();
        add_hps((fathom_sim_hps167s_config_t){.unasked_us = unasked_us[i]});
        connect_next();
        expect(commission("hps167s --addresses 2 --wait 60"), 0, "1 of 1");
        assert_int_equal(site.device[0]->address, 2);
    }
}

TEST(json_has_an_object_for_each_sensor)
{
    add_hps_units(1);
    const tool_run_t *const done = commission("hps167s --addresses 2 --format json");
    assert_int_equal(done->status, 0);
    assert_int_equal(strncmp(done->out,
                             "{\"model\":\"hps167s\",\"address\":2,\"uuid\":\"" FIRST "\","
                             "\"termination\":true,\"distance_mm\":1234,\"status\":\"done\","
                             "\"utc\":\"2025-11-24T16:00:",
                             148),
                     0);
    assert_int_equal(count_of(done->out, "\n"), 1);
    assert_non_null(strstr(done->err, "  writes address 2 (#8)\n"));
}

/* ---- interrupted and resumed ---- */

/* What two units are to have come to. */
typedef struct {
    void (*add)(size_t count);
    const char *more;
    uint8_t addresses[2];
    uint8_t writes[2];
} pair_t;

/* The first run is ended so long after its begin. False: it was done before. */
static bool is_ended_after(const pair_t *pair, uint64_t us)
{
    site_begin();
    pair->add(2);
    bench.tool.ctrl_c_us = us;
    const bool is_done = commission(pair->more)->status == 0;
    bench.tool.ctrl_c_us = 0;
    expect(commission(pair->more), 0, "2 of 2 addresses");
    for (size_t i = 0; i != 2; i++) {
        assert_int_equal(site.device[i]->address, pair->addresses[i]);
        assert_int_equal(site.device[i]->counters.writes, pair->writes[i]);
    }
    return !is_done;
}

/* Every 200 ms; and with each request of a run that is not ended: as it leaves, in its middle, while the device works
 * on it, in the middle of the response (of 8 bytes: 4.6 ms at 19200 8E1, 8.3 ms at 9600 8N1) and behind it. */
static void end_at_any_moment(void **state)
{
    static const uint32_t after_us[] = {0, 3 * MS, 6 * MS, 10 * MS, 16 * MS, 25 * MS};
    const pair_t *const pair = *state;
    static uint32_t asked_us[MOMENTS];
    uint64_t us = 0;
    site_begin();
    pair->add(2);
    expect(commission(pair->more), 0, "2 of 2 addresses");
    const size_t count = site.asked;
    assert_in_range(count, 20, MOMENTS - 1);
    memcpy(asked_us, site.asked_us, sizeof asked_us);
    while (is_ended_after(pair, us += 200 * MS)) {
    }
    assert_in_range(us, 5 * SECOND, 30 * SECOND);
    for (size_t i = 0; i != count; i++)
        for (size_t j = 0; j != sizeof after_us / sizeof after_us[0]; j++)
            assert_true(is_ended_after(pair, asked_us[i] + after_us[j]));
}

#define ENDED(name, ...)                                                                                     \
    static const pair_t pair_##name = {__VA_ARGS__};                                                         \
    TEST_ROW(interrupted_at_any_moment_it_resumes_with_##name, end_at_any_moment, &pair_##name)

ENDED(an_hps167s, add_hps_units, "hps167s --addresses 2,3 --wait 60", {2, 3}, {2, 1})
ENDED(an_a16, add_a16_units, "a16 --addresses 2,3 --wait 60", {2, 3}, {1, 1})
ENDED(an_a05_that_keeps_address_1, add_a05_units, "a05 --addresses 9,1 --wait 60", {9, 1}, {1, 0})

TEST(interrupted_again_and_again_it_finishes)
{
    for (uint64_t step = 0; step != 20; step++) {
        unsigned runs = 1;
        site_begin();
        add_hps_units(8);
        bench.tool.ctrl_c_us = 10 * SECOND + step * 97 * MS; /* to take up one unit takes less */
        while (commission("hps167s --addresses 2-9")->status != 0) assert_true(++runs < 40);
        assert_in_range(runs, 3, 40);
        expect_all_hps(8);
    }
}
