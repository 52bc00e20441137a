/* SPDX-License-Identifier: MIT */
#ifndef MODELS_H
#define MODELS_H

#include "sensors/model.h"

/* The models, a row each. If several can be a device, a later one is tried first. A model with a driver of its own also
 * needs a place in the unions of driver.h and device.h. */
extern const model_t models[];
extern const size_t model_count;

enum { FACTORY_ADDRESS = 1 };

/* Returns the least address: 0 or 1. */
uint8_t model_least_address(const model_t *model, const model_mode_t *mode);

/* Returns the mode in which a setting can be read and set; NULL: the mode that uses Modbus. */
const model_mode_t *model_mode_of(const model_t *model, const setting_t *setting);

/* Returns true if no model loses settings by this read. At address 0, which is a broadcast to some models, the register
 * must belong to a model that can have that address. */
bool models_allow_read(uint8_t address, uint16_t first, uint16_t count);

/* Returns the first model that has one of these protocols (DECODE_...). */
const model_t *model_with(uint8_t protocols);

#endif
