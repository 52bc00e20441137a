/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_plan.h"

#include <string.h>

int32_t calibrate_tolerance_mm(uint32_t spread_mm)
{
    const int32_t half_mm = (int32_t)(spread_mm / 2 + spread_mm % 2);
    return half_mm > CALIBRATE_LEAST_TOLERANCE_MM ? half_mm : CALIBRATE_LEAST_TOLERANCE_MM;
}

void calibrate_start(calibrate_plan_t *plan, int32_t known_mm)
{
    memset(plan, 0, sizeof *plan);
    plan->next = CALIBRATE_MEASURE;
    plan->known_mm = known_mm;
    plan->tolerance_mm = calibrate_tolerance_mm(0);
}

static bool is_near(const calibrate_plan_t *plan, int32_t one_mm, int32_t other_mm)
{
    const int32_t apart_mm = one_mm < other_mm ? other_mm - one_mm : one_mm - other_mm;
    return apart_mm <= plan->tolerance_mm;
}

static void end(calibrate_plan_t *plan, calibrate_why_t why, bool is_right)
{
    plan->next = CALIBRATE_END;
    plan->why = why;
    plan->is_right = is_right;
}

static void propose(calibrate_plan_t *plan, int32_t offset_mm)
{
    if (offset_mm < INT16_MIN || offset_mm > INT16_MAX) {
        end(plan, CALIBRATE_TOO_LARGE, false);
        return;
    }
    plan->next = CALIBRATE_WRITE;
    plan->write_mm = offset_mm;
}

/* The measurement does not show that the sensor accepted the last write. */
static void end_in_doubt(calibrate_plan_t *plan, calibrate_why_t why)
{
    plan->certain_writes = plan->writes - 1;
    end(plan, why, false);
}

static void accept(calibrate_plan_t *plan) { plan->certain_writes = plan->writes; }

static void judge_write(calibrate_plan_t *plan, int32_t now_mm)
{
    const bool is_right = is_near(plan, now_mm, plan->known_mm);
    const bool is_unmoved = is_near(plan, now_mm, plan->measured_mm[plan->measurements - 2]);
    const bool is_second = plan->writes == CALIBRATE_WRITES;
    if (is_right && is_unmoved && !(is_second && plan->is_acknowledged)) {
        end_in_doubt(plan, CALIBRATE_UNCLEAR);
    } else if (is_right) {
        accept(plan);
        end(plan, CALIBRATE_DONE, true);
    } else if (is_unmoved) {
        end_in_doubt(plan, plan->is_acknowledged ? CALIBRATE_NOT_MOVED : CALIBRATE_NOT_SEEN);
    } else if (is_second) {
        plan->replaces = false; /* something else moved the first measurement */
        end(plan, CALIBRATE_UNEXPECTED, false);
    } else {
        accept(plan);
        plan->replaces = true;
        propose(plan, plan->written_mm[0] + plan->known_mm - now_mm);
    }
}

void calibrate_measured(calibrate_plan_t *plan, int32_t median_mm, uint32_t spread_mm)
{
    if (spread_mm > plan->spread_mm) plan->spread_mm = spread_mm;
    plan->tolerance_mm = calibrate_tolerance_mm(plan->spread_mm);
    plan->measured_mm[plan->measurements++] = median_mm;
    if (plan->writes != 0)
        judge_write(plan, median_mm);
    else if (is_near(plan, median_mm, plan->known_mm))
        end(plan, CALIBRATE_DONE, true);
    else
        propose(plan, plan->known_mm - median_mm);
}

void calibrate_not_measured(calibrate_plan_t *plan) { end(plan, CALIBRATE_NOT_MEASURED, false); }

void calibrate_wrote(calibrate_plan_t *plan, calibrate_outcome_t outcome)
{
    if (outcome == CALIBRATE_NOT_WRITTEN) {
        end(plan, CALIBRATE_REFUSED, false);
        return;
    }
    plan->written_mm[plan->writes++] = plan->write_mm;
    plan->is_acknowledged = outcome == CALIBRATE_ACKNOWLEDGED;
    if (plan->is_acknowledged) accept(plan);
    plan->next = CALIBRATE_MEASURE;
}

static size_t add(calibrate_offset_t offsets[CALIBRATE_OFFSETS], size_t count, int32_t mm, bool is_added)
{
    offsets[count] = (calibrate_offset_t){mm, is_added};
    return count + 1;
}

/* Adds the possible offsets of a sensor that has accepted the first `writes` writes. */
static size_t add_after(const calibrate_plan_t *plan, size_t writes,
                        calibrate_offset_t offsets[CALIBRATE_OFFSETS], size_t count)
{
    int32_t sum_mm = 0;
    for (size_t i = 0; i != writes; i++) sum_mm += plan->written_mm[i];
    if (writes != 0) count = add(offsets, count, plan->written_mm[writes - 1], false);
    if (!plan->replaces || writes == 0) count = add(offsets, count, sum_mm, true);
    return count;
}

size_t calibrate_offsets(const calibrate_plan_t *plan, calibrate_offset_t offsets[CALIBRATE_OFFSETS])
{
    const size_t count = add_after(plan, plan->writes, offsets, 0);
    if (plan->certain_writes == plan->writes) return count;
    return add_after(plan, plan->certain_writes, offsets, count);
}
