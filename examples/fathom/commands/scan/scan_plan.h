/* SPDX-License-Identifier: MIT */
#ifndef SCAN_PLAN_H
#define SCAN_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

/*
 * What a scan asks, and how long that takes. The order is: each line setting in turn, in it each address in turn.
 */
enum { SCAN_RATES = 6, SCAN_PARITIES = 3, SCAN_SETTINGS = SCAN_RATES * SCAN_PARITIES };

typedef struct {
    fathom_line_settings_t settings[SCAN_SETTINGS];
    uint32_t timeout_us; /* of every probe; 0: the defaults below */
    uint32_t listen_us;  /* before the first request */
    uint8_t setting_count;
    uint8_t first; /* address */
    uint8_t last;
    uint8_t repeats; /* how often a silent address is asked again */
} scan_plan_t;

/* The sensors' factory settings, as lines of a plan and to tell them from others. */
extern const fathom_line_settings_t scan_dyp_line;     /* A16, A05: 9600 8N1 */
extern const fathom_line_settings_t scan_hps167s_line; /* 19200 8E1 */

/* The parity that a sensor with this rate has from the factory: none at 9600, even at the others, which an HPS-167S
 * keeps at all its rates (HPS-167S 2.2.2). */
uint8_t scan_factory_parity(uint32_t baud);

bool scan_is_dyp_line(const fathom_line_settings_t *line);

/*
 * How long an address may take for the first byte of its response.
 *
 * 100 ms: an HPS-167S needs 2.5 to 20 ms, a USB adapter may hold bytes back for 16. 150 ms where A16 and A05 are: no
 * figure is printed, and a module that has just begun a measurement of 110 ms (A16 1) may want to finish it. What
 * comes later than that is heard while the next address is asked, and its sender is asked again.
 */
enum { SCAN_TIMEOUT_US = 100000, SCAN_DYP_TIMEOUT_US = 150000 };
uint32_t scan_timeout_us(const scan_plan_t *plan, const fathom_line_settings_t *line);

/* The silence before a request, of the slowest line of the plan: who is slower than the host has to see it too. */
uint16_t scan_silence_us(const scan_plan_t *plan);

/* What one silent address takes, and all of it if none answers. A device that answers adds SCAN_FOUND_US at most. */
enum { SCAN_FOUND_US = 1500000 };
uint32_t scan_probe_us(const scan_plan_t *plan, const fathom_line_settings_t *line);
uint64_t scan_plan_us(const scan_plan_t *plan);

/* How many addresses the plan has. */
uint32_t scan_addresses(const scan_plan_t *plan);

/* The request to any A05 by 55 AA, which the line of A16 and A05 gets besides. It waits until no unit is in
 * quarantine, and after it any may be: so it takes three time-outs. */
enum { SCAN_ANY_TIMEOUT_US = 300000 };
uint32_t scan_any_us(const scan_plan_t *plan);

#endif
