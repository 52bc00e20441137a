/* SPDX-License-Identifier: MIT */
/* A calibration plan against a model of every device that the datasheet allows: each old offset, each deviation, each
 * fate of each write. */
#include "commands/calibrate/calibrate.h"
#include "suite.h"

#include <stdlib.h>

/* ---- a device ---- */

/* What happens to a write. */
typedef enum { TAKEN, TAKEN_UNANSWERED, LOST, REFUSED, FATES } fate_t;

typedef struct {
    bool adds;
    bool is_later; /* an offset holds from the next power-on */
    int raw_mm;
    int used_mm; /* the offset in force, ... */
    int kept_mm; /* ... and the one in flash */
} device_t;

static void take(device_t *device, int offset_mm)
{
    device->kept_mm = offset_mm + (device->adds ? device->kept_mm : 0);
    if (!device->is_later) device->used_mm = device->kept_mm;
}

/* ---- a run ---- */

enum { KNOWN_MM = 2000, T_MM = 2, MOST_MM = 7 };

typedef struct {
    device_t device;
    int before_mm; /* the offset */
    fate_t fates[CALIBRATE_WRITES];
    int8_t errors_mm[CALIBRATE_MEASUREMENTS]; /* of the medians */
} run_t;

static calibration_t plan;
static calibrate_next_t why;
static unsigned whys[CALIBRATE_TOO_LARGE + 1];
static unsigned replacing; /* runs */

static void fail_run(const run_t *run, const char *what)
{
    fail_msg(
        "%s: %s%s, raw %d, before %d, fates %u %u, errors %d %d %d: measured %zu, wrote %zu: %d %d, why %d",
        what, run->device.adds ? "adds" : "replaces", run->device.is_later ? " later" : "",
        run->device.raw_mm, run->before_mm, run->fates[0], run->fates[1], run->errors_mm[0],
        run->errors_mm[1], run->errors_mm[2], plan.measurements, plan.writes, plan.written_mm[0],
        plan.written_mm[1], (int)why);
}

static bool lists_truth(const run_t *run)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(&plan, offsets);
    for (size_t i = 0; i != count; i++)
        if (offsets[i].mm + (offsets[i].is_added ? run->before_mm : 0) == run->device.kept_mm) return true;
    return false;
}

/* Returns the step after one more measurement. */
static calibrate_next_t measure(const run_t *run)
{
    const device_t *const device = &run->device;
    if (plan.measurements == CALIBRATE_MEASUREMENTS) fail_run(run, "too many measurements");
    return calibrate_measured(&plan, device->raw_mm + device->used_mm + run->errors_mm[plan.measurements], 3);
}

/* Runs a calibration and checks its claims. Exact: the medians have no error. Returns how far off the device is then. */
static int run_plan(run_t *run, bool is_exact)
{
    const device_t *const device = &run->device;
    bool is_lost = false;
    plan = (calibration_t){.known_mm = KNOWN_MM};
    while ((why = measure(run)) == CALIBRATE_WRITE) {
        if (plan.writes == CALIBRATE_WRITES) fail_run(run, "a third write");
        if (is_lost) fail_run(run, "a write after one that was lost");
        const fate_t fate = run->fates[plan.writes];
        if (fate == REFUSED) why = CALIBRATE_REFUSED;
        if (fate == REFUSED) break;
        if (fate != LOST) take(&run->device, plan.offset_mm);
        is_lost = fate == LOST;
        calibrate_wrote(&plan, fate == TAKEN);
    }
    const int off_mm = device->raw_mm + device->used_mm - KNOWN_MM;
    whys[why]++;
    replacing += plan.replaces;
    assert_int_equal(calibrate_tolerance_mm(plan.spread_mm), T_MM); /* half of 3, rounded up */
    if (plan.replaces && device->adds) fail_run(run, "it adds");
    if (!lists_truth(run)) fail_run(run, "it has another offset");
    if (why == CALIBRATE_RIGHT && abs(off_mm) > T_MM + !is_exact) fail_run(run, "it is not right");
    if (why == CALIBRATE_RIGHT && device->kept_mm != device->used_mm)
        fail_run(run, "not from the next power-on");
    return off_mm;
}

/* ---- all of them ---- */

static void each_device(void (*check)(const run_t *start))
{
    memset(whys, 0, sizeof whys);
    replacing = 0;
    for (unsigned kind = 0; kind != 4 * FATES * FATES; kind++)
        for (int before_mm = -MOST_MM; before_mm <= MOST_MM; before_mm++)
            for (int off_mm = -MOST_MM; off_mm <= MOST_MM; off_mm++) {
                const run_t start = {
                    .device = {(kind & 1) != 0, (kind & 2) != 0, KNOWN_MM + off_mm, before_mm, before_mm},
                    .before_mm = before_mm,
                    .fates = {(fate_t)(kind / 4 % FATES), (fate_t)(kind / 4 / FATES)}};
                check(&start);
            }
}

/* What can be done is done. */
static void check_exact(const run_t *start)
{
    run_t run = *start;
    const int off_mm = run_plan(&run, true);
    const bool is_right = why == CALIBRATE_RIGHT;
    const int d_mm = -(start->device.raw_mm - KNOWN_MM + start->before_mm);
    const bool is_same = !start->device.adds && abs(d_mm - start->before_mm) <= T_MM;
    for (size_t i = 0; i != CALIBRATE_WRITES; i++)
        if (start->fates[i] != TAKEN) return;
    if (abs(d_mm) <= T_MM) {
        if (plan.writes != 0 || !is_right) fail_run(start, "it was right");
        return;
    }
    if (start->device.is_later || is_same) {
        if (plan.writes != 1 || is_right) fail_run(start, "it does not move");
        return;
    }
    if (!is_right || abs(off_mm) > T_MM) fail_run(start, "it is not made right");
    const size_t writes = abs(start->before_mm) > T_MM && !start->device.adds ? 2 : 1;
    if (plan.writes != writes) fail_run(start, "another number of writes");
}

