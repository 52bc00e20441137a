/* SPDX-License-Identifier: MIT */
#include "sensors/decoding_print.h"

enum { KEY = 64 };

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

/* The name and the unit of a field as a key: "real-time distance" in mm is real_time_distance_mm. */
static const char *key_of(const decode_field_t *field, char key[KEY])
{
    const char *const unit = field->unit[0] == 'F' ? "degf" : field->unit[0] == 'C' ? "degc" : field->unit;
    (void)snprintf(key, KEY, "%s%s%s", field->name, unit[0] != '\0' ? "_" : "", unit);
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
        if (meaning->fields[i].note != NULL)
            json_string(json, key_of(&meaning->fields[i], key), meaning->fields[i].note);
    json_end(json, '}');
    json_end(json, '}');
}
