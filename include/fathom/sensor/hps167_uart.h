/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167_UART_H
#define FATHOM_HPS167_UART_H

#include "fathom/codec/hps167_frames.h"
#include "fathom/engine/internal/modbus_command.h"
#include "fathom/engine/line.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Measures with an HPS-167 or HPS-166, the relatives of the HPS-167S that have a UART.
 *
 * The driver requests measurements, and each response is one sample. The line has 115200 baud and 8N1
 * (`fathom_hps167_factory_line`). The driver never waits and never allocates memory. include/COST.md has its flash, RAM
 * and stack (`hps167_uart`).
 *
 * @warning This driver was never tried with a sensor. The frames (hps167_frames.h) and the rate come from several public
 * programs for these sensors. Their times, their range and what they send after a fault are not known; the driver takes
 * those of the HPS-167S, whose 8 bytes of a measurement are the same. The revision history of the HPS-167S says that
 * units of before 2020-09 spoke a protocol with a CRC16-CCITT on RS-485. That may be this one; their rate and their
 * address are not published.
 *
 * @code
 * static fathom_hps167_uart_t gate;
 * fathom_hps167_uart_init(&gate, &line, NULL);
 * const fathom_sensor_t sensor = fathom_hps167_uart_sensor(&gate);
 *
 * fathom_sample_t sample;                            // in the loop:
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) use(sample.distance_mm);
 * @endcode
 *
 * 1. **Single or continuous.** By default the driver requests each measurement (command 22). A sample is then the
 *    response to a request that left after the previous sample, no output has to be stopped, and a sensor that was
 *    switched off and on needs nothing. If `continuous` is true, the driver requests the continuous measurement (24)
 *    once, and becomes the listener of the line. It requests it again if the output stops for `stale_us`, because the
 *    sensor is silent after power-on but for the text "Hypersen". A public driver notes that the precision is better
 *    in continuous mode; prefer it for that reason only, and see fathom_hps167_uart_deinit(). Among the frames of the
 *    output, commands and the next request wait for a silence (line.h, rule 11): poll more often than frames arrive.
 *
 * 2. **Samples** have the kinds of hps167s.h (rule 1): over range, 65.53 m, is FATHOM_NO_TARGET. `time_us` is the clock at
 *    the last byte of the frame, and `address` is 0. The driver accepts a frame only if its length is right and its CRC
 *    fits. It searches for the next frame behind the first byte of the damaged one, so bytes of other origin hide no
 *    frame. The CRC sees one and two wrong bits in a frame, and all errors within 16 bits in a row. Of frames whose
 *    bytes were replaced at random, one in 65536 passes.
 *
 * 3. **What `sequence` promises.** `sequence` increases by 1 with each sample and wraps after 65535. A new number is a new
 *    frame of the sensor. If several frames of the continuous output arrive between two polls, the driver returns the
 *    newest and counts the others in `missed`. A frame that is older than `stale_us` and FATHOM_LINE_LATE_US is no
 *    sample and is counted there too.
 *
 * 4. **Errors of fathom_poll().** The driver continues after each.
 *
 *    | error                  | cause                                                                             |
 *    |------------------------|-----------------------------------------------------------------------------------|
 *    | FATHOM_ERR_NO_RESPONSE | The sensor did not respond to a request within `modbus.timeout_us`.               |
 *    | FATHOM_ERR_CHECKSUM    | A response was damaged. Continuous: bytes arrived for `stale_us`, but no frame.   |
 *    | FATHOM_ERR_STALE       | Continuous: the output has started, and nothing arrived for `stale_us`.           |
 *    | FATHOM_ERR_MALFORMED   | A frame has values that cannot be a measurement, counted in `implausible`; or the |
 *    |                        | response to another command arrived.                                              |
 *    | FATHOM_ERR_WARMING_UP  | One of the first two, less than `start_us` after fathom_hps167_uart_power_on().   |
 *    | FATHOM_ERR_LINE_BUSY   | As in line.h, rule 3.                                                             |
 *    | FATHOM_ERR_PORT        | The port is broken.                                                               |
 *    | FATHOM_ERR_CANCELLED   | The line was initialised again.                                                   |
 *    | FATHOM_ERR_ARGUMENT    | The driver is not initialised.                                                    |
 *
 *    With the defaults, alone on its line and polled each millisecond, an unplugged sensor is an error after 0.51 s, in
 *    continuous mode after 2 s. Later errors are up to 8.5 s apart, because the driver asks a silent sensor less and
 *    less often (`modbus.backoff_us`). So long can the first sample after a return take, too.
 */

