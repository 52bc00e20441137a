/* SPDX-License-Identifier: MIT */
/* Every command of the tool against devices of which each has made its own choices: its exit status and its statements
 * against the device's own log. */
#include "second_judge.h"

#include <stdlib.h>
#include <string.h>

#include "tool_run.h"

static rig_t rig;
static const tool_run_t *run;

static void idle(void *ctx, uint32_t max_us) { rig_pass(ctx, max_us); }

/* Runs "fathom COMMAND SENSOR:ADDRESS[MODE] --port line MORE", a second after the one before; mode NULL: without an
 * address, so in the sensor's first mode. */
static void tool(const char *command, const char *sensor, const char *mode, const char *more)
{
    const tool_line_t line = {.uart = rig.uart, .clock = rig.clock, .idle = idle, .ctx = &rig};
    const second_state_t state = second_state(&rig.device);
    char which[16] = "";
    if (mode != NULL) (void)snprintf(which, sizeof which, ":%u%s", state.address, mode);
    if (strcmp(command, "scan") == 0)
        run = tool_run(&line, "scan --port line %s", more);
    else
        run = tool_run(&line, "%s %s%s --port line --baud %u %s", command, sensor, which, state.line.baud,
                       more);
    assert_in_range(run->status, 0, 1);
    if (getenv("FATHOM_SEED") != NULL)
        print_message("$ %s %s%s %s -> %d\n%s%s", command, sensor, which, more, run->status, run->out,
                      run->err);
}

static void begin(const char *name)
{
    rig_wait(&rig, 1000000);
    judge_begin(name);
}

static bool says(const char *text)
{
    return strstr(run->out, text) != NULL || strstr(run->err, text) != NULL;
}

/* Values that were printed as raw were sent. */
static void read_some(const char *name, const char *sensor, const char *mode, const char *more)
{
    bool is_right = true;
    begin(name);
    char line[64];
    (void)snprintf(line, sizeof line, "%s --format json --duration 40", more);
    tool("read", sensor, mode, line);
    for (const char *at = strstr(run->out, "\"raw\":"); at != NULL; at = strstr(at + 1, "\"raw\":"))
        if (at[6] != 'n') /* null: the row of a failure */
            is_right = judge_was_sent((uint16_t)strtoul(at + 6, NULL, 10)) && is_right;
    judge_done(run->status == 0, is_right);
}

/* What is told of a setting, if it is told, is what the device has: a number, or one of two words. */
static bool tells(const char *name, int64_t held, const char *if_0, const char *if_not)
{
    char key[64], value[64];
    (void)snprintf(key, sizeof key, "\"%s\":", name);
    if (if_0 == NULL)
        (void)snprintf(value, sizeof value, "%lld,", (long long)held);
    else
        (void)snprintf(value, sizeof value, "%s,", held == 0 ? if_0 : if_not);
    const char *at = strstr(run->out, key);
    if (at == NULL || strncmp(at + strlen(key), "null", 4) == 0) return true;
    return strncmp(at + strlen(key), value, strlen(value) - 1) == 0;
}

static void ask(const char *name, const char *command, const char *sensor, const char *mode, const char *more)
{
    begin(name);
    tool(command, sensor, mode, more);
    judge_done(run->status == 0,
               tells("address", rig.device.address, NULL, NULL) &&
                   tells("switch_polarity", judge_held(0x0205), "\"negative\"", "\"positive\"") &&
                   tells("switch_threshold", judge_held(0x0206), NULL, NULL) &&
                   tells("automatic_value", judge_held(0x0207), "\"processed\"", "\"real-time\"") &&
                   tells("warm_up", judge_told_value(0x0A), NULL, NULL) &&
                   tells("measure_after_power_on", judge_told_value(0x12), "false", "true") &&
                   tells("termination", judge_told_value(0x13), "false", "true"));
}

/* What is found is what is there. */
static void scan(const char *sensor)
{
    begin("scan");
    tool("scan", sensor, "", "--address 1-3 --format json");
    bool is_other = (says("\"a16\"") && strcmp(sensor, "a16") != 0) ||
                    (says("\"a05\"") && strcmp(sensor, "a05") != 0) ||
                    (says("\"hps167s\"") && strcmp(sensor, "hps167s") != 0);
    judge_done(run->status == 0, !is_other);
}

typedef struct {
    const char *words; /* the setting and its value */
    wanted_t wanted;
} tool_set_t;

static report_t report(void)
{
    return (report_t){.made = run->status == 0,
                      .not_written = says("not written") || says("nothing was written") ||
                                     says("nothing was sent") || says("unchanged"),
                      .not_confirmed = says("not confirmed") || says("was sent"),
                      .otherwise = says("differs"),
                      .refused = !says("not written") && !says("nothing was written") && says("refused")};
}

static void set(const char *sensor, const char *mode, const tool_set_t *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        begin(rows[i].words);
        tool("set", sensor, mode, rows[i].words);
        judge_report(report(), rows[i].wanted);
    }
}

