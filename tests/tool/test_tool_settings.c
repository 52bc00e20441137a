/* SPDX-License-Identifier: MIT */
/* fathom set, get, info and reset: every setting that a device accepts is made, and what is said of it is so. */
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

/* ---- what is on the line ---- */

static const fathom_sim_hps167s_config_t any_hps167s;
static const fathom_sim_a16_config_t any_a16;
static const fathom_sim_a05_config_t any_a05;

static void nothing(void) {}
static void a16(void) { bench_a16(any_a16); }
static void a16_auto(void) { bench_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO}); }
static void a05(void) { bench_a05(any_a05); }
static void a05_dyp(void) { bench_a05((fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_DYP}); }
static void hps(void) { bench_hps167s(any_hps167s); }
static void hps_7(void) { bench_hps167s((fathom_sim_hps167s_config_t){.address = 7}); }
static void offset_adds(void) { bench_hps167s((fathom_sim_hps167s_config_t){.offset_adds = true}); }
static void crowded(void) { bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 12000}); }

static void a05_beside_an_a16(void)
{
    a05();
    bench_a16((fathom_sim_a16_config_t){.address = 5});
}

/* Table 12 has no encoding of the rate, and the reconnect time that #2 tells may be any. */
static void odd(void)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.reconnect_ms = 1000, .no_baud_code = true});
}

/* #9 holds from the next power-on here, and #2 tells nothing of it. */
static void baud_later(void)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.no_baud_code = true, .baud_at_power_on = true});
}

/* ---- what a command says and writes ---- */

typedef struct {
    void (*begin)(void);
    const char *line;
    int status;
    unsigned writes;
    const char *text; /* on standard output or error */
    const char *also; /* the same; NULL: none */
    uint8_t fault;    /* happens to the frames of the sensor from the first to the last; 0: none */
    uint8_t first;
    uint8_t last;
} row_t;

/* Of an HPS-167S frames 1 and 2 answer #2 for the user, 3 and 4 for the driver; 5 acknowledges. Of an A16 frame 1 answers
 * the user, 2 the driver; 3 acknowledges, 4 reads back. */
#define LOST(first_frame, last_frame)                                                                        \
    .fault = FATHOM_SIM_FAULT_SILENCE, .first = (first_frame), .last = (last_frame)

static void add_fault(const row_t *row)
{
    static fathom_sim_fault_t faults;
    const bool is_a16 = strstr(row->line, "a16") != NULL;
    fathom_sim_fault_init(&faults, 1);
    fathom_sim_fault_attach(&faults, &bench.line, is_a16 ? &bench.a16.device : &bench.hps167s.device);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&faults, row->fault, FATHOM_SIM_FAULT_ALWAYS_PPM, row->first);
    assert_non_null(rule);
    rule->run = row->last - row->first + 1u;
}

static unsigned writes(void)
{
    return bench.hps167s.device.counters.writes + bench.a16.device.counters.writes +
           bench.a05.device.counters.writes;
}

static bool is_said(const tool_run_t *run, const char *text)
{
    return text == NULL || strstr(run->out, text) != NULL || strstr(run->err, text) != NULL;
}

static void run_row(const row_t *row)
{
    bench_begin();
    row->begin();
    if (row->fault != 0) add_fault(row);
    const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", row->line);
    if (run->status != row->status || writes() != row->writes || !is_said(run, row->text) ||
        !is_said(run, row->also) || strstr(run->err, "cannot be a distance") != NULL)
        fail_msg("%s: exit status %d, %u writes\n%s%s", row->line, run->status, writes(), run->out, run->err);
}

/* A test of the rows above it. */
#define TEST_ROWS(name, rows)                                                                                \
    TEST(name)                                                                                               \
    {                                                                                                        \
        for (size_t i = 0; i != sizeof(rows) / sizeof(rows)[0]; i++) run_row(&(rows)[i]);                    \
    }

