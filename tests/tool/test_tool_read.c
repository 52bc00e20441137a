/* SPDX-License-Identifier: MIT */
/* What read prints of each sensor, and what it can choose: its value, its probes, its limits, its temperature, and
 * whether it is asked at all. */
#include "tool_steps.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the bench: what the tool sends, and what happens meanwhile ---- */

enum { LOG = 256 };

static uint8_t sent[LOG];
static size_t sent_count;
static unsigned breaks;      /* calls of set_break */
static uint64_t passed_us;   /* since the begin */
static uint64_t off_at_us;   /* when the power goes for 3 s; 0: never */
static uint8_t refused_at_3; /* a request with this register's low byte does not leave; 0: none */

static int log_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    const bool is_refused = length > 3 && refused_at_3 != 0 && bytes[3] == refused_at_3;
    if (sent_count + length <= LOG) {
        memcpy(sent + sent_count, bytes, length);
        sent_count += length;
    }
    return is_refused ? (int)length : uart.write(ctx, bytes, length);
}

static int log_break(void *ctx, bool on)
{
    breaks++;
    return fathom_sim_uart(ctx).set_break(ctx, on);
}

static void pass(void *ctx, uint32_t max_us)
{
    const uint32_t began_us = bench.clock.now_us;
    fathom_sim_clock_idle(ctx, max_us < 1000 ? max_us : 1000);
    passed_us += bench.clock.now_us - began_us;
    if (off_at_us == 0 || passed_us < off_at_us) return;
    off_at_us = 0;
    fathom_sim_power_cycle(&bench.line, &bench.a05.device, 3000000, bench.clock.now_us);
}

static int set_up(void **state)
{
    sent_count = 0;
    breaks = 0;
    passed_us = 0;
    off_at_us = 0;
    refused_at_3 = 0;
    bench_begin();
    bench.tool.uart.write = log_write;
    bench.tool.uart.set_break = log_break;
    bench.tool.idle = pass;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Each reading has this in it, and there are so many. */
static void expect_all(const tool_run_t *run, unsigned readings, const char *part)
{
    if (count_of(run->out, "\n") != readings || count_of(run->out, part) != readings)
        fail_msg("not %u times '%s':\n%s%s", readings, part, run->out, run->err);
}

/* Runs "read WORDS --format json", which succeeds with so many readings that have this in them. */
static const tool_run_t *readings(unsigned count, const char *part, const char *words)
{
    const tool_run_t *const run = tool_run(&bench.tool, "read %s --format json --port line", words);
    expect_all(run, count, part);
    assert_int_equal(run->status, 0);
    return run;
}

/* ---- what is printed ---- */

/* The sensor that the word names, at its factory address, which sees this. */
static const tool_run_t *read_factory(const char *words, const int32_t sees[4], const char *options)
{
    (void)set_up(NULL);
    memcpy(bench.scene.value, sees, sizeof bench.scene.value);
    bench.line.full_duplex = strchr(words, ':') == NULL && words[0] == 'a';
    if (strncmp(words, "a16", 3) == 0)
        bench_a16((fathom_sim_a16_config_t){.mode = bench.line.full_duplex ? FATHOM_SIM_A16_UART : 0});
    else if (strncmp(words, "a05", 3) == 0)
        bench_a05((fathom_sim_a05_config_t){.mode = bench.line.full_duplex          ? FATHOM_SIM_A05_AUTO
                                                    : strstr(words, ":dyp") != NULL ? FATHOM_SIM_A05_DYP
                                                                                    : 0});
    else
        bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = strstr(words, "auto") != NULL ? 18519 : 0});
    return tool_run(&bench.tool, "read %s --count 1 --port line %s", words, options);
}

/* Replaces the two columns with times by T. */
static void mask_times(const char *csv, char *to)
{
    unsigned commas = 0;
    for (; *csv != '\0'; csv++) {
        commas = *csv == '\n' ? 0 : commas + (*csv == ',' ? 1 : 0);
        if (commas == 6 && *csv == ',') to += sprintf(to, ",T");
        if (commas < 6 || commas > 7) *to++ = *csv;
    }
    *to = '\0';
}

