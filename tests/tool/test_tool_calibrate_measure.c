/* SPDX-License-Identifier: MIT */
/* fathom calibrate prints why it cannot measure, and writes nothing then. */
#include "tool_bench.h"

#include <string.h>

#include "sim/fault.h"

static void begin(int32_t mm)
{
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    bench.scene.value[0] = mm;
}

static int set_up(void **state)
{
    begin(2015);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

#define CALIBRATE "calibrate hps167s --port line --known 2000"

/* Ends, having written nothing; says this on stderr. */
static void writes_nothing(int status, const char *err, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s", line);
    if (run->status != status || strstr(run->err, err) == NULL || strstr(run->out, "writing") != NULL)
        fail_msg("%s: exit status %d\n%s%s", err, run->status, run->out, run->err);
    assert_int_equal(bench.hps167s.device.counters.writes, 0);
}

/* 11 mm up and down around 2015, evenly: a spread of 22. */
static int32_t noisy(void *ctx, uint8_t probe, uint32_t now_us)
{
    const int32_t most_mm = *(const int32_t *)ctx;
    static uint32_t n;
    return 2015 - most_mm + (int32_t)(n++ * 5 % (2u * (uint32_t)most_mm + 1));
}

static void begin_noisy(int32_t *most_mm)
{
    begin(2015);
    bench.hps167s.device.scene = (fathom_sim_scene_t){noisy, most_mm};
}

TEST(samples_that_differ_too_much_are_not_used)
{
    int32_t most_mm = 11;
    begin_noisy(&most_mm);
    writes_nothing(1,
                   "the samples differ by 22 mm, more than --spread 20. Hold the sensor and the target still",
                   CALIBRATE);
    writes_nothing(1, "fathom: hps167s:1: nothing was written.\n", CALIBRATE);
    /* half the spread is 11 mm, and d = -15 within twice that: the result may be ambiguous, but never wrong */
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE " --spread 22");
    const int off_mm = 15 + bench.hps167s.sensor.offset_mm;
    assert_true(run->status != 0 || (off_mm >= -11 && off_mm <= 11));
}

TEST(samples_that_differ_a_little_are_averaged)
{
    int32_t most_mm = 3;
    begin_noisy(&most_mm);
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    if (run->status != 0 || strstr(run->out, "right within 3 mm") == NULL) fail_msg("%s", run->out);
    assert_in_range(bench.hps167s.sensor.offset_mm + 18, 0, 6);
}

static int32_t moving(void *ctx, uint8_t probe, uint32_t now_us)
{
    const uint32_t begin_us = *(const uint32_t *)ctx;
    return 2015 + (int32_t)((now_us - begin_us) / 100000); /* 10 mm a second */
}

TEST(a_distance_that_moves_is_not_calibrated)
{
    uint32_t begin_us = bench.clock.now_us;
    bench.hps167s.device.scene = (fathom_sim_scene_t){moving, &begin_us};
    writes_nothing(1, "the median does not settle", CALIBRATE);
}

/* After a write the first measurement is one from before. */
static int32_t stale(void *ctx, uint8_t probe, uint32_t now_us)
{
    int32_t *const used = ctx;
    const int32_t offset_mm = bench.hps167s.sensor.offset_mm;
    const int32_t mm = 2015 - offset_mm + *used;
    *used = offset_mm;
    return mm;
}

TEST(samples_from_before_a_write_are_discarded)
{
    int32_t used = 0;
    bench.hps167s.device.scene = (fathom_sim_scene_t){stale, &used};
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    if (run->status != 0 || strstr(run->out, "right within 2 mm") == NULL) fail_msg("%s", run->out);
}

/* 6 mm up and down, in the first second. */
static int32_t noisy_at_first(void *ctx, uint8_t probe, uint32_t now_us)
{
    static uint32_t n;
    if (now_us - *(const uint32_t *)ctx > 1000000) return 2000;
    return 1997 + (int32_t)(n++ * 5 % 7);
}

TEST(of_two_batches_the_larger_spread_counts)
{
    uint32_t begin_us = bench.clock.now_us;
    bench.hps167s.device.scene = (fathom_sim_scene_t){noisy_at_first, &begin_us};
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    if (run->status != 0 || strstr(run->out, "spread 6 mm)") == NULL) fail_msg("%s", run->out);
    assert_non_null(strstr(run->out, "right within 3 mm"));
}