static const row_t shown[] = {
    /* the examples of #3; a temperature of 77 degrees Fahrenheit is (77 - 32) * 5 / 9 = 25.0 */
    {hps_7, "info hps167s:7 --format json", 0, 0,
     .text = "{\"name\":\"hps167s:7\",\"model\":\"hps167s\",\"mode\":\"modbus\",\"address\":7,"
             "\"line\":\"19200 8E1\",\"interface_version\":\"2.1.0 of 2020-09-27\","
             "\"sensor_version\":\"3.9 of 2019-09-23\",\"uuid\":\"00390025423457142034383501060705\","
             "\"temperature\":25.0,\"baud\":19200,\"baud_code\":1,\"warm_up\":0,"
             "\"measure_after_power_on\":true,\"termination\":true,\"reconnect_time\":180}\n"},
    {a16, "info a16 --format json", 0, 0,
     .text = "{\"name\":\"a16:1\",\"model\":\"a16\",\"mode\":\"modbus\",\"line\":\"9600 8N1\",\"address\":1,"
             "\"switch_polarity\":\"positive\",\"switch_threshold\":1000,"
             "\"automatic_value\":\"processed\",\"distance\":1234,\"real_time_distance\":1234}\n"},
    {a05, "info a05 --format json", 0, 0, .text = "\"distances\":\"1234, 1234, 1234, 1234\"}\n"},
    {odd, "info hps167s", 0, 0, .text = "\nbaud-code                  0\n",
     .also = "\nreconnect-time             1000 ms\n"},
    {hps, "info hps167s", 0, 0, .text = "\ntermination                on\n",
     .also = "in all but the last with 'fathom set"},
    {hps, "get hps167s", 0, 0, .text = "\ndistance-offset            - (write-only)\n",
     .also = "\nbaud                       19200\n"},
    {hps_7, "get hps167s:7 --format json", 0, 0,
     .text = "\"line\":\"19200 8E1\",\"address\":7,\"baud\":19200,\"warm_up\":0,"},
    {hps_7, "get hps167s:7 address", 0, 0, .text = "\naddress                    7\n"},
    {hps_7, "get hps167s:7 address --format json", 0, 0, .text = "\"address\":7}\n"},
    {hps_7, "get hps167s:8 address", 1, 0, .text = "no response from hps167s:8"},
    {hps, "get hps167s reconnect-time", 0, 0, .text = "\nreconnect-time             180 ms\n"},
    {crowded, "info hps167s", 1, 0, .text = "the sensor sends measurements without a request",
     .also = "setserial line low_latency"},
    {hps, "info hps167s", 1, 0, .text = "fathom: hps167s:1: 7 of 10 values could not be read.\n",
     LOST(4, 60)},
};
TEST_ROWS(info_and_get_print_what_a_sensor_has_and_write_nothing, shown)

static const row_t written[] = {
    {a16, "set a16 switch-polarity negative", 0, 1, .text = "switch-polarity is negative (was positive)\n"},
    {a16, "set a16 switch-threshold 2000", 0, 1, .text = "switch-threshold is 2000 mm (was 1000)\n"},
    {a16, "set a16 automatic-value real-time", 0, 1,
     .text = "automatic-value is real-time (was processed)\n"},
    {a16, "set a16 address 5", 0, 1, .text = "address is 5 (was 1)\n",
     .also = "from now on: fathom read a16:5:modbus --port line\n"},
    {a05, "set a05 address 5", 0, 1, .text = "address is 5 (was 1)\n",
     .also = "from now on: fathom read a05:5:modbus --port line\n"},
    {a05_dyp, "set a05 every-address 9", 0, 1, .text = "every-address is 9\n",
     .also = "fathom read a05:9:dyp --port line\n"},
    {odd, "set hps167s warm-up 3", 0, 1, .text = "warm-up is 3 s (was 0)\n"},
    {odd, "set hps167s measure-after-power-on off", 0, 1,
     .text = "measure-after-power-on is off from the next power-on (was on)\n"},
    {odd, "set hps167s termination off --format json", 0, 1,
     .text = "\"value\":false,\"was\":true,\"written\":true,\"confirmed\":true,\"status\":\"written\""},
    {odd, "set hps167s reconnect-time 36", 0, 1, .text = "reconnect-time is 36 ms (was 1000)\n"},
    {odd, "set hps167s address 7", 0, 1, .text = "address is 7\n",
     .also = "from now on: fathom read hps167s:7:modbus --port line\n"},
    {odd, "set hps167s baud 115200", 0, 1, .text = "baud is 115200 (was 19200)\n",
     .also = "from now on: fathom read hps167s:1:modbus --port line --baud 115200\n"},
};
TEST_ROWS(each_setting_that_can_be_read_is_written_once_and_read_back, written)

static const row_t unchanged[] = {
    {hps, "set hps167s termination on", 0, 0, .text = "termination is on: unchanged\n"},
    {hps, "set hps167s termination on --format json", 0, 0,
     .text = "\"written\":false,\"confirmed\":true,\"status\":\"unchanged\""},
    {a16, "set a16 switch-threshold 1000", 0, 0, .text = "switch-threshold is 1000 mm: unchanged\n"},
    {a05, "set a05 address 1", 0, 0, .text = "address is 1: unchanged\n"},
};
TEST_ROWS(what_it_had_is_unchanged, unchanged)

