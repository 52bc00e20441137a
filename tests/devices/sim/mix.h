/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_BENCH_MIX_H
#define FATHOM_BENCH_MIX_H

#include <stdbool.h>
#include <stdint.h>

/* The mix of examples/bus.c, an A16 and an A05 at 9600 8N1 beside an HPS-167S at 19200 8E1 on one simulated pair, and
 * what each gets of it. */

enum { MIX_A16 = 0, MIX_A05 = 1, MIX_HPS = 2, MIX_SENSORS = 3 };

typedef struct {
    uint32_t hps_period_us; /* 0: as fast as it can */
    uint32_t loop_us;       /* the main loop comes round so often; 0: it sleeps as long as it may */
    uint8_t absent;         /* bit: is not asked at all */
    uint8_t dead;           /* bit: is asked and has no power */
    bool processed;         /* the A16's value */
    bool fair;              /* by fair_share.h; else first come, first served */
} mix_t;

typedef struct {
    uint32_t responses;
    uint32_t failures;
    uint32_t
        line_us; /* the line was its own: from a request to the end of its response, or of its time-out */
    uint32_t longest_wait_us; /* from the moment a request could leave to its first bit */
} mix_share_t;

void mix_run(const mix_t *mix, uint32_t seconds, mix_share_t shares[MIX_SENSORS]);

#endif
