/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STREAM_H
#define FATHOM_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/codec/dyp_stream.h"
#include "fathom/engine/line.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Finds the frames FF .. SUM that an A16 or A05 with automatic output sends.
 *
 * A stream receives bytes and returns whole frames of 4 or 10 bytes (dyp_stream.h). The bytes come from a line, whose
 * listener the stream is, or from the caller, who passes them to fathom_stream_feed(). The stream never waits, never
 * allocates memory, and keeps no state outside its struct and `storage`.
 *
 * @code
 * static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
 * static const fathom_stream_config_t config = {.storage = storage, .length = FATHOM_DYP_A16_LENGTH};
 * fathom_stream_init(&stream, &config, now_us());
 * fathom_line_listen(&line, &stream.listener);
 * for (;;) {
 *     fathom_line_poll(&line);                              // feeds the stream
 *     if (fathom_stream_poll(&stream, now_us()) == FATHOM_OK)
 *         fathom_dyp_stream_decode(fathom_stream_frame(&stream), &distance_mm, 1);
 * }
 * @endcode
 *
 * @note Call all functions of one stream from one context: never from an interrupt, never from two tasks at once.
 *
 * The state of a stream. A new frame may wait while the stream already searches for the next frame.
 *
 *                 a valid window where               the next byte is FF,
 *                 a frame may stand                  or gap_us of silence
 *     SEARCHING ----------------------> CANDIDATE ------------------------> NEW FRAME
 *         ^                                 |                                   |
 *         |<--- any other byte, a loss -----+                                   |
 *         |<-------------- fathom_stream_poll() returns FATHOM_OK -----------+
 *
 * A **window** is the last `length` bytes. A window is **valid** if it begins with FF and its last byte is the sum of
 * the bytes before it. A valid window is not always a frame: FF may stand anywhere in a frame, and the sum has 8 bits.
 *
 * 1. **Where a frame may stand.** The stream believes a valid window only in two places. The first is directly after a
 *    silence of `gap_us` that the clock or the port measured. The second is directly after another valid window, if no
 *    other alignment of the bytes of both was valid.
 *
 *        wire   ......... FF 07 A1 A7 ..........     A1 A7 FF 07 A1 A7 FF 07 A1 A7 FF
 *               silence  [  believed ]  silence           [ not known ][  believed ]
 *
 * 2. **Where a frame ends.** A believed window becomes a new frame when the next byte is FF, or after `gap_us` of
 *    silence. Any other byte refutes the window: the sensor sends FF after each frame. The frame is therefore returned
 *    one byte late, or `gap_us` late: 5 ms on a microcontroller, 25 ms behind an operating system. `time_us` is still
 *    the time of the last byte of the frame.
 *
 *        wire   FF 07 A1 A7 FF           FF 07 A1 A7 .....         FF 07 9B A1 A7
 *               [ window  ] ^ a frame    [ window  ]  ^ a frame    [ window  ] ^ no frame
 *
 * 3. **Ambiguity.** A few values are valid in two alignments. A sensor that holds 511 mm can be read as 65281 mm one
 *    byte early. Without silences the stream shows neither value: it counts the windows as ambiguous.
 *
 *        wire       FF 01 FF FF FF 01 FF FF FF 01 FF FF
 *        511 mm     [         ] [         ] [         ]
 *        65281 mm            [         ] [         ]
 *
 * 4. **A sure place.** The place of a frame is sure (`is_sure`) if silence was measured before and after the frame, or
 *    if the frame follows in step after two frames or more. In any other believed place, a frame could still consist of
 *    the halves of two frames.
 *
 * 5. **Stale.** If no frame is accepted for `stale_us`, fathom_stream_poll() returns an error, and again after each
 *    further `stale_us`. The error is FATHOM_ERR_CHECKSUM if bytes arrived in this time, and FATHOM_ERR_STALE if the
 *    wire was silent. Bytes of other devices on the line count too.
 *
 *        wire      [frame] [damaged] [damaged] [damaged]      ..............................
 *        poll      OK               CHECKSUM ^             ..............  STALE ^
 *                  |<-------- stale_us -------->|             |<----- stale_us ---->|
 *
 * 6. **Age.** A frame is at most `stale_us` and FATHOM_LINE_LATE_US old when fathom_stream_poll() returns it. A poll
 *    that comes later drops the frame and returns FATHOM_ERR_STALE. The line drops bytes that may be older than
 *    `stale_us` in the same way, because a port does not know when a byte arrived (line.h, rule 14).
 *
 *        wire      [frame]
 *        polls     |   |     . . . the program sleeps . . .       |       |
 *                                                    ERR_STALE ---+       +--- only later frames
 *
 *    If the caller feeds the stream, the caller must do the same after a pause: discard the bytes that gathered in the
 *    pause, and call fathom_stream_feed() with a `count` of 0. Otherwise bytes of earlier get the time of now. Nothing
 *    can detect a pause of more than 71 minutes. Before such a pause, poll until the result is FATHOM_PENDING. After
 *    the pause, call fathom_stream_start(), and for a line fathom_line_flush().
 *
 * 7. **Damage.** The stream counts what it drops. Each byte ends in exactly one place: in an accepted frame, in the
 *    counter FATHOM_STREAM_DROPPED_BYTES, or among the newest `length` bytes, which may still become a frame. Each
 *    frame with a wrong sum, with a wrong first byte or with missing bytes is counted as FATHOM_STREAM_DAMAGED, if the
 *    stream knows where the frame should stand. A valid window that the stream does not believe is counted as
 *    FATHOM_STREAM_AMBIGUOUS or FATHOM_STREAM_UNSURE.
 *
 *        wire      ... FF 07 A1 A7 ... FF 06 A1 A7 ... FF 07 A1 ...  FF 07 A1 A7 55 ...
 *        counted        FRAMES          DAMAGED +1      DAMAGED +1    UNSURE +1
 *        dropped                        4 bytes         3 bytes       5 bytes
 *
 * 8. **Limits.** Damage that leaves the sum right cannot be seen. A single wrong bit and a single wrong byte are always
 *    seen. Two wrong bits cancel only if they stand at the same place of two bytes. If a share d of the frames is seen
 *    as damaged (DAMAGED / (DAMAGED + FRAMES)), the share of frames with a wrong value is:
 *
 *    | damage                                         | A16, 4 bytes | A05, 10 bytes | A16: d = 1 % | d = 10 %   |
 *    |------------------------------------------------|--------------|---------------|--------------|------------|
 *    | independent wrong bits                         | 0.013 x d^2  | 0.026 x d^2   | 1 in 760,000 | 1 in 7,500 |
 *    | one of bits 0 to 6 of each byte (a soft UART)  | 0.094 x d^2  | 0.18 x d^2    | 1 in 106,000 | 1 in 1,040 |
 *    | bit 7 of each byte                             | 0.19 x d^2   | 0.36 x d^2    | 1 in 53,000  | 1 in 520   |
 *    | bytes replaced at random, but for the first    | d / 255      | d / 255       | 1 in 25,500  | 1 in 2,550 |
 *
 *    These are averages over all values. For one value that is held, the first row is at most 0.017 x d^2 (A16).
 *    A byte too many passes once in 65536: the sum must be FF and the byte must fit. A byte too few passes once in 256
 *    at most, and only before a frame that follows without a silence and continues with FF, such as FF FF FD FB (no
 *    target).
 *
 * The newest frame wins: if two frames arrive between two polls, the older one is counted as FATHOM_STREAM_MISSED.
 */

