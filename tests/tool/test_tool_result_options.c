/* SPDX-License-Identifier: MIT */
/* --median, --gate, --level and --alarm: what they may say, and what is said of everything else. */
#include "tool_bench.h"

#include <string.h>

#include "cli/rows.h"
#include "output/words.h"

EACH_BEGINS(bench_begin())

static const suite_t suite = {.set_up = begins};

/* ---- what they may say ---- */

/* Stores `text` as the value of --NAME. */
static bool set(const char *name, const char *text, results_config_t *config)
{
    static char copy[2000];
    const option_table_t tables[] = {{result_rows, 0}, {NULL, 0}};
    const origin_t origin = {.command = "read"};
    option_walk_t walk;
    assert_true(option_find(&walk, tables, name));
    (void)snprintf(copy, sizeof copy, "%s", text);
    return option_set(walk.row, copy, config, &origin);
}

#define TANK "mounting=2300,height=2000"
#define POINTS_32                                                                                            \
    "0:0/1:1/2:2/3:3/4:4/5:5/6:6/7:7/8:8/9:9/10:10/11:11/12:12/13:13/14:14/15:15/"                           \
    "16:16/17:17/18:18/19:19/20:20/21:21/22:22/23:23/24:24/25:25/26:26/27:27/28:28/29:29/30:30/31:31"

TEST(a_level_may_be_so)
{
    const struct {
        const char *text;
        fathom_level_config_t tank;
    } rows[] = {
        {TANK ",capacity=5000", {fathom_tank_upright, NULL, 0, 5000, 2300, 2000, 0}},
        {"capacity=1,height=1,mounting=1", {fathom_tank_upright, NULL, 0, 1, 1, 1, 0}},
        {"mounting=65535,height=65535,capacity=4294967295,offset=32767",
         {fathom_tank_upright, NULL, 0, 4294967295u, 65535, 65535, 32767}},
        {TANK ",shape=upright,capacity=5000,offset=-32767",
         {fathom_tank_upright, NULL, 0, 5000, 2300, 2000, -32767}},
        {TANK ",shape=horizontal-cylinder,capacity=5000,offset=0",
         {fathom_tank_horizontal_cylinder, NULL, 0, 5000, 2300, 2000, 0}},
        {TANK ",shape=table,points=0:0/2000:4294967295", {fathom_tank_table, NULL, 2, 0, 2300, 2000, 0}},
        {TANK ",points=65535:70000,shape=table", {fathom_tank_table, NULL, 1, 0, 2300, 2000, 0}},
        {TANK ",shape=table,points=" POINTS_32, {fathom_tank_table, NULL, 32, 0, 2300, 2000, 0}},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        results_config_t config = {0};
        fathom_level_config_t expected = rows[i].tank;
        if (expected.point_count != 0) expected.points = config.points;
        assert_true(set("level", rows[i].text, &config));
        assert_true(config.has_level);
        assert_false(config.has_alarm);
        assert_memory_equal(&config.tank, &expected, sizeof expected);
    }
}

/* What is read in parts was cut to 15 or 31 characters before: 15-20 was 1-20, and 0:1 with 30 zeros in it 0:0. */
TEST(a_number_with_so_many_zeros_that_its_end_is_cut_off_is_refused)
{
    static const char points[] = TANK ",shape=table,points=500:400/00000000001500:4000";
    uint32_t first = 0;
    uint32_t last = 0;
    results_config_t config = {0};
    assert_true(
        range_parse("0000000015-0000000020", 1, 254, &first, &last)); /* ten digits are enough for any */
    assert_int_equal(first, 15);
    assert_int_equal(last, 20);
    assert_false(range_parse("0000000000000015-20", 1, 254, &first, &last));
    assert_false(range_parse("0000000000000015", 0, 254, &first, &last));
    assert_false(number_parse("00000000015", 0, 254, &first));
    assert_false(set("level", points, &config));
    assert_false(set("level", TANK ",shape=table,points=0:000000000000000000000000000000000001", &config));
}

TEST(the_points_of_a_level_are_a_level_and_a_volume)
{
    results_config_t config = {0};
    assert_true(set("level", TANK ",shape=table,points=500:400/1500:4000/2000:5000", &config));
    assert_int_equal(config.points[0].level_mm, 500);
    assert_int_equal(config.points[0].volume, 400);
    assert_int_equal(config.points[2].level_mm, 2000);
    assert_int_equal(config.points[2].volume, 5000);
}

enum { ON = FATHOM_ALARM_ON, OFF = FATHOM_ALARM_OFF };

