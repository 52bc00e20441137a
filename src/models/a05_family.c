/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include "fathom/sensor/factory_line.h"
#include "models_internal.h"

/* The A05 with its printed range. No other module with its frames is known. a16_family.c says what a row is. */

#define A05_LINE .line_settings = (&fathom_a05_factory_line)

/* clang-format off */
#define ROWS(ROW) \
    /* A05 datasheet 1, a seller's page (range). */ \
    ROW(a05lyu, A05, AUTO, H, "A05LYU", "", "DYP", "", A05_LINE, RANGE(250, 4500)) \
    /* A05 datasheet 2, four projects. 2(3) and 3(3): 100 ms a probe. */ \
    ROW(a05_rs485, A05, 55AA, H, "A05-RS485", "", "DYP", "RS485", \
        A05_LINE, RANGE(250, 4500), .period_ms = 100) \
    /* A05 datasheet 3. */ \
    ROW(a05_modbus, A05, MODBUS, H, "A05-RS485", "", "DYP", "RS485", \
        A05_LINE, RANGE(250, 4500), .period_ms = 100)
/* clang-format on */

ROWS(MODEL_FACTS)

static const fathom_model_description_t descriptions[] = {ROWS(MODEL_DESCRIPTION)};

const fathom_model_table_t fathom_models_a05 = MODEL_TABLE(descriptions);