/** @brief Default of fathom_stream_config_t::gap_us, in microseconds. */
#define FATHOM_STREAM_DEFAULT_GAP_US 5000

/** @brief Least fathom_stream_config_t::gap_us: a character of 10 bits at 9600 baud, in microseconds. */
#define FATHOM_STREAM_MIN_GAP_US 1042

/** @brief Default of fathom_stream_config_t::stale_us, in microseconds. */
#define FATHOM_STREAM_DEFAULT_STALE_US 2000000uL

/** @brief Greatest fathom_stream_config_t::stale_us: 35 minutes, in microseconds. */
#define FATHOM_STREAM_MAX_STALE_US 0x7FFFFFFFuL

/** @brief Size in bytes of the memory of a stream of frames of `length` bytes. */
#define FATHOM_STREAM_STORAGE(length) (2 * (length))

/**
 * @brief Indices of the counters in fathom_stream_t::counters.
 *
 * Each counter stops at 65535. The caller may set a counter to 0.
 */
enum {
    FATHOM_STREAM_FRAMES = 0, /**< Accepted frames. */
    /** Accepted frames that were not returned: a newer frame arrived before the poll, or the poll came too late. */
    FATHOM_STREAM_MISSED = 1,
    /** Valid windows that overlap another valid window (rule 3). */
    FATHOM_STREAM_AMBIGUOUS = 2,
    /** Valid windows in a place that is not believed, or followed by a byte other than FF or by a loss (rule 2). */
    FATHOM_STREAM_UNSURE = 3,
    FATHOM_STREAM_STALES =
        4, /**< Times that `stale_us` passed without an accepted frame, whatever the error was. */
    FATHOM_STREAM_BYTES = 5, /**< Received bytes. */
    /** Received bytes that are in no accepted frame. A byte is counted as soon as it can be in none. */
    FATHOM_STREAM_DROPPED_BYTES = 6,
    /** Times that no valid window stood directly after a silence or an accepted frame, though bytes arrived there: a
     * wrong sum, a wrong first byte, or fewer than `length` bytes before the next silence or loss. */
    FATHOM_STREAM_DAMAGED = 7,
    FATHOM_STREAM_COUNTERS = 8 /**< Number of counters. */
};

