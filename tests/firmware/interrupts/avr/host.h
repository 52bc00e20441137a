/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_INTERRUPTS_HOST_H
#define FATHOM_TEST_INTERRUPTS_HOST_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "calls.h"

/*
 * One path of the port (a call, with what is there when it begins), broken into at each of its instruction boundaries:
 *
 *   scenarios.c  the paths
 *   events.c     what may happen, so that an interrupt comes
 *   run.c        one run, from the image's begin to what came of it
 *   outcome.c    what came of it: all that the main loop, the wire and the pins can see
 *   rules.c      what has to hold whatever came first: no byte lost, no time wrong, driver on around each byte
 *   serial.c     the same events one after the other, by really running them, and the comparison
 *   enumerate.c  the boundaries; fork(2) is the snapshot
 */

/* ---- events ---- */

typedef enum {
    EVENT_NONE,
    EVENT_BYTE,   /* one has come */
    EVENT_FLAWED, /* one has come with wrong parity and no stop bit */
    EVENT_BEHIND, /* one has come behind some that the USART has lost */
    EVENT_LEFT,   /* a character has left: data register empty, or transmit complete */
    EVENT_LATE,   /* two have, while interrupts were held back: data register empty and transmit complete */
    EVENT_INT0,   /* the other level at PD2 */
    EVENT_ICP1,   /* the other level at PB0 */
    EVENT_OVERFLOW, /* of Timer1: comes of itself at a cycle, since scenario_run has moved all the rest against it */
    EVENTS
} event_t;

extern const char *const event_names[EVENTS];

enum { MOST_BYTES = 80, MOST_EDGES = 16, MOST_SENT = 16 };

/* What has happened so far, by the one who did it. */
typedef struct {
    uint8_t bytes[MOST_BYTES], flags[MOST_BYTES], count; /* that came */
    uint8_t sent[MOST_SENT], sent_count, requests;       /* that were taken from the main loop */
    bool has_break;                                      /* which turns the driver on and off, too */
    uint64_t edge_cycles[2][MOST_EDGES];                 /* at PD2 and PB0, which are low to begin with */
    uint8_t edges[2];
    uint64_t zero_cycle; /* when the clock was zero_us */
    uint32_t zero_us;
} truth_t;
extern truth_t truth;

void truth_begin(uint32_t zero_us);
uint32_t truth_us(uint64_t cycle);
uint64_t truth_overflow_cycle(void); /* the next one */

/* It happens, as number 0 or 1 of its run; false: it could not (no character leaves). Not for EVENT_OVERFLOW. */
bool event_raise(event_t event, uint8_t number);
void event_byte(uint8_t byte, uint8_t flags);
void event_edge(uint8_t which);
/* Is this the vector of its interrupt? */
bool event_has_vector(event_t event, uint8_t vector);

/* ---- scenarios ---- */

enum { MOST_EVENTS = 8 };

typedef struct {
    const char *name;
    uint8_t call, length, which, flags;
    uint8_t is_masked;         /* as calls_t has it */
    uint8_t parity, stop_bits; /* for set_line, with baud */
    bool may_drop;             /* a byte may find the ring full */
    uint16_t baud;
    uint16_t gather_us; /* for idle, with most_us */
    uint32_t most_us;
    uint32_t zero_us;            /* of the clock: a multiple of a period of Timer1 */
    void (*prepare)(void);       /* or NULL */
    event_t events[MOST_EVENTS]; /* alone, and two together; EVENT_NONE behind the last */
    event_t pairs[MOST_EVENTS];  /* those that are put at all pairs of boundaries, where depth_t has them */
} scenario_t;

extern const scenario_t scenarios[];
extern const unsigned scenario_count;
/* Does the call of this run begin with edges once more? */
bool scenario_begins(void);

/* ---- a run ---- */

enum { LOG = 200, NO_PULSE = 0xEE /* in the log; no byte that comes is that */ };

