/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MEDIAN_H
#define FATHOM_MEDIAN_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The median of the last 3 to 15 samples of one probe, behind a gate that drops spikes.
 *
 * The median works for any sensor in any mode. include/COST.md has its size in the row `median`.
 *
 * @code
 * static uint16_t window[5];
 * fathom_median_t median;
 * fathom_median_init(&median, &(fathom_median_config_t){.window = window, .count = 5, .gate_mm = 300});
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK && fathom_median_add_sample(&median, &sample, &steady))
 *     use(&steady);
 * if (fathom_median_advance(&median, clock.now_us(clock.ctx))) warn();
 * @endcode
 *
 * | sample | counts as |
 * |---|---|
 * | FATHOM_TARGET | its millimetres |
 * | FATHOM_NO_TARGET, FATHOM_FAR | farther than every distance, so the median is FATHOM_NO_TARGET if most samples are |
 * | FATHOM_NEAR | nearer than every distance, 0 mm, so the median may be FATHOM_NEAR |
 * | FATHOM_UNKNOWN, FATHOM_FAULT, or an error, which has no sample | nothing: window and row stay as they are |
 *
 * If no sample counts for more than `unknown_us`, the window is emptied by the next sample that counts, or by
 * fathom_median_advance(), which reports it. A spike counts here. There is a median when the window is full, and then
 * with each sample that counts and is no spike. Of an even number of samples the median is the nearer of the two in
 * the middle, so the median is always a value that was measured.
 *
 * **The gate.** A sample that is more than `gate_mm` nearer or farther than the median is a spike. Spikes are dropped
 * and counted. After `gate_row` spikes in a row, wherever each of them was, something has moved: the next sample is
 * not dropped, but empties the window and is the first one of a new window. The difference between a distance and
 * "farther than every distance" is always more than `gate_mm`. While the window is not full, no sample is a spike.
 *
 * A distance of 0 mm is returned as FATHOM_NEAR, and 65535 mm as FATHOM_NO_TARGET. No sensor of this library has
 * either.
 *
 * The functions use no clock but the times of the samples, may be called from any context, and do no I/O.
 */

/** @brief Limits and defaults. */
enum {
    FATHOM_MEDIAN_MIN_COUNT = 3,       /**< Least `count`. */
    FATHOM_MEDIAN_MAX_COUNT = 15,      /**< Greatest `count`. */
    FATHOM_MEDIAN_DEFAULT_GATE_ROW = 2 /**< Default of `gate_row`. */
};

/** Default of `unknown_us`. */
#define FATHOM_MEDIAN_DEFAULT_UNKNOWN_US 5000000uL

/** @brief The configuration of a median. */
typedef struct {
    uint16_t *
        window; /**< `count` elements of the caller, which must stay valid as long as the median. Required. */
    /** Time without a sample that counts after which the window is emptied, 1..FATHOM_MAX_DURATION_US. Choose more than
     * the interval between two samples. 0 selects 5 s; FATHOM_NO_DEADLINE disables it. */
    uint32_t unknown_us;
    uint16_t gate_mm; /**< 1..65535; 0: no gate. */
    uint8_t gate_row; /**< Spikes in a row that are dropped, 1..255; 0 selects 2. */
    uint8_t count;    /**< Length of the window, 3..15. Required. */
} fathom_median_config_t;

/** @brief The state of one median. The caller owns the memory. */
typedef struct {
    fathom_median_config_t config; /**< Invariant: `window` is NULL unless the initialisation succeeded. */
    uint32_t fed_us;               /**< Time of the last sample that counted, also of a spike. */
    uint16_t value;                /**< The median, while the window is full. */
    uint16_t dropped;              /**< Spikes; stops at 65535. The caller may read it, and set it to 0. */
    uint8_t have;                  /**< Samples in the window. */
    uint8_t next;                  /**< Place of the next sample; in a full window, of the oldest one. */
    uint8_t row;                   /**< Spikes in a row. */
} fathom_median_t;

/**
 * @brief Initialises a median with an empty window.
 *
 * If the function fails, the median is zeroed; it then never has a value.
 *
 * @param median  The median.
 * @param config  The configuration. Not used after the call; `config->window` is.
 * @retval FATHOM_OK            The median is ready.
 * @retval FATHOM_ERR_ARGUMENT  There is no window, or a member is outside its range.
 */
fathom_status_t fathom_median_init(fathom_median_t *median, const fathom_median_config_t *config);

/**
 * @brief Adds the next sample of the probe.
 *
 * @param median  The median.
 * @param sample  The sample.
 * @param out     If there is a median: this sample with the kind and the distance of the median, and without the mark
 *                of interference if the kind differs. Otherwise unchanged. `out` may be `sample`.
 * @return True if there is a median with this sample.
 */
bool fathom_median_add_sample(fathom_median_t *median, const fathom_sample_t *sample, fathom_sample_t *out);

/**
 * @brief Advances the median to `now_us` without a new sample.
 *
 * Call it often enough that the time between two calls and `unknown_us` are together below 35 minutes. A time before
 * that of the last sample has no effect.
 *
 * @param median  The median.
 * @param now_us  The clock, in microseconds.
 * @return True if this emptied a window that held samples.
 */
bool fathom_median_advance(fathom_median_t *median, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
