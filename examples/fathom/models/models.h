/* SPDX-License-Identifier: MIT */
#ifndef MODELS_H
#define MODELS_H

#include <stdio.h>

#include "models/devices.h"
#include "models/readers.h"
#include "settings/settings.h"

/* One way in which a sensor can be read and simulated. */
typedef struct {
    const char *name;
    bool is_asked; /* at an address; else it sends by itself */
    reader_init_t read;
    device_init_t simulate;
} model_mode_t;

enum { MODEL_MODES = 3 };

/* What the tool knows of a sensor. The first mode is the default, the line is the factory's. */
typedef struct {
    const char *name;
    const char *what;
    fathom_line_settings_t line;
    model_mode_t modes[MODEL_MODES]; /* rows without a name end it */
    const char *other_settings; /* options with other line settings that it can have; NULL: it has none */
    const setting_t *settings;
    uint8_t max_address;
    uint8_t probes;
    bool has_optics;  /* magnitude, ambient light and precision, and it can report a fault */
    uint16_t near_mm; /* between these the simulated target moves if nothing else is asked for */
    uint16_t far_mm;
} model_t;

enum { FACTORY_ADDRESS = 1 };

/* By name; NULL after a usage error that lists what there is. A mode's name NULL: the default. */
const model_t *model_find(const char *command, const char *name);
const model_mode_t *model_mode_find(const char *command, const model_t *model, const char *name);

/* 0 where that is an address, as over Modbus of an A16 and an A05; else 1. */
uint8_t model_least_address(const model_t *model, const model_mode_t *mode);

/* The table, for help texts. */
void models_print(FILE *to);

#endif
