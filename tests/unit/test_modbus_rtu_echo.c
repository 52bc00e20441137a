/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/modbus_rtu.h"

/* Which bytes begin like the request itself? */

/* A16 6(4) examples 1 and 3; HPS-167S #15, table 37, with 36 ms; 123 registers have 255 bytes. */
static const uint8_t read_0100[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
static const uint8_t write_0200[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71};
static const uint8_t write_0020[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04,
                                     0x00, 0x00, 0x00, 0x24, 0xF1, 0xAC};

static uint16_t values[123];
static fathom_modbus_message_t message;

typedef struct {
    const uint8_t *bytes;
    uint8_t length;
} request_t;

static const request_t requests[] = {
    {read_0100, sizeof read_0100}, {write_0200, sizeof write_0200}, {write_0020, sizeof write_0020}};

static void fill(size_t which)
{
    values[0] = 0;
    values[1] = 36;
    if (which == 0) fathom_modbus_read_holding_registers(&message, 1, 0x0100, 1, values);
    if (which == 1) fathom_modbus_write_single_register(&message, 1, 0x0200, 5);
    if (which == 2) fathom_modbus_write_multiple_registers(&message, 1, 0x0020, 2, values);
}

TEST(every_beginning_of_a_request_has_its_length)
{
    for (size_t which = 0; which != 3; which++) {
        fill(which);
        for (uint8_t have = 1; have <= requests[which].length; have++)
            assert_int_equal(fathom_modbus_rtu_begun_request(&message, requests[which].bytes, have),
                             requests[which].length);
    }
}

TEST(more_bytes_behind_a_request_do_not_matter)
{
    uint8_t bytes[32];
    for (size_t which = 0; which != 3; which++) {
        fill(which);
        memset(bytes, 0xFF, sizeof bytes);
        memcpy(bytes, requests[which].bytes, requests[which].length);
        assert_int_equal(fathom_modbus_rtu_begun_request(&message, bytes, sizeof bytes),
                         requests[which].length);
    }
}

/* Of a write of many the byte count belongs to the beginning too; what follows is for the CRC to check. */
TEST(one_other_bit_in_the_beginning_makes_it_no_request)
{
    uint8_t bytes[13];
    for (size_t which = 0; which != 3; which++)
        for (unsigned bit = 0; bit != (which == 2 ? 56 : 48); bit++)
            for (uint8_t have = 1; have <= requests[which].length; have++) {
                fill(which);
                memcpy(bytes, requests[which].bytes, requests[which].length);
                bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
                assert_int_equal(fathom_modbus_rtu_begun_request(&message, bytes, have),
                                 have <= bit / 8 ? requests[which].length : 0);
            }
}

TEST(the_longest_write_has_255_bytes)
{
    uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
    fathom_modbus_write_multiple_registers(&message, 1, 0x0020, 123, values);
    assert_int_equal(fathom_modbus_rtu_encode_request(&message, frame), 255);
    assert_int_equal(frame[6], 246);
    for (unsigned have = 1; have != 256; have++)
        assert_int_equal(fathom_modbus_rtu_begun_request(&message, frame, (uint8_t)have), 255);
}

/* HPS-167S table 38: the acknowledgement of a write of many has the request's head and then its CRC. */
TEST(the_answer_to_a_write_of_many_is_not_its_request)
{
    static const uint8_t done[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02};
    fill(2);
    for (uint8_t have = 1; have <= 6; have++)
        assert_int_equal(fathom_modbus_rtu_begun_request(&message, done, have), 13);
    assert_int_equal(fathom_modbus_rtu_begun_request(&message, done, 7), 0);
    assert_int_equal(fathom_modbus_rtu_begun_request(&message, done, 8), 0);
}