static const row_t acknowledged[] = {
    {hps, "set hps167s filter-sensitivity 50", 0, 1,
     .text =
         "hps167s:1: filter-sensitivity: 50 was written and acknowledged; the setting cannot be read back\n"},
    {hps, "set hps167s load-settings user", 0, 1, .text = "cannot be read back"},
    {a16, "set a16 operating-mode controlled", 0, 1, .text = "acknowledged"},
    {offset_adds, "set hps167s distance-offset -15", 0, 1,
     .text =
         "distance-offset: a sensor that has an offset already may add the new one to it. To check, measure ",
     .also = "hps167s:1: distance-offset: -15 mm was written and acknowledged; the setting cannot be read "
             "back\n"},
    {a16_auto, "set a16 automatic-output on", 0, 1, .text = "frames are received\n"},
    {a16, "set a16 automatic-output on", 1, 1,
     .text = "no frame was received in 10 s; only the RS232 variant sends automatically"},
};
TEST_ROWS(what_cannot_be_read_back_is_said_to_be_acknowledged, acknowledged)

static const row_t not_written[] = {
    {nothing, "set hps167s termination off", 1, 0, .text = "termination off: not written: no response"},
    {nothing, "set hps167s termination off --format json", 1, 0,
     .text = "\"written\":false,\"confirmed\":false,\"status\":\"not_written\""},
    {nothing, "set hps167s filter-sensitivity 5", 1, 0,
     .text = "filter-sensitivity 5: not written: no response"},
    /* A faulted sensor that sends by itself: nothing can be made out between its packets at 54 Hz. */
    {hps, "set hps167s termination off", 1, 0, .text = "not written: ", .fault = FATHOM_SIM_FAULT_FUNCTION,
     .first = 1, .last = 60},
    {a05_beside_an_a16, "set a05 address 5", 1, 0,
     .text = "not written: a sensor responds at address 5 already"},
    /* The command was run before. */
    {hps_7, "set hps167s address 7", 1, 0,
     .text = "fathom: hps167s:7: it responds, and nothing responds at address 1"},
    {hps_7, "set hps167s address 8", 1, 0, .text = "fathom: hps167s:1: address 8: not written: no response"},
    {a16, "set a16:5 address 1", 1, 0,
     .text = "fathom: a16:1: it responds, and nothing responds at address 5"},
};
TEST_ROWS(without_a_response_nothing_was_written, not_written)

static const row_t not_confirmed[] = {
    {hps, "set hps167s termination off", 1, 1,
     .text = "termination off: not confirmed: no acknowledgement was received. The value may be set or not",
     LOST(5, 60)},
    /* #1 is read before what is write-only */
    {hps, "set hps167s filter-sensitivity 5", 1, 1, .text = "not confirmed: no acknowledgement was received",
     LOST(2, 60)},
    {hps, "set hps167s baud 115200", 1, 1,
     .text = "The sensor is at 19200 or at 115200 baud, perhaps from its next power-on",
     .also = "'fathom scan --port line --baud 19200,115200'", LOST(5, 60)},
    {a16, "set a16 address 5", 1, 1, .text = "The sensor is at address 1 or at address 5", LOST(3, 20)},
    {a16, "set a16 switch-threshold 2000", 0, 1, .text = "2000 mm (was 1000)", LOST(3, 3)},
    {a16, "set a16 switch-threshold 2000", 1, 1, .text = "The value may be set or not", LOST(3, 4)},
    {hps, "set hps167s termination off", 1, 1,
     .text = "termination off: refused: hps167s:1 at line (19200 8E1) refused the request: exception ",
     .fault = FATHOM_SIM_FAULT_EXCEPTION, .first = 5, .last = 6},
    {baud_later, "set hps167s baud 115200", 1, 1,
     .text = "baud 115200: differs: the sensor acknowledged the write, but it reads back another value"},
};
TEST_ROWS(what_is_not_confirmed_is_said_to_be_so, not_confirmed)

static const row_t resets[] = {
    {hps_7, "reset hps167s:7 interface --yes", 0, 0, .text = "address 1, 19200 8E1, termination on"},
    {hps, "reset hps167s sensor --yes", 0, 1, .text = "acknowledged"},
    {hps_7, "reset hps167s:7 interface --yes", 1, 0,
     .text = "It is at address 1, 19200 8E1, or still at address 7, 19200 8E1", LOST(3, 30)},
};
TEST_ROWS(a_reset_is_confirmed_or_names_both_places, resets)

