/* SPDX-License-Identifier: MIT */
/*
 * The items of sending, and those of plain reading that need no marks. They compare the bytes that come back, and their
 * times, with those that were sent.
 */
#include <stddef.h>

#include "internal/kit.h"

static uint8_t some(const kit_t *kit) { return kit->bench->longest < 64 ? kit->bench->longest : 64; }

static uint32_t tolerance_us(const kit_t *kit)
{
    return kit->character_us / 2 + kit->bench->late_us + 2 * kit->step_us;
}

static void sent_comes(kit_t *kit)
{
    kit_begin(kit);
    if (!kit_send(kit, 8)) {
        kit_tell(kit, SENT_COMES, FATHOM_NOT_SEEN, 0);
        return;
    }
    const bool has_come = kit_await_sent(kit);
    kit_tell(kit, SENT_COMES, kit_kept_if(has_come), kit_since(kit, kit->wrote_us));
}

static bool is_whole(int taken, uint8_t length) { return taken == 0 || taken == length; }

static uint16_t poisoned(const kit_t *kit)
{
    uint16_t count = 0;
    for (uint16_t i = 0; i != kit->got; i++) count = (uint16_t)(count + (kit->arrivals[i].byte == POISON));
    return count;
}

/* Writes a request, and three bytes while it leaves, which the port may queue or refuse. If this returns false,
 * `*figure` is what was wrong. */
static bool writes_whole(kit_t *kit, uint8_t length, int *figure)
{
    static const uint8_t more[3] = {POISON, POISON, POISON};
    const fathom_uart_t *const uart = kit->bench->uart;
    kit_begin(kit);
    for (uint8_t i = 0; i != length; i++) kit->out[i] = i & 0x7F; /* never POISON */
    const uint32_t since_us = kit_now(kit);
    do *figure = uart->write(uart->ctx, kit->out, length);
    while (*figure == 0 && kit_since(kit, since_us) < 1000000);
    if (*figure != length) return false;
    const int taken = uart->write(uart->ctx, more, sizeof more);
    *figure = taken;
    if (!is_whole(taken, sizeof more)) return false;
    (void)kit_await(kit, (uint16_t)(length + taken));
    if (taken == 0) kit_wait(kit, 5 * kit->character_us + kit->bench->late_us);
    kit_read(kit);
    *figure = (int)poisoned(kit);
    return taken != 0 || *figure == 0;
}

static void write_whole(kit_t *kit)
{
    static const uint8_t lengths[] = {1, 2, 3, 8, 21, 64, 255};
    int figure = 0;
    bool is_right = true;
    if (kit_lacks(kit, BIT_OF(SENT_COMES))) {
        kit_tell(kit, WRITE_WHOLE, FATHOM_NOT_SEEN, 0);
        return;
    }
    for (unsigned i = 0; i != sizeof lengths && is_right; i++) {
        const uint8_t length = lengths[i] < kit->bench->longest ? lengths[i] : kit->bench->longest;
        is_right = writes_whole(kit, length, &figure);
    }
    kit_tell(kit, WRITE_WHOLE, kit_kept_if(is_right), is_right ? 0 : (uint32_t)figure);
}

static void write_copy(kit_t *kit)
{
    kit_begin(kit);
    const bool is_taken =
        !kit_lacks(kit, BIT_OF(SENT_COMES) | BIT_OF(WRITE_WHOLE)) && kit_send(kit, some(kit));
    if (!is_taken || !kit_await(kit, some(kit)))
        kit_tell(kit, WRITE_COPY, FATHOM_NOT_SEEN, 0);
    else
        kit_tell(kit, WRITE_COPY, kit_kept_if(poisoned(kit) == 0), poisoned(kit));
}

/* Reads one byte, three bytes and all bytes, one after the other. */
static void read_order(kit_t *kit)
{
    static const uint8_t capacities[] = {255, 1, 3, 255};
    uint16_t sent = 0, right = 0;
    if (kit_lacks(kit, BIT_OF(SENT_COMES) | BIT_OF(WRITE_WHOLE))) {
        kit_tell(kit, READ_ORDER, FATHOM_NOT_SEEN, 0);
        return;
    }
    kit_begin(kit);
    for (unsigned i = 0; i != sizeof capacities && kit_send(kit, some(kit)); i++) {
        sent = (uint16_t)(sent + some(kit));
        kit->capacity = capacities[i];
        if (i == 2) (void)kit_await_sent(kit); /* Now more bytes wait than fit into a read. */
        (void)kit_await(kit, sent);
    }
    kit->has_wire = kit->got != 0;
    while (right != kit->got && kit->arrivals[right].byte == kit_value(kit, right)) right++;
    kit_tell(kit, READ_ORDER,
             kit->has_wire ? kit_kept_if(right == sent && kit->got == sent) : FATHOM_NOT_SEEN, right);
    kit->capacity = 255;
}

