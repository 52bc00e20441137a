/* SPDX-License-Identifier: MIT */
/* fathom save and fathom restore: a file has what the unit has, a unit gets what the file has, and nothing is written
 * that need not be. Each mistake in a file that a person has edited is reported with its line, and nothing is sent. */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "fathom/version.h"
#include "sim/fault.h"

static int set_up(void **state)
{
    bench_begin();
    desk_begin();
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = desk_end};

static const fathom_sim_a16_config_t any_a16;
static const fathom_sim_a05_config_t any_a05;
static const fathom_sim_hps167s_config_t any_hps167s;

static const fathom_sim_counters_t *counters(void) { return &bench.hps167s.device.counters; }

/* Runs a command with the file: it ends so, and says this. */
static void says(int status, const char *text, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s --port line --file %s", line, desk_path("unit"));
    if (run->status != status || (strstr(run->out, text) == NULL && strstr(run->err, text) == NULL))
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
}

/* The file, changed as sed would: what stands there once gives way to something else. */
static void change(const char *from, const char *to)
{
    static char text[DESK_TEXT];
    static char changed[DESK_TEXT];
    desk_read("unit", text);
    const char *const at = strstr(text, from);
    assert_non_null(at);
    (void)snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    desk_write("unit", changed);
}

#define BEGIN(place)                                                                                         \
    "# The settings of a range sensor, read by fathom save " FATHOM_VERSION_STRING " at\n"                   \
    "# " place ", 2025-11-24T16:00:"
#define MIDDLE                                                                                               \
    "Z. fathom restore writes them into a unit.\n"                                                           \
    "# A value may be changed; a line may be taken out, then restore leaves that as it is.\n\n"
#define PLACE "\n# Where it is. fathom restore leaves a unit where it is, but for --as-new.\n"

/* The whole text but the seconds. */
static void is_text(const char *text, const char *begin, const char *rest)
{
    const size_t length = strlen(begin);
    assert_memory_equal(text, begin, length);
    assert_string_equal(text + length + 2, rest);
}

/* The values of #1 and #3 are the datasheet's example: 2.1.0 of 2020-09-27, 3.9 of 2019-09-23, its UUID. */
static const char of_hps167s[] = MIDDLE
    "sensor = hps167s                         # infrared time of flight\n"
    "\n# Which unit it is. It cannot be set; fathom restore compares it.\n"
    "interface-version = 2.1.0 of 2020-09-27  # of the RS485 interface (#1)\n"
    "sensor-version = 3.9 of 2019-09-23       # of the sensor behind it (#3)\n"
    "uuid = 00390025423457142034383501060705  # the sensor's own number (#3)\n" PLACE
    "address = 7                              # Modbus address (#8)\n"
    "baud = 19200                             # of the line (#9)\n"
    "\n# How it is set.\n"
    "warm-up = 5                              # s, time without a response after power-on (#7)\n"
    "measure-after-power-on = on              # whether it measures continuously, so that a response is "
    "ready sooner (#10)\n"
    "termination = off                        # the termination resistor, on in every unit from the factory "
    "(#11)\n"
    "reconnect-time = 180                     # ms, after this time without data from its sensor it "
    "sends abnormal packets (#15)\n"
    "\n# What the unit does not tell. It is restored only if you fill it in, and then written each time.\n"
    "distance-offset = not readable           # mm, added to what it measures; whether to an earlier "
    "offset too is not in the datasheet (#12)\n"
    "filter-sensitivity = not readable        # larger is steadier and slower; 0 from the factory, -100 to "
    "100 is recommended (#14)\n";

TEST(the_file_of_an_hps167s_has_what_it_is_where_it_is_and_how_it_is_set)
{
    char text[DESK_TEXT];
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7, .warm_up_s = 5, .no_termination = true});
    says(0, "hps167s:7: the settings are in ", "save hps167s:7");
    is_text(desk_read("unit", text), BEGIN("address 7, 19200 8E1"), of_hps167s);
    assert_int_equal(desk_count(), 1);
    assert_int_equal(counters()->writes, 0);
    const tool_run_t *const run = tool_run(&bench.tool, "save hps167s:7 --port line");
    assert_int_equal(run->status, 0);
    is_text(run->out, BEGIN("address 7, 19200 8E1"), of_hps167s);
}

