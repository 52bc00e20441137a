/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_AUTO_H
#define FATHOM_A05_AUTO_H

#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp_auto.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an A05 that sends the distances of its four ultrasonic probes without a request (datasheet A05 1).
 *
 * The driver is the listener of a line at 9600 baud and 8N1. It finds the frames `FF 1H 1L 2H 2L 3H 3L 4H 4L SUM` by
 * the rules of stream.h, and each frame is one sample for each fitted probe. The driver sends nothing; it can only hold
 * the RX pin of the module low to select the values. It never waits and never allocates memory. include/COST.md has its
 * flash, RAM and stack (`a05_auto`).
 *
 * @warning The first Modbus request on the line stops the automatic output until the module is powered off and on (A05
 * 1(1)).
 *
 * @code
 * static fathom_a05_auto_t bumper;
 * fathom_line_init_listening(&line, &parts);         // line.h: a line without requests
 * fathom_a05_auto_init(&bumper, &line, NULL);        // all four probes
 * const fathom_sensor_t sensor = fathom_a05_auto_sensor(&bumper);
 *
 * fathom_sample_t near;                              // in the loop: each probe is one sample
 * while (fathom_poll(&sensor, &near) == FATHOM_OK)
 *     if (near.kind == FATHOM_TARGET) use(near.distance_mm);
 * @endcode
 *
 * 1. **Values.** The module sends processed or real-time values. The level of its RX pin in the first second after
 *    power-on decides which: high or open for processed, low for real-time. See fathom_a05_auto_select(). No frame says
 *    which values it has. The datasheet gives response times of 300 to 1500 ms and of about 300 ms (A05 1(1)).
 *
 * 2. **Samples.** `kind` is FATHOM_TARGET if the value is inside the range (1 to 6000 mm by default). The facts of
 *    the model give the values 0, FFFB, FFFD, FFFE and FFFF their meaning (dyp.h). By default FFFD is FATHOM_NO_TARGET,
 *    FFFE is FATHOM_NO_TARGET with `interference`, 0 is FATHOM_UNKNOWN, and FFFF is refused. A frame is returned when
 *    the line has been silent for `gap_us` behind it, or when the next frame begins.
 *
 * 3. **What `sequence` promises.** The samples of one frame have one `sequence` and one `time_us`, the clock at the
 *    last byte of the frame. `sequence` increases by 1 with each frame that the driver evaluates, also with a refused
 *    one, and wraps after 65535. A new number is a new frame, not always a new measurement. The datasheet prints no
 *    period of the frames. A frame that is sent sooner than the module measures has the previous values: a processed
 *    value follows a change within 300 to 1500 ms, a real-time value within about 300 ms. If the facts of the model have
 *    `period_ms`, a frame with the same values within three quarters of this period is the same measurement, and its
 *    samples keep `sequence` and `time_us`. The newest frame wins; older ones are counted in `base.stream.counters`.
 *
 * 4. **Errors of fathom_poll().** The driver continues after each.
 *
 *    | error                | cause                                                                               |
 *    |----------------------|-------------------------------------------------------------------------------------|
 *    | FATHOM_ERR_STALE     | Nothing was received for `stale_us`: no wire, no supply, or another mode. Or the    |
 *    |                      | newest frame is too old (stream.h, rule 6). Returned once every `stale_us`.         |
 *    | FATHOM_ERR_CHECKSUM  | Bytes were received for `stale_us`, but no frame: damage, noise, another rate, or   |
 *    |                      | another device. If `base.stream.counters[FATHOM_STREAM_FRAMES]` is 0, suspect the   |
 *    |                      | rate or the device; else suspect noise. Returned once every `stale_us`.             |
 *    | FATHOM_ERR_MALFORMED | The value of one probe is refused (rule 5).                                         |
 *    | FATHOM_ERR_PORT      | The port is broken. Returned by every poll until the port works again.              |
 *    |                      | Or the port does not end the break of fathom_a05_auto_select(). Then this error is  |
 *    |                      | returned once a second, and samples continue.                                       |
 *    | FATHOM_ERR_ARGUMENT  | The driver is not initialised.                                                      |
 *
 * 5. **Refused values.** A value outside the range, or FFFF, is no sample. The driver counts it in
 *    `base.measurement.implausible` and stores it in `refused_raw` and `refused_probe` there. The other probes of the
 *    frame are returned only if the place of the frame is sure (stream.h, rule 4) and the frame before had a refused
 *    value too. Else the frame may be damaged or out of step, and all of it is refused. So a probe that continues to
 *    send refused values costs the other probes one frame.
 *
 * 6. **Bound.** On a line that carries no requests, fathom_poll() returns a sample or an error at the latest `stale_us`
 *    and one polling interval after the previous one.
 */

/** @brief The facts that NULL selects: 1 to 6000 mm, the default meanings, and no period. */
extern const fathom_model_facts_t fathom_a05_auto_model;

/** @brief Configuration. Read only during fathom_a05_auto_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Time without a frame after which fathom_poll() returns an error, in microseconds: 1 to 2^31 - 1.
     *
     * 0 selects 2 s plus four periods of the model. The datasheet prints no period of the frames. If the model
     * has none (model_facts.h), and the unit sends less often than every 2 s, choose more.
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
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a05_auto_model.
     *
     * Must stay valid until fathom_a05_auto_deinit().
     */
    const fathom_model_facts_t *model;

    /**
     * @brief Fitted probes, bit (probe - 1): 1 to 15. 0 selects all four.
     *
     * A probe that is not fitted has neither a sample nor an error.
     */
    uint8_t probes;

    /**
     * @brief Output that drives the RX pin of the module, for fathom_a05_auto_select(). Zeroed: none.
     *
     * It is a pin, or a break of the line whose TX is connected to RX (fathom_output_line_break()). What it points to
     * must stay valid as long as the driver.
     */
    fathom_output_t select;
} fathom_a05_auto_config_t;

