/* SPDX-License-Identifier: MIT */
/* Many ports in one command: each is read, lost and opened again on its own. */
#include "tool_steps.h"

#include <stdio.h>
#include <string.h>

enum { PORTS = 256, NAMES = 16, WORDS = 8192 };

static struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t lines[PORTS];
    fathom_sim_uart_t uarts[PORTS];
    fathom_sim_hps167s_t hps167s[PORTS];
    fathom_sim_a16_t a16;
    fathom_sim_fixed_t scene;
    tool_port_t ports[PORTS];
    char paths[PORTS][24]; /* p0, p1 ... */
    tool_line_t tool;
    uint64_t passed_us;
    size_t pulled; /* this port is away ... */
    uint64_t off_us;
    uint64_t on_us;
} many;

static void pass(void *ctx, uint32_t max_us)
{
    const uint32_t began_us = many.clock.now_us;
    /* So that it is away to the millisecond. */
    fathom_sim_clock_idle(ctx, many.on_us != 0 && max_us > 1000 ? 1000 : max_us);
    many.passed_us += many.clock.now_us - began_us;
    if (many.on_us != 0)
        many.ports[many.pulled].is_away = many.passed_us >= many.off_us && many.passed_us < many.on_us;
}

/* So many ports with an empty line at 19200 8E1 each. */
static void ports(size_t count)
{
    const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    memset(&many, 0, sizeof many);
    many.scene.value[0] = 1234;
    fathom_sim_clock_init(&many.clock, UINT32_MAX - 1000000, 0);
    for (size_t i = 0; i != count; i++) {
        fathom_sim_line_init(&many.lines[i], &settings, many.clock.now_us);
        fathom_sim_uart_init(&many.uarts[i], &many.lines[i], &many.clock);
        many.uarts[i].knows = 0;
        (void)snprintf(many.paths[i], sizeof many.paths[i], "p%zu", i);
        many.ports[i] = (tool_port_t){.path = many.paths[i], .uart = fathom_sim_uart(&many.uarts[i])};
    }
    many.tool = (tool_line_t){.ports = many.ports,
                              .port_count = count,
                              .clock = fathom_sim_clock(&many.clock),
                              .idle = pass,
                              .ctx = &many.clock};
}

static void hps167s(size_t port, fathom_sim_hps167s_config_t config)
{
    config.scene = fathom_sim_fixed(&many.scene);
    fathom_sim_hps167s_init(&many.hps167s[port], &config);
    fathom_sim_attach(&many.lines[port], &many.hps167s[port].device, many.clock.now_us);
}

/* Another one at address 2, which takes the place of that at port 1. */
static void beside(size_t port, fathom_sim_hps167s_config_t config)
{
    config.address = 2;
    config.scene = fathom_sim_fixed(&many.scene);
    fathom_sim_hps167s_init(&many.hps167s[1], &config);
    fathom_sim_attach(&many.lines[port], &many.hps167s[1].device, many.clock.now_us);
}

static void away(size_t port, uint64_t off_us, uint64_t on_us)
{
    many.pulled = port;
    many.off_us = off_us;
    many.on_us = on_us;
    many.ports[port].is_away = off_us == 0;
}

/* ---- what the lines of text say ---- */

typedef struct {
    unsigned count;
    double first_s, last_s;
    double longest_s; /* from one to the next */
} readings_t;

static readings_t readings_of(const tool_run_t *run, const char *name)
{
    readings_t readings = {0};
    for (const char *line = run->out; *line != '\0'; line = strchr(line, '\n') + 1) {
        double at_s = 0;
        char word[64];
        assert_int_equal(sscanf(line, "%lf s %63s", &at_s, word), 2);
        if (strcmp(word, name) != 0) continue;
        if (readings.count == 0) readings.first_s = at_s;
        if (readings.count != 0 && at_s - readings.last_s > readings.longest_s)
            readings.longest_s = at_s - readings.last_s;
        readings.last_s = at_s;
        readings.count++;
    }
    return readings;
}

