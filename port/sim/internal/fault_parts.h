/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_FAULT_PARTS_H
#define FATHOM_SIM_FAULT_PARTS_H

#include "../fault.h"

/* Between the sources of the faults. Each uses those behind it: fault, fault_damage, fault_forge, fault_random. */

/* fault_random.c: 32 random bits; 0..end-1. */
uint32_t fathom_sim_fault_random(fathom_sim_fault_rule_t *rule);
uint32_t fathom_sim_fault_below(fathom_sim_fault_rule_t *rule, uint32_t end);

/* fault_damage.c: does to the frame what the rules that hit are for; returns the set of the kinds that changed it. */
uint32_t fathom_sim_fault_damage(fathom_sim_fault_t *fault, fathom_sim_frame_t *frame);

/* fault_forge.c. Kinds UNIT to EXCEPTION: makes it another frame with a right end. False: the kind does not fit it. */
bool fathom_sim_fault_forge(fathom_sim_fault_rule_t *rule, fathom_sim_frame_t *frame);

/* The unsolicited frame, in the frame's protocol, written to `bytes`; returns its length. */
uint8_t fathom_sim_fault_unasked(const fathom_sim_fault_t *fault, const fathom_sim_frame_t *frame,
                                 uint8_t *bytes);

/* fault_kinds.c. In which protocols does the kind do something? A set of FATHOM_SIM_STREAM and so on. */
uint8_t fathom_sim_fault_protocols(uint8_t kind);

#endif
