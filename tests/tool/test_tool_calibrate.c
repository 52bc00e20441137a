/* SPDX-License-Identifier: MIT */
/* After fathom calibrate the device is right, or the report is true. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

/* ---- the device, whose writes are counted from 1 ---- */

/* The frames of function 06 that are lost: their acknowledgements; the requests too. */
static struct {
    unsigned lost_write; /* 0: none */
    bool is_taken;
    uint8_t exception; /* comes in place of the acknowledgement; 0: nothing does */
    bool is_deaf;      /* to #1, which the driver reads before it writes #12 */
    unsigned requests;
} writes;

static void incoming(void *ctx, fathom_sim_frame_t *frame)
{
    if (writes.is_deaf && frame->length != 0 && frame->bytes[1] == 3 && frame->bytes[3] == 1)
        frame->length = 0;
    if (frame->length == 0 || frame->bytes[1] != 6) return;
    if (++writes.requests == writes.lost_write && !writes.is_taken) frame->length = 0;
}

static void outgoing(void *ctx, fathom_sim_frame_t *frame)
{
    static const uint8_t refused[5] = {1, 0x86, 3, 0x02, 0x61};
    static const uint8_t gateway[5] = {1, 0x86, 11, 0x03, 0xA7};
    if (frame->length == 0 || frame->bytes[1] != 6 || writes.requests != writes.lost_write) return;
    frame->length = writes.exception != 0 ? 5 : 0;
    memcpy(frame->bytes, writes.exception == 3 ? refused : gateway, frame->length);
}

static const fathom_sim_faults_t faults = {.incoming = incoming, .outgoing = outgoing};

static void begin(bool adds, int32_t raw_mm, int16_t before_mm)
{
    memset(&writes, 0, sizeof writes);
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.offset_adds = adds, .faults = &faults});
    bench.scene.value[0] = raw_mm;
    bench.hps167s.sensor.offset_mm = bench.hps167s.user.offset_mm = before_mm;
}

static unsigned flash_writes(void) { return bench.hps167s.device.counters.flash_writes; }

static unsigned count(const char *text, const char *what)
{
    unsigned n = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at++) n++;
    return n;
}

#define CALIBRATE "calibrate hps167s --port line --known 2000"

static int set_up(void **state)
{
    begin(false, 2015, 0);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- every kind of device ---- */

typedef struct {
    bool adds;
    int16_t off_mm;    /* the device's deviation, without an offset */
    int16_t before_mm; /* the offset */
    unsigned lost_write;
    bool is_taken;
} row_t;

static void check(const row_t *row)
{
    enum { T_MM = 2 };
    const int d_mm = -(row->off_mm + row->before_mm);
    const bool is_same = !row->adds && row->before_mm == d_mm;
    const unsigned needed = !row->adds && row->before_mm != 0 ? 2 : 1;
    begin(row->adds, 2000 + row->off_mm, row->before_mm);
    writes.lost_write = row->lost_write;
    writes.is_taken = row->is_taken;
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE " --samples 5");
    const int off_mm = row->off_mm + bench.hps167s.sensor.offset_mm;
    const unsigned announced = count(run->out, "to flash");
    bool is_wrong = (run->status == 0) != (off_mm >= -T_MM && off_mm <= T_MM);
    is_wrong = is_wrong || flash_writes() > announced || announced > 2 || writes.requests != announced;
    is_wrong = is_wrong || (run->status == 0) != (strstr(run->out, "right within 2 mm") != NULL);
    is_wrong = is_wrong || (row->adds && strstr(run->out, "#12 replaces") != NULL);
    /* a lost acknowledgement does not matter if the distance shows that the offset was accepted */
    const bool is_known = row->lost_write == 0 || row->lost_write > announced || row->is_taken;
    if (is_same)
        is_wrong = is_wrong || run->status != 1 || announced != 1;
    else if (is_known)
        is_wrong = is_wrong || run->status != 0 || announced != needed;
    else
        is_wrong = is_wrong || run->status != 1 || announced != row->lost_write; /* nothing after it */
    if (is_wrong)
        fail_msg("%s, off %d, before %d, lost %u%s: off %d, status %d, announced %u, wrote %u\n%s%s",
                 row->adds ? "adds" : "replaces", row->off_mm, row->before_mm, row->lost_write,
                 row->is_taken ? " taken" : "", off_mm, run->status, announced, flash_writes(), run->out,
                 run->err);
}

