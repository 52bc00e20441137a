/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FATHOM_H
#define FATHOM_FATHOM_H

/**
 * @file
 * @brief Includes the headers of all sensors and building blocks, and shows which one reads which sensor in which mode.
 *
 * The header costs nothing, because a function that is not called is not linked. Each driver returns a fathom_sensor_t
 * (sensor.h), and each reading is a fathom_sample_t (sample.h). include/README.md lists the headers by purpose.
 *
 * @code
 * #include "fathom/fathom.h"
 *
 * fathom_sensor_t sensor = fathom_a16_auto_sensor(&a16);    // after fathom_a16_auto_init()
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK) use(&sample);
 * @endcode
 */

/* A16, one ultrasonic probe */
#include "fathom/sensor/a16_auto.h"       /* UART automatic; RS232 before its first Modbus request */
#include "fathom/sensor/a16_controlled.h" /* UART controlled: one frame for each trigger */
#include "fathom/sensor/a16_modbus.h"     /* Modbus RTU on RS485 or RS232: the distances */
#include "fathom/sensor/a16_pwm.h"        /* PWM: one pulse for each trigger */
#include "fathom/sensor/a16_rs232.h"      /* RS232: returns from Modbus to automatic output */
#include "fathom/sensor/a16_settings.h"   /* Modbus RTU: all other registers */
#include "fathom/sensor/a16_switch.h"     /* switch output */

/* A05, four ultrasonic probes */
#include "fathom/sensor/a05_auto.h"       /* UART automatic */
#include "fathom/sensor/a05_dyp.h"        /* RS485 by the protocol 55 AA ("DYP protocol") */
#include "fathom/sensor/a05_modbus.h"     /* Modbus RTU on RS485 or UART; the address */
#include "fathom/sensor/a05_relay.h"      /* relay output */
#include "fathom/sensor/a05_relay_rule.h" /* the rule of the relay, for distances of any other mode */

/* HPS-167S, infrared time of flight, Modbus RTU on RS485 */
#include "fathom/codec/hps167s_registers.h" /* addresses of the commands, and the meaning of values */
#include "fathom/sensor/hps167s.h"          /* distances */
#include "fathom/sensor/hps167s_auto.h"     /* unsolicited frames */
#include "fathom/sensor/hps167s_info.h"     /* commands that read: #1 to #4 */
#include "fathom/sensor/hps167s_settings.h" /* commands that set: #6 to #15 */

/* HPS-167 and HPS-166, the same with a UART and frames of their own */
#include "fathom/codec/hps167_frames.h" /* the frames */
#include "fathom/sensor/hps167_uart.h"  /* distances, single or continuous */

/* All of them */
#include "fathom/models.h" /* the facts of their relatives, such as A02YYUW, JSN-SR04T and HC-SR04 */
#include "fathom/sensor/factory_line.h" /* the line settings with which they leave the factory */

/* Processing of readings */
#include "fathom/processing/alarm.h" /* an alarm: thresholds, hold times, and a side for an unknown distance */
#include "fathom/processing/level.h"  /* level and volume of a tank */
#include "fathom/processing/median.h" /* a median, and a gate that drops spikes */

/* Building blocks */
#include "fathom/engine/edges.h"         /* pulses by a pin interrupt, without capture hardware */
#include "fathom/engine/fair_share.h"    /* sensors of different speed on one line */
#include "fathom/engine/line_pins.h"     /* a line whose TX is a trigger or select, or whose RX is a switch */
#include "fathom/engine/modbus_client.h" /* the transport of the Modbus drivers over a line (line.h) */
#include "fathom/engine/sensor.h"        /* fathom_poll, for all of them */
#include "fathom/engine/transaction.h"   /* a request, its response, and the table of a protocol */
#include "fathom/engine/wait.h"          /* fathom_wait, which blocks */
#include "fathom/processing/debounce.h"  /* a switch made of distances, by the A16's rule */
#include "fathom/version.h"              /* the version of Fathom */

#endif