#define NONE   FATHOM_SIM_NO_TARGET
#define HIDDEN FATHOM_SIM_INTERFERENCE
TEST(each_sensor_in_each_mode_has_exactly_what_it_sees)
{
    const struct {
        const char *words;
        const char *names; /* the first columns */
        int32_t sees[4];
        const char *values[5]; /* of each probe: the columns behind the times */
    } rows[] = {
        {"a16", "a16,a16,auto,", {1953}, {"target,false,1953,1953"}},
        /* FF 01 FF FF: out of step it would be 65281 */
        {"a16", "a16,a16,auto,", {511}, {"target,false,511,511"}},
        {"a16", "a16,a16,auto,", {NONE}, {"no_target,false,,65533"}},
        {"a16", "a16,a16,auto,", {HIDDEN}, {"no_target,true,,65534"}},
        {"a16:1:modbus", "a16:1,a16,modbus,1", {754}, {"target,false,754,754"}},
        /* out of step by six it would be 1339 2047 1000 2000 */
        {"a05",
         "a05,a05,auto,",
         {1000, 2000, 2047, 1339},
         {"target,false,1000,1000", "target,false,2000,2000", "target,false,2047,2047",
          "target,false,1339,1339"}},
        {"a05:1:modbus",
         "a05:1,a05,modbus,1",
         {316, NONE, HIDDEN, 4500},
         {"target,false,316,316", "no_target,false,,65533", "no_target,true,,65534",
          "target,false,4500,4500"}},
        {"hps167s", "hps167s:1,hps167s,modbus,1", {2083}, {"target,false,2083,2083,723.1744,1,0"}},
        {"hps167s", "hps167s:1,hps167s,modbus,1", {NONE}, {"no_target,false,,65530,0.0016,1,0"}},
        {"hps167s:1:auto", "hps167s:1,hps167s,auto,1", {2083}, {"target,false,2083,2083,723.1744,1,0"}},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        char got[1024];
        char expected[1024];
        const tool_run_t *const run = read_factory(rows[i].words, rows[i].sees, "--format csv");
        int length = sprintf(
            expected, "name,model,mode,address,probe,sequence,T,status,interference,distance_mm,raw%s\n",
            rows[i].words[0] == 'h' ? ",magnitude,ambient,precision" : "");
        for (unsigned p = 0; rows[i].values[p] != NULL; p++)
            length += sprintf(expected + length, "%s,%u,1,T,%s\n", rows[i].names, p + 1, rows[i].values[p]);
        mask_times(run->out, got);
        assert_string_equal(got, expected);
        assert_string_equal(run->err, "");
        assert_int_equal(run->status, 0);
    }
}

