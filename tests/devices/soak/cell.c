/* SPDX-License-Identifier: MIT */
#include "cell.h"

#include "theory.h"

/* So few that no counter of 16 bits stops. */
enum { CHUNK = 3000, LOOPS = 3, PORTS = 2 };

const uint32_t cell_rates_ppm[CELL_RATES] = {1000, 10000, 100000, 300000};

/* Six fifths of the time-out: the response is late for certain, and with the longest response of an A05 (400 ms + 720
 * ms, and its 13 bytes) within twice the time-out. A stream is just late. */
static uint32_t late_in_time_us(uint8_t setting)
{
    return soak_is_asked(setting) ? soak_facts[setting].timeout_us / 5 * 6 : 1500000;
}

uint32_t cell_late_beyond_us(uint8_t setting)
{
    return 2 * soak_facts[setting].timeout_us + soak_facts[setting].timeout_us / 4;
}

static uint32_t late_us_of(const cell_t *cell)
{
    return cell->late_us != 0 ? cell->late_us : late_in_time_us(cell->setting);
}

static void arm(const cell_t *cell, fathom_sim_fault_t *fault)
{
    for (uint8_t i = 0; i < cell->kinds_used; i++) {
        fathom_sim_fault_rule_t *const rule =
            fathom_sim_fault_add(fault, cell->kinds[i], cell->chance_ppm, 0);
        if (rule->kind == FATHOM_SIM_FAULT_LATE) rule->us = late_us_of(cell);
    }
}

/* From the end of the faults, and of what they have begun, to the next right reading. */
static void recover(rig_t *rig, rig_unit_t *unit, cell_result_t *result)
{
    fathom_sim_fault_enable(&unit->fault, false);
    uint32_t begin_us = rig->clock.now_us;
    const uint32_t under_way_us = unit->under_way_us - begin_us;
    if (under_way_us <= INT32_MAX) {
        rig_run(rig, under_way_us);
        begin_us += under_way_us;
    }
    const uint32_t bound_us = rig_recovery_us(unit);
    while (fathom_elapsed_us(unit->right_us, begin_us) > INT32_MAX &&
           fathom_elapsed_us(rig->clock.now_us, begin_us) <= 4 * bound_us)
        rig_turn(rig);
    uint32_t recovered_us = fathom_elapsed_us(unit->right_us, begin_us);
    if (recovered_us > INT32_MAX) recovered_us = fathom_elapsed_us(rig->clock.now_us, begin_us);
    if (recovered_us > bound_us) result->too_slow++;
    /* the one that came nearest to its bound */
    if ((uint64_t)recovered_us * result->bound_us >= (uint64_t)result->recovered_us * bound_us) {
        result->recovered_us = recovered_us;
        result->bound_us = bound_us;
    }
}

static void run_chunk(const cell_t *cell, uint32_t seed, uint64_t transactions, cell_result_t *result)
{
    static const uint32_t loops_us[LOOPS] = {100, 1000, 20000};
    static const uint8_t knows[PORTS] = {
        FATHOM_RX_TIMED | FATHOM_RX_SILENCE | FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN, 0};
    rig_t rig;
    rig_init(&rig, cell->setting, loops_us[seed % LOOPS], knows[seed / LOOPS % PORTS], &cell->options);
    rig_unit_t *const unit = rig_add(&rig, cell->setting, 1, seed);
    unit->truth.held_mm = cell->held_mm;
    arm(cell, &unit->fault);
    const uint64_t stuck_limit = 3; /* more says no more */
    while (unit->totals.transactions < transactions && unit->totals.stuck < stuck_limit) rig_turn(&rig);
    recover(&rig, unit, result);
    rig_account(unit);
    rig_totals_add(&result->totals, &unit->totals);
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        result->expected += (double)unit->totals.hits[kind] * theory_pass(cell->setting, kind) / 65536;
    result->expected += (double)unit->totals.joint * theory_pass_joint(cell->setting) / 65536;
    result->expected += (double)unit->totals.joint_full * theory_pass_full() / 65536;
}

void cell_run(const cell_t *cell, uint64_t transactions, cell_result_t *result)
{
    uint32_t seed = cell->seed, kinds = 0;
    for (uint8_t i = 0; i < cell->kinds_used; i++) kinds |= FATHOM_SIM_FAULT_BIT(cell->kinds[i]);
    if (theory_is_alike(cell->setting, kinds, late_us_of(cell)) != NULL) result->is_alike = true;
    /* at least one chunk for each way of polling, if there is enough for that */
    uint64_t chunk = transactions / (LOOPS * PORTS) + 1;
    if (chunk < 50) chunk = transactions < 50 ? transactions : 50;
    if (chunk > CHUNK) chunk = CHUNK;
    for (uint64_t done = 0; done < transactions; done += chunk) run_chunk(cell, seed++, chunk, result);
}

void cell_add(cell_result_t *a, const cell_result_t *b)
{
    rig_totals_add(&a->totals, &b->totals);
    a->expected += b->expected;
    a->is_alike = a->is_alike || b->is_alike;
    a->too_slow += b->too_slow;
    if ((uint64_t)b->recovered_us * a->bound_us >= (uint64_t)a->recovered_us * b->bound_us) {
        a->recovered_us = b->recovered_us;
        a->bound_us = b->bound_us;
    }
}

const char *cell_broken_rule(const cell_result_t *result)
{
    const rig_totals_t *const totals = &result->totals;
    const uint64_t most = theory_most(result->expected);
    if (totals->wrong_responses > most) return "wrong readings, more than the checksum must let pass";
    if (totals->old != 0 && !result->is_alike) return "old values";
    if (totals->stuck != 0) return "stuck";
    if (totals->unaccounted != 0) return "books that do not balance";
    if (totals->unexplained != 0) return "readings lost without a fault";
    if (result->too_slow != 0) return "recovered too slowly";
    if (totals->readings == 0) return "no readings at all";
    return NULL;
}
