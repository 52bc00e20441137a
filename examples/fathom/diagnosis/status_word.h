/* SPDX-License-Identifier: MIT */
#ifndef STATUS_WORD_H
#define STATUS_WORD_H

#include <stdio.h>

#include "sensors/model.h"

/* The words for programs, in `status` and `alarm`, of all commands that tell readings. */

/* What a sample of this kind is; one of a contact has its own. */
const char *status_word(const model_mode_t *mode, uint8_t kind);

/* An attempt that has failed; kind: of counters.h. text: a buffer of COUNTERS_MEMBER. */
const char *status_word_of_failure(size_t kind, char *text);

/* fathom_alarm_state_t */
const char *alarm_word(uint8_t state);

/* The words of `status`, a line each. */
void status_words_help(FILE *to);

#endif
