/* SPDX-License-Identifier: MIT */
/* A calibration plan against a model of every device that the datasheet allows: each old offset, each deviation, each
 * fate of each write. */
#include "commands/calibrate/calibrate_plan.h"
#include "suite.h"

/* ---- a device ---- */

/* What happens to a write. */
typedef enum { TAKEN, TAKEN_UNANSWERED, LOST, REFUSED, FATES } fate_t;

typedef struct {
    bool adds;
    bool is_later; /* an offset holds from the next power-on */
    int32_t raw_mm;
    int32_t used_mm; /* the offset in force, ... */
    int32_t kept_mm; /* ... and the one in flash */
} device_t;

static void take(device_t *device, int32_t offset_mm)
{
    device->kept_mm = offset_mm + (device->adds ? device->kept_mm : 0);
    if (!device->is_later) device->used_mm = device->kept_mm;
}

/* ---- a run ---- */

enum { KNOWN_MM = 2000, T_MM = 2, MOST_MM = 7 };

typedef struct {
    device_t device;
    int32_t before_mm; /* the offset */
    fate_t fates[CALIBRATE_WRITES];
    int8_t errors_mm[CALIBRATE_MEASUREMENTS]; /* of the medians */
} run_t;

static calibrate_plan_t plan;
static unsigned whys[CALIBRATE_TOO_LARGE + 1];
static unsigned replacing, refused; /* runs; writes */

static void fail_run(const run_t *run, const char *what)
{
    fail_msg(
        "%s: %s%s, raw %d, before %d, fates %u %u, errors %d %d %d: measured %zu, wrote %zu: %d %d, why %d",
        what, run->device.adds ? "adds" : "replaces", run->device.is_later ? " later" : "",
        (int)run->device.raw_mm, (int)run->before_mm, run->fates[0], run->fates[1], run->errors_mm[0],
        run->errors_mm[1], run->errors_mm[2], plan.measurements, plan.writes, (int)plan.written_mm[0],
        (int)plan.written_mm[1], (int)plan.why);
}

static bool lists_truth(const run_t *run)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(&plan, offsets);
    for (size_t i = 0; i != count; i++)
        if (offsets[i].mm + (offsets[i].is_added ? run->before_mm : 0) == run->device.kept_mm) return true;
    return false;
}

static int32_t size_of(int32_t mm) { return mm < 0 ? -mm : mm; }

/* Returns how far off it is in the end. */
static int32_t run_plan(run_t *run)
{
    device_t *const device = &run->device;
    size_t tries = 0;
    bool is_lost = false;
    refused = 0;
    calibrate_start(&plan, KNOWN_MM);
    while (plan.next != CALIBRATE_END) {
        if (plan.next == CALIBRATE_MEASURE) {
            if (plan.measurements == CALIBRATE_MEASUREMENTS) fail_run(run, "too many measurements");
            calibrate_measured(&plan, device->raw_mm + device->used_mm + run->errors_mm[plan.measurements],
                               3);
            continue;
        }
        if (tries == CALIBRATE_WRITES) fail_run(run, "a third write");
        if (is_lost) fail_run(run, "a write after one that was lost");
        const fate_t fate = run->fates[tries++];
        if (fate == TAKEN || fate == TAKEN_UNANSWERED) take(device, plan.write_mm);
        is_lost = fate == LOST;
        refused += fate == REFUSED;
        calibrate_wrote(&plan, fate == TAKEN     ? CALIBRATE_ACKNOWLEDGED
                               : fate == REFUSED ? CALIBRATE_NOT_WRITTEN
                                                 : CALIBRATE_UNANSWERED);
    }
    whys[plan.why]++;
    replacing += plan.replaces;
    assert_int_equal(plan.tolerance_mm, T_MM); /* of a spread of 3: half of it, rounded up */
    if (plan.writes + refused != tries) fail_run(run, "not all writes are counted");
    if (plan.replaces && device->adds) fail_run(run, "it adds");
    if (!lists_truth(run)) fail_run(run, "it has another offset");
    if (plan.why == CALIBRATE_DONE && !plan.is_right) fail_run(run, "done, and not right");
    return device->raw_mm + device->used_mm - KNOWN_MM;
}

/* ---- all of them ---- */

