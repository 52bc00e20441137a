/* SPDX-License-Identifier: MIT */
#include "fathom/codec/modbus_rtu.h"

#include <stdbool.h>

#include "fathom/codec/crc16.h"

/*
 * Modbus RTU frames of the functions 03, 06 and 10. Pure functions: the messages first, then the client, then
 * the server.
 */

/* Offsets in a frame. SIZE is the byte count in the response to a read. */
enum { UNIT = 0, FUNCTION = 1, FIRST = 2, SIZE = 2, COUNT_HIGH = 4, COUNT = 5, HEAD = 6, DATA = 7 };

enum {
    READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS,
    WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER,
    WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS,
    EXCEPTION = FATHOM_MODBUS_EXCEPTION
};

enum { FIXED_LENGTH = 8, EXCEPTION_LENGTH = 5, READ_OVERHEAD = 5, WRITE_MANY_OVERHEAD = 9 };

static uint8_t *put16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)(value >> 8);
    at[1] = (uint8_t)value;
    return &at[2];
}

static uint16_t get16(const uint8_t *at) { return (uint16_t)((at[0] * 256u) + at[1]); }

static uint8_t *put_values(uint8_t *at, const uint16_t *values, uint8_t count)
{
    for (; count != 0u; count--) {
        at = put16(at, *values);
        values++;
    }
    return at;
}

static void get_values(uint16_t *values, const uint8_t *at, uint8_t count)
{
    for (; count != 0u; count--) {
        *values = get16(at);
        values++;
        at += 2;
    }
}

static uint8_t *put_head(uint8_t *at, const fathom_modbus_message_t *message)
{
    const uint8_t *from = message->head;
    do {
        *at = *from;
        from++;
        at++;
    } while (from != &message->head[HEAD]);
    return at;
}

static uint8_t seal(uint8_t *frame, const uint8_t *end)
{
    const uint8_t length = (uint8_t)(end - frame);
    const uint16_t crc = fathom_crc16(frame, length);
    frame[length] = (uint8_t)crc;
    frame[length + 1u] = (uint8_t)(crc >> 8);
    return (uint8_t)(length + 2u);
}

static void set(fathom_modbus_message_t *message, uint8_t address, uint8_t function, uint16_t first,
                uint16_t last)
{
    message->head[UNIT] = address;
    message->head[FUNCTION] = function;
    (void)put16(&message->head[FIRST], first);
    (void)put16(&message->head[COUNT_HIGH], last);
    message->exception = 0;
}

void fathom_modbus_read_holding_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                          uint8_t count, uint16_t *values)
{
    set(message, address, READ, first, count);
    message->values = values;
    message->has_effect = false;
}

void fathom_modbus_write_single_register(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                         uint16_t value)
{
    set(message, address, WRITE, first, value);
}

void fathom_modbus_write_multiple_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                            uint8_t count, const uint16_t *values)
{
    set(message, address, WRITE_MANY, first, count);
    message->values = (uint16_t *)values; /* Function 10 only reads the values. */
}

/* ---- Client ---- */

uint8_t fathom_modbus_rtu_frame_size(const fathom_modbus_message_t *message)
{
    const uint8_t count = message->head[COUNT];
    uint8_t most = FATHOM_MODBUS_MAX_READ;
    uint8_t overhead = READ_OVERHEAD;
    if (message->head[FUNCTION] == WRITE) return FIXED_LENGTH;
    if (message->head[FUNCTION] == WRITE_MANY) {
        most = FATHOM_MODBUS_MAX_WRITE;
        overhead = WRITE_MANY_OVERHEAD;
    }
    if ((count == 0u) || (count > most)) return 0;
    const uint8_t frame_size = (uint8_t)((2u * count) + overhead);
    return (frame_size > FIXED_LENGTH) ? frame_size : FIXED_LENGTH;
}

uint8_t fathom_modbus_rtu_encode_request(const fathom_modbus_message_t *message, uint8_t *frame)
{
    uint8_t *at = put_head(frame, message);
    if (message->head[FUNCTION] == WRITE_MANY) {
        const uint8_t count = message->head[COUNT];
        *at = (uint8_t)(2u * count);
        at = put_values(&at[1], message->values, count);
    }
    return seal(frame, at);
}

static bool is_alike(const uint8_t *a, const uint8_t *b, uint8_t count)
{
    for (; count != 0u; count--) {
        if (*a != *b) return false;
        a++;
        b++;
    }
    return true;
}

