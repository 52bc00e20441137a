/* SPDX-License-Identifier: MIT */
#include "scan/scan_report.h"

#include <inttypes.h>
#include <string.h>

#include "fathom/dyp.h"
#include "scan/scan_plan.h"
#include "shared/channel.h"

enum { TOLD_TEXT = 160, NEXT_TEXT = 1024 };

const char *duration_text(uint64_t us, char text[DURATION_TEXT])
{
    const uint64_t s = (us + 999999u) / 1000000u;
    if (s < 60)
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " s", s);
    else
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " min %" PRIu64 " s", s / 60, s % 60);
    return text;
}

static const char *model_name(const scan_finding_t *finding)
{
    static const char *const names[] = {
        [FATHOM_A16] = "a16", [FATHOM_A05] = "a05", [FATHOM_HPS167S] = "hps167s"};
    return names[finding->model];
}

static const char *mode_name(const scan_finding_t *finding)
{
    static const char *const names[] = {[SCAN_MODBUS] = "modbus", [SCAN_AUTO] = "auto", [SCAN_DYP] = "dyp"};
    return names[finding->mode];
}

/* Adds to a text of `capacity` bytes; what does not fit is left out. */
#define ADD(text, capacity, ...) (void)snprintf((text) + strlen(text), (capacity)-strlen(text), __VA_ARGS__)

/* ---- what to type next ---- */

/* As a word of a shell's command line. */
static void add_word(char *text, size_t capacity, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:@%+=,-";
    if (word[0] != '\0' && strspn(word, plain) == strlen(word)) {
        ADD(text, capacity, "%s", word);
        return;
    }
    ADD(text, capacity, "'");
    for (; *word != '\0'; word++)
        if (*word == '\'')
            ADD(text, capacity, "'\\''");
        else
            ADD(text, capacity, "%c", *word);
    ADD(text, capacity, "'");
}

/* 0 is one where a sensor was asked there. */
static bool has_address(const scan_finding_t *finding)
{
    return finding->address != 0 || (finding->kind == SCAN_SENSOR && finding->mode == SCAN_MODBUS);
}

/* "" where there is nothing to type. */
static void next_command(const scan_finding_t *finding, const char *port, char text[NEXT_TEXT])
{
    text[0] = '\0';
    if (finding->kind != SCAN_SENSOR) return;
    char options[LINE_OPTIONS];
    const bool is_hps167s = finding->model == FATHOM_HPS167S;
    const fathom_line_settings_t *const factory = is_hps167s ? &scan_hps167s_line : &scan_dyp_line;
    ADD(text, NEXT_TEXT, "fathom read %s", model_name(finding));
    if (!is_hps167s && finding->mode != SCAN_AUTO) ADD(text, NEXT_TEXT, " --mode %s", mode_name(finding));
    if (finding->mode != SCAN_AUTO) ADD(text, NEXT_TEXT, " --address %u", finding->address);
    ADD(text, NEXT_TEXT, "%s --port ", line_options(&finding->line, factory, options));
    add_word(text, NEXT_TEXT, port);
}

/* ---- text ---- */

/* What #1 and #3 tell of a part of the device. */
typedef struct {
    uint16_t year;
    uint8_t month;
    uint8_t day;
    char version[16];
} part_t;

static part_t part_of_interface(const fathom_hps167s_version_t *is)
{
    part_t part = {.year = is->year, .month = is->month, .day = is->day};
    (void)snprintf(part.version, sizeof part.version, "%u.%u.%u", is->major, is->minor, is->revision);
    return part;
}

static part_t part_of_sensor(const fathom_hps167s_details_t *is)
{
    part_t part = {.year = is->year, .month = is->month, .day = is->day};
    (void)snprintf(part.version, sizeof part.version, "%u.%u", is->major, is->minor);
    return part;
}

static void add_part(char text[TOLD_TEXT], const char *what, part_t part)
{
    ADD(text, TOLD_TEXT, "%s%s %s of %u-%02u-%02u", text[0] != '\0' ? ", " : "", what, part.version,
        part.year, part.month, part.day);
}

/* FFFD and FFFE are not in the datasheets; sister models say these. */
static void add_value(char text[TOLD_TEXT], const scan_finding_t *finding)
{
    const char *const probe = finding->model == FATHOM_A05 ? "probe 1: " : "";
    if (!finding->has_value) return;
    const uint16_t max_mm = finding->model == FATHOM_A05 ? FATHOM_A05_MAX_MM : FATHOM_A16_MAX_MM;
    if (finding->value == 0xFFFD)
        ADD(text, TOLD_TEXT, "%sno target", probe);
    else if (finding->value == 0xFFFE)
        ADD(text, TOLD_TEXT, "%sno target, interference", probe);
    else if (finding->value != 0 && finding->value <= max_mm)
        ADD(text, TOLD_TEXT, "%s%u mm", probe, finding->value);
    else
        ADD(text, TOLD_TEXT, "%sthe value %u, which is no distance", probe, finding->value);
}

static void tell_sensor(const scan_finding_t *finding, char text[TOLD_TEXT])
{
    if (finding->mode == SCAN_AUTO) {
        ADD(text, TOLD_TEXT, "sends by itself");
    } else if (finding->model != FATHOM_HPS167S) {
        add_value(text, finding);
    } else {
        if (finding->has_interface) add_part(text, "interface", part_of_interface(&finding->interface));
        if (finding->has_details) add_part(text, "sensor", part_of_sensor(&finding->details));
        if (finding->has_config)
            ADD(text, TOLD_TEXT, ", termination %s", finding->has_termination ? "on" : "off");
        if (text[0] == '\0') ADD(text, TOLD_TEXT, "sends answers unasked");
    }
    if (finding->is_double) ADD(text, TOLD_TEXT, ", answered twice");
}