TEST(text_has_mm_and_m_and_the_reason_if_there_is_none)
{
    const struct {
        const char *words;
        int32_t sees[4];
        const char *options;
        const char *out;
    } rows[] = {
        {"a16", {754}, "", "0 a16     754 mm    0.754 m\n"},
        {"a05",
         {1000, 20, NONE, HIDDEN},
         "--format text",
         "0 a05 probe 1    1000 mm    1.000 m\n0 a05 probe 2      20 mm    0.020 m\n"
         "0 a05 probe 3  no_target\n0 a05 probe 4  no_target (interference)\n"},
        {"a05",
         {0, 65533, 1000, 1000},
         "--means fffd=too-near",
         "0 a05 probe 1  unknown: the value 0 has no known meaning (--means)\n0 a05 probe 2  too_near\n"
         "0 a05 probe 3    1000 mm    1.000 m\n0 a05 probe 4    1000 mm    1.000 m\n"},
        {"hps167s",
         {17999},
         "",
         "0 hps167s   17999 mm   17.999 m  magnitude 723.1744  ambient 1  precision 0\n"},
        {"hps167s", {FATHOM_SIM_FAULT}, "", "0 hps167s  fault: the sensor reports a fault\n"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        expect_text(read_factory(rows[i].words, rows[i].sees, rows[i].options), rows[i].out);
}

/* Datasheets 3 and 4: 0 does not mean that nothing is in range, and a probe that is not fitted does not hide the others. */
TEST(an_odd_probe_is_told_and_the_others_are_read_each_time)
{
    static const int32_t sees[] = {1000, 2000, 7000, 3000};
    static const char *const modes[] = {"a05", "a05:1:modbus", "a05:1:dyp"};
    const tool_run_t *run = read_factory("a05", sees, "--count 3 --stats");
    assert_int_equal(run->status, 1);
    expect_all(run, 9, "000 mm");
    expect_err(run, "attempts 3, failed 3, readings 9\n");
    for (unsigned attempt = 1; attempt <= 3; attempt++) {
        char text[128];
        (void)snprintf(text, sizeof text, "attempt %u: ", attempt);
        expect_err(run, text);
    }
    assert_int_equal(count_of(run->err,
                              "probe 3: 7000 is no distance from 1 to 6000 mm. If this probe is not fitted, "
                              "leave it out"),
                     1); /* the cause stays the same */
    for (size_t i = 0; i != 3; i++) {
        run = read_factory(modes[i], sees, "--probes 1,2,4");
        assert_int_equal(run->status, 0);
        expect_all(run, 3, "000 mm");
    }
}

/* ---- processed or real-time ---- */

/* bench.scene is the real-time value, 1234 mm. */
static fathom_sim_fixed_t processed = {{2000, 2000, 2000, 2000}};

static void a16(uint8_t mode)
{
    bench.line.full_duplex = mode == FATHOM_SIM_A16_UART;
    bench_a16((fathom_sim_a16_config_t){.mode = mode, .processed = fathom_sim_fixed(&processed)});
}

static void a05_auto(void)
{
    bench.line.full_duplex = true;
    bench_a05(
        (fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .processed = fathom_sim_fixed(&processed)});
}

/* A DS1603L sends every 4 s: 2 s and 4 * 4.096 s (a16_auto.h). The A16 has no period: 2 s. */
TEST(a_sensor_that_sends_seldom_is_stale_after_its_periods)
{
    const struct {
        const char *words;
        uint32_t stale_us;
    } rows[] = {{"a16", 2000000}, {"ds1603l", 18000000}, {"ds1603l --timeout 500", 500000}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)set_up(NULL);
        const tool_run_t *const run = tool_run(&bench.tool, "read %s --count 1 --port line", rows[i].words);
        assert_int_equal(run->status, 1);
        assert_in_range(run->took_us, rows[i].stale_us, rows[i].stale_us + 100000);
    }
}

/* A16 6(3): 0x0100 processed, 0x0101 real-time. */
TEST(an_a16_is_asked_for_the_value_that_is_wanted)
{
    const struct {
        const char *option;
        const char *distance;
        uint8_t reg;
    } rows[] = {
        {"", ":2000,", 0x00}, {"--value processed", ":2000,", 0x00}, {"--value real-time", ":1234,", 0x01}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)set_up(NULL);
        a16(FATHOM_SIM_A16_MODBUS);
        const tool_run_t *const run =
            tool_run(&bench.tool, "read a16:1:modbus --count 2 --format json %s --port line", rows[i].option);
        assert_int_equal(run->status, 0);
        expect_all(run, 2, rows[i].distance);
        assert_int_equal(sent[2], 0x01);
        assert_int_equal(sent[3], rows[i].reg);
    }
}

TEST(rx_of_an_a16_is_held_low_for_real_time_values_and_let_go_at_the_end)
{
    a16(FATHOM_SIM_A16_UART);
    (void)readings(5, ":1234,", "a16 --value real-time --count 5");
    assert_int_equal(bench.a16.device.rx_held, 0);
    assert_int_equal(breaks, 3); /* off, on, off */
    bench.tool.ctrl_c_us = 1000000;
    ASSERT_RUN(0, "read a16 --value real-time --port line");
    assert_int_equal(bench.a16.device.rx_held, 0);
    assert_int_equal(breaks, 6);
}

TEST(rx_of_an_a16_is_high_for_processed_values_whatever_was_before)
{
    a16(FATHOM_SIM_A16_UART);
    fathom_sim_break(&bench.line, true, bench.clock.now_us);
    (void)readings(5, ":1234,", "a16 --count 5");
    assert_int_equal(breaks, 0); /* without the option it is left alone */
    (void)readings(5, ":2000,", "a16 --value processed --count 5");
}

