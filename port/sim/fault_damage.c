/* SPDX-License-Identifier: MIT */
/* Faults that change a frame, its time or its silences, but do not repair its checksum. */
#include <string.h>

#include "internal/fault_parts.h"

enum { MAX_FRAME = FATHOM_SIM_MAX_FRAME, MAX_NOISE = 8, MAX_TRAILING = 4 };

static uint32_t us_or(const fathom_sim_fault_rule_t *rule, uint32_t default_us)
{
    return rule->us != 0 ? rule->us : default_us;
}

static uint8_t any_byte(fathom_sim_fault_rule_t *rule) { return (uint8_t)fathom_sim_fault_below(rule, 256); }

static uint8_t any_place(fathom_sim_fault_rule_t *rule, const fathom_sim_frame_t *frame)
{
    return (uint8_t)fathom_sim_fault_below(rule, frame->length);
}

/* ---- places move with the bytes ---- */

/* Makes room for `count` bytes at `at`; false: there is none. Marks and pauses behind move with their bytes;
 * a pause before `at` stays before what is new. */
static bool widen(fathom_sim_frame_t *frame, uint8_t at, uint8_t count)
{
    if (frame->length + count > MAX_FRAME) return false;
    const size_t behind = (size_t)(frame->length - at);
    memmove(frame->bytes + at + count, frame->bytes + at, behind);
    memmove(frame->marks + at + count, frame->marks + at, behind);
    memset(frame->marks + at, 0, count);
    for (uint8_t i = 0; i < frame->paused; i++)
        if (frame->pauses[i].at > at) frame->pauses[i].at = (uint16_t)(frame->pauses[i].at + count);
    frame->length = (uint8_t)(frame->length + count);
    return true;
}

static void remove_byte(fathom_sim_frame_t *frame, uint8_t at)
{
    frame->length--;
    memmove(frame->bytes + at, frame->bytes + at + 1, (size_t)(frame->length - at));
}

/* It ends after `length` bytes. */
static void cut(fathom_sim_frame_t *frame, uint8_t length)
{
    uint8_t kept = 0;
    for (uint8_t i = 0; i < frame->paused; i++)
        if (frame->pauses[i].at < length) frame->pauses[kept++] = frame->pauses[i];
    frame->paused = kept;
    frame->length = length;
}

static bool pause(fathom_sim_frame_t *frame, uint8_t at, uint32_t us)
{
    if (frame->paused == FATHOM_SIM_PAUSES) return false;
    frame->pauses[frame->paused].at = at;
    frame->pauses[frame->paused++].us = us;
    return true;
}

/* ---- its bytes ---- */

static bool flip(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame, uint8_t mark)
{
    const uint8_t at = any_place(rule, frame);
    const bool one_bit = rule->kind == FATHOM_SIM_FAULT_FLIP_BIT || rule->kind == FATHOM_SIM_FAULT_PARITY;
    const uint32_t mask =
        one_bit ? UINT32_C(1) << fathom_sim_fault_below(rule, 8) : 1 + fathom_sim_fault_below(rule, 255);
    frame->bytes[at] = (uint8_t)(frame->bytes[at] ^ mask);
    frame->marks[at] |= mark;
    return true;
}

static bool lose(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    frame->marks[any_place(rule, frame)] |= FATHOM_RX_OVERRUN;
    return true;
}

static bool insert(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if (frame->length < 2) return false;
    const uint8_t at = (uint8_t)(1 + fathom_sim_fault_below(rule, frame->length - 1u));
    if (!widen(frame, at, 1)) return false;
    frame->bytes[at] = any_byte(rule);
    return true;
}

static bool truncate(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if (frame->length < 2) return false;
    cut(frame, (uint8_t)(1 + fathom_sim_fault_below(rule, frame->length - 1u)));
    return true;
}

static bool trail(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    const uint8_t at = frame->length;
    const uint8_t count = (uint8_t)(1 + fathom_sim_fault_below(rule, MAX_TRAILING));
    if (!widen(frame, at, count)) return false;
    for (uint8_t i = 0; i < count; i++) frame->bytes[at + i] = any_byte(rule);
    return true;
}

/* ---- time ---- */

static bool split(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if (frame->length < 2) return false;
    return pause(frame, (uint8_t)(1 + fathom_sim_fault_below(rule, frame->length - 1u)), us_or(rule, 10000));
}

static bool duplicate(const fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    const uint8_t length = frame->length;
    if (!widen(frame, length, length)) return false;
    memcpy(frame->bytes + length, frame->bytes, length);
    memcpy(frame->marks + length, frame->marks, length);
    if (rule->us != 0) (void)pause(frame, length, rule->us);
    return true;
}

static bool cut_power(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if (frame->length != 0) cut(frame, any_place(rule, frame));
    frame->off_us = us_or(rule, 2000000);
    return true;
}

/* ---- around it ---- */

