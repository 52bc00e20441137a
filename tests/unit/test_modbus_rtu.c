/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/modbus_rtu.h"

/* CRCs that no datasheet prints were worked out apart, bit by bit, and stand here as bytes. Every prefix and
 * every damaged byte of the datasheets' frames: tests/unit/test_corruption.c. */

enum { READ = 0x03, WRITE = 0x06, WRITE_MANY = 0x10, GUARD = 0xA5, CAPACITY = 300, VALUES = 130 };
enum { GUARD16 = 0xA5A5 };
#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static fathom_modbus_message_t message;
static uint8_t frame[CAPACITY];
static uint16_t values[VALUES];

static int set_up(void **state)
{
    memset(&message, GUARD, sizeof message);
    memset(frame, GUARD, sizeof frame);
    memset(values, GUARD, sizeof values);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void expect_encoded_request(const uint8_t *expected, uint8_t length)
{
    assert_int_equal(fathom_modbus_rtu_encode_request(&message, frame), length);
    assert_memory_equal(frame, expected, length);
}

static void expect_encoded_response(const uint8_t *expected, uint8_t length)
{
    assert_int_equal(fathom_modbus_rtu_encode_response(&message, frame), length);
    assert_memory_equal(frame, expected, length);
}

static void assert_untouched_from(const uint8_t *bytes, size_t from, size_t size)
{
    for (size_t i = from; i != size; i++) assert_int_equal(bytes[i], GUARD);
}

static void assert_values_untouched_from(size_t from)
{
    for (; from != VALUES; from++) assert_int_equal(values[from], GUARD16);
}

#define expect_room(n) assert_int_equal(fathom_modbus_rtu_frame_size(&message), n)
#define expect_response(bytes, status)                                                                       \
    assert_int_equal(fathom_modbus_rtu_parse_response(&message, bytes), status)
#define expect_request(bytes, most, status)                                                                  \
    assert_int_equal(fathom_modbus_rtu_parse_request(&message, bytes, most), status)

static void ask(uint8_t function, uint8_t count)
{
    if (function == READ)
        fathom_modbus_read_holding_registers(&message, 1, 0x0020, count, values);
    else
        fathom_modbus_write_multiple_registers(&message, 1, 0x0020, count, values);
}

/* ---- the client's side ---- */

/* 8 bytes, and where it is longer: a read's response is 5 + 2 n (6.3), a write's request 9 + 2 n (6.12). modbus_rtu.h:
 * "what is outside is refused when it is submitted or encoded (..., length 0)". */
TEST(the_room_of_every_count)
{
    for (unsigned n = 0; n != 256; n++) {
        ask(READ, (uint8_t)n);
        expect_room(n == 0 || n > 125 ? 0 : n == 1 ? 8 : 5 + 2 * n);
        ask(WRITE_MANY, (uint8_t)n);
        expect_room(n == 0 || n > 123 ? 0 : 9 + 2 * n);
        fathom_modbus_write_single_register(&message, 1, 0x0020, (uint16_t)n);
        expect_room(8);
    }
}

static const uint8_t three_values[] = {0x01, 0x03, 0x06, 0x00, 0x00, 0x80, 0x00, 0xFF, 0xFF, 0x09, 0x05};
static const uint8_t write_three[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x03, 0x06, 0x00,
                                      0x00, 0x80, 0x00, 0xFF, 0xFF, 0xCF, 0x9A};

TEST(a_response_brings_0000_8000_and_FFFF)
{
    ask(READ, 3);
    expect_response(three_values, FATHOM_OK);
    assert_int_equal(values[0], 0x0000);
    assert_int_equal(values[1], 0x8000);
    assert_int_equal(values[2], 0xFFFF);
    assert_values_untouched_from(3);
    assert_int_equal(message.exception, 0);
    expect_encoded_response(three_values, sizeof three_values);
}

TEST(a_write_of_many_carries_0000_8000_and_FFFF)
{
    static const uint16_t written[] = {0x0000, 0x8000, 0xFFFF};
    static const uint8_t response[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x03, 0x00, 0x00};
    fathom_modbus_write_multiple_registers(&message, 1, 0x0020, 3, written);
    expect_encoded_request(write_three, sizeof write_three);
    expect_response(response, FATHOM_OK);
    expect_request(write_three, 2, FATHOM_ERR_EXCEPTION);
    message.values = values;
    expect_request(write_three, 3, FATHOM_OK);
    assert_memory_equal(values, written, sizeof written);
    assert_values_untouched_from(3);
}

/* Value i is 256 i + 255 - i, so that every byte of the frames is known. */
static uint16_t pattern(unsigned i) { return (uint16_t)(256 * i + 255 - i); }

static void set_pattern(unsigned count)
{
    for (unsigned i = 0; i != count; i++) values[i] = pattern(i);
}

/* And behind them the CRC, with which the frame ends; after that values is as before the test. */
static void assert_pattern(const uint8_t *bytes, unsigned count, uint8_t crc_low, uint8_t crc_high)
{
    for (unsigned i = 0; i != count; i++, bytes += 2) {
        assert_int_equal(bytes[0], i);
        assert_int_equal(bytes[1], 255 - i);
    }
    assert_int_equal(bytes[0], crc_low);
    assert_int_equal(bytes[1], crc_high);
    assert_untouched_from(frame, (size_t)(bytes + 2 - frame), CAPACITY);
    memset(values, GUARD, sizeof values);
}

static void assert_values(unsigned count)
{
    for (unsigned i = 0; i != count; i++) assert_int_equal(values[i], pattern(i));
    assert_values_untouched_from(count);
}

TEST(the_largest_response_is_255_bytes_and_fits)
{
    static const uint8_t head[] = {0x01, 0x03, 250};
    ask(READ, 125);
    set_pattern(125);
    assert_int_equal(fathom_modbus_rtu_encode_response(&message, frame), 255);
    assert_memory_equal(frame, head, sizeof head);
    assert_pattern(frame + 3, 125, 0xEB, 0x7C);
    assert_int_equal(fathom_modbus_rtu_response_length(frame, 255), 255);
    expect_response(frame, FATHOM_OK);
    assert_values(125);
}

TEST(the_largest_request_is_255_bytes_and_fits)
{
    static const uint8_t head[] = {0x01, 0x10, 0x00, 0x20, 0x00, 123, 246};
    ask(WRITE_MANY, 123);
    set_pattern(123);
    assert_int_equal(fathom_modbus_rtu_encode_request(&message, frame), 255);
    assert_memory_equal(frame, head, sizeof head);
    assert_pattern(frame + 7, 123, 0x25, 0x87);
    assert_int_equal(fathom_modbus_rtu_request_length(frame, 255), 255);
    expect_request(frame, 123, FATHOM_OK);
    assert_values(123);
}

/* Every first three bytes. A byte count of 0 is a whole frame that answers nothing. */
TEST(the_length_of_a_response_for_every_function_and_third_byte)
{
    for (unsigned function = 0; function != 256; function++) {
        for (unsigned third = 0; third != 256; third++) {
            const uint8_t bytes[] = {0x20, (uint8_t)function, (uint8_t)third};
            unsigned expected = 0;
            if (function == 0x03 && third % 2 == 0 && third >= 2 && third <= 250) expected = third + 5;
            if (function == 0x06 || function == 0x10) expected = 8;
            if (function == 0x83 || function == 0x86 || function == 0x90) expected = 5;
            assert_int_equal(fathom_modbus_rtu_response_length(bytes, 3), expected);
        }
    }
}

/* Responses with a right CRC that answer something else. */
typedef struct {
    uint8_t function;
    fathom_status_t status;
    uint8_t bytes[15];
} other_t;

/* Asked: unit 1 to read 3 from 0020, to write 0003 to 0020, to write 3 from 0020. */
static const other_t others[] = {
    {READ, FATHOM_PENDING, {0x02, 0x03, 0x06, 0, 1, 0, 2, 0, 3}},
    {READ, FATHOM_PENDING, {0x81, 0x03, 0x06, 0, 1, 0, 2, 0, 3}},
    {READ, FATHOM_PENDING, {0x02, 0x83, 0x02}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x00, 0x20, 0x00, 0x03}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x00, 0x20, 0x00, 0x03}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x86, 0x02}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x90, 0x02}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x03, 0x00}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x03, 0x04, 0, 1, 0, 2}},
    {READ, FATHOM_ERR_MALFORMED, {0x01, 0x03, 0x08, 0, 1, 0, 2, 0, 3, 0, 4}},
    {WRITE, FATHOM_PENDING, {0x02, 0x06, 0x00, 0x20, 0x00, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x00, 0x20, 0x00, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x03, 0x02, 0x20, 0x00, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x83, 0x02}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x01, 0x20, 0x00, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x00, 0x21, 0x00, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x00, 0x20, 0x01, 0x03}},
    {WRITE, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x00, 0x20, 0x00, 0x04}},
    {WRITE_MANY, FATHOM_PENDING, {0x02, 0x10, 0x00, 0x20, 0x00, 0x03}},
    {WRITE_MANY, FATHOM_PENDING, {0x02, 0x90, 0x03}},
    {WRITE_MANY, FATHOM_ERR_MALFORMED, {0x01, 0x06, 0x00, 0x20, 0x00, 0x03}},
    {WRITE_MANY, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x80, 0x20, 0x00, 0x03}},
    {WRITE_MANY, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x00, 0x10, 0x00, 0x03}},
    {WRITE_MANY, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x00, 0x20, 0x00, 0x02}},
    {WRITE_MANY, FATHOM_ERR_MALFORMED, {0x01, 0x10, 0x00, 0x20, 0x80, 0x03}},
};

