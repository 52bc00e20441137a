/* SPDX-License-Identifier: MIT */
/* What read makes of the readings: the median of each probe, the level in a tank, and the changes of an alarm. */
#include "tool_steps.h"

#include <stdio.h>
#include <string.h>

static int set_up(void **state)
{
    steps_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

typedef struct {
    int status;
    const char *sees;
    const char *words;
    const char *out;
} row_t;

static const tool_run_t *run_row(const row_t *row)
{
    steps_see(row->sees, row->words);
    const tool_run_t *const run = read_steps(row->words);
    expect_text(run, row->out);
    if (run->status != row->status) fail_msg("%s: exit status %d\n%s", row->words, run->status, run->err);
    return run;
}

#define TEST_ROWS(name, ...)                                                                                 \
    TEST(name)                                                                                               \
    {                                                                                                        \
        static const row_t rows[] = {__VA_ARGS__};                                                           \
        for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) (void)run_row(&rows[i]);                  \
    }

/* ---- the median ---- */

TEST_ROWS(
    a_median_is_of_each_probe_and_begins_anew_after_5_s_without_a_sample,
    {0, "1000,2000,none,500 1020,4000,3000,500 1010,2010,none,400", "a16:1 a05:2 --count 3 --median 3",
     "2 a16:1    1234 mm    1.234 m\n2 a05:2 probe 1    1010 mm    1.010 m\n"
     "2 a05:2 probe 2    2010 mm    2.010 m\n2 a05:2 probe 3  no_target\n"
     "2 a05:2 probe 4     500 mm    0.500 m\n"},
    {0, "fault", "hps167s --count 2 --median 5",
     "0 hps167s  fault: the sensor reports a fault\n1 hps167s  fault: the sensor reports a fault\n"},
    /* The last sample before it was cut off is that of second 2, the next one that of 9: 7 s are more than 5. */
    {1, "1000 1000 1000 2000 @2800-8800", "a16:1:modbus --median 3 --duration 12",
     "2 a16    1000 mm    1.000 m\n11 a16    2000 mm    2.000 m\n"},
    /* Every 3 s: three of them are 9 s. Of 1000 1000 2000 the median is 1000. */
    {1, "1000 1000 1000 1000 1000 1000 1000 2000 @7000-11000",
     "a16:1:modbus --median 3 --interval 3000 --duration 17",
     "6 a16    1000 mm    1.000 m\n12 a16    1000 mm    1.000 m\n15 a16    2000 mm    2.000 m\n"})

/* Of 1000 1010 990, of 1010 990 1005 and of 990 1005 1002 the middle one; 3000 is more than 300 mm from 1000. */
TEST(a_spike_is_dropped_and_counted)
{
    const char *const words = "a16:1:modbus --count 6 --median 3 --gate 300 --stats";
    const tool_run_t *run = run_row(&(row_t){0, "1000 1010 990 3000 1005 1002", words,
                                             "2 a16    1000 mm    1.000 m\n4 a16    1005 mm    1.005 m\n"
                                             "5 a16    1002 mm    1.002 m\n"});
    expect_err(run, "fathom: attempts 6, failed 0, readings 6\n");
    expect_err(run, "fathom: a16:1: spikes dropped 1\n");
    steps_see("1000 1000 1000 3000 1000 3000", words);
    expect_err(read_steps("a16:1:modbus --count 6 --median 3 --gate 300 --stats --format json"),
               ",\"dropped_spikes\":2,");
    steps_see("1000", words);
    run = read_steps("a16:1:modbus --count 1 --stats --format json");
    assert_null(strstr(run->err, "spikes"));
}

/* ---- the level ---- */

#define LEVEL(keys) "a16:1:modbus --count 1 --level mounting=2300,height=2000," keys

