/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_AUTO_H
#define FATHOM_A16_AUTO_H

#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp_auto.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an A16 with automatic output: UART automatic (A16 2), and RS232 (A16 5) before its first Modbus request.
 *
 * The module sends frames FF H L SUM without a request, at 9600 8N1 (A16 2(2), 2(3)). The driver listens to a line and
 * returns samples of these frames. The driver never sends a byte and never waits. It can select which distance the
 * module sends, by a pin or by a break of the line. include/COST.md has its size in the row `a16_auto`.
 *
 * @code
 * // `uart` is set to 9600 8N1. fathom_line_init_listening(&line, &parts) initialises a line without requests (line.h).
 * fathom_a16_auto_init(&a16, &line, NULL);
 * sensor = fathom_a16_auto_sensor(&a16);
 * for (;;)
 *     if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) show_mm(sample.distance_mm);
 * @endcode
 *
 * 1. **Samples.** A distance is a sample of the kind FATHOM_TARGET. Other values have a meaning, which the facts of
 *    the model change. By default FFFD is FATHOM_NO_TARGET, FFFE is FATHOM_NO_TARGET with `interference`, 0 is FATHOM_UNKNOWN,
 *    and the driver refuses FFFF. `distance_mm` is 0 unless the kind is FATHOM_TARGET. `time_us` is the arrival of the
 *    last byte of the frame. fathom_poll() returns the sample when the next frame begins, or when the line has been
 *    silent for `gap_us` after the frame.
 *
 * 2. **Sequence.** Each frame that fathom_poll() fetches increments `sequence`, a frame with a refused value too. If
 *    the program polls less often than the module sends, newer frames replace older ones. The replaced frames do not
 *    increment `sequence`; `base.stream.counters[FATHOM_STREAM_MISSED]` counts them. The datasheet prints no period of
 *    the frames. If a module sends faster than it measures, it repeats the old value. If its facts have `period_ms`, a
 *    frame with the old value within three quarters of this period is the same measurement: the sample has the
 *    `sequence` and the `time_us` of the first frame.
 *
 * 3. **Settling.** The processed value needs 2.5 to 7.5 s to follow a change, the real-time value about 500 ms
 *    (A16 2(2)).
 *
 * 4. **Errors.** fathom_poll() returns FATHOM_PENDING if there is nothing new. FATHOM_ERR_STALE and FATHOM_ERR_CHECKSUM
 *    are returned once every `stale_us` while there is no valid frame:
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_STALE | the line was silent for `stale_us`: no wire, no supply, or another mode |
 * | FATHOM_ERR_STALE | the program paused for longer than `stale_us` and 0.5 s, and the port dates no newer bytes (hal.h) |
 * | FATHOM_ERR_CHECKSUM | bytes, but no valid frame, for `stale_us`: damage, noise, another rate or another device |
 * | FATHOM_ERR_MALFORMED | once for each frame with a refused value: outside the range, or FFFF by default |
 * | FATHOM_ERR_PORT | the port is broken; returned by every poll until the port can be read again |
 * | FATHOM_ERR_ARGUMENT | the initialisation failed; or it never ran, and the memory is zeroed |
 *
 * After FATHOM_ERR_CHECKSUM read `base.stream.counters[FATHOM_STREAM_FRAMES]`. If it is 0, suspect the rate or the
 * device; else suspect noise. After FATHOM_ERR_MALFORMED, `base.measurement.refused_raw` is the refused value.
 */

/**
 * @brief The facts that NULL selects: 1 to 16350 mm, the default meanings, and no period.
 *
 * A program that accepts other values changes a copy (model_facts.h).
 */
extern const fathom_model_facts_t fathom_a16_auto_model;

/** @brief The configuration. A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief The output that drives the RX pin of the module: fathom_output_pin(), or fathom_output_line_break()
     * (line_pins.h) if the TX of the line is wired to it.
     *
     * A line of fathom_line_init_listening() can hold TX low too. If all members are 0, the program selects nothing. A
     * module whose RX is not connected sends the processed value (A16 2(2)). `select.ctx` must stay valid until
     * fathom_a16_auto_deinit().
     */
    fathom_output_t select;

    /**
     * @brief Time without a frame after which fathom_poll() returns an error, in microseconds: 1 to 2^31 - 1.
     *
     * 0 selects 2 s plus four periods of the model. If the model has no period (model_facts.h), and the module
     * sends less often than every 2 s, choose more.
     */
    uint32_t stale_us;

    /**
     * @brief Silence that starts and ends a frame (stream.h), in microseconds: 1042 to 65535.
     *
     * 0 selects 5000, or `gap_us` in the parts of the line if that is longer: a port that holds bytes back in the middle
     * of a frame, as behind an operating system, has a long one there.
     */
    uint16_t gap_us;

    /**
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a16_auto_model.
     *
     * Must stay valid until fathom_a16_auto_deinit().
     */
    const fathom_model_facts_t *model;

    /** @brief The value that is selected by the initialisation: a fathom_dyp_value_t. 0 selects FATHOM_PROCESSED. */
    uint8_t value;
} fathom_a16_auto_config_t;

