/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TOOL_COMMISSION_BENCH_H
#define FATHOM_TESTS_TOOL_COMMISSION_BENCH_H

#include "tool_bench.h"

/* fathom commission at units as from the factory, each with its own number and its own response times. Each is
 * connected when the one before it has left address 1. */

enum { UNITS = 8, MOMENTS = 200, MS = 1000, SECOND = 1000000 };

/* The units of a test, in the order in which they are connected. */
typedef struct {
    union {
        fathom_sim_hps167s_t hps;
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
    } unit[UNITS];
    fathom_sim_device_t *device[UNITS];
    size_t count;
    size_t connected;
    void (*watch)(void); /* what else befalls the units: called whenever time has passed */
    uint32_t hand_us;    /* how long it takes to connect the next one; 100 ms */
    uint32_t left_us;    /* when the last one that is connected was at address 1 last */
    unsigned announced;  /* writes, in all runs */
    char record[64];
    uint32_t begin_us;
    uint32_t asked_us[MOMENTS]; /* when requests left, since begin_us */
    size_t asked;
} site_t;

extern site_t site;

/* An empty line, and no record; and the same as the set-up of a suite. */
void site_begin(void);
int site_set_up(void **state);
int site_tear_down(void **state);

/* Units that come at once or later: the first one is connected. */
void add_hps(fathom_sim_hps167s_config_t config);
void add_hps_units(size_t count);
void add_a16_units(size_t count);
void add_a05_units(size_t count);
void connect_next(void);

/* Runs it with the record. more: sensor, addresses, options. After each run it holds: of those that are connected no
 * two have one address; and no more was written than was announced. */
const tool_run_t *commission(const char *more);

/* It ended so, and said this. */
void expect(const tool_run_t *done, int status, const char *text);

unsigned count_of(const char *text, const char *what);
unsigned writes(void); /* to all units */

/* The text of the record. */
const char *record_text(void);
void write_record(const char *text);

#define TITLE "# fathom commission: which unit has which address, or is to have it\n"
#define FIRST "00390025423457142034383501060705" /* the UUID of the datasheet's example of #3 */

#endif
