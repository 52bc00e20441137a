/* SPDX-License-Identifier: MIT */
#ifndef WATCH_PICTURE_H
#define WATCH_PICTURE_H

#include "commands/watch/watch_lanes.h"

/* The picture that `fathom watch` shows: characters in rows and columns. */
enum { PICTURE_ROWS = 200, PICTURE_COLUMNS = 400, PICTURE_ROW_TEXT = PICTURE_COLUMNS * 16 };

/* Glyphs above GLYPH_BLOCK are blocks that are filled from below: 1 to 8 eighths. */
enum { GLYPH_BLOCK = 128 };

typedef struct {
    uint8_t glyph;
    uint8_t colour;
} cell_t;

typedef struct {
    int rows;
    int columns;
    cell_t cells[PICTURE_ROWS][PICTURE_COLUMNS];
} picture_t;

/* Draws everything. rows, columns: of the window. The title is cut to the width, the message wrapped. */
void picture_draw(picture_t *picture, int rows, int columns, const lanes_t *lanes, const char *title,
                  const char *message);

/* Writes a row for the terminal, without its position and the blanks at its end. Returns the columns that it fills. */
int picture_row(const picture_t *picture, int row, bool has_colours, bool is_utf8,
                char text[PICTURE_ROW_TEXT]);

#endif
