/* SPDX-License-Identifier: MIT */
#include "cli/options.h"
#include "commands/calibrate/calibrate_report.h"
#include "commands/commands.h"
#include "device/setting_text.h"

/* fathom calibrate finds the distance offset of an HPS-167S with a target at a known distance. calibrate_plan.h explains
 * the steps. */

static const char command[] = "calibrate";

/* Table 1 of the datasheet: its range. */
enum { LEAST_MM = 80, MOST_MM = 18000, SPREAD_MM = 20, MOST_SPREAD_MM = 1000 };

enum { SAMPLES = SESSION_OPTIONS, SPREAD, KNOWN, DRY_RUN, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
    [SAMPLES] = {"samples", required_argument, NULL, 256},
    [SPREAD] = {"spread", required_argument, NULL, 256},
    [KNOWN] = {"known", required_argument, NULL, 256},
    [DRY_RUN] = {"dry-run", no_argument, NULL, 256},
};

static session_t session;

/* Returns true if the sensor itself refused the write. Any other exception leaves the result open: the sensor failed (4),
 * or a gateway lost the request or the response (10, 11). */
static bool is_refusal(uint8_t exception)
{
    return exception == FATHOM_MODBUS_ILLEGAL_FUNCTION || exception == FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS ||
           exception == FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
}

static calibrate_outcome_t write_offset(const setting_t *setting, int32_t offset_mm)
{
    const fathom_status_t status = session_set(&session, setting, offset_mm);
    const reader_facts_t facts = reader_facts(session.station->reader);
    const bool is_refused = status == FATHOM_ERR_EXCEPTION && is_refusal(facts.exception);
    if (status == FATHOM_OK) return CALIBRATE_ACKNOWLEDGED;
    if (facts.is_written && !is_refused) return CALIBRATE_UNANSWERED;
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: offset %d mm was not written: ", session.station->name,
                  (int)offset_mm);
    session_explain(&session, status);
    (void)fputs("\n", stderr);
    return CALIBRATE_NOT_WRITTEN;
}

static void measure(calibrate_plan_t *plan, const calibrate_batch_t *batch)
{
    calibrate_measurement_t measurement = {0, 0};
    if (calibrate_measure(&session, batch, plan->writes != 0, &measurement) &&
        calibrate_report_measurement(&session, plan, batch, &measurement))
        calibrate_measured(plan, measurement.median_mm, measurement.spread_mm);
    else
        calibrate_not_measured(plan);
}

static int calibrate(calibrate_plan_t *plan, const calibrate_batch_t *batch, bool is_dry)
{
    const setting_t *const setting = setting_find(command, session.station->model->name,
                                                  session_settings(&session), session.station->model->offset);
    if (setting == NULL) return STATUS_USAGE;
    while (plan->next != CALIBRATE_END) {
        if (plan->next == CALIBRATE_MEASURE)
            measure(plan, batch);
        else if (is_dry)
            break;
        else
            calibrate_wrote(plan, calibrate_report_write(&session, plan)
                                      ? write_offset(setting, plan->write_mm)
                                      : CALIBRATE_NOT_WRITTEN);
    }
    return calibrate_report(&session, plan, plan->next == CALIBRATE_WRITE);
}

static void help(FILE *to)
{
    (void)fputs(
        "Find the distance offset of an HPS-167S (#12) with a target at a known distance, and write it.\n\n"
        "usage: fathom calibrate hps167s[:ADDRESS] --port PATH --known MM [OPTIONS]\n\n"
        "  --known MM        true distance from the sensor to the target, 80 to 18000\n"
        "  --samples N       samples of a measurement, 5 to 200; default 25\n"
        "  --spread MM       largest difference of these samples, 0 to 1000; default 20\n"
        "  --dry-run         measure, and print the offset without writing it\n",
        to);
    session_options_help(to);
    (void)fputs(
        "\nUse a flat, light target at a right angle, and let nothing move. The sensor is measured before "
        "and\n"
        "after each write until two medians agree. It is right within half the spread, and at least 2 mm.\n"
        "Flash is written at most twice, and each write is announced. A write without an acknowledgement is\n"
        "not repeated: the next measurement shows whether the sensor accepted it. If the command stops, it\n"
        "prints the offsets that the sensor may have. If an offset was written since the last power-on,\n"
        "switch the power off and on first.\n\n"
        "Exit status: 0 when the sensor is right, 1 when it is not (also with --dry-run) or that is "
        "unknown,\n"
        "2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom calibrate hps167s --port /dev/ttyUSB0 --known 2000 --dry-run\n"
        "  fathom calibrate hps167s:7 --port /dev/ttyUSB0 --known 2000 --samples 100\n",
        to);
}

static int run(const host_t *host, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    int status = STATUS_OK;
    uint32_t known_mm = 0;
    calibrate_batch_t batch = {.samples = CALIBRATE_SAMPLES, .spread_mm = SPREAD_MM};
    calibrate_plan_t plan;
    if (!session_options_of_one(&session, &calibrate_command, argc, argv, table, values, &status))
        return status;
    if (session.station->model->offset == NULL)
        return usage_error(command, "%s has no distance offset. Only hps167s has one",
                           session.station->model->name);
    if (values[KNOWN] == NULL)
        return usage_error(command, "--known is missing. It is the true distance of the target in mm");
    if (!option_number(command, "known", values[KNOWN], LEAST_MM, MOST_MM, &known_mm) ||
        !option_number(command, "samples", values[SAMPLES], CALIBRATE_LEAST_SAMPLES, CALIBRATE_MOST_SAMPLES,
                       &batch.samples) ||
        !option_number(command, "spread", values[SPREAD], 0, MOST_SPREAD_MM, &batch.spread_mm))
        return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    calibrate_start(&plan, (int32_t)known_mm);
    status = calibrate(&plan, &batch, values[DRY_RUN] != NULL);
    session_close(&session);
    return status;
}

const command_t calibrate_command = {.name = "calibrate",
                                     .summary = "finds the distance offset of an HPS-167S by measuring",
                                     .help = help,
                                     .run = run};