TEST(a_port_without_a_break_is_told_before_anything_is_read)
{
    a16(FATHOM_SIM_A16_UART);
    bench.tool.uart.set_break = NULL;
    const tool_run_t *run = tool_run(&bench.tool, "read a16 --value real-time --count 1 --port line");
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, "");
    expect_err(run,
               "fathom: a16: this port cannot hold its TX low (a break), which selects real-time values; try "
               "another adapter");
    run = tool_run(&bench.tool, "read a05 --value real-time --count 1 --port line");
    assert_int_equal(run->status, 1);
    expect_err(run, "fathom: a05: this port cannot hold its TX low");
}

/* A05 1(1): it looks at RX in the first second after power-on. 10 s after the begin it goes off for 3 s. */
static void a05_is_switched(const char *value, const char *distance)
{
    a05_auto();
    off_at_us = 10000000;
    const tool_run_t *const run =
        tool_run(&bench.tool, "read a05 --value %s --count 20 --format json --port line", value);
    assert_int_equal(run->status, 0);
    expect_all(run, 80, distance);
    assert_in_range(run->took_us, 13000000, 21000000);
    assert_int_equal(count_of(run->err, "switch its supply off for 3 seconds and on\n"), 1);
    assert_int_equal(count_of(run->err, "fathom: a05: it has been switched on: readings begin\n"), 1);
    assert_int_equal(bench.a05.device.rx_held, 0);
}

TEST(an_a05_is_read_from_when_it_was_switched_on_with_rx_as_it_is_wanted)
{
    a05_is_switched("real-time", ":1234,");
    (void)set_up(NULL);
    a05_is_switched("processed", ":2000,");
}

TEST(an_a05_that_is_off_at_the_begin_is_waited_for)
{
    a05_auto();
    fathom_sim_power_cycle(&bench.line, &bench.a05.device, 20000000, bench.clock.now_us);
    (void)readings(8, ":1234,", "a05 --value real-time --count 2");
}

TEST(an_a05_that_is_not_switched_off_gives_nothing)
{
    a05_auto();
    const tool_run_t *const run =
        tool_run(&bench.tool, "read a05 --value real-time --duration 30 --stats --port line");
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, "");
    expect_err(run, "attempts 0, failed 0, readings 0\n");
    assert_int_equal(bench.a05.device.rx_held, 0);
}

/* ---- what is asked for ---- */

/* A05 2(3)4: 55 AA 01 12 measures the third probe; the sum 55 + AA + 01 + 12 is 112, of which the low byte is sent. */
TEST(one_probe_of_an_a05_is_measured_alone)
{
    const uint8_t request[] = {0x55, 0xAA, 0x01, 0x12, 0x12};
    bench_a05((fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_DYP});
    bench.scene = (fathom_sim_fixed_t){{1000, 2000, 3000, 4000}};
    const tool_run_t *const run = readings(4, "\"probe\":3,", "a05:1:dyp --probes 3 --count 4");
    expect_all(run, 4, "\"distance_mm\":3000,");
    assert_int_equal(sent_count, 4 * sizeof request);
    assert_memory_equal(sent, request, sizeof request);
    /* 100 ms from one to the next, and 75 ms for the last (A05 2(3)1); of all probes it is 250 ms */
    assert_in_range(run->took_us, 300000, 400000);
}

TEST(two_probes_of_an_a05_are_measured_with_the_others)
{
    const uint8_t request[] = {0x55, 0xAA, 0x01, 0x01, 0x01};
    bench_a05((fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_DYP});
    (void)readings(2, ":1234,", "a05:1:dyp --probes 3,4 --count 1");
    assert_memory_equal(sent, request, sizeof request);
}

/* ---- what is believed ---- */

static const tool_run_t *read_of(const char *sensor, int32_t value, const char *options)
{
    (void)set_up(NULL);
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    bench_a05((fathom_sim_a05_config_t){.address = 2});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 3});
    for (int i = 0; i != 4; i++) bench.scene.value[i] = value;
    return tool_run(&bench.tool, "read %s --count 1 --format json %s --port line", sensor, options);
}

