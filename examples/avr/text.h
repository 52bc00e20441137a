/* SPDX-License-Identifier: MIT */
#ifndef TEXT_H
#define TEXT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/sample.h"
#include "fathom/status.h"

/* A line of text for people, gathered here and handed to the UART whole. Nothing waits: what finds no room is cut
 * off. */
enum { TEXT_SIZE = 64 };

typedef struct {
    uint8_t length;
    uint8_t bytes[TEXT_SIZE];
} text_t;

/* flash: a string in program memory, PSTR("...") */
void text_say(text_t *text, const char *flash);
void text_number(text_t *text, uint16_t number);

/* "1234 mm", "nothing in range", "disturbed" or "sensor fault" */
void text_sample(text_t *text, const fathom_sample_t *sample);
/* "error -3: no response" and so on */
void text_error(text_t *text, fathom_status_t status);

/* Hands it over, if the UART is not busy with the one before. True: it has been taken, and the text is empty. */
bool text_send(text_t *text, const fathom_uart_t *uart);

#endif