static void each_device(void (*check)(const run_t *start))
{
    memset(whys, 0, sizeof whys);
    replacing = 0;
    for (unsigned kind = 0; kind != 4 * FATES * FATES; kind++)
        for (int32_t before_mm = -MOST_MM; before_mm <= MOST_MM; before_mm++)
            for (int32_t off_mm = -MOST_MM; off_mm <= MOST_MM; off_mm++) {
                const run_t start = {
                    .device = {(kind & 1) != 0, (kind & 2) != 0, KNOWN_MM + off_mm, before_mm, before_mm},
                    .before_mm = before_mm,
                    .fates = {(fate_t)(kind / 4 % FATES), (fate_t)(kind / 4 / FATES)}};
                check(&start);
            }
}

/* What can be done is done. */
static void check_good(const run_t *start, int32_t off_mm)
{
    const int32_t d_mm = -(start->device.raw_mm - KNOWN_MM + start->before_mm);
    const bool is_same = !start->device.adds && size_of(d_mm - start->before_mm) <= T_MM;
    for (size_t i = 0; i != CALIBRATE_WRITES; i++)
        if (start->fates[i] != TAKEN) return;
    if (size_of(d_mm) <= T_MM) {
        if (plan.writes != 0 || !plan.is_right) fail_run(start, "it was right");
        return;
    }
    if (start->device.is_later || is_same) {
        if (plan.writes != 1 || plan.is_right) fail_run(start, "it does not move");
        return;
    }
    if (!plan.is_right || size_of(off_mm) > T_MM) fail_run(start, "it is not made right");
    const size_t writes = size_of(start->before_mm) > T_MM && !start->device.adds ? 2 : 1;
    if (plan.writes != writes) fail_run(start, "another number of writes");
}

static void check_exact(const run_t *start)
{
    run_t run = *start;
    const int32_t off_mm = run_plan(&run);
    if (plan.is_right && size_of(off_mm) > T_MM) fail_run(&run, "it is not right");
    if (plan.is_right && run.device.kept_mm != run.device.used_mm)
        fail_run(&run, "not from the next power-on");
    check_good(start, off_mm);
}

TEST(every_claim_holds_for_every_device_and_every_fate_of_its_writes)
{
    each_device(check_exact);
    assert_true(whys[CALIBRATE_DONE] > 0 && whys[CALIBRATE_REFUSED] > 0 && whys[CALIBRATE_NOT_MOVED] > 0 &&
                whys[CALIBRATE_NOT_SEEN] > 0 && whys[CALIBRATE_UNCLEAR] > 0);
    /* the target does not move, and nothing is so far away */
    assert_int_equal(whys[CALIBRATE_UNEXPECTED] + whys[CALIBRATE_NOT_MEASURED] + whys[CALIBRATE_TOO_LARGE],
                     0);
    assert_true(replacing > 0);
}

/* Medians that are off by up to half the tolerance, so that two of them differ by up to T. */
static void check_noisy(const run_t *start)
{
    for (unsigned errors = 0; errors != 3 * 3 * 3; errors++) {
        run_t run = *start;
        unsigned rest = errors;
        for (size_t i = 0; i != CALIBRATE_MEASUREMENTS; i++, rest /= 3)
            run.errors_mm[i] = (int8_t)((int)(rest % 3) - 1);
        const int32_t off_mm = run_plan(&run);
        if (plan.is_right && size_of(off_mm) > T_MM + 1) fail_run(&run, "it is not right");
        if (plan.is_right && run.device.kept_mm != run.device.used_mm)
            fail_run(&run, "not from the next power-on");
    }
}

TEST(every_claim_holds_with_medians_off_by_half_the_tolerance) { each_device(check_noisy); }

/* ---- one at a time ---- */

static void measured(int32_t median_mm) { calibrate_measured(&plan, median_mm, 0); }

