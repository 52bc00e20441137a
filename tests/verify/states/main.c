/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "search.h"

/* states [MOST-STATES] WORD=NUMBER ...: the words of options_t. Prints a line of figures, or the way to what is broken;
 * its exit status is 0, or 1. */

typedef struct {
    const char *word;
    int *value;
} word_t;

static const word_t words[] = {{"dyp", &options.dyp},
                               {"transactions", &options.transactions},
                               {"retries1a", &options.retries[0]},
                               {"retries1b", &options.retries[1]},
                               {"retries2a", &options.retries[2]},
                               {"retries2b", &options.retries[3]},
                               {"timeout1", &options.timeout[0]},
                               {"timeout2", &options.timeout[1]},
                               {"silence", &options.silence},
                               {"gap", &options.gap},
                               {"leave", &options.leave},
                               {"poll", &options.poll},
                               {"over", &options.over},
                               {"takes", &options.takes},
                               {"echo", &options.echo},
                               {"exception", &options.exception},
                               {"damaged", &options.damaged},
                               {"unexpected", &options.unexpected},
                               {"piece", &options.piece},
                               {"crowd", &options.crowd},
                               {"halves", &options.halves},
                               {"foreign", &options.foreign},
                               {"stream", &options.stream},
                               {"own", &options.own},
                               {"noise", &options.noise},
                               {"asks", &options.asks},
                               {"senders", &options.senders},
                               {"masters", &options.masters},
                               {"busy", &options.busy},
                               {"cancel", &options.cancel},
                               {"cancel_unit", &options.cancel_unit},
                               {"read_fails", &options.read_fails},
                               {"write_fails", &options.write_fails},
                               {"write_busy", &options.write_busy},
                               {"set_line", &options.set_line},
                               {"watched", &options.watched}};

static bool set(const char *argument)
{
    const char *const equals = strchr(argument, '=');
    if (equals == NULL) return false;
    for (size_t i = 0; i != sizeof words / sizeof *words; i++)
        if (strlen(words[i].word) == (size_t)(equals - argument) &&
            strncmp(words[i].word, argument, (size_t)(equals - argument)) == 0) {
            *words[i].value = atoi(equals + 1);
            return true;
        }
    return false;
}

int main(int argc, char **argv)
{
    uint32_t most = 4000000;
    for (int i = 1; i != argc; i++) {
        if (i == 1 && atol(argv[i]) != 0)
            most = (uint32_t)atol(argv[i]);
        else if (!set(argv[i])) {
            fprintf(stderr, "%s: no such word\n", argv[i]);
            return 2;
        }
    }
    if (!search(most) || !all_end()) return 1;
    printf("states %lu transitions %llu levels %lu longest %lu others %u requests %llu late %llu",
           (unsigned long)figures.states, (unsigned long long)figures.transitions,
           (unsigned long)figures.levels, (unsigned long)figures.longest, figures.others,
           (unsigned long long)figures.requests, (unsigned long long)figures.late);
    for (int i = 0; i != ENDS; i++)
        if (figures.ends[i] != 0)
            printf(" %s %llu", fathom_status_name((fathom_status_t)(1 - i)),
                   (unsigned long long)figures.ends[i]);
    printf("\n");
    return 0;
}
