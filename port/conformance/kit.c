/* SPDX-License-Identifier: MIT */
/*
 * What the items share: the table of items, the clock with its monotony check, sending, and reading into a list of
 * arrivals. An arrival is a byte with the time of its read and its flags.
 */
#include "internal/kit.h"

#include <stddef.h>

enum { QUIET = 12 }; /* in characters */

static const struct {
    const char *name, *clause, *of;
} items[FATHOM_CONFORMANCE_ITEMS] = {
    [CLOCK_RUNS] = {"clock_runs", "now_us counts", "us of its coarsest step"},
    [CLOCK_WRAP] = {"clock_wrap", "now_us wraps from 4294967295 to 0",
                    "the clock after it was set and went on"},
    [WRITE_WHOLE] = {"write_whole", "write takes all bytes, or none and returns 0",
                     "returned, or refused and sent all the same"},
    [SENT_COMES] = {"sent_comes", "sent turns true", "us after write"},
    [WRITE_COPY] = {"write_copy", "write does not keep the pointer", "bytes changed after write"},
    [READ_ORDER] = {"read_order", "read copies the bytes that came", "bytes right"},
    [READ_BOUNDS] = {"read_bounds", "read copies up to capacity bytes", "bytes beyond it"},
    [CLOCK_US] = {"clock_us", "now_us counts microseconds", "per mille of the line's time"},
    [WRITE_AT_ONCE] = {"write_at_once", "every function returns at once", "us that write took"},
    [WRITE_NO_GAP] = {"write_no_gap", "bytes leave the pin without a gap", "us of the longest gap"},
    [SENT_NOT_EARLY] = {"sent_not_early", "sent: the last stop bit has left",
                        "us from sent to the last byte"},
    [LEAVES_IN_US] = {"leaves_in_us", "leaves_in_us: at most so long, 0 when all has left", "us"},
    [DRIVER] = {"driver", "the port drives the transceiver", "us from the last byte to its end"},
    [READ_SILENCE] = {"read_silence", "no read spans a silence; FATHOM_RX_SILENCE", "bytes before the mark"},
    [READ_STAMP] = {"read_stamp", "last_us: the clock at the end of the last byte",
                    "us behind the last stop bit"},
    [READ_AGE] = {"read_age", "read returns 0 only if no byte waits; last_us of bytes that waited",
                  "old bytes that look new"},
    [MARK_PARITY] = {"mark_parity", "FATHOM_RX_PARITY: no read spans an error", "bytes with it"},
    [MARK_FRAMING] = {"mark_framing", "FATHOM_RX_FRAMING: no read spans an error", "bytes with it"},
    [WRITE_WHEN_FULL] = {"write_when_full", "write is busy only while bytes leave",
                         "bytes not read meanwhile"},
    [READ_OVERRUN] = {"read_overrun", "FATHOM_RX_OVERRUN: bytes were lost just before", "bytes lost"},
    [SET_LINE_HOLDS] = {"set_line_holds", "set_line 1: they hold now", "us of a character"},
    [SET_LINE_WAITS] = {"set_line_waits", "set_line 0: bytes are still leaving", "returned"},
    [SET_LINE_KEEPS] = {"set_line_keeps", "set_line keeps what was received", "bytes kept"},
    [SET_LINE_REFUSES] = {"set_line_refuses", "set_line < 0: not within 2.5 %", "baud taken"},
    [SET_BREAK] = {"set_break", "set_break 0: bytes are still leaving; 1: done", "returned"},
    [CLOCK_FORWARD] = {"clock_forward", "now_us is monotonic", "us back"},
};

uint32_t kit_raw_now(const kit_t *kit) { return kit->bench->clock->now_us(kit->bench->clock->ctx); }

uint32_t kit_now(kit_t *kit)
{
    const uint32_t now = kit_raw_now(kit);
    const uint32_t by = fathom_elapsed_us(now, kit->last_us);
    if (by > INT32_MAX && (uint32_t)(0 - by) > kit->back_us) kit->back_us = (uint32_t)(0 - by);
    kit->last_us = now;
    return now;
}

uint32_t kit_since(kit_t *kit, uint32_t since_us) { return fathom_elapsed_us(kit_now(kit), since_us); }

bool kit_lacks(const kit_t *kit, uint32_t wanted) { return (kit->not_kept & wanted) != 0; }

bool kit_has_wire(const kit_t *kit)
{
    return kit->has_wire && !kit_lacks(kit, BIT_OF(SENT_COMES) | BIT_OF(WRITE_WHOLE) | BIT_OF(READ_ORDER));
}

fathom_verdict_t kit_kept_if(bool kept) { return kept ? FATHOM_KEPT : FATHOM_NOT_KEPT; }

