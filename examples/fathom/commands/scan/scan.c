/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "commands/commands.h"
#include "commands/scan/scan_listen.h"
#include "commands/scan/scan_options.h"
#include "commands/scan/scan_progress.h"
#include "commands/scan/scan_report.h"
#include "commands/scan/scan_walk.h"
#include "ports/channel.h"
#include "ports/line_text.h"
#include "sensors/models.h"

enum { PROGRESS_US = 100000 };

typedef struct {
    const host_t *host;
    scan_options_t options;
    channel_t channel;
    scan_wire_t wire;
    scan_walk_t walk;
    scan_unasked_t unasked;
    scan_progress_t progress;
    uint64_t start_us;
    uint32_t sensors;      /* found */
    uint32_t terminations; /* of these, HPS-167S whose resistor is on */
    uint32_t awakened;     /* of these, those of the model that was heard to send by itself */
    int output_error;      /* errno */
} scan_t;

static uint64_t now_us(const scan_t *scan) { return scan->host->now_us(scan->host->ctx); }

/* ---- what it tells ---- */

static void tell_found(void *ctx, const scan_finding_t *finding)
{
    scan_t *const scan = ctx;
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
    if (scan->unasked.is_heard && finding->model == scan->unasked.finding.model) scan->awakened++;
}

static void tell_progress(void *ctx, uint64_t done_us, const fathom_line_settings_t *line, uint8_t address)
{
    scan_t *const scan = ctx;
    char settings[LINE_TEXT];
    char what[LINE_TEXT + 16];
    (void)snprintf(what, sizeof what, "%s address %u", line_text(line, settings), address);
    scan_progress_show(&scan->progress, now_us(scan), scan->options.plan.listen_us + done_us, what);
}

static void tell_unsupported(void *ctx, const fathom_line_settings_t *line)
{
    scan_t *const scan = ctx;
    char settings[LINE_TEXT];
    scan_progress_clear(&scan->progress);
    (void)fprintf(stderr, "fathom: this port cannot do %s, which is left out\n", line_text(line, settings));
}

/* "addresses 1 to 32 at 9600 8N1, 19200 8E1" */
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
        (void)printf("{\"settings\":%u,\"addresses\":%" PRIu32 ",\"seconds\":%" PRIu64 "}\n",
                     plan->setting_count, scan_addresses(plan), (all_us + 999999u) / 1000000u);
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

/* ---- what it does ---- */

static bool wait_for(void *ctx, uint32_t max_us)
{
    scan_t *const scan = ctx;
    const host_t *const host = scan->host;
    if (host->has_ended(host->ctx) || host->is_output_gone(host->ctx) || scan->output_error != 0)
        return false;
    host->wait(host->ctx, &scan->channel.port, max_us, true);
    return true;
}

/* While it listens there is nothing else to show. */
static bool wait_and_show(void *ctx, uint32_t max_us)
{
    scan_t *const scan = ctx;
    const uint64_t now = now_us(scan);
    scan_progress_show(&scan->progress, now, now - scan->start_us, "listens");
    return wait_for(ctx, max_us < PROGRESS_US ? max_us : PROGRESS_US);
}

static fathom_status_t scan_line(scan_t *scan)
{
    const scan_plan_t *const plan = &scan->options.plan;
    const scan_tell_t tell = {tell_found, tell_progress, tell_unsupported, scan};
    scan->wire.wait = wait_and_show;
    const fathom_status_t status = scan_listen(&scan->wire, plan->listen_us, &scan->unasked);
    scan->wire.wait = wait_for;
    if (status != FATHOM_OK || (scan->unasked.is_heard && !scan->options.wake)) return status;
    scan->walk.wire = &scan->wire;
    scan->walk.plan = plan;
    scan->walk.tell = &tell;
    scan->walk.has_sender = scan->unasked.is_heard;
    return scan_walk(&scan->walk);
}

/* ---- the end ---- */

/* A device sent by itself: what that means for the scan, and for the device. */
static void conclude_unasked(scan_t *scan)
{
    const scan_finding_t *const finding = &scan->unasked.finding;
    const char *const again = finding->mode == SCAN_AUTO ? model_of(finding->model)->automatic_again : NULL;
    if (scan->awakened == 0) tell_found(scan, finding);
    if (scan->options.wake && scan->awakened != 0 && finding->mode == SCAN_AUTO)
        (void)fprintf(stderr,
                      "fathom: it sent by itself until it was asked, and sends again after power-off%s\n",
                      again != NULL ? again : "");
    else if (!scan->options.wake && finding->kind == SCAN_MASTER)
        (void)fputs(
            "fathom: nothing was sent, because another master asks on this line; disconnect it or stop "
            "its program, and scan again (--wake asks all the same)\n",
            stderr);
    else if (!scan->options.wake && finding->kind == SCAN_SENDER && finding->address == 0)
        (void)fputs("fathom: nothing was sent, because something sends by itself: an HPS-167S made before "
                    "2020-09 speaks another protocol; another rate, A and B swapped and noise look like this "
                    "too; --wake asks all the same\n",
                    stderr);
    else if (!scan->options.wake && finding->mode == SCAN_AUTO)
        (void)fputs("fathom: nothing was sent, because even a read ends what an A16 or A05 sends by itself "
                    "(of an A05 until power-off); --wake asks all the same\n",
                    stderr);
    else if (!scan->options.wake)
        (void)fputs(
            "fathom: nothing was sent, because requests would go into what it sends; --wake asks all the "
            "same\n",
            stderr);
}

