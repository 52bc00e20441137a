/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "scan/scan_listen.h"
#include "scan/scan_options.h"
#include "scan/scan_progress.h"
#include "scan/scan_report.h"
#include "scan/scan_walk.h"
#include "shared/channel.h"
#include "shared/command.h"

enum { PROGRESS_US = 100000 };

typedef struct {
    const host_t *host;
    scan_options_t options;
    channel_t channel;
    scan_wire_t wire;
    scan_walk_t walk;
    scan_talk_t talk;
    scan_progress_t progress;
    uint64_t start_us;
    uint32_t sensors;      /* found */
    uint32_t terminations; /* of these, HPS-167S whose resistor is on */
    uint32_t awakened;     /* of these, those of the model that was heard to send by itself */
    int output_error;      /* errno */
} session_t;

static uint64_t now_us(const session_t *session) { return session->host->now_us(session->host->ctx); }

/* ---- what it tells ---- */

static void tell_found(void *ctx, const scan_finding_t *finding)
{
    session_t *const session = ctx;
    const scan_options_t *const options = &session->options;
    scan_progress_clear(&session->progress);
    errno = 0;
    if (options->is_json)
        scan_print_json(stdout, finding, options->port);
    else
        scan_print_text(stdout, finding, options->port);
    /* Readers of a pipe see each line at once. */
    if (fflush(stdout) != 0 || ferror(stdout)) session->output_error = errno != 0 ? errno : EIO;
    scan_print_advice(stderr, finding);
    if (finding->kind != SCAN_SENSOR) return;
    session->sensors++;
    if (finding->has_config && finding->has_termination) session->terminations++;
    if (session->talk.is_heard && finding->model == session->talk.finding.model) session->awakened++;
}

static void tell_progress(void *ctx, uint64_t done_us, const fathom_line_settings_t *line, uint8_t address)
{
    session_t *const session = ctx;
    char settings[SETTINGS_TEXT];
    char what[SETTINGS_TEXT + 16];
    (void)snprintf(what, sizeof what, "%s address %u", settings_text(line, settings), address);
    scan_progress_show(&session->progress, now_us(session), session->options.plan.listen_us + done_us, what);
}

static void tell_unsupported(void *ctx, const fathom_line_settings_t *line)
{
    session_t *const session = ctx;
    char settings[SETTINGS_TEXT];
    scan_progress_clear(&session->progress);
    (void)fprintf(stderr, "fathom: this port cannot do %s, which is left out\n",
                  settings_text(line, settings));
}

/* "addresses 1 to 32 at 9600 8N1, 19200 8E1" */
static void print_plan(FILE *to, const scan_plan_t *plan)
{
    char settings[SETTINGS_TEXT];
    if (plan->first == plan->last)
        (void)fprintf(to, "address %u at", plan->first);
    else
        (void)fprintf(to, "addresses %u to %u at", plan->first, plan->last);
    for (uint8_t i = 0; i != plan->setting_count; i++)
        (void)fprintf(to, "%s %s", i != 0 ? "," : "", settings_text(&plan->settings[i], settings));
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
    session_t *const session = ctx;
    const host_t *const host = session->host;
    if (host->has_ended(host->ctx) || host->is_output_gone(host->ctx) || session->output_error != 0)
        return false;
    host->wait(host->ctx, &session->channel.port, max_us, true);
    return true;
}

/* While it listens there is nothing else to show. */
static bool wait_and_show(void *ctx, uint32_t max_us)
{
    session_t *const session = ctx;
    const uint64_t now = now_us(session);
    scan_progress_show(&session->progress, now, now - session->start_us, "listens");
    return wait_for(ctx, max_us < PROGRESS_US ? max_us : PROGRESS_US);
}

static fathom_status_t scan_line(session_t *session)
{
    const scan_plan_t *const plan = &session->options.plan;
    const scan_tell_t tell = {tell_found, tell_progress, tell_unsupported, session};
    session->wire.wait = wait_and_show;
    const fathom_status_t status = scan_listen(&session->wire, plan->listen_us, &session->talk);
    session->wire.wait = wait_for;
    if (status != FATHOM_READY || (session->talk.is_heard && !session->options.wake)) return status;
    session->walk.wire = &session->wire;
    session->walk.plan = plan;
    session->walk.tell = &tell;
    session->walk.is_talking = session->talk.is_heard;
    return scan_walk(&session->walk);
}

/* ---- the end ---- */

/* Somebody sent by himself: what that means for the scan, and for him. */
static void conclude_talk(session_t *session)
{
    const scan_finding_t *const finding = &session->talk.finding;
    if (session->awakened == 0) tell_found(session, finding);
    if (session->options.wake && session->awakened != 0 && finding->mode == SCAN_AUTO)
        (void)fprintf(stderr,
                      "fathom: it sent by itself until it was asked, and sends again after power-off%s\n",
                      finding->model == FATHOM_A16 ? ", or when 1 is written to its register 0x0202" : "");
    else if (!session->options.wake && finding->kind == SCAN_MASTER)
        (void)fputs(
            "fathom: nothing was sent, because another master asks on this line; disconnect it or stop "
            "its program, and scan again (--wake asks all the same)\n",
            stderr);
    else if (!session->options.wake && finding->kind == SCAN_SENDER && finding->address == 0)
        (void)fputs("fathom: nothing was sent, because something sends by itself: an HPS-167S made before "
                    "2020-09 speaks another protocol; another rate, A and B swapped and noise look like this "
                    "too; --wake asks all the same\n",
                    stderr);
    else if (!session->options.wake && finding->mode == SCAN_AUTO)
        (void)fputs("fathom: nothing was sent, because even a read ends what an A16 or A05 sends by itself "
                    "(of an A05 until power-off); --wake asks all the same\n",
                    stderr);
    else if (!session->options.wake)
        (void)fputs(
            "fathom: nothing was sent, because questions would go into what it sends; --wake asks all the "
            "same\n",
            stderr);
}