TEST(the_tolerance_is_half_the_spread_and_2_mm_at_least)
{
    static const struct {
        uint32_t spread_mm;
        int32_t tolerance_mm;
    } rows[] = {{0, 2}, {3, 2}, {4, 2}, {5, 3}, {20, 10}, {21, 11}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(calibrate_tolerance_mm(rows[i].spread_mm), rows[i].tolerance_mm);
        for (int sign = -1; sign <= 1; sign += 2) {
            calibrate_start(&plan, 2000);
            calibrate_measured(&plan, 2000 + sign * rows[i].tolerance_mm, rows[i].spread_mm);
            assert_true(plan.next == CALIBRATE_END && plan.is_right && plan.why == CALIBRATE_DONE);
            calibrate_start(&plan, 2000);
            calibrate_measured(&plan, 2000 + sign * (rows[i].tolerance_mm + 1), rows[i].spread_mm);
            assert_int_equal(plan.next, CALIBRATE_WRITE);
            assert_int_equal(plan.write_mm, -sign * (rows[i].tolerance_mm + 1));
        }
    }
}

TEST(the_largest_spread_sets_the_tolerance)
{
    calibrate_start(&plan, 2000);
    calibrate_measured(&plan, 2100, 20);
    calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
    calibrate_measured(&plan, 2010, 1);
    assert_true(plan.next == CALIBRATE_END && plan.is_right);
    assert_int_equal(plan.tolerance_mm, 10);
}

/* 18000 - 80 = 17920 is written first, and replaces; what is then missing is added to it. */
TEST(an_offset_beyond_int16_is_not_written)
{
    calibrate_start(&plan, 18000);
    measured(80);
    assert_int_equal(plan.write_mm, 17920);
    calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
    measured(3152); /* 17920 + 14848 = 32768 */
    assert_true(plan.next == CALIBRATE_END && plan.why == CALIBRATE_TOO_LARGE && !plan.is_right);
    calibrate_start(&plan, 18000);
    measured(80);
    calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
    measured(3153); /* 17920 + 14847 = 32767 */
    assert_true(plan.next == CALIBRATE_WRITE && plan.write_mm == 32767);
    for (int32_t more_mm = 0; more_mm <= 1; more_mm++) {
        calibrate_start(&plan, 80);
        measured(18000);
        calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
        measured(14928 + more_mm); /* -17920 - 14848 = -32768 */
        assert_int_equal(plan.next, more_mm == 0 ? CALIBRATE_WRITE : CALIBRATE_END);
    }
    assert_int_equal(plan.why, CALIBRATE_TOO_LARGE);
}

/* -15 and then 30 as if it replaced; where it adds, that has become 15. */
TEST(a_second_write_without_success_leaves_the_rule_open)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    calibrate_start(&plan, 2000);
    measured(2015);
    calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
    measured(1955);
    assert_true(plan.next == CALIBRATE_WRITE && plan.write_mm == 30);
    calibrate_wrote(&plan, CALIBRATE_UNANSWERED);
    measured(2045);
    assert_true(plan.next == CALIBRATE_END && plan.why == CALIBRATE_UNEXPECTED && !plan.is_right);
    assert_false(plan.replaces);
    assert_int_equal(calibrate_offsets(&plan, offsets), 4);
    assert_true(offsets[0].mm == 30 && !offsets[0].is_added && offsets[1].mm == 15 && offsets[1].is_added);
    assert_true(offsets[2].mm == -15 && !offsets[2].is_added && offsets[3].mm == -15 && offsets[3].is_added);
}

TEST(without_a_measurement_the_sensor_is_not_right)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    calibrate_start(&plan, 2000);
    calibrate_not_measured(&plan);
    assert_true(plan.next == CALIBRATE_END && !plan.is_right && plan.writes == 0);
    assert_int_equal(calibrate_offsets(&plan, offsets), 1);
    assert_true(offsets[0].mm == 0 && offsets[0].is_added);
    calibrate_start(&plan, 2000);
    measured(2015);
    calibrate_wrote(&plan, CALIBRATE_ACKNOWLEDGED);
    calibrate_not_measured(&plan);
    assert_true(plan.next == CALIBRATE_END && !plan.is_right && plan.why == CALIBRATE_NOT_MEASURED);
    assert_int_equal(calibrate_offsets(&plan, offsets), 2); /* -15, or 15 less than before */
    calibrate_start(&plan, 2000);
    measured(2015);
    calibrate_wrote(&plan, CALIBRATE_UNANSWERED);
    calibrate_not_measured(&plan);
    assert_int_equal(calibrate_offsets(&plan, offsets), 3); /* or as before */
}