/* 2300 - 500 = 1800 mm, 900 per mille of 2000, 4500 of 5000; 2300 - (499 - 3) = 1804 */
TEST_ROWS(a_reading_has_the_level_in_an_upright_tank,
          {0, "500", LEVEL("capacity=5000"),
           "0 a16     500 mm    0.500 m  level 1800 mm  900 per mille  volume 4500\n"},
          {0, "500", LEVEL("capacity=5000,shape=upright"),
           "0 a16     500 mm    0.500 m  level 1800 mm  900 per mille  volume 4500\n"},
          {0, "499", LEVEL("capacity=5000,offset=-3"),
           "0 a16     499 mm    0.499 m  level 1804 mm  902 per mille  volume 4510\n"},
          {0, "499", LEVEL("offset=3,capacity=4000000000"),
           "0 a16     499 mm    0.499 m  level 1798 mm  899 per mille  volume 3596000000\n"},
          {0, "200", LEVEL("capacity=5000"),
           "0 a16     200 mm    0.200 m  level 2100 mm  1000 per mille  volume 5000\n"},
          {0, "2400", LEVEL("capacity=5000"),
           "0 a16    2400 mm    2.400 m  level -100 mm  0 per mille  volume 0\n"},
          {0, "none", LEVEL("capacity=5000"), "0 a16  no_target\n"},
          /* Of 1000 500 600 it is 600: 2300 - 600 = 1700 mm. */
          {0, "1000 500 600",
           "a16:1:modbus --count 3 --median 3 --level mounting=2300,height=2000,capacity=5000",
           "2 a16     600 mm    0.600 m  level 1700 mm  850 per mille  volume 4250\n"})

/* 1000 mm is half way from 500 to 1500: (400 + 4000) / 2; 250 mm half way from the bottom */
#define TABLE LEVEL("shape=table,points=500:400/1500:4000/2000:5000")
TEST_ROWS(a_reading_has_the_level_in_a_tank_by_a_table,
          {0, "1300", TABLE, "0 a16    1300 mm    1.300 m  level 1000 mm  500 per mille  volume 2200\n"},
          {0, "2050", TABLE, "0 a16    2050 mm    2.050 m  level 250 mm  125 per mille  volume 200\n"},
          {0, "300", TABLE, "0 a16     300 mm    0.300 m  level 2000 mm  1000 per mille  volume 5000\n"})

TEST(the_level_stands_in_json_and_csv_and_is_empty_without_a_distance)
{
    const char *const words =
        "a16:1:modbus --count 2 --level mounting=2300,height=2000,capacity=5000 --format json";
    steps_see("500 none", words);
    const tool_run_t *run = read_steps(words);
    assert_non_null(
        strstr(run->out, ",\"raw\":500,\"level_mm\":1800,\"level_per_mille\":900,\"volume\":4500}\n"));
    assert_non_null(
        strstr(run->out, ",\"raw\":65533,\"level_mm\":null,\"level_per_mille\":null,\"volume\":null}\n"));
    steps_see("500 none", words);
    run = read_steps("a16:1:modbus --count 2 --level mounting=2300,height=2000,capacity=5000 --format csv");
    assert_non_null(strstr(run->out, ",distance_mm,raw,level_mm,level_per_mille,volume\n"));
    assert_non_null(strstr(run->out, ",500,500,1800,900,4500\n"));
    assert_non_null(strstr(run->out, ",,65533,,,\n"));
}

/* ---- alarms ---- */

#define SAFE ",unknown=on,no-response=on"
#define A16  "a16:1:modbus --alarm "

TEST_ROWS(near_and_far_have_thresholds_of_their_own,
          /* 550 and 600 are neither nearer than 500 nor farther than 600. */
          {0, "700 550 499 550 600 601 600 500", A16 "near<500/600" SAFE " --count 8",
           "0 a16: alarm off, 700 mm\n2 a16: alarm on, 499 mm\n5 a16: alarm off, 601 mm\n"},
          /* alarm.h: between the thresholds, and nothing before: as the user says of "unknown" */
          {0, "550", A16 "near<500/600,unknown=on,no-response=off --count 2", "0 a16: alarm on, 550 mm\n"},
          {0, "550", A16 "near<500/600,no-response=on,unknown=off --count 2", "0 a16: alarm off, 550 mm\n"},
          {0, "400 none", A16 "near<500" SAFE " --count 8",
           "0 a16: alarm on, 400 mm\n1 a16: alarm off, no_target\n"},
          {0, "400 none", A16 "far>2000" SAFE " --count 8",
           "0 a16: alarm off, 400 mm\n1 a16: alarm on, no_target\n"},
          /* 5 s after the distance of second 0 */
          {0, "400 none", A16 "near<500,unknown=off,no-response=on,no-target=unknown --count 8",
           "0 a16: alarm on, 400 mm\n5 a16: alarm unknown (off)\n"},
          /* Of 700 700 700 it is 700, of 700 700 400 too, of 700 400 400 it is 400. */
          {0, "700 700 700 400 400", A16 "near<500" SAFE " --median 3 --count 5",
           "2 a16: alarm off, 700 mm\n4 a16: alarm on, 400 mm\n"})

