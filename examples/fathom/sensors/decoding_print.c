/* SPDX-License-Identifier: MIT */
#include "sensors/decoding_print.h"

#include <string.h>

enum { KEY = 64 };

static void put_value(FILE *to, const decode_field_t *field)
{
    (void)fprintf(to, "%s%s%s", field->value, field->unit[0] != '\0' ? " " : "", field->unit);
    if (field->note[0] != '\0') (void)fprintf(to, " (%s)", field->note);
}

/* A value whose name ends the line before it is printed without its name. */
static bool is_named(const decode_meaning_t *meaning)
{
    const size_t what = strlen(meaning->what);
    const size_t name = strlen(meaning->fields[0].name);
    return what >= name && strcmp(meaning->what + what - name, meaning->fields[0].name) == 0;
}

void decoding_put_line(FILE *to, const decode_meaning_t *meaning)
{
    (void)fputs(meaning->what, to);
    if (meaning->count == 0) return;
    (void)fputs(is_named(meaning) ? " " : ": ", to);
    if (!is_named(meaning)) (void)fprintf(to, "%s ", meaning->fields[0].name);
    put_value(to, &meaning->fields[0]);
}

void decoding_put_text(FILE *to, const decode_meaning_t *meaning)
{
    (void)fputs("        ", to);
    if (meaning->sensor[0] != '\0') (void)fprintf(to, "%-8s ", meaning->sensor);
    if (meaning->count == 1) {
        decoding_put_line(to, meaning);
        (void)fputc('\n', to);
        return;
    }
    (void)fprintf(to, "%s\n", meaning->what);
    for (uint8_t i = 0; i != meaning->count; i++) {
        (void)fprintf(to, "            %-22s ", meaning->fields[i].name);
        put_value(to, &meaning->fields[i]);
        (void)fputc('\n', to);
    }
}

/* The name and the unit of a field as a key: "real-time-distance" in mm is real_time_distance_mm. */
static const char *key_of(const decode_field_t *field, char key[KEY])
{
    (void)snprintf(key, KEY, "%s%s%s", field->name, field->unit[0] != '\0' ? "_" : "", field->unit);
    for (char *at = key; *at != '\0'; at++) {
        if (*at >= 'A' && *at <= 'Z') *at = (char)(*at - 'A' + 'a');
        if (*at == ' ' || *at == '-') *at = '_';
    }
    return key;
}

void decoding_put_json(json_t *json, const decode_meaning_t *meaning)
{
    char key[KEY];
    json_begin(json, NULL, '{');
    if (meaning->sensor[0] != '\0') {
        json_string(json, "model", meaning->sensor);
        json_string(json, "source", meaning->source);
    }
    json_string(json, "what", meaning->what);
    json_begin(json, "fields", '{');
    for (uint8_t i = 0; i != meaning->count; i++) {
        const decode_field_t *const field = &meaning->fields[i];
        if (field->is_number)
            json_value(json, key_of(field, key), "%s", field->value);
        else
            json_string(json, key_of(field, key), field->value);
    }
    json_end(json, '}');
    json_begin(json, "notes", '{');
    for (uint8_t i = 0; i != meaning->count; i++)
        if (meaning->fields[i].note[0] != '\0')
            json_string(json, key_of(&meaning->fields[i], key), meaning->fields[i].note);
    json_end(json, '}');
    json_end(json, '}');
}
