/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/command.h"
#include "commands/commission/commission.h"
#include "device/change.h"
#include "device/setting_text.h"

/* Writes the settings of one sensor. */

enum {
    MOST_UNWRITTEN = 3, /* times that a sensor may respond and then not be written, before the command ends */
    READS = 3           /* attempts to read a setting */
};

static bool has_output(void)
{
    if (output_flush() == 0) return true;
    (void)fputs("fathom: cannot write the output. The command ends.\n", stderr);
    return false;
}

/* Prints the command or register, "(#8)" of "Modbus address (#8)". */
static void print_register(FILE *to, const setting_t *setting)
{
    const char *const open = strchr(setting->what, '(');
    if (open != NULL) (void)fprintf(to, " %.*s", (int)strcspn(open, ")") + 1, open);
}

static bool announce(const commission_t *run, const change_t *change)
{
    FILE *const to = commission_text(run);
    (void)fprintf(to, "  writes %s %s", change->setting->name, change->wanted);
    print_register(to, change->setting);
    (void)fputc('\n', to);
    return has_output();
}

static fathom_status_t read_setting(commission_t *run, change_t *change)
{
    fathom_status_t status = FATHOM_OK;
    change->was[0] = '\0';
    for (unsigned i = 0; i != READS && change->setting->get != NULL; i++) {
        status = session_get(&run->session, change->setting, change->was);
        if (status == FATHOM_OK || commission_has_ended(run)) break;
    }
    return status;
}

static commission_end_t end_unset(commission_t *run, const change_t *change, change_outcome_t outcome,
                                  fathom_status_t status)
{
    change_explain(change, outcome, status);
    if (status == FATHOM_ERR_DIFFERS)
        (void)fputs("fathom: the new value may take effect at the next power-on. Switch the sensor off and "
                    "on, and run the command again.\n",
                    stderr);
    if (outcome == CHANGE_NOT_WRITTEN && status != FATHOM_ERR_CANCELLED && status != FATHOM_ERR_PORT &&
        ++run->unwritten_count < MOST_UNWRITTEN)
        return COMMISSION_LATER;
    return COMMISSION_STOPPED;
}

/* Writes a setting, unless the sensor has this value already. */
static commission_end_t set(commission_t *run, const char *name, int32_t value)
{
    change_t change = {
        .session = &run->session, .setting = setting_of(run->model->settings, name), .value = value};
    setting_print_value(change.setting, value, change.wanted);
    fathom_status_t status = read_setting(run, &change);
    if (status != FATHOM_OK) return end_unset(run, &change, CHANGE_NOT_WRITTEN, status);
    if (strcmp(change.was, change.wanted) == 0) return COMMISSION_DONE;
    if (!announce(run, &change)) return COMMISSION_STOPPED;
    run->write_count++;
    status = session_set(&run->session, change.setting, value);
    if (!reader_facts(run->session.sensor->reader).is_written) run->write_count--;
    const change_outcome_t outcome = change_outcome(&change, status);
    if (outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE) return COMMISSION_DONE;
    /* the termination was acknowledged; the datasheet does not state what #2 reads until the next power-on */
    if (status == FATHOM_ERR_DIFFERS && !change.setting->moves) return COMMISSION_DONE;
    return end_unset(run, &change, outcome, status);
}

/* ---- one sensor ---- */

/* No sensor may respond at the new address, and the sensor must still be the one that was found. */
static commission_end_t check_places(commission_t *run, const record_unit_t *plan, uint8_t at)
{
    const fathom_line_settings_t *const line = &run->session.sensor->line;
    if (at == plan->address) return COMMISSION_DONE;
    /* Once is enough: the driver asks there again right before the write (modbus_setting.h). */
    const presence_t target = presence_ask(&run->session, plan->address, line, 1);
    if (target.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    if (target.what != PRESENT_NONE) {
        const bool is_unknown = target.what == PRESENT_UNKNOWN;
        commission_prompt(
            run, "nothing was written: %s address %u, which the sensor at address %u is to get. %s",
            is_unknown ? "cannot ask at" : "a sensor responds at", plan->address, at,
            is_unknown ? "Disconnect what else sends on this line" : "Disconnect one of the two");
        return COMMISSION_LATER;
    }
    const presence_t here = presence_ask(&run->session, at, line, 2);
    if (here.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    return here.what == PRESENT_ONE && strcmp(here.number, plan->number) == 0 ? COMMISSION_DONE
                                                                              : COMMISSION_LATER;
}

static uint64_t utc_us(const commission_t *run)
{
    const host_t *const host = run->session.port.host;
    return host->utc_us(host->ctx);
}

static commission_end_t finish(commission_t *run, record_unit_t *unit)
{
    commission_proof_t proof = {.termination = ""};
    if (!commission_verify(run, unit, &proof)) return COMMISSION_STOPPED;
    record_unit_t done = *unit;
    if (proof.is_complete) done.state = RECORD_DONE;
    if (record_put(&run->record, &done, utc_us(run)) == NULL) return COMMISSION_STOPPED;
    run->unwritten_count = 0;
    run->prompt[0] = '\0';
    commission_report(run, unit, &proof);
    return has_output() ? COMMISSION_DONE : COMMISSION_STOPPED;
}

static commission_end_t set_all(commission_t *run, const record_unit_t *unit, uint8_t at)
{
    commission_end_t end = COMMISSION_DONE;
    if (setting_of(run->model->settings, "termination") != NULL)
        end = set(run, "termination", unit->address == run->options.terminated);
    return end == COMMISSION_DONE && at != unit->address ? set(run, "address", unit->address) : end;
}

static void print_start(const commission_t *run, const record_unit_t *plan, uint8_t at)
{
    FILE *const to = commission_text(run);
    (void)fprintf(to, "%s at address %u", plan->model->name, at);
    if (record_has_numbers(plan->model)) (void)fprintf(to, ", UUID %s", plan->number);
    if (at == plan->address)
        (void)fputs(": verifying\n", to);
    else
        (void)fprintf(to, ": gets address %u\n", plan->address);
}

commission_end_t commission_sensor(commission_t *run, const record_unit_t *plan, uint8_t at)
{
    record_unit_t planned = *plan;
    const bool was_known = record_at(&run->record, plan->address) != NULL;
    const unsigned write_count = run->write_count;
    planned.state = RECORD_PLANNED;
    commission_end_t end = check_places(run, &planned, at);
    if (end != COMMISSION_DONE) return end;
    print_start(run, &planned, at);
    record_unit_t *const unit = record_put(&run->record, &planned, utc_us(run));
    if (unit == NULL || !has_output()) return COMMISSION_STOPPED;
    end = set_all(run, unit, at);
    if (end == COMMISSION_DONE) return finish(run, unit);
    /* A sensor to which nothing was written is as good as a new one, and may be one. */
    const bool is_new = end == COMMISSION_LATER && !was_known && run->write_count == write_count;
    return is_new && !record_drop(&run->record, unit) ? COMMISSION_STOPPED : end;
}