static bool misses_switch(void *ctx, fathom_sim_frame_t *frame)
{
    (void)ctx;
    return frame->bytes[2] == 0x02 && (frame->bytes[3] == 0x05 || frame->bytes[3] == 0x06);
}

static void miss(void *ctx, fathom_sim_frame_t *frame)
{
    if (misses_switch(ctx, frame)) frame->length = 0;
}

static const fathom_sim_faults_t no_switch = {.incoming = miss};

TEST(what_a_variant_of_the_a16_does_not_have_is_not_there)
{
    char text[DESK_TEXT];
    bench_a16((fathom_sim_a16_config_t){.address = 200, .real_time = true, .faults = &no_switch});
    says(0, "", "save a16:200");
    is_text(
        desk_read("unit", text), BEGIN("address 200, 9600 8N1"),
        MIDDLE
        "sensor = a16                             # one ultrasonic probe\n" PLACE
        "address = 200                            # Modbus address (register 0x0200)\n"
        "\n# How it is set.\n"
        "switch-polarity = not there              # switch variant: the level when something is nearer "
        "than the threshold (0x0205); no response. Not every variant has it\n"
        "switch-threshold = not there             # mm, switch variant: the distance at which it "
        "switches (0x0206); no response. Not every variant has it\n"
        "automatic-value = real-time              # RS232 variant: the distance that the automatic output "
        "sends (0x0207)\n");
    says(0, "no differences", "restore a16:200");
    change("switch-threshold = not there", "switch-threshold = 1500");
    says(1, "switch-threshold         not there      -> 1500 mm  this sensor does not have it",
         "restore a16:200 --dry-run");
    says(1, "nothing was written: this sensor does not have all settings of the file", "restore a16:200");
    assert_int_equal(bench.a16.device.counters.writes, 0);
}

TEST(the_file_of_an_a05_has_its_address)
{
    char text[DESK_TEXT];
    bench_a05((fathom_sim_a05_config_t){.address = 9});
    says(0, "", "save a05:9");
    assert_non_null(strstr(desk_read("unit", text), PLACE "address = 9 "));
    says(0, "unknown whether it is the same sensor", "restore a05:9");
}

/* ---- where a save fails there is no file ---- */

static uint32_t answers_left;

static void fall_silent(void *ctx, fathom_sim_frame_t *frame)
{
    if (answers_left == 0)
        frame->length = 0;
    else
        answers_left--;
}

/* The A16 has four rows; without a response to any of them it is gone, and "not there" would be wrong. */
TEST(a_unit_that_falls_silent_leaves_no_file)
{
    static const fathom_sim_faults_t falls_silent = {.incoming = fall_silent};
    for (answers_left = 0; answers_left != 4; answers_left++) {
        const uint32_t answers = answers_left;
        bench_begin();
        bench_a16((fathom_sim_a16_config_t){.faults = &falls_silent});
        says(1, "no response", "save a16");
        assert_int_equal(desk_count(), 0);
        answers_left = answers;
    }
    bench_begin();
    bench_a16((fathom_sim_a16_config_t){.faults = &falls_silent});
    says(0, "the settings are in", "save a16");
}

TEST(a_response_that_is_lost_is_asked_for_again)
{
    static fathom_sim_fault_t faults;
    char text[DESK_TEXT];
    for (uint32_t frame = 1; frame <= 4; frame++) {
        bench_begin();
        bench_a16(any_a16);
        fathom_sim_fault_init(&faults, 1);
        fathom_sim_fault_attach(&faults, &bench.line, &bench.a16.device);
        assert_non_null(
            fathom_sim_fault_add(&faults, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame));
        says(0, "", "save a16");
        assert_null(strstr(desk_read("unit", text), "not there"));
        desk_remove("unit");
    }
}

static int (*inner_write)(void *ctx, const uint8_t *bytes, size_t length);

static int write_file_too(void *ctx, const uint8_t *bytes, size_t length)
{
    desk_write("unit", "mine");
    return inner_write(ctx, bytes, length);
}

