/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STATUS_H
#define FATHOM_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The result of any call that can fail or take time.
 *
 * Success is 0, a call that is not finished is positive, and errors are negative: test for them with `status < 0`. No
 * status is a reading: "no target" and "the sensor reports a fault" are samples (sample.h), because the sensor did
 * respond.
 *
 * The numbers are part of the interface. They fit an int8_t, and later versions only add numbers.
 *
 * **Precedence.** Several things can go wrong in one attempt, and an attempt has one status. The first line of this
 * table that applies is the status of the attempt. Every driver keeps this order, and reports the status of the last
 * attempt if the request was retried.
 *
 * |    | what was observed                                                   | status                   |
 * |----|---------------------------------------------------------------------|--------------------------|
 * |  1 | The unit refused the request.                                       | FATHOM_ERR_EXCEPTION     |
 * |  2 | The attempt was not sent, or was sent without silence before it.    | FATHOM_ERR_LINE_BUSY     |
 * |  3 | Another master sent the unit a request while ours was in progress.  | FATHOM_ERR_OTHER_MASTER  |
 * |  4 | A response of the unit was damaged or broke off.                    | FATHOM_ERR_CHECKSUM      |
 * |  5 | The unit sent a frame with a right checksum that is not the response. | FATHOM_ERR_MALFORMED   |
 * |  6 | Only one copy of a write arrived, and it is not known if the line echoes. | FATHOM_ERR_ECHO    |
 * |  7 | None of these.                                                      | FATHOM_ERR_NO_RESPONSE   |
 *
 * A response that is accepted ends the attempt with FATHOM_OK, whatever was observed before. A driver may refuse an
 * accepted response because of its values; that is FATHOM_ERR_MALFORMED too. A sensor that sends without a request has
 * two such errors: FATHOM_ERR_CHECKSUM if bytes arrived but no valid frame, else FATHOM_ERR_STALE.
 *
 * A broken port, a cancelled request and an argument out of range come before the table: in these cases there is no
 * attempt to judge. FATHOM_ERR_WARMING_UP replaces lines 1, 4 and 7 directly after power-on.
 *
 * **What proves that no unit is there.** Only FATHOM_ERR_NO_RESPONSE does. FATHOM_ERR_LINE_BUSY and
 * FATHOM_ERR_OTHER_MASTER say nothing about the unit: repeat the request.
 *
 * **Programming mistakes.** If you compile the sources, the macro FATHOM_ASSERT can stop the program at a mistake. It is
 * empty by default. Define it for all sources of Fathom, for example with `-include assert.h -DFATHOM_ASSERT=assert`. It
 * checks three mistakes:
 *
 * - A driver is used before its init function returned FATHOM_OK. The function also returns its error.
 * - A driver is initialised while its request is queued. The function also returns its error.
 * - The parts of a line changed after fathom_line_init(), for example because they were a local variable of a function
 *   that has returned.
 */

/** @brief The result of a call. */
typedef enum {
    /** @brief The call succeeded: it is finished, and its outputs are new. */
    FATHOM_OK = 0,

    /** @brief The call is not finished and has written nothing. Call again. */
    FATHOM_PENDING = 1,

    /**
     * @brief An argument or a member of a config is outside its range, or the object is not initialised.
     *
     * Correct the program. Nothing was sent.
     */
    FATHOM_ERR_ARGUMENT = -1,

    /** @brief The port is broken: it reported an error, accepted a part of a write, or did not send. Continue to poll. */
    FATHOM_ERR_PORT = -2,

    /** @brief The unit did not respond within the time-out, and the line was silent and free of other masters. */
    FATHOM_ERR_NO_RESPONSE = -3,

    /**
     * @brief A response was damaged or broke off; or a sensor that sends without a request sent only damaged frames.
     *
     * Check baud rate, parity, termination and ground.
     */
    FATHOM_ERR_CHECKSUM = -4,

    /** @brief The unit refused the request with a Modbus exception. The driver has a function for its number. */
    FATHOM_ERR_EXCEPTION = -5,

    /** @brief A frame with a right checksum is not the response, or has a value that this sensor cannot mean. */
    FATHOM_ERR_MALFORMED = -6,

    /** @brief A sensor that sends without a request has sent nothing for too long. */
    FATHOM_ERR_STALE = -7,

    /** @brief The request was cancelled, or the line was initialised again while the request was queued. */
    FATHOM_ERR_CANCELLED = -8,

    /** @brief The object is in use: a request, command or setting is not finished. Nothing changed; try again later. */
    FATHOM_ERR_BUSY = -9,

    /** @brief The caller's memory is too small for this request or its response. Nothing was sent. */
    FATHOM_ERR_CAPACITY = -10,

    /**
     * @brief A write: the only received bytes equal the request, and it is not known whether the line echoes (line.h).
     *
     * Submit a read first, or state `echo` in the parts of the line.
     */
    FATHOM_ERR_ECHO = -11,

    /** @brief The port or the protocol cannot do this. Nothing was sent. */
    FATHOM_ERR_UNSUPPORTED = -12,

    /** @brief There is no reading yet so soon after power-on; reported only after `..._power_on()` was called. */
    FATHOM_ERR_WARMING_UP = -13,

    /** @brief A setting was sent and could not be read back: it may be set or not. Read it again. */
    FATHOM_ERR_UNCONFIRMED = -14,

    /** @brief A unit responds at the address that was to be set. Nothing was changed. */
    FATHOM_ERR_IN_USE = -15,

    /** @brief A setting was acknowledged, and reads back as another value. */
    FATHOM_ERR_DIFFERS = -16,

    /**
     * @brief The line was never silent for `busy_us` (line.h).
     *
     * The request was not sent, or it was sent without the silence before it and was not answered. Another device sends
     * without pause, the pair has no bias resistors, or the program polls too seldom. Says nothing about the unit.
     */
    FATHOM_ERR_LINE_BUSY = -17,

    /**
     * @brief Another master sent the same unit a request, so a response cannot be assigned to ours.
     *
     * Let one master poll this unit, or repeat the request. Says nothing about the unit.
     */
    FATHOM_ERR_OTHER_MASTER = -18
} fathom_status_t;

/**
 * @brief Returns the name of a status without FATHOM_ and ERR_, for messages and logs.
 *
 * For example "OK" or "NO_RESPONSE". The function costs 227 bytes of flash on a Cortex-M0+. On an AVR constants lie
 * in RAM: 176 bytes of it; print the number there. If a program does not call the function, it is not linked.
 *
 * @return A constant string, never NULL. "?" for any other number.
 */
const char *fathom_status_name(fathom_status_t status);

/**
 * @brief Returns what to check after a status: one or two sentences in English, for people who read the program's output.
 *
 * The advice follows from the status alone, so it is the same for all sensors. The function costs about 1.8 KB of flash
 * on a Cortex-M0+, and as much RAM on an AVR, where constants lie in RAM. If a program does not call the function, it is
 * not linked.
 *
 * @return A constant string, never NULL. "This is no status." for any other number.
 */
const char *fathom_status_advice(fathom_status_t status);

#ifdef __cplusplus
}
#endif

#endif
