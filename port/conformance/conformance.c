/* SPDX-License-Identifier: MIT */
/*
 * Runs all items of the kit in order, and has those of the clock. The other items are in send.c, receive.c and
 * settings.c.
 */
#include "fathom_conformance.h"

#include <stddef.h>

#include "internal/kit.h"

static const uint32_t most_reads = 10000000; /* After this number of equal reads the clock stands still. */

const char *fathom_verdict_name(fathom_verdict_t verdict)
{
    if (verdict == FATHOM_KEPT) return "kept";
    return verdict == FATHOM_NOT_KEPT ? "NOT KEPT" : "not seen";
}

/* Reads the clock for 20000 steps, or for 200 ms. Returns false if it stands still. */
static bool clock_runs(kit_t *kit)
{
    uint32_t reads = 0;
    const uint32_t begun_us = kit->last_us = kit_raw_now(kit);
    for (uint32_t steps = 0; steps != 20000 && reads != most_reads; reads++) {
        const uint32_t before_us = kit->last_us, by_us = fathom_elapsed_us(kit_now(kit), before_us);
        if (by_us == 0) continue;
        if (by_us > kit->step_us && by_us < 1000000) kit->step_us = by_us;
        steps++;
        if (fathom_elapsed_us(kit->last_us, begun_us) > 200000) break;
    }
    kit_tell(kit, CLOCK_RUNS, kit_kept_if(reads != most_reads), kit->step_us);
    return reads != most_reads;
}

/* Reads the clock for 2 ms across the wrap. A step that a clock with another wrap would make is a fault. */
static void clock_wrap(kit_t *kit)
{
    const fathom_conformance_t *const bench = kit->bench;
    const uint32_t from_us = UINT32_MAX - 1000;
    if (bench->set_clock == NULL) {
        kit_tell(kit, CLOCK_WRAP, FATHOM_NOT_SEEN, 0);
        return;
    }
    bool is_right = true;
    bench->set_clock(bench->ctx, from_us);
    uint32_t now = kit_raw_now(kit);
    for (uint32_t reads = 0; reads != most_reads && is_right && fathom_elapsed_us(now, from_us) < 2000;
         reads++) {
        const uint32_t before = now;
        now = kit_raw_now(kit);
        is_right = fathom_elapsed_us(now, before) < 1000000;
    }
    is_right = is_right && fathom_elapsed_us(now, from_us) < 1000000;
    for (uint32_t reads = 0; reads != 200; reads++)
        (void)kit_raw_now(kit); /* These reads pass another wrap too. */
    kit->last_us = kit_raw_now(kit);
    kit_tell(kit, CLOCK_WRAP, kit_kept_if(is_right), now);
}

static void tell_rest(kit_t *kit, item_t from)
{
    for (unsigned item = from; item != CLOCK_FORWARD; item++) kit_tell(kit, (item_t)item, FATHOM_NOT_SEEN, 0);
}

unsigned fathom_conformance_run(const fathom_conformance_t *bench)
{
    const fathom_line_settings_t *const line = &bench->line;
    const uint32_t bits = 9u + (line->parity != FATHOM_PARITY_NONE) + line->stop_bits;
    kit_t kit;
    kit.bench = bench;
    kit.failed = 0;
    kit.not_kept = 0;
    kit.character_us = (bits * 1000000u + line->baud - 1) / line->baud;
    kit.step_us = kit.back_us = 0;
    kit.has_wire = kit.has_time = false;
    kit.next = 0;
    kit.beyond = 0;
    kit.stamp_us = 0;
    if (!clock_runs(&kit)) {
        tell_rest(&kit, CLOCK_WRAP);
    } else {
        clock_wrap(&kit);
        kit_sending(&kit);
        kit_receiving(&kit);
        kit_settings(&kit);
    }
    kit_tell(&kit, CLOCK_FORWARD, kit_kept_if(kit.back_us == 0), kit.back_us);
    return kit.failed;
}
