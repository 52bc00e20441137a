/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_report.h"

#include <errno.h>
#include <inttypes.h>

#include "cli/command.h"

bool calibrate_report_measurement(const session_t *session, const calibrate_plan_t *plan,
                                  const calibrate_batch_t *batch, const calibrate_measurement_t *measurement)
{
    const int32_t off_mm = measurement->median_mm - plan->known_mm;
    if (session->is_json) return true;
    errno = 0;
    (void)printf("%s: measured %" PRId32 " mm (median of %" PRIu32 ", spread %" PRIu32 " mm), known %" PRId32
                 " mm",
                 session->sensor->name, measurement->median_mm, batch->samples, measurement->spread_mm,
                 plan->known_mm);
    if (off_mm != 0)
        (void)printf(": %" PRId32 " mm too %s", off_mm < 0 ? -off_mm : off_mm, off_mm < 0 ? "near" : "far");
    (void)fputs("\n", stdout);
    return output_flush() == 0;
}

bool calibrate_report_write(const session_t *session, const calibrate_plan_t *plan)
{
    FILE *const to = session->is_json ? stderr : stdout;
    errno = 0;
    (void)fprintf(to, "%s%s: writing offset %" PRId32 " mm to flash (write %zu of at most %d)\n",
                  session->is_json ? "fathom: " : "", session->sensor->name, plan->write_mm, plan->writes + 1,
                  CALIBRATE_WRITES);
    return session->is_json ? fflush(to) == 0 : output_flush() == 0;
}

/* ---- the result ---- */

static void print_offset(FILE *to, const calibrate_offset_t *offset)
{
    if (!offset->is_added)
        (void)fprintf(to, "%" PRId32 " mm", offset->mm);
    else if (offset->mm == 0)
        (void)fputs("the old offset", to);
    else
        (void)fprintf(to, "the old offset %s %" PRId32 " mm", offset->mm < 0 ? "minus" : "plus",
                      offset->mm < 0 ? -offset->mm : offset->mm);
}

static void print_offsets(FILE *to, const calibrate_plan_t *plan)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(plan, offsets);
    for (size_t i = 0; i != count; i++) {
        (void)fputs(i == 0 ? "" : i == count - 1 ? " or " : ", ", to);
        print_offset(to, &offsets[i]);
    }
}

static int32_t last_mm(const calibrate_plan_t *plan) { return plan->measured_mm[plan->measurements - 1]; }

static void print_right(const session_t *session, const calibrate_plan_t *plan)
{
    (void)printf("%s: right within %" PRId32 " mm: measured %" PRId32 " mm, known %" PRId32 " mm; ",
                 session->sensor->name, plan->tolerance_mm, last_mm(plan), plan->known_mm);
    if (plan->writes == 0) {
        (void)puts("nothing was written");
        return;
    }
    (void)fputs("offset: ", stdout);
    print_offsets(stdout, plan);
    (void)printf("; flash writes: %zu%s\n", plan->writes,
                 plan->replaces ? "; #12 replaces the old offset" : "");
}

static void print_why(const calibrate_plan_t *plan)
{
    const int32_t offset_mm = plan->writes != 0 ? plan->written_mm[plan->writes - 1] : 0;
    switch (plan->why) {
    case CALIBRATE_NOT_MOVED:
        (void)fprintf(stderr,
                      "offset %" PRId32 " mm was acknowledged, but the sensor still measures %" PRId32
                      " mm. The offset takes effect at the next power-on, or the sensor had this offset "
                      "already, or it did not accept it",
                      offset_mm, last_mm(plan));
        break;
    case CALIBRATE_NOT_SEEN:
        (void)fprintf(stderr,
                      "offset %" PRId32 " mm was not acknowledged, and the sensor still measures %" PRId32
                      " mm",
                      offset_mm, last_mm(plan));
        break;
    case CALIBRATE_UNCLEAR:
        (void)fprintf(stderr,
                      "the distance before offset %" PRId32 " mm and the known distance are within %" PRId32
                      " mm of each other, so %" PRId32
                      " mm does not show whether the sensor accepted the offset",
                      offset_mm, plan->tolerance_mm, last_mm(plan));
        break;
    case CALIBRATE_UNEXPECTED:
        (void)fprintf(stderr,
                      "%" PRId32 " mm after offset %" PRId32
                      " mm is not possible unless the sensor or the target has moved",
                      last_mm(plan), offset_mm);
        break;
    default:
        (void)fputs("the required offset does not fit into #12, -32768 to 32767 mm", stderr);
        break;
    }
}

