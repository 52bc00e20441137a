/* SPDX-License-Identifier: MIT */
#include "search.h"

#include <stdlib.h>

/*
 * Does each transaction end, whatever is on the wire? If nothing more is submitted or cancelled, the port works and the
 * program polls, the states in which something is queued must form no circle. Then the longest way through them is the
 * time that a transaction takes at most.
 */

enum { UNSEEN, OPEN, DONE };

static uint32_t *longest;
static uint8_t *seen;
static uint32_t *stack;
static uint64_t *next;

bool all_end(void)
{
    longest = calloc(figures.states, sizeof *longest);
    seen = calloc(figures.states, 1);
    stack = calloc(figures.states, sizeof *stack);
    next = calloc(figures.states, sizeof *next);
    if (longest == NULL || seen == NULL || stack == NULL || next == NULL) exit(2);
    for (uint32_t root = 0; root != figures.states; root++) {
        if (seen[root] != UNSEEN) continue;
        uint32_t depth = 1;
        stack[0] = root;
        next[0] = graph.first[root];
        seen[root] = OPEN;
        while (depth != 0) {
            const uint32_t at = stack[depth - 1];
            if (next[depth - 1] == graph.first[at + 1]) {
                seen[at] = DONE;
                if (--depth == 0) break;
                const uint32_t edge = graph.to[next[depth - 1] - 1];
                const uint32_t way = longest[at] + (edge >> 31);
                if (way > longest[stack[depth - 1]]) longest[stack[depth - 1]] = way;
                continue;
            }
            const uint32_t edge = graph.to[next[depth - 1]++];
            const uint32_t to = edge & ~IS_TICK;
            if (seen[to] == OPEN) {
                print_state(at);
                printf("  BROKEN: from here it comes back here, and a transaction never ends\n");
                return false;
            }
            if (seen[to] == DONE) {
                if (longest[to] + (edge >> 31) > longest[at]) longest[at] = longest[to] + (edge >> 31);
                continue;
            }
            seen[to] = OPEN;
            stack[depth] = to;
            next[depth++] = graph.first[to];
        }
        if (longest[root] > figures.longest) figures.longest = longest[root];
    }
    return true;
}
