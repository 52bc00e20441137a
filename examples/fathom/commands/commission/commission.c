/* SPDX-License-Identifier: MIT */
#include "commands/commission/commission.h"

#include <inttypes.h>
#include <string.h>

#include "commands/commands.h"

/* fathom commission assigns addresses to new sensors that all have address 1, one after the other. */

static const origin_t origin = {.command = "commission"};

static bool is_open(const commission_t *run, const record_unit_t *unit)
{
    return unit->model == run->model && unit->state != RECORD_DONE;
}

static bool has_open(const commission_t *run)
{
    for (uint32_t i = 0; i != run->record.count; i++)
        if (is_open(run, &run->record.units[i])) return true;
    return false;
}

/* Returns the first address of the list that is not in the record, or 0. A sensor that keeps address 1 would be in the way
 * of all others, so it comes last. */
static uint8_t next_address(commission_t *run)
{
    for (uint32_t i = 0; i != run->options.count; i++) {
        const uint8_t address = run->options.addresses[i];
        if (record_at(&run->record, address) == NULL && (address != FACTORY_ADDRESS || !has_open(run)))
            return address;
    }
    return 0;
}

static bool is_same(const record_unit_t *unit, const presence_t *presence)
{
    return presence->what == PRESENT_ONE && strcmp(unit->number, presence->number) == 0;
}

static presence_t look_at(commission_t *run, uint8_t address, unsigned times)
{
    return presence_ask(&run->session, address, &run->session.sensor->line, times);
}

/* ---- resuming ---- */

/* Finishes a planned sensor, which is at its address or still at address 1. */
static commission_end_t resume(commission_t *run, const record_unit_t *unit)
{
    presence_t presence = look_at(run, unit->address, 2);
    if (presence.what == PRESENT_UNCLEAR || presence.what == PRESENT_UNKNOWN)
        presence = look_at(run, unit->address, 2);
    if (is_same(unit, &presence)) return commission_sensor(run, unit, unit->address);
    if (presence.what == PRESENT_NONE) {
        presence = look_at(run, FACTORY_ADDRESS, 2);
        if (is_same(unit, &presence)) return commission_sensor(run, unit, FACTORY_ADDRESS);
    }
    if (presence.what == PRESENT_STOPPED) return COMMISSION_STOPPED;
    (void)fprintf(commission_text(run), "address %u stays reserved: its sensor%s%s was not found\n",
                  unit->address, record_has_numbers(run->model) ? " " : "",
                  record_has_numbers(run->model) ? unit->number : "");
    return COMMISSION_LATER;
}

static bool resume_all(commission_t *run)
{
    for (uint32_t i = 0; i != run->record.count; i++) {
        const record_unit_t unit = run->record.units[i]; /* the record changes meanwhile */
        if (is_open(run, &unit) && resume(run, &unit) == COMMISSION_STOPPED) return false;
    }
    return true;
}

/* Sensors without a UUID have to stay connected. Otherwise a planned sensor that has already moved may be absent too, and
 * another one would get its address. */
static bool is_present(commission_t *run, const record_unit_t *unit)
{
    const presence_t presence = look_at(run, unit->address, 2);
    if (presence.what == PRESENT_STOPPED) return false;
    if (presence.what != PRESENT_UNKNOWN && presence.what != PRESENT_NONE) return true;
    (void)fprintf(stderr, "fathom: nothing was written: address %u is done in the record, but ",
                  unit->address);
    if (presence.what == PRESENT_NONE) {
        (void)fputs("no sensor responds there. Connect it and switch it on. If you took it away, remove its "
                    "line from the record and its address from --addresses\n",
                    stderr);
        return false;
    }
    presence_explain(&run->session, &presence);
    (void)fputc('\n', stderr);
    return false;
}

static bool are_present(commission_t *run)
{
    for (uint32_t i = 0; i != run->record.count && !record_has_numbers(run->model); i++) {
        const record_unit_t *const unit = &run->record.units[i];
        if (unit->model == run->model && unit->state == RECORD_DONE && !is_present(run, unit)) return false;
    }
    return true;
}

/* ---- the next sensor ---- */

static commission_end_t assign(commission_t *run, const presence_t *presence, uint8_t address)
{
    record_unit_t plan = {.model = run->model, .address = address};
    const record_unit_t *const known = record_of(&run->record, run->model, presence->number);
    (void)snprintf(plan.number, sizeof plan.number, "%s", presence->number);
    if (known == NULL) return commission_sensor(run, &plan, FACTORY_ADDRESS);
    if (known->state == RECORD_DONE)
        commission_prompt(run, "the sensor at address 1 was at address %u and gets this address again",
                          known->address);
    return commission_sensor(run, known, FACTORY_ADDRESS);
}

static commission_end_t try_next(commission_t *run, uint8_t address)
{
    const presence_t presence = look_at(run, FACTORY_ADDRESS, 1);
    switch (presence.what) {
    case PRESENT_STOPPED:
        return COMMISSION_STOPPED;
    case PRESENT_NONE:
        commission_prompt(run, "connect the next sensor, which gets address %u", address);
        return COMMISSION_LATER;
    case PRESENT_UNKNOWN:
        commission_prompt(run, "cannot ask at address 1: %s. Disconnect what else sends on this line",
                          presence.status == FATHOM_ERR_OTHER_MASTER ? "another master asks there"
                                                                     : "the line is never silent");
        return COMMISSION_LATER;
    case PRESENT_UNCLEAR:
        commission_prompt(run, "two sensors at address 1, or a loose wire: %s. Connect one sensor only",
                          presence.is_two ? "two responses to one request" : "a damaged response");
        return COMMISSION_LATER;
    default:
        return assign(run, &presence, address);
    }
}