/* If the first write takes effect only at the next power-on: a sensor that adds is right then. A sensor that replaces
 * lacks its old offset then, and another calibration would only restore the old state. */
static void print_next(const calibrate_plan_t *plan)
{
    const bool is_unmoved = plan->why == CALIBRATE_NOT_MOVED || plan->why == CALIBRATE_NOT_SEEN;
    if (plan->replaces) {
        (void)fputs("fathom: #12 replaces the old offset, so you can calibrate again.\n", stderr);
        return;
    }
    (void)fputs("fathom: before you calibrate again, switch the power off and on, and measure.\n", stderr);
    if (is_unmoved)
        (void)fprintf(stderr,
                      "fathom: if the sensor then measures as before, set distance-offset to 0, switch the "
                      "power off and on, and calibrate again.\n"
                      "fathom: if it measures another wrong distance X, #12 replaces the old offset, and the "
                      "right offset is %" PRId32 " - X.\n",
                      plan->written_mm[0] + plan->known_mm);
}

static void print_failure(const session_t *session, const calibrate_plan_t *plan)
{
    const char *const name = session->sensor->name;
    (void)fflush(stdout);
    /* the other two reasons were printed when they occurred */
    if (plan->why != CALIBRATE_REFUSED && plan->why != CALIBRATE_NOT_MEASURED) {
        (void)fprintf(stderr, "fathom: %s: ", name);
        print_why(plan);
        (void)fputs("\n", stderr);
    }
    if (plan->writes == 0) {
        (void)fprintf(stderr, "fathom: %s: nothing was written.\n", name);
        return;
    }
    (void)fprintf(stderr,
                  "fathom: %s: flash writes: %zu; the offset is now, or from the next power-on: ", name,
                  plan->writes);
    print_offsets(stderr, plan);
    (void)fputs("\n", stderr);
    print_next(plan);
}

static const char *const whys[] = {
    [CALIBRATE_DONE] = "right",
    [CALIBRATE_REFUSED] = "not_written",
    [CALIBRATE_NOT_MEASURED] = "not_measured",
    [CALIBRATE_NOT_MOVED] = "without_effect",
    [CALIBRATE_NOT_SEEN] = "not_acknowledged",
    [CALIBRATE_UNCLEAR] = "ambiguous",
    [CALIBRATE_UNEXPECTED] = "impossible_distance",
    [CALIBRATE_TOO_LARGE] = "offset_too_large",
};

static void print_list(json_t *json, const char *key, const int32_t *values, size_t count)
{
    json_begin(json, key, '[');
    for (size_t i = 0; i != count; i++) json_value(json, NULL, "%" PRId32, values[i]);
    json_end(json, ']');
}

static void print_json(const session_t *session, const calibrate_plan_t *plan, bool is_dry)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(plan, offsets);
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, session->sensor);
    json_value(&json, "address", "%u", session->sensor->address);
    json_string(&json, "status", is_dry ? "dry_run" : whys[plan->why]);
    json_value(&json, "known_mm", "%" PRId32, plan->known_mm);
    print_list(&json, "measured_mm", plan->measured_mm, plan->measurements);
    json_value(&json, "spread_mm", "%" PRIu32, plan->spread_mm);
    json_value(&json, "tolerance_mm", "%" PRId32, plan->tolerance_mm);
    print_list(&json, "written_mm", plan->written_mm, plan->writes);
    if (is_dry) json_value(&json, "would_write_mm", "%" PRId32, plan->write_mm);
    json_begin(&json, "offsets", '[');
    for (size_t i = 0; i != count; i++) {
        json_begin(&json, NULL, '{');
        json_value(&json, "offset_mm", "%" PRId32, offsets[i].mm);
        json_flag(&json, "is_added", offsets[i].is_added);
        json_end(&json, '}');
    }
    json_end(&json, ']');
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

int calibrate_report(const session_t *session, const calibrate_plan_t *plan, bool is_dry)
{
    errno = 0;
    if (session->is_json)
        print_json(session, plan, is_dry);
    else if (is_dry)
        (void)printf("%s: nothing was written; without --dry-run, offset %" PRId32 " mm would be\n",
                     session->sensor->name, plan->write_mm);
    else if (plan->is_right)
        print_right(session, plan);
    if (!is_dry && plan->why != CALIBRATE_DONE) print_failure(session, plan);
    if (output_flush() == 0) return plan->is_right ? STATUS_OK : STATUS_FAILED;
    (void)fprintf(stderr, "fathom: cannot write the output; flash writes: %zu.\n", plan->writes);
    return STATUS_FAILED;
}
