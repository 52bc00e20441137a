/* SPDX-License-Identifier: MIT */
#include "wire_phases.h"

#include <stdio.h>
#include <stdlib.h>

static const char *const names[] = {
    [FATHOM_LINE_IDLE] = "IDLE",
    [FATHOM_LINE_IN_BREAK] = "IN_BREAK",
    [FATHOM_LINE_ENDING_BREAK] = "ENDING_BREAK",
    [FATHOM_LINE_DRAINING] = "DRAINING",
    [FATHOM_LINE_PORT_BUSY] = "PORT_BUSY",
    [FATHOM_LINE_SENDING] = "SENDING",
    [FATHOM_LINE_WAITING] = "WAITING",
};
enum { PHASES = sizeof names / sizeof *names, CELL = 160 };

static bool seen[PHASES][PHASES];
static bool is_in_table[PHASES][PHASES];
static uint8_t phase;

void phases_watch(void)
{
    phase = desk.line.phase;
    wire.on_call = phases_sample;
}

void phases_sample(void)
{
    const uint8_t now = desk.line.phase;
    assert_true(now < PHASES);
    if (now == phase) return;
    seen[phase][now] = true;
    phase = now;
}

void phases_count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    phases_sample();
    fathom_line_count(line, which, by);
}

/* Copies the cell that begins at `*at`, without spaces at its ends, and moves on behind its '|'. */
static bool next_cell(const char **at, char *cell)
{
    const char *const end = strchr(*at, '|');
    size_t length;
    if (end == NULL) return false;
    while (**at == ' ') (*at)++;
    length = (size_t)(end - *at);
    while (length != 0 && (*at)[length - 1] == ' ') length--;
    if (length >= CELL) length = CELL - 1;
    memcpy(cell, *at, length);
    cell[length] = '\0';
    *at = end + 1;
    return true;
}

static uint8_t phase_of(const char *name, size_t length)
{
    for (uint8_t i = 0; i != PHASES; i++)
        if (strlen(names[i]) == length && strncmp(names[i], name, length) == 0) return i;
    fail_msg("the table names a phase that the line does not have: %.*s", (int)length, name);
    return 0;
}

/* Calls `with` for each phase of "A, B, C". */
static unsigned for_each(const char *cell, uint8_t to, unsigned (*with)(uint8_t from, uint8_t to))
{
    unsigned missing = 0;
    while (*cell != '\0') {
        const size_t length = strcspn(cell, ",");
        missing += with(phase_of(cell, length), to);
        cell += length;
        cell += strspn(cell, ", ");
    }
    return missing;
}

static unsigned expect_seen(uint8_t from, uint8_t to)
{
    is_in_table[from][to] = true;
    if (seen[from][to]) return 0;
    print_message("never seen: %s to %s\n", names[from], names[to]);
    return 1;
}

/* The rows stand below "| phase | event | next phase |" and a row of dashes. */
static unsigned read_table(FILE *file)
{
    char line[512], from[CELL], event[CELL], next[CELL];
    unsigned missing = 0, rows = 0;
    bool is_table = false;
    while (fgets(line, sizeof line, file) != NULL) {
        const char *at = line + 1;
        if (line[0] != '|' || !next_cell(&at, from) || !next_cell(&at, event) || !next_cell(&at, next)) {
            is_table = false;
            continue;
        }
        if (strcmp(from, "phase") == 0 && strcmp(next, "next phase") == 0) {
            is_table = true;
            continue;
        }
        if (!is_table || from[0] == '-') continue;
        missing += for_each(from, phase_of(next, strlen(next)), expect_seen);
        rows++;
    }
    assert_true(rows != 0);
    return missing;
}

void phases_expect_table(void)
{
    FILE *const file = fopen(FATHOM_ENGINE_PAGE, "r");
    unsigned unknown = 0;
    assert_non_null(file);
    const unsigned missing = read_table(file);
    (void)fclose(file);
    for (uint8_t from = 0; from != PHASES; from++)
        for (uint8_t to = 0; to != PHASES; to++) {
            if (!seen[from][to] || is_in_table[from][to]) continue;
            print_message("not in the table: %s to %s\n", names[from], names[to]);
            unknown++;
        }
    assert_int_equal(missing + unknown, 0);
}
