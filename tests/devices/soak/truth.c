/* SPDX-License-Identifier: MIT */
#include "truth.h"

#include <string.h>

#include "sim/device.h"

enum { UNITS = 8 };

/* The codes of the datasheets and of sister models; the example of HPS-167S #5, and the simulator's weak light. */
enum { NO_TARGET = 0xFFFD, INTERFERENCE = 0xFFFE, HPS_OVER_RANGE = 65530, HPS_FAILED = 0xFFFF };
enum { HPS_MAGNITUDE = 0xDCB2 << 7, HPS_WEAK = 0x0010, HPS_AMBIENT = 1, HPS_ONES = 0xFF };

void truth_init(truth_t *truth, uint8_t setting, uint8_t index)
{
    memset(truth, 0, sizeof *truth);
    truth->setting = setting;
    truth->index = index;
    for (uint8_t i = 0; i < TRUTH_PROBES; i++) truth->current[i] = TRUTH_NOTHING;
}

int32_t truth_look(truth_t *truth, uint8_t probe)
{
    const soak_facts_t *const facts = &soak_facts[truth->setting];
    if (truth->held_mm != 0) return truth->held_mm;
    const uint32_t place = (truth->looks++ * UNITS + truth->index) % facts->span_mm;
    /* 16807 = 7^5 has no factor with the spans in common: all their values in an order that looks like none */
    return (int32_t)(facts->least_mm + place * 16807u % facts->span_mm);
}

void truth_measured(truth_t *truth, uint8_t probe, int32_t value)
{
    const bool is_optical = soak_facts[truth->setting].model == FATHOM_HPS167S;
    if (value == FATHOM_SIM_NO_TARGET) value = is_optical ? HPS_OVER_RANGE : NO_TARGET;
    if (value == FATHOM_SIM_INTERFERENCE) value = INTERFERENCE;
    if (value == FATHOM_SIM_FAULT) value = HPS_FAILED;
    truth->current[probe - 1] = value;
    truth->any = true;
}

truth_entry_t *truth_at(truth_t *truth, uint32_t n) { return &truth->log[n % TRUTH_ROOM]; }

truth_entry_t *truth_leaves(truth_t *truth, uint32_t now_us)
{
    if (!truth->any) return NULL;
    truth_entry_t *const entry = truth_at(truth, truth->count++);
    memset(entry, 0, sizeof *entry);
    entry->measured_us = now_us;
    for (uint8_t i = 0; i < TRUTH_PROBES; i++) {
        entry->values[i] = truth->current[i];
        truth->current[i] = TRUTH_NOTHING;
    }
    truth->any = false;
    return entry;
}

/* Does all else in the sample follow from its 16 bits? */
static bool is_consistent(const truth_t *truth, const fathom_sample_t *sample)
{
    const soak_facts_t *const facts = &soak_facts[truth->setting];
    const uint16_t raw = (uint16_t)sample->raw;
    uint8_t kind = FATHOM_TARGET;
    if (facts->model == FATHOM_HPS167S) {
        if (raw == HPS_OVER_RANGE) kind = FATHOM_NO_TARGET;
        if (raw == HPS_FAILED) kind = FATHOM_FAULT;
        const uint32_t magnitude = kind == FATHOM_TARGET      ? HPS_MAGNITUDE
                                   : kind == FATHOM_NO_TARGET ? HPS_WEAK
                                                              : 0;
        const uint8_t ambient = kind == FATHOM_FAULT ? HPS_ONES : HPS_AMBIENT;
        if (sample->magnitude != magnitude || sample->ambient != ambient) return false;
    } else if (raw == NO_TARGET || raw == INTERFERENCE) {
        kind = FATHOM_NO_TARGET;
        if (sample->interference != (raw == INTERFERENCE)) return false;
    }
    return sample->kind == kind && sample->model == facts->model &&
           sample->distance_mm == (kind == FATHOM_TARGET ? raw : 0);
}

static bool is_before(uint32_t a_us, uint32_t b_us) { return (int32_t)(a_us - b_us) < 0; }

static uint32_t oldest(const truth_t *truth)
{
    return truth->count > TRUTH_ROOM ? truth->count - TRUTH_ROOM : 0;
}

void truth_forget(truth_entry_t *entry)
{
    for (uint8_t i = 0; i < TRUTH_PROBES; i++) entry->values[i] = TRUTH_NOTHING;
}

static bool says(const truth_entry_t *entry, const fathom_sample_t *sample)
{
    return entry->values[sample->probe - 1] == (uint16_t)sample->raw;
}

/* Frame n, if it says that and was measured in time; else NULL. */
static truth_entry_t *fitting(truth_t *truth, uint32_t n, const fathom_sample_t *sample, uint32_t now_us,
                              uint32_t since_us)
{
    truth_entry_t *const entry = truth_at(truth, n);
    const bool is_in_time =
        !is_before(entry->measured_us, since_us) && !is_before(now_us, entry->measured_us);
    return says(entry, sample) && is_in_time ? entry : NULL;
}

/* Frames come in their order and each one once, but for those that are marked. */
static truth_entry_t *find_in_order(truth_t *truth, const fathom_sample_t *sample, uint32_t now_us,
                                    uint32_t since_us)
{
    enum { SWAPPED = 2 };
    const uint32_t newest = truth->newest_read;
    const bool is_first = sample->probe == soak_facts[truth->setting].first;
    truth_entry_t *entry;
    if (!is_first && newest != 0 && (entry = fitting(truth, newest - 1, sample, now_us, since_us)) != NULL)
        return entry; /* the probes of one frame share it */
    const uint32_t begin = newest > oldest(truth) ? newest : oldest(truth);
    for (uint32_t n = begin; n != truth->count; n++) {
        entry = fitting(truth, n, sample, now_us, since_us);
        if (entry == NULL) continue;
        truth->newest_read = n + 1;
        return entry;
    }
    for (uint32_t n = newest; n-- > oldest(truth) && n + SWAPPED >= newest;) {
        entry = fitting(truth, n, sample, now_us, since_us);
        if (entry != NULL && entry->is_twice) return entry;
    }
    return NULL;
}

static truth_entry_t *find_any(truth_t *truth, const fathom_sample_t *sample, uint32_t now_us,
                               uint32_t since_us)
{
    for (uint32_t n = truth->count; n-- > oldest(truth);) {
        truth_entry_t *const entry = fitting(truth, n, sample, now_us, since_us);
        if (entry != NULL) return entry;
    }
    return NULL;
}

truth_verdict_t truth_judge(truth_t *truth, const fathom_sample_t *sample, uint32_t now_us, uint32_t since_us,
                            bool in_order)
{
    if (sample->probe < 1 || sample->probe > TRUTH_PROBES || !is_consistent(truth, sample))
        return TRUTH_DAMAGED;
    truth_entry_t *const entry =
        in_order ? find_in_order(truth, sample, now_us, since_us) : find_any(truth, sample, now_us, since_us);
    if (entry != NULL) {
        entry->is_read = true;
        return TRUTH_RIGHT;
    }
    for (uint32_t n = truth->count; n-- > oldest(truth);)
        if (says(truth_at(truth, n), sample)) return TRUTH_STALE;
    return truth_said(truth, (uint16_t)sample->raw) ? TRUTH_PERMUTED : TRUTH_DAMAGED;
}

bool truth_said(const truth_t *truth, uint16_t raw)
{
    for (uint32_t n = truth->count; n-- > oldest(truth);)
        for (uint8_t i = 0; i < TRUTH_PROBES; i++)
            if (truth->log[n % TRUTH_ROOM].values[i] == raw) return true;
    return false;
}
