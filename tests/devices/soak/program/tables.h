/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TABLES_H
#define FATHOM_TESTS_TABLES_H

#include <stdint.h>

/* Prints the table of eight units on one pair, which is not by sensor and fault. Returns how many of its lines break
 * a rule. */
uint32_t tables_eight(uint32_t seconds, uint32_t seed);

#endif
