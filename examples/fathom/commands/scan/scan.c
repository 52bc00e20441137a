/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "commands/commands.h"
#include "commands/scan/scan.h"
#include "diagnosis/advice.h"
#include "output/words.h"

/* ---- the options ---- */

enum { ITEM_TEXT = 16, FIRST_ADDRESS = 1, LAST_ADDRESS = 32 /* of an HPS-167S */, MAX_ADDRESS = 254 };

/* Adds a rate that is not there yet. A 0 ends them. */
static void add_rate(uint32_t *rates, uint32_t baud)
{
    while (*rates != 0 && *rates != baud) rates++;
    *rates = baud;
}

/* Adds the factory rates of the models, or all that can be set. */
static void add_rates_of_models(uint32_t *rates, bool has_all)
{
    for (size_t i = 0; i != model_count; i++) {
        add_rate(rates, models[i].line.baud);
        for (const uint32_t *rate = models[i].rates; has_all && rate != NULL && *rate != 0; rate++)
            add_rate(rates, *rate);
    }
}

static bool parse_rates(const char *text, void *member)
{
    uint32_t *const rates = member;
    const bool has_all = strcmp(text, "all") == 0;
    memset(rates, 0, (SCAN_RATES + 1) * sizeof *rates);
    if (has_all) add_rates_of_models(rates, true);
    while (!has_all && text != NULL) {
        char item[ITEM_TEXT];
        uint32_t baud = 0;
        text = next_word(text, ',', item, sizeof item);
        if (!word_find(PORT_BAUDS, item, &baud) || !number_parse(item, 1, UINT32_MAX, &baud)) return false;
        add_rate(rates, baud);
    }
    return true;
}

static bool parse_parities(const char *text, void *member)
{
    uint8_t *const parities = member;
    *parities = 0;
    if (strcmp(text, "all") == 0) text = "none,even,odd";
    while (text != NULL) {
        char item[ITEM_TEXT];
        uint32_t parity = 0;
        text = next_word(text, ',', item, sizeof item);
        if (!word_find(PORT_PARITIES, item, &parity)) return false;
        *parities |= (uint8_t)(1u << parity);
    }
    return true;
}

/* Address 0 is in no range, since most units obey it as a broadcast. */
static bool parse_addresses(const char *text, void *member)
{
    scan_addresses_t *const addresses = member;
    uint32_t first = 0;
    uint32_t last = 0;
    if (strcmp(text, "0") != 0 && !range_parse(text, 1, MAX_ADDRESS, &first, &last)) return false;
    *addresses = (scan_addresses_t){(uint8_t)first, (uint8_t)last};
    return true;
}

