/* SPDX-License-Identifier: MIT */
/*
 * The items of reception: silence, time stamps, the age of bytes, error marks, and a full ring. Each needs the wire
 * from TX to RX.
 */
#include <stddef.h>

#include "internal/kit.h"

static const uint32_t age_us =
    1000000; /* more than FATHOM_LINE_LATE_US and a usual time-out (line.h, rule 14) */
enum { WORD = 5, PAUSE = 20 /* characters */, PAUSE_US = 5000 /* at least; t3.5 is 1750 us at high rates */ };

static bool tells(const kit_t *kit, uint8_t mark) { return (kit->bench->marks & mark) != 0; }

/* Sends two words with a silence between them, and then reads. `ends_us` gets the end of each word, by `sent`. */
static bool two_words(kit_t *kit, uint32_t begins_us[2], uint32_t ends_us[2])
{
    kit_begin(kit);
    for (int i = 0; i != 2; i++) {
        if (!kit_has_wire(kit) || !kit_send(kit, WORD)) return false;
        begins_us[i] = kit->wrote_us;
        if (!kit_await_sent(kit)) return false;
        ends_us[i] = kit_now(kit);
        kit_wait(kit, (WORD + PAUSE) * kit->character_us + PAUSE_US + kit->bench->late_us);
    }
    return true;
}

/* The mark must stand at both words, because there was silence before each, and nowhere else. */
static void read_silence(kit_t *kit)
{
    uint32_t begins_us[2], ends_us[2];
    uint16_t at = 0;
    if (!tells(kit, FATHOM_RX_SILENCE) || kit_lacks(kit, BIT_OF(WRITE_NO_GAP)) ||
        !two_words(kit, begins_us, ends_us) || !kit_await(kit, 2 * WORD)) {
        kit_tell(kit, READ_SILENCE, FATHOM_NOT_SEEN, 0);
        return;
    }
    bool is_right = true;
    for (uint16_t i = 1; i != 2 * WORD; i++) {
        const bool is_marked = (kit->arrivals[i].flags & FATHOM_RX_SILENCE) != 0;
        if (is_marked && at == 0) at = i;
        is_right = is_right && is_marked == (i == WORD);
    }
    kit_tell(kit, READ_SILENCE, kit_kept_if(is_right), at);
}

/* The stamp of the first read must not be before its bytes can have arrived, and not after they have arrived. */
static void read_stamp(kit_t *kit)
{
    uint32_t begins_us[2], ends_us[2];
    fathom_verdict_t verdict = FATHOM_NOT_SEEN;
    uint32_t late_us = 0;
    if (tells(kit, FATHOM_RX_TIMED) && !kit_lacks(kit, BIT_OF(SENT_NOT_EARLY)) &&
        two_words(kit, begins_us, ends_us)) {
        const uint32_t most_us = kit->character_us + kit->bench->late_us + 2 * kit->step_us;
        const uint32_t read_us = kit_now(kit);
        kit->stamp_us = read_us - INT32_MAX;
        kit_read(kit);
        const unsigned word = kit->got <= WORD ? 0 : 1;
        late_us = fathom_elapsed_us(kit->stamp_us, ends_us[word]);
        if (late_us > INT32_MAX) late_us = 0;
        verdict =
            kit_kept_if(late_us <= most_us && fathom_elapsed_us(kit->stamp_us, begins_us[word]) < INT32_MAX);
    }
    kit_tell(kit, READ_STAMP, verdict, late_us);
}

/*
 * Bytes wait in the port for longer than age_us while nothing reads. The line can tell that they are old in two ways:
 *
 *     sent      no read for age_us            read  read  read
 *     #####.....................................2     3     0     later bytes are new
 *
 *   - the port dates them: then a stamp may not be later than their arrival; or
 *   - the port does not, and the line drops all bytes until a read returns 0: then no old byte may come after that.
 */
