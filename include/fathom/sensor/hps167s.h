/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_H
#define FATHOM_HPS167S_H

#include <stdint.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/engine/internal/modbus_setting.h"
#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Measures with an HPS-167S, an infrared time-of-flight sensor on RS-485, by Modbus RTU.
 *
 * The driver sends command #5 of the datasheet again and again, and each response is one sample with a distance, the
 * strength of the reflection, the ambient light and a figure of precision. Polling sends no other command, because the
 * "registers" of this device are commands, and a read of a wrong register can reset it. #1 to #15 are the numbers of
 * the commands in the datasheet. The driver never waits and never allocates memory. include/COST.md has its flash,
 * RAM and stack (`hps167s`). hps167s_info.h reads versions, configuration and temperature, hps167s_settings.h changes
 * settings, and hps167s_auto.h listens to unsolicited frames.
 *
 * With factory settings the sensor has address 1, 19200 baud and 8E1 (datasheet 2.3).
 *
 * @code
 * static uint8_t frame[32];                          // static objects must stay valid as long as `gate`
 * static const fathom_line_parts_t parts = {.uart = &uart, .clock = &clock,
 *                                           .frame = frame, .frame_size = sizeof frame,
 *                                           .echo = FATHOM_LINE_ECHO_OFF,
 *                                           .senders = &fathom_line_senders,          // rule 6
 *                                           .silence_us = FATHOM_T3_5_US(19200, 11)}; // 11 bits in a character
 * static fathom_line_t line;
 * static fathom_modbus_t modbus;
 * static fathom_hps167s_t gate;
 *
 * fathom_line_init(&line, &parts);
 * modbus = fathom_modbus_client(&line);              // modbus_client.h
 * fathom_hps167s_init(&gate, &modbus, NULL);         // address 1, all defaults
 *
 * fathom_sample_t sample;                            // in the loop:
 * if (fathom_hps167s_poll(&gate, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) use(sample.distance_mm);
 * @endcode
 *
 * 1. **Samples.** `raw` has the 16 bits of the distance as the sensor sent them. `distance_mm` is 0 unless the kind is
 *    FATHOM_TARGET. fathom_hps167s_set_limits() replaces the limits 80, 30000 and 65530 of this table. The datasheet
 *    promises 80 to 18000 mm (table 1), so do not rely on a greater distance. A `max_mm` of 18000 refuses it (rule 3).
 *
 *    | `kind`           | response                                                                        |
 *    |------------------|---------------------------------------------------------------------------------|
 *    | FATHOM_TARGET    | A distance of 80 to 30000 mm.                                                   |
 *    | FATHOM_NO_TARGET | 65530 to 65534 mm: out of range, or too weak ("65.53 meters", #5).              |
 *    | FATHOM_UNKNOWN   | 1 to 79 mm, below the range.                                                    |
 *    | FATHOM_FAULT     | The abnormal packet: the sensor reports a failure (#5).                         |
 *
 *    In the abnormal packet all bits of distance, ambient light and precision are 1, and the magnitude is 0.
 *
 * 2. **Errors of fathom_poll().** FATHOM_PENDING is no error: there is nothing new. Continue to poll after an error.
 *    An error is the result of one request after its retries (line.h, rule 8), except FATHOM_ERR_ARGUMENT and
 *    FATHOM_ERR_PORT. A response with refused values (rule 3) is not retried.
 *
 *    | error                   | cause                                                                     |
 *    |-------------------------|---------------------------------------------------------------------------|
 *    | FATHOM_ERR_NO_RESPONSE  | The unit did not respond within `timeout_us`. Check power and wiring.     |
 *    | FATHOM_ERR_CHECKSUM     | A response was damaged. Check baud rate, parity, termination and ground.  |
 *    | FATHOM_ERR_EXCEPTION    | The unit refused the request: see fathom_hps167s_exception().             |
 *    | FATHOM_ERR_MALFORMED    | The unit sent a frame of another shape, or values that rule 3 refuses.    |
 *    | FATHOM_ERR_WARMING_UP   | The unit was powered a short time ago: see fathom_hps167s_power_on().     |
 *    | FATHOM_ERR_PORT         | The port is broken: see below.                                            |
 *    | FATHOM_ERR_LINE_BUSY    | The line was never silent. This says nothing about the unit (status.h).   |
 *    | FATHOM_ERR_OTHER_MASTER | Another master sent the unit a request. This says nothing about the unit. |
 *    | FATHOM_ERR_CANCELLED    | The line was initialised again. Or another driver changed the address or  |
 *    |                         | rate of this unit: initialise this driver with the new one.               |
 *    | FATHOM_ERR_UNSUPPORTED  | `line_settings` cannot be set, or the line only listens.                  |
 *    | FATHOM_ERR_ARGUMENT     | The driver is not initialised.                                            |
 *
 *    If the port cannot be read, every poll returns FATHOM_ERR_PORT until the port works again. If the port can be read
 *    but cannot send, each request ends with this error.
 *
 * 3. **Refused values.** The driver refuses a distance of 0, of 30001 to 65529, and of 65535 outside the abnormal
 *    packet. It also refuses an exponent of the magnitude above 16. If the program has read the configuration (#2), the
 *    driver refuses a response with the same 8 bytes, which may be a late response to #2. Of all distances only 255 mm
 *    can have these bytes. The driver counts the responses that it refuses in `implausible`.
 *
 * 4. **What `sequence` promises.** `sequence` increases by 1 with each sample and wraps after 65535. A new number means
 *    a new response, not always a new measurement. The sensor measures 6 to 54 times a second (table 1). If a request
 *    arrives before a new measurement is finished, the sensor may send the previous one again. If each sample must be a
 *    new measurement, set `period_us` to 167000 (6 a second) or more.
 *
 * 5. **Bound.** fathom_poll() returns a sample or an error at the latest after
 *
 *        period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *
 *    B is the bound of one transaction alone on its line (line.h, rule 13). S is the sum of the bounds of the line's
 *    other transactions. P is the longest time between two polls. While a command or a setting of this driver is in
 *    progress, fathom_poll() returns FATHOM_PENDING, except FATHOM_ERR_PORT and the result of a measurement that was on
 *    the wire already. So the time of the command or setting is added. modbus_unit.h has the rules of pace, back-off
 *    and abandoned commands.
 *
 *    For example, an unplugged sensor with the default configuration, alone on its line and polled each millisecond, is
 *    FATHOM_ERR_NO_RESPONSE at these times after the first poll. The back-off begins after the third error:
 *
 *    | error   | 1   | 2   | 3   | 4   | 5 | 6   | 7  | 8    | each later one |
 *    |---------|-----|-----|-----|-----|---|-----|----|------|----------------|
 *    | seconds | 0.5 | 1.5 | 2.5 | 3.5 | 5 | 7.5 | 12 | 20.5 | 8.5 more       |
 *
 * 6. **Unsolicited frames.** With factory settings the sensor may send measurements without a request after power-on
 *    (#10). Name `senders` in the parts of the line (line.h, rule 11), so that requests leave between these frames.
 *    Such a frame is no sample, unless it arrives in place of a due response and has its shape. Its values are then as
 *    new as those of the response. fathom_hps167s_set_measures_after_power_on() of hps167s_settings.h switches the
 *    frames off from the next power-on.
 */

/** @brief Least time from one measurement to the next in microseconds: 54 measurements a second (table 1). */
#define FATHOM_HPS167S_MIN_PERIOD_US 18519uL

/** @brief The configuration. Used only during fathom_hps167s_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Connection to the sensor; fathom/engine/internal/modbus_unit.h explains its members.
     *
     * | member               | range here                               | 0 selects                              |
     * |----------------------|------------------------------------------|----------------------------------------|
     * | `address`            | 1 to 32                                  | 1                                      |
     * | `address_zero`       | false                                    |                                        |
     * | `period_us`          | 18519 to 2^31 - 1; less acts as 18519    | 18519 us                               |
     * | `timeout_us`         | 1 to 2^31 - 1                            | 500 ms: the slowest period is 167 ms   |
     * | `command_timeout_us` | 1 to 2^31 - 1                            | 1 s: the datasheet states no times     |
     * | `retries`            | 0 to 254                                 | no retry                               |
     * | `backoff_us`         | 1 to 2^31 - 1                            | 2^31 - 1 us: rule 5 limits it to 8 s   |
     *
     * Set `line_settings` if fathom_hps167s_set_baud() is to be used, or if the units of the line differ.
     */
    fathom_modbus_config_t modbus;

    /** @brief Warm-up time of the sensor in seconds (#7), for fathom_hps167s_power_on(). 0 selects 5. */
    uint8_t warm_up_s;

    /** @brief True if a `warm_up_s` of 0 means 0 s, not the default. No effect if `warm_up_s` is not 0. */
    bool no_warm_up;

    /**
     * @brief Number of equal responses in succession after which the driver believes the configuration (#2): 1 to 8.
     *
     * 0 selects 2. A response to #2 has the shape of a measurement. So for 2 s after an unsolicited frame the driver
     * needs at least 3 equal responses.
     */
    uint8_t same_responses;

    /**
     * @brief Steps of the temperature (#4) in a degree Fahrenheit, 1 to 255. 0 selects 1.
     *
     * The datasheet states no scale. At 25 degrees Celsius a sensor sends 77 if it has 1 step, and 770 if it has 10.
     */
    uint8_t steps_per_degree;

    /**
     * @brief True if the low word of the reconnect time (#2, #15) comes first.
     *
     * The datasheet leaves this open. False: the high word comes first, as in all integers of this sensor. In the wrong
     * order, a time below 65536 ms is read as a multiple of 65536 ms.
     */
    bool low_word_first;
} fathom_hps167s_config_t;

/** @brief Value of `reset_response`: the sensor has not responded to the factory reset (#6). */
#define FATHOM_HPS167S_NO_RESET_RESPONSE 0xFFFFu

/** @brief A driver (struct fathom_hps167s). */
typedef struct fathom_hps167s fathom_hps167s_t;

/**
 * @brief A driver, in the caller's memory. Call fathom_hps167s_init() before use.
 *
 * The caller may read `implausible`, `reset_response` and `next_baud`. All other members are private.
 */
struct fathom_hps167s {
    uint16_t measurement[FATHOM_HPS167S_MEASUREMENT_COUNT]; /**< The newest response to #5. */
    uint8_t warm_up_s;                                      /**< Warm-up time in seconds. */
    uint8_t same_responses;                                 /**< As in the config. */
    uint8_t steps_per_degree;                               /**< As in the config. */
    bool low_word_first;                                    /**< As in the config. */
    /** @brief True if another frame was mistaken for a response to #2, so that the response may still arrive. */
    bool is_outstanding;
    bool is_among_unasked; /**< True if an unsolicited frame was received in the last 2 s. */
    uint8_t responses;     /**< Responses to #2 in the read in progress. */
    uint8_t agreed;        /**< The newest of them that are equal. */
    bool is_seeking;       /**< True if the sensor may use the line settings `other` instead. */
    bool is_looked_at;     /**< True if #2 was read before the factory reset. */
    uint16_t sequence;     /**< Sequence number of the newest sample. */
    /** @brief Responses to #5 that were refused because of their values; stops at 65535. */
    uint16_t implausible;
    /**
     * @brief The sensor's response to the newest factory reset (#6).
     *
     * 1 is success. FATHOM_HPS167S_NO_RESET_RESPONSE is no response, or no reset since fathom_hps167s_init(). Any other
     * value is the sensor's error code.
     */
    uint16_t reset_response;
    uint16_t last_configuration[FATHOM_HPS167S_CONFIGURATION_COUNT]; /**< The newest that may be of #2. */
    uint16_t
        last_measurement[FATHOM_HPS167S_MEASUREMENT_COUNT]; /**< The newest measurement, also unsolicited. */
    uint16_t values[FATHOM_HPS167S_MAX_REGISTERS];          /**< The newest response to another command. */
    const fathom_hps167s_limits_t *limits;                  /**< The limits; NULL: the defaults. */
    /** @brief Returns true if the newest response to #5 is a measurement. NULL until #2 matters. */
    bool (*is_new)(fathom_hps167s_t *sensor);
    /**
     * @brief Called when a request ends, or with FATHOM_PENDING by fathom_hps167s_power_on(). NULL until a baud rate is
     * set.
     */
    void (*follow)(fathom_hps167s_t *sensor, fathom_status_t status);
    uint32_t unasked_us;       /**< Clock at the newest unsolicited frame, in microseconds. */
    fathom_modbus_unit_t unit; /**< The unit. */
    /**
     * @brief Baud rate that the sensor uses from its next power-on; 0: unchanged.
     *
     * fathom_hps167s_set_baud() and fathom_hps167s_restore_factory_settings() write this member.
     */
    uint32_t next_baud;
    /* private */
    const fathom_line_settings_t *other;            /* the line settings that are not in use while seeking */
    fathom_line_settings_t moved[2];                /* those in use, and those that are being set */
    fathom_modbus_setting_t setting;                /* the newest setting */
    uint16_t words[FATHOM_HPS167S_RECONNECT_COUNT]; /* the registers that #15 writes */
};

/**
 * @brief Initialises a driver. Nothing is sent before the first poll.
 *
 * @param sensor     The driver. Its memory may have any content. Must stay valid until fathom_hps167s_deinit().
 * @param transport  The transport: `modbus` of a bus, or the result of fathom_modbus_client(). Copied; its line must stay
 *                   valid as long as the driver.
 * @param config     The config. Read only during the call; what it points to must stay valid as long as the driver.
 *                   NULL selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, pass fathom_hps167s_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `transport` has no initialised line, the address is above 32, `address_zero` is true,
 *                              `same_responses` is above 8, another member of `modbus` is outside its range, or the
 *                              frame buffer of the line has less than 13 bytes. The driver is zeroed: each poll and
 *                              command returns FATHOM_ERR_ARGUMENT.
 * @retval FATHOM_ERR_BUSY      A request of this driver is still queued. Nothing changed. Call fathom_hps167s_deinit()
 *                              first.
 */
fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_modbus_t *transport,
                                    const fathom_hps167s_config_t *config);

/**
 * @brief Replaces the default distance limits (hps167s_registers.h), from the next response on.
 *
 * @param sensor  The driver, initialised.
 * @param limits  The limits, in memory that stays valid until the driver is deinitialised. The function sets members of
 *                `*limits` that are 0 to their defaults, also if it fails.
 * @retval FATHOM_OK            The limits are in use.
 * @retval FATHOM_ERR_ARGUMENT  `over_range_mm` is 65535 or not above `max_mm`, or `min_mm` is above `max_mm`. The
 *                              driver uses the same limits as before.
 */
fathom_status_t fathom_hps167s_set_limits(fathom_hps167s_t *sensor, fathom_hps167s_limits_t *limits);

/**
 * @brief Cancels what is in progress. After this the memory belongs to the caller again.
 *
 * Do not poll the sensor after this: a poll would start a new measurement. If the program has used settings or
 * fathom_hps167s_get_configuration(), and the sensor may send unsolicited frames, a response to #2 may still arrive.
 * Wait for `command_timeout_us` before you initialise another driver for the same unit.
 */
void fathom_hps167s_deinit(fathom_hps167s_t *sensor);

/**
 * @brief Informs the driver that the sensor is powered now. Call this function when the supply is switched on.
 *
 * The driver cancels what is in progress. For `warm_up_s` and one `timeout_us` after the call, four results become
 * FATHOM_ERR_WARMING_UP: no response, a damaged response, an exception, and the abnormal packet (#7).
 *
 * If the program does not know when the sensor is powered, do not call this function. The driver then returns these
 * errors unchanged. Exception: if `next_baud` is not 0 and the sensor no longer responds, call this function, because
 * only this function makes the driver use `next_baud`. The function sets `next_baud` to 0. While the sensor does not
 * respond, the driver alternates between this rate and the former one.
 */
void fathom_hps167s_power_on(fathom_hps167s_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_hps167s_poll().
 *
 * @param ctx     The driver, a fathom_hps167s_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_hps167s_poll().
 */
fathom_status_t fathom_hps167s_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_hps167s_t.
 * @return As fathom_hps167s_due_us().
 */
uint32_t fathom_hps167s_sensor_due_us(void *ctx);

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
static inline fathom_status_t fathom_hps167s_poll(fathom_hps167s_t *sensor, fathom_sample_t *sample)
{
    return fathom_hps167s_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_hps167s_due_us(fathom_hps167s_t *sensor)
{
    return fathom_hps167s_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_hps167s_sensor(fathom_hps167s_t *sensor)
{
    return fathom_sensor_make(fathom_hps167s_sensor_poll, fathom_hps167s_sensor_due_us, sensor);
}

/**
 * @brief Returns the exception code of the newest response, valid after FATHOM_ERR_EXCEPTION until the next request.
 *
 * Codes of table 39: 1 illegal function, 2 illegal address, 3 illegal count, 4 operation failed. 0: no exception.
 */
static inline uint8_t fathom_hps167s_exception(const fathom_hps167s_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->unit);
}

/** @brief Returns the unit, whose requests fathom_modbus_unit_responses() and fathom_modbus_unit_failures() count. */
static inline const fathom_modbus_unit_t *fathom_hps167s_unit(const fathom_hps167s_t *sensor)
{
    return &sensor->unit;
}

/**
 * @brief Cancels the measurement, command or setting in progress. The driver can be used at once.
 *
 * No call returns a result for what was cancelled; a later fathom_poll() starts a new measurement. A cancelled setting
 * may be set or not. The driver uses the address and line settings from before the setting.
 */
void fathom_hps167s_cancel(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
