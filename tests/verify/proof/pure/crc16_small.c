/* SPDX-License-Identifier: MIT */
/*
 * The sum over 0..255 bytes that can be any, and not one byte more, by the table of 16.
 *
 * proves: src/codec/crc16_small.c
 * options: -eva-auto-loop-unroll 1 -eva-slevel-function fathom_crc16:0 -eva-domains cvalue,gauges
 * quick:   no
 */
#include "crc16_any.h"
