/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/factory_line.h"

/* The line settings of sensors that were never set. */

const fathom_line_settings_t fathom_hps167s_factory_line = {19200, FATHOM_PARITY_EVEN, 1};

const fathom_line_settings_t fathom_hps167_factory_line = {115200, FATHOM_PARITY_NONE, 1};

const fathom_line_settings_t fathom_a16_factory_line = {9600, FATHOM_PARITY_NONE, 1};

const fathom_line_settings_t fathom_a05_factory_line = {9600, FATHOM_PARITY_NONE, 1};
