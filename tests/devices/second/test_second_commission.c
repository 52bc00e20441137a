/* SPDX-License-Identifier: MIT */
/* fathom commission against devices of which each has made its own choices, ended at some time or not, and taken up
 * again after a power-on: where the device is was said, and nothing was written that was not announced. */
#include "second_judge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tool_run.h"

enum { NEW = 3, SECOND = 1000000 };

static rig_t rig;
static char record[64];
static unsigned announced; /* writes to this device */

static void idle(void *ctx, uint32_t max_us) { rig_pass(ctx, max_us); }

/* What of the record is about the new address: NULL: nothing. */
static const char *recorded(void)
{
    static char text[1024];
    FILE *const file = fopen(record, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    const char *const at = strstr(text, " 3 ");
    return at;
}

static void wrong(const tool_run_t *run, const char *what)
{
    print_message("seed %u: %s; exit status %d\n%s%s", (unsigned)rig.device.config.seed, what, run->status,
                  run->out, run->err);
    judge.wrong++;
}

/* One run, and whether what it said is so. */
static bool is_commissioned(const char *sensor, uint64_t ctrl_c_us)
{
    const tool_line_t line = {
        .uart = rig.uart, .clock = rig.clock, .idle = idle, .ctx = &rig, .ctrl_c_us = ctrl_c_us};
    const char *const none = strcmp(sensor, "hps167s") == 0 ? "--terminated none" : "";
    const tool_run_t *const run =
        tool_run(&line, "commission %s --port line --addresses %d --record %s --wait 30 %s", sensor, NEW,
                 record, none);
    for (const char *at = run->out; (at = strstr(at, "  writes ")) != NULL; at++) announced++;
    if (getenv("FATHOM_SEED") != NULL) print_message("-> %d\n%s%s", run->status, run->out, run->err);
    const second_state_t state = second_state(&rig.device);
    const char *const at = recorded();
    if (rig.writes > announced || state.flash_writes > announced) wrong(run, "written more than announced");
    if (rig.to_all != 0) wrong(run, "written to all");
    if (state.address != 1 && state.address != NEW) wrong(run, "somewhere else");
    if (state.address == NEW && at == NULL) wrong(run, "moved without a line in the record");
    if (state.flash_writes != 0 && at == NULL) wrong(run, "written without a line in the record");
    if (run->status != 0) return false;
    if (state.address != NEW) wrong(run, "not done");
    if (at == NULL || strstr(at, " done ") == NULL) wrong(run, "not in the record");
    if (none[0] != '\0' && judge_held(0x0013) != 0) wrong(run, "the termination is on");
    return true;
}

/* good_of_100: so many are done in the end; at_once: without a power-on. */
static void live(second_kind_t kind, const char *sensor, unsigned good_of_100, unsigned at_once)
{
    const char *const from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    const uint64_t last = from != NULL ? seed : 199;
    unsigned done = 0;
    unsigned first = 0;
    judge = (judge_t){.rig = &rig};
    (void)snprintf(record, sizeof record, "%s/fathom-second-%d.txt",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", (int)getpid());
    for (; seed <= last; seed++) {
        const second_config_t config = {.kind = kind, .seed = seed, .scene = {{1234, 2000, 1953, 3562}}};
        const uint64_t ctrl_c_us = seed % 2 == 0 ? 0 : (1 + seed * 7 % 12) * SECOND + seed * 997;
        announced = 0;
        (void)unlink(record);
        rig_open(&rig, &config);
        rig.has_stamps = false; /* the tool has a clock of its own */
        rig_power(&rig, true);
        rig_wait(&rig, 12 * SECOND);
        bool is_done = is_commissioned(sensor, ctrl_c_us);
        if (!is_done && ctrl_c_us != 0) is_done = is_commissioned(sensor, 0);
        first += is_done;
        for (int i = 0; i != 2 && !is_done; i++) {
            rig_restart(&rig, SECOND, 12 * SECOND);
            is_done = is_commissioned(sensor, 0);
        }
        done += is_done;
    }
    (void)unlink(record);
    assert_int_equal(judge.wrong, 0);
    if (from != NULL) return;
    assert_in_range(first, at_once * 2, 200);
    assert_in_range(done, good_of_100 * 2, 200);
}

TEST(commission_hps167s) { live(SECOND_HPS167S, "hps167s", 54, 30); }
TEST(commission_a16_rs485) { live(SECOND_A16_RS485, "a16", 98, 65); }
TEST(commission_a05_rs485) { live(SECOND_A05_RS485, "a05", 98, 65); }
