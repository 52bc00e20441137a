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