TEST(every_claim_holds_for_every_device_and_every_fate_of_its_writes)
{
    each_device(check_exact);
    /* the target does not move, and nothing is so far away */
    for (unsigned i = CALIBRATE_RIGHT; i <= CALIBRATE_TOO_LARGE; i++)
        assert_int_equal(whys[i] == 0, i == CALIBRATE_UNEXPECTED || i == CALIBRATE_NOT_MEASURED ||
                                           i == CALIBRATE_TOO_LARGE);
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
        (void)run_plan(&run, false);
    }
}

TEST(every_claim_holds_with_medians_off_by_half_the_tolerance) { each_device(check_noisy); }

/* ---- one at a time ---- */

TEST(the_tolerance_is_half_the_spread_and_2_mm_at_least)
{
    static const struct {
        int spread_mm;
        int tolerance_mm;
    } rows[] = {{0, 2}, {3, 2}, {4, 2}, {5, 3}, {20, 10}, {21, 11}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        const int spread_mm = rows[i].spread_mm;
        assert_int_equal(calibrate_tolerance_mm(spread_mm), rows[i].tolerance_mm);
        for (int sign = -1; sign <= 1; sign += 2) {
            const int off_mm = sign * rows[i].tolerance_mm;
            plan = (calibration_t){.known_mm = 2000};
            assert_int_equal(calibrate_measured(&plan, 2000 + off_mm, spread_mm), CALIBRATE_RIGHT);
            plan = (calibration_t){.known_mm = 2000};
            assert_int_equal(calibrate_measured(&plan, 2000 + off_mm + sign, spread_mm), CALIBRATE_WRITE);
            assert_int_equal(plan.offset_mm, -off_mm - sign);
        }
    }
}

/* A measurement, and the step that follows from it. */
typedef struct {
    int median_mm;
    int spread_mm;
    calibrate_next_t next;
    int offset_mm;        /* with CALIBRATE_WRITE: it is written */
    bool is_acknowledged; /* of the write */
} step_t;

static const struct {
    const char *name;
    int known_mm;
    step_t steps[CALIBRATE_MEASUREMENTS + 1]; /* a median of 0 ends them */
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
} conversations[] = {
    {"the largest spread sets the tolerance",
     2000,
     {{2100, 20, CALIBRATE_WRITE, -100, true}, {2010, 1, CALIBRATE_RIGHT, 0, false}},
     {{-100, false}, {-100, true}}},
    {"an offset over int16 is not written: 17920 + 14848 = 32768",
     18000,
     {{80, 0, CALIBRATE_WRITE, 17920, true}, {3152, 0, CALIBRATE_TOO_LARGE, 0, false}},
     {{17920, false}}},
    {"an offset of 17920 + 14847 = 32767 is written",
     18000,
     {{80, 0, CALIBRATE_WRITE, 17920, true}, {3153, 0, CALIBRATE_WRITE, 32767, true}},
     {{32767, false}}},
    {"an offset of -17920 - 14848 = -32768 is written",
     80,
     {{18000, 0, CALIBRATE_WRITE, -17920, true}, {14928, 0, CALIBRATE_WRITE, -32768, true}},
     {{-32768, false}}},
    {"an offset under int16 is not written",
     80,
     {{18000, 0, CALIBRATE_WRITE, -17920, true}, {14929, 0, CALIBRATE_TOO_LARGE, 0, false}},
     {{-17920, false}}},
    /* -15 and then 30 as if it replaced; in a device that adds, that has become 15 */
    {"a second write without success leaves the rule open",
     2000,
     {{2015, 0, CALIBRATE_WRITE, -15, true},
      {1955, 0, CALIBRATE_WRITE, 30, false},
      {2045, 0, CALIBRATE_UNEXPECTED, 0, false}},
     {{30, false}, {15, true}, {-15, false}, {-15, true}}},
    {"without a measurement the offset is the old one", 2000, {{0}}, {{0, true}}},
    {"without a measurement after a write there are two offsets",
     2000,
     {{2015, 0, CALIBRATE_WRITE, -15, true}},
     {{-15, false}, {-15, true}}},
    {"without a measurement after a write without acknowledgement there are three",
     2000,
     {{2015, 0, CALIBRATE_WRITE, -15, false}},
     {{-15, false}, {-15, true}, {0, true}}},
};

TEST(conversations_end_as_they_must)
{
    for (size_t i = 0; i != sizeof conversations / sizeof conversations[0]; i++) {
        calibrate_offset_t offsets[CALIBRATE_OFFSETS] = {{0, false}};
        plan = (calibration_t){.known_mm = conversations[i].known_mm};
        for (const step_t *step = conversations[i].steps; step->median_mm != 0; step++) {
            if (calibrate_measured(&plan, step->median_mm, step->spread_mm) != step->next)
                fail_msg("%s", conversations[i].name);
            if (step->next != CALIBRATE_WRITE) continue;
            assert_int_equal(plan.offset_mm, step->offset_mm);
            calibrate_wrote(&plan, step->is_acknowledged);
        }
        (void)calibrate_offsets(&plan, offsets);
        for (size_t j = 0; j != CALIBRATE_OFFSETS; j++)
            if (offsets[j].mm != conversations[i].offsets[j].mm ||
                offsets[j].is_added != conversations[i].offsets[j].is_added)
                fail_msg("%s: offset %zu is %d mm", conversations[i].name, j, offsets[j].mm);
    }
}
