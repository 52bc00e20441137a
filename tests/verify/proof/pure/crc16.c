/* SPDX-License-Identifier: MIT */
/*
 * The sum over 0..255 bytes that can be any, and not one byte more; crc16_small.c is the same.
 *
 * proves: src/codec/crc16.c
 * options: -eva-auto-loop-unroll 1 -eva-slevel-function fathom_crc16:0 -eva-domains cvalue,gauges
 */
#include "crc16_any.h"