/** @brief Configuration of a stream. Copied by fathom_stream_init(). A member that is 0 takes its default. */
typedef struct {
    /** @brief Memory of FATHOM_STREAM_STORAGE(length) bytes. Only the stream may use it while the stream is used. */
    uint8_t *storage;

    /** @brief Time without a frame after which the stream is stale, in microseconds: 1 to 2^31 - 1. 0 selects 2 s. */
    uint32_t stale_us;

    /**
     * @brief Silence that starts and ends a frame, in microseconds: 1042 to 65535. 0 selects 5000.
     *
     * Choose more than one character, and less than the pause between two frames. Behind an operating system choose
     * 25000. With a `gap_us` that is longer than the pauses, the next frame ends a frame.
     */
    uint16_t gap_us;

    /** @brief Length of a frame in bytes: FATHOM_DYP_A16_LENGTH (4) or FATHOM_DYP_A05_LENGTH (10). */
    uint8_t length;
} fathom_stream_config_t;

/** @brief Where a valid window stands, in increasing order of trust. */
typedef enum {
    FATHOM_STREAM_NOWHERE = 0,      /**< Not where a frame may stand; or the window is not valid. */
    FATHOM_STREAM_AFTER_WINDOW = 1, /**< Directly after a valid window. */
    FATHOM_STREAM_AFTER_SILENCE =
        2,                    /**< Directly after a silence. Silence on both sides is as good as IN_STEP. */
    FATHOM_STREAM_IN_STEP = 3 /**< Directly after two valid windows or more that follow each other. */
} fathom_stream_place_t;

/** @brief How the newest valid window stands to the valid window before it. */
typedef enum {
    FATHOM_STREAM_APART = 0,    /**< Bytes lie between the two, or there is no window before it. */
    FATHOM_STREAM_OVERLAPS = 1, /**< The two have bytes in common: neither alignment is known to be right. */
    FATHOM_STREAM_ADJOINS = 2   /**< Directly after a window that overlaps no other. */
} fathom_stream_relation_t;

/**
 * @brief A stream, in the caller's memory. Call fathom_stream_init() before use.
 *
 * The caller may use `listener` (for fathom_line_listen()), `counters`, and after FATHOM_OK `time_us` and `is_sure`.
 * All other members are private to the stream and the drivers of this library.
 */
typedef struct {
    /** @brief The listener for fathom_line_listen(). Invariant: the first member, so that one pointer is both. */
    fathom_listener_t listener;

    /* Bytes stand before words, because a Cortex-M0+ reaches only the first 32 bytes of a struct at once. */

    /** @brief Length of a frame in bytes: 4 or 10. */
    uint8_t length;

    /** @brief Bytes since the last silence or loss; stops at 255. A window may not reach across either. */
    uint8_t run_count;

    /** @brief Bytes since the end of the newest valid window; stops at 255. At `length` a window adjoins. */
    uint8_t step_count;

    /**
     * @brief Newest bytes of which it is not known yet whether an accepted frame contains them: 0 to `length`.
     *
     * Invariant: received bytes = `length` x accepted frames + dropped bytes + `undecided_count`.
     */
    uint8_t undecided_count;

    /** @brief The window's place: a fathom_stream_place_t. Not NOWHERE: FF or silence makes the window a new frame. */
    uint8_t candidate;

    /** @brief How the newest valid window stands to the one before it: a fathom_stream_relation_t. */
    uint8_t relation;

    /**
     * @brief True if the undecided bytes begin where a frame must stand: after a measured silence or an accepted frame.
     *
     * Invariant: false if `undecided_count` is `length`.
     */
    bool is_expected;

    /** @brief True if bytes arrived, or were lost, since fathom_stream_poll() last returned a frame or an error. */
    bool is_heard;

    /** @brief True if the newest frame has not been returned by fathom_stream_poll() yet. */
    bool is_new;

    /** @brief True if the place of the newest frame is sure (rule 4). Valid after FATHOM_OK. */
    bool is_sure;

    /** @brief The counters. */
    uint16_t counters[FATHOM_STREAM_COUNTERS];

    /** @brief The window, the last `length` bytes; behind it the newest frame. */
    uint8_t *storage;

    /** @brief Clock when fathom_stream_poll() last returned a frame or an error, in microseconds. */
    uint32_t since_us;

    /** @brief Clock at the last byte of the newest frame, in microseconds. Valid after FATHOM_OK. */
    uint32_t time_us;

    /** @brief Clock at the last byte of the candidate, in microseconds. */
    uint32_t candidate_us;
} fathom_stream_t;