/**
 * @brief Time for which RX is held low to select real-time values, in microseconds.
 *
 * The module reads the pin in its first second (A05 1(1)); half a second is for the supply to rise.
 */
#define FATHOM_A05_SELECT_US 1500000uL

/**
 * @brief A driver, in the caller's memory. Call fathom_a05_auto_init() before use.
 *
 * The caller may read `base.stream.counters`, and `implausible`, `refused_probe` and `refused_raw` of
 * `base.measurement`. All other members are private.
 */
typedef struct {
    fathom_dyp_auto_t base; /**< The part that A16 and A05 share. */
    /* private */
    uint16_t values[4];                                            /* the values of the newest frame */
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A05_LENGTH)]; /* the memory of the stream */
    fathom_output_t select;                                        /* as in the config */
    uint32_t select_left_us; /* rest of the time for which RX is held low */
    uint32_t polled_us;      /* clock at the last poll while RX is held low */
    bool selecting;          /* true if RX is held low */
    uint8_t probes;          /* fitted probes, bit (probe - 1) */
    bool was_odd; /* true if the frame before had a refused value of a fitted probe, or there was none */
} fathom_a05_auto_t;

/**
 * @brief Initialises a driver and makes it the listener of the line. It does not change the level of RX.
 *
 * @param sensor  The driver, in any memory. Must stay valid until fathom_a05_auto_deinit().
 * @param line    The initialised line, whose listener the driver becomes. It may also carry Modbus, which stops the
 *                automatic output. Must stay valid until fathom_a05_auto_deinit().
 * @param config  The config. Read only during the call; what it points to must stay valid as long as the driver.
 *                NULL selects all defaults.
 * @retval FATHOM_OK            The driver listens. Next, pass fathom_a05_auto_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `line` is NULL or not initialised, `stale_us` is above 2^31 - 1, `gap_us` is 1 to 1041,
 *                              `min_mm` is above `max_mm`, a meaning does not exist, or `probes` is above 15. The
 *                              driver is zeroed.
 * @retval FATHOM_ERR_BUSY      The line has another listener, which stays. The driver is zeroed.
 */
fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, fathom_line_t *line,
                                     const fathom_a05_auto_config_t *config);

/**
 * @brief Sets the RX pin for the values that the module is to send. Call it right before the module is powered.
 *
 * For real-time values RX is low for FATHOM_A05_SELECT_US; then fathom_poll() makes it high. For processed values RX is
 * high. All received bytes and the counters of the stream are dropped, and `stale_us` starts again.
 *
 * @param sensor  The driver.
 * @param value   FATHOM_PROCESSED or FATHOM_REAL_TIME.
 * @retval FATHOM_OK               Switch the supply on now.
 * @retval FATHOM_ERR_ARGUMENT     There is no such value, or the driver is not initialised.
 * @retval FATHOM_ERR_UNSUPPORTED  Real-time values were selected without `select`, or the port cannot hold its TX low.
 * @retval FATHOM_ERR_BUSY         The line still sends, or the break of an earlier power-on has not ended. Call again.
 * @retval FATHOM_ERR_PORT         The port is broken.
 */
fathom_status_t fathom_a05_auto_select(fathom_a05_auto_t *sensor, fathom_dyp_value_t value);

/**
 * @brief Stops listening, if the driver is the listener of the line, and makes RX high if the driver holds it low.
 *
 * Do not poll this sensor after the call. Call this function again until it returns FATHOM_OK. If the program gives up
 * before, the memory belongs to the caller too. TX stays low, and the line sends nothing until
 * fathom_line_break(line, false) returns FATHOM_OK.
 *
 * @retval FATHOM_OK        The memory is the caller's again. A pin always gives this result.
 * @retval FATHOM_PENDING   The break has not ended (fathom_line_break()).
 * @retval FATHOM_ERR_PORT  The port is broken, or it refused for a second to end the break.
 */
fathom_status_t fathom_a05_auto_deinit(fathom_a05_auto_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_a05_auto_poll().
 *
 * @param ctx     The driver, a fathom_a05_auto_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_a05_auto_poll().
 */
fathom_status_t fathom_a05_auto_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_a05_auto_t.
 * @return As fathom_a05_auto_due_us().
 */
uint32_t fathom_a05_auto_sensor_due_us(void *ctx);

/**
 * @brief Polls the driver as fathom_poll() does, without a fathom_sensor_t.
 *
 * A program that calls only this function does not link the part of the driver that fathom_due_us() needs.
 *
 * @param sensor  The driver.
 * @param sample  Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*sample` is the reading of one probe. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_a05_auto_poll(fathom_a05_auto_t *sensor, fathom_sample_t *sample)
{
    return fathom_a05_auto_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a05_auto_due_us(fathom_a05_auto_t *sensor)
{
    return fathom_a05_auto_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_a05_auto_sensor(fathom_a05_auto_t *sensor)
{
    return fathom_sensor_make(fathom_a05_auto_sensor_poll, fathom_a05_auto_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