TEST(an_alarm_may_be_so)
{
    const struct {
        const char *text;
        fathom_alarm_config_t
            alarm; /* on_hold, off_hold, unknown, on, off, when, unknown, no response, no target */
    } rows[] = {
        {"near<500/600,unknown=on,no-response=off", {0, 0, 0, 500, 600, FATHOM_NEAR, ON, OFF, false}},
        {"near<500/500,unknown=off,no-response=on", {0, 0, 0, 500, 500, FATHOM_NEAR, OFF, ON, false}},
        {"near<65535,no-response=on,unknown=on", {0, 0, 0, 65535, 65535, FATHOM_NEAR, ON, ON, false}},
        {"far>2000/1900,unknown=on,no-response=on,no-target=unknown",
         {0, 0, 0, 2000, 1900, FATHOM_FAR, ON, ON, true}},
        {"far>1,unknown=off,no-response=off,no-target=far", {0, 0, 0, 1, 1, FATHOM_FAR, OFF, OFF, false}},
        {"near<5,hold=200,unknown=on,no-response=on", {200000, 200000, 0, 5, 5, FATHOM_NEAR, ON, ON, false}},
        {"near<5,unknown=on,hold=0/2000000,no-response=on,unknown-after=2000000",
         {0, 2000000000u, 2000000000u, 5, 5, FATHOM_NEAR, ON, ON, false}},
        {"near<5,unknown=on,no-response=on,unknown-after=1", {0, 0, 1000, 5, 5, FATHOM_NEAR, ON, ON, false}},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        results_config_t config = {0};
        assert_true(set("alarm", rows[i].text, &config));
        assert_true(config.has_alarm);
        assert_false(config.has_level);
        assert_memory_equal(&config.alarm, &rows[i].alarm, sizeof config.alarm);
    }
}

/* ---- what they may not ---- */

REFUSES(a_median_may_not_be_so, "read a16 --port line",
        {"--median 2", "--median is '2'. It takes a whole number from 3 to 15. See 'fathom read --help'.\n"},
        {"--median 16", "--median is '16'."}, {"--median five", "--median is 'five'."},
        {"--median 3 --gate 0", "--gate is '0'. It takes a whole number from 1 to 65535 mm."},
        {"--median 3 --gate 65536", "--gate is '65536'."},
        {"--median 3 --interval 2000000",
         "--interval is 2000000 ms, but --median knows nothing after 2000000 ms without a reading."})

#define POINTS "--level: points is '"
#define GROW   ". Level and volume grow from point to point, and the full tank has a volume."
#define SHAPE  "--level: shape=table takes points= and no capacity=. The last point is the full tank."

REFUSES(a_level_may_not_be_so, "read a16 --port line --level",
        {"mounting=2300,hight=2000", "--level: unknown key 'hight'. Did you mean height?"},
        {"2300",
         "--level: unknown key '2300'. It is one of mounting, height, capacity, shape, points, offset."},
        {TANK ",capacity=5000,", "--level: unknown key ''"},
        {TANK ",capacity=0", "--level: capacity is '0'. It takes a whole number from 1 to 4294967295."},
        {TANK ",capacity=4294967296", "capacity is '4294967296'"},
        {"height=2000,capacity=5000",
         "--level: mounting is missing. It takes a whole number from 1 to 65535 mm."},
        {"mounting=2300,capacity=5000",
         "--level: height is missing. It takes a whole number from 1 to 65535 mm."},
        {"mounting=0,height=2000,capacity=5000", "--level: mounting is '0'."},
        {"mounting=65536,height=2000,capacity=5000", "mounting is '65536'"},
        {"mounting=2300mm,height=2000,capacity=5000", "mounting is '2300mm'"},
        {TANK, "--level: capacity is missing."},
        {TANK ",capacity=5000,points=500:400", "--level: points= is for shape=table."},
        {TANK ",capacity=5000,shape=round",
         "--level: shape is 'round'. It takes upright, horizontal-cylinder or table."},
        {TANK ",shape=table", SHAPE}, {TANK ",shape=table,points=500:400,capacity=5000", SHAPE},
        {TANK ",shape=table,points=",
         POINTS "'. It takes at most 32 of LEVEL:VOLUME, such as 500:400/1500:4000."},
        {TANK ",shape=table,points=500", POINTS "500'"}, {TANK ",shape=table,points=500:", POINTS "500:'"},
        {TANK ",shape=table,points=500:400/", POINTS "500:400/'"},
        {TANK ",shape=table,points=500:4:5", POINTS "500:4:5'"},
        {TANK ",shape=table,points=65536:1", POINTS "65536:1'"},
        {TANK ",shape=table,points=1:4294967296", POINTS "1:4294967296'"},
        {TANK ",shape=table,points=" POINTS_32 "/32:32", POINTS "0:0/1:1"},
        {TANK ",shape=table,points=500:400/500:500/2000:600", "--level: points is wrong at 500:500" GROW},
        {TANK ",shape=table,points=500:400/600:400/2000:500", "--level: points is wrong at 600:400" GROW},
        {TANK ",shape=table,points=500:400/600:500/2000:499", "--level: points is wrong at 2000:499" GROW},
        {TANK ",shape=table,points=2000:0", "--level: points is wrong at 2000:0" GROW},
        {TANK ",capacity=5000,offset=-32768",
         "--level: offset is '-32768'. It takes a whole number from -32767 to 32767 mm."},
        {TANK ",capacity=5000,offset=32768", "offset is '32768'"},
        {TANK ",capacity=5000,offset=--3", "offset is '--3'"},
        {TANK ",capacity=5000,offset=-", "offset is '-'"})

