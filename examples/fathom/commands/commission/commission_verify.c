/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/commission/commission.h"
#include "device/setting_text.h"

/* What is asked of a unit at its own address before it counts as done. */

enum {
    TRIES = 3,
    /* An HPS-167S measures nothing in the first 5 s after power-on (#7), which the user may have made longer. */
    MEASURED_WITHIN_US = 20000000
};

static bool fail(const record_unit_t *unit, const char *what)
{
    (void)fprintf(stderr, "fathom: %s at address %u: %s\n", unit->model->name, unit->address, what);
    return false;
}

/* A failed call: why. */
static bool fail_by(commission_t *run, const record_unit_t *unit, const char *what, fathom_status_t status)
{
    (void)fprintf(stderr, "fathom: %s at address %u: %s: ", unit->model->name, unit->address, what);
    session_explain(&run->session, status);
    (void)fputc('\n', stderr);
    return false;
}

static bool is_it(commission_t *run, const record_unit_t *unit)
{
    presence_t presence = {.what = PRESENT_UNCLEAR};
    for (unsigned i = 0; i != TRIES && (presence.what == PRESENT_UNCLEAR || presence.what == PRESENT_UNKNOWN);
         i++)
        presence = presence_ask(&run->session, unit->address, 2);
    switch (presence.what) {
    case PRESENT_STOPPED:
        return false;
    case PRESENT_NONE:
        return fail(unit, "it does not answer any more; see that it is connected, and run the command again");
    case PRESENT_UNKNOWN:
        (void)fprintf(stderr, "fathom: %s at address %u: ", unit->model->name, unit->address);
        presence_explain(&run->session, &presence);
        (void)fputs("; run the command again then\n", stderr);
        return false;
    case PRESENT_UNCLEAR:
        (void)fprintf(stderr, "fathom: %s at address %u: ", unit->model->name, unit->address);
        presence_explain(&run->session, &presence);
        (void)fputs("; two that were at address 1 together may be there together now\n", stderr);
        return false;
    default:
        break;
    }
    return strcmp(presence.number, unit->number) == 0 ||
           fail(unit, "another unit answers there, by its UUID; find out which, and run the command again");
}

/* Reads the termination; "": the model has none. is_so: as it is to be. */
static fathom_status_t read_termination(commission_t *run, const record_unit_t *unit, char text[SETTING_TEXT],
                                        bool *is_so)
{
    const setting_t *const setting = setting_of(unit->model->settings, "termination");
    char wanted[SETTING_TEXT];
    fathom_status_t status = FATHOM_OK;
    *is_so = true;
    if (setting == NULL) return status;
    setting_print_value(setting, unit->address == run->options.terminated, wanted);
    for (unsigned i = 0; i != TRIES; i++) {
        status = session_get(&run->session, setting, text);
        if (status == FATHOM_OK || commission_has_ended(run)) break;
    }
    *is_so = status == FATHOM_OK && strcmp(text, wanted) == 0;
    return status;
}

bool commission_is_restarted(commission_t *run, const record_unit_t *unit)
{
    commission_proof_t proof = {.is_complete = true};
    if (unit->state == RECORD_RESTART)
        (void)read_termination(run, unit, proof.termination, &proof.is_complete);
    return proof.is_complete;
}

static bool has_termination(commission_t *run, const record_unit_t *unit, commission_proof_t *proof)
{
    const fathom_status_t status = read_termination(run, unit, proof->termination, &proof->is_complete);
    if (status != FATHOM_OK) return fail_by(run, unit, "its termination cannot be read", status);
    return proof->is_complete || unit->state == RECORD_RESTART ||
           fail(unit, "its termination reads otherwise than it was set");
}

static fathom_status_t call_measure(reader_t *reader, void *ctx)
{
    fathom_sample_t *const sample = ctx;
    return fathom_poll(&reader->sensor, sample);
}

/* Of an A05 with fewer probes than four only some give one. */
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
        if (!reader_has_more(&run->session.station->reader)) return found;
        status = session_call(&run->session, call_measure, &sample);
    }
}

static bool measures(commission_t *run, const record_unit_t *unit, fathom_sample_t *sample)
{
    const host_t *const host = run->session.channel.host;
    const uint64_t begin_us = host->now_us(host->ctx);
    fathom_status_t status = FATHOM_PENDING;
    do {
        status = measure(run, sample);
        if (status == FATHOM_OK && sample->kind != FATHOM_FAULT) return true;
        if (status == FATHOM_ERR_PORT) break;
    } while (!commission_has_ended(run) && host->now_us(host->ctx) - begin_us < MEASURED_WITHIN_US);
    if (status == FATHOM_OK)
        return fail(unit, "it reports a fault; it has its address, and does not measure");
    return fail_by(run, unit, "it has its address, and no measurement came", status);
}

/* One that does not obey alone, or two with one number. The next one may be there already. */
static bool has_left(commission_t *run, const record_unit_t *unit)
{
    if (unit->address == FACTORY_ADDRESS) return true;
    const presence_t presence = presence_ask(&run->session, FACTORY_ADDRESS, 1);
    if (presence.what == PRESENT_STOPPED) return false;
    if (presence.what != PRESENT_ONE || !record_has_numbers(unit->model) ||
        strcmp(presence.number, unit->number) != 0)
        return true;
    return fail(unit, "a unit with the same UUID answers at address 1 too; disconnect one of the two");
}

bool commission_verify(commission_t *run, const record_unit_t *unit, commission_proof_t *proof)
{
    return is_it(run, unit) && has_termination(run, unit, proof) && measures(run, unit, &proof->sample) &&
           has_left(run, unit);
}
