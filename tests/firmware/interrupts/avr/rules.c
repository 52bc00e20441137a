/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <string.h>

/* What each header says, whatever came first. */

/* The longest way out of the port's sleep, with two interrupts; less than what idle is given in scenarios.c, so that a
 * sleep to its end is seen. */
enum { WAKE_CYCLES = 1000, WAKE_US = 60 };
/* 8E1 at 1200 baud, rounded up, as usart0.c counts it. */
enum { CHARACTER_US = (11 * 1000000 + 1199) / 1200 };

static bool is_between(uint32_t us, uint64_t begin_cycle, uint64_t end_cycle)
{
    const uint32_t begin_us = truth_us(begin_cycle);
    return us - begin_us <= truth_us(end_cycle) - begin_us;
}

/* fathom_avr.h: "us since then"; hal.h: "now_us is monotonic". Each reading is the time at some instant of its call. */
static const char *check_now(void)
{
    const calls_t *const now = &run.returned;
    if (!is_between(now->time_us[0], run.begin_cycle, run.end_cycle)) return "the clock is wrong";
    if (!is_between(now->time_us[1], run.begin_cycle, run.end_cycle)) return "the second reading is wrong";
    const uint32_t begin_us = truth_us(run.begin_cycle);
    return now->time_us[1] - begin_us < now->time_us[0] - begin_us ? "the clock goes back" : NULL;
}

/* fathom_avr.h: "counts bytes, and is two characters too long at most". */
static const char *check_leaves(void)
{
    const uint32_t us = run.returned.time_us[0];
    if (us < (run.left[1] != 0 ? run.left[1] - 1U : 0U) * CHARACTER_US)
        return "more bytes leave than it says";
    return us > (run.left[0] + 2U) * CHARACTER_US ? "it is more than two characters too long" : NULL;
}

/* hal.h: "True when the last stop bit of all that was written has left the pin." */
static const char *check_sent(void)
{
    return run.returned.result != 0 && run.left[1] != 0 ? "it is not sent" : NULL;
}

/* hal.h: "is_high: the level now", at some instant of the call. */
static const char *check_level(void)
{
    const uint8_t which = run.scenario->which;
    bool may_be[2] = {false, false};
    uint8_t edges = 0;
    for (uint8_t i = 0; i < truth.edges[which]; i++) {
        if (truth.edge_cycles[which][i] > run.end_cycle) break;
        edges++;
        if (truth.edge_cycles[which][i] >= run.begin_cycle) may_be[i % 2 == 0 ? 0 : 1] = true; /* before it */
    }
    may_be[edges % 2] = true;
    return may_be[run.returned.is_high != 0] ? NULL : "that is not the level";
}

static bool wakes(event_t event)
{
    return event != EVENT_OVERFLOW && event != EVENT_LATE && event != EVENT_NONE;
}

/* fathom_avr.h: "sleeps until a byte has been received or an edge fed, a request has left, or max_us have passed, and
 * returns; at once if a byte waits already"; and "for so long bytes do not wake it". */
static const char *check_idle(void)
{
    const scenario_t *const scenario = run.scenario;
    const uint64_t most_cycles = (uint64_t)(scenario->most_us + WAKE_US) * BOARD_CYCLES_PER_US;
    if (run.end_cycle - run.begin_cycle > most_cycles + WAKE_CYCLES) return "it sleeps too long";
    bool may_end =
        run.end_cycle - run.begin_cycle + WAKE_CYCLES / 2 > scenario->most_us * BOARD_CYCLES_PER_US;
    if (truth.count != 0 && run.raises == 0) may_end = true; /* it waited, or came before */
    for (uint8_t i = 0; i < run.raises; i++) {
        const raised_t *const raised = &run.raised[i];
        if (!wakes(raised->event) || !raised->has_raised || raised->cycle > run.end_cycle) continue;
        if (raised->event == EVENT_LEFT && run.left[1] != 0) continue;
        may_end = true;
        const bool is_byte = event_has_vector(raised->event, 18);
        uint64_t wake_cycle = raised->cycle;
        const uint64_t gathered_cycle = run.begin_cycle + scenario->gather_us * (uint64_t)BOARD_CYCLES_PER_US;
        if (is_byte && wake_cycle < gathered_cycle) wake_cycle = gathered_cycle;
        if (run.end_cycle > wake_cycle + WAKE_CYCLES) return "it sleeps through what should wake it";
    }
    return may_end || run.raises == 0 ? NULL : "it wakes of nothing";
}

