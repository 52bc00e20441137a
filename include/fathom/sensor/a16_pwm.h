/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_PWM_H
#define FATHOM_A16_PWM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/pulse.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with PWM output (A16 1): each falling edge at its RX pin makes it measure and respond with one high pulse on TX,
 * whose width is the time of flight. pulse.h does the timing, and has what each width means.
 *
 * One sample a cycle of 221 ms; raw is the width of the pulse in us, time_us its end:
 *   FATHOM_TARGET      distance_mm by the datasheet's formula, or with the temperature of the air (pulse_width.h)
 *   FATHOM_NO_TARGET   the pulse of about 94 ms
 *   FATHOM_FAULT       a longer one, or the line stays high, when raw is 0
 * The errors of fathom_poll:
 *   FATHOM_ERR_NO_RESPONSE  no pulse in the cycle: no supply, a cut wire, not in this mode
 *   FATHOM_ERR_MALFORMED    a distance outside the window; refused and counted
 *   FATHOM_ERR_PORT         the capture or the break failed; returned by every poll until it works again
 * In the blind zone, nearer than 50 cm, a module may send any value; the shortest pulse, 3 ms, is 522 mm.
 */

/* The longest pulse in the hottest air, 94 ms at 85 degC, in mm and rounded up. */
enum { FATHOM_A16_PWM_MAX_MM_IN_AIR = 18000 };

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    /* The clock, the capture of the module's TX pin (a timer's, or of edges.h) and the trigger, its RX pin; and the
     * widths, which have defaults. */
    fathom_pulse_config_t pulse;
    fathom_dyp_window_t window; /* min_mm and max_mm alone; 0: 1 and 16350 mm, 18000 with in_air */
    /* false: the datasheet's formula. true: with air_dc, which is not in the datasheet; off by default, since the
     * module may compensate by itself. */
    bool in_air;
    int16_t air_dc; /* with in_air: tenths of a degree C, -400..850 */
} fathom_a16_pwm_config_t;

typedef struct {
    fathom_pulse_meter_t meter;
    fathom_dyp_window_t window;
    uint16_t sequence;
    uint16_t implausible; /* distances that were refused; stops at 65535 */
    int16_t air_dc;       /* the caller's to change at any time */
    bool in_air;
} fathom_a16_pwm_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: min_mm over max_mm; else what fathom_pulse_init returns. */
fathom_status_t fathom_a16_pwm_init(fathom_a16_pwm_t *sensor, const fathom_a16_pwm_config_t *config);

/* Lets the trigger go high; the memory is the caller's again. What it returns, and when to call it again: as
 * fathom_pulse_deinit. */
fathom_status_t fathom_a16_pwm_deinit(fathom_a16_pwm_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a16_pwm_sensor(fathom_a16_pwm_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
