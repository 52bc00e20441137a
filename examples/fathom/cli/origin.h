/* SPDX-License-Identifier: MIT */
#ifndef ORIGIN_H
#define ORIGIN_H

#include <stdbool.h>
#include <stddef.h>

/* Where a text stands that the user wrote: on the command line, or in a line of a file. */
typedef struct {
    const char *command; /* NULL: no command is known yet */
    const char *file;    /* NULL: the command line */
    unsigned line;       /* of the file, from 1 */
    const char *within;  /* the option, or the word, whose keys are read; NULL: none */
    bool is_option;      /* `within` is an option */
} origin_t;

/* Prints one message to standard error: where, what is wrong, what to try. Returns false. */
bool reject(const origin_t *origin, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The name that is nearest to a word that is none of them. Start with {.word = word}, and try every name. */
typedef struct {
    const char *word;
    const char *name; /* NULL: no name is near enough to be meant */
    size_t distance;
} nearest_t;

void nearest_try(nearest_t *nearest, const char *name);

/* Rejects the word of `nearest`, which is no WHAT ("sensor", "key"): with the nearest name if there is one, else with
 * all that are `known` ("a16, a05"; NULL: they are too many). `mark` stands before names ("--" or ""). False. */
bool reject_unknown(const origin_t *origin, const char *what, const char *mark, const nearest_t *nearest,
                    const char *known);

#endif
