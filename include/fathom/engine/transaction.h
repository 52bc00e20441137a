/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TRANSACTION_H
#define FATHOM_TRANSACTION_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief A request and its response, and the functions by which a line recognises the frames of a protocol.
 *
 * The rules that this file refers to are those of line.h.
 */

/** @brief A request and its response (struct fathom_transaction). */
typedef struct fathom_transaction fathom_transaction_t;

/**
 * @brief A protocol: the functions by which the line recognises the frames of, for example, Modbus RTU.
 *
 * All functions are pure and return at once. `transaction` is a transaction that names this protocol. `frame` points to
 * `received_count` bytes (at least 1) at the beginning of the line's frame buffer. No function changes a received byte.
 * The table is const and must stay valid as long as a line uses it.
 */
typedef struct {
    /**
     * @brief Writes the request to `frame`, which has `frame_size` bytes.
     * @return The length of the request in bytes, 1 to 255.
     */
    uint8_t (*encode)(const fathom_transaction_t *transaction, uint8_t *frame);

    /**
     * @brief Returns the length in bytes of the frame that begins at `frame`.
     * @retval 0  No frame begins here.
     * @return A result above `received_count` requests more bytes: call again when that number of bytes has arrived.
     */
    uint8_t (*length)(const uint8_t *frame, uint8_t received_count);

    /**
     * @brief Checks the checksum of `length` bytes.
     * @retval 0  The checksum is right. All other values: it is wrong.
     */
    uint16_t (*check)(const uint8_t *frame, uint8_t length);

    /**
     * @brief Returns true if the bytes are the beginning of the request, as an adapter with echo returns it.
     *
     * If as many bytes have arrived as the request has, the line checks the checksum as well.
     */
    bool (*is_request)(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t received_count);

    /**
     * @brief Decodes a complete frame with a right checksum that came from the requested unit.
     * @retval FATHOM_OK          The frame is the response. The results are written.
     * @retval FATHOM_ERR_EXCEPTION  The unit refused the request. The exception number is written.
     * @return All other values: the frame is not the response to this transaction, and nothing is written.
     */
    fathom_status_t (*parse_response)(fathom_transaction_t *transaction, const uint8_t *frame);

    /** @brief Offset of the unit's address in a frame, in bytes. */
    uint8_t address_offset;

    /** @brief True if address 0 is an ordinary unit. False if a request to address 0 is a broadcast. */
    bool is_unit_0_ordinary;

    /**
     * @brief Returns true if the request may be sent into noise: the request changes nothing in any unit, and the
     * checksum is strong enough that a damaged request cannot become one that does. NULL: no request may.
     */
    bool (*may_collide)(const fathom_transaction_t *transaction);
} fathom_protocol_t;

/** @brief Addresses with a special meaning. */
enum {
    /** @brief A broadcast: all units execute the request and none responds. */
    FATHOM_LINE_ALL_UNITS = 0,
    /**
     * @brief Any unit: the line accepts the first response, whichever unit sent it.
     *
     * All units are then quarantined as after a time-out, because a second unit may respond as well.
     */
    FATHOM_LINE_ANY_UNIT = 255
};

/**
 * @brief A request and its response, in the caller's memory.
 *
 * Set the members from `protocol` to `retries` and submit the transaction. Do not change or free the transaction until
 * `status` differs from FATHOM_PENDING. After that, the transaction can be submitted again at once.
 */
struct fathom_transaction {
    /** @brief The protocol of the request. Must stay valid as long as the line uses it. */
    const fathom_protocol_t *protocol;

    /**
     * @brief Line settings that are set before the request is sent. NULL: `line_settings` in the parts of the line.
     *
     * If those are NULL too, the settings of the transaction before are used. Then, if one transaction of a line names
     * line settings, all must. Must stay valid as long as the transaction is queued.
     */
    const fathom_line_settings_t *line_settings;

    /**
     * @brief Time from the end of the request to the first byte of the response, in microseconds; at most 2^31 - 1.
     *
     * The maximum is 35 minutes, because a quarantine lasts twice the time-out. For a broadcast this is the turnaround
     * delay: the time that the units need before the next request. After the delay the transaction ends with
     * FATHOM_OK.
     */
    uint32_t timeout_us;

    /**
     * @brief Address of the unit.
     *
     * Units whose addresses are equal modulo 16 share one quarantine. This can delay a request to one of them. It never
     * assigns the response of one unit to another.
     */
    uint8_t address;

    /** @brief Number of further attempts after a failed attempt, 0 to 254. */
    uint8_t retries;

    /** @brief Number of attempts that were sent. 0: no unit has received the request. Written by the line. */
    uint8_t attempts;

    /**
     * @brief Result of the transaction. Written by the line; an int8_t that holds a fathom_status_t.
     *
     * | value                   | cause                                                                          |
     * |-------------------------|--------------------------------------------------------------------------------|
     * | FATHOM_PENDING          | The transaction is queued or on the wire.                                      |
     * | FATHOM_OK            | The response arrived and its results are written; or the broadcast is finished. |
     * | FATHOM_ERR_EXCEPTION    | The unit refused the request. The exception number is in the request.          |
     * | FATHOM_ERR_LINE_BUSY    | No silence came within `busy_us` (rule 3). See `attempts`.                     |
     * | FATHOM_ERR_OTHER_MASTER | Another master sent this unit a request during the attempt (rule 12).          |
     * | FATHOM_ERR_CHECKSUM     | A response of the unit was damaged or broke off.                               |
     * | FATHOM_ERR_MALFORMED    | The unit sent a frame with a right checksum that is not the response.          |
     * | FATHOM_ERR_ECHO         | Only one copy of a write arrived, and echo is not known (rule 9).              |
     * | FATHOM_ERR_NO_RESPONSE  | The unit did not respond within the time-out.                                  |
     * | FATHOM_ERR_CANCELLED    | fathom_line_cancel() ended the transaction.                                    |
     * | FATHOM_ERR_UNSUPPORTED  | The port cannot set `line_settings`. Nothing was sent.                         |
     * | FATHOM_ERR_PORT         | The port reported an error, or did not send within FATHOM_LINE_SEND_US.        |
     *
     * If several errors apply to the last attempt, the one that stands first in this table is reported.
     */
    int8_t status;

    /** @brief Queue link or time stamp, depending on `status`. Written by the line. */
    union {
        /** @brief While the transaction is queued: the next transaction in the queue. */
        fathom_transaction_t *next;
        /** @brief After the transaction ended with a response: the clock at its last byte, in microseconds. */
        uint32_t heard_us;
    } link;
};

#ifdef __cplusplus
}
#endif

#endif
