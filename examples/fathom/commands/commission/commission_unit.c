/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/command.h"
#include "commands/commission/commission.h"
#include "device/change.h"
#include "device/setting_text.h"

/* What is written to one unit, and in which order. */

/* How often a unit may answer and then not let itself be set, before it is given up; and how often it is read. */
enum { UNWRITTEN = 3, READS = 3 };

static bool has_output(void)
{
    if (output_flush() == 0) return true;
    (void)fputs("fathom: the output cannot be written; it has ended\n", stderr);
    return false;
}

/* "#8" of "Modbus address (#8)": the command or register, as its table names it. */
static void print_where(FILE *to, const setting_t *setting)
{
    const char *const open = strchr(setting->what, '(');
    if (open != NULL) (void)fprintf(to, " %.*s", (int)strcspn(open, ")") + 1, open);
}

static bool announce(const commission_t *run, const change_t *change)
{
    FILE *const to = commission_text(run);
    (void)fprintf(to, "  writes %s %s", change->setting->name, change->wanted);
    print_where(to, change->setting);
    (void)fputc('\n', to);
    return has_output();
}

/* Is this so already? Where it cannot be read: no. */
static fathom_status_t look(commission_t *run, change_t *change, bool *is_so)
{
    fathom_status_t status = FATHOM_OK;
    change->was[0] = '\0';
    for (unsigned i = 0; i != READS && change->setting->get != NULL; i++) {
        status = session_get(&run->session, change->setting, change->was);
        if (status == FATHOM_OK || commission_has_ended(run)) break;
    }
    *is_so = status == FATHOM_OK && strcmp(change->was, change->wanted) == 0;
    return status;
}

static commission_end_t not_set(commission_t *run, const change_t *change, change_outcome_t outcome,
                                fathom_status_t status)
{
    if (status == FATHOM_ERR_DIFFERS && !change->setting->moves) return COMMISSION_RESTART;
    change_explain(change, outcome, status);
    if (status == FATHOM_ERR_DIFFERS)
        (void)fputs("fathom: or from its next power-on: switch it off and on, and run the command again\n",
                    stderr);
    if (outcome == CHANGE_NOT_WRITTEN && status != FATHOM_ERR_CANCELLED && status != FATHOM_ERR_PORT &&
        ++run->unwritten < UNWRITTEN)
        return COMMISSION_LATER;
    return COMMISSION_STOPPED;
}

/* Sets what is not so already. */
static commission_end_t set(commission_t *run, const char *name, int32_t value)
{
    change_t change = {
        .session = &run->session, .setting = setting_of(run->model->settings, name), .value = value};
    bool is_so = false;
    setting_print_value(change.setting, value, change.wanted);
    fathom_status_t status = look(run, &change, &is_so);
    if (is_so) return COMMISSION_DONE;
    if (status != FATHOM_OK) return not_set(run, &change, CHANGE_NOT_WRITTEN, status);
    if (!announce(run, &change)) return COMMISSION_STOPPED;
    run->writes++;
    status = session_set(&run->session, change.setting, value);
    if (!run->session.station->reader.unit->is_written) run->writes--;
    const change_outcome_t outcome = change_outcome(&change, status);
    if (outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE) return COMMISSION_DONE;
    return not_set(run, &change, outcome, status);
}

/* ---- before ---- */

/* Nothing may answer where it is to be, and it has not been taken for another one meanwhile. */
static commission_end_t look_around(commission_t *run, const record_unit_t *plan, uint8_t at)
{
    if (at == plan->address) return COMMISSION_DONE;
    /* Once; right before the write the driver asks there again (modbus_setting.h). */
    const presence_t target = presence_ask(&run->session, plan->address, 1);
    if (target.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    if (target.what == PRESENT_UNKNOWN) {
        commission_tell(run,
                        "address %u, which the unit at address %u is to get, could not be asked: nothing was "
                        "written; disconnect what else sends on this line",
                        plan->address, at);
        return COMMISSION_LATER;
    }
    if (target.what != PRESENT_NONE) {
        commission_tell(
            run,
            "something answers at address %u, which the unit at address %u is to get: nothing was written; "
            "disconnect one of the two",
            plan->address, at);
        return COMMISSION_LATER;
    }
    const presence_t here = presence_ask(&run->session, at, 2);
    if (here.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    return here.what == PRESENT_ONE && strcmp(here.number, plan->number) == 0 ? COMMISSION_DONE
                                                                              : COMMISSION_LATER;
}

/* ---- afterwards ---- */

static uint64_t utc_us(const commission_t *run)
{
    const host_t *const host = run->session.channel.host;
    return host->utc_us(host->ctx);
}

static commission_end_t finish(commission_t *run, record_unit_t *unit)
{
    commission_proof_t proof = {.termination = ""};
    if (!commission_verify(run, unit, &proof)) return COMMISSION_STOPPED;
    record_unit_t done = *unit;
    if (proof.is_complete) done.state = RECORD_DONE;
    if (record_put(&run->record, &done, utc_us(run)) == NULL) return COMMISSION_STOPPED;
    run->unwritten = 0;
    run->last_told[0] = '\0';
    commission_report(run, unit, &proof);
    return has_output() ? COMMISSION_DONE : COMMISSION_STOPPED;
}

/* The termination, which #11 sets for the next power-on; what #2 tells until then is not in the datasheet. */
static commission_end_t set_termination(commission_t *run, record_unit_t *unit)
{
    if (setting_of(run->model->settings, "termination") == NULL || unit->state == RECORD_RESTART)
        return COMMISSION_DONE;
    const commission_end_t end = set(run, "termination", unit->address == run->options.terminated);
    if (end != COMMISSION_RESTART) return end;
    record_unit_t restart = *unit;
    restart.state = RECORD_RESTART;
    return record_put(&run->record, &restart, utc_us(run)) != NULL ? COMMISSION_DONE : COMMISSION_STOPPED;
}

static void print_begin(const commission_t *run, const record_unit_t *plan, uint8_t at)
{
    FILE *const to = commission_text(run);
    (void)fprintf(to, "%s at address %u", plan->model->name, at);
    if (record_has_numbers(plan->model)) (void)fprintf(to, ", UUID %s", plan->number);
    if (at == plan->address)
        (void)fputs(": is looked through\n", to);
    else
        (void)fprintf(to, ": becomes address %u\n", plan->address);
}

commission_end_t commission_unit(commission_t *run, const record_unit_t *plan, uint8_t at)
{
    record_unit_t planned = *plan;
    const bool was_there = record_at(&run->record, plan->address) != NULL;
    const unsigned writes = run->writes;
    if (planned.state == RECORD_DONE) planned.state = RECORD_PLANNED;
    commission_end_t end = look_around(run, &planned, at);
    if (end != COMMISSION_DONE) return end;
    print_begin(run, &planned, at);
    record_unit_t *const unit = record_put(&run->record, &planned, utc_us(run));
    if (unit == NULL || !has_output()) return COMMISSION_STOPPED;
    end = set_termination(run, unit);
    if (end == COMMISSION_DONE && at != unit->address) end = set(run, "address", unit->address);
    if (end == COMMISSION_DONE) return finish(run, unit);
    /* One to which nothing was written is as good as a new one, and may be one. */
    const bool is_new = end == COMMISSION_LATER && !was_there && run->writes == writes;
    return is_new && !record_drop(&run->record, unit) ? COMMISSION_STOPPED : end;
}