TEST(a_distance_outside_the_window_is_refused)
{
    const char *const window = "--window 300-5000";
    expect_all(read_of("a16:1:modbus", 300, window), 1, "\"distance_mm\":300,");
    expect_all(read_of("a16:1:modbus", 5000, window), 1, "\"distance_mm\":5000,");
    const tool_run_t *run = read_of("a16:1:modbus", 299, window);
    assert_int_equal(run->status, 1);
    expect_err(run, "299 is no distance from 300 to 5000 mm");
    run = read_of("a05:2:modbus", 5001, window);
    expect_all(run, 4,
               "\"status\":\"impossible_values\",\"interference\":null,\"distance_mm\":null,\"raw\":null}");
    expect_all(run, 4, "\"sequence\":null,");
    assert_int_equal(count_of(run->out, "\"probe\":4,"), 1);
    expect_err(run, "probe 4: 5001 is no distance from 300 to 5000 mm");
    /* wider than the A05's own, which ends at 6000 */
    expect_all(read_of("a05:2:modbus", 6500, "--window 1-7000"), 4, "\"distance_mm\":6500,");
}

/* What is nearer is below its range, as 79 mm is (table 1: 0.08 m); what is farther cannot be. */
TEST(a_window_of_an_hps167s_moves_its_limits)
{
    const char *const window = "--window 300-5000";
    expect_all(read_of("hps167s:3", 300, window), 1, "\"distance_mm\":300,");
    expect_all(read_of("hps167s:3", 5000, window), 1, "\"distance_mm\":5000,");
    expect_all(read_of("hps167s:3", 299, window), 1, "\"status\":\"unknown\",");
    expect_err(read_of("hps167s:3", 5001, window), "the values cannot be a distance: 5001");
    expect_all(read_of("hps167s:3", 79, ""), 1, "\"status\":\"unknown\",");
    expect_all(read_of("hps167s:3", 79, "--window 50-5000"), 1, "\"distance_mm\":79,");
}

TEST(each_of_the_four_values_can_have_each_of_the_six_meanings)
{
    static const int32_t values[] = {0, 0xFFFD, 0xFFFE, 0xFFFF};
    static const char *const meanings[] = {"unknown",  "no-target", "interference",
                                           "too-near", "fault",     "refused"};
    static const char *const statuses[] = {
        "\"unknown\",\"interference\":false",  "\"no_target\",\"interference\":false",
        "\"no_target\",\"interference\":true", "\"too_near\",\"interference\":false",
        "\"fault\",\"interference\":false",    NULL};
    for (size_t v = 0; v != 4; v++)
        for (size_t m = 0; m != 6; m++) {
            char option[64];
            (void)snprintf(option, sizeof option, "--means %x=%s", (unsigned)values[v], meanings[m]);
            const tool_run_t *const run = read_of("a16:1:modbus", values[v], option);
            if (statuses[m] != NULL)
                expect_all(run, 1, statuses[m]);
            else
                expect_err(run, " has no known meaning. If you know it, use --means ");
            /* An unknown value is a reading, but no good one. */
            assert_int_equal(run->status, m == 0 || m == 5 ? 1 : 0);
        }
    expect_all(read_of("a16:1:modbus", 0, ""), 1, statuses[0]);
    expect_err(read_of("a16:1:modbus", 0xFFFF, ""),
               "65535 (hex FFFF) has no known meaning. If you know it, use --means FFFF=");
}

/* ---- an HPS-167S that is not asked ---- */

TEST(unasked_frames_of_an_address_are_read_and_nothing_is_sent)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7, .unasked_us = 18519});
    const tool_run_t *const run =
        readings(54, "{\"name\":\"hps167s:7\",\"model\":\"hps167s\",\"mode\":\"auto\",\"address\":7,",
                 "hps167s:7:auto --count 54 --stats");
    /* DC B2 07: 56498 * 128 / 10000 (the example of #5) */
    expect_all(run, 54,
               "\"distance_mm\":1234,\"raw\":1234,\"magnitude\":723.1744,\"ambient\":1,\"precision\":0}");
    assert_in_range(run->took_us, 900000, 1100000); /* 54 a second */
    assert_int_equal(sent_count, 0);
    expect_err(run, "\"stream\":{\"frames\":54,");
}