/* The pace of the bytes of one request, by the groups in which they were read. */
typedef struct {
    uint32_t us, characters; /* without the first group and the one after the longest gap */
    uint32_t gap_us;         /* the longest, beyond the time of its group */
    uint16_t groups;
} pace_t;

static pace_t pace_of(const kit_t *kit)
{
    pace_t pace = {0, 0, 0, 0};
    uint32_t before_us = 0, longest_us = 0;
    uint16_t count = 0, of_longest = 0;
    for (uint16_t i = 0; i != kit->got; i++) {
        count++;
        if (!kit->arrivals[i].is_last) continue;
        const uint32_t gap_us = fathom_elapsed_us(kit->arrivals[i].at_us, before_us);
        if (pace.groups++ != 0) {
            pace.us += gap_us;
            pace.characters += count;
            if (gap_us > longest_us) {
                longest_us = gap_us;
                of_longest = count;
            }
        }
        before_us = kit->arrivals[i].at_us;
        count = 0;
    }
    pace.us -= longest_us;
    pace.characters -= of_longest;
    const uint32_t due_us = of_longest * kit->character_us;
    pace.gap_us = longest_us > due_us ? longest_us - due_us : 0;
    return pace;
}

static bool measure(kit_t *kit, pace_t *pace)
{
    kit_begin(kit);
    if (!kit_has_wire(kit) || !kit_send(kit, some(kit)) || !kit_await(kit, some(kit))) return false;
    *pace = pace_of(kit);
    return true;
}

static void clock_us(kit_t *kit)
{
    pace_t pace;
    uint32_t figure = 0;
    fathom_verdict_t verdict = FATHOM_NOT_SEEN;
    if (measure(kit, &pace) && pace.characters != 0) {
        const uint32_t due_us = pace.characters * kit->character_us;
        const uint32_t off_us = pace.us > due_us ? pace.us - due_us : due_us - pace.us;
        figure = pace.us / (due_us / 1000 + 1);
        kit->has_time = pace.groups >= 4 && pace.us > due_us / 10 && kit->bench->late_us < kit->character_us;
        if (kit->has_time) verdict = kit_kept_if(off_us <= due_us / 20 + 2 * kit->step_us);
    }
    kit_tell(kit, CLOCK_US, verdict, figure);
    kit->has_time = kit->has_time && verdict == FATHOM_KEPT;
}

static void write_at_once(kit_t *kit)
{
    const uint32_t most_us = some(kit) * kit->character_us / 2;
    uint32_t least_us = UINT32_MAX;
    bool is_taken = kit_has_wire(kit);
    for (int i = 0; i != 3 && is_taken; i++) {
        kit_begin(kit);
        is_taken = kit_send(kit, some(kit));
        if (kit->called_us < least_us) least_us = kit->called_us;
        (void)kit_await(kit, some(kit));
    }
    kit_tell(kit, WRITE_AT_ONCE, is_taken ? kit_kept_if(least_us < most_us) : FATHOM_NOT_SEEN,
             is_taken ? least_us : 0);
}

static void write_no_gap(kit_t *kit)
{
    pace_t pace = {0, 0, 0, 0};
    const bool is_seen = kit->has_time && measure(kit, &pace);
    kit_tell(kit, WRITE_NO_GAP,
             is_seen ? kit_kept_if(pace.gap_us <= kit->character_us * 3 / 2 + 2 * kit->step_us)
                     : FATHOM_NOT_SEEN,
             pace.gap_us);
}

/* Finds how long after `since_us` the last byte of the request arrived. `had` bytes had arrived at `since_us`. Returns
 * false if it does not arrive. */
