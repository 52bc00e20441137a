/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_AUTO_H
#define FATHOM_HPS167S_AUTO_H

#include "fathom/engine/line.h"
#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads an HPS-167S that sends measurements without a request.
 *
 * The driver is the listener of a line, and each frame of one sensor is one sample. It is for a sensor that sends
 * unsolicited frames, or for a program that listens to another master; hps167s.h sends requests. It sends nothing,
 * never waits and never allocates memory. include/COST.md has its flash, RAM and stack (`hps167s_auto`).
 *
 * @note The datasheet contradicts itself. Section 2.2.1 states that a slave cannot send without a request, and #5
 * states that a master repeats the request to measure continuously. Table 12, #10 and #15 describe a "continuous
 * output".
 *
 * @code
 * fathom_line_init_listening(&line, &parts);          // line.h: a line without requests
 * fathom_hps167s_auto_init(&gate, &line, NULL);       // address 1
 * const fathom_sensor_t sensor = fathom_hps167s_auto_sensor(&gate);
 *
 * fathom_sample_t sample;                             // in the loop:
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) use(sample.distance_mm);
 * @endcode
 *
 * 1. **Frames.** The driver searches the received bytes for frames of the shape of the response to #5 from one address:
 *    ADDRESS 03 08, 8 bytes, CRC. If a byte cannot belong to such a frame, the driver drops this byte and continues
 *    with the next. So the driver needs no silence: the CRC decides what is a frame.
 *
 *        bytes   01 01 03 08 | 01 03 08 08 23 DC B2 07 01 00 00 FD 41 | 01 03 08 08 23 DC ...
 *                dropped     | a frame                                | held: may become a frame
 *
 *    The CRC sees one and two wrong bits in a frame, and all errors within 16 bits in a row. Of frames whose bytes were
 *    replaced at random, one in 65536 passes.
 *
 * 2. **Requests** to the same sensor on the same line work at the same time. A response goes to its request, and a
 *    frame that no request waits for comes to this driver. See fathom_hps167s_auto_follow().
 *
 * 3. **Samples.** Each frame is one sample, with the kinds of hps167s.h (rule 1). `time_us` is the clock at the last
 *    byte of the frame. If several frames arrive between two polls, the driver returns the newest and counts the others
 *    in `missed`. A frame that is older than `stale_us` and FATHOM_LINE_LATE_US is no sample, whether it waited in the
 *    port (line.h, rule 14) or in the driver.
 *
 * 4. **What `sequence` promises.** `sequence` increases by 1 with each sample that fathom_poll() returns, and wraps
 *    after
 *    65535. A new number means a new frame. The datasheet does not state whether a new frame is always a new
 *    measurement. The sensor measures 6 to 54 times a second (table 1).
 *
 * 5. **Errors of fathom_poll().** The driver continues after each.
 *
 *    | error                | cause                                                                               |
 *    |----------------------|-------------------------------------------------------------------------------------|
 *    | FATHOM_ERR_STALE     | Nothing was received for `stale_us`. Returned once every `stale_us`.                |
 *    | FATHOM_ERR_CHECKSUM  | Bytes were received for `stale_us`, but no sample of this address: damage, noise,   |
 *    |                      | another rate, or another device. Returned once every `stale_us`.                    |
 *    | FATHOM_ERR_MALFORMED | A frame has values that cannot be a measurement. Counted in `implausible`.          |
 *    | FATHOM_ERR_PORT      | The port is broken. Returned by every poll until the port works again.              |
 *    | FATHOM_ERR_ARGUMENT  | The driver is not initialised.                                                      |
 */

/** @brief Length of a frame of the shape of a measurement. */
enum {
    FATHOM_HPS167S_FRAME_LENGTH = 13 /**< In bytes, with address, function, byte count and CRC. */
};

/** @brief Default of fathom_hps167s_auto_config_t::stale_us in microseconds. The slowest rate is 6 frames a second. */
#define FATHOM_HPS167S_AUTO_DEFAULT_STALE_US 2000000uL

/** @brief Configuration. Read only during fathom_hps167s_auto_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Time without a sample after which fathom_poll() returns an error, in microseconds: 1 to 2^31 - 1.
     *
     * 0 selects 2 s. The slowest sensor sends 6 frames a second (table 1).
     */
    uint32_t stale_us;

    /** @brief Address of the unit: 1 to 32. 0 selects 1. */
    uint8_t address;
} fathom_hps167s_auto_config_t;

/**
 * @brief A driver, in the caller's memory.
 *
 * The caller may read the members from `sequence` to `damaged`, and set the counters among them to 0. All others are
 * private.
 */
