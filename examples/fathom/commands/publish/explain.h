/* SPDX-License-Identifier: MIT */
#ifndef EXPLAIN_H
#define EXPLAIN_H

#include "cli/config.h"

/* What a configuration means, in words: what is read where and how, and the topics of all that is published. */
void explain(const config_t *config, config_results_t results, FILE *to);

#endif
