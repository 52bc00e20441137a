/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_HEX_H
#define FATHOM_TESTS_HEX_H

#include <stdint.h>

/* The bytes of "01 03 FF", a space between two; returns how many. */
uint8_t hex_parse(const char *hex, uint8_t *bytes);

#endif
