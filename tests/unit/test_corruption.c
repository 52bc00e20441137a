/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "vectors.h"

/* What a wrong byte on the wire does to the Modbus frames of vectors.c; test_corruption_sums.c has the others. */

typedef uint8_t length_of_t(const uint8_t *, uint8_t);

/* What a receiver does with bytes that have ended: it asks for the length, and checks the CRC of a whole frame. */
static unsigned is_accepted(length_of_t *length_of, const uint8_t *bytes, uint8_t have)
{
    const uint8_t length = length_of(bytes, have);
    return length != 0 && length <= have && fathom_crc16(bytes, length) == 0;
}

/* How many of the receivers for whom the frame is meant take it. */
static unsigned accepted(const vector_t *row, const uint8_t *bytes, uint8_t have)
{
    unsigned n = 0;
    if ((row->direction & VECTOR_REQUEST) != 0)
        n += is_accepted(fathom_modbus_rtu_request_length, bytes, have);
    if ((row->direction & VECTOR_RESPONSE) != 0)
        n += is_accepted(fathom_modbus_rtu_response_length, bytes, have);
    return n;
}

enum { ALL_BYTES = 267 }; /* in the Modbus frames of the table */

/* Calls this with every frame that has one wrong byte, or only one wrong bit; returns how many there were. */
static uint32_t for_each_error(bool of_one_bit, void (*look)(const vector_t *row, const uint8_t *bytes))
{
    uint32_t tried = 0;
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const row = &modbus_vectors[i].frame;
        uint8_t bytes[VECTOR_BYTES];
        memcpy(bytes, row->bytes, sizeof bytes);
        for (unsigned at = 0; at != row->length; at++) {
            for (unsigned change = 1; change != 256; change += of_one_bit ? change : 1, tried++) {
                bytes[at] = (uint8_t)(row->bytes[at] ^ change);
                look(row, bytes);
            }
            bytes[at] = row->bytes[at];
        }
    }
    return tried;
}

static void refuse(const vector_t *row, const uint8_t *bytes)
{
    assert_int_equal(accepted(row, bytes, row->length), 0);
}

TEST(every_single_bit_error_in_a_modbus_frame_is_refused)
{
    assert_int_equal(for_each_error(true, refuse), 8 * ALL_BYTES);
}

TEST(every_single_byte_error_in_a_modbus_frame_is_refused)
{
    assert_int_equal(for_each_error(false, refuse), (uint32_t)255 * ALL_BYTES);
}

/* A CRC of 16 bits sees every burst of up to 16 bits, so any two bytes side by side as well. */
TEST(every_error_in_two_neighbouring_bytes_of_a_modbus_frame_is_refused)
{
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const row = &modbus_vectors[i].frame;
        uint8_t bytes[VECTOR_BYTES];
        for (unsigned at = 0; at + 1u != row->length; at++) {
            memcpy(bytes, row->bytes, sizeof bytes);
            for (uint32_t change = 1; change != 65536; change += 257) {
                bytes[at] = (uint8_t)(row->bytes[at] ^ change >> 8);
                bytes[at + 1] = (uint8_t)(row->bytes[at + 1] ^ (change & 0xFF));
                assert_int_not_equal(fathom_crc16(bytes, row->length), 0);
            }
        }
    }
}

TEST(a_modbus_frame_that_breaks_off_is_refused_wherever_it_does)
{
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const row = &modbus_vectors[i].frame;
        for (uint8_t have = 1; have != row->length; have++)
            assert_int_equal(accepted(row, row->bytes, have), 0);
    }
}

/* The buffer is just as large as what was received, so that the address sanitizer sees a look beyond it, and what
 * lies behind is different each time, so that its influence is seen without one. */
static uint8_t length_of_prefix(length_of_t *length_of, const uint8_t *bytes, uint8_t have)
{
    uint8_t *const alone = malloc(have);
    uint8_t behind[VECTOR_BYTES + 1];
    assert_non_null(alone);
    memcpy(alone, bytes, have);
    const uint8_t length = length_of(alone, have);
    free(alone);
    for (unsigned filling = 0; filling != 256; filling++) {
        memset(behind, (int)filling, sizeof behind);
        memcpy(behind, bytes, have);
        assert_int_equal(length_of(behind, have), length);
    }
    return length;
}

/* Of every beginning of a frame: below `least` bytes it is known that so many are needed, then the whole. */
static void assert_lengths(length_of_t *length_of, const uint8_t *bytes, uint8_t length, uint8_t least)
{
    for (uint8_t have = 1; have <= length; have++)
        assert_int_equal(length_of_prefix(length_of, bytes, have), have < least ? least : length);
}

TEST(the_length_of_a_response_is_known_from_its_third_byte)
{
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const row = &modbus_vectors[i].frame;
        if ((row->direction & VECTOR_RESPONSE) != 0)
            assert_lengths(fathom_modbus_rtu_response_length, row->bytes, row->length, 3);
    }
}

TEST(the_length_of_a_request_is_known_from_its_second_byte_or_its_byte_count)
{
    /* HPS-167S table 37 without its CRC, which it does not print: 36 ms, 2 registers, 4 bytes. */
    static const uint8_t write_many[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0x24};
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const row = &modbus_vectors[i].frame;
        if ((row->direction & VECTOR_REQUEST) != 0)
            assert_lengths(fathom_modbus_rtu_request_length, row->bytes, row->length, 2);
    }
    for (uint8_t have = 1; have <= sizeof write_many; have++) {
        const uint8_t length = length_of_prefix(fathom_modbus_rtu_request_length, write_many, have);
        assert_int_equal(length, have < 2 ? 2 : have < 7 ? 7 : 13);
    }
}