static const option_t rows[] = {
    {"port", "PATH", "Use the serial port PATH (default: $FATHOM_PORT)", KIND_TEXT, GROUP_LINE,
     AT(scan_settings_t, port), .is_once = true},
    {"address", "A-B", "Ask the addresses A to B of 1-254, or 0 (default 1-32)", KIND_CUSTOM, GROUP_COMMAND,
     .takes = "an address from 1 to 254, a range such as 1-32, or 0", .parse = parse_addresses,
     AT(scan_settings_t, addresses), HAS(scan_settings_t, has_addresses)},
    {"baud", "LIST", "Try these rates, or all (default 9600,19200)", KIND_CUSTOM, GROUP_LINE,
     .takes = "all, or some of 9600, 19200, 38400, 57600, 115200 and 230400 with commas between them",
     .words = "all " PORT_BAUDS, .parse = parse_rates, AT(scan_settings_t, rates)},
    {"parity", "LIST", "Try these parities, or all (default: factory setting)", KIND_CUSTOM, GROUP_LINE,
     .takes = "all, or some of none, even and odd with commas between them", .words = "all " PORT_PARITIES,
     .parse = parse_parities, AT(scan_settings_t, parities)},
    {"stop-bits", "N", "Set 1 or 2 stop bits; 2 implies no parity", KIND_NUMBER, GROUP_LINE, .min = 1,
     .max = 2, AT(scan_settings_t, stop_bits)},
    {"timeout", "MS", "Wait MS for a response (A16 or A05 150, else 100)", KIND_NUMBER, GROUP_COMMAND,
     .min = 1, .max = 10000, .scale = 1000, AT(scan_settings_t, timeout_us)},
    {"retries", "N", "Ask a silent address N more times (default 0)", KIND_NUMBER, GROUP_COMMAND, .max = 9,
     AT(scan_settings_t, retries)},
    {"listen", "S", "Listen for S seconds before the first request (8)", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 60, .scale = 1000000, AT(scan_settings_t, listen_us)},
    {"one", .help = "Stop at the first sensor that is found", .group = GROUP_COMMAND,
     AT(scan_settings_t, is_one)},
    {"wake", .help = "Send requests also if a sensor sends automatically", .group = GROUP_COMMAND,
     AT(scan_settings_t, wake)},
    {"estimate", .help = "Print how long the scan would take, and stop", .group = GROUP_COMMAND,
     AT(scan_settings_t, estimate)},
    {"format", "FORMAT", "Print text or json, one object a line (default text)", KIND_CHOICE, GROUP_OUTPUT,
     .words = "text json", AT(scan_settings_t, is_json)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {NULL, 0}};

/* ---- the plan ---- */

/* The datasheets print no period of the frames. An A16 takes 7.5 s to settle (A16 2(2)). */
enum { DEFAULT_LISTEN_US = 8000000 };

/* Returns none at 9600 baud and even above, which an HPS-167S keeps at all its rates (HPS-167S 2.2.2). */
static uint8_t factory_parity(uint32_t baud)
{
    size_t i = 0;
    while (i != model_count - 1 && !model_has_rate(&models[i], baud)) i++;
    return models[i].line.parity;
}

/* Returns the parity of the relatives of a model at this rate as a bit. */
static unsigned factory_parities(const model_t *model, uint32_t baud, uint8_t stop_bits)
{
    const fathom_line_settings_t *const line = &model->relatives_line;
    return baud == line->baud && stop_bits == line->stop_bits ? 1u << line->parity : 0;
}

/* Fills in the defaults, and the line settings. The parity of the factory comes first: at an address where a device
 * responds, the others of this rate are left out. */
static void make_plan(scan_settings_t *plan)
{
    plan->is_default =
        !plan->has_addresses && plan->rates[0] == 0 && plan->parities == 0 && plan->stop_bits == 0;
    if (plan->parities == 0 && plan->stop_bits == 2)
        plan->parities = 1u << FATHOM_PARITY_NONE; /* HPS-167S 2.2.2 */
    if (plan->stop_bits == 0) plan->stop_bits = 1;
    if (plan->listen_us == 0) plan->listen_us = DEFAULT_LISTEN_US;
    if (!plan->has_addresses) plan->addresses = (scan_addresses_t){FIRST_ADDRESS, LAST_ADDRESS};
    if (plan->rates[0] == 0) add_rates_of_models(plan->rates, false);
    for (const uint32_t *baud = plan->rates; *baud != 0; baud++) {
        const uint8_t factory = factory_parity(*baud);
        unsigned parities = plan->parities;
        for (size_t i = 0; plan->parities == 0 && i != model_count; i++)
            parities |= 1u << factory | factory_parities(&models[i], *baud, plan->stop_bits);
        const uint8_t order[] = {factory, FATHOM_PARITY_NONE, FATHOM_PARITY_EVEN, FATHOM_PARITY_ODD};
        for (size_t i = 0; i != sizeof order; i++)
            if ((parities >> order[i] & 1) != 0 && (i == 0 || order[i] != factory))
                plan->lines[plan->line_count++] = (fathom_line_settings_t){*baud, order[i], plan->stop_bits};
    }
}

/* Returns true if the far end of the port has the line settings, which the scan cannot change. */
static bool is_converters(const char *port) { return port != NULL && !port_has_settings(port_kind(port)); }

/* Prints "addresses 1 to 32 at 9600 8N1, 19200 8E1". */
static void print_plan(FILE *to, const scan_settings_t *plan)
{
    char line[LINE_TEXT];
    if (plan->addresses.first == plan->addresses.last)
        (void)fprintf(to, "address %u at", plan->addresses.first);
    else
        (void)fprintf(to, "addresses %u to %u at", plan->addresses.first, plan->addresses.last);
    if (is_converters(plan->port)) (void)fputs(" the line settings of the converter", to);
    for (uint8_t i = 0; !is_converters(plan->port) && i != plan->line_count; i++)
        (void)fprintf(to, "%s %s", i != 0 ? "," : "", line_text(&plan->lines[i], line));
}

static int print_estimate(const scan_settings_t *plan)
{
    const uint64_t all_us = scan_plan_us(plan);
    if (plan->is_json) {
        (void)printf("{\"settings\":%u,\"addresses\":%u,\"duration_s\":%" PRIu64 "}\n", plan->line_count,
                     plan->addresses.last - plan->addresses.first + 1u, (all_us + 999999u) / 1000000u);
    } else {
        char duration[DURATION_TEXT];
        print_plan(stdout, plan);
        (void)printf(": about %s, and a second for each sensor\n", duration_text(all_us, duration));
    }
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

/* ---- a finding ---- */

static const char *const modes[] = {[SCAN_MODBUS] = "modbus", [SCAN_AUTO] = "auto", [SCAN_DYP] = "dyp"};

static const struct {
    const char *name;
    const char *text;
    const char *advice; /* NULL: there is nothing to do */
    const char *why;    /* nothing was sent, because of this sender */
} kinds[] = {
    [SCAN_SENSOR] = {"sensor", NULL, NULL, NULL},
    [SCAN_OTHER] = {"other_modbus", "a Modbus device that is none of the known sensors", NULL, NULL},
    [SCAN_DAMAGED] =
        {"damaged", "damaged responses: two sensors with one address?",
         "the responses are damaged: do two sensors have this address? Connect one at a time. If the "
         "sensor is alone, check --parity, the cable and its termination.",
         NULL},
    [SCAN_NOT_MODBUS] =
        {"not_modbus", "a response that is not Modbus",
         "a device responds, but not in Modbus. An HPS-167S made before 2020-09 has another protocol. "
         "Another --baud or --parity, swapped wires A and B and noise have the same effect.",
         NULL},
    [SCAN_SENDER] =
        {"sender", "sends without requests, but no frames of the known sensors", NULL,
         "a device sends without a request. An HPS-167S made before 2020-09 has another protocol. "
         "Another rate, swapped wires A and B and noise have the same effect"},
    [SCAN_ALIKE] = {"hps167", "speaks like an HPS-167", NULL, "a device sends without a request"},
    [SCAN_MASTER] =
        {"master", "another master sends requests to this address", NULL,
         "another master sends requests on this line. Disconnect it or stop its program, and scan again"},
};

/* Address 0 is one only if a sensor responded there. */
static bool has_address(const scan_finding_t *finding)
{
    return finding->address != 0 || (finding->kind == SCAN_SENSOR && finding->mode == SCAN_MODBUS);
}

static void print_next(FILE *to, const scan_finding_t *finding, const char *port)
{
    read_command_print(to, finding->model, modes[finding->mode],
                       finding->mode == SCAN_AUTO ? -1 : finding->address,
                       is_converters(port) ? &finding->model->line : &finding->line, port);
}

static const char *settings_text(const scan_finding_t *finding, const char *port, char text[LINE_TEXT])
{
    return is_converters(port) ? "-" : line_text(&finding->line, text);
}

/* The fields below name the members by their offsets. */
typedef struct {
    /* cppcheck-suppress unusedStructMember */
    const char *kind, *model, *parity, *mode, *interface_version, *sensor_version, *uuid, *status, *perhaps;
    char *next;
    /* cppcheck-suppress unusedStructMember */
    int64_t address, baud, stop_bits, termination, distance_mm, raw, is_certain, is_double;
} row_t;

enum { SENSOR = 1, OPTICS = 2, VALUE = 4, UNCONFIRMED = 8 };

#define FOUND(member) offsetof(row_t, member)
static const field_t fields[] = {
    {"kind", "", "What was found: sensor, other_modbus, damaged, ...", FIELD_WORD, 0, FOUND(kind)},
    {"model", "", "Model; null unless it is one of the known sensors", FIELD_WORD, 0, FOUND(model)},
    {"address", "", "Address; null if there is none", FIELD_NUMBER, 0, FOUND(address)},
    {"baud", "", "Baud rate; null behind a converter", FIELD_NUMBER, 0, FOUND(baud)},
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
    {"is_certain", "", "Whether only an a16, a05 or relative responds like this", FIELD_FLAG, VALUE,
     FOUND(is_certain)},
    {"perhaps", "", "What an unconfirmed device could be, and how sure that is", FIELD_WORD, UNCONFIRMED,
     FOUND(perhaps)},
    {"is_double", "", "Whether one request had two responses", FIELD_FLAG, 0, FOUND(is_double)},
    {"next", "", "Command to type next", FIELD_WORD, 0, FOUND(next)},
    {.key = NULL},
};
#undef FOUND

void scan_help_fields(FILE *to) { record_help(to, fields); }

static bool is_terminated(const scan_finding_t *finding) { return strcmp(finding->termination, "on") == 0; }

static const char *word_of(const char *text) { return text[0] != '\0' ? text : NULL; }

static void print_json(const scan_finding_t *finding, const char *port)
{
    const bool is_sensor = finding->kind == SCAN_SENSOR;
    row_t row = {.kind = kinds[finding->kind].name,
                 .model = is_sensor ? finding->model->name : NULL,
                 .parity = is_converters(port) ? NULL : parity_name(finding->line.parity),
                 .mode = is_sensor ? modes[finding->mode] : NULL,
                 .address = has_address(finding) ? finding->address : NO_VALUE,
                 .baud = is_converters(port) ? NO_VALUE : finding->line.baud,
                 .stop_bits = is_converters(port) ? NO_VALUE : finding->line.stop_bits,
                 .interface_version = word_of(finding->interface_version),
                 .sensor_version = word_of(finding->sensor_version),
                 .uuid = word_of(finding->uuid),
                 .termination = finding->termination[0] != '\0' ? is_terminated(finding) : NO_VALUE,
                 .perhaps = finding->perhaps,
                 .is_certain = finding->is_certain,
                 .raw = finding->has_value ? finding->value : NO_VALUE,
                 .is_double = finding->is_double};
    size_t size = 0;
    FILE *const next = is_sensor ? open_memstream(&row.next, &size) : NULL;
    if (next != NULL) {
        print_next(next, finding, port);
        (void)fclose(next);
    }
    if (finding->has_value) row.status = model_value_status(finding->model, finding->value, &row.distance_mm);
    record_json_line(stdout, fields, &row,
                     (is_sensor ? SENSOR : 0u) | (is_sensor && finding->model->has_optics ? OPTICS : 0u) |
                         (finding->has_value ? VALUE : 0u) |
                         (finding->kind == SCAN_OTHER || finding->kind == SCAN_ALIKE ? UNCONFIRMED : 0u));
    free(row.next);
}

static void print_sensor(const scan_finding_t *finding)
{
    const bool has_interface = finding->interface_version[0] != '\0';
    const bool has_version = finding->sensor_version[0] != '\0';
    int64_t distance_mm = 0;
    if (finding->mode == SCAN_AUTO) {
        (void)printf("sends without requests: %s", finding->model->scan.family);
    } else if (finding->has_value) {
        const char *const status = model_value_status(finding->model, finding->value, &distance_mm);
        if (finding->model->probes > 1) (void)printf("probe 1: ");
        if (distance_mm != NO_VALUE)
            (void)printf("%" PRId64 " mm", distance_mm);
        else
            (void)printf("%s (value %u)", status, finding->value);
        (void)printf(", %s%s%s", finding->is_certain ? "" : "probably ", finding->model->scan.family,
                     finding->mode == SCAN_MODBUS ? " with Modbus" : "");
    } else if (finding->model->has_optics) {
        if (!has_interface && !has_version) (void)printf("sends unsolicited responses");
        if (has_interface) (void)printf("interface %s", finding->interface_version);
        if (has_version) (void)printf("%ssensor %s", has_interface ? ", " : "", finding->sensor_version);
        if (finding->termination[0] != '\0') (void)printf(", termination %s", finding->termination);
    }
}

/* Prints a finding in a line, with the command to type next. */
static void print_text(const scan_finding_t *finding, const char *port)
{
    const bool is_sensor = finding->kind == SCAN_SENSOR;
    char line[LINE_TEXT];
    char address[16] = "-";
    if (has_address(finding)) (void)snprintf(address, sizeof address, "address %u", finding->address);
    (void)printf("%-8s %-12s %-11s  ", is_sensor ? finding->model->name : "?", address,
                 settings_text(finding, port, line));
    if (is_sensor)
        print_sensor(finding);
    else
        (void)printf("%s%s%s", kinds[finding->kind].text, finding->perhaps != NULL ? "; " : "",
                     finding->perhaps != NULL ? finding->perhaps : "");
    if (finding->is_double)
        (void)printf(", responds twice%s", is_sensor ? "" : ": two sensors with one address?");
    if (is_sensor) {
        (void)printf("  ->  ");
        print_next(stdout, finding, port);
    }
    (void)printf("\n");
}

/* Prints what to do about a finding; nothing for most. */
static void print_advice(const scan_finding_t *finding, const char *port)
{
    const char *const advice =
        finding->is_double
            ? "a request had two responses: do two sensors have this address? Connect one at a time."
            : kinds[finding->kind].advice;
    char address[32] = "";
    char line[LINE_TEXT];
    if (advice == NULL) return;
    if (finding->address != 0) (void)snprintf(address, sizeof address, "address %u at ", finding->address);
    (void)fprintf(stderr, "fathom: %s%s: %s\n", address, settings_text(finding, port, line), advice);
}

static void report(scan_t *scan, const scan_finding_t *finding)
{
    progress_clear(&scan->progress);
    errno = 0;
    (scan->settings->is_json ? print_json : print_text)(finding, scan->settings->port);
    scan->output_error = output_flush();
    if (scan->output_error != 0) scan->status = FATHOM_ERR_CANCELLED;
    print_advice(finding, scan->settings->port);
    if (finding->kind == SCAN_DAMAGED || finding->kind == SCAN_OTHER) scan->has_responses = true;
    if (finding->kind != SCAN_SENSOR) return;
    scan->sensors++;
    if (is_terminated(finding)) {
        scan->terminations++;
        scan->terminated = finding->model;
    }
    if (finding->model == scan->sender.model && finding->mode != SCAN_AUTO) scan->awakened++;
}

/* ---- the result ---- */

static failure_t failure_of(const scan_t *scan, fathom_status_t status)
{
    failure_t failure = failure_of_request(status, &scan->port);
    failure.evidence = scan->heard;
    failure.is_scan = true;
    return failure;
}

static void print_why_nothing_was_sent(const scan_finding_t *sender)
{
    (void)fputs("fathom: nothing was sent, because ", stderr);
    if (sender->kind == SCAN_SENSOR && sender->mode == SCAN_AUTO)
        (void)fprintf(stderr, "even a read ends %s", sender->model->request_ends);
    else if (sender->kind == SCAN_MASTER || sender->address == 0)
        (void)fputs(kinds[sender->kind].why, stderr);
    else
        (void)fputs("requests would collide with its unsolicited frames", stderr);
    (void)fputs(". To send requests anyway, use --wake.\n", stderr);
}

static void print_nothing(const scan_t *scan)
{
    failure_t failure = failure_of(scan, FATHOM_ERR_NO_RESPONSE);
    failure.evidence.masters = 0; /* print_others() has printed them */
    (void)fputs("fathom: ", stderr);
    if (scan->not_asked != 0 || scan->has_responses)
        (void)fputs("no sensor was found", stderr);
    else
        advice_print(stderr, &failure);
    if (is_converters(scan->settings->port))
        (void)fputs(
            ". The scan cannot change the settings of the converter: with factory settings, a16 and a05 "
            "need 9600 8N1, and hps167s 19200 8E1",
            stderr);
    else if (scan->settings->is_default)
        (void)fprintf(stderr,
                      ". To find a sensor with other settings, run 'fathom scan --port %s --address 1-254 "
                      "--baud all --parity all' (about 8 minutes)",
                      scan->settings->port);
    (void)fputs(". A sensor that was just switched on may need 5 s\n", stderr);
}

/* Prints why the scan sent addresses no request, or which device disturbs the line. */
static void print_cause(const scan_t *scan, fathom_status_t status)
{
    const failure_t failure = failure_of(scan, status);
    advice_print_cause(stderr, &failure);
    (void)fputs(". Then scan again\n", stderr);
}

static void print_others(const scan_t *scan)
{
    if (scan->heard.masters != 0) {
        (void)fputs("fathom: ", stderr);
        print_cause(scan, FATHOM_ERR_LINE_BUSY);
    }
    if (scan->not_asked != 0) {
        (void)fprintf(stderr, "fathom: %" PRIu32 " addresses were sent no request: ", scan->not_asked);
        print_cause(scan, scan->has_other_master ? FATHOM_ERR_OTHER_MASTER : FATHOM_ERR_LINE_BUSY);
    }
    if (scan->outside != 0)
        (void)fprintf(
            stderr,
            "fathom: a frame from address %u was received, which is not in the scan. Use --address %u.\n",
            scan->outside, scan->outside);
}

/* Prints the result of a scan that went to its end, and what to check. */
static void print_result(const scan_t *scan)
{
    const scan_finding_t *const sender = &scan->sender;
    char duration[DURATION_TEXT];
    char line[LINE_TEXT];
    if (sender->kind != 0 && !scan->settings->wake) {
        print_why_nothing_was_sent(sender);
        return;
    }
    if (scan->awakened != 0 && sender->mode == SCAN_AUTO) {
        (void)fprintf(stderr, "fathom: the sensor sent automatically until the first request. It sends again "
                              "after a power cycle");
        if (sender->model->automatic_again != NULL)
            (void)fprintf(stderr, ", or after 'fathom set %s:ADDRESS --port %s %s'", sender->model->name,
                          scan->settings->port, sender->model->automatic_again);
        (void)fputs(".\n", stderr);
    }
    print_others(scan);
    if (scan->left_out_count == scan->settings->line_count) {
        (void)fputs("fathom: no request was sent, because the port has none of these settings. A scan with "
                    "other settings "
                    "or with another adapter can find a sensor.\n",
                    stderr);
        return;
    }
    if (scan->terminations > 1)
        (void)fprintf(
            stderr,
            "fathom: %" PRIu32 " sensors have their termination resistor on, the factory setting, which "
            "overloads the line. Switch it off in all but the last sensor with 'fathom set %s:ADDRESS "
            "--port %s termination off'.\n",
            scan->terminations, scan->terminated->name, scan->settings->port);
    if (scan->sensors == 0) print_nothing(scan);
    (void)fprintf(stderr, "fathom: sensors found: %" PRIu32 ", after %s", scan->sensors,
                  duration_text(scan_now_us(scan) - scan->progress.start_us, duration));
    if (scan->sensors != 0 && scan->settings->is_one)
        (void)fputs(". --one ended the scan, and other sensors may be on the line", stderr);
    for (uint8_t i = 0, listed = 0; i != scan->settings->line_count; i++)
        if (scan->left_out[i])
            (void)fprintf(stderr, "%s%s",
                          listed++ == 0 ? ". Left out, since the port does not have them: " : ", ",
                          line_text(&scan->settings->lines[i], line));
    (void)fputs("\n", stderr);
}

/* ---- the command ---- */

static int finish(scan_t *scan)
{
    const host_t *const host = scan->port.host;
    progress_clear(&scan->progress);
    if (scan->output_error == EINTR && host->has_ended(host->ctx)) scan->output_error = 0;
    /* The reader of a pipe has read enough, as head does. That needs no message. */
    if (scan->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (scan->status == FATHOM_OK && scan->sender.kind != 0 && scan->awakened == 0)
        report(scan, &scan->sender);
    if (scan->output_error != 0) {
        (void)fprintf(stderr, "fathom: cannot write the output: %s\n", strerror(scan->output_error));
        return STATUS_FAILED;
    }
    if (scan->status == FATHOM_ERR_PORT) {
        const failure_t failure = failure_of(scan, FATHOM_ERR_PORT);
        (void)fputs("fathom: ", stderr);
        advice_print(stderr, &failure);
        (void)fputs("\n", stderr);
        return STATUS_FAILED;
    }
    if (scan->status == FATHOM_OK)
        print_result(scan);
    else
        (void)fprintf(stderr, "fathom: the scan ended before its last address. Sensors found: %" PRIu32 ".\n",
                      scan->sensors);
    return scan->sensors != 0 ? STATUS_OK : STATUS_FAILED;
}

static int run(scan_t *scan, const host_t *host)
{
    const scan_settings_t *const settings = scan->settings;
    const port_options_t port = {.path = settings->port,
                                 .line = model_with(DECODE_STREAM_ONE | DECODE_STREAM_FOUR)->line};
    char duration[DURATION_TEXT];
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    if (!port_open_now(&scan->port, host, &port)) {
        (void)fprintf(stderr, "fathom: %s\n", scan->port.error_text);
        return STATUS_FAILED;
    }
    advice_print_opening(&scan->port);
    for (uint8_t i = 0; i != settings->line_count;
         i++) { /* a slower unit has to recognise the silence, too */
        const uint16_t silence_us = fathom_silence_us(&settings->lines[i]);
        if (i == 0 || silence_us > scan->port.parts.silence_us) scan->port.parts.silence_us = silence_us;
    }
    (void)fprintf(stderr, "fathom: listens for %s, and then sends requests to ",
                  duration_text(settings->listen_us, duration));
    print_plan(stderr, settings);
    (void)fprintf(stderr, ": about %s in all, and a second for each sensor\n",
                  duration_text(scan_plan_us(settings), duration));
    progress_init(&scan->progress, stderr, scan_now_us(scan), scan_plan_us(settings));
    scan_listen(scan);
    if (scan->sender.kind == 0 || settings->wake) scan_walk(scan);
    const int status = finish(scan);
    port_close(&scan->port);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const origin_t origin = {.command = "scan"};
    static scan_t scan;
    scan_settings_t *const settings = arguments->settings;
    const bool has_settings = settings->rates[0] != 0 || settings->parities != 0 || settings->stop_bits != 0;
    /* At the rate of an HPS-167S, the first read identifies each model that responds to it. */
    if (is_converters(settings->port) && !has_settings) (void)parse_rates("19200,9600", settings->rates);
    make_plan(settings);
    scan = (scan_t){.report = report, .settings = settings, .port.watches_output = true};
    if (arguments->count != 0 && settings->port == NULL)
        (void)reject(&origin, "scan accepts options only. Use --port %s.", arguments->words[0]);
    else if (arguments->count != 0)
        (void)reject(&origin, "scan accepts options only, not '%s'.", arguments->words[0]);
    else if (settings->port == NULL && !settings->estimate)
        (void)reject(&origin,
                     "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
    else if (settings->port != NULL && !port_has_bytes(port_kind(settings->port)))
        (void)reject(&origin,
                     "scan needs a serial port, or a converter that passes raw bytes (rtu-tcp:), not '%s'.",
                     settings->port);
    else if (is_converters(settings->port) && has_settings)
        (void)reject(
            &origin,
            "%s has no line settings: the converter has them. Leave --baud, --parity and --stop-bits out.",
            settings->port);
    else
        return settings->estimate ? print_estimate(settings) : run(&scan, host);
    return STATUS_USAGE;
}

const command_t scan_command = {
    .name = "scan",
    .summary = "Find the sensors on a serial line",
    .usage = "--port PATH [OPTIONS]",
    .tables = tables,
    .common = "port address baud wake format",
    .own_group = "Scan",
    .about = "It only reads: no request can change a setting. But even a read ends the automatic output of "
             "an A16 or A05, so the scan listens first, and sends nothing if a sensor sends. At the rates of "
             "A16 and A05 it first reads the address at address 255, to which a unit that is alone responds "
             "from its own, and after the walk it reads 0x0100 at silent addresses, where other devices "
             "respond. At "
             "an address where a device responds, other parities of the same rate are not tried.\n",
    .examples = "  fathom scan --port /dev/ttyUSB0\n"
                "  fathom scan --port /dev/ttyUSB0 --one\n"
                "  fathom scan --port /dev/ttyUSB0 --address 1-254 --baud all --parity all\n"
                "  fathom scan --port /dev/ttyUSB0 --baud 57600,115200 --format json\n",
    .status = "Exit status: 0 a sensor was found, 1 none was or the port failed, 2 wrong usage.\n",
    .topics = "trouble, ports, output",
    .settings_size = sizeof(scan_settings_t),
    .start = start,
};