void kit_tell(kit_t *kit, item_t item, fathom_verdict_t verdict, uint32_t figure)
{
    /* If the clock goes back, no other item proves anything. */
    if (verdict == FATHOM_NOT_KEPT && kit->back_us != 0 && item != CLOCK_FORWARD) verdict = FATHOM_NOT_SEEN;
    if (verdict == FATHOM_NOT_KEPT) {
        kit->failed++;
        kit->not_kept |= BIT_OF(item);
    }
    const fathom_finding_t finding = {items[item].name, items[item].clause, verdict, figure, items[item].of};
    kit->bench->report(kit->bench->ctx, &finding);
}

uint32_t kit_patience_us(const kit_t *kit, uint32_t count)
{
    return 2 * count * kit->character_us + 2 * kit->bench->late_us + 100000;
}

void kit_wait(kit_t *kit, uint32_t us)
{
    const uint32_t since_us = kit_now(kit);
    while (kit_since(kit, since_us) < us) {
    }
}

static void take(kit_t *kit, int count, uint8_t flags)
{
    const uint32_t now = kit_now(kit);
    for (int i = 0; i < count && kit->got != MOST; i++) {
        arrival_t *const arrival = &kit->arrivals[kit->got++];
        arrival->at_us = now;
        arrival->byte = kit->in[i];
        arrival->flags = i == 0 ? flags : 0;
        arrival->is_first = i == 0;
        arrival->is_last = i == count - 1;
    }
}

void kit_read(kit_t *kit)
{
    const fathom_uart_t *const uart = kit->bench->uart;
    fathom_rx_t rx = {0, 0};
    for (uint16_t i = kit->capacity; i != sizeof kit->in; i++) kit->in[i] = POISON;
    const int count = uart->read(uart->ctx, kit->in, kit->capacity, &rx);
    uint16_t used = sizeof kit->in;
    while (used > kit->capacity && kit->in[used - 1] == POISON) used--;
    if (count > (int)used && count <= (int)sizeof kit->in) used = (uint16_t)count;
    if ((uint16_t)(used - kit->capacity) > kit->beyond) kit->beyond = (uint16_t)(used - kit->capacity);
    if (count > 0 && (rx.flags & FATHOM_RX_TIMED) != 0) kit->stamp_us = rx.last_us;
    take(kit, count > (int)sizeof kit->in ? (int)sizeof kit->in : count, rx.flags);
}

bool kit_await(kit_t *kit, uint16_t count)
{
    const uint32_t since_us = kit_now(kit), most_us = kit_patience_us(kit, count);
    do kit_read(kit);
    while (kit->got < count && kit_since(kit, since_us) < most_us);
    return kit->got >= count;
}

void kit_begin(kit_t *kit)
{
    const uint32_t quiet_us = QUIET * kit->character_us + kit->bench->late_us;
    uint32_t since_us = kit_now(kit);
    kit->capacity = 255;
    for (unsigned bytes = 0; bytes < 10000 && kit_since(kit, since_us) < quiet_us; bytes += kit->got) {
        kit->got = 0;
        kit_read(kit);
        if (kit->got != 0) since_us = kit_now(kit);
    }
    kit->got = 0;
    kit->awaited = kit->next;
}

uint8_t kit_after(uint8_t value) { return (uint8_t)(value + (value == POISON - 1 ? 2 : 1)); }

uint8_t kit_value(const kit_t *kit, uint16_t at)
{
    uint8_t value = kit->awaited;
    while (at-- != 0) value = kit_after(value);
    return value;
}

bool kit_is_sent(const kit_t *kit) { return kit->bench->uart->sent(kit->bench->uart->ctx); }

bool kit_send(kit_t *kit, uint8_t length)
{
    const fathom_uart_t *const uart = kit->bench->uart;
    const uint32_t since_us = kit_now(kit), most_us = kit_patience_us(kit, length) + 1000000;
    int taken;
    uint8_t value = kit->next;
    for (uint8_t i = 0; i != length; i++, value = kit_after(value)) kit->out[i] = value;
    do {
        kit->wrote_us = kit_now(kit);
        taken = uart->write(uart->ctx, kit->out, length);
        kit->called_us = kit_since(kit, kit->wrote_us);
    } while (taken == 0 && kit_since(kit, since_us) < most_us);
    if (taken != length) return false;
    kit->next = value;
    if (!kit_lacks(kit, BIT_OF(WRITE_COPY)))
        for (uint8_t i = 0; i != length; i++) kit->out[i] = POISON;
    return true;
}

bool kit_await_sent(kit_t *kit)
{
    const uint32_t since_us = kit_now(kit), most_us = kit_patience_us(kit, 255) + 1000000;
    while (!kit_is_sent(kit))
        if (kit_since(kit, since_us) > most_us) return false;
    return true;
}