/* Nor one that comes while the unit is read. */
TEST(a_file_that_is_there_is_never_overwritten)
{
    char text[DESK_TEXT];
    bench_hps167s(any_hps167s);
    inner_write = bench.tool.uart.write;
    bench.tool.uart.write = write_file_too;
    for (unsigned time = 0; time != 2; time++) {
        says(1, "unit exists and is not overwritten", "save hps167s");
        assert_string_equal(desk_read("unit", text), "mine");
        assert_int_equal(desk_count(), 1);
        assert_true((counters()->requests != 0) == (time == 0));
        bench_begin();
        bench_hps167s(any_hps167s);
    }
    const tool_run_t *const run =
        tool_run(&bench.tool, "save hps167s --port line --file %s/none/file", desk_path("new"));
    assert_int_equal(run->status, 1);
    assert_non_null(strstr(run->err, "none/file: No such file or directory"));
}

/* ---- restore ---- */

TEST(where_nothing_differs_nothing_is_written)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7, .reconnect_ms = 36});
    says(0, "", "save hps167s:7");
    says(0, "no differences", "restore hps167s:7 --dry-run");
    says(0, "in the sensor: the same sensor\n", "restore hps167s:7");
    says(0, "no differences", "restore hps167s:7 --as-new");
    assert_int_equal(counters()->writes, 0);
    assert_int_equal(counters()->flash_writes, 0);
}

/* Each difference alone: it is shown, written once, and then there is none. */
TEST(each_setting_that_differs_is_written_once)
{
    static const char *const rows[][3] = {
        {"warm-up = 0", "warm-up = 255", "warm-up is 255 s (was 0)\n"},
        {"measure-after-power-on = on", "measure-after-power-on = off",
         "power-on is off from the next power-on (was on)\n"},
        {"termination = on", "termination = off", "termination is off from the next power-on (was on)\n"},
        {"reconnect-time = 180", "reconnect-time = 1800", "reconnect-time is 1800 ms (was 180)\n"}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        bench_begin();
        bench_hps167s(any_hps167s);
        says(0, "", "save hps167s");
        change(rows[i][0], rows[i][1]);
        says(1, " -> ", "restore hps167s --dry-run");
        assert_int_equal(counters()->writes, 0);
        says(0, rows[i][2], "restore hps167s");
        says(0, "no differences", "restore hps167s");
        assert_int_equal(counters()->writes, 1);
        desk_remove("unit");
    }
}

TEST(an_a16_gets_what_differs)
{
    bench_a16(any_a16);
    desk_write("unit", "sensor = a16\nswitch-polarity = positive\nswitch-threshold = 16350\n"
                       "automatic-value = real-time\n");
    says(0, "switch-threshold is 16350 mm (was 1000)\n", "restore a16");
    assert_int_equal(bench.a16.threshold_mm, 16350);
    assert_int_equal(bench.a16.data_type, 1);
    assert_int_equal(bench.a16.device.counters.writes, 2);
}

TEST(a_unit_stays_where_it_is_unless_told)
{
    bench_hps167s(any_hps167s);
    desk_write("unit", "sensor = hps167s\naddress = 7\nbaud = 115200\n");
    says(0, "address                  1              -> 7  stays, without --as-new\n", "restore hps167s");
    says(0, "baud                     19200          -> 115200  stays, without --as-new\n",
         "restore hps167s");
    assert_int_equal(counters()->writes, 0);
}

TEST(what_the_unit_does_not_tell_is_written_when_it_is_filled_in)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.offset_adds = true});
    desk_write("unit", "sensor = hps167s\ndistance-offset = -15\nfilter-sensitivity = 20\n");
    says(1, "distance-offset: a sensor that has an offset already may add the new one",
         "restore hps167s --dry-run");
    says(1, "distance-offset          not readable   -> -15 mm  is written without comparison",
         "restore hps167s --dry-run");
    assert_int_equal(counters()->writes, 0);
    says(0, "distance-offset: -15 mm was written and acknowledged; the setting cannot be read back\n",
         "restore hps167s");
    assert_int_equal(counters()->writes, 2);
    assert_int_equal(bench.hps167s.user.offset_mm, -15);
    assert_int_equal(bench.hps167s.user.filter, 20);
    says(0, "", "restore hps167s"); /* each time */
    assert_int_equal(counters()->writes, 4);
    assert_int_equal(bench.hps167s.user.offset_mm, -30);
}

