/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODEL_FACTS_H
#define FATHOM_MODEL_FACTS_H

#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/sample.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief What a driver knows about a model: the facts in which the relatives of the A16 and A05 differ.
 *
 * A driver takes a pointer to the facts of one model in its configuration. NULL selects the A16 or the A05 of the
 * datasheet. models.h names the facts of each known model, none of which was tried with a real module unless the page of
 * models (src/models/README.md) says so. A program can also change a copy:
 *
 * @code
 * static fathom_model_facts_t tank;                         // must stay valid as long as the driver
 * tank = fathom_model_a02yyuw;
 * tank.max_mm = 2500;                                       // the tank is no deeper: refuse longer distances
 * const fathom_a16_auto_config_t config = {.model = &tank};
 * @endcode
 *
 * The facts may be const. Drivers keep the pointer and never write to the facts. This header declares types only.
 */

/** @brief The meaning of a value that is no distance: the kind of its sample. */
typedef enum {
    FATHOM_MEANS_DEFAULT = 0,                  /**< The default of the member of fathom_model_facts_t. */
    FATHOM_MEANS_UNKNOWN = FATHOM_UNKNOWN,     /**< A sample FATHOM_UNKNOWN. */
    FATHOM_MEANS_NO_TARGET = FATHOM_NO_TARGET, /**< A sample FATHOM_NO_TARGET. */
    FATHOM_MEANS_TOO_NEAR = FATHOM_NEAR,       /**< A sample FATHOM_NEAR: a target is too near to measure. */
    FATHOM_MEANS_FAULT = FATHOM_FAULT,         /**< A sample FATHOM_FAULT. */
    FATHOM_MEANS_INTERFERENCE = 7,             /**< A sample FATHOM_NO_TARGET with `interference`. */
    FATHOM_MEANS_REFUSED = 8                   /**< No sample: FATHOM_ERR_MALFORMED. */
} fathom_meaning_t;

/** @brief What starts a measurement. The program chooses the output of the driver by it. */
typedef enum {
    FATHOM_STARTS_ALONE = 0,     /**< Nothing: the module measures at its own pace, or by a Modbus request. */
    FATHOM_STARTS_FALLING = 1,   /**< A falling edge: fathom_output_pin(), or a break of the line. */
    FATHOM_STARTS_BYTE = 2,      /**< The byte `trigger_byte`: fathom_output_line_byte(). */
    FATHOM_STARTS_HIGH_PULSE = 3 /**< A high pulse of at least `trigger_us`: fathom_output_inverted_pin(). */
} fathom_model_start_t;

/** @brief Bits of fathom_model_facts_t::registers: registers beside those of the A16. */
enum {
    /** 0x0102: temperature of the air or water, signed, in tenths of a degree C. */
    FATHOM_HAS_TEMPERATURE = 1
};

/**
 * @brief The facts of one model in one mode. 28 bytes on a 32-bit machine.
 *
 * A member that does not concern the mode is 0.
 */
typedef struct {
    /** @brief The line settings that the module has when it is new. NULL for pulses. Drivers do not set them. */
    const fathom_line_settings_t *line_settings;

    /**
     * @brief Least accepted distance in millimetres: the end of the blind zone, 0 to `max_mm`. 0: it is not known.
     *
     * 0 is never a distance, and nor are the values from FFFB on.
     */
    uint16_t min_mm;

    /** @brief Greatest accepted distance in millimetres: `min_mm` to 65535, and at least 1. */
    uint16_t max_mm;

    /**
     * @brief Least time between two triggers or two requests, in milliseconds. 0: none is known.
     *
     * For an A05 with requests it is the time of one probe.
     *
     * With automatic output it is the time between two measurements. A frame that repeats the value sooner than three
     * quarters of this time after the last new value is the same measurement, and does not increment `sequence`.
     */
    uint16_t period_ms;

    /**
     * @brief Least time for which the trigger is low, or high (FATHOM_STARTS_HIGH_PULSE), and for which it rests, in
     * microseconds: 1 to 60000. 0 selects 2000.
     */
    uint16_t trigger_us;

    /** @brief Width of the pulse for each 100 mm, in microseconds: 1 to 6000, 575 for the A16. 0: there is no pulse. */
    uint16_t us_per_dm;

    /** @brief What starts a measurement: a fathom_model_start_t. */
    uint8_t start;

    /** @brief The byte that starts a measurement, with FATHOM_STARTS_BYTE. */
    uint8_t trigger_byte;

    /** @brief Earliest end of the response after the trigger, in milliseconds. */
    uint8_t earliest_ms;

    /** @brief Latest end of the response after the trigger, in milliseconds: `earliest_ms` to 255, and at least 1. */
    uint8_t latest_ms;

    /**
     * @brief Width of the pulse that means that nothing is in range, in milliseconds, at least 3. 0: there is no such
     * pulse.
     */
    uint8_t no_target_ms;

    /** @brief Meaning of FFFB: a fathom_meaning_t. 0 selects FATHOM_MEANS_REFUSED. */
    uint8_t value_fffb;

    /** @brief Meaning of FFFD: a fathom_meaning_t. 0 selects FATHOM_MEANS_NO_TARGET. */
    uint8_t value_fffd;

    /** @brief Meaning of FFFE: a fathom_meaning_t. 0 selects FATHOM_MEANS_INTERFERENCE. */
    uint8_t value_fffe;

    /** @brief Meaning of FFFF: a fathom_meaning_t. 0 selects FATHOM_MEANS_REFUSED. */
    uint8_t value_ffff;

    /** @brief Meaning of 0: a fathom_meaning_t. 0 selects FATHOM_MEANS_UNKNOWN. */
    uint8_t value_0;

    /** @brief Registers beside those of the A16: bits FATHOM_HAS_... */
    uint8_t registers;
} fathom_model_facts_t;

#ifdef __cplusplus
}
#endif

#endif
