/* SPDX-License-Identifier: MIT */
#ifndef RP2040_BOARD_H
#define RP2040_BOARD_H

/* What the start-up code has made of the clocks: the usual ones of the maker's SDK, for a crystal of 12 MHz. */
#define BOARD_CLK_REF_HZ  12000000u
#define BOARD_CLK_PERI_HZ 125000000u

enum { BOARD_ENDED = 0x454E4421 }; /* in the watchdog's SCRATCH1 after main; SCRATCH0 has what it returned */

#endif
