/* SPDX-License-Identifier: MIT */
#include "defences.h"

#include <string.h>

#include "cell.h"

static void run_cell(uint8_t setting, uint8_t kind, uint32_t chance_ppm, uint16_t held_mm,
                     const soak_options_t *options, uint64_t transactions, uint32_t seed,
                     cell_result_t *result)
{
    const cell_t cell = {.setting = setting,
                         .kinds_used = kind != 0,
                         .kinds = {kind},
                         .chance_ppm = chance_ppm,
                         .held_mm = held_mm,
                         .seed = seed,
                         .options = *options};
    memset(result, 0, sizeof *result);
    cell_run(&cell, transactions, result);
}

/* A frame with a byte too few in one place and one too many in another has the right length, and one in 256 of them
 * passes, but then the distances between the two are made of halves. Half the frames are hit so. */
static void window(uint64_t transactions, uint32_t seed, defence_result_t *result)
{
    static const uint16_t max_mm[2] = {0, UINT16_MAX};
    uint64_t wrong[2];
    result->what = "wrong readings";
    for (uint8_t i = 0; i < 2; i++) {
        const cell_t cell = {.setting = SOAK_A05_AUTO,
                             .kinds_used = 2,
                             .kinds = {FATHOM_SIM_FAULT_DROP, FATHOM_SIM_FAULT_INSERT},
                             .chance_ppm = 700000,
                             .seed = seed,
                             .options = {.max_mm = max_mm[i]}};
        cell_result_t cell_result = {0};
        cell_run(&cell, 2 * transactions, &cell_result);
        wrong[i] = cell_result.totals.wrong_responses;
    }
    result->with = wrong[0];
    result->without = wrong[1];
}

/* 511 mm held still is FF 01 FF FF, which is a valid frame one byte later too. */
static void gaps(uint64_t transactions, uint32_t seed, defence_result_t *result)
{
    const soak_options_t options = {.max_mm = 0};
    cell_result_t cell;
    result->what = "frames of 511 mm without a reading";
    run_cell(SOAK_A16_AUTO, 0, 0, 511, &options, transactions, seed, &cell);
    result->with = cell.totals.lost; /* that which is on its way when a run ends */
    run_cell(SOAK_A16_TIGHT, 0, 0, 511, &options, transactions, seed, &cell);
    result->without = cell.totals.lost;
}

static void stale(uint64_t transactions, uint32_t seed, defence_result_t *result)
{
    const soak_options_t as_ever = {.stale_us = 0};
    const soak_options_t never = {.stale_us = INT32_MAX};
    cell_result_t cell;
    result->what = "times that it is stuck";
    run_cell(SOAK_A16_AUTO, FATHOM_SIM_FAULT_POWER_CYCLE, 300000, 0, &as_ever, transactions, seed, &cell);
    result->with = cell.totals.stuck;
    run_cell(SOAK_A16_AUTO, FATHOM_SIM_FAULT_POWER_CYCLE, 300000, 0, &never, transactions, seed, &cell);
    result->without = cell.totals.stuck;
}

/* Writes to a unit that is not there, on a line that echoes: how many are said to be done? */
static uint64_t acknowledged(uint8_t echo, uint64_t writes)
{
    const soak_options_t options = {.echo = echo};
    fathom_modbus_request_t request;
    uint64_t done = 0;
    rig_t rig;
    rig_init(&rig, SOAK_A16_REAL_TIME, 1000, FATHOM_RX_TIMED, &options);
    rig.wire.echo = true;
    for (; writes != 0; writes--) {
        memset(&request, 0, sizeof request);
        request.transaction.timeout_us = 100000;
        fathom_modbus_write_single_register(&request.message, 1, 0x0200, 2);
        (void)fathom_modbus_client_submit(&rig.line, &request);
        while (request.transaction.status == FATHOM_PENDING) {
            (void)fathom_line_poll(&rig.line);
            fathom_sim_clock_advance(&rig.clock, 1000);
        }
        if (request.transaction.status == FATHOM_READY) done++;
    }
    return done;
}

static void echo(uint64_t transactions, uint32_t seed, defence_result_t *result)
{
    result->what = "writes to a dead unit that were acknowledged";
    result->with = acknowledged(FATHOM_LINE_ECHO_AUTO, transactions / 100);
    result->without = acknowledged(FATHOM_LINE_ECHO_OFF, transactions / 100);
}

const defence_t defences[DEFENCES] = {
    {"plausibility window", window},
    {"pauses that are seen", gaps},
    {"stale deadline", stale},
    {"echo found out", echo},
};

bool defence_matters(const defence_result_t *result) { return result->without > 2 * result->with; }
