/* SPDX-License-Identifier: MIT */
/* fathom set, get and info: every setting that a device accepts is made, and what is said of it is so. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "sim/fault.h"

static int set_up(void **state)
{
    bench_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_sim_fault_t faults;

static const fathom_sim_hps167s_config_t any_hps167s;
static const fathom_sim_a16_config_t any_a16;

static const fathom_sim_counters_t *counters(void) { return &bench.hps167s.device.counters; }

/* Runs it: it ends so, and says this on its standard output or error. */
static void says(int status, const char *text, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", line);
    if (run->status != status || (strstr(run->out, text) == NULL && strstr(run->err, text) == NULL))
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
    assert_null(strstr(run->err, "cannot be a distance"));
}

/* The factory's HPS-167S, to whose frames from this one to the last `kind` happens. */
static void faulty(uint8_t kind, uint32_t first, uint32_t last)
{
    bench_begin();
    bench_hps167s(any_hps167s);
    fathom_sim_fault_init(&faults, 1);
    fathom_sim_fault_attach(&faults, &bench.line, &bench.hps167s.device);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&faults, kind, FATHOM_SIM_FAULT_ALWAYS_PPM, first);
    assert_non_null(rule);
    rule->run = last - first + 1;
}

/* Table 12 has no encoding of the rate, and the reconnect time that #2 tells may be any. */
TEST(an_hps167s_with_another_reconnect_time_and_baud_code_can_be_set)
{
    static const char *const settings[] = {"warm-up 0",          "warm-up 3",  "measure-after-power-on off",
                                           "termination off",    "address 7",  "reconnect-time 36",
                                           "distance-offset 10", "baud 115200"};
    for (size_t i = 0; i != sizeof settings / sizeof settings[0]; i++) {
        char line[80];
        bench_begin();
        bench_hps167s(
            (fathom_sim_hps167s_config_t){.reconnect_ms = 1000, .no_baud_code = true, .warm_up_s = 5});
        (void)snprintf(line, sizeof line, "set hps167s %s", settings[i]);
        bench.clock.now_us += 6000000;
        says(0, "", line);
        assert_int_equal(counters()->writes, 1);
    }
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.reconnect_ms = 1000, .no_baud_code = true});
    says(0, "\nbaud-code                  0\n", "info hps167s");
    says(0, "\nreconnect-time             1000 ms\n", "info hps167s");
}

TEST(what_it_had_is_unchanged)
{
    bench_hps167s(any_hps167s);
    says(0, "termination is on: unchanged\n", "set hps167s termination on");
    says(0, "\"written\":false,\"confirmed\":true,\"status\":\"unchanged\"",
         "set hps167s termination on --format json");
    assert_int_equal(counters()->flash_writes, 0);
}

TEST(without_a_response_nothing_was_written)
{
    says(1, "termination off: not written: no response", "set hps167s termination off");
    says(1, "\"written\":false,\"confirmed\":false,\"status\":\"not_written\"",
         "set hps167s termination off --format json");
    says(1, "filter-sensitivity 5: not written: no response", "set hps167s filter-sensitivity 5");
}

/* A faulted sensor that sends by itself: nothing can be made out between its packets at 54 Hz. */
TEST(of_a_setting_that_was_refused_nothing_is_claimed)
{
    faulty(FATHOM_SIM_FAULT_FUNCTION, 1, 60);
    says(1, "not written: ", "set hps167s termination off");
    assert_int_equal(counters()->writes, 0);
}

/* Frames 1 and 2 answer #2 for the user, 3 and 4 for the driver; 5 acknowledges. */
TEST(what_cannot_be_read_afterwards_is_not_confirmed)
{
    faulty(FATHOM_SIM_FAULT_SILENCE, 5, 60);
    says(1, "termination off: not confirmed: no acknowledgement was received. The value may be set or not",
         "set hps167s termination off");
    assert_false(bench.hps167s.termination);
    /* #1 is read before what is write-only */
    faulty(FATHOM_SIM_FAULT_SILENCE, 2, 60);
    says(1, "not confirmed: no acknowledgement was received", "set hps167s filter-sensitivity 5");
}