#define WHEN "--alarm: when is '"
#define SAFE ",unknown=on,no-response=on"
#define SWAP " With near, OFF is the greater distance; with far, the smaller one."

REFUSES(an_alarm_may_not_be_so, "read a16 --port line --alarm",
        {"unknown=on,no-response=on,near<500", "--alarm: unknown key 'near<500'."},
        {"unknown=on,no-response=on", "--alarm: when is missing. It takes near<ON/OFF or far>ON/OFF"},
        {"near>500" SAFE, WHEN "near>500'. It takes near<ON/OFF or far>ON/OFF, from 1 to 65535 mm"},
        {"near" SAFE, WHEN "near'"}, {"near<" SAFE, WHEN "near<'"}, {"near<0" SAFE, WHEN "near<0'"},
        {"near<65536" SAFE, WHEN "near<65536'"}, {"near<500/" SAFE, WHEN "near<500/'"},
        {"near</600" SAFE, WHEN "near</600'"}, {"near<500/600/700" SAFE, WHEN "near<500/600/700'"},
        {"far<500" SAFE, WHEN "far<500'"}, {"far>5m" SAFE, WHEN "far>5m'"},
        {"near<500/499" SAFE,
         "--alarm: the alarm cannot switch off at 499 mm after it is on at 500 mm." SWAP},
        {"far>2000/2001" SAFE, "--alarm: the alarm cannot switch off at 2001 mm"},
        {"near<500", "--alarm: unknown is missing. It takes on or off. no-response is missing too."},
        {"near<500,no-response=on", "--alarm: unknown is missing. It takes on or off."},
        {"near<500,unknown=on", "--alarm: no-response is missing. It takes on or off."},
        {"near<500,unknown=yes,no-response=on", "--alarm: unknown is 'yes'. It takes on or off."},
        {"near<500,holds=1" SAFE, "--alarm: unknown key 'holds'. Did you mean hold?"},
        {"near<500,hold=2000001" SAFE, "--alarm: hold is '2000001'. It takes MS/MS, from 0 to 2000000."},
        {"near<500,hold=1/2000001" SAFE, "hold is '1/2000001'"}, {"near<500,hold=1/" SAFE, "hold is '1/'"},
        {"near<500,unknown-after=0" SAFE,
         "--alarm: unknown-after is '0'. It takes a whole number from 1 to 2000000 ms."},
        {"near<500,unknown-after=2000001" SAFE, "unknown-after is '2000001'"},
        {"near<500,no-target=near" SAFE, "--alarm: no-target is 'near'. It takes far or unknown."},
        {"near<500,unknown-after=1000" SAFE " --interval 1000",
         "--interval is 1000 ms, but --alarm knows nothing after 1000 ms without a reading."},
        {"near<500" SAFE " --interval 2100000", "--alarm knows nothing after 2000000 ms"})

REFUSES(an_option_without_the_one_that_it_needs_has_no_effect, "read a16 --port line",
        {"--until-alarm", "--until-alarm has no effect without --alarm."},
        {"--gate 300", "--gate has no effect without --median."},
        {"--rotate day", "--rotate has no effect without --output."})

/* The longest interval with which they know something: three of them are more than 2000 s. */
TEST(a_long_interval_is_right)
{
    bench_a16((fathom_sim_a16_config_t){0});
    ASSERT_RUN(0,
               "read a16:1:modbus --count 1 --port line --median 3 --interval 1999999 --alarm near<5" SAFE);
}
