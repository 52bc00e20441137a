/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/commission/commission.h"
#include "device/setting_text.h"

/* Verifies a sensor at its own address. */

enum {
    TRIES = 3,
    /* An HPS-167S does not measure in the first 5 s after power-on, or longer (#7). */
    MEASURED_WITHIN_US = 20000000
};

static bool fail(const record_unit_t *unit, const char *what)
{
    (void)fprintf(stderr, "fathom: %s at address %u: %s\n", unit->model->name, unit->address, what);
    return false;
}

static bool fail_by(commission_t *run, const record_unit_t *unit, const char *what, fathom_status_t status)
{
    (void)fprintf(stderr, "fathom: %s at address %u: %s: ", unit->model->name, unit->address, what);
    session_explain(&run->session, status);
    (void)fputc('\n', stderr);
    return false;
}

static bool is_same_sensor(commission_t *run, const record_unit_t *unit)
{
    presence_t presence = {.what = PRESENT_UNCLEAR};
    for (unsigned i = 0; i != TRIES && (presence.what == PRESENT_UNCLEAR || presence.what == PRESENT_UNKNOWN);
         i++)
        presence = presence_ask(&run->session, unit->address, &run->session.sensor->line, 2);
    switch (presence.what) {
    case PRESENT_STOPPED:
        return false;
    case PRESENT_NONE:
        return fail(unit, "the sensor does not respond any more. Check its wires, and run the command again");
    case PRESENT_UNKNOWN:
    case PRESENT_UNCLEAR:
        (void)fprintf(stderr, "fathom: %s at address %u: ", unit->model->name, unit->address);
        presence_explain(&run->session, &presence);
        (void)fputs(presence.what == PRESENT_UNKNOWN
                        ? ". Then run the command again\n"
                        : ". If two sensors were at address 1, both may have this address now\n",
                    stderr);
        return false;
    default:
        break;
    }
    return strcmp(presence.number, unit->number) == 0 ||
           fail(unit, "a sensor with another UUID responds. Find out which, and run the command again");
}

static bool read_termination(commission_t *run, const record_unit_t *unit, commission_proof_t *proof)
{
    const setting_t *const setting = setting_of(unit->model->settings, "termination");
    char wanted[SETTING_TEXT];
    fathom_status_t status = FATHOM_OK;
    proof->is_complete = true;
    if (setting == NULL) return true;
    setting_print_value(setting, unit->address == run->options.terminated, wanted);
    for (unsigned i = 0; i != TRIES; i++) {
        status = session_get(&run->session, setting, proof->termination);
        if (status == FATHOM_OK || commission_has_ended(run)) break;
    }
    if (status != FATHOM_OK) return fail_by(run, unit, "cannot read the termination", status);
    proof->is_complete = strcmp(proof->termination, wanted) == 0;
    return true;
}

static fathom_status_t call_measure(reader_t *reader, void *ctx)
{
    fathom_sample_t *const sample = ctx;
    return reader_poll(reader, sample);
}

/* Prefers a sample with a distance: an A05 may have fewer than four probes. */
static fathom_status_t measure(commission_t *run, fathom_sample_t *best)
{
    fathom_sample_t sample;
    fathom_status_t status = session_call(&run->session, call_measure, &sample);
    if (status != FATHOM_OK && status != FATHOM_ERR_MALFORMED) return status;
    fathom_status_t found = FATHOM_ERR_MALFORMED;
    for (;;) {
        const bool is_better = found != FATHOM_OK || best->kind != FATHOM_TARGET;
        if (status == FATHOM_OK && is_better) *best = sample;
        if (status == FATHOM_OK) found = FATHOM_OK;
        if (!reader_has_more(run->session.sensor->reader)) return found;
        status = session_call(&run->session, call_measure, &sample);
    }
}

static bool measures(commission_t *run, const record_unit_t *unit, fathom_sample_t *sample)
{
    const host_t *const host = run->session.port.host;
    const uint64_t begin_us = host->now_us(host->ctx);
    fathom_status_t status = FATHOM_PENDING;
    do {
        status = measure(run, sample);
        if (status == FATHOM_OK && sample->kind != FATHOM_FAULT) return true;
        if (status == FATHOM_ERR_PORT) break;
    } while (!commission_has_ended(run) && host->now_us(host->ctx) - begin_us < MEASURED_WITHIN_US);
    if (status == FATHOM_OK) return fail(unit, "the address is set, but the sensor reports a fault");
    return fail_by(run, unit, "the address is set, but the sensor does not measure", status);
}

/* At address 1, there may be the next sensor, but none with this UUID. */
static bool has_left(commission_t *run, const record_unit_t *unit)
{
    if (unit->address == FACTORY_ADDRESS) return true;
    const presence_t presence = presence_ask(&run->session, FACTORY_ADDRESS, &run->session.sensor->line, 1);
    if (presence.what == PRESENT_STOPPED) return false;
    if (presence.what != PRESENT_ONE || !record_has_numbers(unit->model) ||
        strcmp(presence.number, unit->number) != 0)
        return true;
    return fail(unit, "a sensor with the same UUID responds at address 1 too. Disconnect one of the two");
}

bool commission_verify(commission_t *run, const record_unit_t *unit, commission_proof_t *proof)
{
    return is_same_sensor(run, unit) && read_termination(run, unit, proof) &&
           measures(run, unit, &proof->sample) && has_left(run, unit);
}