static void tell_other(const scan_finding_t *finding, char text[TOLD_TEXT])
{
    switch (finding->kind) {
    case SCAN_OTHER:
        ADD(text, TOLD_TEXT, "another Modbus device: none of the three sensors");
        break;
    case SCAN_DAMAGED:
        ADD(text, TOLD_TEXT, "its answers are damaged: two sensors with one address?");
        break;
    case SCAN_NOT_MODBUS:
        ADD(text, TOLD_TEXT, "something answers, but not Modbus");
        break;
    case SCAN_MASTER:
        ADD(text, TOLD_TEXT, "another master asks this address");
        break;
    default:
        ADD(text, TOLD_TEXT, "something sends by itself, but no frames of these sensors");
        break;
    }
}

static void tell(const scan_finding_t *finding, char text[TOLD_TEXT])
{
    text[0] = '\0';
    if (finding->kind == SCAN_SENSOR)
        tell_sensor(finding, text);
    else
        tell_other(finding, text);
}

void scan_print_text(FILE *to, const scan_finding_t *finding, const char *port)
{
    char line[SETTINGS_TEXT];
    char address[16] = "-";
    char told[TOLD_TEXT];
    char next[NEXT_TEXT];
    if (has_address(finding)) (void)snprintf(address, sizeof address, "address %u", finding->address);
    tell(finding, told);
    next_command(finding, port, next);
    (void)fprintf(to, "%-8s %-12s %-11s  %s", finding->kind == SCAN_SENSOR ? model_name(finding) : "?",
                  address, settings_text(&finding->line, line), told);
    if (next[0] != '\0') (void)fprintf(to, "  ->  %s", next);
    (void)fputs("\n", to);
}

/* ---- JSON ---- */

static void print_string(FILE *to, const char *text)
{
    (void)fputs("\"", to);
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\')
            (void)fprintf(to, "\\%c", *text);
        else if ((unsigned char)*text < 0x20)
            (void)fprintf(to, "\\u%04x", (unsigned)(unsigned char)*text);
        else
            (void)fputc(*text, to);
    }
    (void)fputs("\"", to);
}

static void print_part(FILE *to, const char *name, part_t part)
{
    (void)fprintf(to, ",\"%s_version\":\"%s\",\"%s_date\":\"%u-%02u-%02u\"", name, part.version, name,
                  part.year, part.month, part.day);
}

static void print_sensor(FILE *to, const scan_finding_t *finding)
{
    (void)fprintf(to, ",\"mode\":\"%s\"", mode_name(finding));
    if (finding->has_value && finding->model != FATHOM_HPS167S)
        (void)fprintf(to, ",\"raw\":%u", finding->value);
    if (finding->has_interface) print_part(to, "interface", part_of_interface(&finding->interface));
    if (finding->has_details) {
        print_part(to, "sensor", part_of_sensor(&finding->details));
        (void)fputs(",\"uuid\":\"", to);
        for (size_t i = 0; i != sizeof finding->details.uuid; i++)
            (void)fprintf(to, "%02x", finding->details.uuid[i]);
        (void)fputs("\"", to);
    }
    if (finding->has_config)
        (void)fprintf(to, ",\"termination\":%s", finding->has_termination ? "true" : "false");
}

void scan_print_json(FILE *to, const scan_finding_t *finding, const char *port)
{
    static const char *const kinds[] = {
        [SCAN_SENSOR] = "sensor",         [SCAN_OTHER] = "other_modbus", [SCAN_DAMAGED] = "damaged",
        [SCAN_NOT_MODBUS] = "not_modbus", [SCAN_SENDER] = "sender",      [SCAN_MASTER] = "master"};
    char next[NEXT_TEXT];
    next_command(finding, port, next);
    (void)fprintf(to, "{\"kind\":\"%s\",\"model\":", kinds[finding->kind]);
    if (finding->kind == SCAN_SENSOR)
        print_string(to, model_name(finding));
    else
        (void)fputs("null", to);
    (void)fputs(",\"address\":", to);
    if (has_address(finding))
        (void)fprintf(to, "%u", finding->address);
    else
        (void)fputs("null", to);
    (void)fprintf(to, ",\"baud\":%" PRIu32 ",\"parity\":\"%s\",\"stop_bits\":%u", finding->line.baud,
                  parity_name(finding->line.parity), finding->line.stop_bits);
    if (finding->kind == SCAN_SENSOR) print_sensor(to, finding);
    if (finding->is_double) (void)fputs(",\"double\":true", to);
    (void)fputs(",\"next\":", to);
    if (next[0] != '\0')
        print_string(to, next);
    else
        (void)fputs("null", to);
    (void)fputs("}\n", to);
}

/* ---- advice ---- */

void scan_print_advice(FILE *to, const scan_finding_t *finding)
{
    char line[SETTINGS_TEXT];
    (void)settings_text(&finding->line, line);
    if (finding->kind == SCAN_DAMAGED)
        (void)fprintf(to,
                      "fathom: answers at address %u (%s) are damaged: two sensors with one address? Connect "
                      "one at a time; if it is alone, check --parity, the cable and its termination\n",
                      finding->address, line);
    else if (finding->kind == SCAN_NOT_MODBUS)
        (void)fprintf(
            to,
            "fathom: something answers at %s, but not Modbus: an HPS-167S made before 2020-09 speaks "
            "another protocol; another --baud or --parity, A and B swapped and noise look like this "
            "too\n",
            line);
    else if (finding->is_double)
        (void)fprintf(
            to,
            "fathom: two answers came from address %u: two sensors with one address? Connect one at "
            "a time\n",
            finding->address);
}
