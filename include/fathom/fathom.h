/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FATHOM_H
#define FATHOM_FATHOM_H

/*
 * The map: which header for which sensor and mode. This one includes them all, which costs nothing: what is not called
 * is not linked. Every driver makes a fathom_sensor_t (sensor.h), and every reading is a fathom_sample_t (sample.h).
 */

/* A16, one ultrasonic probe */
#include "fathom/sensor/a16_auto.h"       /* UART automatic, and RS232 until its first Modbus request */
#include "fathom/sensor/a16_controlled.h" /* UART controlled: a frame for each trigger */
#include "fathom/sensor/a16_modbus.h"     /* Modbus RTU on RS485 or RS232: distances */
#include "fathom/sensor/a16_pwm.h"        /* PWM: the width of a pulse for each trigger */
#include "fathom/sensor/a16_rs232.h"      /* RS232: from Modbus back to automatic output */
#include "fathom/sensor/a16_settings.h"   /* Modbus RTU: all other registers */
#include "fathom/sensor/a16_switch.h"     /* switch output */

/* A05, four ultrasonic probes */
#include "fathom/sensor/a05_auto.h"       /* UART automatic */
#include "fathom/sensor/a05_dyp.h"        /* RS485 by 55 AA, the "DYP protocol" */
#include "fathom/sensor/a05_modbus.h"     /* Modbus RTU on RS485 or UART; the address */
#include "fathom/sensor/a05_relay.h"      /* relay output */
#include "fathom/sensor/a05_relay_rule.h" /* the relay's rule over distances of any other mode */

/* HPS-167S, infrared time of flight, Modbus RTU on RS485 */
#include "fathom/codec/hps167s_registers.h" /* addresses of the commands, and what their values mean */
#include "fathom/sensor/hps167s.h"          /* distances */
#include "fathom/sensor/hps167s_auto.h"     /* frames that it sends without a request */
#include "fathom/sensor/hps167s_info.h"     /* what can be read: commands #1 to #4 */
#include "fathom/sensor/hps167s_settings.h" /* what can be set: commands #6 to #15 */

/* What is made of their readings */
#include "fathom/processing/alarm.h" /* thresholds, hold times, and a safe side where the distance is not known */
#include "fathom/processing/level.h"  /* a tank's level and volume */
#include "fathom/processing/median.h" /* a median, and a gate that drops spikes */

/* What goes with them */
#include "fathom/engine/edges.h"         /* pulses by a pin interrupt, without capture hardware */
#include "fathom/engine/fair_share.h"    /* sensors of different speed on one line */
#include "fathom/engine/line_pins.h"     /* a line whose TX triggers or selects, or whose RX is a switch */
#include "fathom/engine/modbus_client.h" /* the transport of the Modbus drivers over a line (line.h) */
#include "fathom/engine/sensor.h"        /* fathom_poll, for all of them */
#include "fathom/engine/transaction.h"   /* a request, its response, and a protocol's table for a line */
#include "fathom/engine/wait.h"          /* fathom_wait, which blocks */
#include "fathom/processing/debounce.h"  /* a switch made of distances, by the A16's rule */
#include "fathom/version.h"              /* which Fathom this is */

#endif