static void advise_on_nothing(const scan_t *scan)
{
    const scan_heard_t *const heard = &scan->walk.heard;
    (void)fputs("fathom: no sensor was found: ", stderr);
    if (heard->not_asked != 0)
        (void)fputs("not all addresses could be asked", stderr);
    else if (heard->bytes != 0)
        (void)fputs(
            "bytes were heard, but no response; check A and B swapped, --baud and --parity, and for noise",
            stderr);
    else if (heard->echoes != 0)
        (void)fputs("only the tool's own requests came back, so the adapter works and echoes, but no sensor "
                    "answers behind it; check the wiring behind the adapter (A, B, ground) and the supply",
                    stderr);
    else
        (void)fputs("nothing was heard at all; check the supply, and A and B (or RX and TX) swapped", stderr);
    if (scan->options.is_default)
        (void)fputs("; a sensor that was set otherwise is found with --address 1-254 --baud all", stderr);
    (void)fputs("; one that was switched on just now may need 5 s\n", stderr);
}

static void conclude_walk(const scan_t *scan)
{
    const scan_heard_t *const heard = &scan->walk.heard;
    const uint64_t took_us = now_us(scan) - scan->start_us;
    char duration[DURATION_TEXT];
    if (heard->has_master)
        (void)fprintf(stderr,
                      "fathom: requests of another master were heard (it asked address %u); disconnect it or "
                      "stop its program, and scan again\n",
                      heard->master_address);
    if (heard->not_asked != 0)
        (void)fprintf(
            stderr,
            "fathom: %" PRIu32 " addresses could not be asked, because %s; disconnect %s, and scan again\n",
            heard->not_asked,
            heard->has_other_master ? "another master asked there at the same time"
                                    : "the line was never silent",
            heard->has_other_master ? "it" : "what else sends on this line, check bias and termination");
    if (heard->outside != 0)
        (void)fprintf(stderr,
                      "fathom: a frame of address %u was heard, which was not asked; try --address %u\n",
                      heard->outside, heard->outside);
    if (scan->terminations > 1)
        (void)fprintf(stderr,
                      "fathom: %" PRIu32
                      " HPS-167S have their termination resistor on, as from the factory, which "
                      "overloads the line: switch it off in all but the last one, as fathom set "
                      "hps167s:ADDRESS --port %s termination off does\n",
                      scan->terminations, scan->options.port);
    if (scan->sensors == 0) advise_on_nothing(scan);
    (void)fprintf(stderr, "fathom: sensors found: %" PRIu32 ", after %s\n", scan->sensors,
                  duration_text(took_us, duration));
}

static int finish(scan_t *scan, fathom_status_t status)
{
    const host_t *const host = scan->host;
    scan_progress_clear(&scan->progress);
    const bool is_cut = status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
    if (scan->output_error == EINTR && host->has_ended(host->ctx)) scan->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: no reason for words. */
    if (scan->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (scan->output_error != 0) {
        (void)fprintf(stderr, "fathom: what was found cannot be written: %s\n", strerror(scan->output_error));
        return STATUS_FAILED;
    }
    if (status == FATHOM_ERR_PORT) {
        const fathom_posix_uart_t *const port = &scan->channel.port;
        if (fathom_posix_error(port) == FATHOM_POSIX_ERR_LOST)
            (void)fprintf(stderr, "fathom: %s; connect it again and start again\n",
                          fathom_posix_error_text(port));
        else
            (void)fprintf(stderr, "fathom: %s: the port did not send a request; check the adapter\n",
                          port->path);
        return STATUS_FAILED;
    }
    if (scan->unasked.is_heard && !is_cut) conclude_unasked(scan);
    if (is_cut)
        (void)fprintf(stderr, "fathom: ended before all addresses were asked; sensors found: %" PRIu32 "\n",
                      scan->sensors);
    else if (!scan->unasked.is_heard || scan->options.wake)
        conclude_walk(scan);
    return scan->sensors != 0 && scan->output_error == 0 ? STATUS_OK : STATUS_FAILED;
}

static int run(const host_t *host, int argc, char **argv)
{
    static scan_t scan; /* too large for a small stack */
    const scan_options_t *const options = &scan.options;
    memset(&scan, 0, sizeof scan);
    scan.host = host;
    if (!scan_options(&scan.options, argc, argv)) return STATUS_USAGE;
    if (options->wants_help) return command_help(&scan_command);
    if (options->estimate) return print_estimate(options);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    if (!channel_open(&scan.channel, host, options->port, &scan_dyp_line)) {
        (void)fprintf(stderr, "fathom: %s\n", fathom_posix_error_text(&scan.channel.port));
        return STATUS_FAILED;
    }
    scan.channel.parts.silence_us = scan_silence_us(&options->plan);
    scan.wire.line = &scan.channel.line;
    scan.wire.listener = &scan.channel.listener;
    scan.wire.clock = &scan.channel.clock;
    scan.wire.ctx = &scan;
    announce(&options->plan);
    scan.start_us = now_us(&scan);
    scan_progress_begin(&scan.progress, stderr, scan_plan_us(&options->plan));
    const int status = finish(&scan, scan_line(&scan));
    channel_close(&scan.channel);
    return status;
}

const command_t scan_command = {
    .name = "scan", .summary = "finds sensors on a serial port", .help = scan_help, .run = run};