/* #9 holds from the next power-on here, and #2 tells nothing of it. */
TEST(what_was_acknowledged_and_reads_otherwise_is_said_to_be_so)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.no_baud_code = true, .baud_at_power_on = true});
    says(1, "baud 115200: differs: the sensor acknowledged the write, but it reads back another value",
         "set hps167s baud 115200");
    assert_int_equal(counters()->writes, 1);
}

TEST(an_offset_that_may_be_added_is_announced_and_not_claimed)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.offset_adds = true});
    says(0,
         "distance-offset: a sensor that has an offset already may add the new one to it. To check, measure ",
         "set hps167s distance-offset -15");
    says(0,
         "hps167s:1: distance-offset: -15 mm was written and acknowledged; the setting cannot be read back\n",
         "set hps167s distance-offset -15");
    assert_int_equal(bench.hps167s.user.offset_mm, -30);
}

TEST(the_address_of_an_hps167s_is_the_one_at_which_it_responds)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 9});
    says(0, "\naddress                    9\n", "get hps167s:9 address");
    says(0, "\"address\":9}\n", "get hps167s:9 address --format json");
    says(1, "no response from hps167s:8", "get hps167s:8 address");
}

TEST(a_refusal_is_a_refusal)
{
    faulty(FATHOM_SIM_FAULT_EXCEPTION, 5, 6);
    says(1, "termination off: refused: hps167s:1 at line (19200 8E1) refused the request: exception ",
         "set hps167s termination off");
}

TEST(info_fails_when_it_could_not_read_all)
{
    faulty(FATHOM_SIM_FAULT_SILENCE, 4, 60); /* #1, #3 twice, and then nothing */
    says(1, "fathom: hps167s:1: 7 of 10 values could not be read.\n", "info hps167s");
}

/* ---- blind ---- */

TEST(what_is_written_blind_is_written_once_and_not_confirmed)
{
    bench_hps167s(any_hps167s);
    says(0, "termination off: not confirmed\n", "set hps167s termination off --blind");
    assert_false(bench.hps167s.termination);
    assert_int_equal(counters()->requests, 1);
    says(0, "\"written\":true,\"confirmed\":false,\"status\":\"not_confirmed\"",
         "set hps167s termination on --blind --format json");
    bench_begin();
    bench_a16(any_a16);
    says(0, "not confirmed", "set a16 switch-threshold 2000 --blind");
    assert_int_equal(bench.a16.device.counters.requests, 1);
    bench_begin(); /* of a dead line that is not all that there is to say */
    says(1, "not confirmed: no acknowledgement was received", "set hps167s termination off --blind");
}

TEST(what_has_to_be_read_is_not_written_blind)
{
    bench_hps167s(any_hps167s);
    says(2, "distance-offset must be read before or after it is written.",
         "set hps167s distance-offset 5 --blind");
    says(2, "address must be read before or after it is written.", "set a16 address 5 --blind");
    says(2, "address must be read before or after it is written.", "set a05 address 5 --blind");
    says(2, "every-address must be read before or after it is written.", "set a05 every-address 5 --blind");
    assert_int_equal(counters()->requests, 0);
}

/* ---- all units ---- */

TEST(all_units_are_told_once_and_only_with_yes)
{
    static const char *const refused[] = {"set hps167s termination off --all-units",
                                          "set hps167s address 5 --all-units --yes",
                                          "set hps167s baud 57600 --all-units --yes",
                                          "set hps167s distance-offset 5 --all-units --yes",
                                          "set hps167s termination off --blind --all-units --yes",
                                          "set a16 switch-threshold 5 --all-units --yes"};
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 9});
    for (size_t i = 0; i != sizeof refused / sizeof refused[0]; i++) says(2, "--all-units", refused[i]);
    assert_int_equal(counters()->requests, 0);
    says(0, "all units: termination off: sent\n", "set hps167s termination off --all-units --yes");
    assert_false(bench.hps167s.termination);
    says(0,
         "\"address\":0,\"setting\":\"measure-after-power-on\",\"value\":false,\"was\":null,\"written\":true,"
         "\"confirmed\":false,\"status\":\"sent\"",
         "set hps167s measure-after-power-on off --all-units --yes --format json");
    assert_false(bench.hps167s.auto_output);
    assert_int_equal(counters()->requests, 2);
    assert_int_equal(counters()->answered, 0);
}

