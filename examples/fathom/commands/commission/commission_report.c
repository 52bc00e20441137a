/* SPDX-License-Identifier: MIT */
#include "commands/commission/commission.h"

/* What is said of a unit at last. */

static void print_json(const record_unit_t *unit, const commission_proof_t *proof)
{
    const bool has_distance = proof != NULL && proof->sample.kind == FATHOM_TARGET;
    (void)printf("{\"sensor\": \"%s\", \"address\": %u, \"uuid\": ", unit->model->name, unit->address);
    (void)printf(record_has_numbers(unit->model) ? "\"%s\"" : "null", unit->number);
    if (proof != NULL && proof->termination[0] != '\0')
        (void)printf(", \"termination\": \"%s\"", proof->termination);
    if (has_distance) (void)printf(", \"distance_mm\": %u", proof->sample.distance_mm);
    (void)printf(", \"state\": \"%s\", \"when\": \"%s\"}\n", record_states[unit->state], unit->when);
}

static void print_done(const record_unit_t *unit, const commission_proof_t *proof)
{
    const fathom_sample_t *const sample = &proof->sample;
    if (unit->state == RECORD_RESTART) {
        (void)printf("  address %u is set; its termination reads %s until it is switched off and on\n",
                     unit->address, proof->termination);
        return;
    }
    (void)printf("  address %u is done: ", unit->address);
    if (proof->termination[0] != '\0')
        (void)printf("termination %s%s, ", proof->termination,
                     proof->termination[1] == 'f' ? " from the next power-on" : "");
    if (sample->kind == FATHOM_TARGET)
        (void)printf("%u mm\n", sample->distance_mm);
    else
        (void)puts(sample->kind == FATHOM_NO_TARGET ? "no target" : "a value without a meaning");
}

static void print_open(const record_unit_t *unit)
{
    (void)printf("address %u is open: ", unit->address);
    if (record_has_numbers(unit->model)) (void)printf("UUID %s, ", unit->number);
    if (unit->state == RECORD_RESTART)
        (void)puts("it is to be switched off and on");
    else if (unit->address == FACTORY_ADDRESS)
        (void)puts("not verified");
    else
        (void)printf("which is there or still at address %d\n", FACTORY_ADDRESS);
}

void commission_report(const commission_t *run, const record_unit_t *unit, const commission_proof_t *proof)
{
    if (run->session.is_json)
        print_json(unit, proof);
    else if (proof != NULL)
        print_done(unit, proof);
    else
        print_open(unit);
}