TEST(a_value_that_cannot_be_set_is_no_line_to_restore)
{
    char text[DESK_TEXT];
    bench_hps167s((fathom_sim_hps167s_config_t){.reconnect_ms = 1000}); /* no multiple of 18 */
    says(0, "", "save hps167s");
    assert_non_null(strstr(desk_read("unit", text), "\nreconnect-time = not settable "));
    assert_non_null(
        strstr(text, "; it has 1000, which cannot be set: 0 to 2147483646, a multiple of 18 ms\n"));
    says(0, "no differences", "restore hps167s");
    change("reconnect-time = not settable", "reconnect-time = 990");
    says(0, "reconnect-time is 990 ms (was 1000)", "restore hps167s");
}

/* Its code 0 has no rate of its own (table 12), so its rate is that at which it answers; code 3 is 115200 (#9). */
TEST(the_rate_of_a_unit_that_does_not_tell_it_is_that_at_which_it_answers)
{
    char text[DESK_TEXT];
    bench_hps167s((fathom_sim_hps167s_config_t){.baud_code = 3, .no_baud_code = true});
    says(0, "", "save hps167s --baud 115200");
    assert_non_null(strstr(desk_read("unit", text), "\nbaud = 115200 "));
    says(0, "no differences", "restore hps167s --baud 115200 --as-new");
}

TEST(another_unit_is_told)
{
    static uint8_t details[22];
    bench_hps167s(any_hps167s);
    says(0, "", "save hps167s");
    memcpy(details, bench.hps167s.details, sizeof details);
    details[1] ^= 0x10; /* of the UUID, behind the acknowledgement's byte */
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.details = details});
    says(0, " in the sensor: another sensor\n", "restore hps167s");
}

/* ---- restore --as-new ---- */

static const char hps167s_file[] = "sensor = hps167s\naddress = 7\nbaud = 57600\nwarm-up = 9\n"
                                   "measure-after-power-on = off\ntermination = off\nreconnect-time = 36\n";

static void is_as_in_the_file(void)
{
    assert_int_equal(bench.hps167s.warm_up_s, 9);
    assert_int_equal(bench.hps167s.reconnect_ms, 36);
    assert_false(bench.hps167s.auto_output);
    assert_false(bench.hps167s.termination);
}

/* Its settings, then its address, then its rate; and then it is looked at again. */
TEST(the_settings_come_before_the_address_and_the_rate_last)
{
    static const char *const order[] = {"warm-up is",
                                        "measure-after-power-on is",
                                        "termination is",
                                        "reconnect-time is",
                                        "hps167s:1: address is 7\n",
                                        "hps167s:7: baud is 57600 (was 19200)\n",
                                        "hps167s:7: responds at the new place, 57600 8E1\n",
                                        "now: the same sensor\n"};
    desk_write("unit", hps167s_file);
    bench_hps167s(any_hps167s);
    const tool_run_t *const run =
        tool_run(&bench.tool, "restore hps167s --as-new --port line --file %s", desk_path("unit"));
    assert_int_equal(run->status, 0);
    const char *at = run->out;
    for (size_t i = 0; i != sizeof order / sizeof order[0]; i++) {
        at = strstr(at, order[i]);
        if (at == NULL) fail_msg("'%s' is not in\n%s", order[i], run->out);
    }
    is_as_in_the_file();
    assert_int_equal(bench.hps167s.device.address, 7);
    assert_int_equal(bench.hps167s.baud_code, 2);
    assert_int_equal(counters()->writes, 6);
    says(0, "no differences", "restore hps167s:7 --baud 57600 --as-new");
}

TEST(a_rate_of_the_next_power_on_is_told_and_the_unit_is_found_where_it_is)
{
    desk_write("unit", hps167s_file);
    bench_hps167s((fathom_sim_hps167s_config_t){.baud_at_power_on = true});
    says(0, "baud is 57600 from the next power-on (19200 until then)\n", "restore hps167s --as-new");
    says(0, "no differences", "restore hps167s:7 --as-new");
    assert_int_equal(counters()->writes, 6);
}