/** @brief Least time from one request to the next in microseconds. A public driver requests every 20 ms. */
#define FATHOM_HPS167_UART_PERIOD_US 20000uL

/** @brief Configuration. Read only during fathom_hps167_uart_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Connection to the sensor; fathom/engine/internal/modbus_unit.h explains its members.
     *
     * | member         | range here                        | 0 selects |
     * |----------------|-----------------------------------|-----------|
     * | `address`      | 0: the frames have no address     |           |
     * | `address_zero` | false                             |           |
     * | `period_us`    | up to 2^31 - 1; at least 20 ms    | 20 ms     |
     * | `timeout_us`   | 1 to 2^31 - 1                     | 500 ms    |
     */
    fathom_modbus_config_t modbus;

    /**
     * @brief Start-up time after fathom_hps167_uart_power_on(), in microseconds: 1 to 2^31 - 1. 0 selects 5 s.
     *
     * That is the factory setting of the HPS-167S. A program for the HPS-166 waits 0.5 s.
     */
    uint32_t start_us;

    /** @brief Continuous: time without a sample after which the output has stopped, in microseconds: 1 to 2^31 - 1. 0
     * selects 2 s. */
    uint32_t stale_us;

    /** @brief True for the continuous measurement (rule 1). */
    bool continuous;
} fathom_hps167_uart_config_t;

/**
 * @brief A driver, in the caller's memory. Call fathom_hps167_uart_init() before use.
 *
 * The caller may read the members from `sequence` to `damaged`, and set the counters among them to 0. All others are
 * private.
 */
typedef struct {
    /** @brief The listener of the continuous output. Invariant: the first member, so that one pointer is both. */
    fathom_listener_t listener;

    /** @brief The requests. */
    fathom_modbus_unit_t unit;

    /** @brief The distance limits, or NULL for the default limits. */
    const fathom_hps167s_limits_t *limits;

    /** @brief Start-up time after power-on, in microseconds. */
    uint32_t start_us;

    /** @brief Sequence number of the newest sample. */
    uint16_t sequence;

    /** @brief Frames that were refused because of their values. This and the next counters stop at 65535. */
    uint16_t implausible;

    /** @brief Frames of the continuous output that were not returned: a newer frame arrived, or the poll came too late. */
    uint16_t missed;

    /** @brief Bytes of the continuous output that belong to no frame. */
    uint16_t dropped_bytes;

    /** @brief Frames of the continuous output with a wrong CRC: 15 bytes that begin with 0A 0D. */
    uint16_t damaged;

    /* private */
    uint16_t values[FATHOM_HPS167S_MEASUREMENT_COUNT];    /* of the newest response to a request to measure */
    uint16_t registers[FATHOM_HPS167S_MEASUREMENT_COUNT]; /* of the newest frame of the continuous output */
    uint16_t result;                                      /* of the newest command */
    uint32_t time_us;                                     /* the clock at the last byte of that frame */
    uint32_t
        since_us; /* the clock at the last sample of the continuous output, or at the error for its lack */
    bool is_continuous; /* as in the config */
    bool is_started;    /* true if the sensor sends by itself, as far as the driver knows */
    bool is_new;        /* true if `registers` were not returned yet */
    bool is_heard;      /* true if bytes arrived, or were lost, since `since_us` */
    uint8_t
        held_count; /* number of bytes in `bytes`. Invariant: they can be the beginning of a measurement */
    uint8_t bytes[FATHOM_HPS167_MEASUREMENT_LENGTH];
} fathom_hps167_uart_t;

/**
 * @brief Initialises a driver. Nothing is sent before the first poll.
 *
 * @param sensor  The driver, in any memory. Must stay valid until fathom_hps167_uart_deinit().
 * @param line    The line, initialised. Must stay valid as long as the driver.
 * @param config  The config. Read only during the call; what it points to must stay valid as long as the driver. NULL
 *                selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, pass fathom_hps167_uart_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `line` is NULL or not initialised, a member is outside its range, or the frame buffer of
 *                              the line has less than 15 bytes. The driver is zeroed: each poll and command returns
 *                              FATHOM_ERR_ARGUMENT.
 * @retval FATHOM_ERR_BUSY      A request of this driver is still queued, and nothing changed: call
 *                              fathom_hps167_uart_deinit() first. Or `continuous` is true, and the line has another
 *                              listener, which stays; the driver is zeroed.
 */