TEST(every_device_is_right_afterwards_or_reported_as_wrong)
{
    static const int16_t offs_mm[] = {16, -40, 6};
    for (unsigned kind = 0; kind != 2 * 4 * 3 * 5; kind++) {
        const int16_t off_mm = offs_mm[kind / 8 % 3];
        const int16_t befores_mm[] = {0, 5, -30, (int16_t)(-off_mm / 2)}; /* the last: equal to d */
        const unsigned fate = kind / 24;
        check(&(row_t){.adds = kind % 2 != 0,
                       .off_mm = off_mm,
                       .before_mm = befores_mm[kind / 2 % 4],
                       .lost_write = (fate + 1) / 2,
                       .is_taken = fate % 2 != 0});
    }
}

/* ---- what is said ---- */

static void expect(int status, const char *out, const char *err, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s", line);
    if (run->status != status || strcmp(run->out, out) != 0 || strcmp(run->err, err) != 0)
        fail_msg("exit status %d\n%s%s", run->status, run->out, run->err);
}

#define FAR   "hps167s:1: measured 2015 mm (median of 25, spread 0 mm), known 2000 mm: 15 mm too far\n"
#define THERE "hps167s:1: measured 2000 mm (median of 25, spread 0 mm), known 2000 mm\n"
#define ONE   "hps167s:1: writing offset -15 mm to flash (write 1 of at most 2)\n"
#define RIGHT "hps167s:1: right within 2 mm: measured 2000 mm, known 2000 mm; "
#define AGAIN                                                                                                \
    "fathom: before you calibrate again, switch the power off and on, and measure.\n"                        \
    "fathom: if the sensor then measures as before, set distance-offset to 0, switch the power off and on, " \
    "and calibrate again.\n"                                                                                 \
    "fathom: if it measures another wrong distance X, #12 replaces the old offset, and the right offset is " \
    "1985 - X.\n" /* 2000 - 15 */

TEST(a_device_without_an_old_offset_is_right_after_one_write)
{
    expect(0, FAR ONE THERE RIGHT "offset: -15 mm or the old offset minus 15 mm; flash writes: 1\n", "",
           CALIBRATE);
    assert_int_equal(flash_writes(), 1);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -15);
}

TEST(a_device_that_adds_is_right_after_one_write)
{
    begin(true, 2010, 5);
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(flash_writes(), 1);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -10);
}

/* Off by 10 without an offset: with -15 it is 5 too near, and -15 + 5 is right. */
TEST(a_device_that_replaces_an_old_offset_is_right_after_two_writes)
{
    begin(false, 2010, 5);
    expect(0,
           FAR ONE "hps167s:1: measured 1995 mm (median of 25, spread 0 mm), known 2000 mm: 5 mm too near\n"
                   "hps167s:1: writing offset -10 mm to flash (write 2 of at most 2)\n" THERE RIGHT
                   "offset: -10 mm; flash writes: 2; #12 replaces the old offset\n",
           "", CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -10);
}

TEST(a_device_that_is_right_is_not_written_to)
{
    for (int32_t raw_mm = 1998; raw_mm <= 2002; raw_mm++) {
        begin(false, raw_mm, 0);
        ASSERT_RUN(0, CALIBRATE);
        assert_int_equal(writes.requests, 0);
    }
    begin(false, 2000, 0);
    expect(0, THERE RIGHT "nothing was written\n", "", CALIBRATE);
    begin(false, 2003, 0);
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -3);
}

TEST(a_dry_run_writes_nothing)
{
    expect(1, FAR "hps167s:1: nothing was written; without --dry-run, offset -15 mm would be\n", "",
           CALIBRATE " --dry-run");
    ASSERT_RUN(1, CALIBRATE " --dry-run --format json");
    assert_int_equal(writes.requests, 0);
}

