/* SPDX-License-Identifier: MIT */
#include "sensors/decoding_print.h"

static void put_value(FILE *to, const decode_field_t *field)
{
    (void)fprintf(to, "%s%s%s", field->value, field->unit[0] != '\0' ? " " : "", field->unit);
    if (field->note != NULL) (void)fprintf(to, " (%s)", field->note);
    (void)fputc('\n', to);
}

void decoding_put_text(FILE *to, const decode_meaning_t *meaning)
{
    (void)fputs("        ", to);
    if (meaning->sensor[0] != '\0') (void)fprintf(to, "%-8s ", meaning->sensor);
    (void)fputs(meaning->what, to);
    if (meaning->count == 1) {
        (void)fprintf(to, ": %s ", meaning->fields[0].name);
        put_value(to, &meaning->fields[0]);
        return;
    }
    (void)fputc('\n', to);
    for (uint8_t i = 0; i != meaning->count; i++) {
        (void)fprintf(to, "            %-17s ", meaning->fields[i].name);
        put_value(to, &meaning->fields[i]);
    }
}

/* The name and the unit of a field, as one word. */
static void put_key(FILE *to, const decode_field_t *field)
{
    (void)fputc('"', to);
    for (const char *at = field->name; *at != '\0'; at++) {
        const char low = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
        (void)fputc(low == ' ' || low == '-' ? '_' : low, to);
    }
    if (field->unit[0] != '\0')
        (void)fprintf(to, "_%s", field->unit[0] == 'F' ? "f" : field->unit[0] == 'C' ? "c" : field->unit);
    (void)fputs("\":", to);
}

void decoding_put_json(FILE *to, const decode_meaning_t *meaning)
{
    bool any = false;
    (void)fputc('{', to);
    if (meaning->sensor[0] != '\0')
        (void)fprintf(to, "\"sensor\":\"%s\",\"source\":\"%s\",", meaning->sensor, meaning->source);
    (void)fprintf(to, "\"what\":\"%s\",\"fields\":{", meaning->what);
    for (uint8_t i = 0; i != meaning->count; i++) {
        const decode_field_t *const field = &meaning->fields[i];
        const char *const quote = field->is_number ? "" : "\"";
        if (i != 0) (void)fputc(',', to);
        put_key(to, field);
        (void)fprintf(to, "%s%s%s", quote, field->value, quote);
    }
    (void)fputs("},\"notes\":{", to);
    for (uint8_t i = 0; i != meaning->count; i++) {
        if (meaning->fields[i].note == NULL) continue;
        if (any) (void)fputc(',', to);
        any = true;
        put_key(to, &meaning->fields[i]);
        (void)fprintf(to, "\"%s\"", meaning->fields[i].note);
    }
    (void)fputs("}}", to);
}
