/* SPDX-License-Identifier: MIT */
#ifndef STATUS_WORD_H
#define STATUS_WORD_H

#include <stdio.h>

#include "sensors/models.h"

/* The words of `status` and `alarm` in text, JSON, CSV and MQTT. */

/* Returns the word for a kind of sample. A contact has its own words. */
const char *status_word(const model_mode_t *mode, uint8_t kind);

/* Failures by kind: -status, and beside it those whose values were refused. The last kind is any other failure. */
enum { FAILURE_VALUE = 0, FAILURE_KINDS = 20 };

/* Returns the word for a failure. NULL if no attempt can end so. */
const char *status_word_of_failure(size_t kind);

/* Returns the word for a fathom_alarm_state_t. */
const char *alarm_word(uint8_t state);

/* Writes a line for each word of `status`. */
void status_words_help(FILE *to);

#endif
