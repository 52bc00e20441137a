/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FAIR_SHARE_H
#define FATHOM_FAIR_SHARE_H

#include "fathom/engine/line_turns.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A fair share of a line's time for units of different speed. First come, first served gives each unit one request in
 * turn: a sensor that responds in 10 ms is then as slow as the one beside it that takes half a second. Here they share
 * time, not turns: of the requests that could leave, the one goes whose unit has used the line least lately, so that
 * the fast one gets many requests between two slow ones.
 *
 *     static fathom_fair_share_t share;
 *     fathom_fair_share(&share, &line);      after fathom_line_init
 *
 * A unit has used the line from the silence before its request until its response, or its time-out. What it did not use
 * while it had no request is not kept for it.
 *
 * A fast unit whose next request comes a moment after its response is not in the queue when the line becomes free. So a
 * request that takes long is held back for it, and the unit for which the line stood idle has used that time as well:
 *  - only for a unit that has used less, and whose last request came within the hold time after the end of the one
 *    before;
 *  - for no longer than the hold time after the end of that unit's last request. The hold time is 1/8 of what the
 *    request's own unit used last, and never over 65 ms.
 * So an idle line is part of a unit's fair share, never more; and a unit whose requests stop delays one request once.
 *
 * The longest wait of a request, from when its unit is not quarantined until it leaves, where no port is broken and no
 * device sends by itself:
 *
 *     (n - 1) * (L + 2 H) + S
 *
 * n units have requests; L is the longest that the line can be this unit's at a stretch (silence, request, time-out), H
 * the longest hold time, S the sum of the others' longest. Retries are requests of their own. Of several requests of
 * one unit that is the wait of the first.
 *
 * Units that are equal modulo 16 share one share. A line with one unit needs none of this.
 */
enum { FATHOM_FAIR_SHARE_UNITS = 16 };

typedef struct {
    uint32_t ahead_us; /* what it has used more than the one that had used least */
    uint32_t ended_us; /* the clock when its last request ended */
    uint16_t again_us; /* its next request came so soon after; 65535: later, or none yet */
    uint16_t hold_us;  /* a request of it is held back for so long at most */
} fathom_fair_share_unit_t;

/* The caller's; outlives the line, of which it serves one. */
typedef struct {
    fathom_line_turns_t turns; /* first, so that one pointer is both */
    fathom_fair_share_unit_t units[FATHOM_FAIR_SHARE_UNITS];
    fathom_fair_share_unit_t *held_for; /* NULL: nothing is held back */
    uint32_t since_us;                  /* up to here the time is counted */
} fathom_fair_share_t;

/* The line's time is shared from here on; all have used nothing. After fathom_line_init, once. */
void fathom_fair_share(fathom_fair_share_t *share, fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