TEST(an_interval_drops_unasked_frames)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18519});
    const tool_run_t *const run =
        readings(4, "\"distance_mm\":1234,", "hps167s:1:auto --count 4 --interval 500");
    assert_in_range(run->took_us, 1500000, 1700000);
}

/* The clock of the library has wrapped once after a second, and again after 72 minutes. */
TEST(times_go_on_above_32_bits)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    bench.tool.idle = fathom_sim_clock_idle;
    const tool_run_t *const run =
        readings(4, "Z\",\"status\":\"target\",", "hps167s --interval 1500000 --count 4");
    const char *at = run->out;
    for (uint64_t i = 0; i != 4; i++) {
        at = strstr(at, "\"time_us\":");
        const uint64_t time_us = strtoull(at += 10, NULL, 10);
        assert_true(time_us / 1000000 == i * 1500);
    }
    assert_non_null(strstr(at, "\"utc\":\"2025-11-24T17:15:00."));
}

TEST(unasked_frames_of_another_address_are_none)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7, .unasked_us = 18519});
    const tool_run_t *run = tool_run(&bench.tool, "read hps167s:1:auto --count 1 --port line");
    assert_int_equal(run->status, 1);
    expect_err(run, "the line works, but address 7 sends. Try --address 7");
    assert_in_range(run->took_us, 2000000, 2100000); /* hps167s_auto.h: 2 s */
    run = tool_run(&bench.tool,
                   "read hps167s:7:auto --timeout 300 --count 1 --window 2000-3000 --stats --port line");
    assert_int_equal(run->status, 1); /* 1234 is unknown: nothing good */
    expect_err(run, "attempts 1, failed 0, readings 1\n");
}

TEST(an_hps167s_that_sends_nothing_is_stale_after_the_time_out)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    const tool_run_t *const run =
        tool_run(&bench.tool, "read hps167s:1:auto --timeout 300 --count 2 --port line");
    assert_int_equal(run->status, 1);
    assert_in_range(run->took_us, 600000, 620000);
    assert_int_equal(
        count_of(run->err, "no byte was received. Check the power and whether A and B are swapped"), 1);
    expect_err(run,
               "attempt 2: no frame from hps167s:1 at line (19200 8E1): the same cause as before, 2 times");
}

/* ---- the temperature of an HPS-167S ---- */

TEST(each_reading_has_the_last_temperature)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.temperature_f = 31}); /* (31 - 32) * 5 / 9 = -0.56 degC */
    const tool_run_t *run =
        tool_run(&bench.tool, "read hps167s --temperature --count 300 --format json --port line");
    assert_int_equal(run->status, 0);
    expect_all(run, 300, ",\"temperature_degc\":-0.6}\n");
    assert_int_equal(bench.hps167s.device.counters.requests, 301); /* some 5.6 s */
    run = tool_run(&bench.tool,
                   "read hps167s --temperature=2 --count 10 --interval 500 --format csv --port line");
    /* at 0, 2 and 4 s */
    assert_int_equal(bench.hps167s.device.counters.requests, 301 + 10 + 3);
    assert_in_range(run->took_us, 4500000, 4700000);
    assert_non_null(strstr(run->out, ",precision,temperature_degc\n"));
    assert_int_equal(count_of(run->out, ",0,-0.6\n"), 10);
    run = tool_run(&bench.tool, "read hps167s --temperature --count 1 --port line");
    assert_non_null(strstr(run->out, "  precision 0  -0.6 degC\n"));
    run = tool_run(&bench.tool, "read hps167s --count 1 --format json --port line");
    assert_null(strstr(run->out, "temperature"));
}

TEST(a_long_interval_does_not_make_the_temperature_old)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    const tool_run_t *const run = tool_run(
        &bench.tool, "read hps167s --temperature=1 --interval 10000 --count 3 --format json --port line");
    expect_all(run, 3, ":25.0}"); /* 77 degrees Fahrenheit */
    assert_in_range(bench.hps167s.device.counters.requests, 3 + 20, 3 + 22);
    assert_in_range(run->took_us, 20000000, 20200000);
}

