/* SPDX-License-Identifier: MIT */
#include "trace.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "board.h"

enum { WORDS = 16384, WAYS = 2 }; /* 32 KiB of flash */

static uint16_t led_to[WORDS][WAYS]; /* words, and 1 more: 0 is none */
static char image_path[512];
static const char *folder;
static unsigned runs;

void trace_begin(const char *image)
{
    folder = getenv("FATHOM_TRACE");
    if (folder == NULL) return;
    (void)snprintf(image_path, sizeof image_path, "%s", image);
    memset(led_to, 0, sizeof led_to);
}

void trace_step(uint32_t from, uint32_t to)
{
    if (folder == NULL || from / 2 >= WORDS) return;
    const uint16_t place = (uint16_t)(to / 2 + 1);
    for (int way = 0; way != WAYS; way++) {
        if (led_to[from / 2][way] == place) return;
        if (led_to[from / 2][way] != 0) continue;
        led_to[from / 2][way] = place;
        return;
    }
}

void trace_end(void)
{
    char path[512];
    if (folder == NULL) return;
    (void)snprintf(path, sizeof path, "%s/avr-%ld-%u.trace", folder, (long)getpid(), runs++);
    FILE *const file = fopen(path, "w");
    if (file == NULL) board_give_up("%s cannot be written", path);
    (void)fprintf(file, "%s\n", image_path);
    for (unsigned word = 0; word != WORDS; word++)
        for (int way = 0; way != WAYS && led_to[word][way] != 0; way++)
            (void)fprintf(file, "%x %x\n", 2 * word, 2u * (led_to[word][way] - 1u));
    (void)fclose(file);
}
