/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FATHOM_H
#define FATHOM_FATHOM_H

/* Everything that an application needs. Including it costs nothing: what is not called is not linked. */
#include "fathom/a05_auto.h"
#include "fathom/a05_dyp.h"
#include "fathom/a05_modbus.h"
#include "fathom/a05_relay.h"
#include "fathom/a05_relay_rule.h"
#include "fathom/a16_auto.h"
#include "fathom/a16_controlled.h"
#include "fathom/a16_modbus.h"
#include "fathom/a16_pwm.h"
#include "fathom/a16_rs232.h"
#include "fathom/a16_settings.h"
#include "fathom/a16_switch.h"
#include "fathom/debounce.h"
#include "fathom/edges.h"
#include "fathom/fair_share.h"
#include "fathom/hps167s.h"
#include "fathom/hps167s_auto.h"
#include "fathom/hps167s_info.h"
#include "fathom/hps167s_registers.h"
#include "fathom/hps167s_settings.h"
#include "fathom/line_pins.h"
#include "fathom/modbus_client.h"
#include "fathom/sensor.h"
#include "fathom/version.h"
#include "fathom/wait.h"

#endif
