/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_CONTROLLED_H
#define FATHOM_A16_CONTROLLED_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/engine/sensor.h"
#include "fathom/engine/stream.h"
#include "fathom/engine/trigger.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an A16 with controlled UART output (A16 3): each trigger starts one measurement and returns one frame.
 *
 * Each falling edge at the RX pin of the module starts a measurement. The module sends one frame FF H L SUM, 90 to 110
 * ms after the edge, at 9600 8N1. A pin makes the edge, or a UART break of the line, so that a serial adapter suffices.
 * A relative that waits for a byte gets it by fathom_output_line_byte() (line_pins.h); the byte counts as the edge. The
 * driver triggers again and again and never waits. include/COST.md has its size in the row `a16_controlled`.
 *
 * @code
 * const fathom_output_t trigger = fathom_output_pin(&pin);
 * fathom_a16_controlled_init(&a16, &line, &trigger, NULL);
 * sensor = fathom_a16_controlled_sensor(&a16);
 * for (;;)
 *     if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) show_mm(sample.distance_mm);
 * @endcode
 *
 * 1. **Samples.** There is one sample for each response. fathom_poll() returns it when the line has been silent for
 *    `gap_us` after the frame. `time_us` is the arrival of the last byte. The kind is FATHOM_TARGET, or the meaning of
 *    a value that is no distance (dyp.h).
 *
 * 2. **Sequence.** Each response increments `sequence`, a response with a refused value too. Each response is a new
 *    measurement, because the time between two triggers is at least the `period_ms` that the module needs (A16 3(2)).
 *
 * 3. **Which frame is the response.** A frame is the response if its last byte arrives `earliest_ms` to `latest_ms`
 *    after the edge, which are facts of the model. If the port has no time stamps, a byte may have arrived at any time since the previous poll; both ends are
 *    then wider by that time. The driver counts all other frames in `late` and drops them.
 *
 *        polls     |        |                                      |
 *        trigger            |edge  earliest_ms      latest_ms
 *        wire      [frame]  |      |<-- [response] -->|
 *        result    `late`                                          one sample
 *
 * 4. **Before the trigger.** No frame from before the trigger is a response. The driver reads the port directly after
 *    the edge, so that bytes that waited in the port are known to be too early.
 *
 * 5. **Limit.** The response to the previous trigger cannot be distinguished from the response to this one, if it
 *    arrives `earliest_ms` or more after this one: 200 ms after the previous trigger, with the default facts.
 *
 * 6. **Pauses.** If the program does not poll for more than `latest_ms` and FATHOM_LINE_LATE_US together, the line
 *    drops the bytes that wait in the port (line.h, rule 14). The trigger then has no response.
 *
 * 7. **Errors.** Each error belongs to one trigger. The driver continues after each error.
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_NO_RESPONSE | no byte arrived in time: no supply, a cut wire, or another mode |
 * | FATHOM_ERR_CHECKSUM | bytes arrived in time, but no valid frame |
 * | FATHOM_ERR_MALFORMED | the frame has a refused value: outside the range, or FFFF; see `measurement` (dyp.h) |
 * | FATHOM_ERR_PORT | the port is broken; returned by every poll until the port works again |
 * | FATHOM_ERR_PORT | the port refused for 1 s to begin or to end the break; returned once a second (trigger.h) |
 * | FATHOM_ERR_ARGUMENT | the initialisation failed or never ran, and the memory is zeroed |
 */

/**
 * @brief The facts that NULL selects (A16 3): 1 to 16350 mm, the default meanings, a response 80 to 130 ms after the
 * edge, and 121 ms between two triggers.
 *
 * The period "must be greater than 120ms" (A16 3(2)), also by a clock that counts in milliseconds. The response ends 90
 * to 110 ms after the edge (A16 3(3)); the rest is a margin for the clocks and for the frame.
 */
extern const fathom_model_facts_t fathom_a16_controlled_model;

/** @brief The configuration. A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Least time between two triggers, in microseconds, at most 2^31 - 1. A shorter time selects `period_ms` of
     * the model, which is the default; if that is 0, `latest_ms`.
     */
    uint32_t period_us;

    /**
     * @brief Silence that ends a frame (stream.h), in microseconds: 1042 to 65535.
     *
     * 0 selects 5000, or `gap_us` in the parts of the line if that is longer: a port that holds bytes back in the middle
     * of a frame, as behind an operating system, has a long one there.
     */
    uint16_t gap_us;

    /**
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a16_controlled_model.
     *
     * Must stay valid until fathom_a16_controlled_deinit().
     */
    const fathom_model_facts_t *model;
} fathom_a16_controlled_config_t;

