/* SPDX-License-Identifier: MIT */
/*
 * proves: src/engine/line_turns.c
 * with:   src/engine/line.c src/engine/line_attempt.c src/engine/line_masters.c src/engine/line_options.c
 *          src/engine/line_request.c src/engine/line_response.c src/engine/line_due.c src/engine/line_echo.c src/engine/line_round.c src/engine/line_senders.c src/engine/fair_share.c
 *          src/codec/dyp_55aa.c src/codec/dyp_stream.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 128
 *          -eva-slevel-function fathom_line_begin:100,fathom_line_init:20,can_send:20,is_usable:20,main:5,fathom_line_poll:3,fathom_line_marks:30
 *          -eva-split-return-function fathom_line_begin:0,fathom_line_init:0
 * quick:   no
 *
 * The same as line.c on a line whose time is shared.
 */
#define FAIR_SHARE
#include "line.c"