static int (*inner_write)(void *ctx, const uint8_t *bytes, size_t length);
static uint8_t sent_to_all[8][8];
static unsigned sent_count;

static int spy(void *ctx, const uint8_t *bytes, size_t length)
{
    const int n = inner_write(ctx, bytes, length);
    if (n > 0 && bytes[0] == 0 && length == 8) memcpy(sent_to_all[sent_count++ % 8], bytes, 8);
    return n;
}

/* All that the tool ever sends to unit 0; unit/test_broadcast.c has the same of the drivers. */
TEST(two_settings_are_all_that_the_tool_ever_sends_to_all_units)
{
    static const char *const commands[] = {"info hps167s",
                                           "info a16",
                                           "info a05",
                                           "info a05:1:dyp",
                                           "read hps167s --count 1",
                                           "read a16:1:modbus --count 1",
                                           "read a05:1:modbus --count 1",
                                           "read a05:1:dyp --count 1",
                                           "scan --address 1-2 --listen 1",
                                           "watch hps167s --duration 1",
                                           "set hps167s address 5",
                                           "set hps167s baud 57600",
                                           "set hps167s warm-up 1",
                                           "set hps167s measure-after-power-on off",
                                           "set hps167s termination off",
                                           "set hps167s reconnect-time 36",
                                           "set hps167s distance-offset 5",
                                           "set hps167s filter-sensitivity 5",
                                           "calibrate hps167s --known 2000",
                                           "set hps167s load-settings user",
                                           "set hps167s termination off --blind",
                                           "set hps167s measure-after-power-on off --all-units --yes",
                                           "set hps167s measure-after-power-on on --all-units --yes",
                                           "set hps167s termination off --all-units --yes",
                                           "set hps167s termination on --all-units --yes",
                                           "set a16 address 5",
                                           "set a16 switch-threshold 5",
                                           "set a16 switch-polarity negative",
                                           "set a16 automatic-value real-time",
                                           "set a16 automatic-output on",
                                           "set a16 operating-mode controlled",
                                           "set a05 address 5",
                                           "set a05 every-address 5",
                                           "reset hps167s --yes-restore-factory-settings",
                                           "reset hps167s --yes-load-factory-sensor-settings"};
    /* #10 and #11, tables 27 and 29 */
    static const uint8_t allowed[4][6] = {{0, 6, 0, 0x12, 0, 0x00},
                                          {0, 6, 0, 0x12, 0, 0xFF},
                                          {0, 6, 0, 0x13, 0, 0x00},
                                          {0, 6, 0, 0x13, 0, 0xFF}};
    sent_count = 0;
    for (size_t i = 0; i != sizeof commands / sizeof commands[0]; i++) {
        bench_begin();
        if (strstr(commands[i], "hps167s") != NULL) bench_hps167s(any_hps167s);
        if (strstr(commands[i], "a16") != NULL) bench_a16(any_a16);
        if (strstr(commands[i], "a05") != NULL)
            bench_a05((fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_DYP});
        inner_write = bench.tool.uart.write;
        bench.tool.uart.write = spy;
        const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", commands[i]);
        if (run->status == 2) fail_msg("%s\n%s", commands[i], run->err);
    }
    assert_int_equal(sent_count, 4);
    for (size_t i = 0; i != 4; i++) assert_memory_equal(sent_to_all[i], allowed[i], 6);
}
