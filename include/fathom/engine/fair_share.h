/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FAIR_SHARE_H
#define FATHOM_FAIR_SHARE_H

#include "fathom/engine/line_turns.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Shares the time of a line fairly between units of different speed.
 *
 * Without this policy each unit gets one request in turn. A sensor that responds in 10 ms is then as slow as a sensor
 * beside it that needs half a second. With this policy the line sends the request of the unit that has used the line
 * least, so a fast unit gets many requests between two of a slow one. The policy never waits, and a line with one unit
 * does not need it. The cost is the RAM of fathom_fair_share_t and its functions, in programs that name it only.
 *
 * @code
 * static fathom_fair_share_t share;                         // must stay valid as long as the line
 * fathom_line_init(&line, &parts);
 * fathom_fair_share(&share, &line);
 * @endcode
 *
 * 1. **Used time.** A unit uses the line from the silence before its request until its response or its time-out. A unit
 *    that has no request does not save its time for later.
 *
 * 2. **Hold.** A fast unit submits its next request shortly after its response, so this request is not in the queue
 *    when the line becomes free. The policy therefore holds a request of a slow unit back, for a unit that has used
 *    less time. The hold time is 1/8 of the time that the slow unit used last, and at most 65 ms. It counts from the
 *    end of the last request of the fast unit. The policy holds only for a unit whose last request came within the hold
 *    time after the one before. The time in which the line was idle counts as used by the fast unit. A fast unit that
 *    stops delays one request once.
 *
 * 3. **Bound.** The longest time from the end of a unit's quarantine until its request leaves is
 *
 *        (n - 1) * (L + 2 H) + S
 *
 *    n is the number of units that have requests. L is the longest time that the line serves this unit without a break:
 *    silence, request and time-out. H is the longest hold time. S is the sum of those longest times of the other units.
 *    Each retry is a request of its own. If a unit has several requests, the bound applies to the first. The bound
 *    holds if no port is broken and no device sends without a request.
 *
 * 4. **Addresses.** Units whose addresses are equal modulo 16 share one share.
 */

/** @brief Number of shares of a line. */
enum {
    FATHOM_FAIR_SHARE_UNITS = 16 /**< A unit has the share (address modulo 16). */
};

/** @brief The share of one unit. All members belong to the policy. */
typedef struct {
    /** @brief Time that the unit has used more than the unit that has used least, in microseconds. */
    uint32_t ahead_us;

    /** @brief Clock at the end of the unit's last request, in microseconds. */
    uint32_t ended_us;

    /** @brief Time from the end of a request to the unit's next request, in microseconds. 65535: longer, or none. */
    uint16_t again_us;

    /** @brief Longest time for which a request of the unit is held back, in microseconds. */
    uint16_t hold_us;
} fathom_fair_share_unit_t;

/** @brief The policy, in the caller's memory. Serves one line. All members belong to the policy. */
typedef struct {
    /** @brief The policy as the line knows it. Invariant: the first member, so that one pointer is both. */
    fathom_line_turns_t turns;

    /** @brief The shares. */
    fathom_fair_share_unit_t units[FATHOM_FAIR_SHARE_UNITS];

    /** @brief The unit for which a request is held back. NULL: none is. */
    fathom_fair_share_unit_t *held_for;

    /** @brief Clock up to which the used time is counted, in microseconds. */
    uint32_t since_us;
} fathom_fair_share_t;

/**
 * @brief Shares the time of a line from now on. Call once, after fathom_line_init(). All units start with no used time.
 *
 * @param share  The policy. Must stay valid as long as the line. Its contents are overwritten.
 * @param line   The line, initialised.
 */
void fathom_fair_share(fathom_fair_share_t *share, fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