TEST(an_a16_and_an_a05_move_to_their_addresses)
{
    bench_a16(any_a16);
    desk_write("unit", "sensor = a16\naddress = 200\nswitch-threshold = 500\n");
    says(0, "a16:200: responds at the new place, 9600 8N1\n", "restore a16 --as-new");
    assert_int_equal(bench.a16.device.address, 200);
    assert_int_equal(bench.a16.threshold_mm, 500);
    bench_begin();
    bench_a05(any_a05);
    desk_write("unit", "sensor = a05\naddress = 2\n");
    says(0, "a05:2: responds at the new place, 9600 8N1\n", "restore a05 --as-new");
    assert_int_equal(bench.a05.device.address, 2);
}

static fathom_sim_hps167s_t other;

static void begin_with_other(fathom_sim_hps167s_config_t config)
{
    bench_begin();
    bench_hps167s(any_hps167s);
    fathom_sim_hps167s_init(&other, &config);
    fathom_sim_attach(&bench.line, &other.device, bench.clock.now_us);
}

/* Another unit at the new address, at the rate of today and at the one to which it is to go; and at the unit's own address,
 * at the rate to which it is to go. */
TEST(an_occupied_place_is_refused_before_anything_is_written)
{
    static const struct {
        fathom_sim_hps167s_config_t other;
        const char *file;
        const char *words;
    } rows[] = {{{.address = 7, .baud_code = 1},
                 hps167s_file,
                 "written: at address 7, 19200 8E1, a sensor responds already"},
                {{.address = 7, .baud_code = 2},
                 hps167s_file,
                 "written: at address 7, 57600 8E1, a sensor responds already"},
                {{.baud_code = 2},
                 "sensor = hps167s\nbaud = 57600\nwarm-up = 9\n",
                 "nothing was written: at address 1, 57600 8E1, a sensor responds already"}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        begin_with_other(rows[i].other);
        desk_write("unit", rows[i].file);
        says(1, rows[i].words, "restore hps167s --as-new");
        assert_int_equal(counters()->writes, 0);
        says(0, "", "restore hps167s"); /* where it is not to go that matters nothing */
        assert_int_equal(bench.hps167s.warm_up_s, 9);
        assert_int_equal(other.device.counters.writes, 0);
    }
}

/* Its first response is lost, which is no silence. */
TEST(a_place_is_asked_twice)
{
    static fathom_sim_fault_t faults;
    desk_write("unit", hps167s_file);
    begin_with_other((fathom_sim_hps167s_config_t){.address = 7});
    fathom_sim_fault_init(&faults, 1);
    fathom_sim_fault_attach(&faults, &bench.line, &other.device);
    assert_non_null(fathom_sim_fault_add(&faults, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 1));
    says(1, "nothing was written: at address 7, 19200 8E1, a sensor responds already",
         "restore hps167s --as-new");
    assert_int_equal(counters()->writes, 0);
}

TEST(one_that_sends_unasked_moves_too)
{
    static const char *const rates[] = {"57600", "115200", "230400"};
    for (uint32_t phase_us = 0; phase_us < 18500; phase_us += 700) {
        const char *const rate = rates[phase_us / 700 % 3];
        char text[DESK_TEXT];
        (void)snprintf(text, sizeof text, "sensor = hps167s\naddress = 7\nbaud = %s\n", rate);
        desk_write("unit", text);
        bench_begin();
        bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18500, .seed = phase_us});
        fathom_sim_clock_advance(&bench.clock, 1000000 + phase_us);
        says(0, "hps167s:7: responds at the new place, ", "restore hps167s --as-new");
        assert_int_equal(counters()->writes, 2);
    }
}

static uint8_t details[22];

/* With the new address another unit stands there. */
static int swap(void *ctx, const uint8_t *bytes, size_t length)
{
    if (bytes[1] == 6 && bytes[3] == 0x10) details[5] ^= 1;
    return inner_write(ctx, bytes, length);
}

