/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "commands/scan/scan.h"
#include "commands/scan/scan_report.h"
#include "sensors/models.h"

/* Says why the scan sent nothing, although the user did not choose that. */
static const char *why_nothing_was_sent(const scan_finding_t *sender)
{
    if (sender->kind == SCAN_MASTER)
        return "another master asks on this line; disconnect it or stop its program, and scan again (--wake "
               "asks all the same)";
    if (sender->kind == SCAN_SENDER && sender->address == 0)
        return "something sends by itself: an HPS-167S made before 2020-09 speaks another protocol; another "
               "rate, A and B swapped and noise look like this too; --wake asks all the same";
    if (sender->mode == SCAN_AUTO)
        return "even a read ends what an A16 or A05 sends by itself (of an A05 until power-off); --wake asks "
               "all the same";
    return "requests would go into what it sends; --wake asks all the same";
}

static void print_sender(const scan_t *scan)
{
    const scan_finding_t *const sender = &scan->sender;
    if (!scan->options.wake) {
        (void)fprintf(stderr, "fathom: nothing was sent, because %s\n", why_nothing_was_sent(sender));
    } else if (scan->awakened != 0 && sender->mode == SCAN_AUTO) {
        const char *const again = model_of(sender->model)->automatic_again;
        (void)fprintf(stderr,
                      "fathom: it sent by itself until it was asked, and sends again after power-off%s\n",
                      again != NULL ? again : "");
    }
}

static const char *why_nothing_was_found(const scan_heard_t *heard)
{
    if (heard->not_asked != 0) return "not all addresses could be asked";
    if (heard->bytes != 0)
        return "bytes were heard, but no response; check A and B swapped, --baud and --parity, and for noise";
    if (heard->echoes != 0)
        return "only the tool's own requests came back, so the adapter works and echoes, but no sensor "
               "answers behind it; check the wiring behind the adapter (A, B, ground) and the supply";
    return "nothing was heard at all; check the supply, and A and B (or RX and TX) swapped";
}

static void print_others(const scan_heard_t *heard)
{
    if (heard->has_master)
        (void)fprintf(stderr,
                      "fathom: requests of another master were heard (it asked address %u); disconnect it or "
                      "stop its program, and scan again\n",
                      heard->master_address);
    if (heard->not_asked != 0)
        (void)fprintf(stderr,
                      "fathom: %" PRIu32 " addresses could not be asked, because %s, and scan again\n",
                      heard->not_asked,
                      heard->has_other_master
                          ? "another master asked there at the same time; disconnect it"
                          : "the line was never silent; disconnect what else sends on this line, check bias "
                            "and termination");
    if (heard->outside != 0)
        (void)fprintf(stderr,
                      "fathom: a frame of address %u was heard, which was not asked; try --address %u\n",
                      heard->outside, heard->outside);
}

void scan_print_result(const scan_t *scan)
{
    char duration[DURATION_TEXT];
    if (scan->has_sender) print_sender(scan);
    if (scan->has_sender && !scan->options.wake) return;
    print_others(&scan->heard);
    if (scan->terminations > 1)
        (void)fprintf(stderr,
                      "fathom: %" PRIu32 " HPS-167S have their termination resistor on, as from the factory, "
                      "which overloads the line: switch it off in all but the last one, as fathom set "
                      "hps167s:ADDRESS --port %s termination off does\n",
                      scan->terminations, scan->options.port);
    if (scan->sensors == 0)
        (void)fprintf(stderr,
                      "fathom: no sensor was found: %s%s; one that was switched on just now may need "
                      "5 s\n",
                      why_nothing_was_found(&scan->heard),
                      scan->options.is_default
                          ? "; a sensor that was set otherwise is found with --address 1-254 --baud all"
                          : "");
    (void)fprintf(stderr, "fathom: sensors found: %" PRIu32 ", after %s\n", scan->sensors,
                  duration_text(scan_now_us(scan) - scan->start_us, duration));
}