TEST(an_address_of_0_needs_a_confirmation_and_can_be_read_but_not_set)
{
    for (int is_a05 = 0; is_a05 != 2; is_a05++) {
        const char *const sensor = is_a05 != 0 ? "a05" : "a16";
        bench_begin();
        (is_a05 != 0 ? a05 : a16)();
        ASSERT_RUN(2, "set %s --port line address 0", sensor);
        ASSERT_RUN(0, "set %s --port line address 0 --may-not-be-found-again", sensor);
        const tool_run_t *run = tool_run(&bench.tool, "info %s:0 --port line", sensor);
        assert_non_null(strstr(run->out, "\naddress                    0\n"));
        ASSERT_RUN(0, "read %s:0 --port line --count 1", sensor);
        run = tool_run(&bench.tool, "scan --address 0 --baud 9600 --listen 1 --timeout 1000 --port line");
        assert_memory_equal(run->out, sensor, 3);
        assert_non_null(strstr(run->out, " address 0 "));
        ASSERT_RUN(2, "set %s:0 --port line address 1", sensor);
        assert_int_equal(writes(), 1);
    }
}

/* ---- blind ---- */

static const row_t blind[] = {
    {hps, "set hps167s termination off --blind", 0, 1, .text = "hps167s:1: termination off: not confirmed\n"},
    {hps, "set hps167s termination on --blind --format json", 0, 1,
     .text = "\"written\":true,\"confirmed\":false,\"status\":\"not_confirmed\""},
    {a16, "set a16 switch-threshold 2000 --blind", 0, 1, .text = "not confirmed"},
    /* of a dead line that is not all that there is to say */
    {nothing, "set hps167s termination off --blind", 1, 0,
     .text = "not confirmed: no acknowledgement was received"},
    {hps, "set hps167s distance-offset 5 --blind", 2, 0,
     .text = "distance-offset must be read before or after it is written."},
    {a16, "set a16 address 5 --blind", 2, 0, .text = "address must be read before or after it is written."},
    {a05, "set a05 address 5 --blind", 2, 0, .text = "address must be read before or after it is written."},
    {a05, "set a05 every-address 5 --blind", 2, 0,
     .text = "every-address must be read before or after it is written."},
};
TEST_ROWS(what_is_written_blind_is_written_once_and_not_confirmed, blind)

TEST(a_blind_setting_is_one_request)
{
    hps();
    ASSERT_RUN(0, "set hps167s termination off --blind --port line");
    assert_false(bench.hps167s.termination);
    assert_int_equal(bench.hps167s.device.counters.requests, 1);
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
    const fathom_sim_counters_t *const counters = &bench.hps167s.device.counters;
    for (size_t i = 0; i != sizeof refused / sizeof refused[0]; i++) {
        const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", refused[i]);
        assert_int_equal(run->status, 2);
        assert_non_null(strstr(run->err, "--all-units"));
    }
    assert_int_equal(counters->requests, 0);
    const tool_run_t *run =
        tool_run(&bench.tool, "set hps167s termination off --all-units --yes --port line");
    assert_string_equal(run->out, "all units: termination off: sent\n");
    assert_false(bench.hps167s.termination);
    run = tool_run(&bench.tool,
                   "set hps167s measure-after-power-on off --all-units --yes --format json --port line");
    assert_non_null(strstr(run->out,
                           "\"address\":0,\"setting\":\"measure-after-power-on\",\"value\":false,"
                           "\"was\":null,\"written\":true,\"confirmed\":false,\"status\":\"sent\""));
    assert_false(bench.hps167s.auto_output);
    assert_int_equal(counters->requests, 2);
    assert_int_equal(counters->answered, 0);
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
    static const char *const commands[] = {
        "info hps167s",
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
        "reset hps167s --yes-load-factory-sensor-settings",
    };
    /* #10 and #11, tables 27 and 29 */
    static const uint8_t allowed[4][6] = {{0, 6, 0, 0x12, 0, 0x00},
                                          {0, 6, 0, 0x12, 0, 0xFF},
                                          {0, 6, 0, 0x13, 0, 0x00},
                                          {0, 6, 0, 0x13, 0, 0xFF}};
    sent_count = 0;
    for (size_t i = 0; i != sizeof commands / sizeof commands[0]; i++) {
        bench_begin();
        if (strstr(commands[i], "hps167s") != NULL) hps();
        if (strstr(commands[i], "a16") != NULL) a16();
        if (strstr(commands[i], "a05") != NULL) a05_dyp();
        inner_write = bench.tool.uart.write;
        bench.tool.uart.write = spy;
        const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", commands[i]);
        if (run->status == 2) fail_msg("%s\n%s", commands[i], run->err);
    }
    assert_int_equal(sent_count, 4);
    for (size_t i = 0; i != 4; i++) assert_memory_equal(sent_to_all[i], allowed[i], 6);
}