/* There in every second batch, which takes 0.46 s; 2 s are between two. */
static int32_t at_times(void *ctx, uint8_t probe, uint32_t now_us)
{
    return (now_us - *(const uint32_t *)ctx) % 4480000 < 1000000 ? FATHOM_SIM_NO_TARGET : 2000;
}

TEST(a_target_that_comes_and_goes_is_reported_as_missing)
{
    uint32_t begin_us = bench.clock.now_us;
    bench.hps167s.device.scene = (fathom_sim_scene_t){at_times, &begin_us};
    writes_nothing(1, "no target in range", CALIBRATE);
}

TEST(a_lost_response_is_requested_again)
{
    static fathom_sim_fault_t lossy;
    fathom_sim_fault_init(&lossy, 1);
    fathom_sim_fault_add(&lossy, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 3)->run = 4;
    fathom_sim_fault_attach(&lossy, &bench.line, &bench.hps167s.device);
    bench.scene.value[0] = 2000;
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(lossy.counters[FATHOM_SIM_FAULT_SILENCE], 4);
    begin(2000);
    fathom_sim_fault_init(&lossy, 1);
    fathom_sim_fault_add(&lossy, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 3)->run = 5;
    fathom_sim_fault_attach(&lossy, &bench.line, &bench.hps167s.device);
    writes_nothing(1, "cannot measure: no response", CALIBRATE);
}

/* What is in force of the offset, in 1/1000 mm: each measurement comes 1/100 nearer, so that it takes 1.85 s to 63 %. */
static int32_t filtered(void *ctx, uint8_t probe, uint32_t now_us)
{
    int32_t *const used = ctx;
    const int32_t offset_mm = bench.hps167s.sensor.offset_mm;
    *used += (offset_mm * 1000 - *used) / 100;
    return 2015 - offset_mm + (*used < 0 ? *used - 500 : *used + 500) / 1000; /* the device adds its offset */
}

TEST(calibrate_waits_for_a_slow_filter)
{
    int32_t used = 0;
    bench.hps167s.device.scene = (fathom_sim_scene_t){filtered, &used};
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    if (run->status != 0) fail_msg("%s%s", run->out, run->err);
    assert_in_range(bench.hps167s.sensor.offset_mm + 17, 0, 4);
}

TEST(without_a_distance_nothing_is_written)
{
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    writes_nothing(1, "no target in range. Aim the sensor at a flat, light target", CALIBRATE);
    bench.scene.value[0] = FATHOM_SIM_FAULT;
    writes_nothing(1, "the sensor reports a fault", CALIBRATE);
    bench.scene.value[0] = 79;
    writes_nothing(1, "the distance is below the range, 80 mm", CALIBRATE);
    bench_begin();
    writes_nothing(1, "cannot measure: no response", CALIBRATE);
}

/* Nothing there at the first `*ctx` measurements. */
static int32_t late_target(void *ctx, uint8_t probe, uint32_t now_us)
{
    unsigned *const left = ctx;
    if (*left == 0) return 2000;
    --*left;
    return FATHOM_SIM_NO_TARGET;
}

TEST(one_sample_without_a_target_does_not_stop_the_calibration)
{
    unsigned left = 1;
    bench.hps167s.device.scene = (fathom_sim_scene_t){late_target, &left};
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(left, 0);
}

TEST(wrong_usage)
{
    writes_nothing(2, "a16 has no distance offset. Only an hps167s has one.",
                   "calibrate a16 --port line --known 2000");
    writes_nothing(2, "--known is missing", "calibrate hps167s --port line");
    writes_nothing(2, "from 80 to 18000", "calibrate hps167s --port line --known 79");
    writes_nothing(2, "from 80 to 18000", "calibrate hps167s --port line --known 18001");
    writes_nothing(2, "from 5 to 200", CALIBRATE " --samples 4");
    writes_nothing(2, "from 5 to 200", CALIBRATE " --samples 201");
    writes_nothing(2, "'2000' is one word too many.", "calibrate hps167s --port line --known 2000 2000");
    writes_nothing(2, "--port is missing", "calibrate hps167s --known 2000");
}
