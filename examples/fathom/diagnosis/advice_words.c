/* SPDX-License-Identifier: MIT */
#include "diagnosis/advice_words.h"

#include <inttypes.h>
#include <string.h>

#include "ports/port_options.h"
#include "sensors/models.h"

/* ---- words that are more than a number or a text ---- */

static void print_sensor(FILE *to, const failure_t *failure)
{
    if (failure->is_request)
        (void)fprintf(to, "unit %u", failure->address);
    else if (failure->mode->has_address)
        (void)fprintf(to, "%s:%u", failure->model->name, failure->address);
    else
        (void)fputs(failure->model->name, to);
}

static void print_place(FILE *to, const failure_t *failure)
{
    (void)fprintf(to, " at %s", failure->port->name);
    if (failure->line != NULL && failure->port->kind == PORT_SERIAL) {
        char text[LINE_TEXT];
        (void)fprintf(to, " (%s)", line_text(failure->line, text));
    }
}

static void print_line(FILE *to, const failure_t *failure)
{
    char text[LINE_TEXT];
    (void)fputs(line_text(failure->line, text), to);
}

/* How the user enters the address that was heard. */
static void print_other(FILE *to, const failure_t *failure)
{
    const unsigned address = failure->evidence.foreign_address;
    if (failure->shared != NULL)
        (void)fprintf(to, "%s:%u", failure->model->name, address);
    else
        (void)fprintf(to, "%s %u", failure->is_request ? "UNIT" : "--address", address);
}

/* "--baud and --parity (now 9600 8N1; ...)" */
static void print_settings(FILE *to, const failure_t *failure)
{
    const fathom_line_settings_t *const now = failure->line;
    const fathom_line_settings_t *const factory = &failure->model->line;
    const uint64_t *const port = failure->counters->attempt.port;
    char text[LINE_TEXT];
    (void)fputs("--baud and --parity", to);
    if (now == NULL) return;
    (void)fprintf(to, " (now %s", line_text(now, text));
    if (factory->baud != 0 && (now->baud != factory->baud || now->parity != factory->parity ||
                               now->stop_bits != factory->stop_bits))
        (void)fprintf(to, "; with factory settings %s", line_text(factory, text));
    else if (failure->model->other_settings != NULL)
        (void)fprintf(to, "; try %s", failure->model->other_settings);
    if (port[PORT_FRAMING] + port[PORT_PARITY] != 0)
        (void)fprintf(to, "; the port counts %s",
                      port[PORT_FRAMING] != 0 ? "framing errors, so most likely --baud"
                                              : "parity errors, so most likely --parity");
    (void)fputs(")", to);
}

static void print_exception(FILE *to, const failure_t *failure)
{
    const uint8_t *const place = failure->port->gateway_exception;
    const uint8_t gateway = place != NULL ? *place : 0;
    const uint8_t number = gateway != 0 ? gateway : reader_facts(failure->reader).exception;
    const modbus_exception_t exception = modbus_exception(number);
    (void)fprintf(to, "%02u (%s)", number, exception.name);
    if (gateway == 0) (void)fprintf(to, ": %s", exception.meaning);
    if (gateway == 0 && exception.is_other_sensor)
        (void)fprintf(to, ". Check that the sensor is %s", failure->model->name);
}

static void print_hex(FILE *to, const failure_t *failure)
{
    (void)fprintf(to, "%X", reader_facts(failure->reader).refused_raw);
}

static void print_values(FILE *to, const failure_t *failure)
{
    const reader_facts_t facts = reader_facts(failure->reader);
    for (uint8_t i = 0; i != facts.value_count; i++)
        (void)fprintf(to, "%s%u", i != 0 ? " " : "", facts.values[i]);
}

static const struct {
    const char *name;
    void (*print)(FILE *to, const failure_t *failure);
} words[] = {
    {"sensor", print_sensor}, {"place", print_place},       {"line", print_line},
    {"other", print_other},   {"settings", print_settings}, {"exception", print_exception},
    {"hex", print_hex},       {"values", print_values},
};
enum { WORDS = sizeof words / sizeof words[0] };

/* ---- texts and numbers ---- */

static const char *text_of(const char *name, const failure_t *failure)
{
    const struct {
        const char *name;
        const char *text;
    } texts[] = {
        {"model", failure->model->name},
        {"path", failure->port->name},
        {"protocol", failure->mode->protocol},
        {"option", failure->is_request ? "UNIT" : "--address"},
        {"streamed", failure->evidence.streamed_a05 != 0 ? "a05" : "a16"},
        {"port-error", failure->port->error_text},
        {"library", fathom_status_advice(failure->status)},
    };
    for (size_t i = 0; i != sizeof texts / sizeof texts[0]; i++)
        if (strcmp(texts[i].name, name) == 0) return texts[i].text;
    return NULL;
}

static uint64_t number_of(const char *name, const failure_t *failure)
{
    const evidence_t *const evidence = &failure->evidence;
    const counters_t *const counters = failure->counters;
    const counts_t *const attempt = &counters->attempt;
    const reader_facts_t facts = reader_facts(failure->reader);
    const bool has_probes = failure->model->probes > 1;
    const struct {
        const char *name;
        uint64_t value;
    } numbers[] = {
        {"address", failure->address},
        {"foreign", evidence->foreign_address},
        {"asked", evidence->masters_address},
        {"own", evidence->own},
        {"took", evidence->slowest_us / 1000u},
        {"timeout",
         (evidence->slowest_us / 500u + 99u) / 100u * 100u}, /* twice the time, in steps of 100 ms */
        {"latency", adapter_latency_ms(failure->port->name)},
        {"probe", has_probes ? facts.refused_probe : 0u},
        {"raw", facts.refused_raw},
        {"min", facts.min_mm},
        {"max", facts.max_mm},
        {"whole", failure->is_whole},
        {"noises", failure->noises},
        {"old", attempt->line[FATHOM_LINE_OLD_BYTES]},
        {"dropped", attempt->stream[FATHOM_STREAM_DROPPED_BYTES]},
        {"damaged-frames", attempt->stream[FATHOM_STREAM_DAMAGED]},
        {"damaged", counters->failures[-FATHOM_ERR_CHECKSUM]},
        {"attempts", counters->attempts + 1},
        {"not-scan", !failure->is_scan},
        {"reads", !failure->is_scan && !failure->is_setting && !failure->is_request},
    };
    for (size_t i = 0; i != sizeof numbers / sizeof numbers[0]; i++)
        if (strcmp(numbers[i].name, name) == 0) return numbers[i].value;
    return 0;
}

static void print_word(FILE *to, const char *name, const failure_t *failure)
{
    const char *const text = text_of(name, failure);
    for (size_t i = 0; i != WORDS; i++) {
        if (strcmp(words[i].name, name) != 0) continue;
        words[i].print(to, failure);
        return;
    }
    if (text != NULL)
        (void)fputs(text, to);
    else
        (void)fprintf(to, "%" PRIu64, number_of(name, failure));
}

void advice_print_template(FILE *to, const char *text, const failure_t *failure)
{
    char name[20];
    while (*text != '\0') {
        const char mark = *text++;
        const size_t length = mark == '{' ? strcspn(text, "}") : mark == '[' ? strcspn(text, ":") : 0;
        if (length == 0) {
            if (mark != ']') (void)fputc(mark, to);
            continue;
        }
        (void)snprintf(name, sizeof name, "%.*s", (int)length, text);
        text += length + 1;
        if (mark == '{')
            print_word(to, name, failure);
        else if (number_of(name, failure) == 0)
            text += strcspn(text, "]");
    }
}
