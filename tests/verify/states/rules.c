/* SPDX-License-Identifier: MIT */
#include "world.h"

#include "line_internal.h"

#include <string.h>

/* What the headers promise, seen at each step. */

int bound_of_others(void)
{
    int bound = 0;
    for (int i = 0; i != TRANSACTIONS; i++)
        if (there_is(i) && i != options.watched) bound += 1 + options.retries[i];
    return bound;
}

static bool is_a5(const void *object, size_t size)
{
    const uint8_t *byte = object;
    for (; size != 0; size--)
        if (*byte++ != 0xA5) return false;
    return true;
}

/* "leave it alone until its status is no longer PENDING"; then "its memory is the caller's again". */
static const char *judge_memory(int step)
{
    for (int i = 0; i != TRANSACTIONS; i++) {
        if (!was_queued(i) && step != SUBMIT + i &&
            (!is_a5(&world.requests[i], sizeof world.requests[i]) ||
             !is_a5(&world.values[i], sizeof world.values[i])))
            return "a transaction that is not the line's was written to";
        if (is_queued(i) &&
            (world.requests[i].transaction.status != FATHOM_PENDING || world.values[i] != 0xDEAD))
            return "a transaction has a result before it has ended";
        if (is_queued(i) && world.requests[i].transaction.attempts > options.retries[i] + 1)
            return "there were more attempts than retries allow";
    }
    return NULL;
}

/* A response serves the transaction that asked for it, and that only while it is the same one. */
static const char *judge_delivery(int transaction)
{
    const int number = effect.delivered[transaction];
    if (number < 0 || number >= TICKETS || world.tickets[number].stage != CAME)
        return "a transaction has ended with a response that has not come";
    const ticket_t *const ticket = &world.tickets[number];
    if (ticket->transaction != transaction) return "a response has served another transaction";
    if ((ticket->flags & ENDED) != 0)
        return "a response has served a request that was sent after its own was given up";
    return NULL;
}

static const char *judge_end(int step, const world_t *before, int transaction)
{
    const bool is_cancel = step == CANCEL + transaction || step == CANCEL_UNIT + unit_of(transaction);
    const bool is_fault =
        step == POLL_READ_FAILS || step == POLL_WRITE_FAILS || step == PAUSE || step == PAUSE_STAYS;
    const int status = effect.ended[transaction];
    if (is_cancel != (status == FATHOM_ERR_CANCELLED)) return "CANCELLED, and it was not, or not, and it was";
    if ((before->came & (CLAIMED | SKIPPED)) == CLAIMED && transaction == effect.queue[0] &&
        status <= FATHOM_ERR_NO_RESPONSE && status != FATHOM_ERR_EXCEPTION &&
        status != FATHOM_ERR_OTHER_MASTER && !is_cancel && !is_fault)
        return "another master had asked the unit, and the status does not tell";
    switch (status) {
    case FATHOM_ERR_LINE_BUSY:
        return (before->came & SKIPPED) != 0 || before->waited >= options.busy || step == PAUSE ||
                       step == PAUSE_STAYS
                   ? NULL
                   : "LINE_BUSY, and the line was silent";
    case FATHOM_ERR_OTHER_MASTER:
        return (before->came & CLAIMED) != 0 ? NULL : "OTHER_MASTER, and there was none";
    case FATHOM_OK:
    case FATHOM_ERR_EXCEPTION:
        return judge_delivery(transaction);
    case FATHOM_ERR_PORT:
        return is_fault ? NULL : "PORT, and the port works";
    case FATHOM_ERR_UNSUPPORTED:
        return step == POLL_SET_FAILS ? NULL : "UNSUPPORTED, and the port can do it";
    case FATHOM_ERR_NO_RESPONSE:
        return (before->came & IN_TIME) == 0 ? NULL : "NO_RESPONSE, and something came";
    case FATHOM_ERR_CHECKSUM:
        return (before->came & BAD) != 0 ? NULL : "CHECKSUM, and nothing damaged came";
    case FATHOM_ERR_MALFORMED:
        return (before->came & OTHER) != 0 ? NULL : "MALFORMED, and nothing unexpected came";
    case FATHOM_ERR_ECHO:
        return options.echo == 2 ? NULL : "ECHO, and it is known";
    case FATHOM_ERR_CANCELLED:
        return NULL;
    default:
        return "a status that no transaction ends with";
    }
}

/* "other units first": of those before it in the queue, each one's unit is quarantined. */
static bool is_first_that_may(int transaction)
{
    for (int i = 0; i != TRANSACTIONS && effect.queue[i] != transaction; i++)
        if (is_queued(effect.queue[i]) &&
            !fathom_line_is_quarantined(&world.line, address_of(effect.queue[i])))
            return false;
    return true;
}

