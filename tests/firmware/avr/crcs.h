/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_CRCS_H
#define FATHOM_TEST_AVR_CRCS_H

#include <stdint.h>

/* What images/crcs.c and its test share. */
enum { CRCS_BYTES = 64, CRCS_RECORD = 1 };

typedef struct {
    uint8_t go; /* set by the test last of all, and to 0 by the image */
    uint8_t length, bytes[CRCS_BYTES];
} crcs_t;

#endif