fathom_status_t fathom_hps167_uart_init(fathom_hps167_uart_t *sensor, fathom_line_t *line,
                                        const fathom_hps167_uart_config_t *config);

/**
 * @brief Replaces the default distance limits (hps167s_registers.h), from the next frame on.
 *
 * @param sensor  The driver, initialised.
 * @param limits  The limits. Members that are 0 are set to their defaults. Must stay valid as long as the driver.
 * @retval FATHOM_OK            The limits are in use.
 * @retval FATHOM_ERR_ARGUMENT  `over_range_mm` is 65535 or not above `max_mm`, or `min_mm` is above `max_mm`. The
 *                              driver uses the same limits as before.
 */
fathom_status_t fathom_hps167_uart_set_limits(fathom_hps167_uart_t *sensor, fathom_hps167s_limits_t *limits);

/**
 * @brief Cancels what is in progress and stops the continuous output. After this the memory is the caller's again.
 *
 * If the output has started, the function sends the command to stop once, at once, and does not wait for the
 * acknowledgement. If the port is busy or broken at that moment, the command is lost and the sensor goes on sending. To be
 * sure that the output has stopped, call fathom_hps167_uart_stop() until its result differs from FATHOM_PENDING, and then
 * this function.
 */
void fathom_hps167_uart_deinit(fathom_hps167_uart_t *sensor);

/** @brief Cancels the measurement or command in progress. The driver can be used at once. */
void fathom_hps167_uart_cancel(fathom_hps167_uart_t *sensor);

/** @brief Returns the unit, whose requests fathom_modbus_unit_responses() and fathom_modbus_unit_failures() count. */
static inline const fathom_modbus_unit_t *fathom_hps167_uart_unit(const fathom_hps167_uart_t *sensor)
{
    return &sensor->unit;
}

/**
 * @brief Reports to the driver that the sensor is powered now. Call it when the supply is switched on.
 *
 * The driver cancels what is in progress. For `start_us` after the call, no response and a damaged response become
 * FATHOM_ERR_WARMING_UP. If the program does not know when the sensor is powered, do not call this function; the errors
 * are then reported unchanged.
 */
void fathom_hps167_uart_power_on(fathom_hps167_uart_t *sensor);

/**
 * @brief Stops the continuous output, also one that another program has started.
 *
 * The call returns at once: call it again until its result differs from FATHOM_PENDING. With `continuous`, the next
 * fathom_poll() starts the output again.
 *
 * @param sensor  The driver.
 * @retval FATHOM_OK             The sensor acknowledged the command.
 * @retval FATHOM_PENDING        Call again.
 * @retval FATHOM_ERR_EXCEPTION  The sensor refused the command.
 * @retval FATHOM_ERR_BUSY       Another command is not finished.
 * @return Other errors of fathom_poll().
 */
fathom_status_t fathom_hps167_uart_stop(fathom_hps167_uart_t *sensor);

/**
 * @brief Reads the temperature of the analog front end.
 *
 * The call returns at once: call it again until its result differs from FATHOM_PENDING.
 *
 * @param sensor       The driver.
 * @param temperature  Written with FATHOM_OK only: the value as the sensor sent it. One public program divides it by 100
 *                     and states no unit, perhaps degrees Celsius. The HPS-167S has whole degrees Fahrenheit (#4).
 * @retval FATHOM_OK        `*temperature` is written.
 * @retval FATHOM_PENDING   Call again.
 * @retval FATHOM_ERR_BUSY  Another command is not finished.
 * @return Other errors of fathom_poll().
 */
fathom_status_t fathom_hps167_uart_get_temperature(fathom_hps167_uart_t *sensor, uint16_t *temperature);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_hps167_uart_poll().
 *
 * @param ctx     The driver, a fathom_hps167_uart_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_hps167_uart_poll().
 */
fathom_status_t fathom_hps167_uart_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_hps167_uart_t.
 * @return As fathom_hps167_uart_due_us().
 */
uint32_t fathom_hps167_uart_sensor_due_us(void *ctx);

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
static inline fathom_status_t fathom_hps167_uart_poll(fathom_hps167_uart_t *sensor, fathom_sample_t *sample)
{
    return fathom_hps167_uart_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_hps167_uart_due_us(fathom_hps167_uart_t *sensor)
{
    return fathom_hps167_uart_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_hps167_uart_sensor(fathom_hps167_uart_t *sensor)
{
    return fathom_sensor_make(fathom_hps167_uart_sensor_poll, fathom_hps167_uart_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
