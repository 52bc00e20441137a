/* SPDX-License-Identifier: MIT */
#ifndef SIM_FAULTS_H
#define SIM_FAULTS_H

#include "sensors/models.h"
#include "sim/fault.h"

/* The --fault options of `fathom sim`. */
typedef struct {
    uint8_t kind;
    uint32_t chance_ppm;
    uint32_t at_frame;
} sim_fault_t;

typedef struct {
    const char *texts[FATHOM_SIM_FAULT_RULES];
    sim_fault_t list[FATHOM_SIM_FAULT_RULES];
    uint32_t count; /* of all that were given, also of those beyond the list */
} sim_faults_t;

/* Takes the text of one option. */
void sim_faults_note(sim_faults_t *faults, const char *text);

/* Understands them all. False after saying what is wrong with one. */
bool sim_faults_parse(sim_faults_t *faults, const char *command, const model_t *model,
                      const model_mode_t *mode);

void sim_faults_begin(const sim_faults_t *faults, fathom_sim_fault_t *fault, uint32_t seed);

/* The kinds, for the help. */
void sim_faults_print(FILE *to);

#endif