TEST_ROWS(
    no_response_and_no_distance_are_states_of_their_own,
    /* An A16 responds in 0.5 s: the last sample is of 3.5 s. It is asked again at 4, 6 and 8 s: a time-out is 1 s, and for
     * as long again its response may still come. */
    {1, "700 @3800-7500", A16 "near<500,unknown-after=2000,no-response=on,unknown=off --count 10",
     "0 a16: alarm off, 700 mm\n5 a16: alarm no_response (on)\n8 a16: alarm off, 700 mm\n"},
    {1, "700 @3800-0", A16 "near<500,unknown-after=2000,no-response=off,unknown=on --count 7",
     "0 a16: alarm off, 700 mm\n5 a16: alarm no_response (off)\n"},
    /* No A16 measures that far: the value is refused. */
    {1, "700 40000", A16 "near<500,unknown-after=2500,no-response=off,unknown=on --count 5",
     "0 a16: alarm off, 700 mm\n2 a16: alarm unknown (on)\n"},
    /* The time alone tells it, 5 s after the last frame; the reader gives up 10 s after it, as --timeout says. */
    {1, "700 @3500-0", "a16 --alarm near<500,unknown=on,no-response=off --duration 15 --timeout 10000",
     "0 a16: alarm off, 700 mm\n8 a16: alarm unknown (on)\n13 a16: alarm no_response (off)\n"},
    /* Nothing came for that time. */
    {1, "", A16 "near<500" SAFE " --count 8", "5 a16: alarm no_response (on)\n"},
    {1, "40000", A16 "near<500,unknown=off,no-response=on --count 8", "5 a16: alarm unknown (off)\n"},
    {1, "", "hps167s --interval 3000 --count 5 --alarm far>500" SAFE,
     "9 hps167s: alarm no_response (on)\n"}, /* three intervals */
    {0, "fault", "hps167s --alarm near<500" SAFE " --count 8", "5 hps167s: alarm unknown (on)\n"},
    /* A sample without a median is a response: of 15 there is none in 8 s. */
    {0, "700", A16 "near<500,unknown=on,no-response=off --median 15 --count 8",
     "5 a16: alarm unknown (on)\n"})

/* The A16 takes 0.5 s, then the A05 0.4 s: the last distance of probe 4 is of 1.9 s, and 1.5 s later it is 3.4 s. No A05
 * measures 7000 mm. */
TEST_ROWS(each_probe_has_an_alarm_of_its_own,
          {1, "480,2000,none,700 480,450,none,700 480,450,100,7000 610,450,100,7000",
           "a16:1 a05:2 --alarm near<500/600,unknown-after=1500" SAFE " --count 5",
           "0 a16:1: alarm off, 1234 mm\n"
           "0 a05:2 probe 1: alarm on, 480 mm\n"
           "0 a05:2 probe 2: alarm off, 2000 mm\n"
           "0 a05:2 probe 3: alarm off, no_target\n"
           "0 a05:2 probe 4: alarm off, 700 mm\n"
           "1 a05:2 probe 2: alarm on, 450 mm\n"
           "2 a05:2 probe 3: alarm on, 100 mm\n"
           "3 a05:2 probe 4: alarm unknown (on)\n"
           "3 a05:2 probe 1: alarm off, 610 mm\n"},
          {1, "", "a05:2:modbus --alarm near<500" SAFE " --probes 2,4 --count 8",
           "5 a05 probe 2: alarm no_response (on)\n5 a05 probe 4: alarm no_response (on)\n"})

/* Nothing else happens before the reader gives up after 60 s. */
TEST(the_time_is_looked_at_when_nothing_happens)
{
    bench.tool.idle = fathom_sim_clock_idle;
    expect_text(read_steps("a16 --alarm near<500" SAFE " --timeout 60000 --duration 20"),
                "5 a16: alarm no_response (on)\n");
}

