/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "commands/commission/record.h"
#include "device/session.h"
#include "output/words.h"

/* fathom commission assigns addresses to new sensors that all have address 1, one after the other. */

enum {
    TRIES = 3,          /* attempts to read a setting, or to find out what responds at an address */
    MOST_UNWRITTEN = 3, /* times that a sensor may respond and then not be written, before the command ends */
    /* An HPS-167S does not measure in the first 5 s after power-on, or longer (#7). */
    MEASURED_WITHIN_US = 20000000,
    PAUSE_US = 200000,
    /* A response to the last request of an interrupted run could be mistaken for one of this run. */
    LATE_US = 1000000
};

static session_t session;
static struct {
    const host_t *host;
    record_t record;
    const model_t *model;
    FILE *text; /* for people: stdout, or stderr with JSON */
    bool has_numbers;
    uint8_t addresses[RECORD_UNITS]; /* to assign, in this order */
    size_t count;
    uint8_t terminated;       /* the address at which the termination stays on; 0: at none */
    unsigned unwritten_count; /* how often in a row a sensor responded and then could not be written */
    bool is_written;          /* something was written to the present sensor */
    char prompt[200];         /* the last instruction to the user, which is not repeated */
} run;

/* The result for one sensor. */
typedef enum {
    DONE,   /* it has its address. Its record is `done`, or the user has to switch it off and on */
    LATER,  /* nothing was written, and the user knows what to do */
    STOPPED /* the command ends; the reason was printed, or the user has ended it */
} end_t;

/* ---- options ---- */

typedef struct {
    session_settings_t session;
    const char *addresses;
    const char *record;
    const char *terminated; /* NULL: not given */
    uint64_t wait_us;
} commission_settings_t;

