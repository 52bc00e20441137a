/* SPDX-License-Identifier: MIT */
#include "theory.h"

#include <math.h>
#include <stddef.h>

#include "settings.h"
#include "sim/fault.h"

/*
 * A CRC of 16 bits sees every damage to one byte (all bursts of up to 16 bits), and one in 65536 of the rest
 * passes. A sum of 8 bits sees every damage to one byte that stays one byte, and one in 256 of the rest passes.
 * In a stream FF has to stand behind the frame besides, which another byte does once in 256: the byte that one
 * too many leaves over, or that of the next frame where no gap is between.
 */
enum { NEVER = 0, CRC = 1, START_AND_SUM = 1, SUM = 256 };

uint32_t theory_pass(uint8_t setting, uint8_t kind)
{
    const uint8_t proof = soak_facts[setting].proof;
    const uint32_t windows = soak_facts[setting].length; /* each place where one could begin */
    switch (kind) {
    case FATHOM_SIM_FAULT_INSERT: /* what follows is one byte out of place, and all is there */
        if (proof == SOAK_GAP) return START_AND_SUM;
        return proof == SOAK_CRC ? CRC : proof == SOAK_NO_GAP ? windows * START_AND_SUM : SUM;
    case FATHOM_SIM_FAULT_DROP:
    case FATHOM_SIM_FAULT_TRUNCATE:
    case FATHOM_SIM_FAULT_OVERRUN:
    case FATHOM_SIM_FAULT_SPLIT:
    case FATHOM_SIM_FAULT_POWER_CYCLE: /* too short: what is missing can only come from the next frame */
        return proof == SOAK_CRC ? CRC : proof == SOAK_NO_GAP ? windows * START_AND_SUM : NEVER;
    case FATHOM_SIM_FAULT_TRAILING:
    case FATHOM_SIM_FAULT_NOISE:
        return proof == SOAK_CRC ? CRC : proof == SOAK_SUM ? NEVER : windows * START_AND_SUM;
    case FATHOM_SIM_FAULT_COUNT:
    case FATHOM_SIM_FAULT_FLIP_BIT:
    case FATHOM_SIM_FAULT_FLIP_BYTE:
    case FATHOM_SIM_FAULT_PARITY:
    case FATHOM_SIM_FAULT_FRAMING:
    case FATHOM_SIM_FAULT_BREAK: /* without gaps, chance may show a frame elsewhere */
        return proof == SOAK_NO_GAP ? windows * START_AND_SUM : NEVER;
    default:
        return NEVER;
    }
}

uint32_t theory_pass_joint(uint8_t setting)
{
    const uint8_t proof = soak_facts[setting].proof;
    if (proof == SOAK_NO_GAP) return 2u * soak_facts[setting].length * START_AND_SUM; /* of two frames */
    return proof == SOAK_CRC ? CRC : SUM;
}

uint32_t theory_pass_full(void) { return SUM; }

uint64_t theory_most(double expected)
{
    if (expected <= 0) return 0;
    double term = exp(-expected);
    double left = 1 - term;
    uint64_t most = 0;
    if (expected > 500) return (uint64_t)(expected + 5 * sqrt(expected) + 5); /* normal; 5 sigma */
    while (left > 1e-6 && most < 2000) {
        most++;
        term *= expected / (double)most;
        left -= term;
    }
    return most;
}

const theory_alike_t theory_alike[THEORY_ALIKE] = {
    {SOAK_SETTINGS, FATHOM_SIM_FAULT_UNASKED, 0,
     "an unsolicited frame, of the very shape of the response, while the next one is waited for"},
    {SOAK_SETTINGS, FATHOM_SIM_FAULT_LATE, 0,
     "a response that comes later than twice its time-out, while the next one is waited for"},
    {SOAK_SETTINGS, FATHOM_SIM_FAULT_CLOCK_JUMP, FATHOM_SIM_FAULT_LATE,
     "the same: by the host's clock twice the time-out has passed"},
};

const theory_alike_t *theory_is_alike(uint8_t setting, uint32_t kinds, uint32_t late_us)
{
    const soak_facts_t *const facts = &soak_facts[setting];
    const bool is_too_late = late_us + facts->response_us > 2 * facts->timeout_us;
    if (!soak_is_asked(setting)) return NULL;
    for (uint8_t i = 0; i < THEORY_ALIKE; i++) {
        const theory_alike_t *const entry = &theory_alike[i];
        if ((kinds & FATHOM_SIM_FAULT_BIT(entry->kind)) == 0) continue;
        if (entry->setting != SOAK_SETTINGS && entry->setting != setting) continue;
        if (entry->beside != 0 && (kinds & FATHOM_SIM_FAULT_BIT(entry->beside)) == 0) continue;
        if (entry->kind == FATHOM_SIM_FAULT_LATE && !is_too_late) continue;
        return entry;
    }
    return NULL;
}
