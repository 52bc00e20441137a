/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_H
#define FATHOM_DYP_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/sample.h"
#include "fathom/sensor/model_facts.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The common part of the ultrasonic sensors A16 and A05: the meaning of their 16-bit values.
 *
 * A program needs of this header fathom_dyp_value_t, and for diagnosis the refused values of fathom_dyp_measurement_t.
 * The drivers use the rest.
 *
 * The datasheets print distances and no other value. Sister models use two more values: 0xFFFD for no object, and
 * 0xFFFE for interference by another unit of the same frequency. Users have seen 0 with nothing in range and with a
 * hand on the probe, so 0 has no meaning by default. Under water, FFFB reports that the module is out of the water. The
 * facts of a model (model_facts.h) give these values other meanings. 0 and all values from FFFB on are never distances.
 * The driver refuses all other values outside the range of the model.
 */

/** @brief The distance that a sensor sends, if the mode offers two. */
typedef enum {
    FATHOM_PROCESSED = 0, /**< The filtered distance: steady, and slow to follow. */
    FATHOM_REAL_TIME = 1  /**< The distance of the last measurement. */
} fathom_dyp_value_t;

/** @brief The greatest distance that is accepted if the program names no model. */
enum {
    FATHOM_A16_MAX_MM = 16350, /**< The longest pulse, 94 ms (A16 1(3)), in millimetres. */
    FATHOM_A05_MAX_MM = 6000   /**< One third above the range of 4.5 m, in millimetres. */
};

/**
 * @brief One response: the values of one to four probes, each of which becomes one sample.
 *
 * A program may read `refused_probe`, `refused_raw` and `implausible`.
 */
typedef struct {
    /** @brief Model of the samples: a fathom_model_t. */
    uint8_t model;

    /** @brief Address of the samples. 0 for a sensor with automatic output. */
    uint8_t address;

    /** @brief Number of the probe that has `values[0]`, 1 to 4. */
    uint8_t first;

    /** @brief Set of the probes that have no sample yet: bit (probe - 1). */
    uint8_t left;

    /**
     * @brief Number of the probe whose value was refused last, 1 to 4. 0: no value was refused.
     *
     * This member and `refused_raw` belong to the last FATHOM_ERR_MALFORMED, if that error incremented `implausible`.
     */
    uint8_t refused_probe;

    /** @brief The value that was refused last. */
    uint16_t refused_raw;

    /** @brief Number of the newest response. Wraps from 65535 to 0. */
    uint16_t sequence;

    /** @brief Number of refused values. Stops at 65535. */
    uint16_t implausible;

    /** @brief The facts of the model: those of the configuration, or those of the datasheet's sensor. */
    const fathom_model_facts_t *facts;

    /** @brief The values of probe `first` and the following probes, in the driver's memory. */
    uint16_t *values;

    /** @brief Clock at the last byte of the response, in microseconds. */
    uint32_t time_us;
} fathom_dyp_measurement_t;

/**
 * @brief Returns the sample of the next probe of the response.
 *
 * @param measurement  The response.
 * @param sample       Written with FATHOM_OK only.
 * @retval FATHOM_OK             `*sample` is written.
 * @retval FATHOM_ERR_MALFORMED  The value is refused and counted; `refused_probe` and `refused_raw` are written. The
 *                               next call continues with the next probe.
 * @retval FATHOM_PENDING        All probes of the response are done.
 */
fathom_status_t fathom_dyp_measurement_next(fathom_dyp_measurement_t *measurement, fathom_sample_t *sample);

/**
 * @brief Starts a new response, whose `values` are written already.
 *
 * @param measurement  The response.
 * @param probes       Set of the probes that become samples: bit (probe - 1).
 * @param time_us      Clock at the last byte of the response, in microseconds.
 */
static inline void fathom_dyp_measurement_set(fathom_dyp_measurement_t *measurement, uint8_t probes,
                                              uint32_t time_us)
{
    measurement->sequence++;
    measurement->time_us = time_us;
    measurement->left = probes;
}

/**
 * @brief Returns the number of the first probe of a set.
 *
 * @param probes  The set, not empty: bit (probe - 1).
 */
static inline uint8_t fathom_dyp_first_probe(uint8_t probes)
{
    uint8_t first = 1;
    for (; (probes & 1u) == 0u; probes = (uint8_t)(probes >> 1)) first++;
    return first;
}

/**
 * @brief Returns true if the distances and the meanings of a model are inside their ranges.
 *
 * @param facts  The facts of the model.
 */
bool fathom_dyp_are_valid(const fathom_model_facts_t *facts);

/**
 * @brief Returns FATHOM_TARGET if a value is an accepted distance, else its fathom_meaning_t.
 *
 * @param facts  The facts of the model.
 * @param value  The value as the device sent it.
 */
uint8_t fathom_dyp_meaning(const fathom_model_facts_t *facts, uint16_t value);

/**
 * @brief Returns true if the range of a model contains at least one distance.
 *
 * @param facts  The facts of the model.
 */
static inline bool fathom_dyp_has_range(const fathom_model_facts_t *facts)
{
    return (facts->min_mm <= facts->max_mm) && (facts->max_mm != 0u);
}

/**
 * @brief Returns the facts that a configuration names, or those of the datasheet's sensor.
 *
 * @param facts      The facts that the configuration names, or NULL.
 * @param datasheet  The facts of the datasheet's sensor.
 */
static inline const fathom_model_facts_t *fathom_dyp_facts_or(const fathom_model_facts_t *facts,
                                                              const fathom_model_facts_t *datasheet)
{
    return (facts != NULL) ? facts : datasheet;
}

/** @brief Returns a time of the facts in microseconds. */
static inline uint32_t fathom_dyp_us(uint16_t ms) { return ms * UINT32_C(1000); }

/**
 * @brief Gives the listener of a driver the gap of its line, if the config left it open and the line's is longer.
 *
 * A port that holds bytes back in the middle of a frame has a long gap in the parts of its line (line.h).
 *
 * @param listener  The listener, whose `gap_us` is that of the config.
 * @param line      The line, initialised.
 */
static inline void fathom_dyp_choose_gap(fathom_listener_t *listener, const fathom_line_t *line)
{
    if ((listener->gap_us == 0u) && (line->parts->gap_us > FATHOM_LINE_DEFAULT_GAP_US))
        listener->gap_us = line->parts->gap_us;
}

#ifdef __cplusplus
}
#endif

#endif
