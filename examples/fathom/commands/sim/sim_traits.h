/* SPDX-License-Identifier: MIT */
#ifndef SIM_TRAITS_H
#define SIM_TRAITS_H

#include "sensors/models.h"

/* The --with options of `fathom sim`: what the datasheets leave open, and what was set before. */

/* Does the sensor have what is named before the =? */
bool sim_trait_fits(const char *text, const model_t *model);

/* Takes NAME or NAME=VALUE. False after saying what is wrong with it. */
bool sim_trait_take(uint32_t traits[DEVICE_TRAITS], const char *command, const model_t *model,
                    const char *text);

/* The table, for the help. */
void sim_traits_print(FILE *to);

#endif
