/* SPDX-License-Identifier: MIT */
#ifndef WATCH_TERMINAL_H
#define WATCH_TERMINAL_H

#include "commands/watch/watch_picture.h"
#include "fathom_loop.h"

/*
 * The terminal at the standard output. While it is taken the picture has it to itself: another screen, no cursor, no
 * echo of what is typed; Ctrl-Z and Ctrl-\ do nothing, because they would leave it so. What was there before is there
 * again afterwards.
 */

/* Is there one that can show a picture? */
bool terminal_can_draw(void);

/* Does it understand UTF-8, as far as the locale's name tells? Does its user want colours (NO_COLOR)? */
bool terminal_is_utf8(void);
bool terminal_has_colours(void);

void terminal_take(void);
/* Twice is no error. False: a signal has ended the command, and the terminal takes nothing. */
bool terminal_give_back(void);

/* Are keys read: is its standard input a terminal too, and taken? */
bool terminal_has_keys(void);

/* Adds the keys to a loop, if they are read. One loop a command, and after terminal_take. */
void terminal_attend(fathom_loop_t *loop);

/* Was q pressed? */
bool terminal_wants_end(void);

/* 80 x 24 where the system does not know. */
void terminal_size(uint16_t *rows, uint16_t *columns);

/* Writes the rows that have changed since the last call, or all of them. 0, or errno. */
int terminal_show(const picture_t *picture, bool all);

#endif