/* Cleared before it is filled, so that memcmp tells. */
typedef struct {
    int16_t result;
    uint8_t log_length, log[LOG]; /* reads: count, flags, bytes; pulses: which of them, level */
    uint16_t counters[3];
    uint8_t wire_length, wire[MOST_SENT];
    uint8_t driver_edges, rises[2], missed[2], lost[2], port_b, port_d, direction_d, is_sent;
} outcome_t;

typedef struct {
    event_t event;
    bool has_raised, has_entered, could_enter;
    uint64_t cycle;
    uint32_t raised_step, entered_step;
    uint16_t address; /* of the instruction before which it came */
} raised_t;

typedef struct {
    const scenario_t *scenario;
    raised_t raised[2];
    uint8_t raises;
    bool is_armed, is_in_path, has_ended;
    bool is_pair;                    /* the second has been put at a boundary of its own */
    uint32_t step;                   /* of the processor */
    uint64_t begin_cycle, end_cycle; /* of the path */
    uint8_t left[2];                 /* characters that had not left at its begin and its end */
    calls_t returned;
    outcome_t outcome;
} run_t;
extern run_t run;

/* What happens outside of the path, and when: 0 and 1 before it, 2 and 3 after it. Two in one slot come together. */
enum { SLOTS_BEFORE = 2, SLOTS = 4 };
typedef struct {
    event_t events[2];
    uint8_t slots[2];
} order_t;

/* From the image's begin to the outcome. `order`: or NULL. overflow_cycle: when Timer1 overflows, in cycles of the run
 * without that; 0: it does not. at_overflow: what happens in that instant, too. */
void scenario_run(const scenario_t *scenario, const order_t *order, uint64_t overflow_cycle,
                  event_t at_overflow);
/* In the observer, before an instruction of the path: it happens at the boundary behind that one. */
void run_raise(event_t event);
/* The same, at the boundary before it. */
void run_raise_here(event_t event);
/* To be called at each boundary of a path, before its next instruction. */
extern void (*run_boundary)(void);

/* The image is told to call the port, outside of the path, and does. */
volatile calls_t *image_calls(void);
void image_call(uint8_t call);
void image_run(uint64_t cycles);

void outcome_take(void);
/* What is wrong whatever the serial orders say, or NULL. */
const char *rules_check(void);
/* Is there nothing to compare, because the header lets go of what came while the path ran? */
bool rules_are_all(void);

/* ---- shared by all processes of a scenario ---- */

enum { SERIALS = 8, MOST_BOUNDARIES = 6000, WORDS = 0x4000 };

typedef struct {
    outcome_t outcomes[SERIALS];
    uint8_t count;
} serial_t;

typedef struct {
    /* The path alone: its instructions, from the report of its begin to that of its end. */
    uint32_t length;
    uint16_t pcs[MOST_BOUNDARIES];
    uint64_t cycles[MOST_BOUNDARIES]; /* at their begin */
    uint64_t window_cycle;            /* when what comes before it may begin */
    serial_t alone[EVENTS], two[EVENTS][EVENTS];
    uint8_t executed[WORDS], covered[WORDS]; /* by address / 2: carried out, and broken into before it */
    uint32_t boundaries, singles, deferred, together, pairs, nothing, wrongs, complaints;
} shared_t;
extern shared_t *shared;

/* Fills shared->alone or shared->two, unless that has been done. second: EVENT_NONE for one alone. */
void serial_compute(const scenario_t *scenario, event_t first, event_t second);
/* Says what is wrong with this run. */
void serial_compare(void);

/* The cycle of a slot, in the run of the path alone. */
uint64_t slot_cycle(uint8_t slot);

/* How far: each event alone; two together as well; two at each pair of boundaries as well. */
typedef enum { DEPTH_ALONE = 1, DEPTH_TOGETHER, DEPTH_PAIRS } depth_t;

/* Runs all of that; false: something was wrong. */
bool enumerate(const scenario_t *scenario, depth_t depth);

/* Two processes from here on; the first one waits for the other, and goes on with false. */
bool fork_here(void);

#endif
