/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_RTU_H
#define FATHOM_MODBUS_RTU_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Modbus RTU frames of the functions that range sensors use, in both directions. Pure functions: no time,
 * no I/O, no state. Source: MODBUS Application Protocol V1.1b3 (section 6.3, 6.6, 6.12, 7) and MODBUS over
 * Serial Line V1.02 (2.5.1).
 *
 * Limits: functions 0x03, 0x06 and 0x10; frames up to 255 bytes, which is all that these three can need
 * (125 registers read, 123 written).
 */
enum {
    FATHOM_MODBUS_READ_HOLDING_REGISTERS = 0x03,
    FATHOM_MODBUS_WRITE_SINGLE_REGISTER = 0x06,
    FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS = 0x10,
    FATHOM_MODBUS_EXCEPTION = 0x80 /* set in the function code of an exception response */
};

enum {
    /* A write to it is for all units, and none responds. A read is for the unit whose address is 0, which A16 and
     * A05 may have (A16 6(3), A05 3(3)). */
    FATHOM_MODBUS_BROADCAST = 0,
    /* Not the standard's: A16 and A05 obey it at any address of their own, which a response puts in message.head[0]. */
    FATHOM_MODBUS_ANY_UNIT = 255,
    FATHOM_MODBUS_MAX_READ = 125,
    FATHOM_MODBUS_MAX_WRITE = 123,
    FATHOM_MODBUS_MAX_FRAME = 255
};

/* The exception codes of section 7. A device may send others; all are kept as they came. */
enum {
    FATHOM_MODBUS_ILLEGAL_FUNCTION = 1,
    FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS = 2,
    FATHOM_MODBUS_ILLEGAL_DATA_VALUE = 3,
    FATHOM_MODBUS_SERVER_DEVICE_FAILURE = 4
};

/*
 * A request and the response to it. `head` is the request's beginning just as it goes over the wire, so that
 * encoding is a copy and a write is acknowledged by comparing; the functions below fill it in.
 */
typedef struct {
    uint16_t *values;  /* registers: a read fills them on success, a write of many sends them */
    uint8_t head[6];   /* unit, function, address (high, low), count or value (high, low) */
    uint8_t exception; /* the code, once FATHOM_ERR_EXCEPTION was returned */
    bool
        has_effect; /* true if this read changes something in the unit, so that it is sent only into a silence */
} fathom_modbus_message_t;

/*
 * Fill in a request. The caller owns `values` and keeps it until the response is there.
 * address: the unit's, 0..255. first: the first register's. count: 1..125 to read, 1..123 to write. Nothing is checked
 * here: fathom_modbus_rtu_frame_size() finds a count out of range, and to submit such a request is FATHOM_ERR_ARGUMENT.
 */
void fathom_modbus_read_holding_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                          uint8_t count, uint16_t *values);
void fathom_modbus_write_single_register(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                         uint16_t value);
void fathom_modbus_write_multiple_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                            uint8_t count, const uint16_t *values);

/* ---- the client's side ---- */

/* Bytes that the longer of request and response needs (8..255); 0: the count is out of range. */
uint8_t fathom_modbus_rtu_frame_size(const fathom_modbus_message_t *message);

/* Writes the request with its CRC to `frame` and returns its length. `frame` holds at least
 * fathom_modbus_rtu_frame_size() bytes, which must not be 0. */
uint8_t fathom_modbus_rtu_encode_request(const fathom_modbus_message_t *message, uint8_t *frame);

/*
 * The length of the response that begins with these `have` (>= 1) bytes, as far as they tell:
 *   0          no response begins like this: drop the first byte and look again. The caller checks the unit
 *   > have     so many bytes are needed to know more (3 until the length is known)
 *   <= have    the response is here, with its CRC still to be checked
 */
uint8_t fathom_modbus_rtu_response_length(const uint8_t *bytes, uint8_t have);

/* Do these `have` (>= 1) bytes begin like the request itself, as a line with local echo brings it back? The first six
 * are compared; where all of it has come, the CRC vouches for the rest. */
bool fathom_modbus_rtu_is_request(const fathom_modbus_message_t *message, const uint8_t *bytes, uint8_t have);

/*
 * Reads a whole response whose CRC the caller has found right (fathom_crc16() == 0).
 *   FATHOM_OK           it is the response to `message`; the values of a read are written
 *   FATHOM_ERR_EXCEPTION   it refuses `message`; message->exception is set
 *   FATHOM_ERR_MALFORMED   from the unit of the request, but no response to it: another function, count,
 *                          address or value. Nothing is written.
 *   FATHOM_PENDING         another unit's. Nothing is written.
 */
fathom_status_t fathom_modbus_rtu_parse_response(fathom_modbus_message_t *message, const uint8_t *frame);

/* ---- the server's side ---- */

/* As fathom_modbus_rtu_response_length, for requests. */
uint8_t fathom_modbus_rtu_request_length(const uint8_t *bytes, uint8_t have);

/*
 * Reads a whole request whose CRC is right. message->values must hold `capacity` registers (or be NULL with
 * capacity 0); a write of many fills them.
 *   FATHOM_OK           unit, function, address and count or value are in message->head
 *   FATHOM_ERR_EXCEPTION   well framed but not to be served: message->exception says why (1 for another
 *                          function, 3 for a count out of range or beyond `capacity`); encode_response
 *                          then gives the exception response
 */
fathom_status_t fathom_modbus_rtu_parse_request(fathom_modbus_message_t *message, const uint8_t *frame,
                                                uint8_t capacity);

/*
 * Writes the response to `message` with its CRC to `frame` and returns its length: the exception response
 * when message->exception is not 0, else the registers of a read or the acknowledgement of a write.
 * `frame` holds 5 + 2 * count bytes for a read, and 8 at least.
 */
uint8_t fathom_modbus_rtu_encode_response(const fathom_modbus_message_t *message, uint8_t *frame);

#ifdef __cplusplus
}
#endif

#endif