static void read_age(kit_t *kit)
{
    const uint32_t unseen = BIT_OF(SENT_NOT_EARLY) | BIT_OF(READ_STAMP);
    const uint32_t most_us = kit->character_us + kit->bench->late_us + 2 * kit->step_us;
    uint32_t young_count = 0;
    uint16_t before;
    kit_begin(kit);
    if (!kit_has_wire(kit) || kit_lacks(kit, unseen) || !kit_send(kit, WORD) || !kit_await_sent(kit)) {
        kit_tell(kit, READ_AGE, FATHOM_NOT_SEEN, 0);
        return;
    }
    const uint32_t end_us = kit_now(kit);
    kit_wait(kit, age_us + kit_patience_us(kit, WORD));
    do {
        before = kit->got;
        kit->stamp_us = end_us;
        kit_read(kit);
        const uint32_t late_us = fathom_elapsed_us(kit->stamp_us, end_us);
        if (late_us > most_us && late_us <= INT32_MAX) young_count += (uint32_t)(kit->got - before);
    } while (kit->got != before);
    (void)kit_await(kit, WORD);
    young_count += (uint32_t)(kit->got - before);
    kit_tell(kit, READ_AGE, kit->got == WORD ? kit_kept_if(young_count == 0) : FATHOM_NOT_SEEN, young_count);
}

/* The far end sends three bytes. The second one must have the mark and a read of its own. */
static void mark(kit_t *kit, item_t item, uint8_t flag)
{
    const fathom_conformance_t *const bench = kit->bench;
    uint32_t marked = 0;
    kit_begin(kit);
    if (!tells(kit, flag) || bench->damage == NULL || !bench->damage(bench->ctx, flag)) {
        kit_tell(kit, item, FATHOM_NOT_SEEN, 0);
        return;
    }
    kit_wait(kit, kit_patience_us(kit, 3));
    kit_read(kit);
    (void)kit_await(kit, 3);
    for (uint16_t i = 0; i != kit->got; i++) marked += (kit->arrivals[i].flags & flag) != 0;
    const arrival_t *const second = &kit->arrivals[1];
    const bool is_right = kit->got == 3 && marked == 1 && (second->flags & flag) != 0 && second->is_last;
    kit_tell(kit, item, kit_kept_if(is_right), marked);
}

/* Reads the bytes that were sent while nothing was read. The values show the losses, if fewer than 255 bytes in a row
 * are lost. */
static uint32_t count_lost(const kit_t *kit, bool *is_marked)
{
    uint8_t awaited = kit->awaited;
    uint32_t lost = 0;
    *is_marked = true;
    for (uint16_t i = 0; i != kit->got; i++) {
        uint32_t skipped = 0;
        while (awaited != kit->arrivals[i].byte && skipped != 255) {
            awaited = kit_after(awaited);
            skipped++;
        }
        awaited = kit_after(awaited);
        lost += skipped;
        if ((skipped != 0) != ((kit->arrivals[i].flags & FATHOM_RX_OVERRUN) != 0)) *is_marked = false;
    }
    return lost;
}

static void full(kit_t *kit)
{
    uint16_t sent = 0;
    bool is_taken = kit_has_wire(kit), is_marked = false;
    kit_begin(kit);
    while (is_taken && sent < FILL) {
        is_taken = kit_send(kit, 8) && kit_await_sent(kit);
        if (is_taken) sent = (uint16_t)(sent + 8);
    }
    kit_tell(kit, WRITE_WHEN_FULL, kit_has_wire(kit) ? kit_kept_if(is_taken) : FATHOM_NOT_SEEN, sent);
    if (!is_taken) {
        kit_tell(kit, READ_OVERRUN, FATHOM_NOT_SEEN, 0);
        return;
    }
    kit_wait(kit, kit_patience_us(kit, 8));
    for (uint16_t before = UINT16_MAX; kit->got != before;) {
        before = kit->got;
        kit_read(kit);
    }
    /* The next byte reports the loss, so one more byte is sent first. */
    const uint16_t had = kit->got;
    if (kit_send(kit, 8)) (void)kit_await(kit, (uint16_t)(had + 8));
    const uint32_t lost = count_lost(kit, &is_marked);
    const bool is_seen = tells(kit, FATHOM_RX_OVERRUN) && (lost != 0 || !is_marked);
    kit_tell(kit, READ_OVERRUN, is_seen ? kit_kept_if(is_marked) : FATHOM_NOT_SEEN, lost);
}

void kit_receiving(kit_t *kit)
{
    read_silence(kit);
    read_stamp(kit);
    read_age(kit);
    mark(kit, MARK_PARITY, FATHOM_RX_PARITY);
    mark(kit, MARK_FRAMING, FATHOM_RX_FRAMING);
    full(kit);
}