TEST(another_unit_at_the_new_place_is_no_success)
{
    bench_hps167s(any_hps167s);
    memcpy(details, bench.hps167s.details, sizeof details);
    bench.hps167s.details = details;
    inner_write = bench.tool.uart.write;
    bench.tool.uart.write = swap;
    desk_write("unit", "sensor = hps167s\naddress = 7\n");
    says(1, " now: another sensor\n", "restore hps167s --as-new");
    desk_write("unit", "sensor = hps167s\naddress = 8\n");
    says(1, "another sensor responds at the new place", "restore hps167s:7 --as-new");
}

/* ---- interrupted ---- */

static uint16_t written[64];
static unsigned written_count;

static int spy(void *ctx, const uint8_t *bytes, size_t length)
{
    const int n = inner_write(ctx, bytes, length);
    if (n > 0 && bytes[1] != 3) written[written_count++ % 64] = (uint16_t)(bytes[2] << 8 | bytes[3]);
    return n;
}

/* How often the device was told what stands there. */
static unsigned writes_of(uint16_t reg)
{
    unsigned count = 0;
    for (unsigned i = 0; i != written_count; i++) count += written[i] == reg;
    return count;
}

/* Runs it where the unit is now. */
static const tool_run_t *restore_there(void)
{
    static const unsigned rates[] = {0, 19200, 57600, 115200, 230400};
    return tool_run(&bench.tool, "restore hps167s:%u --baud %u --as-new --port line --file %s",
                    bench.hps167s.device.address, rates[bench.hps167s.baud_code], desk_path("unit"));
}

/* Runs it with a new unit, until the user ends it. */
static const tool_run_t *restore_until(uint64_t end_us)
{
    bench_begin();
    bench_hps167s(any_hps167s);
    inner_write = bench.tool.uart.write;
    bench.tool.uart.write = spy;
    written_count = 0;
    bench.tool.ctrl_c_us = end_us;
    return restore_there();
}

/* Ended at any time and run again, it comes to the same, and nothing is written a second time. */
TEST(what_was_interrupted_is_carried_on_by_the_next_run)
{
    static const uint16_t registers[] = {0x0A, 0x10, 0x11, 0x12, 0x13, 0x20}; /* #7 to #11, #15 */
    unsigned ended = 0;
    unsigned after_a_write = 0;
    desk_write("unit", hps167s_file);
    for (;; ended++) {
        const tool_run_t *run = restore_until(20000 + 7000 * (uint64_t)ended);
        if (run->status == 0) break;
        assert_int_equal(run->status, 1);
        after_a_write += written_count != 0;
        /* if it fails behind all that is written, nothing is left to name */
        if (written_count != 6)
            assert_non_null(strstr(run->err, written_count != 0 ? "stopped at " : "written"));
        bench.tool.ctrl_c_us = 0;
        fathom_sim_clock_advance(&bench.clock, 1000000);
        run = restore_there();
        if (run->status != 0) fail_msg("run %u: %s%s", ended, run->out, run->err);
        is_as_in_the_file();
        assert_int_equal(bench.hps167s.device.address, 7);
        assert_int_equal(bench.hps167s.baud_code, 2);
        for (size_t i = 0; i != sizeof registers / sizeof registers[0]; i++)
            assert_int_equal(writes_of(registers[i]), 1);
        assert_int_equal(counters()->writes, 6);
    }
    assert_true(ended > 300 && after_a_write > 100);
}

/* What is written without comparison comes behind what is compared, and is named where the run ends after it. */
TEST(what_would_be_written_again_is_named)
{
    bool was_named = false;
    const tool_run_t *run = NULL;
    desk_write("unit", "sensor = hps167s\naddress = 7\nwarm-up = 9\ndistance-offset = -15\n");
    for (uint64_t end_us = 20000; (run = restore_until(end_us))->status != 0; end_us += 7000) {
        const bool is_written = bench.hps167s.user.offset_mm == -15;
        const bool is_named =
            strstr(run->err, "before you run restore again, write `not readable` for distance-offset in ") !=
            NULL;
        if (is_written && !is_named) fail_msg("%u us: %s", (unsigned)end_us, run->err);
        if (is_named) assert_int_equal(bench.hps167s.warm_up_s, 9);
        was_named = was_named || is_named;
    }
    assert_true(was_named);
}

