/* SPDX-License-Identifier: MIT */
#include "cli/arguments.h"
#include "cli/session_options.h"
#include "commands/calibrate/calibrate_report.h"
#include "commands/commands.h"
#include "device/setting_text.h"

/* fathom calibrate finds the distance offset of an HPS-167S with a target at a known distance. calibrate_plan.h explains
 * the steps. */

/* Table 1 of the datasheet: its range. */
enum { LEAST_MM = 80, MOST_MM = 18000, SPREAD_MM = 20, MOST_SPREAD_MM = 1000 };

typedef struct {
    session_settings_t session;
    uint32_t known_mm;
    calibrate_batch_t batch;
    bool is_dry;
} calibrate_settings_t;

static const option_t rows[] = {
    {"known", "MM", "Set the true distance of the target", KIND_NUMBER, GROUP_COMMAND, .min = LEAST_MM,
     .max = MOST_MM, AT(calibrate_settings_t, known_mm), .is_required = true},
    {"samples", "N", "Measure with N samples (default 25)", KIND_NUMBER, GROUP_COMMAND,
     .min = CALIBRATE_LEAST_SAMPLES, .max = CALIBRATE_MOST_SAMPLES, AT(calibrate_settings_t, batch.samples)},
    {"spread", "MM", "Accept samples that differ by at most MM (default 20)", KIND_NUMBER, GROUP_COMMAND,
     .max = MOST_SPREAD_MM, AT(calibrate_settings_t, batch.spread_mm)},
    {"dry-run", .help = "Measure, and print the offset without writing it", .group = GROUP_COMMAND,
     AT(calibrate_settings_t, is_dry)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

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
    const reader_facts_t facts = reader_facts(session.sensor->reader);
    const bool is_refused = status == FATHOM_ERR_EXCEPTION && is_refusal(facts.exception);
    if (status == FATHOM_OK) return CALIBRATE_ACKNOWLEDGED;
    if (facts.is_written && !is_refused) return CALIBRATE_UNANSWERED;
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: offset %d mm was not written: ", session.sensor->name, (int)offset_mm);
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
    const setting_t *const setting = setting_of(session_settings(&session), session.sensor->model->offset);
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

static int start(const host_t *host, const arguments_t *arguments)
{
    calibrate_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    calibrate_plan_t plan;
    if (!arguments_have(arguments, "samples")) settings->batch.samples = CALIBRATE_SAMPLES;
    if (!arguments_have(arguments, "spread")) settings->batch.spread_mm = SPREAD_MM;
    if (!session_read(&session, arguments, 1, 0)) return STATUS_USAGE;
    if (session.sensor->model->offset == NULL) {
        (void)reject(&origin, "%s has no distance offset. Only an hps167s has one.",
                     session.sensor->model->name);
        return STATUS_USAGE;
    }
    if (!session_open(&session, host)) return STATUS_FAILED;
    calibrate_start(&plan, (int32_t)settings->known_mm);
    const int status = calibrate(&plan, &settings->batch, settings->is_dry);
    session_close(&session);
    return status;
}

const command_t calibrate_command = {
    .name = "calibrate",
    .summary = "Find the distance offset of an hps167s by measuring",
    .usage = "hps167s[:ADDRESS][@PORT] --known MM [OPTIONS]",
    .about = "Use a flat, light target at a right angle, and let nothing move. The distance is\n"
             "measured before and after each write. It is right within half the spread, and\n"
             "at least 2 mm. Flash is written at most twice. If an offset was written since\n"
             "the last power-on, switch the power off and on first.\n",
    .tables = tables,
    .common = "port known samples spread dry-run",
    .examples = "  fathom calibrate hps167s --port /dev/ttyUSB0 --known 2000 --dry-run\n"
                "  fathom calibrate hps167s:7 --port /dev/ttyUSB0 --known 2000 --samples 100\n",
    .status = "Exit status: 0 the sensor is right, 1 it is not (also with --dry-run) or that is\n"
              "unknown, 2 wrong usage.\n",
    .topics = "calibration, settings, ports",
    .operands = operands_resettable,
    .settings_size = sizeof(calibrate_settings_t),
    .start = start,
};