TEST(a_response_to_something_else_writes_nothing)
{
    for (unsigned i = 0; i != COUNT_OF(others); i++) {
        set_up(NULL);
        ask(others[i].function, 3);
        if (others[i].function == WRITE) fathom_modbus_write_single_register(&message, 1, 0x0020, 3);
        fathom_modbus_message_t before;
        memcpy(&before, &message, sizeof before);
        expect_response(others[i].bytes, others[i].status);
        assert_memory_equal(&message, &before, sizeof before);
        assert_values_untouched_from(0);
    }
}

/* ---- the server's side ---- */

TEST(the_length_of_a_request_for_every_function_and_byte_count)
{
    for (unsigned function = 0; function != 256; function++) {
        for (unsigned size = 0; size != 256; size++) {
            const uint8_t bytes[] = {0x01, (uint8_t)function, 0, 0, 0, 0, (uint8_t)size};
            unsigned expected = function < 0x80 ? 8 : 0;
            if (function == 0x10) expected = size <= 246 ? size + 9 : 0;
            assert_int_equal(fathom_modbus_rtu_request_length(bytes, 7), expected);
        }
    }
}

typedef struct {
    uint8_t capacity;
    uint8_t exception;
    uint8_t request[15];
    uint8_t response[5];
} refused_t;

