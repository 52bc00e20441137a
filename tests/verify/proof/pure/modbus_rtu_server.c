/* SPDX-License-Identifier: MIT */
/*
 * The server's side: every beginning of a request, every request whose length is what request_length() says, and the
 * response to each message that parse_request() lets pass, into a frame of just the size that the header asks for.
 *
 * proves: src/codec/modbus_rtu.c
 * options: -eva-auto-loop-unroll 9 -eva-plevel 300 -eva-slevel-function put_values:0,get_values:0 -inline-calls put16,get16
 * unreached: fathom_modbus_read_holding_registers fathom_modbus_write_single_register set
 *            fathom_modbus_write_multiple_registers fathom_modbus_rtu_encode_request is_alike
 *            fathom_modbus_rtu_response_length fathom_modbus_rtu_is_request fathom_modbus_rtu_parse_response
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

static void beginning(uint8_t have, uint8_t claimed)
{
    (void)fathom_modbus_rtu_request_length(any_frame(have), claimed);
}

/* A write of so many values that says it has from `least` to `most`; they are taken where that is so, and fit. */
static void write_many(uint8_t count, uint8_t least, uint8_t most, uint8_t capacity, uint16_t *space)
{
    fathom_modbus_message_t message;
    uint8_t *const frame = any_frame((uint8_t)(2 * count + 9));
    frame[1] = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
    frame[5] = any_8_in(least, most);
    frame[6] = (uint8_t)(2 * count);
    const uint8_t claimed = fathom_modbus_rtu_request_length(frame, (uint8_t)(2 * count + 9));
    /*@ assert claimed == 2 * count + 9; */
    message.values = space;
    (void)fathom_modbus_rtu_parse_request(&message, frame, capacity);
}

static void writes_many(uint8_t count)
{
    write_many(count, count, count, any_8_in(count, UINT8_MAX), values + COUNT - count);
    if (count != 0) write_many(count, count, count, any_8_in(0, (uint8_t)(count - 1)), NULL);
    if (count != 0) write_many(count, 0, (uint8_t)(count - 1), any_8(), NULL);
    write_many(count, (uint8_t)(count + 1), UINT8_MAX, any_8(), NULL);
}

/* Half a value too many: nothing is taken. */
static void write_odd(void)
{
    fathom_modbus_message_t message;
    uint8_t *const frame = any_frame(10);
    frame[1] = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
    frame[6] = (uint8_t)(2 * any_8_in(0, FATHOM_MODBUS_MAX_WRITE) + 1);
    message.values = NULL;
    (void)fathom_modbus_rtu_parse_request(&message, frame, any_8());
}

/* A read, a write of one, or a function that is not known. */
static void other(uint8_t function)
{
    fathom_modbus_message_t message;
    uint8_t *const frame = any_frame(8);
    frame[1] = function;
    message.values = NULL;
    (void)fathom_modbus_rtu_parse_request(&message, frame, any_8());
}

static void encode(uint8_t function, uint8_t count, uint8_t exception, uint8_t size)
{
    fathom_modbus_message_t message;
    any_bytes(message.head, sizeof message.head);
    message.head[1] = function;
    message.head[5] = count;
    message.values = values + COUNT - count;
    message.exception = exception;
    const uint8_t length = fathom_modbus_rtu_encode_response(&message, any_frame(size));
    /*@ assert 5 <= length <= size; */
}

int main(void)
{
    enum { WRITE_MANY = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS };
    any_memory(values, sizeof values);
    for (uint8_t have = 1; have != 9; have++) beginning(have, have);
    beginning(9, any_8_in(9, UINT8_MAX));
    /*@ loop unroll 124; */
    for (uint8_t count = 0; count <= FATHOM_MODBUS_MAX_WRITE; count++) writes_many(count);
    write_odd();
    other(any_8_in(0, WRITE_MANY - 1));
    other(any_8_in(WRITE_MANY + 1, UINT8_MAX));
    encode(any_8(), 1, any_8_in(1, UINT8_MAX), 8);
    encode(FATHOM_MODBUS_WRITE_SINGLE_REGISTER, 0, 0, 8);
    encode(WRITE_MANY, 0, 0, 8);
    encode(FATHOM_MODBUS_READ_HOLDING_REGISTERS, 1, 0, 8);
    /*@ loop unroll 124; */
    for (uint8_t count = 2; count <= COUNT; count++)
        encode(FATHOM_MODBUS_READ_HOLDING_REGISTERS, count, 0, (uint8_t)(5 + 2 * count));
    return 0;
}
