/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TABLES_H
#define FATHOM_TESTS_TABLES_H

#include <stdint.h>

/* The tables that are not by sensor and fault. Each prints to stdout and returns how many of its lines break a
 * rule. */
uint32_t tables_eight(uint32_t seconds, uint32_t seed);
uint32_t tables_options(uint64_t transactions, uint32_t seed);

#endif