static void work(commission_t *run)
{
    enum { PAUSE_US = 200000 };
    const host_t *const host = run->session.port.host;
    uint64_t since_us = host->now_us(host->ctx);
    for (uint8_t address; (address = next_address(run)) != 0;) {
        const commission_end_t end = try_next(run, address);
        if (end == COMMISSION_STOPPED || commission_has_ended(run)) return;
        const uint64_t now_us = host->now_us(host->ctx);
        if (end == COMMISSION_DONE) since_us = now_us;
        if (run->options.wait_us != 0 && now_us - since_us > run->options.wait_us) {
            (void)fprintf(stderr, "fathom: no sensor was commissioned for %" PRIu64 " s.\n",
                          run->options.wait_us / 1000000);
            return;
        }
        session_listen(&run->session, PAUSE_US);
    }
}

/* ---- the end ---- */

static int finish(commission_t *run)
{
    uint32_t done = 0;
    const bool is_all = !has_open(run);
    for (uint32_t i = 0; i != run->record.count; i++)
        if (is_open(run, &run->record.units[i])) commission_report(run, &run->record.units[i], NULL);
    for (uint32_t i = 0; i != run->options.count; i++) {
        const record_unit_t *const unit = record_at(&run->record, run->options.addresses[i]);
        if (unit != NULL && unit->state == RECORD_DONE) done++;
    }
    const bool is_good = is_all && done == run->options.count;
    (void)fprintf(commission_text(run), "%" PRIu32 " of %" PRIu32 " addresses are assigned and verified%s\n",
                  done, run->options.count, is_good ? "" : ". To continue, run the same command again");
    return fflush(stdout) == 0 && ferror(stdout) == 0 && is_good ? STATUS_OK : STATUS_FAILED;
}

/* Compares the record with the list of addresses. */
static bool is_suitable(commission_t *run)
{
    for (uint32_t i = 0; i != run->options.count; i++) {
        const uint8_t address = run->options.addresses[i];
        const record_unit_t *const unit = record_at(&run->record, address);
        if (unit == NULL || unit->model == run->model) continue;
        (void)reject(&origin, "address %u belongs to an %s in the record %s.", address, unit->model->name,
                     run->record.path);
        return false;
    }
    const record_unit_t *const first = record_at(&run->record, FACTORY_ADDRESS);
    if (first == NULL || next_address(run) == 0 || next_address(run) == FACTORY_ADDRESS) return true;
    (void)reject(&origin,
                 "a sensor keeps address %d in the record %s, where the next one would appear. Give it "
                 "another address, and remove its line.",
                 FACTORY_ADDRESS, run->record.path);
    return false;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    enum { LATE_US = 1000000 };
    static commission_t run;
    site_free(&run.session.site); /* of an earlier call */
    memset(&run, 0, sizeof run);
    if (!commission_options(&run.options, &run.session, arguments)) return STATUS_USAGE;
    run.model = run.session.sensor->model;
    if (!record_read(&run.record, run.options.record)) return STATUS_FAILED;
    if (!is_suitable(&run)) return STATUS_USAGE;
    if (!session_open(&run.session, host)) return STATUS_FAILED;
    int status = STATUS_FAILED;
    if (record_write(&run.record)) { /* proves that the record can be written before anything is sent */
        /* a response to the last request of an interrupted run could be mistaken for one of this run */
        session_listen(&run.session, LATE_US);
        if (are_present(&run) && resume_all(&run)) work(&run);
        status = finish(&run);
    }
    session_close(&run.session);
    return status;
}

const command_t commission_command = {
    .name = "commission",
    .summary = "Assign addresses to new sensors that all have address 1",
    .usage = "SENSOR[@PORT] --addresses LIST --record FILE [OPTIONS]",
    .about = "Connect the sensors one after the other. The command prints the address that\n"
             "the next one gets, finds it at address 1, sets it up and verifies it. An\n"
             "hps167s may then be taken off the line. Keep each a16 and a05 connected and\n"
             "switched on, since it has no serial number. After a failed write the command\n"
             "ends; run it again with the same FILE, and it continues.\n",
    .tables = commission_tables,
    .common = "port addresses record terminated wait",
    .examples = "  fathom commission hps167s -p /dev/ttyUSB0 --addresses 2-9 --record hall.txt\n"
                "  fathom commission a16 -p /dev/ttyUSB0 --addresses 2-8,1 --record tanks.txt\n"
                "  fathom sim hps167s hps167s --one-by-one --link ./bus     # to try it\n",
    .status = "Exit status: 0 all addresses are assigned and verified, 1 not, 2 wrong usage.\n",
    .topics = "commissioning, settings, sensors, ports",
    .operands = operands_one,
    .settings_size = sizeof(commission_settings_t),
    .start = start,
};