TEST(json_is_one_object)
{
    expect(0,
           "{\"name\":\"hps167s:1\",\"model\":\"hps167s\",\"mode\":\"modbus\",\"address\":1,\"status\":"
           "\"right\","
           "\"known_mm\":2000,\"measured_mm\":[2015,2000],\"spread_mm\":0,\"tolerance_mm\":2,\"written_mm\":["
           "-15],"
           "\"offsets\":[{\"offset_mm\":-15,\"is_added\":false},{\"offset_mm\":-15,\"is_added\":true}]}\n",
           "fathom: " ONE, CALIBRATE " --format json");
}

/* ---- what goes wrong ---- */

TEST(a_lost_write_stops_the_calibration)
{
    writes.lost_write = 1;
    expect(1, FAR ONE FAR,
           "fathom: hps167s:1: offset -15 mm was not acknowledged, and the sensor still measures 2015 mm\n"
           "fathom: hps167s:1: flash writes: 1; the offset is now, or from the next power-on: -15 mm, the "
           "old offset minus 15 mm or the old offset\n" AGAIN,
           CALIBRATE);
    assert_int_equal(writes.requests, 1);
}

TEST(an_offset_without_effect_stops_the_calibration)
{
    begin(false, 2030, -15); /* which it has already */
    expect(1, FAR ONE FAR,
           "fathom: hps167s:1: offset -15 mm was acknowledged, but the sensor still measures 2015 mm. The "
           "offset takes effect at the next power-on, or the sensor had this offset already, or it did not "
           "accept it\n"
           "fathom: hps167s:1: flash writes: 1; the offset is now, or from the next power-on: -15 mm, the "
           "old offset minus 15 mm or the old offset\n" AGAIN,
           CALIBRATE);
}

/* What it says to do then. */
TEST(an_offset_of_0_removes_the_old_offset)
{
    begin(false, 2030, -15);
    ASSERT_RUN(1, CALIBRATE);
    ASSERT_RUN(0, "set hps167s --port line distance-offset 0");
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -30);
}

TEST(a_second_write_that_is_lost_names_both_offsets)
{
    begin(false, 2010, 5);
    writes.lost_write = 2;
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(
        run->err,
        "fathom: hps167s:1: offset -10 mm was not acknowledged, and the sensor still measures 1995 mm\n"
        "fathom: hps167s:1: flash writes: 2; the offset is now, or from the next power-on: -10 mm or -15 mm\n"
        "fathom: #12 replaces the old offset, so you can calibrate again.\n");
}

/* It says so, whatever it has done. */
static void begin_refused(unsigned write)
{
    writes.lost_write = write;
    writes.is_taken = true;
    writes.exception = 3;
}

TEST(a_refused_write_stops_the_calibration)
{
    begin_refused(1);
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err, "fathom: hps167s:1: offset -15 mm was not written: "));
    assert_non_null(strstr(run->err, "refused"));
    assert_non_null(strstr(run->err, "\nfathom: hps167s:1: nothing was written.\n"));
    assert_int_equal(writes.requests, 1);
}

TEST(a_write_that_was_not_sent_stops_the_calibration)
{
    writes.is_deaf = true;
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err, "fathom: hps167s:1: offset -15 mm was not written: no response"));
    assert_non_null(strstr(run->err, "\nfathom: hps167s:1: nothing was written.\n"));
    assert_int_equal(writes.requests, 0);
}

/* 11: a gateway has heard nothing of the device, which may have taken it. */
TEST(an_exception_that_is_no_refusal_counts_as_no_acknowledgement)
{
    writes.lost_write = 1;
    writes.is_taken = true;
    writes.exception = 11;
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(writes.requests, 1);
}

TEST(ctrl_c_prints_the_possible_offsets)
{
    bench.tool.ctrl_c_us = 5000000; /* the first measurement takes 3 s, the second 4 */
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err,
                           "the offset is now, or from the next power-on: -15 mm or the old offset minus "
                           "15 mm\n"));
}
