/* SPDX-License-Identifier: MIT */
/*
 * The client's side: every request with a count that frame_size() admits, into a frame of just that size, from just so
 * many values; every beginning of a response; every response whose length is what response_length() says.
 *
 * proves: src/codec/modbus_rtu.c
 * options: -eva-auto-loop-unroll 9 -eva-plevel 300 -eva-slevel-function put_values:0,get_values:0 -inline-calls put16,get16
 * unreached: fathom_modbus_rtu_request_length fathom_modbus_rtu_parse_request fathom_modbus_rtu_encode_response
 */
#include "contracts.h"
#include "fathom/codec/modbus_rtu.h"

enum { SIZE = FATHOM_MODBUS_MAX_FRAME, COUNT = FATHOM_MODBUS_MAX_READ };

static uint8_t bytes[SIZE];
static uint16_t values[COUNT];

/* So many of them; before the first one there is other memory, behind the last one none. */
static uint8_t *any_frame(uint8_t size)
{
    any_memory(bytes, sizeof bytes);
    return bytes + SIZE - size;
}

static uint16_t *any_values(uint8_t count)
{
    any_memory(values, sizeof values);
    return values + COUNT - count;
}

static void encode(const fathom_modbus_message_t *message)
{
    const uint8_t size = fathom_modbus_rtu_frame_size(message);
    /*@ assert 8 <= size <= SIZE; */
    const uint8_t length = fathom_modbus_rtu_encode_request(message, any_frame(size));
    /*@ assert 8 <= length <= size; */
}

static void requests(void)
{
    fathom_modbus_message_t message;
    fathom_modbus_write_single_register(&message, any_8(), any_16(), any_16());
    encode(&message);
    /*@ loop unroll 125; */
    for (uint8_t count = 1; count <= FATHOM_MODBUS_MAX_READ; count++) {
        fathom_modbus_read_holding_registers(&message, any_8(), any_16(), count, NULL);
        encode(&message);
    }
    /*@ loop unroll 125; */
    for (uint8_t count = 1; count <= FATHOM_MODBUS_MAX_WRITE; count++) {
        fathom_modbus_write_multiple_registers(&message, any_8(), any_16(), count, any_values(count));
        encode(&message);
    }
    /* "0: the count is out of range" */
    fathom_modbus_read_holding_registers(&message, any_8(), any_16(), any_8_in(126, 255), NULL);
    uint8_t size = fathom_modbus_rtu_frame_size(&message);
    /*@ assert size == 0; */
    fathom_modbus_write_multiple_registers(&message, any_8(), any_16(), any_8_in(124, 255), NULL);
    size = fathom_modbus_rtu_frame_size(&message);
    /*@ assert size == 0; */
    fathom_modbus_read_holding_registers(&message, any_8(), any_16(), 0, NULL);
    size = fathom_modbus_rtu_frame_size(&message);
    /*@ assert size == 0; */
}

static void beginning(uint8_t have, uint8_t claimed)
{
    fathom_modbus_message_t message;
    const uint8_t *const frame = any_frame(have);
    fathom_modbus_read_holding_registers(&message, any_8(), any_16(), any_8(), NULL);
    (void)fathom_modbus_rtu_response_length(frame, claimed);
    (void)fathom_modbus_rtu_is_request(&message, frame, claimed);
}

/* A response of this length with this function, for any request; `count` of its registers. */
static void response(uint8_t length, uint8_t function, uint8_t count)
{
    fathom_modbus_message_t message;
    uint8_t *const frame = any_frame(length);
    frame[1] = function;
    if (count != 0) frame[2] = (uint8_t)(2 * count);
    const uint8_t claimed = fathom_modbus_rtu_response_length(frame, length);
    /*@ assert claimed == length; */
    fathom_modbus_write_single_register(&message, any_8(), any_16(), any_16());
    (void)fathom_modbus_rtu_parse_response(&message, frame);
    fathom_modbus_write_multiple_registers(&message, any_8(), any_16(), any_8_in(1, FATHOM_MODBUS_MAX_WRITE),
                                           NULL);
    (void)fathom_modbus_rtu_parse_response(&message, frame);
    /* Values are written where the count is that of the request alone. */
    if (count > 1) {
        fathom_modbus_read_holding_registers(&message, any_8(), any_16(), any_8_in(1, (uint8_t)(count - 1)),
                                             NULL);
        (void)fathom_modbus_rtu_parse_response(&message, frame);
    }
    if (count < COUNT) {
        fathom_modbus_read_holding_registers(&message, any_8(), any_16(),
                                             any_8_in((uint8_t)(count + 1), COUNT), NULL);
        (void)fathom_modbus_rtu_parse_response(&message, frame);
    }
    if (count != 0) {
        fathom_modbus_read_holding_registers(&message, any_8(), any_16(), count, any_values(count));
        (void)fathom_modbus_rtu_parse_response(&message, frame);
    }
}

int main(void)
{
    requests();
    for (uint8_t have = 1; have != 9; have++) beginning(have, have);
    beginning(9, any_8_in(9, UINT8_MAX));
    /*@ loop unroll 125; */
    for (uint8_t count = 1; count <= COUNT; count++)
        response((uint8_t)(2 * count + 5), FATHOM_MODBUS_READ_HOLDING_REGISTERS, count);
    response(8, FATHOM_MODBUS_WRITE_SINGLE_REGISTER, 0);
    response(8, FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS, 0);
    response(5, FATHOM_MODBUS_EXCEPTION | FATHOM_MODBUS_READ_HOLDING_REGISTERS, 0);
    response(5, FATHOM_MODBUS_EXCEPTION | FATHOM_MODBUS_WRITE_SINGLE_REGISTER, 0);
    response(5, FATHOM_MODBUS_EXCEPTION | FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS, 0);
    return 0;
}
