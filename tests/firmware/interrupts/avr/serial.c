/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static serial_t *serial_of(event_t first, event_t second)
{
    return second == EVENT_NONE ? &shared->alone[first] : &shared->two[first][second];
}

static void compute(const scenario_t *scenario, serial_t *serial, const order_t *order)
{
    outcome_t *const outcome = &serial->outcomes[serial->count++];
    if (!fork_here()) return;
    uint64_t overflow_cycle = 0;
    for (int i = 0; i < 2; i++)
        if (order->events[i] == EVENT_OVERFLOW) overflow_cycle = slot_cycle(order->slots[i]);
    scenario_run(scenario, order, overflow_cycle, EVENT_NONE);
    *outcome = run.outcome;
    const char *const wrong = rules_check();
    if (wrong != NULL) {
        printf("wrong %s: %s in slot %u, %s in slot %u: %s\n", scenario->name, event_names[order->events[0]],
               order->slots[0], event_names[order->events[1]], order->slots[1], wrong);
        shared->wrongs++;
    }
    _exit(EXIT_SUCCESS);
}

/* The first before the path or after it, the second likewise; on one side in both orders, and together: two edges of a
 * pin that are no interrupt apart are one interrupt. Of two alike the first stays the first. */
void serial_compute(const scenario_t *scenario, event_t first, event_t second)
{
    static const uint8_t slots[SERIALS][2] = {{0, 1}, {0, 0}, {0, 2}, {2, 3}, {2, 2}, {1, 0}, {2, 0}, {3, 2}};
    const bool is_alike = first == second;
    serial_t *const serial = serial_of(first, second);
    if (serial->count != 0) return;
    for (int i = 0; i < SERIALS && !(is_alike && i == 5); i++) {
        const order_t order = {{first, second}, {slots[i][0], slots[i][1]}};
        if (second == EVENT_NONE && i != 0 && i != 3) continue;
        compute(scenario, serial, &order);
    }
}

static void complain(const char *what)
{
    shared->wrongs++;
    if (shared->complaints++ >= 8) return;
    printf("wrong %s:", run.scenario->name);
    for (uint8_t i = 0; i < run.raises; i++)
        printf("%s %s at %04x", i == 0 ? "" : " and", event_names[run.raised[i].event],
               run.raised[i].address);
    printf(": %s\n", what);
}

/* One that came alone where it could interrupt has done so there. */
static const char *was_there(void)
{
    const raised_t *const raised = &run.raised[0];
    if (raised->event == EVENT_LEFT || raised->event == EVENT_LATE)
        return NULL; /* may be no interrupt at all */
    /* What the pin did before its interrupt is enabled is forgotten. */
    if (rules_are_all()) return NULL;
    if (!raised->has_entered) return "its interrupt never came";
    if (run.raises != 1) return NULL;
    const bool is_deferred = raised->entered_step != raised->raised_step;
    if (is_deferred) shared->deferred++;
    return is_deferred == raised->could_enter ? "its interrupt did not come at that boundary" : NULL;
}

static void count(void)
{
    if (run.raises == 1)
        shared->singles++;
    else if (run.is_pair)
        shared->pairs++;
    else
        shared->together++;
}

void serial_compare(void)
{
    count();
    const char *wrong = rules_check();
    if (wrong == NULL) wrong = was_there();
    const serial_t *const serial =
        serial_of(run.raised[0].event, run.raises == 2 ? run.raised[1].event : EVENT_NONE);
    bool is_serial = rules_are_all();
    for (uint8_t i = 0; i < serial->count; i++)
        if (memcmp(&run.outcome, &serial->outcomes[i], sizeof run.outcome) == 0) is_serial = true;
    if (wrong == NULL && !is_serial) wrong = "no serial order comes to this";
    if (wrong != NULL) complain(wrong);
}
