/* SPDX-License-Identifier: MIT */
#ifndef WATCH_TERMINAL_H
#define WATCH_TERMINAL_H

#include "commands/watch/watch_picture.h"
#include "fathom_loop.h"

/*
 * The terminal at the standard output. While it is open, the picture has another screen without a cursor, nothing that is
 * typed is echoed, and Ctrl-Z and Ctrl-\ do nothing, because they would leave the terminal in this state.
 */

/* Returns true if a picture can be drawn. */
bool terminal_can_draw(void);

void terminal_open(void);

/* Restores the terminal; a second call does nothing. False: a signal ended the command, and the terminal is stuck. */
bool terminal_close(void);

/* Keys are read if the standard input is a terminal too. The loop gets them while the terminal is open. */
bool terminal_has_keys(void);
void terminal_add_keys(fathom_loop_t *loop);

/* Returns true if q was pressed. */
bool terminal_wants_end(void);

/* 80 x 24 if the system does not know. */
void terminal_size(int *rows, int *columns);

/* Writes the rows that have changed since the last call, or all of them. Returns 0, or errno. */
int terminal_show(const picture_t *picture, bool all);

#endif