/* ---- a file that a person has edited ---- */

#define HPS         "sensor = hps167s\n"
#define UNPRINTABLE "2: the line has a character that cannot be printed or is not ASCII"
#define MISSING     " the line 'sensor = hps167s' is missing. Is this a file of 'fathom save'?"
#define NO_SETTING  "is no setting that 'fathom save' prints for an"

static void set_up_both(void)
{
    bench_begin();
    bench_hps167s(any_hps167s);
    bench_a16(any_a16);
}

/* The file is refused with this line alone on the standard error, and nothing is sent. */
static void refuses(int status, const char *sensor, const char *words)
{
    char line[512];
    const tool_run_t *const run =
        tool_run(&bench.tool, "restore %s --port line --file %s", sensor, desk_path("unit"));
    (void)snprintf(line, sizeof line, "fathom: %s:%s\n", desk_path("unit"), words);
    assert_string_equal(run->err, line);
    assert_string_equal(run->out, "");
    assert_int_equal(run->status, status);
    assert_int_equal(bench.line.counters.from_host, 0);
}

TEST(a_file_of_an_earlier_version_has_the_command_load_settings)
{
    set_up_both();
    desk_write("unit", HPS "load-settings = not readable\n");
    says(0, "no differences", "restore hps167s");
}

/* ESC [ is how a terminal is told to do things, and so is 9B, in UTF-8 C2 9B, alone. */
TEST(every_mistake_in_a_file_is_told_with_its_line_and_nothing_is_sent)
{
    static const char *const rows[][2] = {
        {"", MISSING},
        {"# nothing\n\n", MISSING},
        {"warm-up = 5\n", "1: the line 'warm-up' comes before the line 'sensor = hps167s'"},
        {"sensor = a16\n", "1: the file belongs to 'a16', and the sensor is an hps167s"},
        {HPS HPS, "2: sensor occurs twice"},
        {HPS "\nwarm-up 5\n", "3: 'warm-up 5' does not have the form NAME = VALUE"},
        {HPS "warm-up = 256\n", "2: warm-up takes 0 to 255 s, not '256'"},
        {HPS "warm-up = 5 s\n", "2: warm-up takes 0 to 255 s, not '5 s'"},
        {HPS "warm-up =\n", "2: warm-up takes 0 to 255 s, not ''"},
        {HPS "warm-up = = 5\n", "2: warm-up takes 0 to 255 s, not '= 5'"},
        {HPS "termination = yes # on\n", "2: termination takes off, on, not 'yes'"},
        {HPS "reconnect-time = 100\n",
         "2: reconnect-time takes 0 to 2147483646, a multiple of 18 ms, not '100'"},
        {HPS "address = 0\n", "2: address takes 1 to 32, not '0'"},
        {HPS "warm-up = 5\nwarm-up = 5\n", "3: warm-up occurs in line 2 already"},
        {HPS "warm-up = not readable\nwarm-up = 5\n", "3: warm-up occurs in line 2 already"},
        {HPS "warmup = 5\n", "2: 'warmup' " NO_SETTING " hps167s"},
        {HPS "Warm-up = 5\n", "2: 'Warm-up' " NO_SETTING " hps167s"},
        {HPS "= 5\n", "2: '' " NO_SETTING " hps167s"},
        {HPS "temperature = 25.0\n", "2: 'temperature' " NO_SETTING " hps167s"},
        {HPS "baud-code = 1\n", "2: 'baud-code' " NO_SETTING " hps167s"},
        {HPS "load-settings = user\n", "2: 'load-settings' " NO_SETTING " hps167s"},
        {HPS "uuid = 0039002542345714203438350106070500390025423457142034383501060705\n",
         "2: the value of uuid is too long"},
        {HPS "uuid = 00\x1b[2J\n", UNPRINTABLE},
        {HPS "uuid = 00\x9b\n", UNPRINTABLE},
        {HPS "uuid = 00\xc2\x9b\n", UNPRINTABLE},
        {HPS "warm-up = \a5\n", UNPRINTABLE},
        {HPS "warm-up\x1b]0;x\a = 5\n", UNPRINTABLE},
        {HPS "\x1b[31m\n", UNPRINTABLE},
        {HPS "warm-up = 5\r6\n", UNPRINTABLE},
        {HPS "uuid = \x7f\n", UNPRINTABLE},
        {HPS "uuid = \xc3\xa4\n", UNPRINTABLE},
        {"# 1\nsensor = \x1b[2J\n", UNPRINTABLE},
    };
    set_up_both();
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        desk_write("unit", rows[i][0]);
        refuses(2, "hps167s", rows[i][1]);
    }
    desk_write("unit", "sensor = a16\noperating-mode = automatic\n");
    refuses(2, "a16", "2: 'operating-mode' " NO_SETTING " a16");
    desk_write("unit", "sensor = a16\nautomatic-output = on\n");
    refuses(2, "a16", "2: 'automatic-output' " NO_SETTING " a16");
}

