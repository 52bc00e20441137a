/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "cli/help.h"

/* The topics of `fathom help`; a row without a name ends them. */
extern const topic_t topics[];

/* The topic `faults`, in the folder of `fathom sim`. */
void topic_faults(FILE *to);

/* Writes a line for each field of the JSON of `fathom scan`. */
void scan_help_fields(FILE *to);

#endif
