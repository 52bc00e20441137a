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

bool option_check_given(const option_table_t *tables, const option_given_t *given, const origin_t *origin)
{
    const char *const mark = origin->within == NULL && origin->file == NULL ? "--" : "";
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        const option_t *const row = walk.row;
        const unsigned line = given->line[walk.number];
        if (line == 0 && row->is_required) {
            char takes[OPTION_TAKES];
            option_takes(row, takes);
            return reject(origin, "%s%s is missing. It takes %s.", mark, row->name, takes);
        }
        if (line == 0 || row->needs == NULL || option_is_given(given, tables, row->needs)) continue;
        origin_t its = *origin;
        if (its.file != NULL) its.line = line;
        return reject(&its, "%s%s has no effect without %s%s.", mark, row->name, mark, row->needs);
    }
    return true;
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
