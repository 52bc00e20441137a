/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_PWM_H
#define FATHOM_A16_PWM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/pulse.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an A16 with PWM output (A16 1): triggers the module and measures the width of its pulse.
 *
 * Each falling edge at the RX pin of the module starts a measurement. The module responds with one high pulse on TX,
 * whose width is the time of flight. pulse.h does the timing and states what each width means. The driver never waits.
 * It needs no line; a capture measures the pulse (hal.h, edges.h). include/COST.md has its size in the row `a16_pwm`.
 *
 * @code
 * const fathom_output_t trigger = fathom_output_pin(&pin);
 * fathom_a16_pwm_init(&a16, &capture, &clock, &trigger, NULL);
 * sensor = fathom_a16_pwm_sensor(&a16);
 * for (;;)
 *     if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) show_mm(sample.distance_mm);
 * @endcode
 *
 * There is one sample per cycle, by default every 221 ms. `raw` is the width of the pulse in microseconds, and
 * `time_us` is its end. Each sample increments `sequence`, and each is a new measurement: the cycle is longer than the
 * 220 ms that the module needs (A16 1(2)).
 *
 * The relatives differ by their facts. JSN-SR04T, HC-SR04 and their like start at a high pulse: pass
 * fathom_output_inverted_pin() as the trigger. A module that sends pulses at its own pace (FATHOM_STARTS_ALONE) gets
 * fathom_output_none(). Each of its pulses is a sample; without one for two periods fathom_poll() returns
 * FATHOM_ERR_NO_RESPONSE.
 *
 * | kind | cause |
 * |---|---|
 * | FATHOM_TARGET | `distance_mm` by the scale of the model, or by the temperature of the air (pulse_width.h) |
 * | FATHOM_NO_TARGET | the pulse of about 94 ms, or of `no_target_ms` of the model |
 * | FATHOM_FAULT | a longer pulse; or the line stays high, then `raw` is 0 |
 * | FATHOM_UNKNOWN | only shorter pulses; `raw` is the longest width, `time_us` the end of the cycle |
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_NO_RESPONSE | no pulse in the cycle: no supply, a cut wire, not in this mode |
 * | FATHOM_ERR_MALFORMED | a distance outside the range; `implausible` counts it |
 * | FATHOM_ERR_STALE | the program polled more than 2.5 s after the end of the pulse |
 * | FATHOM_ERR_PORT | the capture or the output fails (in every poll), or the output refuses (once a second) |
 * | FATHOM_ERR_ARGUMENT | the initialisation failed or never ran, and the memory is zeroed; fathom_due_us() is 0 then |
 *
 * A program that polls gets a sample or an error within `2 * cycle_us + low_us + 3 * P` (pulse.h), where P is the longest
 * time between two polls: 444 ms + 3 * P by default. If a break is the trigger, add 2 s + 2 * P. pulse.h has the conditions.
 *
 * Nearer than 50 cm, in the blind zone, a module may send any value. The shortest pulse of the datasheet, 3 ms, is
 * 522 mm.
 */

/**
 * @brief The facts that NULL selects (A16 1): 18000 mm, 57.5 us for each centimetre, a pulse of 94 ms if nothing is
 * in range, and 221 ms between two triggers.
 *
 * The period "must be greater than 220ms" (A16 1(2)), also by a clock that counts in milliseconds. 18000 mm is the
 * longest pulse in the hottest air, rounded up. By the datasheet's formula the longest distance is 16000 mm, since a pulse
 * of 92 ms or more means that nothing is in range.
 */
extern const fathom_model_facts_t fathom_a16_pwm_model;

/** @brief The configuration. A member that is 0 takes its default. */
typedef struct {
    /**
     * The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a16_pwm_model. Must stay
     * valid until fathom_a16_pwm_deinit(). `us_per_dm` is at least 1.
     *
     * `no_target_ms` is the width of the pulse that means that nothing is in range: pulses from 2 ms less to 11 ms more
     * are FATHOM_NO_TARGET, and longer ones FATHOM_FAULT. If it is 0, every pulse up to the period is a distance.
     * Pulses shorter than three quarters of that of `min_mm` are noise (pulse.h), but at least those below 100 us, and at
     * most those below 2700 us; if `min_mm` is 0, those below 2700 us.
     */
    const fathom_model_facts_t *model;
    /** Least time between two triggers, in microseconds, at most 2^31 - 1. A shorter time selects `period_ms` of the
     * model, or 221000 if that is 0. Of a module that sends pulses at its own pace: the longest wait for a pulse, at least
     * two periods. */
    uint32_t period_us;
    /** Compute the distance with the speed of sound at `air_dc`; else by `us_per_dm` of the model. The datasheet does
     * not say whether the module compensates for the temperature itself, so false is the default. */
    bool in_air;
    int16_t air_dc; /**< Temperature of the air with `in_air`, in tenths of a degree C: -400..850. */
} fathom_a16_pwm_config_t;

