/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "commands/commands.h"
#include "commands/scan/scan.h"
#include "commands/scan/scan_report.h"
#include "output/json.h"
#include "ports/line_text.h"
#include "sensors/models.h"

uint64_t scan_now_us(const scan_t *scan) { return scan->port.host->now_us(scan->port.host->ctx); }

void scan_report(scan_t *scan, const scan_finding_t *finding)
{
    const scan_options_t *const options = &scan->options;
    scan_progress_clear(&scan->progress);
    errno = 0;
    if (options->is_json)
        scan_print_json(stdout, finding, options->port);
    else
        scan_print_text(stdout, finding, options->port);
    scan->output_error = output_flush();
    scan_print_advice(stderr, finding);
    if (finding->kind != SCAN_SENSOR) return;
    scan->sensors++;
    if (finding->has_config && finding->has_termination) scan->terminations++;
    if (scan->has_sender && finding->model == scan->sender.model && finding->mode != SCAN_AUTO)
        scan->awakened++;
}

void scan_show_progress(scan_t *scan)
{
    const uint64_t now = scan_now_us(scan);
    char settings[LINE_TEXT];
    char doing[LINE_TEXT + 16] = "listens";
    if (scan->line != NULL)
        (void)snprintf(doing, sizeof doing, "%s address %u", line_text(scan->line, settings), scan->address);
    scan_progress_show(
        &scan->progress, now,
        scan->line != NULL ? scan->options.plan.listen_us + scan->done_us : now - scan->start_us, doing);
}

/* Prints "addresses 1 to 32 at 9600 8N1, 19200 8E1". */
static void print_plan(FILE *to, const scan_plan_t *plan)
{
    char settings[LINE_TEXT];
    if (plan->first == plan->last)
        (void)fprintf(to, "address %u at", plan->first);
    else
        (void)fprintf(to, "addresses %u to %u at", plan->first, plan->last);
    for (uint8_t i = 0; i != plan->setting_count; i++)
        (void)fprintf(to, "%s %s", i != 0 ? "," : "", line_text(&plan->settings[i], settings));
}

static int print_estimate(const scan_options_t *options)
{
    const scan_plan_t *const plan = &options->plan;
    const uint64_t all_us = scan_plan_us(plan);
    if (options->is_json) {
        json_t json = {.to = stdout};
        json_begin(&json, NULL, '{');
        json_value(&json, "settings", "%u", plan->setting_count);
        json_value(&json, "addresses", "%" PRIu32, scan_addresses(plan));
        json_value(&json, "duration_s", "%" PRIu64, (all_us + 999999u) / 1000000u);
        json_end(&json, '}');
        (void)puts("");
    } else {
        char duration[DURATION_TEXT];
        print_plan(stdout, plan);
        (void)printf(": about %s, and a second for each sensor\n", duration_text(all_us, duration));
    }
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static void announce(const scan_plan_t *plan)
{
    char duration[DURATION_TEXT];
    (void)fputs("fathom: asks ", stderr);
    print_plan(stderr, plan);
    (void)fprintf(stderr, "; takes about %s, and a second for each sensor\n",
                  duration_text(scan_plan_us(plan), duration));
}

static fathom_status_t scan_line(scan_t *scan)
{
    announce(&scan->options.plan);
    scan->start_us = scan_now_us(scan);
    scan_progress_begin(&scan->progress, stderr, scan_plan_us(&scan->options.plan));
    const fathom_status_t status = scan_listen(scan);
    return status != FATHOM_OK || (scan->has_sender && !scan->options.wake) ? status : scan_walk(scan);
}

static int finish(scan_t *scan, fathom_status_t status)
{
    const host_t *const host = scan->port.host;
    scan_progress_clear(&scan->progress);
    if (scan->output_error == EINTR && host->has_ended(host->ctx)) scan->output_error = 0;
    /* The reader of a pipe has read enough, as head does. That needs no message. */
    if (scan->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (status == FATHOM_OK && scan->has_sender && scan->awakened == 0) scan_report(scan, &scan->sender);
    if (status == FATHOM_OK && scan->output_error == 0) scan_print_result(scan);
    if (scan->output_error != 0)
        (void)fprintf(stderr, "fathom: cannot write the output: %s\n", strerror(scan->output_error));
    else if (status == FATHOM_ERR_PORT)
        scan_print_port_failure(scan);
    else if (status != FATHOM_OK)
        (void)fprintf(stderr, "fathom: ended before all addresses were asked; sensors found: %" PRIu32 "\n",
                      scan->sensors);
    return scan->sensors != 0 && scan->output_error == 0 && status != FATHOM_ERR_PORT ? STATUS_OK
                                                                                      : STATUS_FAILED;
}

static int run(const host_t *host, int argc, char **argv)
{
    static scan_t scan;
    memset(&scan, 0, sizeof scan);
    if (!scan_options(&scan.options, argc, argv)) return STATUS_USAGE;
    if (scan.options.wants_help) return command_help(&scan_command);
    if (scan.options.estimate) return print_estimate(&scan.options);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    scan.port.watches_output = true;
    if (!port_open_now(&scan.port, host,
                       &(port_settings_t){.path = scan.options.port, .line = *scan_listen_line()})) {
        (void)fprintf(stderr, "fathom: %s\n", port_error(&scan.port));
        return STATUS_FAILED;
    }
    scan.port.parts.silence_us = scan_silence_us(&scan.options.plan);
    const int status = finish(&scan, scan_line(&scan));
    port_close(&scan.port);
    return status;
}

const command_t scan_command = {
    .name = "scan", .summary = "finds sensors on a serial port", .help = scan_help, .run = run};