#define RUN(exit_status, ...)                                                                                \
    const tool_run_t *const run = tool_run(&many.tool, __VA_ARGS__);                                         \
    if (run->status != (exit_status)) fail_msg("exit status %d\n%s%s", run->status, run->out, run->err)

/* ---- lost, silent and fine ---- */

/* Lost at 2.2 s, found so at once by those that wait for time: its attempts at 0, 0.5, 1, 1.5 and 2 s, the loss, and,
 * as the pauses are 0.5, 1 and 2 s, tries at 2.7, 3.7 and 5.7 s; back at 5 s; attempts at 5.7, 6.2 ... 9.7 s: 9. The
 * others: at 0, 0.5 ... 9.5 s. */
static void three(void)
{
    ports(3);
    hps167s(0, (fathom_sim_hps167s_config_t){0});
    hps167s(2, (fathom_sim_hps167s_config_t){0});
    away(0, 2200000, 5000000);
}

TEST(one_is_lost_and_comes_back_one_is_silent_and_the_third_does_not_pause)
{
    three();
    RUN(1, "read lost=hps167s@p0 mute=hps167s@p1 fine=hps167s@p2 --interval 500 --timeout 100 --duration 10 "
           "--reconnect --stats");
    const readings_t fine = readings_of(run, "fine");
    const readings_t lost = readings_of(run, "lost");
    assert_int_equal(fine.count, 20);
    assert_true(fine.longest_s < 0.510);
    assert_int_equal(lost.count, 5 + 9);
    assert_true(lost.longest_s > 3.690 && lost.longest_s < 3.710); /* from 2.0 to 5.7 s */
    assert_int_equal(readings_of(run, "mute").count, 0);
    expect_err(run, "fathom: lost: attempts 15, failed 1, readings 14,");
    expect_err(run, "fathom: mute: attempts 20, failed 20, readings 0");
    expect_err(run, "fathom: fine: attempts 20, failed 0, readings 20,");
    assert_int_equal(count_of(run->err, "p0: unplugged. Waiting until it is back\n"), 1);
    assert_int_equal(count_of(run->err, "fathom: p0: it is back; reading goes on\n"), 1);
    assert_int_equal(count_of(run->err, "p0: "), 2);
    assert_int_equal(count_of(run->err, "p2"), 0);
    expect_err(run, "fathom: mute: attempt 20: no response from hps167s:1");
}

/* Rows of csv that begin with the name and have this status. */
static unsigned rows_of(const tool_run_t *run, const char *name, const char *status)
{
    unsigned count = 0;
    for (const char *line = run->out; *line != '\0'; line = strchr(line, '\n') + 1) {
        const char *const found = strstr(line, status);
        if (strncmp(line, name, strlen(name)) == 0 && found != NULL && found < strchr(line, '\n')) count++;
    }
    return count;
}

/* As above; a row for the loss, and one for each try in vain, at 2.7 and 3.7 s, of each sensor at that port. */
TEST(an_outage_is_rows_and_a_quiet_one_is_no_more)
{
    three();
    beside(0, (fathom_sim_hps167s_config_t){0});
    RUN(1, "read lost=hps167s@p0 both=hps167s:2@p0 mute=hps167s@p1 fine=hps167s@p2 --interval 500 "
           "--timeout 100 --duration 10 --reconnect --quiet --format csv");
    assert_int_equal(rows_of(run, "lost,", ",target,"), 5 + 9);
    assert_int_equal(rows_of(run, "lost,", "Z,port,,,,,,\n"), 3);
    assert_int_equal(rows_of(run, "both,", ",port,"), 3);
    assert_int_equal(rows_of(run, "mute,", ",no_response,"), 20);
    assert_int_equal(rows_of(run, "fine,", ",target,"), 20);
    assert_int_equal(count_of(run->out, "\n"), 1 + 14 + 3 + 14 + 3 + 20 + 20);
    assert_string_equal(run->err, "");
}

