/* SPDX-License-Identifier: MIT */
#include <stdarg.h>

#include "world.h"

#include "fathom/engine/line_turns.h"

/* One step of a way as a line to be read. */

static const char *name_of(int transaction)
{
    static const char *const names[TRANSACTIONS] = {"1a", "1b", "2a", "2b"};
    return names[transaction];
}

static int length;

static void say(FILE *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    length += vfprintf(out, format, arguments);
    va_end(arguments);
}

static const char *what_comes(int step)
{
    switch (step - step % TICKETS) {
    case RESPOND:
        return "responds";
    case EXCEPTION:
        return "refuses (an exception)";
    case DAMAGED:
        return "responds, one bit damaged";
    case UNEXPECTED:
        return "sends something else";
    case SEND_PIECE:
        return "is heard to begin, noise";
    case BEGIN:
        return "begins to respond";
    default:
        return "goes on responding";
    }
}

static void describe_step(int step, const world_t *before, FILE *out)
{
    if (step == TICK) {
        say(out, "a tick");
        if (before->leaving != 0 && world.leaving == 0) say(out, ": the last bit of the request leaves");
    } else if (step == PAUSE || step == PAUSE_STAYS) {
        say(out, "a second%s, poll", step == PAUSE ? "" : " with a busy port");
    } else if (step < SUBMIT || step == POLL_DRAWN) {
        static const char *const polls[] = {
            "", ", read fails", ", write fails", ", write is busy", ", set_line is busy", ", set_line fails"};
        say(out, "poll%s", step == POLL_DRAWN ? ", the slot is drawn" : polls[step - POLL]);
    } else if (step < CANCEL) {
        say(out, "submit %s", name_of(step - SUBMIT));
    } else if (step < CANCEL_UNIT) {
        say(out, "cancel %s", name_of(step - CANCEL));
    } else if (step < RESPOND) {
        say(out, "cancel unit %d", step - CANCEL_UNIT + 1);
    } else if (step == FOREIGN) {
        say(out, "unit 3 responds to another host");
    } else if (step == STREAM) {
        say(out, "a device sends by itself");
    } else if (step > STREAM) {
        static const char *const others[] = {"unit 1 sends by itself", "a byte of noise",
                                             "another master asks unit 1", "unit 1 answers the other master"};
        say(out, "%s", others[step - OWN]);
    } else {
        const ticket_t *const ticket = &before->tickets[step % TICKETS];
        const char *const whose = (ticket->flags & ENDED) != 0    ? "given up"
                                  : (ticket->flags & CLOSED) != 0 ? "timed out"
                                                                  : "waited for";
        say(out, "unit %d %s: %s's (%s), %d after it", unit_of(ticket->transaction) + 1, what_comes(step),
            name_of(ticket->transaction), whose, ticket->age);
    }
}

void describe(int step, const world_t *before, FILE *out)
{
    length = 0;
    describe_step(step, before, out);
    if (effect.sent >= 0) say(out, "; request of %s", name_of(effect.sent));
    for (int i = 0; i != TRANSACTIONS; i++) {
        if (effect.ended[i] == FATHOM_PENDING) continue;
        say(out, "; %s %s", name_of(i), fathom_status_name((fathom_status_t)effect.ended[i]));
        if (effect.delivered[i] >= 0 && effect.delivered[i] < TICKETS) {
            const ticket_t *const ticket = &before->tickets[effect.delivered[i]];
            say(out, " by %s's%s", name_of(ticket->transaction),
                (ticket->flags & ENDED) != 0 ? ", which was given up" : "");
        }
    }
    fprintf(out, "%*s |", length < 60 ? 60 - length : 0, "");
    for (const fathom_transaction_t *x = world.line.head; x != NULL; x = x->link.next) {
        const int i = (int)((const fathom_modbus_request_t *)x - world.requests);
        fprintf(out, " %s%s", name_of(i),
                x == world.line.head && world.line.attempt.request_length != 0 ? " on the wire"
                : x->attempts != 0                                             ? " waits for a retry"
                                                                               : " waits");
        if (x->link.next != NULL) fprintf(out, ",");
    }
    for (int unit = 1; unit <= UNITS; unit++)
        if (fathom_line_is_quarantined(&world.line, (uint8_t)unit))
            fprintf(out, "; unit %d quarantined %lu", unit, (unsigned long)world.line.quarantine_left_us);
    fprintf(out, "\n");
}
