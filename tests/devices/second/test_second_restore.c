/* SPDX-License-Identifier: MIT */
/* fathom save and fathom restore --as-new at devices of which each has made its own choices: what they say against the
 * device's own log. */
#include "second_judge.h"

#include <stdlib.h>
#include <string.h>

#include "backup_desk.h"
#include "tool_run.h"

static int set_up(void **state)
{
    desk_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = desk_end};

enum { ROWS = 8 };

/* What the file is changed to. */
typedef struct {
    const char *name;
    const char *value;
    uint16_t reg;
    int64_t number;
} wish_t;

static rig_t rig;
static const tool_run_t *run;
static struct {
    unsigned runs, saved, restored, written, confirmed, wrong;
} sums;
static bool is_confirmed[ROWS]; /* by a run before */

static void idle(void *ctx, uint32_t max_us) { rig_pass(ctx, max_us); }

/* Where the device is now. */
static void tool(const char *command, const char *sensor, const char *more)
{
    const tool_line_t line = {.uart = rig.uart, .clock = rig.clock, .idle = idle, .ctx = &rig};
    const second_state_t state = second_state(&rig.device);
    rig_wait(&rig, 1000000);
    run = tool_run(&line, "%s %s:%u --port line --baud %u --file %s %s", command, sensor, state.address,
                   state.line.baud, desk_path("unit"), more);
    assert_in_range(run->status, 0, 1);
    if (getenv("FATHOM_SEED") != NULL)
        print_message("$ %s %s -> %d\n%s%s", command, sensor, run->status, run->out, run->err);
}

static void finding(const char *what, const char *name)
{
    if (getenv("FATHOM_SEED") != NULL)
        print_message("kind %d seed %u: %s: %s\n%s%s\n", (int)rig.device.config.kind,
                      (unsigned)rig.device.config.seed, name, what, run->out, run->err);
    sums.wrong++;
}

static bool says(const char *text)
{
    return strstr(run->out, text) != NULL || strstr(run->err, text) != NULL;
}

/* ---- save ---- */

/* Is a value that the file has what the device tells? */
static void check_saved(const char *text, const char *name, int64_t value, const char *if_0,
                        const char *if_not)
{
    char key[48], expected[64];
    (void)snprintf(key, sizeof key, "\n%s = ", name);
    const char *const at = strstr(text, key);
    if (if_0 == NULL)
        (void)snprintf(expected, sizeof expected, "%lld ", (long long)value);
    else
        (void)snprintf(expected, sizeof expected, "%s ", value == 0 ? if_0 : if_not);
    if (at == NULL || strncmp(at + strlen(key), "not ", 4) == 0) return;
    if (strncmp(at + strlen(key), expected, strlen(expected)) != 0)
        finding("the file has another value", name);
}

static bool save(const char *sensor)
{
    char text[DESK_TEXT];
    const uint32_t writes = rig.writes;
    tool("save", sensor, "");
    if (rig.writes != writes) finding("it has written", "save");
    if ((desk_count() == 1) != (run->status == 0)) finding("a file without a save, or the other way", "save");
    if (run->status != 0) return false;
    (void)desk_read("unit", text);
    check_saved(text, "address", second_state(&rig.device).address, NULL, NULL);
    check_saved(text, "switch-polarity", judge_held(0x0205), "negative", "positive");
    check_saved(text, "switch-threshold", judge_held(0x0206), NULL, NULL);
    check_saved(text, "automatic-value", judge_held(0x0207), "processed", "real-time");
    check_saved(text, "warm-up", judge_told_value(0x0A), NULL, NULL);
    check_saved(text, "measure-after-power-on", judge_told_value(0x12), "off", "on");
    check_saved(text, "termination", judge_told_value(0x13), "off", "on");
    return true;
}

/* The file with these values, where it has one. */
static void change(const wish_t *wishes, size_t count)
{
    static char text[DESK_TEXT];
    static char changed[DESK_TEXT];
    (void)desk_read("unit", text);
    for (size_t i = 0; i < count; i++) {
        char key[48];
        (void)snprintf(key, sizeof key, "\n%s = ", wishes[i].name);
        const char *const at = strstr(text, key);
        if (at == NULL || strncmp(at + strlen(key), "not ", 4) == 0) continue;
        const int length = snprintf(changed, sizeof changed, "%.*s%s%s%s", (int)(at - text), text, key,
                                    wishes[i].value, strchr(at + 1, '\n'));
        assert_in_range(length, 1, sizeof changed - 1);
        memcpy(text, changed, sizeof text);
    }
    desk_write("unit", text);
}

/* ---- restore ---- */

/* How often the device has taken this since then. */
static unsigned settings_of(uint16_t reg, uint64_t since)
{
    unsigned count = 0;
    for (uint64_t i = since; i < second_log_count(&rig.device); i++) {
        const second_event_t *const event = second_log_at(&rig.device, i);
        if (event != NULL && event->kind == SECOND_EVENT_SETTING && event->reg == reg) count++;
    }
    return count;
}

/* "a16:1: NAME is VALUE": it is made, and read back. */
static bool is_made(const wish_t *wish)
{
    char text[80];
    (void)snprintf(text, sizeof text, ": %s is %s", wish->name, wish->value);
    return strstr(run->out, text) != NULL;
}

/* "a16:1: NAME VALUE: not confirmed", "differs" or "refused": a write that failed, or whose effect is unknown. */
static bool is_sent(const wish_t *wish)
{
    char text[80];
    (void)snprintf(text, sizeof text, ": %s %s: ", wish->name, wish->value);
    const char *const at = strstr(run->err, text);
    return at != NULL && strncmp(at + strlen(text), "not written", 11) != 0;
}