static bool is_behind(kit_t *kit, uint16_t had, uint32_t since_us, uint32_t *by_us)
{
    *by_us = 0;
    if (had >= some(kit)) return true;
    if (!kit_await(kit, some(kit))) return false;
    *by_us = fathom_elapsed_us(kit->arrivals[some(kit) - 1].at_us, since_us);
    return true;
}

static void sent_not_early(kit_t *kit)
{
    uint32_t by_us = 0;
    bool is_seen = false;
    kit_begin(kit);
    if (kit_has_wire(kit) && kit_send(kit, some(kit))) {
        const uint32_t since_us = kit_now(kit);
        do kit_read(kit);
        while (!kit_is_sent(kit) && kit_since(kit, since_us) < kit_patience_us(kit, some(kit)));
        const uint32_t sent_us = kit_now(kit);
        kit_read(kit);
        is_seen = is_behind(kit, kit->got, sent_us, &by_us);
    }
    kit_tell(kit, SENT_NOT_EARLY, is_seen ? kit_kept_if(by_us <= tolerance_us(kit)) : FATHOM_NOT_SEEN, by_us);
}

static void leaves_in_us(kit_t *kit)
{
    const fathom_uart_t *const uart = kit->bench->uart;
    kit_begin(kit);
    if (uart->leaves_in_us == NULL || !kit_has_wire(kit) || kit_lacks(kit, BIT_OF(SENT_NOT_EARLY)) ||
        !kit_send(kit, some(kit))) {
        kit_tell(kit, LEAVES_IN_US, FATHOM_NOT_SEEN, 0);
        return;
    }
    const uint32_t first_us = uart->leaves_in_us(uart->ctx);
    (void)kit_await_sent(kit);
    const uint32_t last_us = uart->leaves_in_us(uart->ctx);
    kit_tell(kit, LEAVES_IN_US, kit_kept_if(last_us == 0 && first_us <= kit_patience_us(kit, some(kit))),
             last_us != 0 ? last_us : first_us);
}

static void driver(kit_t *kit)
{
    const fathom_conformance_t *const bench = kit->bench;
    kit_begin(kit);
    if (bench->driver == NULL || !kit_has_wire(kit)) {
        kit_tell(kit, DRIVER, FATHOM_NOT_SEEN, 0);
        return;
    }
    if (bench->driver(bench->ctx)) { /* The driver is always enabled, so the port never receives. */
        kit_tell(kit, DRIVER, FATHOM_NOT_KEPT, 0);
        return;
    }
    uint32_t by_us = 0;
    const bool is_taken = kit_send(kit, some(kit));
    const uint32_t since_us = kit_now(kit);
    while (bench->driver(bench->ctx) && kit_since(kit, since_us) < kit_patience_us(kit, some(kit)))
        kit_read(kit);
    const uint32_t off_us = kit_now(kit);
    kit_read(kit);
    const bool is_seen = is_taken && is_behind(kit, kit->got, off_us, &by_us);
    bool is_right = !bench->driver(bench->ctx) && by_us <= tolerance_us(kit);
    if (is_seen && by_us == 0) {
        by_us = fathom_elapsed_us(off_us, kit->arrivals[some(kit) - 1].at_us);
        if (by_us > INT32_MAX) by_us = 0; /* Both happened within one read. */
        is_right = is_right && by_us <= 2 * kit->character_us + tolerance_us(kit);
    }
    kit_tell(kit, DRIVER, is_seen ? kit_kept_if(is_right) : FATHOM_NOT_SEEN, by_us);
}

static void read_bounds(kit_t *kit)
{
    kit_begin(kit);
    const bool is_sent = kit_has_wire(kit) && kit_send(kit, 8) && kit_await_sent(kit);
    if (is_sent) kit_wait(kit, 2 * kit->character_us + kit->bench->late_us);
    kit->capacity = 2;
    kit_read(kit);
    kit->capacity = 255;
    kit_tell(kit, READ_BOUNDS, is_sent ? kit_kept_if(kit->beyond == 0) : FATHOM_NOT_SEEN, kit->beyond);
}

void kit_sending(kit_t *kit)
{
    sent_comes(kit);
    write_whole(kit);
    write_copy(kit);
    read_order(kit);
    read_bounds(kit);
    clock_us(kit);
    write_at_once(kit);
    write_no_gap(kit);
    sent_not_early(kit);
    leaves_in_us(kit);
    driver(kit);
}
