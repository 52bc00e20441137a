/* SPDX-License-Identifier: MIT */
/* fathom calibrate: after it the device is right, or what is said of it is so. */
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
    begin(row->adds, 2000 + row->off_mm, row->before_mm);
    writes.lost_write = row->lost_write;
    writes.is_taken = row->is_taken;
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE " --samples 5");
    const int off_mm = row->off_mm + bench.hps167s.sensor.offset_mm;
    const unsigned announced = count(run->out, "writing to flash");
    bool is_wrong = (run->status == 0) != (off_mm >= -T_MM && off_mm <= T_MM);
    is_wrong = is_wrong || flash_writes() > announced || announced > 3 || writes.requests != announced;
    is_wrong = is_wrong || (run->status == 0) != (strstr(run->out, "it is right within 2 mm") != NULL);
    is_wrong = is_wrong || (row->adds && strstr(run->out, "; #12 replaces") != NULL);
    is_wrong = is_wrong || (!row->adds && strstr(run->out, "; #12 adds") != NULL);
    /* A lost acknowledgement does not matter where it is seen to be taken; the second write of one that adds is a 0,
     * which is never seen. */
    const bool is_known = row->lost_write == 0 || row->lost_write > announced || row->is_taken;
    const bool is_zero_lost = row->adds && row->lost_write == 2;
    if (is_same)
        is_wrong = is_wrong || run->status != 1 || announced != 1;
    else if (is_known && !is_zero_lost)
        is_wrong =
            is_wrong || run->status != 0 || strstr(run->out, row->adds ? "; #12 adds" : "; #12 repl") == NULL;
    else
        is_wrong = is_wrong || announced != row->lost_write; /* nothing after it */
    /* 2; 3 where there was no offset to tell by */
    if (is_known && !is_same && !is_zero_lost)
        is_wrong = is_wrong || announced != (!row->adds && row->before_mm == 0 ? 3 : 2);
    if (is_wrong)
        fail_msg("%s, off %d, before %d, lost %u%s: off %d, status %d, announced %u, wrote %u\n%s%s",
                 row->adds ? "adds" : "replaces", row->off_mm, row->before_mm, row->lost_write,
                 row->is_taken ? " taken" : "", off_mm, run->status, announced, flash_writes(), run->out,
                 run->err);
}

TEST(every_device_is_right_afterwards_or_said_not_to_be)
{
    static const int16_t offs_mm[] = {16, -40, 6};
    for (unsigned kind = 0; kind != 2 * 4 * 3 * 7; kind++) {
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

#define FAR   "hps167s:1: measured 2015 mm, the median of 25 (spread 0 mm); known 2000 mm: 15 mm too far\n"
#define THERE "hps167s:1: measured 2000 mm, the median of 25 (spread 0 mm); known 2000 mm\n"
#define ONE   "hps167s:1: writing to flash, 1 of at most 3: offset -15 mm\n"
#define TWO                                                                                                  \
    "hps167s:1: writing to flash, 2 of at most 3: offset 0 mm, which shows whether #12 adds or replaces\n"
#define RIGHT  "hps167s:1: it is right within 2 mm: measured 2000 mm, known 2000 mm; "
#define EITHER "whether #12 adds to the offset before or replaces it is not settled"
#define AGAIN                                                                                                \
    "fathom: switch its power off and on, then measure, before you calibrate again\n"                        \
    "fathom: if it measures as before then, write offset 0, switch it off and on, and calibrate again; if "  \
    "it\n"                                                                                                   \
    "fathom: measures X mm, neither right nor as before, #12 replaces, and the right offset is 1985 - X\n" /* 2000 - 15 */

TEST(one_that_replaces_is_settled_in_three_writes)
{
    expect(0,
           FAR ONE THERE TWO FAR "hps167s:1: writing to flash, 3 of at most 3: offset -15 mm\n" THERE RIGHT
                                 "offset: -15 mm; #12 replaces the offset before; flash writes: 3\n",
           "", CALIBRATE);
    assert_int_equal(flash_writes(), 3);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -15);
}

TEST(one_that_adds_is_settled_in_two)
{
    begin(true, 2010, 5);
    expect(0,
           FAR ONE THERE TWO THERE RIGHT
           "offset: what it was before minus 15 mm; #12 adds to the offset before; flash writes: 2\n",
           "", CALIBRATE);
    assert_int_equal(flash_writes(), 2);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -10);
}

/* Off by 10 without an offset: with -15 it is 5 too near, and -15 + 5 is right. */
TEST(one_that_had_another_offset_and_replaces_is_settled_in_two)
{
    begin(false, 2010, 5);
    expect(0,
           FAR ONE
           "hps167s:1: measured 1995 mm, the median of 25 (spread 0 mm); known 2000 mm: 5 mm too near\n"
           "hps167s:1: writing to flash, 2 of at most 3: offset -10 mm\n" THERE RIGHT
           "offset: -10 mm; #12 replaces the offset before; flash writes: 2\n",
           "", CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -10);
}

TEST(it_need_not_be_settled)
{
    expect(0,
           FAR ONE THERE RIGHT "offset: -15 mm or what it was before minus 15 mm; " EITHER
                               "; flash writes: 1\n",
           "", CALIBRATE " --leave-unsettled");
    assert_int_equal(flash_writes(), 1);
}

TEST(what_is_right_is_left_alone)
{
    for (int32_t raw_mm = 1998; raw_mm <= 2002; raw_mm++) {
        begin(false, raw_mm, 0);
        ASSERT_RUN(0, CALIBRATE);
        assert_int_equal(writes.requests, 0);
    }
    begin(false, 2000, 0);
    expect(0, THERE RIGHT "nothing was written; " EITHER "\n", "", CALIBRATE);
    begin(false, 2003, 0);
    ASSERT_RUN(0, CALIBRATE " --leave-unsettled");
    assert_int_equal(bench.hps167s.sensor.offset_mm, -3);
}

