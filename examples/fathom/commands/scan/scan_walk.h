/* SPDX-License-Identifier: MIT */
#ifndef SCAN_WALK_H
#define SCAN_WALK_H

#include "commands/scan/scan_ask.h"
#include "commands/scan/scan_plan.h"
#include "sensors/finding.h"

/* What a walk tells its owner. */
typedef struct {
    /* At once, but what needs a look at all addresses of a line setting comes when these have been asked. */
    void (*found)(void *ctx, const scan_finding_t *finding);
    /* done_us of scan_plan_us() have been walked; line and address are asked next. */
    void (*progress)(void *ctx, uint64_t done_us, const fathom_line_settings_t *line, uint8_t address);
    /* The port cannot do these settings; they are left out. */
    void (*unsupported)(void *ctx, const fathom_line_settings_t *line);
    void *ctx;
} scan_tell_t;

/* What was heard besides, for advice; since the walk began. */
typedef struct {
    uint32_t bytes;         /* all but echo */
    uint32_t echoes;        /* of what was asked */
    uint8_t outside;        /* an address beyond the plan's from which a frame came; 0: none */
    uint8_t master_address; /* another master asks it, ... */
    bool has_master;        /* ... if there is one */
    /* Addresses, counted at each line setting, that could not be asked: the line was busy, or another master asked. */
    uint32_t not_asked;
    bool has_other_master; /* it asked one of these */
} scan_heard_t;

enum { SCAN_ADDRESSES = 256 };

typedef struct {
    const scan_wire_t *wire;
    const scan_plan_t *plan;
    const scan_tell_t *tell;
    bool has_sender; /* a device sends by itself: bytes that come unasked are no sign of another one */
    scan_heard_t heard;

    /* the walk's own */
    uint64_t done_us;
    bool has_a05;
    uint32_t found_baud[SCAN_ADDRESSES]; /* of the device found at an address; 0: none */
    uint8_t states[SCAN_ADDRESSES];      /* at the present line settings */
    uint16_t busy_in_row;                /* addresses that a busy line kept from being asked, in a row */
    uint16_t garbled;                    /* of these, ... */
    uint16_t asked;                      /* ... and so many were asked */
} scan_walk_t;

/*
 * Asks what the plan says: first a probe of each address, then, where a device answers, what it is.
 *
 *  - A response that comes too late is heard while another address is asked, and its sender is asked again with a long
 *    time-out.
 *  - Bytes that are no frame, or a damaged one, make it ask again; if that happens each time, the address is
 *    DAMAGED. If more than half of the addresses are, and no response was whole, it is NOT_MODBUS.
 *  - A request that a busy line or another master ended is repeated. An address for which that goes on is counted in
 *    heard.not_asked: nothing is known about it.
 *  - Where a device was found, other parities of the same rate are not tried.
 *  - On the line of A16 and A05, if no A05 was found, any A05 is asked by 55 AA: one with an address beyond the plan's
 *    is found by that, if it is alone.
 *
 * wire, plan and tell are the caller's; the rest begins as zeros. FATHOM_OK; FATHOM_ERR_CANCELLED: wire->wait has
 * ended it; FATHOM_ERR_PORT.
 */
fathom_status_t scan_walk(scan_walk_t *walk);

#endif
