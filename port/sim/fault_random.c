/* SPDX-License-Identifier: MIT */
/* The random numbers of a fault rule. They are the same in every run. */
#include "internal/fault_parts.h"

/* Knuth's MMIX generator; its high half is the good one. */
uint32_t fathom_sim_fault_random(fathom_sim_fault_rule_t *rule)
{
    rule->random = rule->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(rule->random >> 32);
}

uint32_t fathom_sim_fault_below(fathom_sim_fault_rule_t *rule, uint32_t end)
{
    return (uint32_t)(((uint64_t)fathom_sim_fault_random(rule) * end) >> 32);
}
