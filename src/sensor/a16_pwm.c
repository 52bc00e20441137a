/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_pwm.h"

#include "../common.h"
#include "fathom/codec/pulse_width.h"

/*
 * The driver of an A16 with PWM output. A pulse meter triggers and measures; this file converts the width to
 * a sample.
 */

const fathom_model_facts_t fathom_a16_pwm_model = {
    .min_mm = 0,     /* A16 1(3) has a shortest pulse, and no blind zone */
    .max_mm = 18000, /* 94 ms at 382.81 m/s, the speed of sound at 85 degrees C */
    .period_ms = 221,
    .us_per_dm = FATHOM_PULSE_WIDTH_A16_US_PER_DM,
    .start = FATHOM_STARTS_FALLING,
    .no_target_ms = 94,
};

/* Default of the period, in microseconds: that of the A16. */
#define DEFAULT_PERIOD_US 221000uL

/* Shorter pulses are noise if the blind zone is not known. The shortest pulse of the A16 is 3 ms (A16 1(3)), less 10 % for
 * the clocks of both sides. */
enum { DEFAULT_NOISE_US = 2700 };

/* How far the width of the pulse that means that nothing is in range may be off, in microseconds. */
enum { NO_TARGET_BELOW_US = 2000, NO_TARGET_ABOVE_US = 11000 };

static bool is_free_running(const fathom_model_facts_t *facts) { return facts->start == FATHOM_STARTS_ALONE; }

/* Returns three quarters of the shortest pulse of a model, inside 100 to 2700 us. */
static uint16_t noise_us(const fathom_model_facts_t *facts)
{
    const uint32_t us = ((uint32_t)facts->min_mm * facts->us_per_dm) / 128u;
    if ((us == 0u) || (us > DEFAULT_NOISE_US)) return DEFAULT_NOISE_US;
    return (uint16_t)((us < FATHOM_PULSE_SHORT_US) ? FATHOM_PULSE_SHORT_US : us);
}

/* Sets the times of the meter by the facts of the model. */
static void set_times(fathom_pulse_meter_t *meter, const fathom_model_facts_t *facts)
{
    const uint32_t no_target_us = fathom_dyp_us(facts->no_target_ms);
    uint32_t period_us = or_default(fathom_dyp_us(facts->period_ms), DEFAULT_PERIOD_US);
    /* A pulse that has begun before the meter is armed is not measured, so the next one ends later than a period. */
    if (is_free_running(facts)) period_us *= 2u;
    if (period_us < meter->trigger.period_us) period_us = meter->trigger.period_us;
    meter->trigger.period_us = period_us;
    meter->trigger.low_us = facts->trigger_us;
    meter->noise_us = noise_us(facts);
    meter->no_target_us = period_us;
    meter->stuck_us = period_us;
    if (no_target_us != 0u) {
        meter->no_target_us = no_target_us - NO_TARGET_BELOW_US;
        meter->stuck_us = no_target_us + NO_TARGET_ABOVE_US;
    }
}

/* Copies the configuration, if there is one. Returns true if each member is inside its range. */
static bool configure(fathom_a16_pwm_t *sensor, const fathom_a16_pwm_config_t *config)
{
    const fathom_model_facts_t *facts = &fathom_a16_pwm_model;
    fathom_pulse_meter_t *const meter = &sensor->meter;
    if (config != NULL) {
        facts = fathom_dyp_facts_or(config->model, facts);
        sensor->air_dc = config->air_dc;
        sensor->in_air = config->in_air;
        meter->trigger.period_us = config->period_us;
    }
    sensor->facts = facts;
    set_times(meter, facts);
    return fathom_dyp_has_range(facts) && (facts->us_per_dm != 0u) &&
           (sensor->air_dc >= FATHOM_PULSE_WIDTH_MIN_AIR_DC) &&
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
    if (configure(sensor, config)) status = fathom_pulse_init(&sensor->meter);
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
    if (is_free_running(sensor->facts))
        sensor->meter.trigger.left_us = 0; /* wait for the next pulse at once */
    if (reading.kind == FATHOM_TARGET) {
        mm = sensor->in_air ? fathom_pulse_width_mm_in_air(reading.width_us, sensor->air_dc)
                            : fathom_pulse_width_mm(reading.width_us, sensor->facts->us_per_dm);
        if ((mm < sensor->facts->min_mm) || (mm > sensor->facts->max_mm)) {
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