/* Without a frame it comes alone, when that would have come. */
static bool surround(fathom_sim_frame_t *frame, const uint8_t *bytes, uint8_t count, bool before, uint32_t us)
{
    const uint8_t length = frame->length;
    const uint8_t at = before ? 0 : length;
    if (frame->paused == FATHOM_SIM_PAUSES || !widen(frame, at, count)) return false;
    memcpy(frame->bytes + at, bytes, count);
    if (length == 0 || !before) frame->after = (uint8_t)(frame->after + count);
    if (length != 0) (void)pause(frame, before ? count : length, us);
    return true;
}

static bool noise(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    uint8_t bytes[MAX_NOISE];
    const bool before = (fathom_sim_fault_random(rule) >> 31) != 0;
    const uint8_t count = (uint8_t)(1 + fathom_sim_fault_below(rule, MAX_NOISE));
    for (uint8_t i = 0; i < count; i++) bytes[i] = any_byte(rule);
    return surround(frame, bytes, count, before, us_or(rule, 3000));
}

static bool unasked(const fathom_sim_fault_t *fault, fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    uint8_t bytes[MAX_FRAME];
    const bool before = (fathom_sim_fault_random(rule) >> 31) != 0;
    const uint8_t count = fathom_sim_fault_unasked(fault, frame, bytes);
    return surround(frame, bytes, count, before, us_or(rule, 10000));
}

static bool put_break(const fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    const uint8_t nothing = 0;
    if (!surround(frame, &nothing, 1, true, us_or(rule, 1000))) return false;
    frame->marks[0] |= FATHOM_RX_FRAMING;
    return true;
}

static bool jump(const fathom_sim_fault_t *fault, const fathom_sim_fault_rule_t *rule,
                 const fathom_sim_frame_t *frame)
{
    if (fault->clock == NULL) return false;
    fathom_sim_clock_jump(fault->clock, frame->now_us, us_or(rule, 10000000));
    return true;
}

/* ---- all ---- */

static bool later(fathom_sim_frame_t *frame, uint32_t us)
{
    frame->delay_us += us;
    return true;
}

/* What needs a byte to be there. */
static bool harm_bytes(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if (frame->length == 0) return false;
    switch (rule->kind) {
    case FATHOM_SIM_FAULT_FLIP_BIT:
    case FATHOM_SIM_FAULT_FLIP_BYTE:
        return flip(rule, frame, 0);
    case FATHOM_SIM_FAULT_PARITY:
        return flip(rule, frame, FATHOM_RX_PARITY);
    case FATHOM_SIM_FAULT_FRAMING:
        return flip(rule, frame, FATHOM_RX_FRAMING);
    case FATHOM_SIM_FAULT_OVERRUN:
        return lose(rule, frame);
    case FATHOM_SIM_FAULT_DROP:
        remove_byte(frame, any_place(rule, frame));
        return true;
    case FATHOM_SIM_FAULT_INSERT:
        return insert(rule, frame);
    case FATHOM_SIM_FAULT_TRUNCATE:
        return truncate(rule, frame);
    case FATHOM_SIM_FAULT_TRAILING:
        return trail(rule, frame);
    case FATHOM_SIM_FAULT_SPLIT:
        return split(rule, frame);
    case FATHOM_SIM_FAULT_DUPLICATE:
        return duplicate(rule, frame);
    case FATHOM_SIM_FAULT_DELAY:
        return later(frame, us_or(rule, 20000));
    case FATHOM_SIM_FAULT_LATE:
        return later(frame, us_or(rule, 1500000));
    case FATHOM_SIM_FAULT_SILENCE:
        cut(frame, 0);
        return true;
    default:
        return fathom_sim_fault_forge(rule, frame);
    }
}

static bool harm(const fathom_sim_fault_t *fault, fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame)
{
    if ((fathom_sim_fault_protocols(rule->kind) & frame->protocol) == 0) return false;
    switch (rule->kind) {
    case FATHOM_SIM_FAULT_STUCK: /* the measurement is over */
    case FATHOM_SIM_FAULT_INTERFERENCE:
    case FATHOM_SIM_FAULT_FAULT:
    case FATHOM_SIM_FAULT_NO_TARGET:
        return false;
    case FATHOM_SIM_FAULT_POWER_CYCLE:
        return cut_power(rule, frame);
    case FATHOM_SIM_FAULT_NOISE:
        return noise(rule, frame);
    case FATHOM_SIM_FAULT_UNASKED:
        return unasked(fault, rule, frame);
    case FATHOM_SIM_FAULT_BREAK:
        return put_break(rule, frame);
    case FATHOM_SIM_FAULT_ECHO: /* the request was repeated when it came */
        return true;
    case FATHOM_SIM_FAULT_CLOCK_JUMP:
        return jump(fault, rule, frame);
    default:
        return harm_bytes(rule, frame);
    }
}

uint32_t fathom_sim_fault_damage(fathom_sim_fault_t *fault, fathom_sim_frame_t *frame)
{
    uint32_t kinds = 0;
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        for (uint8_t i = 0; i < fault->rules_used; i++)
            if (fault->rules[i].kind == kind && fault->rules[i].hit && harm(fault, &fault->rules[i], frame))
                kinds |= FATHOM_SIM_FAULT_BIT(kind);
    frame->marked = frame->length != 0;
    return kinds;
}
