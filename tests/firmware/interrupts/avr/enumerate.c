/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static depth_t depth;

bool fork_here(void)
{
    int status;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) return true;
    if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
        printf("wrong: a run did not come to its end\n");
        shared->wrongs++;
    }
    return false;
}

static bool is_among(event_t event, const event_t *events)
{
    for (int i = 0; i < MOST_EVENTS && events[i] != EVENT_NONE; i++)
        if (events[i] == event) return true;
    return false;
}

/* ---- its boundaries ---- */

static bool raise_in_a_fork(event_t event)
{
    if (!fork_here()) return false;
    run.is_pair = run.raises == 1;
    run_raise(event);
    return true;
}

static void first_at_boundary(const scenario_t *scenario)
{
    const event_t *const events = scenario->events;
    for (int i = 0; events[i] != EVENT_NONE; i++) {
        if (events[i] == EVENT_OVERFLOW) continue;
        if (raise_in_a_fork(events[i])) return;
        for (int j = i; depth != DEPTH_ALONE && events[j] != EVENT_NONE; j++) {
            if (events[j] == EVENT_OVERFLOW || !fork_here()) continue;
            run_raise(events[i]);
            run_raise(events[j]);
            return;
        }
    }
}

static void second_at_boundary(const scenario_t *scenario)
{
    for (int i = 0; scenario->pairs[i] != EVENT_NONE; i++)
        if (scenario->pairs[i] != EVENT_OVERFLOW && raise_in_a_fork(scenario->pairs[i])) return;
}

/* What is carried out only while an overflow waits: with interrupts off, so what is raised here waits too. */
static void behind_an_overflow(const scenario_t *scenario)
{
    uint8_t *const covered = &shared->covered[(uint16_t)board.avr->pc / 2];
    if (*covered != 0 || board.avr->sreg[S_I] || !run.raised[0].has_raised) return;
    if (run.raised[0].event != EVENT_OVERFLOW || !is_among(EVENT_BYTE, scenario->events)) return;
    *covered = 1;
    if (!fork_here()) return;
    run.is_pair = true;
    run_raise_here(EVENT_BYTE);
}

static bool was_broken_into; /* the boundary behind the last instruction */

static void at_boundary(void)
{
    const scenario_t *const scenario = run.scenario;
    const bool is_first = run.raises == 0;
    const bool is_second =
        run.raises == 1 && depth == DEPTH_PAIRS && is_among(run.raised[0].event, scenario->pairs);
    if (was_broken_into) shared->covered[(uint16_t)board.avr->pc / 2] = 1;
    was_broken_into = is_first || is_second;
    if (is_first) {
        shared->boundaries++;
        first_at_boundary(scenario);
    } else if (is_second) {
        second_at_boundary(scenario);
    } else if (run.raises == 1 && depth != DEPTH_ALONE) {
        behind_an_overflow(scenario);
    }
}

/* ---- all ---- */

static void serial_orders(const scenario_t *scenario)
{
    for (int i = 0; scenario->events[i] != EVENT_NONE; i++) {
        serial_compute(scenario, scenario->events[i], EVENT_NONE);
        for (int j = i; depth != DEPTH_ALONE && scenario->events[j] != EVENT_NONE; j++)
            if (scenario->events[j] != EVENT_OVERFLOW || i != j)
                serial_compute(scenario, scenario->events[i], scenario->events[j]);
        if (depth != DEPTH_ALONE && scenario->events[i] != EVENT_OVERFLOW &&
            is_among(EVENT_OVERFLOW, scenario->events))
            serial_compute(scenario, EVENT_OVERFLOW, scenario->events[i]);
    }
    for (int i = 0; depth == DEPTH_PAIRS && scenario->pairs[i] != EVENT_NONE; i++)
        for (int j = 0; scenario->pairs[j] != EVENT_NONE; j++)
            if (scenario->pairs[j] != EVENT_OVERFLOW)
                serial_compute(scenario, scenario->pairs[i], scenario->pairs[j]);
}

/* And then ends this process. */
static void run_one(const scenario_t *scenario, uint64_t overflow_cycle, event_t at_overflow)
{
    scenario_run(scenario, NULL, overflow_cycle, at_overflow);
    if (run.raises != 0) serial_compare();
    if (run.raises == 0) {
        const char *const wrong = rules_check();
        if (wrong != NULL) shared->wrongs++, printf("wrong %s: nothing happens: %s\n", scenario->name, wrong);
    }
    _exit(EXIT_SUCCESS);
}

static void each_overflow(const scenario_t *scenario)
{
    for (uint64_t cycle = shared->cycles[0] + 1; cycle <= shared->cycles[shared->length - 1]; cycle++) {
        run_boundary = at_boundary;
        if (fork_here()) run_one(scenario, cycle, EVENT_NONE);
        run_boundary = NULL;
        for (int i = 0; depth != DEPTH_ALONE && scenario->events[i] != EVENT_NONE; i++)
            if (scenario->events[i] != EVENT_OVERFLOW && fork_here())
                run_one(scenario, cycle, scenario->events[i]);
    }
}

bool enumerate(const scenario_t *scenario, depth_t how_far)
{
    memset(shared, 0, sizeof *shared);
    depth = how_far;
    if (fork_here()) run_one(scenario, 0, EVENT_NONE);
    serial_orders(scenario);
    run_boundary = at_boundary;
    if (fork_here()) run_one(scenario, 0, EVENT_NONE);
    run_boundary = NULL;
    if (is_among(EVENT_OVERFLOW, scenario->events)) each_overflow(scenario);
    for (unsigned i = 0; i < WORDS; i++)
        if (shared->covered[i]) printf("covered %x\n", 2 * i);
    printf("figures %s,%u,%u,%u,%u,%u,%u\n", scenario->name, shared->boundaries, shared->singles,
           shared->deferred, shared->together, shared->pairs, shared->nothing);
    if (shared->boundaries + 1 != shared->length) {
        printf("wrong %s: %u boundaries in a path of %u instructions\n", scenario->name, shared->boundaries,
               shared->length);
        shared->wrongs++;
    }
    return shared->wrongs == 0;
}
