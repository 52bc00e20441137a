/* SPDX-License-Identifier: MIT */
#include "cli/key_list.h"

#include <stdint.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

enum { MAX_LIST = 1024, MAX_KEY = 24, MAX_KEYS = 160 };

typedef struct {
    const char *command;
    const char *option;
    const key_row_t *rows;
    size_t count;
    uint32_t seen; /* bit: row */
} key_list_t;

static bool no_key(const key_list_t *list, const char *key)
{
    char keys[MAX_KEYS] = "";
    for (size_t i = 0; i != list->count; i++) list_add(keys, sizeof keys, list->rows[i].key);
    (void)usage_error(list->command, "--%s: there is no key '%s', only %s", list->option, key, keys);
    return false;
}

/* KEY=VALUE */
static bool take_pair(key_list_t *list, const char *pair, void *ctx)
{
    char key[MAX_KEY];
    const char *const value = next_word(pair, '=', key, sizeof key);
    size_t i = 0;
    while (i != list->count && strcmp(key, list->rows[i].key) != 0) i++;
    if (i == list->count) return no_key(list, key);
    const key_row_t *const row = &list->rows[i];
    if ((list->seen >> i & 1) != 0) {
        (void)usage_error(list->command, "--%s: %s is there twice", list->option, key);
        return false;
    }
    list->seen |= UINT32_C(1) << i;
    if (value != NULL && row->take(ctx, value)) return true;
    (void)usage_error(list->command, "--%s: %s= takes %s, not '%s'", list->option, key, row->takes,
                      value != NULL ? value : "");
    return false;
}

bool key_list(const char *command, const char *option, const char *list, const key_row_t *rows, size_t count,
              void *ctx)
{
    key_list_t keys = {.command = command, .option = option, .rows = rows, .count = count};
    if (list != NULL && strlen(list) >= MAX_LIST) {
        (void)usage_error(command, "--%s takes %d characters at most", option, MAX_LIST - 1);
        return false;
    }
    while (list != NULL) {
        char pair[MAX_LIST];
        list = next_word(list, ',', pair, sizeof pair);
        if (!take_pair(&keys, pair, ctx)) return false;
    }
    for (size_t i = 0; i != count; i++) {
        if (!rows[i].is_needed || (keys.seen >> i & 1) != 0) continue;
        (void)usage_error(command, "--%s: %s= is missing; it takes %s", option, rows[i].key, rows[i].takes);
        return false;
    }
    return true;
}