/** @brief The driver, in the caller's memory. Call fathom_a16_pwm_init() before use. */
typedef struct {
    fathom_pulse_meter_t meter;        /**< The meter. `noises` and `stales` may be read and set to 0. */
    const fathom_model_facts_t *facts; /**< The facts of the model. */
    uint16_t sequence;                 /**< Number of the last sample. */
    uint16_t implausible;              /**< Refused distances; stops at 65535. */
    int16_t air_dc;                    /**< The caller may change it at any time, -400..850. */
    bool in_air;                       /**< As in the configuration. */
} fathom_a16_pwm_t;

/**
 * @brief Initialises the driver and makes the trigger high. If the function fails, the driver is zeroed.
 *
 * @param sensor   The driver. Must stay valid until fathom_a16_pwm_deinit().
 * @param capture  Captures the TX pin of the module, with `arm` and `take`; not shared. Must stay valid as long as the
 *                 driver.
 * @param clock    The clock. Must stay valid as long as the driver.
 * @param trigger  Drives the RX pin of the module: a pin, or the break of a UART that has no other use. Copied; its
 *                 `ctx` must stay valid as long as the driver.
 * @param config   The configuration. Not used after the call. NULL selects all defaults.
 * @retval FATHOM_OK               The driver is ready. Next, call fathom_poll(). The first trigger comes 2 ms
 *                                 later, or `trigger_us` of the model.
 * @retval FATHOM_ERR_ARGUMENT     `capture`, `clock` or `trigger` or one of their functions is NULL, or a member of the
 *                                 configuration or a fact is outside its range.
 * @retval FATHOM_ERR_UNSUPPORTED  The UART has no `set_break`, or the pin no `set`.
 */
fathom_status_t fathom_a16_pwm_init(fathom_a16_pwm_t *sensor, const fathom_capture_t *capture,
                                    const fathom_clock_t *clock, const fathom_output_t *trigger,
                                    const fathom_a16_pwm_config_t *config);

/**
 * @brief Makes the trigger high, if it is low. Call it again, and do not poll, unless it returns FATHOM_OK.
 *
 * @param sensor  The driver.
 * @retval FATHOM_OK        The trigger is high. The memory belongs to the caller again. A pin always has this result.
 * @retval FATHOM_PENDING   The UART refused to end the break.
 * @retval FATHOM_ERR_PORT  The break failed, or the UART has refused for 1 s. If the program gives up, the memory
 *                          belongs to the caller too, and the trigger stays low.
 */
fathom_status_t fathom_a16_pwm_deinit(fathom_a16_pwm_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_a16_pwm_poll().
 *
 * @param ctx     The driver, a fathom_a16_pwm_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_a16_pwm_poll().
 */
fathom_status_t fathom_a16_pwm_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_a16_pwm_t.
 * @return As fathom_a16_pwm_due_us().
 */
uint32_t fathom_a16_pwm_sensor_due_us(void *ctx);

/**
 * @brief Polls the driver as fathom_poll() does, without a fathom_sensor_t.
 *
 * A program that calls only this function does not link the part of the driver that fathom_due_us() needs.
 *
 * @param sensor  The driver.
 * @param sample  Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*sample` is a new reading. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_a16_pwm_poll(fathom_a16_pwm_t *sensor, fathom_sample_t *sample)
{
    return fathom_a16_pwm_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no pulse ends.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a16_pwm_due_us(fathom_a16_pwm_t *sensor)
{
    return fathom_a16_pwm_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). */
static inline fathom_sensor_t fathom_a16_pwm_sensor(fathom_a16_pwm_t *sensor)
{
    return fathom_sensor_make(fathom_a16_pwm_sensor_poll, fathom_a16_pwm_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
