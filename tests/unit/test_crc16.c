/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include "suite.h"

/* Both sources at once, each under a name of its own; the library's is linked beside them. */
uint16_t crc16_256(const uint8_t *bytes, uint8_t length);
uint16_t crc16_16(const uint8_t *bytes, uint8_t length);

#include "fathom/codec/crc16.h"

#define fathom_crc16 crc16_256
#define table        table_256
#include "../../src/codec/crc16.c"
#undef fathom_crc16
#undef table

#define fathom_crc16 crc16_16
#define table        table_16
#include "../../src/codec/crc16_small.c"
#undef fathom_crc16
#undef table

typedef uint16_t crc16_t(const uint8_t *, uint8_t);

/* So that a function can be a test's state. */
typedef struct {
    crc16_t *of;
} source_t;

static source_t table_of_256 = {crc16_256};
static source_t table_of_16 = {crc16_16};
static source_t linked = {fathom_crc16};

/* The definition (MODBUS over Serial Line V1.02, 6.2.2): for each of 8 bits, low bit first, shift right, and XOR
 * with A001 if a 1 fell out. */
static uint16_t one_byte_more(uint16_t state, uint8_t byte)
{
    state ^= byte;
    for (int bit = 0; bit != 8; bit++)
        state = (uint16_t)((state & 1) != 0 ? state >> 1 ^ 0xA001 : state >> 1);
    return state;
}

static uint16_t by_definition(const uint8_t *bytes, unsigned length)
{
    uint16_t state = 0xFFFF;
    for (unsigned i = 0; i != length; i++) state = one_byte_more(state, bytes[i]);
    return state;
}

/* Bytes without a pattern, always the same: x = 5 x + 17 modulo 251. */
static void fill(uint8_t *bytes, unsigned length)
{
    unsigned x = 3;
    for (unsigned i = 0; i != length; i++) {
        x = (5 * x + 17) % 251;
        bytes[i] = (uint8_t)(x ^ i);
    }
}

TEST(the_definition_gives_the_published_examples)
{
    /* MODBUS over Serial Line V1.02, 6.2.2: 02 07 gives 1241. The catalogues' check value: 4B37. A16 6(4) ex 1: 01 03
     * 01 00 00 01 is followed by 85 F6. HPS-167S appendix: AA BB CC gives 4523. */
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01};
    static const uint8_t data4[] = {0xAA, 0xBB, 0xCC};
    static const uint8_t message[] = {0x02, 0x07};
    static const uint8_t check[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    assert_int_equal(by_definition(message, 2), 0x1241);
    assert_int_equal(by_definition(check, 9), 0x4B37);
    assert_int_equal(by_definition(request, 6), 0xF685);
    assert_int_equal(by_definition(data4, 3), 0x4523);
}

static void every_length_to_255_does_what_the_definition_says(void **state)
{
    crc16_t *const crc16 = ((const source_t *)*state)->of;
    uint8_t bytes[255];
    fill(bytes, sizeof bytes);
    for (unsigned length = 0; length <= 255; length++)
        assert_int_equal(crc16(bytes, (uint8_t)length), by_definition(bytes, length));
}

static void no_byte_at_all_gives_FFFF(void **state)
{
    crc16_t *const crc16 = ((const source_t *)*state)->of;
    const uint8_t byte = 0;
    assert_int_equal(crc16(NULL, 0), 0xFFFF);
    assert_int_equal(crc16(&byte, 0), 0xFFFF);
}

static void over_a_frame_and_its_crc_low_byte_first_it_is_0(void **state)
{
    crc16_t *const crc16 = ((const source_t *)*state)->of;
    uint8_t frame[255];
    for (unsigned length = 0; length <= 253; length++) {
        fill(frame, length);
        const uint16_t crc = by_definition(frame, length);
        frame[length] = (uint8_t)(crc & 0xFF);
        frame[length + 1] = (uint8_t)(crc >> 8);
        assert_int_equal(crc16(frame, (uint8_t)(length + 2)), 0);
        if (frame[length] == frame[length + 1]) continue;
        frame[length] = (uint8_t)(crc >> 8);
        frame[length + 1] = (uint8_t)(crc & 0xFF);
        assert_int_not_equal(crc16(frame, (uint8_t)(length + 2)), 0);
    }
}

#define TEST_OF_BOTH(name)                                                                                   \
    TEST_ROW(name##_with_table_of_256, name, &table_of_256)                                                  \
    TEST_ROW(name##_with_table_of_16, name, &table_of_16)

TEST_OF_BOTH(every_length_to_255_does_what_the_definition_says)
TEST_OF_BOTH(no_byte_at_all_gives_FFFF)
TEST_OF_BOTH(over_a_frame_and_its_crc_low_byte_first_it_is_0)
TEST_ROW(every_length_to_255_does_what_the_definition_says_with_linked,
         every_length_to_255_does_what_the_definition_says, &linked)
