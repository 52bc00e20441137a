/* SPDX-License-Identifier: MIT */
/*
 * Selects the frames that a fault rule damages, by number or by chance. The faults of values are here; those of frames
 * are in fault_damage.c and fault_forge.c.
 */
#include "fault.h"

#include <string.h>

#include "internal/fault_parts.h"

/* ---- chance ---- */

/* Does it hit frame `number`? */
static void draw(fathom_sim_fault_rule_t *rule, uint32_t number)
{
    if (rule->left != 0) {
        rule->left--;
        rule->hit = true;
        return;
    }
    const bool is_chosen = fathom_sim_fault_below(rule, FATHOM_SIM_FAULT_ALWAYS_PPM) < rule->chance_ppm;
    rule->hit = is_chosen && (rule->at_frame == 0 || rule->at_frame == number);
    if (rule->hit && rule->run > 1) rule->left = rule->run - 1;
}

/* The echo of a request must be decided before it comes. */
static void set_echo(fathom_sim_fault_t *fault)
{
    bool echo = fault->line_echo;
    if (fault->line == NULL) return;
    for (uint8_t i = 0; i < fault->rules_used; i++)
        if (fault->rules[i].kind == FATHOM_SIM_FAULT_ECHO && fault->rules[i].hit && !fault->off) echo = true;
    fault->line->echo = echo;
}

static void draw_all(fathom_sim_fault_t *fault)
{
    for (uint8_t i = 0; i < fault->rules_used; i++) draw(&fault->rules[i], fault->number + 1);
    set_echo(fault);
}

/* ---- what is measured ---- */

static bool is_for(const fathom_sim_fault_rule_t *rule, uint8_t probe)
{
    return rule->code == 0 || rule->code == probe;
}

/* False: the kind changes no value, or has none to give. */
static bool another_value(const fathom_sim_fault_t *fault, uint8_t kind, uint8_t probe, int32_t *value)
{
    switch (kind) {
    case FATHOM_SIM_FAULT_STUCK:
        if (probe > 4 || (fault->known & (1u << probe)) == 0) return false;
        *value = fault->last[probe - 1];
        return true;
    case FATHOM_SIM_FAULT_INTERFERENCE:
        *value = FATHOM_SIM_INTERFERENCE;
        break;
    case FATHOM_SIM_FAULT_FAULT:
        *value = FATHOM_SIM_FAULT;
        break;
    case FATHOM_SIM_FAULT_NO_TARGET:
        *value = FATHOM_SIM_NO_TARGET;
        break;
    default:
        return false;
    }
    return fathom_sim_fault_applies(kind, fault->device);
}

static int32_t measured(void *ctx, uint8_t probe, int32_t value)
{
    fathom_sim_fault_t *const fault = (fathom_sim_fault_t *)ctx;
    const int32_t real = value;
    bool is_stuck = false;
    for (uint8_t i = 0; i < fault->rules_used && !fault->off; i++) {
        const fathom_sim_fault_rule_t *const rule = &fault->rules[i];
        int32_t other = value;
        if (!rule->hit || !is_for(rule, probe) || !another_value(fault, rule->kind, probe, &other)) continue;
        value = other;
        is_stuck = is_stuck || rule->kind == FATHOM_SIM_FAULT_STUCK;
        fault->measured_kinds |= FATHOM_SIM_FAULT_BIT(rule->kind);
    }
    if (probe <= 4 && !is_stuck) {
        fault->last[probe - 1] = real;
        fault->known = (uint8_t)(fault->known | 1u << probe);
    }
    return value;
}

/* ---- the frame ---- */

static void outgoing(void *ctx, fathom_sim_frame_t *frame)
{
    fathom_sim_fault_t *const fault = (fathom_sim_fault_t *)ctx;
    uint32_t kinds = fault->measured_kinds;
    fault->frames++;
    fault->number++;
    if (!fault->off) kinds |= fathom_sim_fault_damage(fault, frame);
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        if ((kinds & FATHOM_SIM_FAULT_BIT(kind)) != 0) fault->counters[kind]++;
    if (kinds != 0) fault->frames_hit++;
    fault->last_kinds = kinds;
    fault->seen_kinds |= kinds;
    fault->measured_kinds = 0;
    draw_all(fault);
}

/* ---- for the caller ---- */

void fathom_sim_fault_init(fathom_sim_fault_t *fault, uint32_t seed)
{
    memset(fault, 0, sizeof *fault);
    fault->seed = seed;
    fault->hooks.outgoing = outgoing;
    fault->hooks.measured = measured;
    fault->hooks.ctx = fault;
}

fathom_sim_fault_rule_t *fathom_sim_fault_add(fathom_sim_fault_t *fault, uint8_t kind, uint32_t chance_ppm,
                                              uint32_t at_frame)
{
    if (kind == 0 || kind >= FATHOM_SIM_FAULT_END || fault->rules_used == FATHOM_SIM_FAULT_RULES) return NULL;
    fathom_sim_fault_rule_t *const rule = &fault->rules[fault->rules_used];
    memset(rule, 0, sizeof *rule);
    rule->kind = kind;
    rule->chance_ppm = chance_ppm;
    rule->at_frame = at_frame;
    /* Far apart for neighbouring seeds and rules: multiplied by an odd number near 2^64 / phi. */
    rule->random =
        (fault->seed * FATHOM_SIM_FAULT_RULES + fault->rules_used + 1) * UINT64_C(0x9E3779B97F4A7C15);
    for (uint8_t i = 0; i < 4; i++) (void)fathom_sim_fault_random(rule);
    fault->rules_used++;
    draw(rule, fault->number + 1);
    set_echo(fault);
    return rule;
}

void fathom_sim_fault_attach(fathom_sim_fault_t *fault, fathom_sim_line_t *line, fathom_sim_device_t *device)
{
    fault->line = line;
    fault->device = device;
    fault->line_echo = line->echo;
    device->faults = &fault->hooks;
    set_echo(fault);
}

void fathom_sim_fault_enable(fathom_sim_fault_t *fault, bool on)
{
    fault->off = !on;
    set_echo(fault);
}

uint32_t fathom_sim_fault_take(fathom_sim_fault_t *fault)
{
    const uint32_t kinds = fault->seen_kinds;
    fault->seen_kinds = 0;
    return kinds;
}