#define BOTH "lost=hps167s@p0 fine=hps167s@p2 "
TEST(each_way_to_lose_a_port_has_its_end)
{
    static const struct {
        uint64_t off_us, on_us; /* when p0 is away */
        const char *words;
        int status;
        unsigned lost, fine;        /* readings */
        uint64_t least_us, most_us; /* what it takes */
        const char *err;            /* parts of it, with | between them */
    } rows[] = {
        /* Without --reconnect the other one is read to its end: 11 intervals, and a response. */
        {2200000, 5000000, BOTH "--count 12 --stats", 1, 5, 12, 5500000, 5600000,
         "p0: unplugged. Connect it again and start again. With --reconnect, fathom waits for it\n|"
         "fathom: lost: attempts 6, failed 1, readings 5,|fathom: fine: attempts 12, failed 0, readings 12,"},
        /* When all are lost it ends. */
        {2200000, 5000000, "lost=hps167s@p0", 1, 5, 0, 2200000, 2210000, "unplugged"},
        /* A count is each sensor's own: 5 readings and the loss are all, so the port is not waited for. */
        {2200000, 5000000, BOTH "--count 6 --reconnect --stats", 1, 5, 6, 2500000, 2600000,
         "fathom: lost: attempts 6, failed 1, readings 5|fathom: fine: attempts 6, failed 0, readings 6|"
         "requests 11\n"},
        /* Not there at the beginning; tries at 0, 0.5, 1.5 and 3.5 s. */
        {0, 3000000, BOTH "--count 4 --stats", 1, 0, 4, 1500000, 1600000,
         "fathom: p0: no such device\n|fathom: lost: attempts 0, failed 0, readings 0\n"},
        {0, 3000000, BOTH "--count 8 --reconnect --stats", 0, 8, 8, 7000000, 7030000,
         "fathom: p0: no such device; waiting until it is there\n|"
         "fathom: p0: it is there; reading begins\n|fathom: requests 16\n"},
        /* A sensor that has said nothing is forgiven if its port has never come. */
        {0, 9000000, BOTH "--reconnect --duration 2", 0, 0, 4, 2000000, 2000000, "waiting"},
        {0, 0, "mute=a16:auto@p1 fine=hps167s@p2 --duration 2", 1, 0, 4, 2000000, 2000000, ""},
        /* These UARTs hold no break. */
        {0, 0, "fine=hps167s@p2 a16::controlled@p0 --count 3", 1, 0, 3, 1000000, 1100000, "fathom: a16: "},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        char parts[512];
        three();
        away(0, rows[i].on_us != 0 ? rows[i].off_us : 1, rows[i].on_us);
        RUN(rows[i].status, "read %s --interval 500", rows[i].words);
        assert_int_equal(readings_of(run, "lost").count, rows[i].lost);
        assert_int_equal(readings_of(run, "fine").count, rows[i].fine);
        assert_in_range(run->took_us, rows[i].least_us, rows[i].most_us);
        (void)strcpy(parts, rows[i].err);
        for (const char *part = strtok(parts, "|"); part != NULL; part = strtok(NULL, "|"))
            expect_err(run, part);
        if (rows[i].err[0] == '\0') assert_string_equal(run->err, "");
    }
}

TEST(when_none_is_there_it_ends)
{
    three();
    many.ports[0].is_away = many.ports[2].is_away = true;
    RUN(1, "read hps167s@p0 hps167s@p2 --interval 500");
    expect_err(run, "fathom: p0: no such device\nfathom: p2: no such device\n");
    assert_string_equal(run->out, "");
    assert_int_equal(run->took_us, 0);
}

TEST(ctrl_c_ends_it_while_one_is_waited_for)
{
    three();
    away(0, 0, 9000000);
    many.tool.ctrl_c_us = 3200000;
    RUN(0, "read " BOTH "--interval 500 --reconnect");
    assert_in_range(run->took_us, 3200000, 3210000);
    assert_int_equal(readings_of(run, "fine").count, 7); /* at 0 to 3 s */
}

