/* SPDX-License-Identifier: MIT */
#include "commands/commission/commission.h"

#include <inttypes.h>
#include <string.h>

#include "commands/commands.h"

/* fathom commission: units that all come with address 1 get an address each, one after the other. */

static const char command[] = "commission";

/* ---- what is left to do ---- */

static bool has_numbers(const commission_t *run) { return record_has_numbers(run->model); }

/* A unit that is planned and not done, from this place of the record on; NULL: there is none. */
static const record_unit_t *open_from(const commission_t *run, uint32_t from)
{
    for (uint32_t i = from; i < run->record.count; i++) {
        const record_unit_t *const unit = &run->record.units[i];
        if (unit->model == run->model && unit->state != RECORD_DONE) return unit;
    }
    return NULL;
}

/* The address that the next unit gets that is in no record; 0: there is none left. */
static uint8_t next_address(commission_t *run)
{
    for (uint32_t i = 0; i != run->options.count; i++) {
        const uint8_t address = run->options.addresses[i];
        /* A unit that keeps address 1 is in the way of all others. */
        if (record_at(&run->record, address) == NULL &&
            (address != FACTORY_ADDRESS || open_from(run, 0) == NULL))
            return address;
    }
    return 0;
}

static uint32_t count_done(commission_t *run)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i != run->options.count; i++) {
        const record_unit_t *const unit = record_at(&run->record, run->options.addresses[i]);
        if (unit != NULL && unit->state == RECORD_DONE) count++;
    }
    return count;
}

/* ---- taking up again ---- */

static bool is_same(const record_unit_t *unit, const presence_t *presence)
{
    return presence->what == PRESENT_ONE && strcmp(unit->number, presence->number) == 0;
}

/* A unit that is planned: it is at its address, or still at address 1. may_be_new: what answers at address 1 without a
 * number may also be another one, which would get its address a second time. */
