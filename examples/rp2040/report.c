/* SPDX-License-Identifier: MIT */
#include "report.h"

typedef struct {
    uint8_t bytes[REPORT_SIZE];
    uint8_t length;
} text_t;

static void add(text_t *text, const char *words)
{
    while (*words != 0 && text->length < REPORT_SIZE) text->bytes[text->length++] = (uint8_t)*words++;
}

static void add_number(text_t *text, uint32_t value)
{
    char digits[11];
    unsigned at = sizeof digits - 1;
    digits[at] = 0;
    do digits[--at] = (char)('0' + value % 10);
    while ((value /= 10) != 0);
    add(text, &digits[at]);
}

void report(const fathom_uart_t *uart, fathom_status_t status, const fathom_sample_t *sample)
{
    text_t text;
    text.length = 0;
    if (status < 0) {
        add(&text, "error -");
        add_number(&text, (uint32_t)-status);
    } else {
        if (sample->kind == FATHOM_TARGET) {
            add(&text, "target ");
            add_number(&text, sample->distance_mm);
            add(&text, " mm");
        } else {
            add(&text, sample->kind == FATHOM_NO_TARGET ? "no target"
                       : sample->kind == FATHOM_UNKNOWN ? "unknown"
                                                        : "fault");
        }
        add(&text, ", raw ");
        add_number(&text, sample->raw);
    }
    add(&text, "\n");
    (void)uart->write(uart->ctx, text.bytes, text.length);
}
