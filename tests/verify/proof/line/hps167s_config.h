/* SPDX-License-Identifier: MIT */
#ifndef HPS167S_CONFIG_H
#define HPS167S_CONFIG_H

#include "fathom/sensor/hps167s.h"
#include "transport.h"

/* Any config of the HPS-167S's driver, and any limits. */

static fathom_hps167s_limits_t any_limits;

static void any_hps167s_config(fathom_hps167s_config_t *config)
{
    any_modbus_config(&config->modbus);
    config->warm_up_s = any_8();
    config->no_warm_up = any_bool();
    config->same_responses = any_8();
    config->steps_per_degree = any_8();
    config->low_word_first = any_bool();
    any_limits.max_mm = any_16();
    any_limits.over_range_mm = any_16();
    any_limits.min_mm = any_16();
}

#endif
