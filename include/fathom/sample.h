/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SAMPLE_H
#define FATHOM_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief A reading of one probe: the same struct for every sensor in every mode.
 *
 * A driver writes a sample when fathom_poll() returns FATHOM_OK (sensor.h). A sample reports what the device sent. An
 * error of the line is never a sample: it is a fathom_status_t (status.h). The struct has no pointers, so it can be
 * copied and stored. This header declares types only and costs no flash.
 *
 * @code
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK) {
 *     if (sample.kind == FATHOM_TARGET) show_mm(sample.distance_mm);
 *     else if (sample.kind == FATHOM_NO_TARGET) show_nothing_in_range();
 *     else show_no_distance();
 * }
 * @endcode
 *
 * 1. **Distance.** Only FATHOM_TARGET has a distance. Test `kind` before you use `distance_mm`.
 *
 * 2. **Sequence.** A new `sequence` shows a new response of the device, not a new measurement. If a program requests a
 *    value sooner than the device measures, the device sends the previous value again, and the sample has a new
 *    `sequence` and a new `time_us`. No response shows this. The header of each driver has the device's period.
 *
 * 3. **Gaps.** A response whose value the driver refuses (FATHOM_ERR_MALFORMED) may use a number of the sequence. A gap
 *    does not prove that a sample was lost.
 */

/** @brief The kind of a sample: what the device reported. */
typedef enum {
    /** @brief A target is `distance_mm` away. */
    FATHOM_TARGET = 1,

    /** @brief The device works and detects nothing in its range. No distance. */
    FATHOM_NO_TARGET = 2,

    /**
     * @brief The device reports that it failed (HPS-167S #5), or its output is one that no working device makes.
     *
     * No distance.
     */
    FATHOM_FAULT = 3,

    /**
     * @brief A target is nearer than the threshold of a switch or relay. No distance.
     *
     * The drivers of the A16 and A05 with a `window` also return it for a value whose meaning the program has set to
     * FATHOM_MEANS_TOO_NEAR: a16_auto, a16_controlled, a16_modbus, a05_auto, a05_dyp and a05_modbus. With the defaults
     * they do not. An HPS-167S never returns it: for an object nearer than its range it returns FATHOM_UNKNOWN.
     */
    FATHOM_NEAR = 4,

    /** @brief No target is nearer than the threshold of a switch or relay. No distance. */
    FATHOM_FAR = 5,

    /**
     * @brief A value without a known meaning, or below the range. `raw` has the value. No distance.
     *
     * Below the range are 1 to 79 mm of an HPS-167S, and a PWM of pulses that are too short only.
     */
    FATHOM_UNKNOWN = 6
} fathom_sample_kind_t;

/** @brief The model of the sensor that sent a sample. */
typedef enum {
    FATHOM_A16 = 1,    /**< A16: one ultrasonic probe. */
    FATHOM_A05 = 2,    /**< A05: four ultrasonic probes. */
    FATHOM_HPS167S = 3 /**< HPS-167S: infrared time of flight. */
} fathom_model_t;

/**
 * @brief One reading of one probe.
 *
 * `magnitude`, `precision` and `ambient` belong to the HPS-167S (HPS-167S #5). They are 0 for all other sensors.
 */
typedef struct {
    /**
     * @brief The clock of the HAL when the last byte of the response arrived, in microseconds. Wraps after 71.6
     * minutes.
     *
     * The age of the sample is the clock's present value minus `time_us`, as a uint32_t, if it is less than 71 minutes. On
     * Linux it is `(uint32_t)fathom_posix_now_us() - sample.time_us`; fathom_posix.h has the time of the day too.
     *
     * For a pulse: the end of the pulse. For a switch or a relay: see contact.h.
     */
    uint32_t time_us;

    /** @brief Strength of the reflected light, times 10000: 7231744 is 723.1744. */
    uint32_t magnitude;

    /**
     * @brief The value as the device sent it, whatever it means.
     *
     * A serial mode has 16 bits. PWM has the width of the pulse in microseconds. A switch or a relay has the level of
     * the pin: 1 is high.
     */
    uint32_t raw;

    /**
     * @brief Number of the response (rules 2 and 3). Wraps from 65535 to 0. All probes of one A05 response share it.
     */
    uint16_t sequence;

    /** @brief Distance in millimetres, 0 to 65535. 0 unless `kind` is FATHOM_TARGET. */
    uint16_t distance_mm;

    /** @brief The device's figure of accuracy, 0 to 65535, without a unit. Smaller is better. */
    uint16_t precision;

    /** @brief Kind of the sample: a fathom_sample_kind_t. */
    uint8_t kind;

    /** @brief Model of the sensor: a fathom_model_t. */
    uint8_t model;

    /** @brief Address of the unit, 0 to 254. 0 if the sensor has no address in this mode. */
    uint8_t address;

    /** @brief Number of the probe, 1 to 4. 1 if the sensor has one probe. */
    uint8_t probe;

    /** @brief Infrared light of the surroundings, 0 to 255, relative. */
    uint8_t ambient;

    /** @brief True, with FATHOM_NO_TARGET only, if another unit of the same frequency disturbs the measurement. */
    bool interference;
} fathom_sample_t;

#ifdef __cplusplus
}
#endif

#endif