static void advise_on_nothing(const session_t *session)
{
    const scan_heard_t *const heard = &session->walk.heard;
    (void)fputs("fathom: no sensor was found: ", stderr);
    if (heard->bytes != 0)
        (void)fputs(
            "bytes were heard, but no answer; check A and B swapped, --baud and --parity, and for noise",
            stderr);
    else if (heard->echoes != 0)
        (void)fputs("only the tool's own requests came back, so the adapter works and echoes, but no sensor "
                    "answers behind it; check the wiring behind the adapter (A, B, ground) and the supply",
                    stderr);
    else
        (void)fputs("nothing was heard at all; check the supply, and A and B (or RX and TX) swapped", stderr);
    if (session->options.is_default)
        (void)fputs("; a sensor that was set otherwise is found with --address 1-254 --baud all", stderr);
    (void)fputs("; one that was switched on just now may need 5 s\n", stderr);
}

static void conclude_walk(const session_t *session)
{
    const scan_heard_t *const heard = &session->walk.heard;
    const uint64_t took_us = now_us(session) - session->start_us;
    char duration[DURATION_TEXT];
    if (heard->has_master)
        (void)fprintf(stderr,
                      "fathom: requests of another master were heard (it asked address %u); disconnect it or "
                      "stop its program, and scan again\n",
                      heard->master_address);
    if (heard->outside != 0)
        (void)fprintf(stderr,
                      "fathom: a frame of address %u was heard, which was not asked; try --address %u\n",
                      heard->outside, heard->outside);
    if (session->terminations > 1)
        (void)fprintf(stderr,
                      "fathom: %" PRIu32
                      " HPS-167S have their termination resistor on, as from the factory, which "
                      "overloads the line: switch it off in all but the last one, as fathom set "
                      "hps167s:ADDRESS --port %s termination off does\n",
                      session->terminations, session->options.port);
    if (session->sensors == 0) advise_on_nothing(session);
    (void)fprintf(stderr, "fathom: sensors found: %" PRIu32 ", after %s\n", session->sensors,
                  duration_text(took_us, duration));
}

static int finish(session_t *session, fathom_status_t status)
{
    const host_t *const host = session->host;
    scan_progress_clear(&session->progress);
    const bool is_cut = status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
    if (session->output_error == EINTR && host->has_ended(host->ctx)) session->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: no reason for words. */
    if (session->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (session->output_error != 0) {
        (void)fprintf(stderr, "fathom: what was found cannot be written: %s\n",
                      strerror(session->output_error));
        return STATUS_FAILED;
    }
    if (status == FATHOM_ERR_PORT) {
        const fathom_posix_uart_t *const port = &session->channel.port;
        if (fathom_posix_error(port) == FATHOM_POSIX_ERR_LOST)
            (void)fprintf(stderr, "fathom: %s; connect it again and start again\n",
                          fathom_posix_error_text(port));
        else
            (void)fprintf(stderr, "fathom: %s: the port did not send a request; check the adapter\n",
                          port->path);
        return STATUS_FAILED;
    }
    if (session->talk.is_heard && !is_cut) conclude_talk(session);
    if (is_cut)
        (void)fprintf(stderr, "fathom: ended before all addresses were asked; sensors found: %" PRIu32 "\n",
                      session->sensors);
    else if (!session->talk.is_heard || session->options.wake)
        conclude_walk(session);
    return session->sensors != 0 && session->output_error == 0 ? STATUS_OK : STATUS_FAILED;
}

static int run(const host_t *host, int argc, char **argv)
{
    static session_t session; /* too large for a small stack */
    const scan_options_t *const options = &session.options;
    memset(&session, 0, sizeof session);
    session.host = host;
    if (!scan_options(&session.options, argc, argv)) return STATUS_USAGE;
    if (options->wants_help) {
        scan_help(stdout);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    if (options->estimate) return print_estimate(options);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    if (!channel_open(&session.channel, host, options->port, &scan_dyp_line)) {
        (void)fprintf(stderr, "fathom: %s\n", fathom_posix_error_text(&session.channel.port));
        return STATUS_FAILED;
    }
    session.channel.config.silence_us = scan_silence_us(&options->plan);
    session.wire.line = &session.channel.line;
    session.wire.ear = &session.channel.ear;
    session.wire.clock = &session.channel.clock;
    session.wire.ctx = &session;
    announce(&options->plan);
    session.start_us = now_us(&session);
    scan_progress_begin(&session.progress, stderr, scan_plan_us(&options->plan));
    const int status = finish(&session, scan_line(&session));
    channel_close(&session.channel);
    return status;
}

const command_t scan_command = {"scan", "finds sensors on a serial port", scan_help, run};