static const refused_t refusals[] = {
    /* another function */
    {125, 1, {0x01, 0x01, 0x00, 0x20, 0x00, 0x03}, {0x01, 0x81, 0x01, 0x81, 0x90}},
    {125, 1, {0x01, 0x02, 0x00, 0x20, 0x00, 0x03}, {0x01, 0x82, 0x01, 0x81, 0x60}},
    {125, 1, {0x01, 0x7F, 0x00, 0x20, 0x00, 0x03}, {0x01, 0xFF, 0x01, 0xA0, 0x30}},
    /* a count of 0, of 126, of 256 + 1, beyond the capacity, without any */
    {125, 3, {0x01, 0x03, 0x00, 0x20, 0x00, 0}, {0x01, 0x83, 0x03, 0x01, 0x31}},
    {255, 3, {0x01, 0x03, 0x00, 0x20, 0x00, 126}, {0x01, 0x83, 0x03, 0x01, 0x31}},
    {255, 3, {0x01, 0x03, 0x00, 0x20, 0x01, 1}, {0x01, 0x83, 0x03, 0x01, 0x31}},
    {4, 3, {0x01, 0x03, 0x00, 0x20, 0x00, 5}, {0x01, 0x83, 0x03, 0x01, 0x31}},
    {0, 3, {0x01, 0x03, 0x00, 0x20, 0x00, 1}, {0x01, 0x83, 0x03, 0x01, 0x31}},
    {125, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 0, 0}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    {255, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 124, 248}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    {255, 3, {0x01, 0x10, 0x00, 0x20, 0x01, 2, 4}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    {2, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 3, 6}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    /* a byte count that is not twice the count */
    {125, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 3, 5}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    {125, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 3, 4}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
    {125, 3, {0x01, 0x10, 0x00, 0x20, 0x00, 3, 8}, {0x01, 0x90, 0x03, 0x0C, 0x01}},
};

TEST(a_request_that_cannot_be_served_is_refused_by_its_number)
{
    for (unsigned i = 0; i != COUNT_OF(refusals); i++) {
        const refused_t *const refused = &refusals[i];
        message.values = values;
        expect_request(refused->request, refused->capacity, FATHOM_ERR_EXCEPTION);
        assert_int_equal(message.exception, refused->exception);
        assert_values_untouched_from(0);
        expect_encoded_response(refused->response, 5);
    }
}

TEST(a_request_as_long_as_the_capacity_is_served)
{
    static const uint8_t read_five[] = {0x01, 0x03, 0x00, 0x20, 0x00, 5};
    static const uint8_t write_one[] = {0x01, 0x06, 0x00, 0x20, 0xFF, 0xFF};
    message.values = values;
    expect_request(read_five, 5, FATHOM_OK);
    assert_int_equal(message.exception, 0);
    expect_request(write_one, 0, FATHOM_OK);
    assert_int_equal(message.exception, 0);
    assert_int_equal(values[0], GUARD16);
}

/* modbus_rtu.h: the frame holds 8 bytes at least, for a refused read of 0 registers too. */
TEST(the_refusal_of_a_read_of_0_registers_fits_in_8_bytes)
{
    static const uint8_t request[] = {0x01, 0x03, 0x00, 0x20, 0x00, 0};
    expect_request(request, 4, FATHOM_ERR_EXCEPTION);
    assert_int_equal(fathom_modbus_rtu_encode_response(&message, frame), 5);
    assert_untouched_from(frame, 8, CAPACITY);
}
