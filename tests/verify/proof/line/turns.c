/* SPDX-License-Identifier: MIT */
/*
 * proves: src/engine/line_turns.c
 * with:   src/engine/line.c src/engine/line_count.c src/engine/line_find_echo.c src/engine/line_marks.c
 *          src/engine/fair_share.c
 *          src/engine/line_request.c src/engine/line_response.c src/engine/line_send.c
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_line_begin:100,main:5,fathom_line_poll:3,fathom_line_marks:30
 *          -eva-split-return-function fathom_line_begin:1,fathom_line_init:1
 * quick:   no
 *
 * The same as line.c on a line whose time is shared.
 */
#define FAIR_SHARE
#include "line.c"