static void check_row(const wish_t *wish, size_t n, uint64_t since)
{
    const bool made = is_made(wish);
    const bool is_later = made && says(" from the next power-on (");
    const bool holds = judge_held(wish->reg) == wish->number;
    const unsigned taken = settings_of(wish->reg, since);
    if (taken > 1) finding("taken more than once", wish->name);
    if (taken > 0 && !made && !is_sent(wish)) finding("taken, and nothing is said of it", wish->name);
    if (made && !is_later && !holds) finding("made, and it does not hold", wish->name);
    if (is_confirmed[n] && (made || is_sent(wish))) finding("written again", wish->name);
    if (made) is_confirmed[n] = true;
    sums.confirmed += made;
}

static void restore(const char *sensor, const wish_t *wishes, size_t count)
{
    const uint64_t since = second_log_count(&rig.device);
    const uint32_t writes = rig.writes;
    const second_state_t was = second_state(&rig.device);
    unsigned announced = 0;
    tool("restore", sensor, "--as-new");
    const second_state_t is = second_state(&rig.device);
    for (size_t i = 0; i < count; i++) {
        announced += is_made(&wishes[i]) || is_sent(&wishes[i]);
        check_row(&wishes[i], i, since);
    }
    if (rig.writes - writes != announced) finding("other writes than it says", "restore");
    if (is.flash_writes - was.flash_writes > announced)
        finding("the flash was written more often", "restore");
    const bool may_move =
        says("address is 3") || says("address 3: not confirmed") || says("address 3: differs");
    const bool may_change =
        says("baud is 57600") || says("baud 57600: not confirmed") || says("baud 57600: differs");
    if (is.address != was.address && !(is.address == 3 && may_move))
        finding("it is nowhere that was said", "address");
    if (is.line.baud != was.line.baud && !(is.line.baud == 57600 && may_change))
        finding("it is nowhere that was said", "baud");
    if (says("address is 3") && is.address != 3) finding("it is not where it is said to be", "address");
    if (says("baud is 57600 (was") && is.line.baud != 57600)
        finding("it is not where it is said to be", "baud");
    if (run->status == 0 && (says("address is 3") || says("baud is 57600")) &&
        !says(": responds at the new place, "))
        finding("moved, and not looked at again", "restore");
    if (run->status == 0 && announced == 0 && !says("no differences"))
        finding("success of nothing", "restore");
    if (run->status != 0 && !says("nothing was written") && !says("stopped at ") &&
        !says("all differences are written"))
        finding("it does not say how it ended", "restore");
    if (rig.to_all != 0) finding("a write to all units", "restore");
    sums.written += announced;
    sums.restored += run->status == 0;
}

static void live(second_kind_t kind, const char *sensor, const wish_t *wishes, size_t count,
                 unsigned good_of_100)
{
    const char *const from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    const uint64_t last = from != NULL ? seed : suite_is_long ? 1000 : 200;
    assert_true(count <= ROWS);
    memset(&sums, 0, sizeof sums);
    judge = (judge_t){.rig = &rig};
    for (; seed <= last; seed++) {
        second_config_t config = {.kind = kind, .seed = seed, .scene = {{1234, 2000, 1953, 3562}}};
        rig_open(&rig, &config);
        rig.has_stamps = false; /* the tool has a clock of its own */
        rig_power(&rig, true);
        rig_wait(&rig, 12000000);
        memset(is_confirmed, 0, sizeof is_confirmed);
        sums.runs++;
        if (!save(sensor)) continue;
        sums.saved++;
        change(wishes, count);
        restore(sensor, wishes, count);
        if (run->status != 0) restore(sensor, wishes, count);
        desk_remove("unit");
    }
    print_message("%u devices, %u saved, %u restored, %u settings written and %u confirmed, %u wrong\n",
                  sums.runs, sums.saved, sums.restored, sums.written, sums.confirmed, sums.wrong);
    assert_int_equal(sums.wrong, 0);
    assert_true(sums.restored * 100 >= sums.runs * good_of_100);
}

#define LIVE(kind, sensor, wishes, good_of_100)                                                              \
    live(kind, sensor, wishes, sizeof(wishes) / sizeof(wishes)[0], good_of_100)

static const wish_t of_a16[] = {{"switch-polarity", "negative", 0x0205, 0},
                                {"switch-threshold", "2000", 0x0206, 2000},
                                {"automatic-value", "real-time", 0x0207, 1},
                                {"address", "3", 0x0200, 3}};
static const wish_t of_a05[] = {{"address", "3", 0x0200, 3}};
static const wish_t of_hps167s[] = {{"warm-up", "3", 0x0A, 3},
                                    {"measure-after-power-on", "off", 0x12, 0},
                                    {"termination", "off", 0x13, 0},
                                    {"address", "3", 0x10, 3},
                                    {"baud", "57600", 0x11, 2}};

TEST(restore_a16_rs232) { LIVE(SECOND_A16_RS232, "a16", of_a16, 50); }
TEST(restore_a16_rs485) { LIVE(SECOND_A16_RS485, "a16", of_a16, 40); }
TEST(restore_a05_uart) { LIVE(SECOND_A05_UART, "a05", of_a05, 30); }
TEST(restore_a05_rs485) { LIVE(SECOND_A05_RS485, "a05", of_a05, 60); }
TEST(restore_hps167s) { LIVE(SECOND_HPS167S, "hps167s", of_hps167s, 35); }
