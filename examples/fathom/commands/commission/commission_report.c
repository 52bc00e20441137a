/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <string.h>

#include "commands/commission/commission.h"

FILE *commission_text(const commission_t *run) { return run->session.is_json ? stderr : stdout; }

void commission_prompt(commission_t *run, const char *format, ...)
{
    char text[sizeof run->prompt];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (strcmp(text, run->prompt) == 0) return;
    memcpy(run->prompt, text, sizeof text);
    (void)fprintf(commission_text(run), "%s\n", text);
    (void)fflush(commission_text(run));
}

bool commission_has_ended(const commission_t *run)
{
    const host_t *const host = run->session.port.host;
    return host->has_ended(host->ctx);
}

/* ---- results ---- */

static void print_json(const record_unit_t *unit, const commission_proof_t *proof)
{
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    json_string(&json, "model", unit->model->name);
    json_value(&json, "address", "%u", unit->address);
    json_string(&json, "uuid", record_has_numbers(unit->model) ? unit->number : NULL);
    if (proof != NULL && proof->termination[0] != '\0')
        json_flag(&json, "termination", strcmp(proof->termination, "on") == 0);
    if (proof != NULL && proof->sample.kind == FATHOM_TARGET)
        json_value(&json, "distance_mm", "%u", proof->sample.distance_mm);
    json_string(&json, "status", record_states[unit->state]);
    json_string(&json, "utc", unit->when);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

static void print_done(const record_unit_t *unit, const commission_proof_t *proof)
{
    const fathom_sample_t *const sample = &proof->sample;
    if (!proof->is_complete) {
        (void)printf("  address %u is set, but the termination reads %s until the next power-on. Switch the "
                     "sensor off and on, and run the command again\n",
                     unit->address, proof->termination);
        return;
    }
    (void)printf("  address %u is done: ", unit->address);
    if (proof->termination[0] != '\0')
        (void)printf("termination %s%s, ", proof->termination,
                     strcmp(proof->termination, "off") == 0 ? " from the next power-on" : "");
    if (sample->kind == FATHOM_TARGET)
        (void)printf("%u mm\n", sample->distance_mm);
    else
        (void)puts(sample->kind == FATHOM_NO_TARGET ? "no_target" : "a value without a known meaning");
}

static void print_open(const record_unit_t *unit)
{
    (void)printf("address %u is not done: the sensor", unit->address);
    if (record_has_numbers(unit->model)) (void)printf(" with UUID %s", unit->number);
    if (unit->address == FACTORY_ADDRESS)
        (void)puts(" is not verified");
    else
        (void)printf(" is at this address, not verified, or still at address %d\n", FACTORY_ADDRESS);
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
