/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_RTU_H
#define FATHOM_MODBUS_RTU_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Encodes and parses Modbus RTU frames of the functions 03, 06 and 10 (hexadecimal), for client and server.
 *
 * The functions are pure: they have no state and need no time or I/O. Sources: MODBUS Application Protocol V1.1b3 (6.3,
 * 6.6, 6.12, 7) and MODBUS over Serial Line V1.02 (2.5.1). Frames have at most 255 bytes, which suffices for 125
 * registers read and 123 written. modbus_client.h sends requests over a line. include/COST.md has the size in the row
 * `modbus_rtu`.
 *
 * @code
 * fathom_modbus_read_holding_registers(&message, 1, 0x0100, 1, &value);
 * length = fathom_modbus_rtu_encode_request(&message, frame);      // 01 03 01 00 00 01 85 F6 (A16 6(4))
 * @endcode
 */

/** @brief Function codes. */
enum {
    FATHOM_MODBUS_READ_HOLDING_REGISTERS = 0x03, /**< Reads 1 to 125 registers. */
    FATHOM_MODBUS_WRITE_SINGLE_REGISTER = 0x06,  /**< Writes one register. The response equals the request. */
    FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS = 0x10, /**< Writes 1 to 123 registers. */
    FATHOM_MODBUS_EXCEPTION = 0x80 /**< This bit marks the function code of an exception response. */
};

/** @brief Special addresses, and limits. */
enum {
    /**
     * @brief The broadcast address: all units execute a write, and none responds.
     *
     * A read is for the unit whose address is 0. An A16 or A05 may have this address (A16 6(3), A05 3(3)).
     */
    FATHOM_MODBUS_BROADCAST = 0,

    /**
     * @brief Any unit. Not part of the standard: A16 and A05 obey it at any address of their own.
     *
     * The response puts the address of the unit into `head[0]` of the message.
     */
    FATHOM_MODBUS_ANY_UNIT = 255,

    FATHOM_MODBUS_MAX_READ = 125,  /**< Greatest number of registers in one read. */
    FATHOM_MODBUS_MAX_WRITE = 123, /**< Greatest number of registers in one write. */
    FATHOM_MODBUS_MAX_FRAME = 255  /**< Longest frame in bytes. */
};

/** @brief Exception codes (MODBUS Application Protocol 7). A device may send others; the functions keep them all. */
enum {
    FATHOM_MODBUS_ILLEGAL_FUNCTION = 1,     /**< The unit does not know the function. */
    FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS = 2, /**< The unit does not have the register. */
    FATHOM_MODBUS_ILLEGAL_DATA_VALUE = 3,   /**< The count or the value is not allowed. */
    FATHOM_MODBUS_SERVER_DEVICE_FAILURE = 4 /**< The unit failed to execute the request. */
};

/** @brief A request and the response to it, in the caller's memory. */
typedef struct {
    /**
     * @brief The registers. A read writes them on success. Function 10 sends them. Function 06 does not use them.
     *
     * Must stay valid until the response is parsed.
     */
    uint16_t *values;

    /**
     * @brief The first six bytes of the request as they are on the wire.
     *
     * They are the unit, the function, the register (high, low), and the count or value (high, low). Invariant: written
     * by the three functions below, and `head[0]` also by the response to FATHOM_MODBUS_ANY_UNIT.
     */
    uint8_t head[6];

    /** @brief The exception code, after FATHOM_ERR_EXCEPTION. 0: there was none. */
    uint8_t exception;

    /**
     * @brief True if this read changes something in the unit. The line then sends it only after a silence.
     *
     * fathom_modbus_read_holding_registers() sets it to false. Set it after that call.
     */
    bool has_effect;
} fathom_modbus_message_t;

/**
 * @brief Fills in a read of holding registers (function 03).
 *
 * The function checks no argument. If `count` is outside its range, fathom_modbus_rtu_frame_size() returns 0, and
 * fathom_modbus_client_submit() returns FATHOM_ERR_ARGUMENT.
 *
 * @param message  The message.
 * @param address  Address of the unit, 0 to 255.
 * @param first    Address of the first register, 0 to 65535.
 * @param count    Number of registers, 1 to 125.
 * @param values   `count` registers, written on success only. Must stay valid until the response is parsed.
 */
void fathom_modbus_read_holding_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                          uint8_t count, uint16_t *values);

/**
 * @brief Fills in a write of one register (function 06).
 *
 * @param message  The message.
 * @param address  Address of the unit, 0 to 255. 0 is a broadcast.
 * @param first    Address of the register, 0 to 65535.
 * @param value    The value, 0 to 65535.
 */
void fathom_modbus_write_single_register(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                         uint16_t value);

