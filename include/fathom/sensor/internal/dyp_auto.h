/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_AUTO_H
#define FATHOM_DYP_AUTO_H

#include "fathom/engine/line.h"
#include "fathom/engine/stream.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The common part of a16_auto.h and a05_auto.h: an ultrasonic sensor that sends frames without a request.
 *
 * A program needs of this header only the members `stream.counters` and `measurement`.
 */

/** @brief An ultrasonic sensor with automatic output, in the memory of its driver. */
typedef struct {
    /** @brief Finds the frames. `stream.counters` may be read and set to 0 (stream.h). */
    fathom_stream_t stream;

    /** @brief The newest frame. `refused_raw`, `refused_probe` and `implausible` may be read. */
    fathom_dyp_measurement_t measurement;

    /** @brief The line. Invariant: NULL unless the initialisation succeeded. */
    fathom_line_t *line;
} fathom_dyp_auto_t;

/**
 * @brief Initialises the common part and makes the stream the listener of the line.
 *
 * The driver first sets `line`, the members that fathom_stream_start() needs, and `values`, `facts`, `model`,
 * `address` and `first` of the measurement.
 *
 * @param sensor  The common part.
 * @retval FATHOM_OK            The stream listens.
 * @retval FATHOM_ERR_ARGUMENT  `line` is NULL or not initialised, or a member is outside its range.
 * @retval FATHOM_ERR_BUSY      The line has another listener, which stays.
 */
fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor);

/** @brief Stops listening. If the stream is not the listener of the line, the present listener stays. */
void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor);

/**
 * @brief Polls the line and fetches the newest frame.
 *
 * A frame that repeats the values of the measurement sooner than three quarters of `period_ms` of the facts after it is
 * the same measurement: `sequence` and `time_us` stay.
 *
 * @param sensor  The common part.
 * @retval FATHOM_OK            The measurement has the values of a new frame. Probe 1 waits for
 *                              fathom_dyp_measurement_next().
 * @retval FATHOM_PENDING       There is no new frame.
 * @retval FATHOM_ERR_STALE     As a16_auto.h.
 * @retval FATHOM_ERR_CHECKSUM  As a16_auto.h.
 * @retval FATHOM_ERR_PORT      As a16_auto.h.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 */
fathom_status_t fathom_dyp_auto_take(fathom_dyp_auto_t *sensor);

/** @brief Returns the time in microseconds until fathom_dyp_auto_take() must be called again if no byte arrives. */
uint32_t fathom_dyp_auto_due_us(const fathom_dyp_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
