/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_report.h"

#include <inttypes.h>
#include <string.h>

#include "ports/line_text.h"
#include "sensors/models.h"

enum { NEXT_TEXT = 1024 };

const char *duration_text(uint64_t us, char text[DURATION_TEXT])
{
    const uint64_t s = (us + 999999u) / 1000000u;
    if (s < 60)
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " s", s);
    else
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " min %" PRIu64 " s", s / 60, s % 60);
    return text;
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
    const model_t *const model = model_of(finding->model);
    const char *const mode = mode_name(finding);
    ADD(text, NEXT_TEXT, "fathom read %s", model->name);
    if (strcmp(mode, model->modes[0].name) != 0) ADD(text, NEXT_TEXT, " --mode %s", mode);
    if (finding->mode != SCAN_AUTO) ADD(text, NEXT_TEXT, " --address %u", finding->address);
    ADD(text, NEXT_TEXT, "%s --port ", line_options(&finding->line, &model->line, options));
    add_word(text, NEXT_TEXT, port);
}

/* ---- text ---- */

static void tell_sensor(FILE *to, const scan_finding_t *finding)
{
    const model_t *const model = model_of(finding->model);
    if (finding->mode == SCAN_AUTO)
        (void)fputs("sends by itself", to);
    else
        model->print_finding(to, model, finding);
    if (finding->is_double) (void)fputs(", answered twice", to);
}

static void tell_other(FILE *to, const scan_finding_t *finding)
{
    switch (finding->kind) {
    case SCAN_OTHER:
        (void)fputs(finding->is_double ? "answered twice: two sensors with one address?"
                                       : "another Modbus device: none of the three sensors",
                    to);
        break;
    case SCAN_DAMAGED:
        (void)fputs("its responses are damaged: two sensors with one address?", to);
        break;
    case SCAN_NOT_MODBUS:
        (void)fputs("something answers, but not Modbus", to);
        break;
    case SCAN_MASTER:
        (void)fputs("another master asks this address", to);
        break;
    default:
        (void)fputs("something sends by itself, but no frames of these sensors", to);
        break;
    }
}

static void tell(FILE *to, const scan_finding_t *finding)
{
    if (finding->kind == SCAN_SENSOR)
        tell_sensor(to, finding);
    else
        tell_other(to, finding);
}

void scan_print_text(FILE *to, const scan_finding_t *finding, const char *port)
{
    char line[LINE_TEXT];
    char address[16] = "-";
    char next[NEXT_TEXT];
    if (has_address(finding)) (void)snprintf(address, sizeof address, "address %u", finding->address);
    next_command(finding, port, next);
    (void)fprintf(to, "%-8s %-12s %-11s  ",
                  finding->kind == SCAN_SENSOR ? model_of(finding->model)->name : "?", address,
                  line_text(&finding->line, line));
    tell(to, finding);
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

void scan_print_json(FILE *to, const scan_finding_t *finding, const char *port)
{
    static const char *const kinds[] = {
        [SCAN_SENSOR] = "sensor",         [SCAN_OTHER] = "other_modbus", [SCAN_DAMAGED] = "damaged",
        [SCAN_NOT_MODBUS] = "not_modbus", [SCAN_SENDER] = "sender",      [SCAN_MASTER] = "master"};
    char next[NEXT_TEXT];
    next_command(finding, port, next);
    (void)fprintf(to, "{\"kind\":\"%s\",\"model\":", kinds[finding->kind]);
    if (finding->kind == SCAN_SENSOR)
        print_string(to, model_of(finding->model)->name);
    else
        (void)fputs("null", to);
    (void)fputs(",\"address\":", to);
    if (has_address(finding))
        (void)fprintf(to, "%u", finding->address);
    else
        (void)fputs("null", to);
    (void)fprintf(to, ",\"baud\":%" PRIu32 ",\"parity\":\"%s\",\"stop_bits\":%u", finding->line.baud,
                  parity_name(finding->line.parity), finding->line.stop_bits);
    if (finding->kind == SCAN_SENSOR) {
        (void)fprintf(to, ",\"mode\":\"%s\"", mode_name(finding));
        model_of(finding->model)->print_finding_json(to, finding);
    }
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
    char line[LINE_TEXT];
    (void)line_text(&finding->line, line);
    if (finding->kind == SCAN_DAMAGED)
        (void)fprintf(
            to,
            "fathom: responses at address %u (%s) are damaged: two sensors with one address? Connect "
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
            "fathom: two responses came from address %u: two sensors with one address? Connect one at "
            "a time\n",
            finding->address);
}