/* A request leaves without the silence before it behind a frame in a slow loop, or after a wait in which no frame came. */
static bool is_without_silence(const world_t *before)
{
    if (world.line.wait != WAIT_SKIPPED) return false;
    if (options.senders && world.line.sender >= SENDER_SLOW && before->is_news) return true;
    return before->waited >= options.busy && !before->has_frame;
}

static const char *judge_sending(int transaction, const world_t *before)
{
    if (!was_queued(transaction)) return "a request has left whose transaction was not queued";
    for (int i = 0; i != TICKETS; i++) {
        const ticket_t *const ticket = &world.tickets[i];
        if (ticket->stage != LEAVING && ticket->stage != DUE) continue;
        if (ticket->stage == LEAVING && (ticket->flags & ENDED) == 0)
            return "a request was sent while another leaves";
        if (ticket->stage == DUE && (ticket->flags & (CLOSED | PIECE)) == 0 &&
            ticket->age < timeout_of(ticket->transaction))
            return "a request was sent while the response to another may come in time";
        if (!options.over && unit_of(ticket->transaction) == unit_of(transaction))
            return "a unit was asked whose late response may still come";
    }
    if (world.asked != 0 && world.line.wait != WAIT_SKIPPED)
        return "a request was sent while the response to another master is due";
    if (world.quiet < options.silence && !is_without_silence(before))
        return "a request was sent without the silence before it";
    if (!is_first_that_may(transaction)) return "a request was sent before one that could have been";
    const int watched = options.watched;
    if (watched < TRANSACTIONS && watched != transaction && is_queued(watched) &&
        !fathom_line_is_quarantined(&world.line, address_of(watched)) && ++world.others > bound_of_others())
        return "a transaction that could leave has let more pass than its bound";
    return NULL;
}

static bool stands_idle(int step)
{
    if (step != POLL || effect.sent >= 0 || world.line.phase != FATHOM_LINE_IDLE ||
        world.line.received_count != 0 || world.line.sender != SENDER_NONE ||
        world.line.awaited_left_us != 0 || world.line.silent_us < options.silence * TICK_US)
        return false;
    for (int i = 0; i != TRANSACTIONS; i++)
        if (is_queued(i) && !fathom_line_is_quarantined(&world.line, address_of(i))) return true;
    return false;
}

static const char *judge_times(int step, const world_t *before)
{
    bool has_ended = false;
    for (int i = 0; i != TRANSACTIONS; i++) has_ended = has_ended || effect.ended[i] != FATHOM_PENDING;
    for (int i = 0; i != TICKETS; i++) {
        const ticket_t *const ticket = &world.tickets[i];
        const int x = ticket->transaction;
        if (ticket->stage == NONE) continue;
        if ((ticket->flags & SURE) != 0 && step == POLL && effect.delivered[x] != i)
            return "a response that came in time was not taken";
        if (ticket->stage == DUE && (ticket->flags & (CLOSED | PIECE)) == 0 && ticket->age < timeout_of(x) &&
            effect.counted[FATHOM_LINE_NO_RESPONSES] != 0)
            return "an attempt has ended before its time-out";
    }
    if (step == POLL && !before->is_news && before->due != 0 && before->due != NEVER &&
        (effect.sent >= 0 || has_ended))
        return "the line had something to do before it was due";
    if (step == POLL && world.due == 0 && world.leaving == 0 && world.line.received_count == 0 &&
        (world.line.quarantined_units == 0 || world.line.quarantine_left_us != 0))
        return "the line is due at once, and did nothing";
    if (stands_idle(step)) return "a request that could leave was not sent";
    for (int unit = 0; unit != UNITS; unit++) {
        if (fathom_line_is_quarantined(&before->line, (uint8_t)(unit + 1)) ||
            !fathom_line_is_quarantined(&world.line, (uint8_t)(unit + 1)))
            continue;
        const bool is_asked = before->line.attempt.request_length != 0 && unit_of(effect.queue[0]) == unit;
        if (!is_asked) return "a unit is quarantined that was not asked";
    }
    if (world.line.quarantined_units != 0) {
        const int longest = options.timeout[0] > options.timeout[1] ? options.timeout[0] : options.timeout[1];
        if (world.line.quarantine_left_us > (uint32_t)(2 * longest * TICK_US))
            return "a quarantine lasts longer than twice the longest time-out";
    }
    return NULL;
}

const char *judge(int step, const world_t *before)
{
    const char *broken = judge_memory(step);
    for (int i = 0; i != TRANSACTIONS && broken == NULL; i++)
        if (effect.ended[i] != FATHOM_PENDING) broken = judge_end(step, before, i);
    if (broken == NULL && effect.sent >= 0) broken = judge_sending(effect.sent, before);
    if (broken == NULL) broken = judge_times(step, before);
    return broken;
}