/* Each byte once, in order, with the flags that are its own. The log is what a read and all reads after it gave. */
static const char *check_bytes(void)
{
    const outcome_t *const outcome = &run.outcome;
    uint8_t at = run.scenario->call == CALL_TAKE ? 2 : 0, seen = 0;
    for (bool is_path = run.scenario->call == CALL_READ;; is_path = false) {
        const uint8_t count = outcome->log[at++];
        const uint8_t flags = outcome->log[at++];
        if (count > CALLS_BYTES || at + count > outcome->log_length) return "a read gives more than there is";
        if (flags != 0 && count != 1) return "a flag is not of one byte";
        bool has_lost = false;
        for (uint8_t i = 0; i < count; i++, at++, seen++) {
            while (run.scenario->may_drop && seen < truth.count && truth.bytes[seen] != outcome->log[at]) {
                seen++;
                has_lost = true;
            }
            if (seen >= truth.count) return "a byte that was never sent, or one that came twice";
            if (truth.bytes[seen] != outcome->log[at]) return "a byte is lost, or out of order";
            const uint8_t expected = (uint8_t)(truth.flags[seen] | (has_lost ? FATHOM_RX_OVERRUN : 0));
            if (flags != expected) return "the flags of a byte are not its own";
        }
        if (count == 0 && !is_path) break;
    }
    return seen == truth.count || run.scenario->may_drop ? NULL : "a byte is lost";
}

/* fathom_avr.h: write "drives `driver` from before that until the last stop bit has left". */
static const char *check_wire(void)
{
    const outcome_t *const outcome = &run.outcome;
    if (outcome->wire_length != truth.sent_count || memcmp(outcome->wire, truth.sent, truth.sent_count) != 0)
        return "what is on the wire is not what was written";
    if (board.cut_bytes != 0) return "the driver cuts a byte off";
    if (truth.has_break) return NULL;
    if (outcome->is_sent != 1) return "the request never counts as sent";
    return outcome->driver_edges == 2 * truth.requests && !board.driver_on
               ? NULL
               : "the driver is not on once a request";
}

static const char *check_pulses(void)
{
    for (uint8_t i = 0; i < run.outcome.log_length; i++)
        if (run.outcome.log[i] == NO_PULSE) return "a pulse that never was";
    return NULL;
}

/* fathom_avr.h: "each fed to `edges`", the old ones or the new ones; hal.h: "a pulse that has begun before does not
 * count", so an edge may be forgotten while the pin changes hands. */
bool rules_are_all(void)
{
    for (uint8_t i = 0; i < run.raises; i++)
        if (scenario_begins() && (run.raised[i].event == EVENT_ICP1 || run.raised[i].event == EVENT_INT0))
            return true;
    return false;
}

static const char *check_begin(void)
{
    const event_t event = run.scenario->call == CALL_ICP1_BEGIN ? EVENT_ICP1 : EVENT_INT0;
    uint8_t raised = 0, entered = 0;
    for (uint8_t i = 0; i < run.raises; i++) {
        if (run.raised[i].event == event) raised++;
        if (run.raised[i].event == event && run.raised[i].has_entered) entered++;
    }
    const uint8_t fed = (uint8_t)(run.outcome.rises[0] + run.outcome.rises[1]);
    if (raised == 0 || run.scenario->prepare != NULL) return NULL;
    if (raised == 2)
        return fed <= 1 ? NULL : "two edges are more than one pulse"; /* or none, seen too late */
    return fed == entered ? NULL : "an edge is fed to nothing";
}

const char *rules_check(void)
{
    const char *wrong = NULL;
    switch (run.scenario->call) {
    case CALL_ICP1_BEGIN:
    case CALL_INT0_BEGIN:
        wrong = check_begin();
        break;
    case CALL_NOW:
        wrong = check_now();
        break;
    case CALL_LEAVES:
        wrong = check_leaves();
        break;
    case CALL_SENT:
        wrong = check_sent();
        break;
    case CALL_TAKE:
        wrong = check_level();
        break;
    case CALL_IDLE:
        wrong = check_idle();
        break;
    default:
        break;
    }
    if (wrong == NULL) wrong = check_bytes();
    if (wrong == NULL) wrong = check_wire();
    if (wrong == NULL) wrong = check_pulses();
    return wrong;
}