TEST(both_sensors_of_a_lost_port_fail_and_it_is_told_once)
{
    three();
    beside(0, (fathom_sim_hps167s_config_t){0});
    RUN(1, "read hps167s:1@p0 hps167s:2@p0 fine=hps167s@p2 --interval 500 --count 6 --stats");
    expect_err(run, "fathom: hps167s:1: attempts 6, failed 1, readings 5");
    expect_err(run, "fathom: hps167s:2: attempts 6, failed 1, readings 5");
    expect_err(run, "fathom: fine: attempts 6, failed 0, readings 6");
    expect_err(run, "fathom: failures: port 2\n");
    assert_int_equal(count_of(run->err, "unplugged"), 1);
}

/* ---- of several kinds ---- */

TEST(each_port_has_its_own_settings_and_its_own_stations)
{
    ports(3);
    hps167s(0, (fathom_sim_hps167s_config_t){.address = 7, .baud_code = 2});
    hps167s(2, (fathom_sim_hps167s_config_t){0});
    beside(2, (fathom_sim_hps167s_config_t){0});
    fathom_sim_a16_init(&many.a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO,
                                                              .scene = fathom_sim_fixed(&many.scene)});
    fathom_sim_attach(&many.lines[1], &many.a16.device, many.clock.now_us);
    RUN(0, "read hps167s:7@p0,baud=57600 tank=a16@p1 hps167s:1@p2 hps167s:2@p2 --count 3 --stats");
    static const char *const names[] = {"hps167s:7", "tank", "hps167s:1", "hps167s:2"};
    for (size_t i = 0; i != 4; i++) assert_int_equal(readings_of(run, names[i]).count, 3);
    /* Of those that are asked and of the one that is not. */
    expect_err(run, "fathom: requests 9\n");
    expect_err(run, "fathom: stream: frames 3, bytes ");
    assert_int_equal(count_of(run->err, ", responses 3, response_min_us "), 3);
    assert_int_equal(count_of(run->err, "response_min_us"), 3);
}

/* One request leaves every 33 ms, and another one always waits behind it. */
TEST(a_line_on_which_a_request_always_waits_is_not_busy)
{
    ports(1);
    hps167s(0, (fathom_sim_hps167s_config_t){.no_auto_output = true});
    beside(0, (fathom_sim_hps167s_config_t){.no_auto_output = true});
    RUN(0, "read hps167s:1@p0 hps167s:2@p0 --duration 30 --stats");
    assert_true(readings_of(run, "hps167s:2").count > 400);
    expect_err(run, "failed 0, ");
}

TEST(a_silent_one_among_others_is_told_by_its_own_line)
{
    ports(2);
    hps167s(1, (fathom_sim_hps167s_config_t){0});
    RUN(1, "read mute=hps167s@p0 fine=hps167s@p1 --count 2 --interval 1000");
    /* Not "while others on this line answer", since they are on another one. */
    expect_err(
        run, "fathom: mute: attempt 1: no response from hps167s:1 at p0 (19200 8E1): no byte was received.");
}

TEST(two_hundred_and_fifty_six_ports_are_read_side_by_side)
{
    static char words[WORDS];
    size_t length = 0;
    ports(PORTS);
    for (size_t i = 0; i != PORTS; i++) {
        hps167s(i, (fathom_sim_hps167s_config_t){.seed = (uint32_t)i});
        length += (size_t)snprintf(words + length, sizeof words - length, " s%zu=hps167s@p%zu", i, i);
    }
    RUN(0, "read%s --count 3 --interval 100", words);
    for (size_t i = 0; i != PORTS; i++) {
        char name[NAMES];
        (void)snprintf(name, sizeof name, "s%zu", i);
        const readings_t one = readings_of(run, name);
        assert_int_equal(one.count, 3);
        assert_true(one.longest_s < 0.110);
    }
    assert_in_range(run->took_us, 200000, 250000);
}