static commission_end_t settle(commission_t *run, const record_unit_t *unit, bool may_be_new)
{
    presence_t presence = presence_ask(&run->session, unit->address, 2);
    if (presence.what == PRESENT_UNCLEAR || presence.what == PRESENT_UNKNOWN)
        presence = presence_ask(&run->session, unit->address, 2);
    if (is_same(unit, &presence))
        return commission_is_restarted(run, unit) ? commission_unit(run, unit, unit->address)
                                                  : COMMISSION_LATER;
    if (presence.what == PRESENT_NONE && (has_numbers(run) || !may_be_new)) {
        presence = presence_ask(&run->session, FACTORY_ADDRESS, 2);
        if (is_same(unit, &presence)) return commission_unit(run, unit, FACTORY_ADDRESS);
    }
    if (presence.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    (void)fprintf(commission_text(run), "address %u stays reserved: its unit%s%s was not found\n",
                  unit->address, has_numbers(run) ? " " : "", has_numbers(run) ? unit->number : "");
    return COMMISSION_LATER;
}

static bool settle_all(commission_t *run, bool may_be_new)
{
    for (uint32_t i = 0; i != run->record.count; i++) {
        const record_unit_t unit = run->record.units[i];
        if (unit.model != run->model || unit.state == RECORD_DONE) continue;
        if (settle(run, &unit, may_be_new) == COMMISSION_STOPPED) return false;
    }
    return true;
}

/* Units without numbers have to be there: else one that was moved without being heard could be made a second time. */
static bool are_there(commission_t *run)
{
    if (has_numbers(run) || run->options.is_taken_away) return true;
    for (uint32_t i = 0; i != run->record.count; i++) {
        const record_unit_t *const unit = &run->record.units[i];
        if (unit->model != run->model || unit->state != RECORD_DONE) continue;
        const presence_t presence = presence_ask(&run->session, unit->address, 2);
        if (presence.what == PRESENT_STOPPED) return false;
        if (presence.what == PRESENT_UNKNOWN) {
            (void)fprintf(
                stderr,
                "fathom: address %u is done by the record, and could not be asked: nothing was written; ",
                unit->address);
            presence_explain(&run->session, &presence);
            (void)fputc('\n', stderr);
            return false;
        }
        if (presence.what != PRESENT_NONE) continue;
        (void)fprintf(stderr,
                      "fathom: address %u is done by the record, and no unit answers there: nothing was "
                      "written. Connect it and switch it on, or if it was taken away: --taken-away\n",
                      unit->address);
        return false;
    }
    return true;
}

/* ---- the next one ---- */

/* The unit that answers at address 1. */
static commission_end_t take(commission_t *run, const presence_t *presence, uint8_t address)
{
    record_unit_t plan = {.model = run->model, .address = address};
    const record_unit_t *const known = record_of(&run->record, run->model, presence->number);
    (void)snprintf(plan.number, sizeof plan.number, "%s", presence->number);
    if (known == NULL) return commission_unit(run, &plan, FACTORY_ADDRESS);
    if (known->state == RECORD_DONE)
        commission_tell(run, "the unit at address 1 was address %u before, and gets that again",
                        known->address);
    return commission_unit(run, known, FACTORY_ADDRESS);
}

/* Looks for one of the units that are open, in turn. */
static commission_end_t look_for_open(commission_t *run, uint32_t *turn)
{
    const record_unit_t *open = open_from(run, *turn);
    if (open == NULL) open = open_from(run, 0);
    if (open == NULL) return COMMISSION_LATER;
    *turn = (uint32_t)(open - run->record.units) + 1;
    const presence_t presence = presence_ask(&run->session, open->address, 1);
    if (presence.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    return is_same(open, &presence) && commission_is_restarted(run, open)
               ? commission_unit(run, open, open->address)
               : COMMISSION_LATER;
}

/* Looks once. */
static commission_end_t look(commission_t *run, uint8_t address, uint32_t *turn)
{
    if (address == 0) {
        commission_tell(run, "switch the units off and on whose termination reads otherwise until then");
        return look_for_open(run, turn);
    }
    const presence_t presence = presence_ask(&run->session, FACTORY_ADDRESS, 1);
    switch (presence.what) {
    case PRESENT_STOPPED:
        return COMMISSION_STOPPED;
    case PRESENT_NONE:
        commission_tell(run, "connect the next unit, which becomes address %u", address);
        return look_for_open(run, turn);
    case PRESENT_UNKNOWN:
        commission_tell(run, "address 1 could not be asked: %s; disconnect what else sends on this line",
                        presence.status == FATHOM_ERR_OTHER_MASTER ? "another master asks there"
                                                                   : "the line is never silent");
        return COMMISSION_LATER;
    case PRESENT_UNCLEAR:
        commission_tell(run, "two units at address 1, or a loose wire: what answers is %s; connect one alone",
                        presence.is_two ? "two responses" : "damaged");
        return COMMISSION_LATER;
    default:
        return take(run, &presence, address);
    }
}

static bool waits_for_restart(const commission_t *run)
{
    const record_unit_t *unit = open_from(run, 0);
    while (unit != NULL && unit->state != RECORD_RESTART)
        unit = open_from(run, (uint32_t)(unit - run->record.units) + 1);
    return unit != NULL;
}

static bool work(commission_t *run)
{
    enum { PAUSE_US = 200000 };
    const host_t *const host = run->session.channel.host;
    uint64_t since_us = host->now_us(host->ctx);
    uint32_t turn = 0;
    for (uint8_t address; (address = next_address(run)) != 0 || waits_for_restart(run);) {
        const commission_end_t end = look(run, address, &turn);
        if (end == COMMISSION_STOPPED || commission_has_ended(run)) return false;
        const uint64_t now_us = host->now_us(host->ctx);
        if (end == COMMISSION_DONE) since_us = now_us;
        if (run->options.wait_us != 0 && now_us - since_us > run->options.wait_us) {
            (void)fprintf(stderr, "fathom: no unit was commissioned for %" PRIu64 " s\n",
                          run->options.wait_us / 1000000);
            return false;
        }
        session_listen(&run->session, PAUSE_US);
    }
    return true;
}

/* What was open is looked for first, and once more when all others are done. */
static void work_all(commission_t *run)
{
    enum { LATE_US = 1000000 };
    /* What a run that has just been ended asked for last may still come, and could pass for what is asked now. */
    session_listen(&run->session, LATE_US);
    if (!are_there(run) || !settle_all(run, run->options.is_taken_away) || !work(run)) return;
    if (open_from(run, 0) != NULL && settle_all(run, true)) (void)work(run);
}

/* ---- the end ---- */

static int finish(commission_t *run)
{
    bool is_all = true;
    for (uint32_t i = 0; i != run->record.count; i++) {
        const record_unit_t *const unit = &run->record.units[i];
        if (unit->model != run->model || unit->state == RECORD_DONE) continue;
        commission_report(run, unit, NULL);
        is_all = false;
    }
    const uint32_t done = count_done(run);
    is_all = is_all && done == run->options.count;
    (void)fprintf(commission_text(run), "%" PRIu32 " of %" PRIu32 " addresses are given and verified%s\n",
                  done, run->options.count, is_all ? "" : "; the same command again goes on from there");
    return fflush(stdout) == 0 && ferror(stdout) == 0 && is_all ? STATUS_OK : STATUS_FAILED;
}

/* What the record holds against this list. */
static bool suits(commission_t *run)
{
    for (uint32_t i = 0; i != run->options.count; i++) {
        const uint8_t address = run->options.addresses[i];
        const record_unit_t *const unit = record_at(&run->record, address);
        if (unit == NULL || unit->model == run->model) continue;
        (void)usage_error(command, "address %u is that of an %s by the record %s", address, unit->model->name,
                          run->record.path);
        return false;
    }
    const record_unit_t *const first = record_at(&run->record, FACTORY_ADDRESS);
    if (first == NULL || next_address(run) == 0 || next_address(run) == FACTORY_ADDRESS) return true;
    (void)usage_error(
        command,
        "a unit keeps address %d by the record %s, where the next one would come; give that one "
        "another address, and delete its line",
        FACTORY_ADDRESS, run->record.path);
    return false;
}

static int run_commission(const host_t *host, int argc, char **argv)
{
    static commission_t run;
    bool wants_help = false;
    memset(&run, 0, sizeof run);
    if (!commission_options(&run.options, &run.session, argc, argv, &wants_help)) return STATUS_USAGE;
    if (wants_help) return command_help(&commission_command);
    run.model = run.session.station->model;
    if (!record_read(&run.record, run.options.record)) return STATUS_FAILED;
    if (!suits(&run)) return STATUS_USAGE;
    if (!session_open(&run.session, host)) return STATUS_FAILED;
    int status = STATUS_FAILED;
    if (record_write(&run.record)) { /* that it can be is known before anything is sent */
        work_all(&run);
        status = finish(&run);
    }
    session_close(&run.session);
    return status;
}

const command_t commission_command = {"commission",
                                      "gives units that all come with address 1 an address each",
                                      commission_help, run_commission};