/**
 * @brief Fills in a write of several registers (function 10). Checks no argument, as
 * fathom_modbus_read_holding_registers().
 *
 * @param message  The message.
 * @param address  Address of the unit, 0 to 255. 0 is a broadcast.
 * @param first    Address of the first register, 0 to 65535.
 * @param count    Number of registers, 1 to 123.
 * @param values   `count` registers. Must stay valid until the response is parsed.
 */
void fathom_modbus_write_multiple_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                            uint8_t count, const uint16_t *values);

/* ---- Client ---- */

/**
 * @brief Returns the length of the longer of request and response in bytes, 8 to 255.
 *
 * @retval 0  The count of the message is outside its range.
 */
uint8_t fathom_modbus_rtu_frame_size(const fathom_modbus_message_t *message);

/**
 * @brief Encodes the request with its CRC.
 *
 * @param message  The message. fathom_modbus_rtu_frame_size() is not 0.
 * @param frame    Memory for at least fathom_modbus_rtu_frame_size() bytes.
 * @return Length of the request in bytes, 8 to 255.
 */
uint8_t fathom_modbus_rtu_encode_request(const fathom_modbus_message_t *message, uint8_t *frame);

/**
 * @brief Returns the length in bytes of the response that begins with the given bytes.
 *
 * The function does not check the address of the unit.
 *
 * @param bytes  The received bytes.
 * @param have   Number of received bytes, at least 1.
 * @retval 0  No response begins here. Discard the first byte and call again.
 * @return More than `have`: call again when this number of bytes has arrived (3 until the length is known). At most
 *         `have`: the response is complete, and its CRC must be checked.
 */
uint8_t fathom_modbus_rtu_response_length(const uint8_t *bytes, uint8_t have);

/**
 * @brief Returns true if the bytes are the beginning of the request, as an adapter with echo returns it.
 *
 * The function compares the first six bytes. If the whole request has arrived, check the CRC for the other bytes.
 *
 * @param message  The message.
 * @param bytes    The received bytes.
 * @param have     Number of received bytes, at least 1.
 */
bool fathom_modbus_rtu_is_request(const fathom_modbus_message_t *message, const uint8_t *bytes, uint8_t have);

/**
 * @brief Parses a complete response whose CRC is right (fathom_crc16() is 0).
 *
 * @param message  The message. A read writes its values with FATHOM_OK only.
 * @param frame    The response.
 * @retval FATHOM_OK             The frame is the response.
 * @retval FATHOM_ERR_EXCEPTION  The unit refused the request. `exception` is written.
 * @retval FATHOM_ERR_MALFORMED  The unit of the request sent the frame, but with another function, count, register or
 *                               value. Nothing is written.
 * @retval FATHOM_PENDING        Another unit sent the frame. Nothing is written.
 */
fathom_status_t fathom_modbus_rtu_parse_response(fathom_modbus_message_t *message, const uint8_t *frame);

/* ---- Server ---- */

/**
 * @brief Returns the length in bytes of the request that begins with the given bytes.
 *
 * @param bytes  The received bytes.
 * @param have   Number of received bytes, at least 1.
 * @return As fathom_modbus_rtu_response_length().
 */
uint8_t fathom_modbus_rtu_request_length(const uint8_t *bytes, uint8_t have);

/**
 * @brief Parses a complete request whose CRC is right.
 *
 * @param message   The message. Set `values` before the call: `capacity` registers, or NULL if `capacity` is 0.
 *                  Function 10 writes them.
 * @param frame     The request.
 * @param capacity  Number of registers in `values`, 0 to 255.
 * @retval FATHOM_OK             `head` has the unit, the function, the register, and the count or value. Execute the
 *                               request, then call fathom_modbus_rtu_encode_response().
 * @retval FATHOM_ERR_EXCEPTION  The request cannot be executed. `exception` is 1 for another function, and 3 for a
 *                               count that is outside its range or above `capacity`. Call
 *                               fathom_modbus_rtu_encode_response().
 */
fathom_status_t fathom_modbus_rtu_parse_request(fathom_modbus_message_t *message, const uint8_t *frame,
                                                uint8_t capacity);

/**
 * @brief Encodes the response to a request, with its CRC.
 *
 * If `exception` is not 0, the frame is the exception response. Otherwise the frame has the registers of a read, or the
 * acknowledgement of a write.
 *
 * @param message  The message.
 * @param frame    Memory for 5 + 2 * count bytes for a read, and for at least 8 bytes.
 * @return Length of the response in bytes, 5 to 255.
 */
uint8_t fathom_modbus_rtu_encode_response(const fathom_modbus_message_t *message, uint8_t *frame);

#ifdef __cplusplus
}
#endif

#endif
