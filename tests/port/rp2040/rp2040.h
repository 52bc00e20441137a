/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_RP2040_H
#define FATHOM_TESTS_RP2040_H

/* The registers of port/rp2040/rp2040.h with memory in their place, where rp2040_at() says. */
#include "../../../port/rp2040/rp2040.h"

/* Called for each access, before it. */
void *rp2040_at(uint32_t address);

#undef RP2040_AT
#define RP2040_AT(address) rp2040_at(address)

#endif