TEST(a_dry_run_writes_nothing)
{
    expect(1, FAR "hps167s:1: nothing was written; offset -15 mm would be\n", "", CALIBRATE " --dry-run");
    ASSERT_RUN(1, CALIBRATE " --dry-run --format json");
    assert_int_equal(writes.requests, 0);
}

TEST(json_is_one_object)
{
    begin(true, 2015, 0);
    expect(
        0,
        "{\"sensor\": \"hps167s\", \"address\": 1, \"known_mm\": 2000, \"measured_mm\": [2015, 2000, 2000], "
        "\"spread_mm\": 0, \"tolerance_mm\": 2, \"written_mm\": [-15, 0], \"would_write_mm\": null, "
        "\"offsets\": [{\"mm\": -15, \"added_to_the_one_before\": true}], \"offset_12\": \"adds\", "
        "\"right\": true, \"outcome\": \"done\"}\n",
        "fathom: " ONE "fathom: " TWO, CALIBRATE " --format json");
}

/* ---- what goes wrong ---- */

TEST(an_acknowledgement_that_is_lost_and_not_seen_to_be_taken_ends_it)
{
    writes.lost_write = 1;
    expect(
        1, FAR ONE FAR,
        "fathom: hps167s:1: offset -15 mm was not acknowledged, and it measures 2015 mm as before\n"
        "fathom: hps167s:1: nothing more is written (flash writes: 1); its offset is now, or from the next "
        "power-on: -15 mm, what it was before minus 15 mm or what it was before\n" AGAIN,
        CALIBRATE);
    assert_int_equal(writes.requests, 1);
}

TEST(a_0_that_is_lost_leaves_it_right_and_unsettled)
{
    writes.lost_write = 2;
    expect(0,
           FAR ONE THERE TWO THERE RIGHT "offset: -15 mm or what it was before minus 15 mm; " EITHER
                                         "; flash writes: 2\n",
           "fathom: hps167s:1: offset 0 mm was not acknowledged, and it measures 2000 mm as before\n",
           CALIBRATE);
}

TEST(an_offset_that_changes_nothing_ends_it)
{
    begin(false, 2030, -15); /* which it has already */
    expect(
        1, FAR ONE FAR,
        "fathom: hps167s:1: offset -15 mm was acknowledged, and it measures 2015 mm as before: it holds from "
        "the "
        "next power-on, or it is the offset that it had, or it was not taken\n"
        "fathom: hps167s:1: nothing more is written (flash writes: 1); its offset is now, or from the next "
        "power-on: -15 mm, what it was before minus 15 mm or what it was before\n" AGAIN,
        CALIBRATE);
}

/* What it says to do then. */
TEST(an_offset_that_it_had_is_got_rid_of_by_a_0)
{
    begin(false, 2030, -15);
    ASSERT_RUN(1, CALIBRATE);
    ASSERT_RUN(0, "set hps167s --port line distance-offset 0");
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -30);
}

TEST(a_third_write_that_is_lost_names_both_offsets)
{
    writes.lost_write = 3;
    expect(
        1, FAR ONE THERE TWO FAR "hps167s:1: writing to flash, 3 of at most 3: offset -15 mm\n" FAR,
        "fathom: hps167s:1: offset -15 mm was not acknowledged, and it measures 2015 mm as before\n"
        "fathom: hps167s:1: nothing more is written (flash writes: 3); its offset is now, or from the next "
        "power-on: -15 mm or 0 mm\n"
        "fathom: #12 replaces the offset before, so it may be calibrated again\n",
        CALIBRATE);
}

/* It says so, whatever it has done. */
static void begin_refused(unsigned write)
{
    writes.lost_write = write;
    writes.is_taken = true;
    writes.exception = 3;
}

TEST(a_refusal_ends_it)
{
    begin_refused(1);
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err, "fathom: hps167s:1: offset -15 mm was not written: "));
    assert_non_null(strstr(run->err, "refused"));
    assert_non_null(strstr(run->err, "\nfathom: hps167s:1: nothing was written\n"));
    assert_int_equal(writes.requests, 1);
}

TEST(a_write_that_could_not_be_sent_ends_it)
{
    writes.is_deaf = true;
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err, "fathom: hps167s:1: offset -15 mm was not written: no response"));
    assert_non_null(strstr(run->err, "\nfathom: hps167s:1: nothing was written\n"));
    assert_int_equal(writes.requests, 0);
}

TEST(a_refused_0_leaves_it_right)
{
    begin(true, 2015, 0);
    begin_refused(2);
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 0);
    assert_string_equal(run->out, FAR ONE THERE TWO RIGHT
                        "offset: -15 mm or what it was before minus 15 mm; " EITHER "; flash writes: 1\n");
    assert_non_null(strstr(run->err, "fathom: hps167s:1: offset 0 mm was not written: "));
}

/* 11: a gateway has heard nothing of the device, which may have taken it. */
TEST(an_exception_that_is_no_refusal_is_as_none_at_all)
{
    writes.lost_write = 1;
    writes.is_taken = true;
    writes.exception = 11;
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(writes.requests, 3);
}

TEST(ctrl_c_says_what_was_written)
{
    bench.tool.ctrl_c_us = 5000000; /* the first measurement takes 3 s, the second 4 */
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, FAR ONE);
    assert_non_null(strstr(run->err,
                           "its offset is now, or from the next power-on: -15 mm or what it was before "
                           "minus 15 mm\n"));
}
