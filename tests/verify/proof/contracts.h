/* SPDX-License-Identifier: MIT */
#ifndef CONTRACTS_H
#define CONTRACTS_H

#include "assumptions.h"
#include "fathom/codec/crc16.h"

/*
 * Functions of Fathom by their contract, where their body costs too much: each is shown by a harness of its own to keep
 * it for every input, and what it asks for is asserted here. A harness that includes this does not link their sources.
 */

/* pure/crc16.c, pure/crc16_small.c: of so many bytes that can be read and were written, any sum. */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    /*@ assert length == 0 || \valid_read(bytes + (0 .. length - 1)); */
    /*@ assert length == 0 || \initialized(bytes + (0 .. length - 1)); */
    return any_16();
}

#endif