typedef struct {
    /** @brief The listener. Invariant: the first member, so that one pointer is both. */
    fathom_listener_t listener;

    /** @brief The line. */
    fathom_line_t *line;

    /** @brief The driver that sends requests to the same device (fathom_hps167s_auto_follow()), or NULL. */
    fathom_hps167s_t *driver;

    /** @brief Returns false if a frame may be a late response to a request of `driver`. Not NULL if `driver` is not. */
    bool (*heard)(fathom_hps167s_t *driver, const uint16_t registers[4], uint32_t time_us);

    /** @brief The distance limits, or NULL for the default limits. */
    const fathom_hps167s_limits_t *limits;

    /** @brief Clock at the last sample or stale error, in microseconds. */
    uint32_t since_us;

    /** @brief Clock at the last byte of the newest frame, in microseconds. */
    uint32_t time_us;

    /** @brief The four registers of the newest frame. */
    uint16_t registers[4];

    /** @brief Sequence number of the newest sample. */
    uint16_t sequence;

    /** @brief Frames that were refused because of their values. This and the next counters stop at 65535. */
    uint16_t implausible;

    /** @brief Frames that were not returned: a newer frame arrived before the poll, or the poll came too late. */
    uint16_t missed;

    /** @brief Received bytes that belong to no frame of this address. */
    uint16_t dropped_bytes;

    /** @brief Frames of this address with a wrong CRC: 13 bytes that begin with ADDRESS 03 08. */
    uint16_t damaged;

    /* private */
    const uint8_t *from;   /* the address whose frames count: `address`, or that of `driver` */
    uint8_t address;       /* the address of the config */
    uint8_t frame_address; /* the address in the newest frame */
    uint8_t held_count;    /* number of bytes in `bytes`. Invariant: they can be the beginning of a frame */
    bool is_new;           /* true if the newest frame has not been returned yet */
    bool is_heard;         /* true if bytes arrived, or were lost, since the last sample or stale error */
    uint8_t bytes[FATHOM_HPS167S_FRAME_LENGTH]; /* the beginning of the next frame */
} fathom_hps167s_auto_t;

/**
 * @brief Initialises a driver and makes it the listener of the line.
 *
 * @param sensor  The driver. Must stay valid until fathom_hps167s_auto_deinit().
 * @param line    The initialised line, whose listener the driver becomes. Its frame buffer has at least 13 bytes. Must
 *                stay valid until fathom_hps167s_auto_deinit().
 * @param config  The config. Read only during the call. NULL selects all defaults.
 * @retval FATHOM_OK         The driver listens. Next, pass fathom_hps167s_auto_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `line` is NULL or not initialised, its frame buffer has less than 13 bytes, `address` is above 32, or
 *                              `stale_us` is above 2^31 - 1. Correct the config.
 * @retval FATHOM_ERR_BUSY      The line has another listener, which stays. Remove that one first.
 */
fathom_status_t fathom_hps167s_auto_init(fathom_hps167s_auto_t *sensor, fathom_line_t *line,
                                         const fathom_hps167s_auto_config_t *config);

/**
 * @brief Names a driver that sends requests to the same device on the same line.
 *
 * From now on the driver searches for frames from the address of `driver`, also after that address changes, and passes
 * each frame to fathom_hps167s_accept_unsolicited(). The response to command #2 has the same shape as a measurement and
 * may arrive late. So two kinds of frames are no measurement and are counted in `implausible`:
 *
 * - a frame that equals the newest response to #2, and
 * - between #2 and the next request, a frame that could be the response to #2. Of all distances, this concerns only
 *   255 mm.
 *
 * @param sensor  The driver that listens.
 * @param driver  The driver that sends requests. Must stay valid as long as `sensor`.
 */
void fathom_hps167s_auto_follow(fathom_hps167s_auto_t *sensor, fathom_hps167s_t *driver);

/**
 * @brief Replaces the default distance limits (hps167s_registers.h), from the next poll on.
 *
 * @param sensor  The driver, initialised.
 * @param limits  The limits. Members that are 0 are set to their defaults. Must stay valid until
 *                fathom_hps167s_auto_deinit().
 * @retval FATHOM_OK            The limits are in use.
 * @retval FATHOM_ERR_ARGUMENT  `over_range_mm` is 65535 or not above `max_mm`, or `min_mm` is above `max_mm`. The
 *                              driver uses the same limits as before.
 */
fathom_status_t fathom_hps167s_auto_set_limits(fathom_hps167s_auto_t *sensor,
                                               fathom_hps167s_limits_t *limits);

/** @brief Stops listening, if the driver is the listener of the line. The memory is the caller's again. */
void fathom_hps167s_auto_deinit(fathom_hps167s_auto_t *sensor);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_hps167s_auto_poll().
 *
 * @param ctx     The driver, a fathom_hps167s_auto_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_hps167s_auto_poll().
 */
fathom_status_t fathom_hps167s_auto_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_hps167s_auto_t.
 * @return As fathom_hps167s_auto_due_us().
 */
uint32_t fathom_hps167s_auto_sensor_due_us(void *ctx);

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
static inline fathom_status_t fathom_hps167s_auto_poll(fathom_hps167s_auto_t *sensor, fathom_sample_t *sample)
{
    return fathom_hps167s_auto_sensor_poll(sensor, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_hps167s_auto_due_us(fathom_hps167s_auto_t *sensor)
{
    return fathom_hps167s_auto_sensor_due_us(sensor);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_hps167s_auto_sensor(fathom_hps167s_auto_t *sensor)
{
    return fathom_sensor_make(fathom_hps167s_auto_sensor_poll, fathom_hps167s_auto_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
