/* SPDX-License-Identifier: MIT */
/* read --alarm: the changes of each probe's alarm, and the exit status of read --until-alarm. */
#include "tool_steps.h"

#include <stdio.h>
#include <string.h>

static int set_up(void **state)
{
    steps_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

#define SAFE ",unknown=on,no-response=on"

/* No A16 and no A05 measures that far: the value is refused. */
enum { REFUSED_A16 = 40000, REFUSED_A05 = 7000 };

static const tool_run_t *alarm_of(const char *sensors, const char *alarm, const char *options)
{
    char words[256];
    (void)snprintf(words, sizeof words, "--alarm %s %s", alarm, options);
    return read_steps(sensors, words);
}

/* ---- thresholds ---- */

/* 550 and 600 are neither nearer than 500 nor farther than 600. */
TEST(near_goes_on_and_off_at_thresholds_of_its_own)
{
    SEES_A16(700, 550, 499, 550, 600, 601, 600, 500);
    const tool_run_t *const run = alarm_of("a16:1:modbus", "near<500/600" SAFE, "--count 8 --stats");
    assert_int_equal(run->status, 0);
    expect_text(run, "0 a16: alarm off, 700 mm\n2 a16: alarm on, 499 mm\n5 a16: alarm off, 601 mm\n");
    expect_err(run, "fathom: attempts 8, failed 0, readings 8\n");
}

/* alarm.h: between the thresholds, and nothing before: as the user says of "unknown" */
TEST(a_first_distance_between_the_thresholds_is_as_unknown)
{
    SEES_A16(550);
    expect_text(alarm_of("a16:1:modbus", "near<500/600,unknown=on,no-response=off", "--count 2"),
                "0 a16: alarm on, 550 mm\n");
    SEES_A16(550);
    expect_text(alarm_of("a16:1:modbus", "near<500/600,no-response=on,unknown=off", "--count 2"),
                "0 a16: alarm off, 550 mm\n");
}

TEST(no_target_is_far_or_unknown)
{
    SEES_A16(400, FATHOM_SIM_NO_TARGET);
    expect_text(alarm_of("a16:1:modbus", "near<500" SAFE, "--count 8"),
                "0 a16: alarm on, 400 mm\n1 a16: alarm off, no_target\n");
    SEES_A16(400, FATHOM_SIM_NO_TARGET);
    expect_text(alarm_of("a16:1:modbus", "far>2000" SAFE, "--count 8"),
                "0 a16: alarm off, 400 mm\n1 a16: alarm on, no_target\n");
    SEES_A16(400, FATHOM_SIM_NO_TARGET); /* 5 s after the distance of second 0 */
    expect_text(
        alarm_of("a16:1:modbus", "near<500,unknown=off,no-response=on,no-target=unknown", "--count 8"),
        "0 a16: alarm on, 400 mm\n5 a16: alarm unknown (off)\n");
}

/* Of 700 700 700 it is 700, of 700 700 400 too, of 700 400 400 it is 400. */
TEST(the_median_stands_before_the_alarm)
{
    SEES_A16(700, 700, 700, 400, 400);
    expect_text(alarm_of("a16:1:modbus", "near<500" SAFE, "--median 3 --count 5"),
                "2 a16: alarm off, 700 mm\n4 a16: alarm on, 400 mm\n");
}

/* ---- no distance ---- */

/* An A16 responds in 0.5 s: the last sample is of 3.5 s. It is asked again at 4, 6 and 8 s: a time-out is 1 s, and for as
 * long again its response may still come. */
TEST(a_device_that_does_not_respond_is_a_state_of_its_own)
{
    SEES_A16(700);
    steps.off_us = 3800000;
    steps.on_us = 7500000;
    const tool_run_t *run =
        alarm_of("a16:1:modbus", "near<500,unknown-after=2000,no-response=on,unknown=off", "--count 10");
    assert_int_equal(run->status, 1);
    expect_text(run, "0 a16: alarm off, 700 mm\n5 a16: alarm no_response (on)\n8 a16: alarm off, 700 mm\n");
    expect_err(run, "no byte was received");
    SEES_A16(700);
    steps.off_us = 3800000;
    run = alarm_of("a16:1:modbus", "near<500,unknown-after=2000,no-response=off,unknown=on", "--count 7");
    expect_text(run, "0 a16: alarm off, 700 mm\n5 a16: alarm no_response (off)\n");
}

TEST(a_device_that_tells_no_distance_is_another_one)
{
    SEES_A16(700, REFUSED_A16);
    expect_text(
        alarm_of("a16:1:modbus", "near<500,unknown-after=2500,no-response=off,unknown=on", "--count 5"),
        "0 a16: alarm off, 700 mm\n2 a16: alarm unknown (on)\n");
}

/* The time alone tells it, 5 s after the last frame; the reader gives up 10 s after it, as --timeout says. */
TEST(a_sensor_that_sends_nothing_any_more_is_noticed_by_the_time)
{
    const int32_t sees = 700;
    steps_a16(FATHOM_SIM_A16_AUTO, &sees, 1);
    steps.off_us = 3500000;
    expect_text(alarm_of("a16", "near<500,unknown=on,no-response=off", "--duration 15 --timeout 10000"),
                "0 a16: alarm off, 700 mm\n8 a16: alarm unknown (on)\n13 a16: alarm no_response (off)\n");
}

TEST(the_first_state_is_told_when_nothing_has_come_for_that_time)
{
    expect_text(alarm_of("a16:1:modbus", "near<500" SAFE, "--count 8"), "5 a16: alarm no_response (on)\n");
    SEES_A16(REFUSED_A16);
    expect_text(alarm_of("a16:1:modbus", "near<500,unknown=off,no-response=on", "--count 8"),
                "5 a16: alarm unknown (off)\n");
    bench_begin(); /* three intervals */
    expect_text(
        tool_run(&bench.tool, "read hps167s --interval 3000 --count 5 --port line --alarm far>500" SAFE),
        "9 hps167s: alarm no_response (on)\n");
    bench_begin();
    for (int i = 0; i != 4; i++) bench.scene.value[i] = FATHOM_SIM_FAULT;
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    expect_text(alarm_of("hps167s", "near<500" SAFE, "--count 8"), "5 hps167s: alarm unknown (on)\n");
}

/* Of 15 there is none in 8 s, but the device responds. */
TEST(a_sample_without_a_median_is_a_response)
{
    SEES_A16(700);
    expect_text(alarm_of("a16:1:modbus", "near<500,unknown=on,no-response=off", "--median 15 --count 8"),
                "5 a16: alarm unknown (on)\n");
}

/* Nothing else happens before the reader gives up after 60 s. */
TEST(the_time_is_looked_at_when_nothing_happens)
{
    bench.tool.idle = fathom_sim_clock_idle;
    expect_text(alarm_of("a16", "near<500" SAFE, "--timeout 60000 --duration 20"),
                "5 a16: alarm no_response (on)\n");
}

/* ---- several ---- */

/* The A16 takes 0.5 s, then the A05 0.4 s: the last distance of probe 4 is of 1.9 s, and 1.5 s later it is 3.4 s. */
TEST(each_probe_has_an_alarm_of_its_own)
{
    SEES_A05({480, 2000, FATHOM_SIM_NO_TARGET, 700}, {480, 450, FATHOM_SIM_NO_TARGET, 700},
             {480, 450, 100, REFUSED_A05}, {610, 450, 100, REFUSED_A05});
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    expect_text(alarm_of("a16:1 a05:2", "near<500/600,unknown-after=1500" SAFE, "--count 5"),
                "0 a16:1: alarm off, 1234 mm\n"
                "0 a05:2 probe 1: alarm on, 480 mm\n"
                "0 a05:2 probe 2: alarm off, 2000 mm\n"
                "0 a05:2 probe 3: alarm off, no_target\n"
                "0 a05:2 probe 4: alarm off, 700 mm\n"
                "1 a05:2 probe 2: alarm on, 450 mm\n"
                "2 a05:2 probe 3: alarm on, 100 mm\n"
                "3 a05:2 probe 4: alarm unknown (on)\n"
                "3 a05:2 probe 1: alarm off, 610 mm\n");
}

TEST(probes_that_are_left_out_have_none)
{
    expect_text(alarm_of("a05:2:modbus", "near<500" SAFE, "--probes 2,4 --count 8"),
                "5 a05 probe 2: alarm no_response (on)\n5 a05 probe 4: alarm no_response (on)\n");
}

/* The first one is done at 2.5 s; the second one is not there, and at 7.5 s it is still waited for. */
TEST(a_sensor_that_has_been_read_often_enough_goes_into_no_other_state)
{
    SEES_A16(700);
    const tool_run_t *const run =
        tool_run(&bench.tool, "read a16:1 a05:2 --timeout 4000 --count 3 --port line --alarm near<500" SAFE);
    assert_in_range(run->took_us, 8000000, 24000000);
    expect_text(run, "0 a16:1: alarm off, 700 mm\n"
                     "5 a05:2 probe 1: alarm no_response (on)\n5 a05:2 probe 2: alarm no_response (on)\n"
                     "5 a05:2 probe 3: alarm no_response (on)\n5 a05:2 probe 4: alarm no_response (on)\n");
}

/* ---- formats ---- */

/* Without their times. */
static void expect_objects(const tool_run_t *run, const char *expected)
{
    char got[1024] = "";
    const char *from = run->out;
    for (const char *time = strstr(from, "\"time_us\""); time != NULL; time = strstr(from, "\"time_us\"")) {
        strncat(got, from, (size_t)(time - from));
        from = strstr(time, "\"alarm\"");
    }
    strcat(got, from);
    assert_string_equal(got, expected);
}

TEST(a_change_is_an_object)
{
    SEES_A05({480, REFUSED_A05, FATHOM_SIM_NO_TARGET, 700});
    expect_objects(alarm_of("a05:2:modbus", "near<500,unknown-after=1500,unknown=off,no-response=on",
                            "--probes 1,2,3 --count 3 --format json"),
                   "{\"name\":\"a05:2\",\"model\":\"a05\",\"mode\":\"modbus\",\"address\":2,\"probe\":1,"
                   "\"alarm\":\"on\",\"is_on\":true,\"distance_mm\":480}\n"
                   "{\"name\":\"a05:2\",\"model\":\"a05\",\"mode\":\"modbus\",\"address\":2,\"probe\":3,"
                   "\"alarm\":\"off\",\"is_on\":false,\"distance_mm\":null}\n"
                   "{\"name\":\"a05:2\",\"model\":\"a05\",\"mode\":\"modbus\",\"address\":2,\"probe\":2,"
                   "\"alarm\":\"unknown\",\"is_on\":false,\"distance_mm\":null}\n");
    (void)set_up(NULL);
    expect_objects(alarm_of("a16:1:modbus", "near<500" SAFE, "--count 7 --format json"),
                   "{\"name\":\"a16:1\",\"model\":\"a16\",\"mode\":\"modbus\",\"address\":1,\"probe\":1,"
                   "\"alarm\":\"no_response\",\"is_on\":true,\"distance_mm\":null}\n");
}

/* 2300 - 480 = 1820 mm, 910 per mille */
TEST(a_change_is_a_row_of_csv_and_may_have_a_level)
{
    SEES_A16(480);
    const tool_run_t *const run =
        alarm_of("a16:1:modbus", "near<500" SAFE,
                 "--level mounting=2300,height=2000,capacity=1000 --count 2 --format csv");
    const char *const header = "name,model,mode,address,probe,time_us,utc,alarm,is_on,distance_mm,level_mm,"
                               "level_per_mille,volume\n"
                               "a16:1,a16,modbus,1,1,";
    assert_memory_equal(run->out, header, strlen(header));
    assert_non_null(strstr(run->out, "Z,on,true,480,1820,910,910\n"));
    SEES_A16(480);
    expect_text(alarm_of("a16:1:modbus", "near<500" SAFE,
                         "--level mounting=2300,height=2000,capacity=1000 --count 2"),
                "0 a16: alarm on, 480 mm  level 1820 mm  910 per mille  volume 910\n");
}

/* ---- the exit status ---- */

TEST(until_alarm_ends_with_3_when_one_is_on)
{
    SEES_A16(700, 700, 700, 400, 700);
    const tool_run_t *run = alarm_of("a16:1:modbus", "near<500" SAFE, "--until-alarm");
    assert_int_equal(run->status, 3);
    expect_text(run, "0 a16: alarm off, 700 mm\n3 a16: alarm on, 400 mm\n");
    assert_in_range(run->took_us, 3500000, 3600000);
    SEES_A16(400); /* from the beginning */
    run = alarm_of("a16:1:modbus", "near<500" SAFE, "--until-alarm");
    assert_int_equal(run->status, 3);
    expect_text(run, "0 a16: alarm on, 400 mm\n");
    (void)set_up(NULL); /* nothing is there: the attempts of 0 and 2 s have failed, that of 4 s not yet */
    run = alarm_of("a16:1:modbus", "near<500" SAFE, "--until-alarm --stats");
    assert_int_equal(run->status, 3);
    assert_in_range(run->took_us, 5000000, 5200000);
    expect_err(run, "fathom: attempts 2, failed 2, readings 0\n");
}

TEST(without_until_alarm_an_alarm_is_no_exit_status)
{
    SEES_A16(400);
    assert_int_equal(alarm_of("a16:1:modbus", "near<500" SAFE, "--count 3")->status, 0);
}

TEST(an_alarm_that_was_on_is_not_kept_for_the_next_run)
{
    SEES_A16(400);
    assert_int_equal(alarm_of("a16:1:modbus", "near<500" SAFE, "--until-alarm")->status, 3);
    SEES_A16(700);
    assert_int_equal(alarm_of("a16:1:modbus", "near<500" SAFE, "--until-alarm --count 2")->status, 0);
    SEES_A16(400);
    expect_text(read_steps("a16:1:modbus", "--count 1"), "0 a16     400 mm    0.400 m\n");
}
