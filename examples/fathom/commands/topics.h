/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "cli/help.h"

/* The topics of `fathom help`; a row without a name ends them. */
extern const topic_t topics[];

#endif
