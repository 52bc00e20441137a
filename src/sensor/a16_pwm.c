/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_pwm.h"

#include "../common.h"
#include "fathom/codec/pulse_width.h"

/*
 * The driver of an A16 with PWM output. A pulse meter triggers and measures; this file converts the width to
 * a sample.
 */

/* Copies the configuration, if there is one. Returns true if each member is inside its range. */
static bool configure(fathom_a16_pwm_t *sensor, const fathom_a16_pwm_config_t *config)
{
    fathom_dyp_window_t *const window = &sensor->window;
    if (config != NULL) {
        window->min_mm = config->window.min_mm;
        window->max_mm = config->window.max_mm;
        sensor->air_dc = config->air_dc;
        sensor->in_air = config->in_air;
    }
    const uint16_t default_max_mm =
        sensor->in_air ? (uint16_t)FATHOM_A16_PWM_MAX_MM_IN_AIR : (uint16_t)FATHOM_A16_MAX_MM;
    window->min_mm = (uint16_t)or_default(window->min_mm, 1);
    window->max_mm = (uint16_t)or_default(window->max_mm, default_max_mm);
    return (window->min_mm <= window->max_mm) && (sensor->air_dc >= FATHOM_PULSE_WIDTH_MIN_AIR_DC) &&
           (sensor->air_dc <= FATHOM_PULSE_WIDTH_MAX_AIR_DC);
}

fathom_status_t fathom_a16_pwm_init(fathom_a16_pwm_t *sensor, const fathom_capture_t *capture,
                                    const fathom_clock_t *clock, const fathom_output_t *trigger,
                                    const fathom_a16_pwm_config_t *config)
{
    fathom_status_t status = FATHOM_ERR_ARGUMENT;
    clear(sensor, sizeof *sensor);
    sensor->meter.capture = capture;
    sensor->meter.trigger.clock = clock;
    if (trigger != NULL) sensor->meter.trigger.output = *trigger;
    if (configure(sensor, config))
        status = fathom_pulse_init(&sensor->meter, (config != NULL) ? &config->pulse : NULL);
    if (status != FATHOM_OK) clear(sensor, sizeof *sensor);
    return status;
}

fathom_status_t fathom_a16_pwm_deinit(fathom_a16_pwm_t *sensor)
{
    return fathom_pulse_deinit(&sensor->meter);
}

fathom_status_t fathom_a16_pwm_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a16_pwm_t *const sensor = ctx;
    fathom_pulse_reading_t reading;
    uint16_t mm = 0;
    const fathom_status_t status = fathom_pulse_poll(&sensor->meter, &reading);
    if (status != FATHOM_OK) return status;
    if (reading.kind == FATHOM_TARGET) {
        mm = sensor->in_air ? fathom_pulse_width_mm_in_air(reading.width_us, sensor->air_dc)
                            : fathom_pulse_width_mm(reading.width_us);
        if ((mm < sensor->window.min_mm) || (mm > sensor->window.max_mm)) {
            count_one(&sensor->implausible);
            return FATHOM_ERR_MALFORMED;
        }
    }
    sample->time_us = reading.time_us;
    sample->magnitude = 0;
    sample->raw = reading.width_us;
    sensor->sequence++;
    sample->sequence = sensor->sequence;
    sample->distance_mm = mm;
    sample->precision = 0;
    sample->kind = reading.kind;
    sample->model = FATHOM_A16;
    sample->address = 0;
    sample->probe = 1;
    sample->ambient = 0;
    sample->interference = false;
    return FATHOM_OK;
}

uint32_t fathom_a16_pwm_sensor_due_us(void *ctx)
{
    const fathom_a16_pwm_t *const sensor = ctx;
    return fathom_pulse_due_us(&sensor->meter);
}
