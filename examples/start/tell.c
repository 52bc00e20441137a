/* SPDX-License-Identifier: MIT */
#include "tell.h"

#include "semihosting.h"

typedef struct {
    char text[64]; /* the longest line is less */
    uint8_t length;
} line_t;

static void add(line_t *line, const char *text)
{
    while (*text != '\0' && line->length < sizeof line->text - 1) line->text[line->length++] = *text++;
    line->text[line->length] = '\0';
}

const char *tell_digits(char digits[TELL_DIGITS], uint32_t number)
{
    uint8_t at = TELL_DIGITS - 1;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    return digits + at;
}

static void add_number(line_t *line, unsigned number)
{
    char digits[TELL_DIGITS];
    add(line, tell_digits(digits, number));
}

void tell_sample(const char *name, const fathom_sample_t *sample)
{
    line_t line = {"", 0};
    add(&line, name);
    add(&line, " probe ");
    add_number(&line, sample->probe);
    if (sample->kind == FATHOM_TARGET) {
        add(&line, " ");
        add_number(&line, sample->distance_mm);
        add(&line, " mm\n");
    } else {
        add(&line, sample->kind == FATHOM_FAULT ? " fault\n" : " no target\n");
    }
    semihosting_write(line.text);
}

void tell_error(const char *name, fathom_status_t status)
{
    line_t line = {"", 0};
    add(&line, name);
    add(&line, " error ");
    add(&line, fathom_status_name(status));
    add(&line, "\n");
    semihosting_write(line.text);
}
