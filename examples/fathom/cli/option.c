/* SPDX-License-Identifier: MIT */
#include "cli/option.h"

#include <string.h>

#include "output/words.h"

bool option_next(option_walk_t *walk)
{
    if (walk->row == NULL) {
        walk->row = walk->table->rows;
    } else {
        walk->row++;
        walk->number++;
    }
    while (walk->row != NULL && walk->row->name == NULL) walk->row = (++walk->table)->rows;
    return walk->row != NULL;
}

bool option_find(option_walk_t *walk, const option_table_t *tables, const char *name, size_t length)
{
    *walk = (option_walk_t){.table = tables};
    while (option_next(walk))
        if (strlen(walk->row->name) == length && strncmp(walk->row->name, name, length) == 0) return true;
    return false;
}

bool option_is_given(const option_given_t *given, const option_table_t *tables, const char *name)
{
    option_walk_t walk;
    return option_find(&walk, tables, name, strlen(name)) && given->line[walk.number] != 0;
}

bool option_reject_unknown(const option_table_t *tables, const char *what, const char *name,
                           const origin_t *origin)
{
    nearest_t nearest = {.word = name};
    char known[OPTION_TAKES] = "";
    const bool is_option = origin->within == NULL && origin->file == NULL;
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        if (walk.row->is_hidden) continue;
        nearest_try(&nearest, walk.row->name);
        list_add(known, sizeof known, walk.row->name);
    }
    return reject_unknown(origin, what, is_option ? "--" : "", &nearest, is_option ? NULL : known);
}
