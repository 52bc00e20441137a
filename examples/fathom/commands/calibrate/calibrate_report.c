/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate_report.h"

#include <errno.h>
#include <inttypes.h>

#include "cli/command.h"

/* ---- on the way ---- */

bool calibrate_report_measurement(const session_t *session, const calibrate_plan_t *plan,
                                  const calibrate_batch_t *asked, const calibrate_measurement_t *measurement)
{
    const int32_t off_mm = measurement->median_mm - plan->known_mm;
    if (session->is_json) return true;
    errno = 0;
    (void)printf("%s: measured %" PRId32 " mm, the median of %" PRIu32 " (spread %" PRIu32
                 " mm); known %" PRId32 " mm",
                 session->station->name, measurement->median_mm, asked->samples, measurement->spread_mm,
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
    (void)fprintf(to, "%s%s: writing to flash, %zu of at most %d: offset %" PRId32 " mm%s\n",
                  session->is_json ? "fathom: " : "", session->station->name, plan->writes + 1,
                  CALIBRATE_WRITES, plan->write_mm,
                  plan->write_mm == 0 ? ", which shows whether #12 adds or replaces" : "");
    return session->is_json ? fflush(to) == 0 : output_flush() == 0;
}

/* ---- what has come of it ---- */

static void print_offset(FILE *to, const calibrate_offset_t *offset)
{
    if (!offset->is_added)
        (void)fprintf(to, "%" PRId32 " mm", offset->mm);
    else if (offset->mm == 0)
        (void)fputs("what it was before", to);
    else
        (void)fprintf(to, "what it was before %s %" PRId32 " mm", offset->mm < 0 ? "minus" : "plus",
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

static const char *rule_text(const calibrate_plan_t *plan)
{
    switch (plan->rule) {
    case CALIBRATE_ADDS:
        return "#12 adds to the offset before";
    case CALIBRATE_REPLACES:
        return "#12 replaces the offset before";
    default:
        return "whether #12 adds to the offset before or replaces it is not settled";
    }
}

static int32_t last_mm(const calibrate_plan_t *plan) { return plan->measured_mm[plan->measurements - 1]; }

static void print_right(const session_t *session, const calibrate_plan_t *plan)
{
    (void)printf("%s: it is right within %" PRId32 " mm: measured %" PRId32 " mm, known %" PRId32 " mm; ",
                 session->station->name, plan->tolerance_mm, last_mm(plan), plan->known_mm);
    if (plan->writes == 0) {
        (void)printf("nothing was written; %s\n", rule_text(plan));
        return;
    }
    (void)fputs("offset: ", stdout);
    print_offsets(stdout, plan);
    (void)printf("; %s; flash writes: %zu\n", rule_text(plan), plan->writes);
}

/* Why it has ended, where something was wrong that has not been said yet. */
static void print_why(const calibrate_plan_t *plan)
{
    const int32_t offset_mm = plan->writes != 0 ? plan->written_mm[plan->writes - 1] : 0;
    switch (plan->why) {
    case CALIBRATE_NOT_MOVED:
        (void)fprintf(
            stderr,
            "offset %" PRId32 " mm was acknowledged, and it measures %" PRId32
            " mm as before: it holds from the next power-on, or it is the offset that it had, or it was "
            "not taken",
            offset_mm, last_mm(plan));
        break;
    case CALIBRATE_NOT_SEEN:
        (void)fprintf(stderr,
                      "offset %" PRId32 " mm was not acknowledged, and it measures %" PRId32 " mm as before",
                      offset_mm, last_mm(plan));
        break;
    case CALIBRATE_UNCLEAR:
        (void)fprintf(stderr,
                      "%" PRId32 " mm after offset %" PRId32
                      " mm may be the distance as before as well as the "
                      "expected one: they are too near to be told apart within %" PRId32 " mm",
                      last_mm(plan), offset_mm, plan->tolerance_mm);
        break;
    case CALIBRATE_UNEXPECTED:
        (void)fprintf(stderr,
                      "%" PRId32 " mm after offset %" PRId32
                      " mm is not what it can be: sensor or target have moved",
                      last_mm(plan), offset_mm);
        break;
    case CALIBRATE_TOO_LARGE:
        (void)fputs("the offset that is right is beyond what #12 takes, -32768 to 32767 mm", stderr);
        break;
    default:
        (void)fputs("it was not finished", stderr);
        break;
    }
}

/* What is safe to do next. Of a first write that holds from the next power-on: where it adds, it is right then; where it
 * replaces an offset that is not 0, what is missing then makes it right, and another calibration would only go back. */
static void print_next(const calibrate_plan_t *plan)
{
    const bool is_unmoved = plan->why == CALIBRATE_NOT_MOVED || plan->why == CALIBRATE_NOT_SEEN;
    if (plan->rule == CALIBRATE_REPLACES) {
        (void)fputs("fathom: #12 replaces the offset before, so it may be calibrated again\n", stderr);
        return;
    }
    (void)fputs("fathom: switch its power off and on, then measure, before you calibrate again\n", stderr);
    if (is_unmoved && plan->writes == 1)
        (void)fprintf(stderr,
                      "fathom: if it measures as before then, write offset 0, switch it off and on, and "
                      "calibrate again; "
                      "if it\nfathom: measures X mm, neither right nor as before, #12 replaces, and the "
                      "right offset is "
                      "%" PRId32 " - X\n",
                      plan->written_mm[0] + plan->known_mm);
}

static void print_ended(const session_t *session, const calibrate_plan_t *plan)
{
    const char *const name = session->station->name;
    if (plan->why == CALIBRATE_DONE) return;
    (void)fflush(stdout);
    if (plan->why != CALIBRATE_REFUSED && plan->why != CALIBRATE_NOT_MEASURED) {
        (void)fprintf(stderr, "fathom: %s: ", name);
        print_why(plan);
        (void)fputs("\n", stderr);
    }
    if (plan->writes == 0) {
        (void)fprintf(stderr, "fathom: %s: nothing was written\n", name);
    } else if (!plan->is_right) {
        (void)fprintf(stderr,
                      "fathom: %s: nothing more is written (flash writes: %zu); its offset is now, or from "
                      "the next power-on: ",
                      name, plan->writes);
        print_offsets(stderr, plan);
        (void)fputs("\n", stderr);
        print_next(plan);
    }
}

static const char *const whys[] = {
    [CALIBRATE_DONE] = "done",
    [CALIBRATE_REFUSED] = "not written",
    [CALIBRATE_NOT_MEASURED] = "not measured",
    [CALIBRATE_NOT_MOVED] = "acknowledged, and it measures as before",
    [CALIBRATE_NOT_SEEN] = "not acknowledged, and it measures as before",
    [CALIBRATE_UNCLEAR] = "too near to be told apart",
    [CALIBRATE_UNEXPECTED] = "not what it can be",
    [CALIBRATE_TOO_LARGE] = "beyond what #12 takes",
};

static void print_json(const session_t *session, const calibrate_plan_t *plan, bool is_dry)
{
    static const char *const rules[] = {"null", "\"adds\"", "\"replaces\""};
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(plan, offsets);
    (void)printf("{\"sensor\": \"%s\", \"address\": %u, \"known_mm\": %" PRId32 ", \"measured_mm\": [",
                 session->station->model->name, session->station->address, plan->known_mm);
    for (size_t i = 0; i != plan->measurements; i++)
        (void)printf("%s%" PRId32, i == 0 ? "" : ", ", plan->measured_mm[i]);
    (void)printf("], \"spread_mm\": %" PRIu32 ", \"tolerance_mm\": %" PRId32 ", \"written_mm\": [",
                 plan->spread_mm, plan->tolerance_mm);
    for (size_t i = 0; i != plan->writes; i++)
        (void)printf("%s%" PRId32, i == 0 ? "" : ", ", plan->written_mm[i]);
    (void)printf("], \"would_write_mm\": ");
    if (is_dry)
        (void)printf("%" PRId32, plan->write_mm);
    else
        (void)fputs("null", stdout);
    (void)printf(", \"offsets\": [");
    for (size_t i = 0; i != count; i++)
        (void)printf("%s{\"mm\": %" PRId32 ", \"added_to_the_one_before\": %s}", i == 0 ? "" : ", ",
                     offsets[i].mm, offsets[i].is_added ? "true" : "false");
    (void)printf("], \"offset_12\": %s, \"right\": %s, \"outcome\": \"%s\"}\n", rules[plan->rule],
                 plan->is_right ? "true" : "false", is_dry ? "dry run" : whys[plan->why]);
}

int calibrate_report(const session_t *session, const calibrate_plan_t *plan, bool is_dry)
{
    errno = 0;
    if (session->is_json)
        print_json(session, plan, is_dry);
    else if (is_dry)
        (void)printf("%s: nothing was written; offset %" PRId32 " mm would be\n", session->station->name,
                     plan->write_mm);
    else if (plan->is_right)
        print_right(session, plan);
    if (!is_dry) print_ended(session, plan);
    if (output_flush() != 0) {
        (void)fprintf(stderr, "fathom: the output cannot be written; flash writes: %zu\n", plan->writes);
        return STATUS_FAILED;
    }
    return plan->is_right ? STATUS_OK : STATUS_FAILED;
}