/** @brief The driver, in the caller's memory. Call fathom_a16_auto_init() before use. */
typedef struct {
    /** @brief `base.stream.counters` and the refused values of `base.measurement` may be read. */
    fathom_dyp_auto_t base;

    /* private */
    fathom_output_t select;
    uint8_t value; /* fathom_dyp_value_t: the selected value */
    uint16_t values[1];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
} fathom_a16_auto_t;

/**
 * @brief Initialises the driver, makes it the listener of the line, and selects the value.
 *
 * After an error the driver does not listen, its memory is zeroed, and fathom_a16_auto_deinit() is not needed. After
 * FATHOM_OK call it before a second initialisation; otherwise a break that selects the real-time value stays on the
 * line.
 *
 * @param sensor  The driver. Must stay valid until fathom_a16_auto_deinit().
 * @param line    The initialised line, whose listener the driver becomes. It may also carry Modbus requests
 *                (a16_rs232.h). Must stay valid until fathom_a16_auto_deinit().
 * @param config  The configuration. Not used after the call. NULL selects all defaults.
 * @retval FATHOM_OK               The driver listens. Next, call fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT     `line` is NULL or not initialised, or a member of the configuration is outside its
 *                                 range.
 * @retval FATHOM_ERR_BUSY         The line has another listener, which stays: deinitialise its driver first. Or the
 *                                 port or a transaction uses the line, so that the break that selects the value cannot
 *                                 begin yet: poll the line and call again.
 * @retval FATHOM_ERR_UNSUPPORTED  `value` is FATHOM_REAL_TIME without `select`, the port has no `set_break`, or the
 *                                 pin has no `set`.
 * @retval FATHOM_ERR_PORT         As fathom_a16_auto_select().
 */
fathom_status_t fathom_a16_auto_init(fathom_a16_auto_t *sensor, fathom_line_t *line,
                                     const fathom_a16_auto_config_t *config);

/**
 * @brief Selects the value that the module sends (A16 2(2)): drives its RX pin high or low by `select`.
 *
 * This function is for UART automatic only; an RS232 module has register 0x0207 instead (a16_settings.h). The first
 * frames may still have the other value, for 0.5 s (real-time) or 2.5 to 7.5 s (processed). The frames do not show
 * this. While a break selects the real-time value, the line cannot send.
 *
 * @param sensor  The driver.
 * @param value   FATHOM_PROCESSED (RX high) or FATHOM_REAL_TIME (RX low).
 * @retval FATHOM_OK               The value is selected. A pin that has `set` always has this result.
 * @retval FATHOM_PENDING          The port is still sending. The selection has not changed: call again. If the port
 *                                 never stops sending, this never ends: use a limit.
 * @retval FATHOM_ERR_BUSY         A transaction is on the wire. The selection has not changed: call again.
 * @retval FATHOM_ERR_PORT         As fathom_line_break(). The selection has not changed: call again.
 * @retval FATHOM_ERR_ARGUMENT     `value` is none of the two, or the driver is not initialised.
 * @retval FATHOM_ERR_UNSUPPORTED  The configuration has no `select`, the port no `set_break`, or the pin no `set`.
 */
fathom_status_t fathom_a16_auto_select(fathom_a16_auto_t *sensor, fathom_dyp_value_t value);

/**
 * @brief Stops listening and ends a break that selects the real-time value.
 *
 * If another listener has replaced the driver, the present listener stays. A pin keeps its level. Do not poll this
 * sensor after the call. Other drivers of the line may be polled, but that does not release TX.
 *
 * @param sensor  The driver.
 * @retval FATHOM_OK        No break is held. The memory belongs to the caller again. A pin always has this result.
 * @retval FATHOM_PENDING   The port has not released TX yet. Call this function again.
 * @retval FATHOM_ERR_PORT  As fathom_line_break(). Call this function again. If the program gives up here, the memory
 *                          belongs to the caller too. TX stays low, and the line sends nothing until
 *                          fathom_line_break() ends the break.
 */
fathom_status_t fathom_a16_auto_deinit(fathom_a16_auto_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_a16_auto_poll().
 *
 * @param ctx     The driver, a fathom_a16_auto_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_a16_auto_poll().
 */
fathom_status_t fathom_a16_auto_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_a16_auto_t.
 * @return As fathom_a16_auto_due_us().
 */
uint32_t fathom_a16_auto_sensor_due_us(void *ctx);

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
static inline fathom_status_t fathom_a16_auto_poll(fathom_a16_auto_t *sensor, fathom_sample_t *sample)
{
    return fathom_a16_auto_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a16_auto_due_us(fathom_a16_auto_t *sensor)
{
    return fathom_a16_auto_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). The sensor points to the driver. */
static inline fathom_sensor_t fathom_a16_auto_sensor(fathom_a16_auto_t *sensor)
{
    return fathom_sensor_make(fathom_a16_auto_sensor_poll, fathom_a16_auto_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
