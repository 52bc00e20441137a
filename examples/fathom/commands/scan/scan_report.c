/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>

#include "commands/scan/scan.h"
#include "commands/topics.h"
#include "ports/line_text.h"
#include "sensors/models.h"
#include "sensors/read_command.h"

enum { NEXT_TEXT = 1024 };

static const char *mode_name(const scan_finding_t *finding)
{
    static const char *const names[] = {[SCAN_MODBUS] = "modbus", [SCAN_AUTO] = "auto", [SCAN_DYP] = "dyp"};
    return names[finding->mode];
}

/* Address 0 is one only if a sensor responded there. */
static bool has_address(const scan_finding_t *finding)
{
    return finding->address != 0 || (finding->kind == SCAN_SENSOR && finding->mode == SCAN_MODBUS);
}

/* Writes the command to type next; "" if there is none. */
static void next_command(const scan_finding_t *finding, const char *port, char text[NEXT_TEXT])
{
    FILE *const to = finding->kind == SCAN_SENSOR ? fmemopen(text, NEXT_TEXT, "w") : NULL;
    text[0] = '\0';
    if (to == NULL) return;
    read_command_print(to, finding->model, mode_name(finding),
                       finding->mode == SCAN_AUTO ? -1 : finding->address, &finding->line, port);
    (void)fclose(to);
}

/* ---- a finding as a record ---- */

/* The fields below name the members by their offsets. */
typedef struct {
    /* cppcheck-suppress unusedStructMember */
    const char *kind, *model, *parity, *mode, *interface_version, *sensor_version, *uuid, *status, *next;
    /* cppcheck-suppress unusedStructMember */
    int64_t address, baud, stop_bits, termination, distance_mm, raw, is_double;
} row_t;

enum { SENSOR = 1, OPTICS = 2, VALUE = 4 };

#define FOUND(member) offsetof(row_t, member)
static const field_t fields[] = {
    {"kind", "", "What was found: sensor, other_modbus, damaged, ...", FIELD_WORD, 0, FOUND(kind)},
    {"model", "", "Model; null unless it is one of the known sensors", FIELD_WORD, 0, FOUND(model)},
    {"address", "", "Address; null if there is none", FIELD_NUMBER, 0, FOUND(address)},
    {"baud", "", "Baud rate", FIELD_NUMBER, 0, FOUND(baud)},
    {"parity", "", "Parity", FIELD_WORD, 0, FOUND(parity)},
    {"stop_bits", "", "Stop bits", FIELD_NUMBER, 0, FOUND(stop_bits)},
    {"mode", "", "Mode in which the sensor can be read", FIELD_WORD, SENSOR, FOUND(mode)},
    {"interface_version", "", "Version of the interface (hps167s)", FIELD_WORD, OPTICS,
     FOUND(interface_version)},
    {"sensor_version", "", "Version of the sensor (hps167s)", FIELD_WORD, OPTICS, FOUND(sensor_version)},
    {"uuid", "", "Unique number of the sensor (hps167s)", FIELD_WORD, OPTICS, FOUND(uuid)},
    {"termination", "", "Whether the termination resistor is on (hps167s)", FIELD_FLAG, OPTICS,
     FOUND(termination)},
    {"status", "", "Kind of the first value", FIELD_WORD, VALUE, FOUND(status)},
    {"distance_mm", "mm", "Distance of the first probe", FIELD_NUMBER, VALUE, FOUND(distance_mm)},
    {"raw", "", "Value that the sensor sent", FIELD_NUMBER, VALUE, FOUND(raw)},
    {"is_double", "", "Whether one request had two responses", FIELD_FLAG, 0, FOUND(is_double)},
    {"next", "", "Command to type next", FIELD_WORD, 0, FOUND(next)},
    {.key = NULL},
};
#undef FOUND

static const char *word_of(const char *text) { return text[0] != '\0' ? text : NULL; }

static finding_facts_t facts_of(const scan_finding_t *finding)
{
    finding_facts_t facts = {.termination = NO_VALUE, .distance_mm = NO_VALUE, .raw = NO_VALUE};
    const model_t *const model = finding->kind == SCAN_SENSOR ? finding->model : NULL;
    if (model != NULL) model->describe(model, finding, &facts);
    return facts;
}

static void print_json(FILE *to, const scan_finding_t *finding, const char *port)
{
    static const char *const kinds[] = {
        [SCAN_SENSOR] = "sensor",         [SCAN_OTHER] = "other_modbus", [SCAN_DAMAGED] = "damaged",
        [SCAN_NOT_MODBUS] = "not_modbus", [SCAN_SENDER] = "sender",      [SCAN_MASTER] = "master"};
    const finding_facts_t facts = facts_of(finding);
    const bool is_sensor = finding->kind == SCAN_SENSOR;
    const bool has_optics = is_sensor && finding->model->has_optics;
    char next[NEXT_TEXT];
    next_command(finding, port, next);
    const row_t row = {.kind = kinds[finding->kind],
                       .model = is_sensor ? finding->model->name : NULL,
                       .parity = parity_name(finding->line.parity),
                       .mode = is_sensor ? mode_name(finding) : NULL,
                       .interface_version = word_of(facts.interface_version),
                       .sensor_version = word_of(facts.sensor_version),
                       .uuid = word_of(facts.uuid),
                       .status = facts.status,
                       .next = word_of(next),
                       .address = has_address(finding) ? finding->address : NO_VALUE,
                       .baud = finding->line.baud,
                       .stop_bits = finding->line.stop_bits,
                       .termination = facts.termination,
                       .distance_mm = facts.distance_mm,
                       .raw = facts.raw,
                       .is_double = finding->is_double};
    record_json_line(to, fields, &row,
                     (is_sensor ? SENSOR : 0u) | (has_optics ? OPTICS : 0u) |
                         (facts.raw != NO_VALUE ? VALUE : 0u));
}