/* The first one is done at 2.5 s; the second one is not there, and at 7.5 s it is still waited for. */
TEST(a_sensor_that_has_been_read_often_enough_goes_into_no_other_state)
{
    steps_see("700", "a16:1");
    const tool_run_t *const run =
        tool_run(&bench.tool, "read a16:1 a05:2 --timeout 4000 --count 3 --port line --alarm near<500" SAFE);
    assert_in_range(run->took_us, 8000000, 24000000);
    expect_text(run, "0 a16:1: alarm off, 700 mm\n"
                     "5 a05:2 probe 1: alarm no_response (on)\n5 a05:2 probe 2: alarm no_response (on)\n"
                     "5 a05:2 probe 3: alarm no_response (on)\n5 a05:2 probe 4: alarm no_response (on)\n");
}

/* 2300 - 480 = 1820 mm, 910 per mille */
TEST(a_change_is_an_object_or_a_row_and_may_have_a_level)
{
    const char *const words = "a05:2:modbus --alarm near<500,unknown-after=1500,unknown=off,no-response=on "
                              "--probes 1,2,3 --count 3 --format json";
    static const char *const changes[] = {"\"alarm\":\"on\",\"is_on\":true,\"distance_mm\":480}\n{",
                                          "\"alarm\":\"off\",\"is_on\":false,\"distance_mm\":null}\n{",
                                          "\"alarm\":\"unknown\",\"is_on\":false,\"distance_mm\":null}\n"};
    static const char *const probes[] = {"\"probe\":1,\"time_us\"", "\"probe\":3,\"time_us\"",
                                         "\"probe\":2,\"time_us\""};
    static const char level[] = "a16:1:modbus --alarm near<500" SAFE
                                " --level mounting=2300,height=2000,capacity=1000 --count 2 --format csv";
    steps_see("480,7000,none,700", words);
    const char *at = read_steps(words)->out;
    for (size_t i = 0; i != 3; i++) {
        at = strstr(at, probes[i]);
        assert_non_null(at);
        at = strstr(at, changes[i]);
        assert_non_null(at);
    }
    assert_null(strstr(at + 1, "\"probe\""));
    steps_see("480", level);
    const tool_run_t *const run = read_steps(level);
    const char *const header = "name,model,mode,address,probe,time_us,utc,alarm,is_on,distance_mm,level_mm,"
                               "level_per_mille,volume\na16:1,a16,modbus,1,1,";
    assert_memory_equal(run->out, header, strlen(header));
    assert_non_null(strstr(run->out, "Z,on,true,480,1820,910,910\n"));
    (void)run_row(&(row_t){0, "480",
                           A16 "near<500" SAFE " --level mounting=2300,height=2000,capacity=1000 --count 2",
                           "0 a16: alarm on, 480 mm  level 1820 mm  910 per mille  volume 910\n"});
}

/* The alarm of one run is not kept for the next. */
TEST_ROWS(until_alarm_ends_with_3_when_one_is_on,
          {3, "400", A16 "near<500" SAFE " --until-alarm", "0 a16: alarm on, 400 mm\n"},
          {0, "700", A16 "near<500" SAFE " --until-alarm --count 2", "0 a16: alarm off, 700 mm\n"},
          {0, "400", A16 "near<500" SAFE " --count 3", "0 a16: alarm on, 400 mm\n"},
          {0, "400", "a16:1:modbus --count 1", "0 a16     400 mm    0.400 m\n"})

TEST(until_alarm_ends_at_once)
{
    const tool_run_t *run = run_row(&(row_t){3, "700 700 700 400 700", A16 "near<500" SAFE " --until-alarm",
                                             "0 a16: alarm off, 700 mm\n3 a16: alarm on, 400 mm\n"});
    assert_in_range(run->took_us, 3500000, 3600000);
    steps_begin(); /* nothing is there: the attempts of 0 and 2 s have failed, that of 4 s not yet */
    run = read_steps(A16 "near<500" SAFE " --until-alarm --stats");
    assert_int_equal(run->status, 3);
    assert_in_range(run->took_us, 5000000, 5200000);
    expect_err(run, "fathom: attempts 2, failed 2, readings 0\n");
}
