/* SPDX-License-Identifier: MIT */
/* fathom restore --as-new, and a restore that is interrupted: where the unit is then, and what is written how often. */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

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

/* Runs it with the file: it ends so, and says this. */
static void says(int status, const char *text, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s --port line --file %s", line, desk_path("unit"));
    if (run->status != status || (strstr(run->out, text) == NULL && strstr(run->err, text) == NULL))
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
}

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

static int (*inner_write)(void *ctx, const uint8_t *bytes, size_t length);
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
