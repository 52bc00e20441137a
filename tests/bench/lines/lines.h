/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_LINES_H
#define FATHOM_TEST_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/hal.h"

/* Many lines with an HPS-167S on each, read by several ways of a program; what they share. */

enum { LINES_MOST = 256, LINES_PATH = 32, LINES_UNIT = 1, LINES_BAUD = 19200, LINES_TIMEOUT_S = 2 };

/* What is behind a pty responds at once. The distance tells which line it is and how many responses it has sent: two
 * lines that were mixed up, and a response that was lost or came twice, are seen. */
enum { LINES_FIRST_MM = 1000, LINES_RESPONSES = 16 };

/* What was read on a line. Its reader writes it, and another thread may look at it. */
typedef struct {
    unsigned line;
    unsigned number; /* of the last one; LINES_RESPONSES: none yet */
    uint32_t right;
    uint32_t wrong;
} lines_seen_t;

/* One measurement: each line is read once a period. */
typedef struct {
    unsigned count;
    bool is_spread; /* the lines begin one after another, evenly over the period; else all at once */
    uint32_t period_us;
    uint32_t window_us;        /* what is measured; it begins when all lines have been read a few times */
    char (*paths)[LINES_PATH]; /* of the ptys */
    lines_seen_t seen[LINES_MOST];
} lines_job_t;

typedef struct {
    uint64_t time_us;
    uint64_t user_us; /* of this process, all of its threads */
    uint64_t system_us;
    uint32_t right;
    uint32_t wrong;
} lines_mark_t;

typedef struct {
    const char *name;
    /* Reads for the warm-up and the window; marks[0] is set when the window begins, marks[1] when it ends. */
    bool (*run)(lines_job_t *job, lines_mark_t marks[2]);
} lines_way_t;

extern const lines_way_t lines_loop;  /* fathom_loop.h: one thread, which polls what is ready or due */
extern const lines_way_t lines_every; /* one thread, which polls all sensors whenever anything has happened */
extern const lines_way_t lines_libmodbus; /* libmodbus, a thread a line */

/* The far end of every line, in a process of its own, which ends with this one. False: why is on stderr. */
bool lines_begin_far_end(unsigned count, char (*paths)[LINES_PATH]);

/* One reading is there; 0 stands for a failure. */
void lines_see(lines_seen_t *seen, unsigned distance_mm);

void lines_mark(const lines_job_t *job, lines_mark_t *mark);
uint64_t lines_now_us(void);

/* When line n is to be read first, after the beginning; and how long after that all have been read a few times. */
uint32_t lines_first_us(const lines_job_t *job, unsigned n);
uint32_t lines_warm_us(const lines_job_t *job);

extern const fathom_line_settings_t lines_settings;

#endif