/**
 * @brief Initialises a stream. Any previous contents of `*stream` are overwritten.
 *
 * @param stream  The stream.
 * @param config  The configuration. Not used after the call.
 * @param now_us  The clock. `stale_us` starts here.
 * @retval FATHOM_OK         The stream can be used. Next, call fathom_line_listen() or fathom_stream_feed().
 * @retval FATHOM_ERR_ARGUMENT  `storage` is NULL, `length` is neither 4 nor 10, `stale_us` is above 2^31 - 1, or
 *                              `gap_us` is 1 to 1041. Correct the config.
 */
fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us);

/**
 * @brief Starts a stream again with the configuration that it has. All received bytes and all counters are dropped.
 *
 * A driver may set `storage`, `length`, `listener.gap_us` and `listener.stale_us` and call this function instead of
 * fathom_stream_init().
 *
 * @param stream  The stream.
 * @param now_us  The clock. `stale_us` starts here.
 * @return As fathom_stream_init().
 */
fathom_status_t fathom_stream_start(fathom_stream_t *stream, uint32_t now_us);

/**
 * @brief Receives bytes: the function `receive` of the stream's listener. The line calls it.
 *
 * @param listener   The member `listener` of a stream.
 * @param bytes      The bytes in order of arrival. Valid only during the call.
 * @param count      Number of bytes. 0 without `after_gap`: bytes were lost here.
 * @param after_gap  True if the wire was silent for `gap_us` before the first byte, or if the bytes before it are known
 *                   to have ended.
 * @param time_us    Clock at the arrival of the last byte, in microseconds.
 */
void fathom_stream_receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                           uint32_t time_us);

/**
 * @brief Feeds a stream by hand. A stream that listens to a line is fed by the line.
 *
 * @param stream     The stream.
 * @param bytes      The bytes in order of arrival. Valid only during the call.
 * @param count      Number of bytes. 0 without `after_gap`: bytes were lost or discarded here (rule 6).
 * @param after_gap  True if the wire was silent for `gap_us` before the first byte.
 * @param time_us    Clock at the arrival of the last byte, in microseconds. A byte whose time is not known may be as
 *                   old as the pause since the previous read. If that is more than `stale_us`, discard the byte.
 */
static inline void fathom_stream_feed(fathom_stream_t *stream, const uint8_t *bytes, uint8_t count,
                                      bool after_gap, uint32_t time_us)
{
    fathom_stream_receive(&stream->listener, bytes, count, after_gap, time_us);
}

/**
 * @brief Returns the newest frame, or an error if there was none for `stale_us`.
 *
 * Call this function after all bytes that arrived before `now_us` have been fed, and at least every 71 minutes.
 *
 * @param stream  The stream.
 * @param now_us  The clock, not before the time of the last byte.
 * @retval FATHOM_OK         fathom_stream_frame() is a new frame; `time_us` and `is_sure` belong to this frame. Read
 *                              the frame before more bytes are fed. Each frame is returned once.
 * @retval FATHOM_PENDING       There is no new frame.
 * @retval FATHOM_ERR_STALE     The wire was silent for `stale_us`; or the newest frame is too old (rule 6).
 * @retval FATHOM_ERR_CHECKSUM  Bytes arrived for `stale_us`, but no frame: noise, another rate, another device, or
 *                              damage. The counters show which.
 */
fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us);

/** @brief Returns the newest frame, `length` bytes. Valid after FATHOM_OK until more bytes are fed. */
static inline const uint8_t *fathom_stream_frame(const fathom_stream_t *stream)
{
    return &stream->storage[stream->length];
}

/**
 * @brief Returns the time in microseconds until fathom_stream_poll() returns a frame or an error if no byte arrives.
 *
 * @param stream  The stream.
 * @param now_us  The clock.
 * @retval 0  A frame or an error waits.
 */
uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
