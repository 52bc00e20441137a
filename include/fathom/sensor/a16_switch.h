/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_SWITCH_H
#define FATHOM_A16_SWITCH_H

#include "fathom/engine/contact.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/a16_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an A16 with switch output (A16 4): whether something is nearer than a threshold.
 *
 * The level of the TX pin is the result. The threshold is 1 m with factory settings. The driver reads the pin and never
 * waits. include/COST.md has its size in the row `a16_switch`, and with settings in `a16_switch_set`.
 *
 * @code
 * fathom_a16_switch_init(&a16, &pin, &clock, NULL);
 * sensor = fathom_a16_switch_sensor(&a16);
 * for (;;)
 *     if (fathom_poll(&sensor, &sample) == FATHOM_OK) show_near(sample.kind == FATHOM_NEAR);
 * @endcode
 *
 * The module measures every 500 ms. It changes the level after 3 measurements in a row below the threshold (1.5 s),
 * or 5 above it (2.5 s). The pin cannot drive a load: read it with an input of 3 V logic. debounce.h is the same rule
 * in software, for any sensor in any mode.
 *
 * The samples are FATHOM_NEAR or FATHOM_FAR, without a distance. contact.h states when there is a sample, what its
 * `time_us` and `raw` are, and within which time a program that polls gets a sample or an error: 3 s + 2 * P by
 * default, where P is the longest time between two polls. The datasheet does not say what the level is before the
 * module's first decision.
 *
 * Each sample increments `sequence`. The driver repeats a level that does not change every `period_us` (1 s). Such a
 * sample proves that the pin was read, not that the module measured again: the module measures every 500 ms.
 *
 * A switch cannot report "no response". A cut wire reads as the level that the board pulls the pin to, so pull it to
 * the safe level.
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_STALE | no level was equal for `settle_us` within `stale_us`: noise, or a line that is never silent |
 * | FATHOM_ERR_PORT | the port of the line on the same pins is broken; returned by every poll that has nothing else |
 * | FATHOM_ERR_ARGUMENT | the initialisation failed or never ran, and the memory is zeroed |
 *
 * **Settings on the same pins.** Modbus sets the threshold and the polarity, 9600 8N1 (A16 4(1), 6(3)): use
 * a16_settings.h with a fathom_a16_modbus_t beside this driver. That driver needs no other polls. The module receives
 * on RX and responds on TX. With a `guard` (line_pins.h) the level does not count while a request is in progress, nor
 * until 5 ms after the last byte.
 *
 * A low level is a break to the host's UART. Bytes with framing errors may stand before and behind a response; the
 * line drops and counts them (FATHOM_LINE_BAD_BYTES). They keep the line from finding out that it has no echo, so
 * configure FATHOM_LINE_ECHO_OFF: there is a wire in each direction. If a UART reports a break repeatedly while it
 * lasts, the line looks busy; switch the receiver off while no request is in progress.
 */

/** @brief The configuration. A member that is 0 takes its default. `guard` must stay valid as long as the driver. */
typedef struct {
    /** The guard of the line on the same pins (fathom_contact_line_guard()). This driver polls that line too. NULL:
     * there is no line, and the module gets no requests. */
    const fathom_contact_guard_t *guard;
    fathom_contact_timing_t timing; /**< The times; contact.h has their ranges. */
    /** A low level is FATHOM_NEAR: register 0x0205 is 0. False: a high level is, as with factory settings, where "less
     * than 1 meter" is a high level (A16 4(2)). */
    bool negative;
    uint8_t
        address; /**< Modbus address for the samples, 0..255; 0: without Modbus. It is copied and not used. */
} fathom_a16_switch_config_t;

/** @brief The driver, in the caller's memory. Call fathom_a16_switch_init() before use. */
typedef struct {
    fathom_contact_t base; /**< Reads the pin. */
} fathom_a16_switch_t;

/**
 * @brief Initialises the driver and reads the pin once. If the function fails, the driver is zeroed.
 *
 * @param sensor  The driver. Must stay valid as long as the program polls it.
 * @param pin     Reads the TX pin of the module, with `get`. Must stay valid as long as the driver.
 * @param clock   The clock, with `now_us`. Must stay valid as long as the driver.
 * @param config  The configuration. Not used after the call. NULL selects all defaults.
 * @retval FATHOM_OK            The driver is ready. Next, call fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  There is no clock, no pin that can be read, a guard without one of its functions, or a
 *                              time outside its range.
 */
fathom_status_t fathom_a16_switch_init(fathom_a16_switch_t *sensor, const fathom_pin_t *pin,
                                       const fathom_clock_t *clock, const fathom_a16_switch_config_t *config);

/**
 * @brief Sets the polarity by Modbus. Call it until it does not return FATHOM_PENDING.
 *
 * The level does not count meanwhile, because it turns during the change. After FATHOM_OK the level has its new
 * meaning, after an error its previous one. After FATHOM_ERR_UNCONFIRMED it may be either: read it with
 * fathom_a16_modbus_get_switch_polarity() and call fathom_a16_switch_note_polarity().
 *
 * @param sensor    The driver.
 * @param modbus    The Modbus driver of the same module, on the line that shares the pins.
 * @param polarity  The polarity.
 * @return What fathom_a16_modbus_set_switch_polarity() returns.
 */
fathom_status_t fathom_a16_switch_set_polarity(fathom_a16_switch_t *sensor, fathom_a16_modbus_t *modbus,
                                               fathom_a16_polarity_t polarity);

/**
 * @brief Sets the meaning of the level without Modbus.
 *
 * Call this function if the polarity was set or read without this driver, or after fathom_a16_modbus_cancel() stopped
 * fathom_a16_switch_set_polarity().
 *
 * @param sensor    The driver.
 * @param polarity  The polarity of the module.
 */
void fathom_a16_switch_note_polarity(fathom_a16_switch_t *sensor, fathom_a16_polarity_t polarity);

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
static inline fathom_status_t fathom_a16_switch_poll(fathom_a16_switch_t *sensor, fathom_sample_t *sample)
{
    return fathom_contact_sensor_poll(&sensor->base, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if the pin does not change.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a16_switch_due_us(fathom_a16_switch_t *sensor)
{
    return fathom_contact_sensor_due_us(&sensor->base);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). There is no deinit: stop polling. */
static inline fathom_sensor_t fathom_a16_switch_sensor(fathom_a16_switch_t *sensor)
{
    return fathom_contact_sensor(&sensor->base);
}

#ifdef __cplusplus
}
#endif

#endif
