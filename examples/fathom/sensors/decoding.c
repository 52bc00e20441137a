/* SPDX-License-Identifier: MIT */
#include "sensors/decoding.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

uint16_t decode_get16(const uint8_t *at) { return (uint16_t)(at[0] * 256u + at[1]); }

decode_meaning_t *decode_mean(decode_frame_t *frame, const char *sensor, const char *source,
                              const char *format, ...)
{
    va_list arguments;
    if (frame->meanings != DECODE_MEANINGS) frame->meanings++;
    decode_meaning_t *const meaning = &frame->meaning[frame->meanings - 1];
    memset(meaning, 0, sizeof *meaning);
    meaning->sensor = sensor;
    meaning->source = source;
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
    (void)vsnprintf(frame->note[frame->notes], sizeof frame->note[0], format, arguments);
    va_end(arguments);
    frame->notes++;
}

static decode_field_t *add(decode_meaning_t *meaning, const char *name, const char *unit)
{
    if (meaning->count != DECODE_FIELDS) meaning->count++;
    decode_field_t *const field = &meaning->fields[meaning->count - 1];
    memset(field, 0, sizeof *field);
    field->name = name;
    field->unit = unit;
    return field;
}

decode_field_t *decode_number(decode_meaning_t *meaning, const char *name, int64_t value, const char *unit)
{
    return decode_decimal(meaning, name, value, 0, unit);
}

decode_field_t *decode_decimal(decode_meaning_t *meaning, const char *name, int64_t value, uint8_t places,
                               const char *unit)
{
    decode_field_t *const field = add(meaning, name, unit);
    const int64_t size = value < 0 ? -value : value;
    int64_t one = 1;
    for (uint8_t i = 0; i != places; i++) one *= 10;
    field->is_number = true;
    size_t length =
        (size_t)snprintf(field->value, sizeof field->value, "%s%" PRId64, value < 0 ? "-" : "", size / one);
    if (places != 0) field->value[length++] = '.';
    for (; one > 1 && length < sizeof field->value - 1; length++) {
        const int64_t rest = size % one;
        one /= 10;
        field->value[length] = (char)('0' + rest / one);
    }
    field->value[length] = '\0';
    return field;
}

decode_field_t *decode_string(decode_meaning_t *meaning, const char *name, const char *format, ...)
{
    decode_field_t *const field = add(meaning, name, "");
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(field->value, sizeof field->value, format, arguments);
    va_end(arguments);
    return field;
}

void decode_remark(decode_field_t *field, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(field->note, sizeof field->note, format, arguments);
    va_end(arguments);
}

/* ---- settings ---- */

static void remark_range(decode_field_t *field, const setting_t *setting, int64_t value)
{
    const int32_t least = setting->has_zero ? 0 : setting->least;
    if (setting->words != NULL)
        decode_remark(field, "not one of its values");
    else if (value < least || value > setting->most)
        decode_remark(field, "not from %" PRId32 " to %" PRId32, least, setting->most);
    else
        decode_remark(field, "no multiple of %" PRId32, setting->step);
}

/* Returns true if its values are numbers, also if only some are allowed. */
static bool is_number(const setting_t *setting)
{
    if (setting->words != NULL) return setting->words[0][0] >= '0' && setting->words[0][0] <= '9';
    return setting->print == NULL || setting->unit != NULL;
}

void decode_setting(decode_meaning_t *meaning, const setting_t *setting, int64_t value)
{
    const char *const note = setting->note != NULL ? setting->note(value) : NULL;
    const int32_t word = setting->words != NULL ? setting_word(setting, value) : -1;
    decode_field_t *field = NULL;
    if (setting->words == NULL)
        field = decode_number(meaning, setting->name, value, setting->unit != NULL ? setting->unit : "");
    else if (word < 0)
        field = decode_string(meaning, setting->name, "0x%04X", (unsigned)value);
    else
        field = decode_string(meaning, setting->name, "%s", setting->words[word]);
    field->is_number = is_number(setting) && (setting->words == NULL || word >= 0);
    if (note != NULL)
        decode_remark(field, "%s", note);
    else if (!setting_can_be(setting, value))
        remark_range(field, setting, value);
}

void decode_response(decode_meaning_t *meaning, const setting_t *setting, const uint16_t *registers)
{
    const int64_t value = setting_decode(setting, registers);
    if (setting->print == NULL) {
        decode_setting(meaning, setting, value);
        return;
    }
    char text[SETTING_TEXT] = "";
    setting->print(text, registers);
    decode_field_t *const field = decode_string(meaning, setting->name, "%s", text);
    if (setting->unit != NULL) field->unit = setting->unit;
    field->is_number = is_number(setting);
}
