/* SPDX-License-Identifier: MIT */
#ifndef KEY_LIST_H
#define KEY_LIST_H

#include <stdbool.h>
#include <stddef.h>

/* One of the keys that the value of an option may have, as in --level mounting=2300,height=2000. */
typedef struct {
    const char *key;
    const char *takes; /* what a value is, in words: "on or off" */
    /* False: it is none. */
    bool (*take)(void *ctx, const char *value);
    bool is_needed;
} key_row_t;

/* Reads KEY=VALUE,KEY=VALUE and so on, each key once; list: of --OPTION, NULL: an empty one. False after a usage error
 * that says which key is wrong, or missing. At most 32 rows. */
bool key_list(const char *command, const char *option, const char *list, const key_row_t *rows, size_t count,
              void *ctx);

#endif
