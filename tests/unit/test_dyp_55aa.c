/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#include "fathom/codec/dyp_55aa.h"

enum { GUARD = 0xA5, GUARD16 = 0xA5A5, BYTES = 256, MOST = FATHOM_DYP_MAX_RESPONSE };

/* A05 2(3)2: 01 all probes, 10 to 13 one probe, 03 the address; anything else is no command. */
static uint8_t length_by_the_datasheet(unsigned command)
{
    if (command == 0x01) return 13;
    if (command == 0x03) return 5;
    return command >= 0x10 && command <= 0x13 ? 7 : 0;
}

/* A05 2(3)3 with the right sum, 2(3)5. The datasheet's frames both ways: tests/unit/test_frames.c. */
static const uint8_t all_probes[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07,
                                     0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
static const uint8_t address_5[] = {0x55, 0xAA, 0x05, 0x03, 0x07};

/* ---- commands ---- */

TEST(every_command_has_the_length_and_the_values_of_the_datasheet)
{
    unsigned known = 0;
    for (unsigned command = 0; command != BYTES; command++) {
        const uint8_t length = length_by_the_datasheet(command);
        const uint8_t values = length == 13 ? 4 : length == 7 ? 1 : 0;
        assert_int_equal(fathom_dyp_55aa_response_length((uint8_t)command), length);
        assert_int_equal(fathom_dyp_55aa_value_count((uint8_t)command), values);
        known += length != 0;
    }
    assert_int_equal(known, 6);
}

/* 55 + AA = FF, so the sum is address + command - 1. */
TEST(every_request_is_55_AA_address_command_and_the_sum)
{
    unsigned tried = 0;
    for (unsigned address = 0; address != BYTES; address++) {
        for (unsigned command = 0; command != BYTES; command++, tried++) {
            const uint8_t expected[] = {
                0x55, 0xAA, (uint8_t)address, (uint8_t)command, (uint8_t)(address + command - 1), GUARD};
            uint8_t frame[sizeof expected];
            memset(frame, GUARD, sizeof frame);
            assert_int_equal(fathom_dyp_55aa_encode_request(frame, (uint8_t)address, (uint8_t)command), 5);
            assert_memory_equal(frame, expected, sizeof expected);
        }
    }
    assert_int_equal(tried, 65536);
}

/* ---- how long a response is ---- */

/* The buffer is as large as what came, so that the address sanitizer sees a look beyond it; and with every byte
 * behind it the result is the same. */
static uint8_t length_of(const uint8_t *bytes, uint8_t have)
{
    uint8_t *const alone = malloc(have);
    uint8_t behind[MOST + 1];
    assert_non_null(alone);
    memcpy(alone, bytes, have);
    const uint8_t length = fathom_dyp_55aa_frame_length(alone, have);
    free(alone);
    for (unsigned filling = 0; filling != BYTES; filling++) {
        memset(behind, (int)filling, sizeof behind);
        memcpy(behind, bytes, have);
        assert_int_equal(fathom_dyp_55aa_frame_length(behind, have), length);
    }
    return length;
}

TEST(the_length_of_every_response_is_known_from_its_fourth_byte)
{
    unsigned tried = 0;
    for (unsigned command = 0; command != BYTES; command++) {
        uint8_t bytes[MOST];
        memset(bytes, 0, sizeof bytes);
        memcpy(bytes, address_5, 3);
        bytes[3] = (uint8_t)command;
        for (uint8_t have = 1; have <= MOST; have++, tried++)
            assert_int_equal(length_of(bytes, have), have < 4 ? 4 : length_by_the_datasheet(command));
    }
    assert_int_equal(tried, 256 * 13);
}

TEST(what_does_not_begin_with_55_AA_is_no_response_from_any_prefix)
{
    unsigned refused = 0;
    for (unsigned byte = 0; byte != BYTES; byte++) {
        uint8_t first[MOST];
        uint8_t second[MOST];
        memcpy(first, all_probes, MOST);
        memcpy(second, all_probes, MOST);
        first[0] = (uint8_t)byte;
        second[1] = (uint8_t)byte;
        for (uint8_t have = 1; have <= MOST; have++) {
            const uint8_t whole = have < 4 ? 4 : 13;
            assert_int_equal(length_of(first, have), byte == 0x55 ? whole : 0);
            assert_int_equal(length_of(second, have), byte == 0xAA || have == 1 ? whole : 0);
            refused += byte != 0x55;
            refused += byte != 0xAA && have != 1;
        }
    }
    assert_int_equal(refused, 255 * 13 + 255 * 12);
}

TEST(what_lies_behind_a_frame_does_not_count)
{
    uint8_t *const alone = malloc(sizeof address_5);
    assert_non_null(alone);
    memcpy(alone, address_5, sizeof address_5);
    assert_true(fathom_dyp_55aa_is_valid(alone, sizeof address_5));
    free(alone);
    for (unsigned filling = 0; filling != BYTES; filling++) {
        uint8_t frame[MOST];
        memset(frame, (int)filling, sizeof frame);
        memcpy(frame, address_5, sizeof address_5);
        assert_true(fathom_dyp_55aa_is_valid(frame, sizeof address_5));
    }
}
