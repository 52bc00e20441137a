/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "commands/scan/scan.h"
#include "diagnosis/advice.h"
#include "sensors/models.h"

static void print_why_nothing_was_sent(const scan_finding_t *sender)
{
    (void)fputs("fathom: nothing was sent, because ", stderr);
    if (sender->kind == SCAN_MASTER)
        (void)fputs(
            "another master sends requests on this line. Disconnect it or stop its program, and scan again",
            stderr);
    else if (sender->kind == SCAN_SENDER && sender->address == 0)
        (void)fputs("a device sends without a request. An HPS-167S made before 2020-09 has another protocol. "
                    "Another rate, swapped wires A and B and noise have the same effect",
                    stderr);
    else if (sender->mode == SCAN_AUTO)
        (void)fprintf(stderr, "even a read ends %s", sender->model->request_ends);
    else
        (void)fputs("requests would collide with its unsolicited frames", stderr);
    (void)fputs(". To ask anyway, use --wake.\n", stderr);
}

static void print_sender(const scan_t *scan)
{
    if (!scan->settings->wake) {
        print_why_nothing_was_sent(&scan->sender);
    } else if (scan->awakened != 0 && scan->sender.mode == SCAN_AUTO) {
        const char *const again = scan->sender.model->automatic_again;
        (void)fprintf(
            stderr,
            "fathom: the sensor sent automatically until the scan asked it. It sends again after a power "
            "cycle%s.\n",
            again != NULL ? again : "");
    }
}

static failure_t failure_of(const scan_t *scan, fathom_status_t status)
{
    failure_t failure = failure_of_request(status, &scan->port);
    failure.evidence.bytes = scan->heard.bytes;
    failure.evidence.echoes = scan->heard.echoes;
    failure.is_scan = true;
    return failure;
}

static void print_cause(const scan_t *scan, fathom_status_t status)
{
    failure_t failure = failure_of(scan, status);
    failure.evidence.masters = scan->heard.has_master;
    failure.evidence.masters_address = scan->heard.master_address;
    advice_print_cause(stderr, &failure);
    (void)fputs(". Then scan again\n", stderr);
}

static bool is_default(const scan_settings_t *settings)
{
    return !settings->has_addresses && settings->rates.count == 0 && settings->parities == 0 &&
           settings->stop_bits == 0;
}

static void print_nothing(const scan_t *scan)
{
    const failure_t failure = failure_of(scan, FATHOM_ERR_NO_RESPONSE);
    (void)fputs("fathom: ", stderr);
    if (scan->heard.not_asked != 0)
        (void)fputs("no sensor was found", stderr);
    else
        advice_print(stderr, &failure);
    if (is_default(scan->settings))
        (void)fprintf(stderr,
                      ". To find a sensor with other settings, run 'fathom scan --port %s --address 1-254 "
                      "--baud all --parity all' (about 7 minutes)",
                      scan->settings->port);
    (void)fputs(". A sensor that was just switched on may need 5 s\n", stderr);
}

void scan_print_port_failure(const scan_t *scan)
{
    const failure_t failure = failure_of(scan, FATHOM_ERR_PORT);
    (void)fputs("fathom: ", stderr);
    advice_print(stderr, &failure);
    (void)fputs("\n", stderr);
}

static void print_others(const scan_t *scan)
{
    const scan_heard_t *const heard = &scan->heard;
    if (heard->has_master) {
        (void)fputs("fathom: ", stderr);
        print_cause(scan, FATHOM_ERR_LINE_BUSY);
    }
    if (heard->not_asked != 0) {
        (void)fprintf(stderr, "fathom: %" PRIu32 " addresses could not be asked: ", heard->not_asked);
        print_cause(scan, heard->has_other_master ? FATHOM_ERR_OTHER_MASTER : FATHOM_ERR_LINE_BUSY);
    }
    if (heard->outside != 0)
        (void)fprintf(
            stderr,
            "fathom: a frame from address %u was heard, which the scan did not ask. Use --address %u.\n",
            heard->outside, heard->outside);
}

void scan_print_result(const scan_t *scan)
{
    char duration[DURATION_TEXT];
    if (scan->has_sender) print_sender(scan);
    if (scan->has_sender && !scan->settings->wake) return;
    print_others(scan);
    if (scan->terminations > 1)
        (void)fprintf(
            stderr,
            "fathom: %" PRIu32 " sensors have their termination resistor on, the factory setting, which "
            "overloads the line. Switch it off in all but the last sensor with 'fathom set %s:ADDRESS "
            "--port %s termination off'.\n",
            scan->terminations, scan->terminated->name, scan->settings->port);
    if (scan->sensors == 0) print_nothing(scan);
    (void)fprintf(stderr, "fathom: sensors found: %" PRIu32 ", after %s\n", scan->sensors,
                  duration_text(scan_now_us(scan) - scan->start_us, duration));
}
