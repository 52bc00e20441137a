/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include "fathom/sensor/factory_line.h"
#include "models_internal.h"

/* The HPS-167S. Its drivers take no facts; the row is for lists. a16_family.c says what a row is. */

/* clang-format off */
#define ROWS(ROW) \
    /* HPS-167S datasheet. */ \
    ROW(hps167s, HPS167S, MODBUS, H, "HPS-167S", "", "Hypersen", "RS485", \
        .line_settings = &fathom_hps167s_factory_line, RANGE(80, 18000))
/* clang-format on */

ROWS(MODEL_FACTS)

static const fathom_model_description_t descriptions[] = {ROWS(MODEL_DESCRIPTION)};

const fathom_model_table_t fathom_models_hps = MODEL_TABLE(descriptions);
