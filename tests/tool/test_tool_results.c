/* SPDX-License-Identifier: MIT */
/* What read makes of the readings: the median of each probe, and the level in a tank. */
#include "tool_steps.h"

#include <stdio.h>
#include <string.h>

static int set_up(void **state)
{
    steps_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- the median ---- */

/* Of 1000 1010 990, of 1010 990 1005 and of 990 1005 1002 the middle one; 3000 is more than 300 mm from 1000. */
TEST(a_spike_is_dropped_and_the_median_of_the_others_is_printed)
{
    SEES_A16(1000, 1010, 990, 3000, 1005, 1002);
    const tool_run_t *const run = read_steps("a16:1:modbus", "--count 6 --median 3 --gate 300 --stats");
    assert_int_equal(run->status, 0);
    expect_text(run, "2 a16    1000 mm    1.000 m\n"
                     "4 a16    1005 mm    1.005 m\n"
                     "5 a16    1002 mm    1.002 m\n");
    expect_err(run, "fathom: attempts 6, failed 0, readings 6\n");
    expect_err(run, "fathom: a16:1: spikes dropped 1\n");
}

TEST(the_counters_have_the_spikes_where_there_is_a_median)
{
    SEES_A16(1000, 1000, 1000, 3000, 1000, 3000);
    expect_err(read_steps("a16:1:modbus", "--count 6 --median 3 --gate 300 --stats --format json"),
               ",\"dropped_spikes\":2,");
    SEES_A16(1000);
    assert_null(strstr(read_steps("a16:1:modbus", "--count 1 --stats --format json")->err, "spikes"));
}

TEST(each_probe_of_each_sensor_has_a_median_of_its_own)
{
    SEES_A05({1000, 2000, FATHOM_SIM_NO_TARGET, 500}, {1020, 4000, 3000, 500},
             {1010, 2010, FATHOM_SIM_NO_TARGET, 400});
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *const run = read_steps("a16:1 a05:2", "--count 3 --median 3");
    assert_int_equal(run->status, 0);
    expect_text(run, "2 a16:1    1234 mm    1.234 m\n"
                     "2 a05:2 probe 1    1010 mm    1.010 m\n"
                     "2 a05:2 probe 2    2010 mm    2.010 m\n"
                     "2 a05:2 probe 3  no_target\n"
                     "2 a05:2 probe 4     500 mm    0.500 m\n");
}

TEST(a_fault_is_printed_as_it_came)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    for (int i = 0; i != 4; i++) bench.scene.value[i] = FATHOM_SIM_FAULT;
    expect_text(read_steps("hps167s", "--count 2 --median 5"),
                "0 hps167s  fault: the sensor reports a fault\n"
                "1 hps167s  fault: the sensor reports a fault\n");
}

/* The last sample before it was cut off is that of second 2, the next one that of 9: 7 s are more than 5. */
TEST(after_5_s_without_a_sample_the_median_begins_anew)
{
    SEES_A16(1000, 1000, 1000, 2000);
    steps.off_us = 2800000;
    steps.on_us = 8800000;
    expect_text(read_steps("a16:1:modbus", "--median 3 --duration 12"),
                "2 a16    1000 mm    1.000 m\n11 a16    2000 mm    2.000 m\n");
}

/* Every 3 s: three of them are 9 s. Of 1000 1000 2000 the median is 1000. */
TEST(three_intervals_are_longer_than_5_s)
{
    SEES_A16(1000, 1000, 1000, 1000, 1000, 1000, 1000, 2000);
    steps.off_us = 7000000;
    steps.on_us = 11000000;
    expect_text(
        tool_run(&bench.tool, "read a16:1:modbus --median 3 --interval 3000 --duration 17 --port line"),
        "6 a16    1000 mm    1.000 m\n12 a16    1000 mm    1.000 m\n"
        "15 a16    2000 mm    2.000 m\n");
}

/* ---- the level ---- */

static void expect_level(int32_t distance_mm, const char *keys, const char *level)
{
    char options[256];
    char expected[128] = "0 a16  no_target\n";
    SEES_A16(distance_mm);
    (void)snprintf(options, sizeof options, "--count 1 --level mounting=2300,height=2000,%s", keys);
    if (level != NULL)
        (void)snprintf(expected, sizeof expected, "0 a16  %6d mm  %3d.%03d m  level %s\n", (int)distance_mm,
                       (int)distance_mm / 1000, (int)distance_mm % 1000, level);
    expect_text(read_steps("a16:1:modbus", options), expected);
}

/* 2300 - 500 = 1800 mm, 900 per mille of 2000, 4500 of 5000; 2300 - (499 - 3) = 1804 */
TEST(a_reading_has_the_level_in_an_upright_tank)
{
    expect_level(500, "capacity=5000", "1800 mm  900 per mille  volume 4500");
    expect_level(500, "capacity=5000,shape=upright", "1800 mm  900 per mille  volume 4500");
    expect_level(499, "capacity=5000,offset=-3", "1804 mm  902 per mille  volume 4510");
    expect_level(499, "offset=3,capacity=4000000000", "1798 mm  899 per mille  volume 3596000000");
    expect_level(200, "capacity=5000", "2100 mm  1000 per mille  volume 5000");
    expect_level(2400, "capacity=5000", "-100 mm  0 per mille  volume 0");
    expect_level(FATHOM_SIM_NO_TARGET, "capacity=5000", NULL);
}

/* 1000 mm is half way from 500 to 1500: (400 + 4000) / 2; 250 mm half way from the bottom */
TEST(a_reading_has_the_level_in_a_tank_by_a_table)
{
    const char *const keys = "shape=table,points=500:400/1500:4000/2000:5000";
    expect_level(1300, keys, "1000 mm  500 per mille  volume 2200");
    expect_level(2050, keys, "250 mm  125 per mille  volume 200");
    expect_level(300, keys, "2000 mm  1000 per mille  volume 5000");
}

TEST(the_level_stands_in_json_and_csv_and_is_empty_without_a_distance)
{
    const char *const options = "--count 2 --level mounting=2300,height=2000,capacity=5000 --format";
    char words[128];
    SEES_A16(500, FATHOM_SIM_NO_TARGET);
    (void)snprintf(words, sizeof words, "%s json", options);
    const tool_run_t *run = read_steps("a16:1:modbus", words);
    assert_non_null(
        strstr(run->out, ",\"raw\":500,\"level_mm\":1800,\"level_per_mille\":900,\"volume\":4500}\n"));
    assert_non_null(
        strstr(run->out, ",\"raw\":65533,\"level_mm\":null,\"level_per_mille\":null,\"volume\":null}\n"));
    SEES_A16(500, FATHOM_SIM_NO_TARGET);
    (void)snprintf(words, sizeof words, "%s csv", options);
    run = read_steps("a16:1:modbus", words);
    assert_non_null(strstr(run->out, ",distance_mm,raw,level_mm,level_per_mille,volume\n"));
    assert_non_null(strstr(run->out, ",500,500,1800,900,4500\n"));
    assert_non_null(strstr(run->out, ",,65533,,,\n"));
}

/* Of 1000 500 600 it is 600: 2300 - 600 = 1700 mm. */
TEST(the_median_stands_before_the_level)
{
    SEES_A16(1000, 500, 600);
    expect_text(
        read_steps("a16:1:modbus", "--count 3 --median 3 --level mounting=2300,height=2000,capacity=5000"),
        "2 a16     600 mm    0.600 m  level 1700 mm  850 per mille  volume 4250\n");
}