TEST(a_temperature_that_cannot_be_read_fails_nothing_and_is_told_once)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    refused_at_3 = 0x04; /* #4 */
    const tool_run_t *const run =
        readings(20, "\"distance_mm\":1234,", "hps167s --temperature=1 --count 20 --interval 500 --stats");
    expect_all(run, 20, ",\"temperature_degc\":null}");
    expect_err(run, "\"attempts\":20,\"failed\":0,\"readings\":20,");
    assert_int_equal(count_of(run->err, "fathom: hps167s:1: its temperature could not be read"), 1);
}

static void fall_silent_at_4500_ms(void *ctx, uint32_t max_us)
{
    pass(ctx, max_us);
    if (passed_us > 4500000) refused_at_3 = 0x04;
}

TEST(a_temperature_of_more_than_three_times_its_period_ago_is_not_told)
{
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    bench.tool.idle = fall_silent_at_4500_ms;
    const tool_run_t *const run = tool_run(
        &bench.tool, "read hps167s --temperature=2 --duration 20 --interval 1000 --format json --port line");
    assert_int_equal(run->status, 0);
    /* Read at 0, 2 and 4 s, so told up to 10 s: with what was measured at 0 to 5 s. Then each request for it takes a
     * time-out of 1 s, and may be answered late for as long again. */
    assert_in_range(count_of(run->out, ":25.0}"), 6, 8);
    assert_in_range(count_of(run->out, ":null}"), 5, 10);
    assert_null(strstr(strstr(run->out, ":null}"), ":25.0}"));
}

/* a22-rs485 and a02yy4w have register 0x0102 in src/models; it is signed, in tenths of a degree. */
TEST(a_relative_with_the_register_has_a_temperature)
{
    bench_a16((fathom_sim_a16_config_t){.baud = 115200, .has_temperature = true, .temperature_dc = -105});
    const tool_run_t *run = tool_run(
        &bench.tool,
        "read a22-rs485 --temperature=2 --count 10 --interval 500 --timeout 2000 --format json --port line");
    assert_int_equal(run->status, 0);
    expect_all(run, 10, ",\"temperature_degc\":-10.5}\n");
    assert_int_equal(bench.a16.device.counters.requests, 10 + 3); /* the temperature at 0, 2 and 4 s */
    run = tool_run(&bench.tool, "read a22-rs485 --temperature --count 1 --port line");
    assert_non_null(strstr(run->out, "  -10.5 degC\n"));
    run = tool_run(&bench.tool, "read a22-rs485 --count 1 --format json --port line");
    assert_null(strstr(run->out, "temperature"));
}

/* A unit that is sold as an A02YY4W and has no such register does not respond to it. */
TEST(a_relative_without_the_register_is_read_all_the_same)
{
    bench_a16((fathom_sim_a16_config_t){.baud = 9600});
    const tool_run_t *const run =
        readings(5, "\"distance_mm\":1234,", "a02yy4w --temperature=1 --count 5 --interval 500");
    expect_all(run, 5, ",\"temperature_degc\":null}");
    assert_int_equal(count_of(run->err, "fathom: a02yy4w:1: its temperature could not be read"), 1);
}

TEST(on_a_line_with_others_only_an_hps167s_has_a_temperature)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 2});
    const tool_run_t *const run = tool_run(
        &bench.tool,
        "read a16:1 hps167s:2 --temperature --window 100-2000 --value real-time --count 1 --format csv "
        "--port line");
    assert_int_equal(run->status, 0);
    assert_int_equal(count_of(run->out, ",1234,1234,,,,\n"), 1);
    assert_int_equal(count_of(run->out, ",1234,1234,723.1744,1,0,25.0\n"), 1);
}

/* ---- several on one line ---- */