uint8_t fathom_modbus_rtu_response_length(const uint8_t *bytes, uint8_t have)
{
    if (have <= SIZE) return SIZE + 1;
    const uint8_t function = bytes[FUNCTION] % EXCEPTION; /* Without the highest bit. */
    const uint8_t size = bytes[SIZE];
    uint8_t length = FIXED_LENGTH;
    if (function == READ) {
        const bool is_size = ((size & 1u) == 0u) && (size != 0u) && (size <= (2u * FATHOM_MODBUS_MAX_READ));
        length = is_size ? (uint8_t)(size + READ_OVERHEAD) : 0u;
    } else if ((function != WRITE) && (function != WRITE_MANY)) {
        return 0;
    }
    return (function == bytes[FUNCTION]) ? length : EXCEPTION_LENGTH;
}

bool fathom_modbus_rtu_is_request(const fathom_modbus_message_t *message, const uint8_t *bytes, uint8_t have)
{
    return is_alike(bytes, message->head, (have < HEAD) ? have : HEAD);
}

fathom_status_t fathom_modbus_rtu_parse_response(fathom_modbus_message_t *message, const uint8_t *frame)
{
    uint8_t *const head = message->head;
    const uint8_t function = head[FUNCTION];
    if ((frame[UNIT] != head[UNIT]) && (head[UNIT] != FATHOM_MODBUS_ANY_UNIT)) return FATHOM_PENDING;
    if (frame[FUNCTION] == (function | EXCEPTION)) {
        message->exception = frame[SIZE];
        return FATHOM_ERR_EXCEPTION;
    }
    if (frame[FUNCTION] != function) return FATHOM_ERR_MALFORMED;
    if (function != READ) {
        /* The acknowledgement of a write repeats the head of the request. */
        if (!is_alike(frame + FIRST, head + FIRST, HEAD - FIRST)) return FATHOM_ERR_MALFORMED;
    } else {
        const uint8_t count = head[COUNT];
        if (frame[SIZE] != (2u * count)) return FATHOM_ERR_MALFORMED;
        get_values(message->values, &frame[SIZE + 1], count);
    }
    head[UNIT] = frame[UNIT];
    return FATHOM_OK;
}

/* ---- Server ---- */

uint8_t fathom_modbus_rtu_request_length(const uint8_t *bytes, uint8_t have)
{
    if (have <= FUNCTION) return FUNCTION + 1;
    if (bytes[FUNCTION] != WRITE_MANY) return (bytes[FUNCTION] < EXCEPTION) ? FIXED_LENGTH : 0;
    if (have < DATA) return DATA;
    return (bytes[HEAD] > (2u * FATHOM_MODBUS_MAX_WRITE)) ? 0u : (uint8_t)(bytes[HEAD] + WRITE_MANY_OVERHEAD);
}

fathom_status_t fathom_modbus_rtu_parse_request(fathom_modbus_message_t *message, const uint8_t *frame,
                                                uint8_t capacity)
{
    for (uint8_t i = 0; i != HEAD; i++) message->head[i] = frame[i];
    message->exception = 0;
    const uint8_t function = frame[FUNCTION];
    const uint8_t count = frame[COUNT];
    if (function == WRITE) return FATHOM_OK;
    if ((function != READ) && (function != WRITE_MANY)) {
        message->exception = FATHOM_MODBUS_ILLEGAL_FUNCTION;
        return FATHOM_ERR_EXCEPTION;
    }
    if ((frame[COUNT_HIGH] != 0u) || (count > capacity) || (fathom_modbus_rtu_frame_size(message) == 0u) ||
        ((function == WRITE_MANY) && (frame[HEAD] != (2u * count)))) {
        message->exception = FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
        return FATHOM_ERR_EXCEPTION;
    }
    if (function == WRITE_MANY) get_values(message->values, frame + DATA, count);
    return FATHOM_OK;
}

uint8_t fathom_modbus_rtu_encode_response(const fathom_modbus_message_t *message, uint8_t *frame)
{
    uint8_t *at = put_head(frame, message);
    if (message->exception != 0u) {
        frame[FUNCTION] |= EXCEPTION;
        frame[SIZE] = message->exception;
        at = &frame[SIZE + 1];
    } else if (message->head[FUNCTION] == READ) {
        const uint8_t count = message->head[COUNT];
        frame[SIZE] = (uint8_t)(2u * count);
        at = put_values(&frame[SIZE + 1], message->values, count);
    }
    return seal(frame, at);
}
