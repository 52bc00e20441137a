/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "commands/commands.h"
#include "commands/scan/scan.h"
#include "output/record.h"
#include "ports/line_text.h"
#include "sensors/models.h"

/* Prints "addresses 1 to 32 at 9600 8N1, 19200 8E1". */
static void print_plan(FILE *to, const scan_plan_t *plan)
{
    char settings[LINE_TEXT];
    if (plan->addresses.first == plan->addresses.last)
        (void)fprintf(to, "address %u at", plan->addresses.first);
    else
        (void)fprintf(to, "addresses %u to %u at", plan->addresses.first, plan->addresses.last);
    for (uint8_t i = 0; i != plan->setting_count; i++)
        (void)fprintf(to, "%s %s", i != 0 ? "," : "", line_text(&plan->settings[i], settings));
}

static int print_estimate(const scan_plan_t *plan, bool is_json)
{
    const uint64_t all_us = scan_plan_us(plan);
    if (is_json) {
        json_t json = {.to = stdout};
        json_begin(&json, NULL, '{');
        json_value(&json, "settings", "%u", plan->setting_count);
        json_value(&json, "addresses", "%" PRIu32, scan_address_count(plan));
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
    (void)fputs("fathom: asking ", stderr);
    print_plan(stderr, plan);
    (void)fprintf(stderr, " takes about %s, and a second for each sensor\n",
                  duration_text(scan_plan_us(plan), duration));
}

static fathom_status_t scan_line(scan_t *scan)
{
    announce(&scan->plan);
    scan->start_us = scan_now_us(scan);
    progress_init(&scan->progress, stderr, scan->start_us, scan_plan_us(&scan->plan));
    const fathom_status_t status = scan_listen(scan);
    return status != FATHOM_OK || (scan->has_sender && !scan->settings->wake) ? status : scan_walk(scan);
}

static int finish(scan_t *scan, fathom_status_t status)
{
    const host_t *const host = scan->port.host;
    progress_clear(&scan->progress);
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
        (void)fprintf(stderr,
                      "fathom: the scan ended before all addresses were asked. Sensors found: %" PRIu32 ".\n",
                      scan->sensors);
    return scan->sensors != 0 && scan->output_error == 0 && status != FATHOM_ERR_PORT ? STATUS_OK
                                                                                      : STATUS_FAILED;
}

static int run(scan_t *scan, const host_t *host)
{
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    if (!port_open_now(&scan->port, host,
                       &(port_settings_t){.path = scan->settings->port, .line = *scan_listen_line()})) {
        (void)fprintf(stderr, "fathom: %s\n", port_error(&scan->port));
        return STATUS_FAILED;
    }
    scan->port.parts.silence_us = scan_silence_us(&scan->plan);
    const int status = finish(scan, scan_line(scan));
    port_close(&scan->port);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static scan_t scan;
    const scan_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = "scan"};
    scan = (scan_t){.settings = settings, .port.watches_output = true};
    scan_make_plan(&scan.plan, settings);
    if (arguments->count != 0 && settings->port == NULL)
        (void)reject(&origin, "scan takes options only. Use --port %s.", arguments->words[0]);
    else if (arguments->count != 0)
        (void)reject(&origin, "scan takes options only, not '%s'.", arguments->words[0]);
    else if (settings->port == NULL && !settings->estimate)
        (void)reject(&origin,
                     "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
    else if (settings->port != NULL && !port_path_has_line(settings->port))
        (void)reject(&origin, "scan needs a serial port. The rates behind '%s' are those of the gateway.",
                     settings->port);
    else
        return settings->estimate ? print_estimate(&scan.plan, settings->is_json) : run(&scan, host);
    return STATUS_USAGE;
}

const command_t scan_command = {
    .name = "scan",
    .summary = "Find the sensors on a serial line",
    .usage = "--port PATH [OPTIONS]",
    .tables = scan_tables,
    .common = "port address baud wake format",
    .own_group = "Scan",
    .about = "It only reads: no request can change a setting. But even a read ends the\n"
             "automatic output of an A16 or A05, so the scan listens first, and sends nothing\n"
             "if a sensor sends. At an address where a device responds, other parities of the\n"
             "same rate are not tried.\n",
    .examples = "  fathom scan --port /dev/ttyUSB0\n"
                "  fathom scan --port /dev/ttyUSB0 --address 1-254 --baud all --parity all\n"
                "  fathom scan --port /dev/ttyUSB0 --baud 57600,115200 --format json\n",
    .status = "Exit status: 0 a sensor was found, 1 none was or the port failed, 2 wrong usage.\n",
    .topics = "trouble, ports, output",
    .settings_size = sizeof(scan_settings_t),
    .start = start,
};
