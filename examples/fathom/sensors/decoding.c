/* SPDX-License-Identifier: MIT */
#include "sensors/decoding.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

uint16_t decode_get16(const uint8_t *at) { return (uint16_t)(at[0] * 256u + at[1]); }

void decode_registers(const uint8_t *at, uint16_t *registers, uint8_t count)
{
    for (uint8_t i = 0; i != count; i++) registers[i] = decode_get16(at + 2 * i);
}

decode_meaning_t *decode_mean(decode_frame_t *frame, const char *sensor, const char *source,
                              const char *format, ...)
{
    va_list arguments;
    if (frame->meanings != DECODE_MEANINGS) frame->meanings++;
    decode_meaning_t *const meaning = &frame->meaning[frame->meanings - 1];
    *meaning = (decode_meaning_t){.sensor = sensor, .source = source};
    va_start(arguments, format);
    (void)vsnprintf(meaning->what, sizeof meaning->what, format, arguments);
    va_end(arguments);
    return meaning;
}

void decode_note(decode_frame_t *frame, const char *format, ...)
{
    va_list arguments;
    if (frame->notes == DECODE_NOTES) return;
    va_start(arguments, format);
    (void)vsnprintf(frame->note[frame->notes++], sizeof frame->note[0], format, arguments);
    va_end(arguments);
}

/* ---- the values of a meaning ---- */

decode_field_t *decode_string(decode_meaning_t *meaning, const char *name, const char *format, ...)
{
    va_list arguments;
    if (meaning->count != DECODE_FIELDS) meaning->count++;
    decode_field_t *const field = &meaning->fields[meaning->count - 1];
    *field = (decode_field_t){.name = name, .unit = ""};
    va_start(arguments, format);
    (void)vsnprintf(field->value, sizeof field->value, format, arguments);
    va_end(arguments);
    return field;
}

decode_field_t *decode_number(decode_meaning_t *meaning, const char *name, int64_t value, const char *unit)
{
    decode_field_t *const field = decode_string(meaning, name, "%" PRId64, value);
    field->is_number = true;
    field->unit = unit;
    return field;
}

void decode_remark(decode_field_t *field, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(field->note, sizeof field->note, format, arguments);
    va_end(arguments);
}

static decode_field_t *add_value(decode_meaning_t *meaning, const setting_t *setting, int64_t value)
{
    if (setting->words == NULL)
        return decode_number(meaning, setting->name, value, setting->unit != NULL ? setting->unit : "");
    const int32_t word = setting_word(setting, value);
    if (word < 0) return decode_string(meaning, setting->name, "0x%04X", (unsigned)value);
    decode_field_t *const field = decode_string(meaning, setting->name, "%s", setting->words[word]);
    field->is_number = isdigit((unsigned char)setting->words[0][0]) != 0;
    return field;
}

void decode_setting(decode_meaning_t *meaning, const setting_t *setting, int64_t value)
{
    const int32_t least = setting->has_zero ? 0 : setting->least;
    const char *const note = setting->note != NULL ? setting->note(value) : NULL;
    decode_field_t *const field = add_value(meaning, setting, value);
    if (note != NULL)
        decode_remark(field, "%s", note);
    else if (setting_can_be(setting, value))
        return;
    else if (setting->words != NULL)
        decode_remark(field, "not one of its values");
    else if (value < least || value > setting->most)
        decode_remark(field, "not from %" PRId32 " to %" PRId32, least, setting->most);
    else
        decode_remark(field, "no multiple of %" PRId32, setting->step);
}

void decode_response(decode_meaning_t *meaning, const setting_t *setting, const uint16_t *registers)
{
    if (setting->print == NULL) {
        decode_setting(meaning, setting, setting_decode(setting, registers));
        return;
    }
    char text[SETTING_TEXT] = "";
    setting->print(text, registers);
    decode_field_t *const field = decode_string(meaning, setting->name, "%s", text);
    field->is_number = setting->unit != NULL || setting->words != NULL;
    if (setting->unit != NULL) field->unit = setting->unit;
}

/* ---- printing ---- */

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
    if (is_named(meaning))
        (void)fputs(" ", to);
    else
        (void)fprintf(to, ": %s ", meaning->fields[0].name);
    put_value(to, &meaning->fields[0]);
}

void decoding_put_text(FILE *to, const decode_meaning_t *meaning)
{
    (void)fputs("        ", to);
    if (meaning->sensor[0] != '\0') (void)fprintf(to, "%-8s ", meaning->sensor);
    if (meaning->count == 1)
        decoding_put_line(to, meaning);
    else
        (void)fputs(meaning->what, to);
    (void)fputc('\n', to);
    for (uint8_t i = 0; i != meaning->count && meaning->count != 1; i++) {
        (void)fprintf(to, "            %-22s ", meaning->fields[i].name);
        put_value(to, &meaning->fields[i]);
        (void)fputc('\n', to);
    }
}

/* Writes `value`, or the note, by the name and the unit of the field: "real-time-distance" in mm is
 * real_time_distance_mm. */
static void put_member(json_t *json, const decode_field_t *field, bool is_note)
{
    char key[DECODE_VALUE];
    (void)snprintf(key, sizeof key, "%s%s%s", field->name, field->unit[0] != '\0' ? "_" : "", field->unit);
    for (char *at = key; *at != '\0'; at++)
        *at = *at == ' ' || *at == '-' ? '_' : (char)tolower((unsigned char)*at);
    if (is_note)
        json_string(json, key, field->note);
    else if (field->is_number)
        json_value(json, key, "%s", field->value);
    else
        json_string(json, key, field->value);
}

void decoding_put_json(json_t *json, const decode_meaning_t *meaning)
{
    json_begin(json, NULL, '{');
    if (meaning->sensor[0] != '\0') {
        json_string(json, "model", meaning->sensor);
        json_string(json, "source", meaning->source);
    }
    json_string(json, "what", meaning->what);
    json_begin(json, "fields", '{');
    for (uint8_t i = 0; i != meaning->count; i++) put_member(json, &meaning->fields[i], false);
    json_end(json, '}');
    json_begin(json, "notes", '{');
    for (uint8_t i = 0; i != meaning->count; i++)
        if (meaning->fields[i].note[0] != '\0') put_member(json, &meaning->fields[i], true);
    json_end(json, '}');
    json_end(json, '}');
}
