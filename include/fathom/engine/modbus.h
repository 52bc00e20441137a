/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_H
#define FATHOM_MODBUS_H

#include "fathom/codec/modbus_rtu.h"
#include "fathom/engine/line.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The transport between the Modbus drivers and the line or library that carries Modbus.
 *
 * A driver knows only this interface. modbus_client.h and dyp_client.h implement it on a line; a port over another
 * Modbus library implements it too.
 */

/**
 * @brief A Modbus request, in the caller's memory.
 *
 * Fill in `message` (modbus_rtu.h) and the members `timeout_us`, `retries` and `line_settings` of `transaction`, then
 * submit the request. Do not change the request until `transaction.status` differs from FATHOM_PENDING.
 * fathom_transaction_t lists the results; `transaction.link.heard_us` is then the time of the response.
 */
typedef struct {
    /** @brief The transaction of the line. The first member, so that one pointer serves for both types. */
    fathom_transaction_t transaction;
    /** @brief The request and its response. */
    fathom_modbus_message_t message;
} fathom_modbus_request_t;

/** @brief A transport of Modbus requests. Must stay valid as long as the drivers that use it. */
typedef struct {
    /**
     * @brief Queues a request.
     * @retval FATHOM_PENDING          The request is queued; `transaction.status` has its result later.
     * @retval FATHOM_ERR_ARGUMENT     A count is out of range, or the time-out is above 2^31 - 1. Nothing changed.
     * @retval FATHOM_ERR_CAPACITY     The frame buffer is too small for the request or its response. Nothing changed.
     * @retval FATHOM_ERR_BUSY         This request is queued already. Nothing changed.
     * @retval FATHOM_ERR_UNSUPPORTED  The transport cannot carry this request. Nothing changed.
     */
    fathom_status_t (*submit)(void *ctx, fathom_modbus_request_t *request);

    /** @brief Ends a request with FATHOM_ERR_CANCELLED and returns its memory to the caller. */
    void (*cancel)(void *ctx, fathom_modbus_request_t *request);

    /** @brief Ends every queued request to one unit with FATHOM_ERR_CANCELLED, because the unit has moved. */
    void (*cancel_unit)(void *ctx, uint8_t address);

    /**
     * @brief Does all work that can be done without waiting.
     *
     * If several drivers share the transport, one call in each round of the main loop does the work for all of them
     * (fathom_line_was_polled()). A transport may ignore `since_us` and work at each call.
     *
     * @param since_us  The clock at the previous call of this driver, in microseconds.
     * @retval FATHOM_PENDING   The transport works.
     * @retval FATHOM_ERR_PORT  The port is broken, and all queued requests have ended with this error.
     */
    fathom_status_t (*poll)(void *ctx, uint32_t since_us);

    /** @brief Returns the time in microseconds until `poll` must be called again, or FATHOM_NO_DEADLINE. */
    uint32_t (*due_us)(void *ctx);

    /** @brief The clock of the transport and of the drivers that use it. Must stay valid as long as the transport. */
    const fathom_clock_t *clock;

    /** @brief First argument of all functions. */
    void *ctx;

    /**
     * @brief Returns true if a request is queued or on the wire. Compares only the pointer.
     *
     * With this function a driver refuses a second init while its request is queued, and notices that its request was
     * forgotten because the transport was initialised again. NULL: the driver does not check.
     */
    bool (*has)(void *ctx, const fathom_modbus_request_t *request);

    /** @brief The longest frame that the transport can carry, in bytes. 0: there is no limit. */
    uint8_t frame_size;
} fathom_modbus_t;

/**
 * @brief Returns a transport whose requests are transactions of a line.
 *
 * @param line    The line, after fathom_line_init(). If the line is not initialised, the returned transport has no
 *                clock, and each driver refuses it with FATHOM_ERR_ARGUMENT.
 * @param submit  Submits a request to the line. All other functions are those of the line.
 * @return The transport, by value. Keep it as long as the drivers that point to it.
 */
fathom_modbus_t fathom_modbus_over_line(fathom_line_t *line,
                                        fathom_status_t (*submit)(void *line,
                                                                  fathom_modbus_request_t *request));

#ifdef __cplusplus
}
#endif

#endif
