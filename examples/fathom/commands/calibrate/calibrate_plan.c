/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_plan.h"

#include <string.h>

/* What was written before the measurement that is due; the numbers are those of the header. */
enum { STEP_FIRST = 1, STEP_CORRECTED, STEP_SETTLING, STEP_REPLACED };

int32_t calibrate_tolerance_mm(uint32_t spread_mm)
{
    const int32_t half_mm = (int32_t)(spread_mm / 2 + spread_mm % 2);
    return half_mm > CALIBRATE_LEAST_TOLERANCE_MM ? half_mm : CALIBRATE_LEAST_TOLERANCE_MM;
}

void calibrate_begin(calibrate_plan_t *plan, int32_t known_mm, bool settles)
{
    memset(plan, 0, sizeof *plan);
    plan->next = CALIBRATE_MEASURE;
    plan->known_mm = known_mm;
    plan->tolerance_mm = calibrate_tolerance_mm(0);
    plan->settles = settles;
    plan->step = STEP_FIRST;
}

static bool is_near(const calibrate_plan_t *plan, int32_t one_mm, int32_t other_mm)
{
    const int32_t apart_mm = one_mm < other_mm ? other_mm - one_mm : one_mm - other_mm;
    return apart_mm <= plan->tolerance_mm;
}

static int32_t last_mm(const calibrate_plan_t *plan) { return plan->measured_mm[plan->measurements - 1]; }

/* is_right is said by the caller, who knows whether the last measurement still holds. */
static void end(calibrate_plan_t *plan, calibrate_why_t why, bool is_right)
{
    plan->next = CALIBRATE_END;
    plan->why = why;
    plan->is_right = is_right;
}

static void propose(calibrate_plan_t *plan, int32_t offset_mm, uint8_t step)
{
    if (offset_mm < INT16_MIN || offset_mm > INT16_MAX) {
        end(plan, CALIBRATE_TOO_LARGE, false);
        return;
    }
    plan->next = CALIBRATE_WRITE;
    plan->write_mm = offset_mm;
    plan->step = step;
}

/* The last write was taken. */
static void taken(calibrate_plan_t *plan) { plan->surely = plan->writes; }

/* It measures as before the last write. */
static void end_unmoved(calibrate_plan_t *plan)
{
    plan->surely = plan->writes - 1;
    end(plan, plan->is_acknowledged ? CALIBRATE_NOT_MOVED : CALIBRATE_NOT_SEEN, false);
}

static void end_unclear(calibrate_plan_t *plan)
{
    plan->surely = plan->writes - 1;
    end(plan, CALIBRATE_UNCLEAR, false);
}

static void take_first(calibrate_plan_t *plan, int32_t now_mm)
{
    if (is_near(plan, now_mm, plan->known_mm))
        end(plan, CALIBRATE_DONE, true);
    else
        propose(plan, plan->known_mm - now_mm, STEP_CORRECTED);
}

static void take_corrected(calibrate_plan_t *plan, int32_t now_mm)
{
    const bool is_there = is_near(plan, now_mm, plan->known_mm);
    const bool is_unmoved = is_near(plan, now_mm, plan->measured_mm[0]);
    if (is_there && is_unmoved) {
        end_unclear(plan);
    } else if (is_unmoved) {
        end_unmoved(plan);
    } else if (!is_there) {
        taken(plan);
        plan->rule = CALIBRATE_REPLACES;
        propose(plan, plan->written_mm[0] + plan->known_mm - now_mm, STEP_REPLACED);
    } else {
        taken(plan);
        if (plan->settles)
            propose(plan, 0, STEP_SETTLING);
        else
            end(plan, CALIBRATE_DONE, true);
    }
}

static void take_settling(calibrate_plan_t *plan, int32_t now_mm)
{
    const int32_t before_mm = plan->measured_mm[plan->measurements - 2];
    const bool is_unmoved = is_near(plan, now_mm, before_mm);
    const bool is_without = is_near(plan, now_mm, before_mm - plan->written_mm[0]);
    if (is_unmoved && is_without) {
        end_unclear(plan);
    } else if (is_without) {
        taken(plan);
        plan->rule = CALIBRATE_REPLACES;
        propose(plan, plan->known_mm - now_mm, STEP_REPLACED);
    } else if (!is_unmoved) {
        end(plan, CALIBRATE_UNEXPECTED, false);
    } else {
        const bool is_right = is_near(plan, now_mm, plan->known_mm);
        /* not acknowledged, it was not taken, or it adds and makes no difference */
        if (plan->is_acknowledged) plan->rule = CALIBRATE_ADDS;
        end(plan, plan->is_acknowledged ? CALIBRATE_DONE : CALIBRATE_NOT_SEEN, is_right);
        if (plan->is_acknowledged && !is_right) plan->why = CALIBRATE_UNEXPECTED;
    }
}

