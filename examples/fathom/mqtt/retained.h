/* SPDX-License-Identifier: MIT */
#ifndef RETAINED_H
#define RETAINED_H

#include <stdbool.h>

/* A list of topics. */
typedef struct retained retained_t;
struct retained {
    retained_t *next;
    char topic[];
};

/* False: there is no memory left. */
bool retained_add(retained_t **list, const char *topic);
void retained_remove(retained_t **list, const char *topic);
void retained_end(retained_t **list);

#endif