/** @brief The driver, in the caller's memory. Call fathom_a16_controlled_init() before use. */
typedef struct {
    /** @brief Finds the frames. Invariant: the first member, so that its listener is the driver. */
    fathom_stream_t stream;

    /** @brief The line. Invariant: NULL unless the initialisation succeeded. */
    fathom_line_t *line;

    /** @brief Makes the edges. */
    fathom_trigger_t trigger;

    /** @brief The newest response. `refused_raw` and `implausible` may be read. */
    fathom_dyp_measurement_t measurement;

    /** @brief Clock at the last trigger, in microseconds. */
    uint32_t edge_us;

    /** @brief Earliest time at which the newest bytes can have arrived, in microseconds. */
    uint32_t came_us;

    /** @brief Number of frames that were no response (rule 3). Stops at 65535. The caller may set it to 0. */
    uint16_t late;

    /* private */
    bool waiting; /* for the response */
    bool heard;   /* bytes arrived while the response was possible */
    uint16_t values[1];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
} fathom_a16_controlled_t;

/**
 * @brief Initialises the driver, makes the trigger high and becomes the listener of the line.
 *
 * The first trigger comes 2 ms later, or `trigger_us` of the model. After an error the driver does not listen, and its memory is zeroed.
 *
 * @param sensor   The driver. Must stay valid until fathom_a16_controlled_deinit().
 * @param line     The initialised line, which has no other sensor. The driver becomes its listener. Must stay valid
 *                 until fathom_a16_controlled_deinit().
 * @param trigger  Drives the RX pin of the module: a pin, a break of the line (fathom_output_line_break()), or a byte
 *                 (fathom_output_line_byte()), as `start` of the model requires. Copied; its `ctx` must stay valid until fathom_a16_controlled_deinit().
 * @param config   The configuration. Not used after the call. NULL selects all defaults.
 * @retval FATHOM_OK               The driver listens. Next, call fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT     `line`, `trigger` or `trigger->set` is NULL, the line is not initialised, or a member
 *                                 of the configuration or a fact is outside its range. `latest_ms` is at least 1.
 * @retval FATHOM_ERR_BUSY         The line has another listener, which stays. The trigger was not touched.
 * @retval FATHOM_ERR_UNSUPPORTED  The port has no `set_break`, or the pin no `set`.
 */
fathom_status_t fathom_a16_controlled_init(fathom_a16_controlled_t *sensor, fathom_line_t *line,
                                           const fathom_output_t *trigger,
                                           const fathom_a16_controlled_config_t *config);

/**
 * @brief Stops listening and makes the trigger high.
 *
 * If the driver is no longer the listener of the line, the present listener stays. Do not poll this sensor after the
 * call.
 *
 * @param sensor  The driver.
 * @retval FATHOM_OK        The trigger is high. The memory belongs to the caller again. A pin always has this result.
 * @retval FATHOM_PENDING   The port refused to end the break. Call this function again.
 * @retval FATHOM_ERR_PORT  The break failed, or the port has refused for 1 s. Call this function again. If the program
 *                          gives up here, the memory belongs to the caller too. TX stays low, and the line sends
 *                          nothing until fathom_line_break() ends the break.
 */
fathom_status_t fathom_a16_controlled_deinit(fathom_a16_controlled_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_a16_controlled_poll().
 *
 * @param ctx     The driver, a fathom_a16_controlled_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_a16_controlled_poll().
 */
fathom_status_t fathom_a16_controlled_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_a16_controlled_t.
 * @return As fathom_a16_controlled_due_us().
 */
uint32_t fathom_a16_controlled_sensor_due_us(void *ctx);

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
static inline fathom_status_t fathom_a16_controlled_poll(fathom_a16_controlled_t *sensor,
                                                         fathom_sample_t *sample)
{
    return fathom_a16_controlled_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a16_controlled_due_us(fathom_a16_controlled_t *sensor)
{
    return fathom_a16_controlled_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). The sensor points to the driver. */
static inline fathom_sensor_t fathom_a16_controlled_sensor(fathom_a16_controlled_t *sensor)
{
    return fathom_sensor_make(fathom_a16_controlled_sensor_poll, fathom_a16_controlled_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