static void take_replaced(calibrate_plan_t *plan, int32_t now_mm)
{
    const bool is_there = is_near(plan, now_mm, plan->known_mm);
    const bool is_unmoved = is_near(plan, now_mm, plan->measured_mm[plan->measurements - 2]);
    if (is_there && (!is_unmoved || plan->is_acknowledged)) {
        taken(plan);
        end(plan, CALIBRATE_DONE, true);
    } else if (is_there) {
        end_unclear(plan);
    } else if (is_unmoved) {
        end_unmoved(plan);
    } else {
        plan->rule = CALIBRATE_UNSETTLED; /* what showed it was something else */
        end(plan, CALIBRATE_UNEXPECTED, false);
    }
}

void calibrate_measured(calibrate_plan_t *plan, int32_t median_mm, uint32_t spread_mm)
{
    if (spread_mm > plan->spread_mm) plan->spread_mm = spread_mm;
    plan->tolerance_mm = calibrate_tolerance_mm(plan->spread_mm);
    plan->measured_mm[plan->measurements++] = median_mm;
    switch (plan->step) {
    case STEP_FIRST:
        take_first(plan, median_mm);
        break;
    case STEP_CORRECTED:
        take_corrected(plan, median_mm);
        break;
    case STEP_SETTLING:
        take_settling(plan, median_mm);
        break;
    default:
        take_replaced(plan, median_mm);
        break;
    }
}

void calibrate_not_measured(calibrate_plan_t *plan) { end(plan, CALIBRATE_NOT_MEASURED, false); }

void calibrate_wrote(calibrate_plan_t *plan, calibrate_outcome_t outcome)
{
    if (outcome == CALIBRATE_NOT_WRITTEN) {
        end(plan, CALIBRATE_REFUSED, is_near(plan, last_mm(plan), plan->known_mm));
        return;
    }
    plan->written_mm[plan->writes++] = plan->write_mm;
    plan->is_acknowledged = outcome == CALIBRATE_ACKNOWLEDGED;
    if (plan->is_acknowledged) taken(plan);
    plan->next = CALIBRATE_MEASURE;
}

static size_t add(calibrate_offset_t offsets[CALIBRATE_OFFSETS], size_t count, int32_t mm, bool is_added)
{
    for (size_t i = 0; i != count; i++)
        if (offsets[i].mm == mm && offsets[i].is_added == is_added) return count;
    if (count == CALIBRATE_OFFSETS) return count;
    offsets[count] = (calibrate_offset_t){mm, is_added};
    return count + 1;
}

/* With so many writes taken. */
static size_t add_after(const calibrate_plan_t *plan, size_t writes,
                        calibrate_offset_t offsets[CALIBRATE_OFFSETS], size_t count)
{
    int32_t sum_mm = 0;
    for (size_t i = 0; i != writes; i++) sum_mm += plan->written_mm[i];
    if (plan->rule != CALIBRATE_ADDS && writes != 0)
        count = add(offsets, count, plan->written_mm[writes - 1], false);
    if (plan->rule != CALIBRATE_REPLACES || writes == 0) count = add(offsets, count, sum_mm, true);
    return count;
}

size_t calibrate_offsets(const calibrate_plan_t *plan, calibrate_offset_t offsets[CALIBRATE_OFFSETS])
{
    /* that it measures as before a 0 excludes that the 0 has replaced something */
    const bool is_excluded = plan->why == CALIBRATE_NOT_SEEN && plan->step == STEP_SETTLING;
    size_t count = 0;
    if (!is_excluded) count = add_after(plan, plan->writes, offsets, count);
    if (plan->surely != plan->writes) count = add_after(plan, plan->surely, offsets, count);
    return count;
}
