/* SPDX-License-Identifier: MIT */
#ifndef MODELS_H
#define MODELS_H

#include <stdio.h>

#include "sensors/model.h"

/* The models, a row each. Where several fit, a later one is tried before an earlier one. A new one is its folder, its
 * row, and its place in the two unions: reader_t.driver and device_t.simulator. */
enum { MODELS = 3 };
extern const model_t *const models[MODELS];

enum { FACTORY_ADDRESS = 1 };

/* The one with this id, which is one of the table. */
const model_t *model_of(uint8_t id);

/* 0 where that is an address, as over Modbus of an A16 and an A05; else 1. */
uint8_t model_least_address(const model_t *model, const model_mode_t *mode);

/* The table, for help texts. */
void models_print(FILE *to);

#endif