static const option_t rows[] = {
    {"addresses", "LIST", "Assign these addresses in this order, such as 2-9 or 5,7,10-12", KIND_TEXT,
     GROUP_COMMAND, AT(commission_settings_t, addresses), .is_required = true,
     .takes = "addresses and ranges, such as 2-9 or 5,7,10-12"},
    {"record", "FILE", "Store in FILE which sensor has which address; continue if it exists", KIND_TEXT,
     GROUP_COMMAND, AT(commission_settings_t, record), .is_required = true, .is_path = true,
     .takes = "the name of a file"},
    {"terminated", "N", "Leave the termination of an hps167s on at address N, or at none (default: the last)",
     KIND_TEXT, GROUP_COMMAND, AT(commission_settings_t, terminated)},
    {"wait", "S", "Stop if no sensor was commissioned for S seconds", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 86400, .scale = 1000000, AT(commission_settings_t, wait_us)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

static const origin_t origin = {.command = "commission"};

static bool is_listed(uint32_t address) { return memchr(run.addresses, (int)address, run.count) != NULL; }

/* "2-9" or "5,7,10-12,1". */
static bool set_addresses(const char *list)
{
    while (list != NULL) {
        char item[16];
        uint32_t address = 0;
        uint32_t last = 0;
        list = next_word(list, ',', item, sizeof item);
        if (!range_parse(item, 1, run.model->max_address, &address, &last))
            return reject(&origin,
                          "--addresses has '%s'. It takes addresses from 1 to %u and ranges with commas "
                          "between them, such as 2-9 or 5,7,10-12.",
                          item, run.model->max_address);
        for (; address <= last; address++) {
            if (is_listed(address))
                return reject(&origin, "--addresses has address %u twice.", (unsigned)address);
            run.addresses[run.count++] = (uint8_t)address;
        }
    }
    if (!is_listed(FACTORY_ADDRESS) || run.addresses[run.count - 1] == FACTORY_ADDRESS) return true;
    return reject(&origin,
                  "--addresses has address %d before its end. All new sensors have it, so only the last "
                  "one can keep it, such as --addresses 2-8,1.",
                  FACTORY_ADDRESS);
}

static bool set_terminated(const char *text)
{
    uint32_t address = run.addresses[run.count - 1];
    const bool has_termination = setting_of(run.model->settings, "termination") != NULL;
    if (text != NULL && !has_termination)
        return reject(&origin, "--terminated has no effect on %s, which has no such setting.",
                      run.model->name);
    if (!has_termination || (text != NULL && strcmp(text, "none") == 0)) return true;
    if (text != NULL && (!number_parse(text, 1, run.model->max_address, &address) || !is_listed(address)))
        return reject(&origin, "--terminated is '%s'. It takes one of --addresses, or none.", text);
    run.terminated = (uint8_t)address;
    return true;
}

static bool set_options(const arguments_t *arguments)
{
    const commission_settings_t *const settings = arguments->settings;
    if (!session_read(&session, arguments, 1, 0) ||
        !session_set_mode(&session, arguments, model_mode_of(session.sensor->model, NULL)))
        return false;
    if (session.sensor->address != FACTORY_ADDRESS)
        return reject(&origin, "new sensors have address %d. Leave address %u out.", FACTORY_ADDRESS,
                      session.sensor->address);
    if (port_kind(session.sensor->port->path) == PORT_GATEWAY)
        return reject(&origin,
                      "%s is no serial port. Behind a gateway, two sensors at one address look like one.",
                      session.sensor->port->path);
    run.model = session.sensor->model;
    run.has_numbers = record_has_numbers(run.model);
    run.text = session.is_json ? stderr : stdout;
    return set_addresses(settings->addresses) && set_terminated(settings->terminated);
}

/* ---- output and input ---- */

static uint64_t now_us(void) { return run.host->now_us(run.host->ctx); }

static bool has_ended(void) { return run.host->has_ended(run.host->ctx); }

static bool store(const record_unit_t *unit)
{
    return record_put(&run.record, unit, run.host->utc_us(run.host->ctx));
}

/* Prints an instruction to the user, unless it is the same as the last one. */
static void prompt(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void prompt(const char *format, ...)
{
    char text[sizeof run.prompt];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (strcmp(text, run.prompt) == 0) return;
    memcpy(run.prompt, text, sizeof text);
    (void)fprintf(run.text, "%s\n", text);
    (void)fflush(run.text);
}

static presence_t look(uint8_t address, unsigned times)
{
    return presence_ask(&session, address, &session.sensor->line, times);
}

static presence_t look_until_clear(uint8_t address)
{
    presence_t presence = {.what = PRESENT_UNCLEAR};
    for (unsigned i = 0; i != TRIES && (presence.what == PRESENT_UNCLEAR || presence.what == PRESENT_UNKNOWN);
         i++)
        presence = look(address, 2);
    return presence;
}

static bool is_of(const presence_t *presence, const record_unit_t *unit)
{
    return presence->what == PRESENT_ONE && strcmp(presence->number, unit->number) == 0;
}

/* Leaves `text` as it is if the setting cannot be read. */
static fathom_status_t read_setting(const setting_t *setting, char text[SETTING_TEXT])
{
    fathom_status_t status = setting->read_at != 0 ? FATHOM_PENDING : FATHOM_OK;
    for (unsigned i = 0; i != TRIES && status != FATHOM_OK && (i == 0 || !has_ended()); i++)
        status = session_get(&session, setting, text);
    return status;
}

/* ---- verifying one sensor ---- */

/* What a sensor responded at its own address. */
typedef struct {
    char termination[SETTING_TEXT]; /* "": the model has none */
    bool is_complete;               /* the termination reads as it was set */
    fathom_sample_t sample;
} proof_t;

static bool is_there(const record_unit_t *unit)
{
    const presence_t presence = look_until_clear(unit->address);
    if (presence.what == PRESENT_STOPPED || is_of(&presence, unit)) return presence.what == PRESENT_ONE;
    if (presence.what == PRESENT_NONE)
        return session_fail(
            &session, FATHOM_OK,
            "the sensor does not respond any more. Check its wires, and run the command again");
    if (presence.what == PRESENT_ONE)
        return session_fail(&session, FATHOM_OK,
                            "a sensor with another UUID responds. Find out which, and run the command again");
    (void)fprintf(stderr, "fathom: %s: ", session.sensor->name);
    presence_explain(&session, &presence);
    (void)fputs(presence.what == PRESENT_UNKNOWN
                    ? ". Then run the command again\n"
                    : ". If two sensors were at address 1, both may have this address now\n",
                stderr);
    return false;
}

static bool read_termination(uint8_t address, proof_t *proof)
{
    const setting_t *const setting = setting_of(run.model->settings, "termination");
    char wanted[SETTING_TEXT];
    proof->is_complete = true;
    if (setting == NULL) return true;
    const fathom_status_t status = read_setting(setting, proof->termination);
    if (status != FATHOM_OK) return session_fail(&session, status, "cannot read the termination");
    setting_print_value(setting, address == run.terminated, wanted);
    proof->is_complete = strcmp(proof->termination, wanted) == 0;
    return true;
}

/* Measures until a sample is no fault. Prefers a sample with a distance: an A05 may have fewer than four probes. */
static bool measures(fathom_sample_t *best)
{
    const uint64_t end_us = now_us() + MEASURED_WITHIN_US;
    fathom_status_t status = FATHOM_PENDING;
    bool has_sample = false;
    do {
        has_sample = false;
        do {
            fathom_sample_t sample;
            status = session_measure(&session, &sample);
            if (status == FATHOM_OK && (!has_sample || best->kind != FATHOM_TARGET)) {
                *best = sample;
                has_sample = true;
            }
        } while ((status == FATHOM_OK || status == FATHOM_ERR_MALFORMED) &&
                 reader_has_more(session.sensor->reader));
        if (has_sample && best->kind != FATHOM_FAULT) return true;
    } while (status != FATHOM_ERR_PORT && !has_ended() && now_us() < end_us);
    if (has_sample) status = FATHOM_OK;
    return session_fail(&session, status,
                        has_sample ? "the address is set, but the sensor reports a fault"
                                   : "the address is set, but the sensor does not measure");
}

/* At address 1, there may be the next sensor, but none with this UUID. */
static bool has_left(const record_unit_t *unit)
{
    if (unit->address == FACTORY_ADDRESS) return true;
    const presence_t presence = look(FACTORY_ADDRESS, 1);
    if (!run.has_numbers || !is_of(&presence, unit)) return presence.what != PRESENT_STOPPED;
    return session_fail(&session, FATHOM_OK,
                        "a sensor with the UUID of address %u responds at address 1 too. Disconnect one of "
                        "the two",
                        unit->address);
}

/* ---- results ---- */

/* proof NULL: it is not done. */
static void print_json(const record_unit_t *unit, const proof_t *proof)
{
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    json_string(&json, "model", run.model->name);
    json_value(&json, "address", "%u", unit->address);
    json_string(&json, "uuid", run.has_numbers ? unit->number : NULL);
    if (proof != NULL && proof->termination[0] != '\0')
        json_flag(&json, "termination", strcmp(proof->termination, "on") == 0);
    if (proof != NULL && proof->sample.kind == FATHOM_TARGET)
        json_value(&json, "distance_mm", "%u", proof->sample.distance_mm);
    json_string(&json, "status", unit->is_done ? "done" : "planned");
    json_string(&json, "utc", unit->when);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

static void print_done(const record_unit_t *unit, const proof_t *proof)
{
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
    if (proof->sample.kind == FATHOM_TARGET)
        (void)printf("%u mm\n", proof->sample.distance_mm);
    else
        (void)puts(proof->sample.kind == FATHOM_NO_TARGET ? "no_target" : "a value without a known meaning");
}

/* ---- writing to one sensor ---- */

static bool announce(const change_t *change)
{
    const char *const open = strchr(change->setting->what, '('); /* "Modbus address (#8)" */
    (void)fprintf(run.text, "  writes %s %s", change->setting->name, change->wanted);
    if (open != NULL) (void)fprintf(run.text, " %.*s", (int)strcspn(open, ")") + 1, open);
    (void)fputc('\n', run.text);
    return is_output_written();
}

static end_t end_unset(const change_t *change, change_outcome_t outcome, fathom_status_t status)
{
    change_explain(change, outcome, status);
    if (status == FATHOM_ERR_DIFFERS)
        (void)fputs("fathom: the new value may take effect at the next power-on. Switch the sensor off and "
                    "on, and run the command again.\n",
                    stderr);
    const bool is_over = outcome != CHANGE_NOT_WRITTEN || status == FATHOM_ERR_CANCELLED ||
                         status == FATHOM_ERR_PORT || ++run.unwritten_count == MOST_UNWRITTEN;
    return is_over ? STOPPED : LATER;
}

/* Writes a setting, unless the sensor has this value already. */
static end_t set(const char *name, int32_t value)
{
    change_t change = {.session = &session, .setting = setting_of(run.model->settings, name), .value = value};
    setting_print_value(change.setting, value, change.wanted);
    fathom_status_t status = read_setting(change.setting, change.was);
    if (status != FATHOM_OK) return end_unset(&change, CHANGE_NOT_WRITTEN, status);
    if (strcmp(change.was, change.wanted) == 0) return DONE;
    if (!announce(&change)) return STOPPED;
    status = session_set(&session, change.setting, value);
    if (reader_facts(session.sensor->reader).is_written) run.is_written = true;
    const change_outcome_t outcome = change_outcome(&change, status);
    if (outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE) return DONE;
    /* the termination was acknowledged; the datasheet does not state what #2 reads until the next power-on */
    if (status == FATHOM_ERR_DIFFERS && !change.setting->moves) return DONE;
    return end_unset(&change, outcome, status);
}

/* Sets up and verifies a sensor whose record is planned. */
static end_t set_up(const record_unit_t *unit, uint8_t at)
{
    end_t end = DONE;
    proof_t proof = {.termination = ""};
    if (setting_of(run.model->settings, "termination") != NULL)
        end = set("termination", unit->address == run.terminated);
    if (end == DONE && at != unit->address) end = set("address", unit->address);
    if (end != DONE) return end;
    if (!is_there(unit) || !read_termination(unit->address, &proof) || !measures(&proof.sample) ||
        !has_left(unit))
        return STOPPED;
    record_unit_t done = *unit;
    done.is_done = proof.is_complete;
    if (!store(&done)) return STOPPED;
    run.unwritten_count = 0;
    run.prompt[0] = '\0';
    if (session.is_json)
        print_json(&run.record.units[unit->address], &proof);
    else
        print_done(unit, &proof);
    return is_output_written() ? DONE : STOPPED;
}

/* No sensor may respond at the new address, and the sensor must still be the one that was found. */
static end_t check_places(const record_unit_t *unit, uint8_t at)
{
    if (at == unit->address) return DONE;
    /* Once is enough: the driver asks there again right before the write (modbus_setting.h). */
    const presence_t target = look(unit->address, 1);
    if (target.what == PRESENT_STOPPED) return STOPPED;
    if (target.what != PRESENT_NONE) {
        const bool is_unknown = target.what == PRESENT_UNKNOWN;
        prompt("nothing was written: %s address %u, which the sensor at address %u is to get. %s",
               is_unknown ? "cannot ask at" : "a sensor responds at", unit->address, at,
               is_unknown ? "Disconnect what else sends on this line" : "Disconnect one of the two");
        return LATER;
    }
    const presence_t here = look(at, 2);
    if (here.what == PRESENT_STOPPED) return STOPPED;
    return is_of(&here, unit) ? DONE : LATER;
}

/* Gives the only sensor at address `at` the address that is planned for it, and verifies it there. */
static end_t commission(record_unit_t unit, uint8_t at)
{
    record_unit_t *const line = &run.record.units[unit.address];
    const bool was_known = line->model != NULL;
    const end_t places = check_places(&unit, at);
    if (places != DONE) return places;
    (void)fprintf(run.text, "%s at address %u%s%s", run.model->name, at, run.has_numbers ? ", UUID " : "",
                  run.has_numbers ? unit.number : "");
    if (at == unit.address)
        (void)fputs(": verifying\n", run.text);
    else
        (void)fprintf(run.text, ": gets address %u\n", unit.address);
    unit.is_done = false;
    run.is_written = false;
    if (!store(&unit) || !is_output_written()) return STOPPED;
    const end_t end = set_up(&unit, at);
    if (end != LATER || was_known || run.is_written) return end;
    /* A sensor to which nothing was written is as good as a new one, and may be one. */
    line->model = NULL;
    return record_write(&run.record) ? LATER : STOPPED;
}

/* ---- resuming ---- */

static bool is_open(const record_unit_t *unit) { return unit->model == run.model && !unit->is_done; }

static bool has_open(void)
{
    for (size_t i = 0; i != RECORD_UNITS; i++)
        if (is_open(&run.record.units[i])) return true;
    return false;
}

/* Finishes a planned sensor, which is at its address or still at address 1. */
static end_t resume(const record_unit_t *unit)
{
    uint8_t at = unit->address;
    presence_t presence = look_until_clear(at);
    if (presence.what == PRESENT_NONE) presence = look(at = FACTORY_ADDRESS, 2);
    if (is_of(&presence, unit)) return commission(*unit, at);
    if (presence.what == PRESENT_STOPPED) return STOPPED;
    (void)fprintf(run.text, "address %u stays reserved: its sensor%s%s was not found\n", unit->address,
                  run.has_numbers ? " " : "", run.has_numbers ? unit->number : "");
    return LATER;
}

/* Sensors without a UUID have to stay connected. Otherwise a planned sensor that has already moved may be absent too, and
 * another one would get its address. */
static bool is_present(const record_unit_t *unit)
{
    const presence_t presence = look(unit->address, 2);
    if (presence.what == PRESENT_STOPPED) return false;
    if (presence.what != PRESENT_UNKNOWN && presence.what != PRESENT_NONE) return true;
    (void)fprintf(stderr, "fathom: nothing was written: address %u is done in the record, but ",
                  unit->address);
    if (presence.what == PRESENT_NONE)
        (void)fputs("no sensor responds there. Connect it and switch it on. If you took it away, remove its "
                    "line from the record and its address from --addresses",
                    stderr);
    else
        presence_explain(&session, &presence);
    (void)fputc('\n', stderr);
    return false;
}

static bool resume_all(void)
{
    const record_unit_t *const units = run.record.units;
    for (size_t i = 0; i != RECORD_UNITS && !run.has_numbers; i++)
        if (units[i].model == run.model && units[i].is_done && !is_present(&units[i])) return false;
    for (size_t i = 0; i != RECORD_UNITS; i++)
        if (is_open(&units[i]) && resume(&units[i]) == STOPPED) return false;
    return true;
}

/* ---- the next sensor ---- */

/* Returns the first address of the list that is not in the record, or 0. A sensor that keeps address 1 would be in the way
 * of all others, so it comes last. */
static uint8_t next_address(void)
{
    for (size_t i = 0; i != run.count; i++)
        if (run.record.units[run.addresses[i]].model == NULL &&
            (run.addresses[i] != FACTORY_ADDRESS || !has_open()))
            return run.addresses[i];
    return 0;
}

static end_t try_next(uint8_t address)
{
    const presence_t presence = look(FACTORY_ADDRESS, 1);
    if (presence.what == PRESENT_STOPPED) return STOPPED;
    if (presence.what == PRESENT_ONE) {
        record_unit_t unit = {.model = run.model, .address = address};
        const record_unit_t *const known = record_of(&run.record, run.model, presence.number);
        (void)snprintf(unit.number, sizeof unit.number, "%s", presence.number);
        if (known != NULL && known->is_done)
            prompt("the sensor at address 1 was at address %u and gets this address again", known->address);
        return commission(known != NULL ? *known : unit, FACTORY_ADDRESS);
    }
    if (presence.what == PRESENT_NONE)
        prompt("connect the next sensor, which gets address %u", address);
    else if (presence.what == PRESENT_UNKNOWN)
        prompt("cannot ask at address 1: %s. Disconnect what else sends on this line",
               presence.status == FATHOM_ERR_OTHER_MASTER ? "another master asks there"
                                                          : "the line is never silent");
    else
        prompt("two sensors at address 1, or a loose wire: %s. Connect one sensor only",
               presence.is_two ? "two responses to one request" : "a damaged response");
    return LATER;
}

/* wait_us: the longest time without a sensor; 0: no limit. */
static void work(uint64_t wait_us)
{
    uint64_t since_us = now_us();
    for (uint8_t address; (address = next_address()) != 0;) {
        const end_t end = try_next(address);
        if (end == STOPPED || has_ended()) return;
        if (end == DONE) since_us = now_us();
        if (wait_us != 0 && now_us() - since_us > wait_us) {
            (void)fprintf(stderr, "fathom: no sensor was commissioned for %" PRIu64 " s.\n",
                          wait_us / 1000000);
            return;
        }
        port_listen(&session.port, PAUSE_US);
    }
}

/* ---- the command ---- */

/* Prints what is done and what is not. Returns the exit status. */
static int finish(void)
{
    size_t done = 0;
    for (size_t i = 0; i != RECORD_UNITS; i++) {
        const record_unit_t *const unit = &run.record.units[i];
        if (is_open(unit) && session.is_json)
            print_json(unit, NULL);
        else if (is_open(unit))
            (void)printf("address %u is not done: the sensor%s%s is %s\n", unit->address,
                         run.has_numbers ? " with UUID " : "", run.has_numbers ? unit->number : "",
                         unit->address == FACTORY_ADDRESS
                             ? "not verified"
                             : "at this address, not verified, or still at address 1");
        else if (unit->model != NULL && is_listed(unit->address))
            done++;
    }
    const bool is_good = !has_open() && done == run.count;
    (void)fprintf(run.text, "%zu of %zu addresses are assigned and verified%s\n", done, run.count,
                  is_good ? "" : ". To continue, run the same command again");
    return is_output_written() && is_good ? STATUS_OK : STATUS_FAILED;
}

/* Compares the record with the list of addresses. */
static bool is_suitable(void)
{
    for (size_t i = 0; i != run.count; i++) {
        const record_unit_t *const unit = &run.record.units[run.addresses[i]];
        if (unit->model != NULL && unit->model != run.model)
            return reject(&origin, "address %u belongs to an %s in the record %s.", unit->address,
                          unit->model->name, run.record.path);
    }
    const uint8_t next = next_address();
    if (run.record.units[FACTORY_ADDRESS].model == NULL || next == 0) return true;
    return reject(&origin,
                  "a sensor keeps address %d in the record %s, where the next one would appear. Give it "
                  "another address, and remove its line.",
                  FACTORY_ADDRESS, run.record.path);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    const commission_settings_t *const settings = arguments->settings;
    memset(&run, 0, sizeof run);
    run.host = host;
    if (!set_options(arguments)) return STATUS_USAGE;
    if (!record_read(&run.record, settings->record)) return STATUS_FAILED;
    if (!is_suitable()) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    int status = STATUS_FAILED;
    if (record_write(&run.record)) { /* proves that the record can be written before anything is sent */
        port_listen(&session.port, LATE_US);
        if (resume_all()) work(settings->wait_us);
        status = finish();
    }
    session_close(&session);
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
    .tables = tables,
    .common = "port addresses record terminated wait",
    .examples = "  fathom commission hps167s -p /dev/ttyUSB0 --addresses 2-9 --record hall.txt\n"
                "  fathom commission a16 -p /dev/ttyUSB0 --addresses 2-8,1 --record tanks.txt\n"
                "  fathom sim hps167s hps167s --one-by-one --link ./bus     # to try it\n",
    .status = "Exit status: 0 all addresses are assigned and verified, 1 not, 2 wrong usage.\n",
    .topics = "commissioning, settings, sensors, ports",
    .operands = OPERANDS_ONE,
    .settings_size = sizeof(commission_settings_t),
    .start = start,
};
