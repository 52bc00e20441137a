/* SPDX-License-Identifier: MIT */
#include "text.h"

#include <avr/pgmspace.h>

static void add(text_t *text, char c)
{
    if (text->length != TEXT_SIZE) text->bytes[text->length++] = (uint8_t)c;
}

void text_say(text_t *text, const char *flash)
{
    for (char c; (c = (char)pgm_read_byte(flash)) != '\0'; flash++) add(text, c);
}

void text_number(text_t *text, uint16_t number)
{
    char digits[5]; /* of 65535 */
    uint8_t count = 0;
    do {
        digits[count++] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    while (count != 0) add(text, digits[--count]);
}

void text_sample(text_t *text, const fathom_sample_t *sample)
{
    switch (sample->kind) {
    case FATHOM_TARGET:
        text_number(text, sample->distance_mm);
        text_say(text, PSTR(" mm"));
        break;
    case FATHOM_NO_TARGET:
        text_say(text, sample->interference ? PSTR("disturbed") : PSTR("nothing in range"));
        break;
    case FATHOM_UNKNOWN:
        text_say(text, PSTR("unknown value "));
        text_number(text, (uint16_t)sample->raw);
        break;
    default:
        text_say(text, PSTR("sensor fault"));
        break;
    }
}

void text_error(text_t *text, fathom_status_t status)
{
    text_say(text, PSTR("error -"));
    text_number(text, (uint16_t)-status);
    switch (status) {
    case FATHOM_ERR_PORT:
        text_say(text, PSTR(": port broken"));
        break;
    case FATHOM_ERR_NO_RESPONSE:
        text_say(text, PSTR(": no response"));
        break;
    case FATHOM_ERR_MALFORMED:
        text_say(text, PSTR(": not plausible"));
        break;
    case FATHOM_ERR_CHECKSUM:
        text_say(text, PSTR(": damaged"));
        break;
    case FATHOM_ERR_STALE:
        text_say(text, PSTR(": silent"));
        break;
    default:
        break; /* sensors that send by themselves have no others */
    }
}

bool text_send(text_t *text, const fathom_uart_t *uart)
{
    if (text->length == 0) return true;
    if (uart->write(uart->ctx, text->bytes, text->length) != text->length) return false;
    text->length = 0;
    return true;
}