/* After the third silence it is left alone for one time-out, then for 2 and 4 (modbus_unit.h); each silence takes two. */
TEST(a_silent_unit_is_named_and_left_alone_and_the_others_are_read)
{
#define UNIT(model, address, counts)                                                                         \
    "\"model\":\"" model "\",\"mode\":\"modbus\",\"address\":" address ",\"attempts\":" counts
    static const char *const parts[] = {
        "no byte was received, but other sensors on this line respond. Check the power",
        "\"attempts\":21,\"failed\":4,\"readings\":41,\"requests\":22,",
        UNIT("a16", "1",
             "9,\"failed\":0,\"readings\":9,\"responses\":9,\"failed_requests\":0,\"timeouts_in_row\":0,"),
        UNIT("a16", "2",
             "4,\"failed\":4,\"readings\":0,\"responses\":0,\"failed_requests\":4,\"timeouts_in_row\":4,"),
        UNIT("a05", "3",
             "8,\"failed\":0,\"readings\":32,\"responses\":8,\"failed_requests\":0,\"timeouts_in_row\":0,"),
        "\"timeouts_in_row\":4,\"backoff_left_us\":0,\"response_min_us\":null,"};
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    bench_a05((fathom_sim_a05_config_t){.address = 3});
    const tool_run_t *run = tool_run(
        &bench.tool, "read a16:1 a16:2 a05:3 --duration 12 --timeout 1000 --stats --format json --port line");
    assert_int_equal(run->status, 1);
    assert_int_equal(count_of(run->err, "attempt "), 4);
    assert_int_equal(count_of(run->err, "fathom: a16:2: attempt "), 4);
    for (size_t i = 0; i != sizeof parts / sizeof parts[0]; i++) expect_err(run, parts[i]);
    assert_int_equal(count_of(run->err, "\"backoff_left_us\":0,"), 3);
    /* the only one on its line */
    run = tool_run(&bench.tool, "read a16:2:modbus --timeout 60 --count 8 --stats --format json --port line");
    expect_err(run, "\"failed\":8,\"readings\":0,\"responses\":0,\"failed_requests\":8,");
    expect_err(run, "\"backoff_left_us\":1,");
}

/* ---- what has no effect ---- */

REFUSES(
    an_option_that_no_sensor_takes_is_wrong_usage, "read --port line",
    {"hps167s --value real-time",
     "--value has no effect on hps167s (modbus). It is for a16 (auto, modbus), a05 (auto)."},
    {"a16:1:controlled --value processed", "--value has no effect on a16 (controlled)."},
    {"a05:1:dyp --value processed", "--value has no effect on a05 (dyp)."},
    {"a05:1:modbus --value processed", "--value has no effect on a05 (modbus)."},
    {"a16 --value fast", "--value is 'fast'. It takes processed or real-time."},
    {"a16:1:modbus --probes 1", "--probes has no effect on a16 (modbus). It is for a05 (auto, modbus, dyp)."},
    {"hps167s --means 0=fault", "--means has no effect on hps167s (modbus). It is for a16 (auto, modbus, "
                                "controlled), a05 (auto, modbus, dyp)."},
    {"a05 --first-register 0x0010", "unknown option '--first-register'."},
    {"a16 --temperature",
     "--temperature has no effect on a16 (auto). It is for hps167s (modbus), models with a temperature in"},
    {"a16:1:modbus --temperature", "--temperature has no effect on a16 (modbus)."},
    {"a02yyuw --temperature", "--temperature has no effect on a02yyuw (auto)."},
    {"a17ny4w --temperature", "--temperature has no effect on a17ny4w (modbus)."},
    {"hps167s:1:auto --temperature", "--temperature has no effect on hps167s (auto)."},
    {"hps167s --temperature=0", "--temperature is '0'. It takes a whole number from 1 to 1000 s."},
    {"a16 --window 300", "--window is '300'. It takes MIN-MAX, from 1 to 65529."},
    {"a16 --window 0-300", "--window is '0-300'."}, {"a16 --window 300-299", "--window is '300-299'."},
    {"a16 --window 300-65530", "--window is '300-65530'."},
    {"hps167s:1:auto a16:2", "hps167s in mode auto sends automatically and cannot share a line."})

TEST(watch_has_the_same_options)
{
    a16(FATHOM_SIM_A16_UART);
    const tool_run_t *const run =
        tool_run(&bench.tool, "watch a16 --value real-time --window 1000-2000 --duration 3 --port line");
    assert_int_equal(run->status, 0);
    assert_int_equal(count_of(run->out, " a16 1.234 m "), 2); /* at 1 and 2 s */
    assert_int_equal(bench.a16.device.rx_held, 0);
}
