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

/* Returns the factory settings of the sensors that send automatically. */
const fathom_line_settings_t *scan_listen_line(void);

/* Returns the factory parity of a sensor that has this rate: none at 9600, even at the others, which an HPS-167S keeps at
 * all its rates (HPS-167S 2.2.2). */
uint8_t scan_factory_parity(uint32_t baud);

/* Returns true if these are the factory settings of a sensor with frames 55 AA. */
bool scan_has_dyp(const fathom_line_settings_t *line);

/*
 * Returns the time-out of an address: that of the plan, the longest of the models that have these factory settings
 * (model_t.scan), or the default. An HPS-167S needs 2.5 to 20 ms, and a USB adapter may delay bytes by 16 ms. A later
 * response is heard while the next address is asked, and its sender is asked again.
 */
enum { SCAN_TIMEOUT_US = 100000 };
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
