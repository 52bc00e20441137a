/* SPDX-License-Identifier: MIT */
#include "mqtt/retained.h"

#include <stdlib.h>
#include <string.h>

bool retained_add(retained_t **list, const char *topic)
{
    const size_t size = strlen(topic) + 1;
    retained_t *const one = malloc(sizeof *one + size);
    if (one == NULL) return false;
    memcpy(one->topic, topic, size);
    one->next = *list;
    *list = one;
    return true;
}

void retained_remove(retained_t **list, const char *topic)
{
    retained_t **at = list;
    while (*at != NULL && strcmp((*at)->topic, topic) != 0) at = &(*at)->next;
    if (*at == NULL) return;
    retained_t *const one = *at;
    *at = one->next;
    free(one);
}

void retained_end(retained_t **list)
{
    while (*list != NULL) {
        retained_t *const one = *list;
        *list = one->next;
        free(one);
    }
}
