/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include "fathom/sensor/factory_line.h"
#include "models_internal.h"

/* The HPS-167S and its relatives with a UART. Their drivers take no facts; the rows are for lists and line settings.
 * a16_family.c says what a row is. */

/* clang-format off */
#define ROWS(ROW) \
    /* HPS-167S datasheet. */ \
    ROW(hps167s, HPS167S, MODBUS, H, "HPS-167S", "", "Hypersen", "RS485", \
        .line_settings = &fathom_hps167s_factory_line, RANGE(80, 18000)) \
    /* PX4's driver: 20 ms. No range: that of the HPS-167S. */ \
    ROW(hps167, HPS167S, 0A, H, "HPS-167", "HPS-167U", "Hypersen", "UART", \
        .line_settings = &fathom_hps167_factory_line, RANGE(80, 18000), .period_ms = 20) \
    /* A project's program. No baud rate, period and range: those of the HPS-167 and HPS-167S. */ \
    ROW(hps166, HPS167S, 0A, H, "HPS-166", "", "Hypersen", "UART", \
        .line_settings = &fathom_hps167_factory_line, RANGE(80, 18000), .period_ms = 20)
/* clang-format on */

ROWS(MODEL_FACTS)

static const fathom_model_description_t descriptions[] = {ROWS(MODEL_DESCRIPTION)};

const fathom_model_table_t fathom_models_hps = MODEL_TABLE(descriptions);
