/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * The part of a line for devices that send by themselves, such as an A16 in automatic mode or an HPS-167S after
 * power-on. These devices do not wait for a free wire. A request survives only in the pause directly after their frame.
 *
 *     device   [frame]                 [frame]                       [frame]
 *     line            |silence|[request]     |silence|          |
 *                             ^                      ^          ^
 *                             slot                   slot       too late: the next frame may begin at any time
 *
 *  - BYTES_OF_A_SENDER bytes since the last response that belong to no transaction show that a device sends by itself.
 *    The shortest frame of all supported protocols has four bytes; noise is shorter.
 *  - In each silence the line has one slot, at the end of `silence_us`. After that the slot is over until the next byte.
 *  - After a response the slot is over at once: the device may have delayed its frame until the response ended.
 *  - QUIET_US of silence end all this: no device sends any more.
 *
 * A program whose turns are longer than the pause cannot measure the silence: each of its polls finds the next frame.
 *
 *     device   [frame]      [frame]      [frame]      [frame]
 *     polls              |            |            |            |
 *                         ^ this poll ends with a complete frame, so a silence has begun: the slot is here
 *
 *  - A program is slow if it polls at twice `silence_us` or later after a poll that ended with a frame, while a
 *    transaction waits. A program that sleeps for due_us comes in time, and so it is quick.
 *  - A slow program sends at once behind a frame. It may hit the next frame, because the frame can be old already.
 *  - If two requests in a row were lost, the turns of the program and the period of the device may keep step, so that
 *    each request leaves just before a frame. Then the line draws one in eight of these slots by the clock.
 *  - The line draws for each write from its first slot on. The reads between two writes succeed, since an unsolicited
 *    frame can serve them, so that the losses of writes alone would never be two in a row.
 */

enum { BYTES_OF_A_SENDER = 4, DRAWN_1_IN = 8 };

static bool is_slow(const fathom_line_t *line) { return line->sender >= SENDER_SLOW; }

static void note_bytes(fathom_line_t *line, uint32_t amount)
{
    const uint32_t sum = line->unsolicited_count + amount;
    line->unsolicited_count = (uint8_t)least_us(sum, BYTES_OF_A_SENDER);
    if ((sum >= BYTES_OF_A_SENDER) && (line->sender == SENDER_NONE)) line->sender = SENDER_QUICK;
}

static void note_pause(fathom_line_t *line, uint32_t pause_us)
{
    if (line->slot != SLOT_BEHIND_FRAME) return;
    line->slot = SLOT_OPEN;
    if (!is_waiting(line) || (line->sender == SENDER_NONE)) return;
    if (pause_us < (2u * silence_us(line)))
        line->sender = SENDER_QUICK;
    else if (line->sender == SENDER_QUICK)
        line->sender = SENDER_SLOW;
}

static void note(fathom_line_t *line, uint8_t event, uint32_t amount)
{
    switch (event) {
    case SENDER_BYTES:
        note_bytes(line, amount);
        break;
    case SENDER_FRAME:
        line->slot = SLOT_BEHIND_FRAME;
        break;
    case SENDER_ECHO:
        line->slot = SLOT_OVER;
        break;
    case SENDER_RESPONSE:
        if (line->sender != SENDER_NONE) fathom_line_add(line, FATHOM_LINE_MAYBE_UNSOLICITED, 1);
        line->slot = SLOT_OVER;
        line->unsolicited_count = 0;
        if (is_slow(line)) line->sender = SENDER_SLOW;
        break;
    case SENDER_LOSS:
        if (is_slow(line) && (line->sender != SENDER_LOST_2)) line->sender++;
        break;
    default: /* SENDER_PAUSE */
        note_pause(line, amount);
        break;
    }
}

static uint32_t slot_in_us(const fathom_line_t *line)
{
    if (line->sender == SENDER_NONE) return fathom_line_silence_left_us(line);
    if (line->slot == SLOT_OVER) return rest_us(QUIET_US, line->silent_us);
    if (is_slow(line) && (line->slot == SLOT_BEHIND_FRAME)) return 0;
    return fathom_line_silence_left_us(line);
}

/* The product spreads neighbouring readings of the clock over all values of 16 bits (Knuth's multiplicative hash:
 * 40503 is 65536 divided by the golden ratio). */
static bool is_drawn(const fathom_line_t *line)
{
    const uint16_t drawn = (uint16_t)((uint16_t)line->polled_us * 40503uL);
    return drawn < (65536uL / DRAWN_1_IN);
}

/* A device may send so seldom that no slot is drawn within `busy_us`, so in the second half of its wait a write uses
 * any slot. */
static bool must_draw(const fathom_line_t *line, const fathom_transaction_t *transaction)
{
    if (line->sender == SENDER_LOST_2) return true;
    if ((transaction == NULL) || may_collide(transaction)) return false;
    return !is_waiting(line) || (line->phase_left_us > (busy_us(line) / 2u));
}

static bool take_slot(fathom_line_t *line, const fathom_transaction_t *transaction)
{
    if (line->silent_us == QUIET_US) {
        line->sender = SENDER_NONE;
        line->unsolicited_count = 0;
    }
    line->slot = SLOT_OVER;
    return (fathom_line_silence_left_us(line) == 0u) || !must_draw(line, transaction) || is_drawn(line);
}

const fathom_line_senders_t fathom_line_senders = {note, slot_in_us, take_slot};