static void a16(void)
{
    const tool_set_t rows[] = {{"switch-polarity negative", HOLDS(0x0205, 0)},
                               {"switch-threshold 2000", HOLDS(0x0206, 2000)},
                               {"automatic-value real-time", HOLDS(0x0207, 1)},
                               {"operating-mode automatic", ACKNOWLEDGED(0x0202, 1)},
                               {"automatic-output on", ACKNOWLEDGED(0x0202, 1)},
                               {"address 3", HOLDS(0x0200, 3)}};
    scan("a16");
    if (rig.device.config.kind == SECOND_A16_RS232) read_some("read a16", "a16", NULL, "--count 4");
    read_some("read a16:1:modbus", "a16", ":modbus", "--count 4");
    read_some("read a16:1:modbus --value", "a16", ":modbus", "--value real-time --count 4");
    ask("info a16", "info", "a16", ":modbus", "--format json");
    ask("get a16 switch-threshold", "get", "a16", "", "switch-threshold --format json");
    ask("get a16 real-time-distance", "get", "a16", "", "real-time-distance");
    set("a16", "", rows, sizeof rows / sizeof rows[0]);
    ask("watch a16", "watch", "a16", ":modbus", "--duration 3");
    ask("info a16", "info", "a16", ":modbus", "");
}

static void a16_auto(void)
{
    scan("a16");
    read_some("read a16", "a16", NULL, "--count 6");
    ask("watch a16", "watch", "a16", NULL, "--duration 4");
}

static void a16_controlled(void) { read_some("read a16:1:controlled", "a16", ":controlled", "--count 6"); }

static void a05(void)
{
    const tool_set_t rows[] = {{"address 3", HOLDS(0x0200, 3)}};
    scan("a05");
    if (rig.device.config.kind == SECOND_A05_UART) read_some("read a05", "a05", NULL, "--count 3");
    read_some("read a05:1:modbus", "a05", ":modbus", "--count 3");
    ask("info a05", "info", "a05", "", "--format json");
    ask("watch a05", "watch", "a05", ":modbus", "--duration 3");
    set("a05", "", rows, 1);
    if (rig.device.config.kind != SECOND_A05_RS485) return;
    const tool_set_t dyp[] = {{"every-address 2", HOLDS(0xAA03, 2)}};
    read_some("read a05:1:dyp", "a05", ":dyp", "--count 3");
    set("a05", ":dyp", dyp, 1);
}

static void hps167s(void)
{
    const tool_set_t rows[] = {{"warm-up 3", HOLDS(0x0A, 3)},
                               {"measure-after-power-on off", HOLDS(0x12, 0)},
                               {"termination off", HOLDS(0x13, 0)},
                               {"distance-offset -15", ACKNOWLEDGED(0x14, -15)},
                               {"filter-sensitivity 20", ACKNOWLEDGED(0x16, 20)},
                               {"load-settings user", ACKNOWLEDGED(0x15, 0)},
                               {"address 3", HOLDS(0x10, 3)},
                               {"baud 57600", HOLDS(0x11, 2)}};
    /* before the first request, which may end that */
    if (rig.device.automatic) read_some("read hps167s:1:auto", "hps167s", ":auto", "--count 6");
    scan("hps167s");
    read_some("read hps167s", "hps167s", "", "--count 6");
    read_some("read hps167s --temperature", "hps167s", "", "--temperature=1 --count 99");
    ask("info hps167s", "info", "hps167s", "", "--format json --retries 2");
    ask("get hps167s termination", "get", "hps167s", "", "termination --format json --retries 2");
    set("hps167s", "", rows, sizeof rows / sizeof rows[0]);
    ask("watch hps167s", "watch", "hps167s", "", "--duration 2");
    begin("reset hps167s");
    tool("reset", "hps167s", "", "--yes-restore-factory-settings");
    judge_report(report(), ACKNOWLEDGED(0x10, 1));
}

static void live(second_kind_t kind, void (*life)(void), unsigned good_of_100)
{
    const char *from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    uint64_t last = from != NULL ? seed : suite_is_long ? 1000 : 30;
    judge = (judge_t){.rig = &rig};
    for (; seed <= last; seed++) {
        second_config_t config = {.kind = kind, .seed = seed, .scene = {{1234, 2000, 1953, 3562}}};
        rig_open(&rig, &config);
        rig.has_stamps = false; /* the tool has a clock of its own */
        rig_power(&rig, true);
        rig_wait(&rig, 12000000);
        life();
        if (rig.to_all > 0) judge.wrong++;
    }
    judge_end(good_of_100);
}

TEST(tool_a16_auto) { live(SECOND_A16_AUTO, a16_auto, 80); }
TEST(tool_a16_controlled) { live(SECOND_A16_CONTROLLED, a16_controlled, 80); }
TEST(tool_a16_rs232) { live(SECOND_A16_RS232, a16, 60); }
TEST(tool_a16_rs485) { live(SECOND_A16_RS485, a16, 45); }
TEST(tool_a05_uart) { live(SECOND_A05_UART, a05, 50); }
TEST(tool_a05_rs485) { live(SECOND_A05_RS485, a05, 80); }
TEST(tool_hps167s) { live(SECOND_HPS167S, hps167s, 65); }
