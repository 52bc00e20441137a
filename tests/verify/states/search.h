/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_STATES_SEARCH_H
#define FATHOM_TESTS_STATES_SEARCH_H

#include "world.h"

enum { ENDS = 2 - FATHOM_ERR_OTHER_MASTER };

typedef struct {
    uint32_t states, levels;
    uint64_t transitions;
    uint64_t requests;   /* transitions with which a request left */
    uint64_t late;       /* and with which a late response was counted */
    uint64_t ends[ENDS]; /* by 1 - status */
    unsigned others;     /* requests of others before that of the watched transaction, at most */
    uint32_t longest;    /* ticks until all have ended, where the line is left alone, at most */
} figures_t;

extern figures_t figures;

/* Of the states in which something is queued, the steps with which the line goes on by itself. */
#define IS_TICK UINT32_C(0x80000000)
typedef struct {
    uint32_t *to;    /* a state, and IS_TICK */
    uint64_t *first; /* of each state, into `to` */
    uint64_t edges, space;
} graph_t;

extern graph_t graph;

uint8_t *state_at(uint32_t index);

/* All states, at most so many. False: a promise was broken, and the way there was printed. */
bool search(uint32_t most);

/* Does all end, from each state? figures.longest; false: not, and the way to such a state was printed. */
bool all_end(void);

/* The way to a state. */
void print_state(uint32_t index);

#endif