TEST(what_is_no_text_of_short_lines_is_refused)
{
    static const char zero[] = "sensor = hps167s\nwarm\0-up = 5\n";
    static const int lengths[] = {5000, 251, 250};
    set_up_both();
    refuses(1, "hps167s", " No such file or directory");
    const tool_run_t *const run = tool_run(&bench.tool, "restore hps167s --port line --file /tmp");
    assert_int_equal(run->status, 1);
    assert_string_equal(run->err, "fathom: /tmp: Is a directory\n");
    FILE *const file = fopen(desk_path("unit"), "w");
    assert_non_null(file);
    assert_int_equal(fwrite(zero, 1, sizeof zero - 1, file), sizeof zero - 1);
    assert_int_equal(fclose(file), 0);
    refuses(2, "hps167s", "2: the line has a byte 0, so this is no text file");
    for (size_t i = 0; i != sizeof lengths / sizeof lengths[0]; i++) {
        char text[DESK_TEXT];
        (void)snprintf(text, sizeof text, HPS "warm-up = 5 #%0*d\n", lengths[i] - 13, 0);
        desk_write("unit", text);
        if (lengths[i] > 250) refuses(2, "hps167s", "2: the line is longer than 250 characters");
    }
    says(0, "warm-up is 5 s", "restore hps167s");
}

/* Line ends of another system, blanks, no end of the last line, lines taken out, and anything in a comment. */
TEST(a_file_may_look_otherwise)
{
    bench_hps167s(any_hps167s);
    desk_write("unit", "\r\n# mine\r\n \tsensor=hps167s\t# \xc3\xa4 and \x1b[2J\r\n\r\n  warm-up\t=  5 \r\n"
                       "uuid = not readable\r\ntermination=off#");
    says(0, "warm-up is 5 s", "restore hps167s");
    assert_false(bench.hps167s.termination);
    assert_int_equal(counters()->writes, 2);
    assert_null(
        strchr(tool_run(&bench.tool, "restore hps167s --port line --file %s", desk_path("unit"))->out, 0x1b));
}

TEST(address_0_is_nothing_that_a_new_unit_gets)
{
    bench_a16(any_a16);
    desk_write("unit", "sensor = a16\naddress = 0\n");
    says(2, "unit:2: with --as-new no sensor gets address 0", "restore a16 --as-new");
    assert_int_equal(bench.a16.device.counters.requests, 0);
    says(0, "stays, without --as-new", "restore a16");
    assert_int_equal(bench.a16.device.counters.writes, 0);
}

REFUSES(a_command_line_without_what_it_needs_is_refused, "",
        {"restore hps167s --port line", "--file is missing"},
        {"restore hps167s --file x", "--port is missing"},
        {"restore hps167s --file x --port line --format json", "unknown option '--format'"},
        {"restore hps167s --file x --port line more", "'more' is one word too many."},
        {"restore a05 --file x --port line --mode dyp", "--mode is dyp, but this needs mode modbus."},
        {"restore a16:0 --file x --port line", "a write to address 0 goes to all units"},
        {"save hps167s --port line --format json", "unknown option '--format'"},
        {"save hps167s --port line more", "'more' is one word too many."},
        {"save hps167s --port line --dry-run", "unknown option '--dry-run'"})