void scan_help_fields(FILE *to) { record_help(to, fields); }

/* ---- text ---- */

static void print_value(FILE *to, const model_t *model, const finding_facts_t *facts)
{
    if (model->probes > 1) (void)fputs("probe 1: ", to);
    if (facts->distance_mm != NO_VALUE)
        (void)fprintf(to, "%" PRId64 " mm", facts->distance_mm);
    else
        (void)fprintf(to, "%s (value %" PRId64 ")", facts->status, facts->raw);
}

static void print_versions(FILE *to, const finding_facts_t *facts)
{
    const char *comma = "";
    if (facts->interface_version[0] == '\0' && facts->sensor_version[0] == '\0')
        (void)fputs("sends unsolicited responses", to);
    if (facts->interface_version[0] != '\0') {
        (void)fprintf(to, "interface %s", facts->interface_version);
        comma = ", ";
    }
    if (facts->sensor_version[0] != '\0') (void)fprintf(to, "%ssensor %s", comma, facts->sensor_version);
    if (facts->termination != NO_VALUE)
        (void)fprintf(to, ", termination %s", facts->termination != 0 ? "on" : "off");
}

static void print_sensor(FILE *to, const scan_finding_t *finding)
{
    const model_t *const model = finding->model;
    const finding_facts_t facts = facts_of(finding);
    if (finding->mode == SCAN_AUTO)
        (void)fputs("sends without requests", to);
    else if (facts.raw != NO_VALUE)
        print_value(to, model, &facts);
    else if (model->has_optics)
        print_versions(to, &facts);
    if (finding->is_double) (void)fputs(", responds twice", to);
}

/* Prints a finding in a line, with the command to type next. port: as the user entered it. */
static void print_text(FILE *to, const scan_finding_t *finding, const char *port)
{
    static const char *const others[] = {[SCAN_OTHER] = "a Modbus device that is none of the known sensors",
                                         [SCAN_DAMAGED] = "damaged responses: two sensors with one address?",
                                         [SCAN_NOT_MODBUS] = "a response that is not Modbus",
                                         [SCAN_SENDER] =
                                             "sends without requests, but no frames of the known sensors",
                                         [SCAN_MASTER] = "another master sends requests to this address"};
    const bool is_sensor = finding->kind == SCAN_SENSOR;
    char line[LINE_TEXT];
    char address[16] = "-";
    char next[NEXT_TEXT];
    if (has_address(finding)) (void)snprintf(address, sizeof address, "address %u", finding->address);
    next_command(finding, port, next);
    (void)fprintf(to, "%-8s %-12s %-11s  ", is_sensor ? finding->model->name : "?", address,
                  line_text(&finding->line, line));
    if (is_sensor)
        print_sensor(to, finding);
    else
        (void)fprintf(to, "%s%s", others[finding->kind],
                      finding->is_double ? ", responds twice: two sensors with one address?" : "");
    if (next[0] != '\0') (void)fprintf(to, "  ->  %s", next);
    (void)fputs("\n", to);
}

/* ---- advice ---- */

/* Prints what to do about a finding; nothing for most. */
static void print_advice(FILE *to, const scan_finding_t *finding)
{
    char line[LINE_TEXT];
    (void)line_text(&finding->line, line);
    if (finding->kind == SCAN_DAMAGED)
        (void)fprintf(
            to,
            "fathom: responses from address %u (%s) are damaged: do two sensors have this address? Connect "
            "one at a time. If the sensor is alone, check --parity, the cable and its termination.\n",
            finding->address, line);
    else if (finding->kind == SCAN_NOT_MODBUS)
        (void)fprintf(
            to,
            "fathom: a device responds at %s, but not in Modbus. An HPS-167S made before 2020-09 has "
            "another protocol. Another --baud or --parity, swapped wires A and B and noise have the same "
            "effect.\n",
            line);
    else if (finding->is_double)
        (void)fprintf(
            to,
            "fathom: a request to address %u had two responses: do two sensors have this address? Connect "
            "one at a time.\n",
            finding->address);
}

/* ---- during the scan ---- */

void scan_report(scan_t *scan, const scan_finding_t *finding)
{
    progress_clear(&scan->progress);
    errno = 0;
    if (scan->settings->is_json)
        print_json(stdout, finding, scan->settings->port);
    else
        print_text(stdout, finding, scan->settings->port);
    scan->output_error = output_flush();
    print_advice(stderr, finding);
    if (finding->kind != SCAN_SENSOR) return;
    scan->sensors++;
    if (finding->has_config && finding->has_termination) {
        scan->terminations++;
        scan->terminated = finding->model;
    }
    if (scan->has_sender && finding->model == scan->sender.model && finding->mode != SCAN_AUTO)
        scan->awakened++;
}

uint64_t scan_now_us(const scan_t *scan) { return scan->port.host->now_us(scan->port.host->ctx); }

void scan_show_progress(scan_t *scan)
{
    const uint64_t now = scan_now_us(scan);
    char doing[LINE_TEXT + 16] = "listens";
    if (scan->line != NULL) {
        char settings[LINE_TEXT];
        (void)snprintf(doing, sizeof doing, "%s address %u", line_text(scan->line, settings), scan->address);
    }
    progress_show(&scan->progress, now,
                  scan->line != NULL ? scan->plan.listen_us + scan->done_us : now - scan->start_us, doing);
}
