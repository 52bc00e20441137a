/* SPDX-License-Identifier: MIT */
#ifndef WATCH_PICTURE_H
#define WATCH_PICTURE_H

#include "commands/watch/watch_lanes.h"

/* The picture that `fathom watch` shows: characters in rows and columns. */
enum { PICTURE_ROWS = 200, PICTURE_COLUMNS = 400 };

typedef enum { COLOUR_PLAIN = 0, COLOUR_BAR, COLOUR_CALM, COLOUR_LOSS, COLOUR_BOLD } colour_t;

/* Characters from 128 on: a block that is filled from below, so many eighths (1..8) over 128. */
enum { GLYPH_BLOCK = 128 };

typedef struct {
    uint8_t glyph;
    uint8_t colour; /* colour_t */
} cell_t;

typedef struct {
    uint16_t rows;
    uint16_t columns;
    cell_t cells[PICTURE_ROWS][PICTURE_COLUMNS];
} picture_t;

/* All of it. rows and columns: the window's, what is over the limits above stays empty. title, message: a line each,
 * cut to the width. */
void picture_draw(picture_t *picture, uint16_t rows, uint16_t columns, const lanes_t *lanes,
                  const char *title, const char *message);

/* A row as it goes to the terminal, without its place: text of `capacity` bytes, PICTURE_ROW_TEXT is enough. Blanks at
 * its end are left out; returns how many columns it fills. */
enum { PICTURE_ROW_TEXT = PICTURE_COLUMNS * 16 };
uint16_t picture_row(const picture_t *picture, uint16_t row, bool has_colours, bool is_utf8, char *text);

#endif
