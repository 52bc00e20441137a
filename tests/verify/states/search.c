/* SPDX-License-Identifier: MIT */
#include "search.h"

#include <stdlib.h>
#include <string.h>

/*
 * Breadth first, so that the way to a state is a shortest one. States are compared whole; the hash only finds them. Each
 * is kept with the step that led to it and the state before.
 */

enum { PER_BLOCK = 1 << 16, NO_STATE = UINT32_MAX };

static uint8_t *blocks[1 << 12];
static uint32_t *parents;
static uint8_t *steps;
static uint32_t *table;
static uint32_t table_mask;
static uint32_t most_states;
figures_t figures;

graph_t graph;

uint8_t *state_at(uint32_t index) { return blocks[index / PER_BLOCK] + (size_t)(index % PER_BLOCK) * PACKED; }

static void *get(size_t count, size_t size)
{
    void *const memory = calloc(count, size);
    if (memory == NULL) {
        fprintf(stderr, "no memory\n");
        exit(2);
    }
    return memory;
}

static uint64_t hash_of(const uint8_t *state)
{
    uint64_t hash = 0x9E3779B97F4A7C15u;
    for (int i = 0; i != PACKED; i += 8) {
        uint64_t word;
        memcpy(&word, state + i, sizeof word);
        hash = (hash ^ word) * 0xFF51AFD7ED558CCDu;
        hash ^= hash >> 32;
    }
    return hash;
}

/* The number of a state; a new one is given to it where there was none. */
static uint32_t find(const uint8_t *state, bool *is_new)
{
    uint32_t at = (uint32_t)hash_of(state) & table_mask;
    for (; table[at] != 0; at = (at + 1) & table_mask) {
        if (memcmp(state_at(table[at] - 1), state, PACKED) != 0) continue;
        *is_new = false;
        return table[at] - 1;
    }
    *is_new = true;
    const uint32_t index = figures.states++;
    if (index == most_states) {
        fprintf(stderr, "more than %lu states\n", (unsigned long)most_states);
        exit(2);
    }
    if (index % PER_BLOCK == 0) blocks[index / PER_BLOCK] = get(PER_BLOCK, PACKED);
    memcpy(state_at(index), state, PACKED);
    table[at] = index + 1;
    return index;
}

/* Steps that no program and no broken port takes: time, polls, and all that is on the wire. */
static bool is_left_alone(int step)
{
    return step == TICK || step == POLL || step == POLL_DRAWN || step == PAUSE ||
           (step >= RESPOND && step <= ANSWER);
}

static void add_edge(uint32_t to, int step)
{
    if (graph.edges == graph.space) {
        graph.space = graph.space != 0 ? 2 * graph.space : 1 << 20;
        graph.to = realloc(graph.to, graph.space * sizeof *graph.to);
        if (graph.to == NULL) exit(2);
    }
    graph.to[graph.edges++] = to | (step == TICK ? IS_TICK : 0u);
}

static void print_way(uint32_t index, int last, const char *broken)
{
    uint32_t length = 0;
    for (uint32_t at = index; at != 0; at = parents[at]) length++;
    uint8_t *const way = get(length + 1, 1);
    uint32_t left = length;
    for (uint32_t at = index; at != 0; at = parents[at]) way[--left] = steps[at];
    uint8_t first[PACKED];
    memcpy(first, state_at(0), PACKED);
    unpack(first);
    unsigned long ticks = 0;
    if (last >= 0) way[length++] = (uint8_t)last;
    printf("  ticks  what happens                                        afterwards\n");
    for (uint32_t i = 0; i != length; i++) {
        ticks += way[i] == TICK;
        world_t before = world;
        const char *const found = carry_out(way[i]);
        printf("  %5lu  ", ticks);
        describe(way[i], &before, stdout);
        if (found == NULL) {
            uint8_t state[PACKED];
            pack(state);
            unpack(state);
        }
    }
    if (broken != NULL) printf("  BROKEN: %s\n", broken);
    free(way);
}

/* All that may come of one state. False: a promise was broken. */
static bool expand(uint32_t index)
{
    static world_t from; /* a line's pointers go to `world`, into which it is copied back */
    bool asked_port = false;
    bool set_port = false;
    unpack(state_at(index));
    from = world;
    graph.first[index] = graph.edges;
    bool is_waiting = false;
    for (int i = 0; i != TRANSACTIONS; i++) is_waiting = is_waiting || is_queued(i);
    for (int step = 0; step != STEPS; step++) {
        if ((step == POLL_WRITE_FAILS || step == POLL_WRITE_BUSY) && !asked_port) continue;
        if ((step == POLL_SET_BUSY || step == POLL_SET_FAILS) && !set_port) continue;
        if (!is_possible(step)) continue;
        const char *const broken = carry_out(step);
        figures.transitions++;
        if (broken != NULL) {
            print_way(index, step, broken);
            return false;
        }
        if (step == POLL) {
            asked_port = effect.asked_port;
            set_port = effect.set_port;
        }
        for (int i = 0; i != TRANSACTIONS; i++)
            if (effect.ended[i] != FATHOM_PENDING) figures.ends[-effect.ended[i] + 1]++;
        figures.late += effect.counted[FATHOM_LINE_LATE_RESPONSES];
        figures.requests += effect.sent >= 0;
        if (world.others > figures.others) figures.others = world.others;
        uint8_t state[PACKED];
        bool is_new;
        pack(state);
        const uint32_t to = find(state, &is_new);
        if (is_new) {
            parents[to] = index;
            steps[to] = (uint8_t)step;
        }
        if (is_waiting && to != index && is_left_alone(step)) add_edge(to, step);
        world = from;
    }
    return true;
}

bool search(uint32_t most)
{
    most_states = most;
    uint32_t slots = 1;
    while (slots < most + most / 2) slots *= 2;
    table_mask = slots - 1;
    table = get(slots, sizeof *table);
    parents = get(most, sizeof *parents);
    steps = get(most, sizeof *steps);
    graph.first = get((size_t)most + 1, sizeof *graph.first);
    uint8_t state[PACKED];
    bool is_new;
    world_begin();
    pack(state);
    unpack(state);
    (void)find(state, &is_new);
    uint32_t index = 0;
    for (uint32_t level_end = 1; index != figures.states; figures.levels++, level_end = figures.states)
        for (; index != level_end; index++)
            if (!expand(index)) return false;
    graph.first[index] = graph.edges;
    figures.levels--; /* the last one has found nothing new */
    return true;
}

void print_state(uint32_t index) { print_way(index, -1, NULL); }
