/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/dyp_stream.h"

/* A05 1(3). The datasheets' frames both ways: tests/unit/test_frames.c. */
static const uint8_t a05_frame[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

/* A16 2(4): SUM = (FF + H + L) & FF, mm = H * 256 + L. */
TEST(every_value_of_an_A16_goes_both_ways)
{
    for (uint32_t mm = 0; mm != 65536; mm++) {
        const uint8_t expected[] = {0xFF, (uint8_t)(mm / 256), (uint8_t)(mm % 256),
                                    (uint8_t)((255 + mm / 256 + mm % 256) % 256)};
        const uint16_t value = (uint16_t)mm;
        uint16_t decoded = (uint16_t)~mm;
        uint8_t frame[4];
        assert_int_equal(fathom_dyp_stream_encode(frame, &value, 1), 4);
        assert_memory_equal(frame, expected, 4);
        assert_true(fathom_dyp_stream_is_valid(expected, 4));
        fathom_dyp_stream_decode(expected, &decoded, 1);
        assert_int_equal(decoded, mm);
    }
}

TEST(every_value_of_every_probe_of_an_A05_goes_both_ways)
{
    for (unsigned probe = 0; probe != 4; probe++) {
        for (uint32_t mm = 0; mm < 65536; mm += 7) {
            uint16_t values[4] = {0, 0, 0, 0};
            uint16_t decoded[4] = {1, 1, 1, 1};
            uint8_t expected[10] = {0xFF};
            uint8_t frame[10];
            values[probe] = (uint16_t)mm;
            expected[1 + 2 * probe] = (uint8_t)(mm / 256);
            expected[2 + 2 * probe] = (uint8_t)(mm % 256);
            expected[9] = (uint8_t)((255 + mm / 256 + mm % 256) % 256);
            assert_int_equal(fathom_dyp_stream_encode(frame, values, 4), 10);
            assert_memory_equal(frame, expected, 10);
            assert_true(fathom_dyp_stream_is_valid(expected, 10));
            fathom_dyp_stream_decode(expected, decoded, 4);
            assert_memory_equal(decoded, values, sizeof values);
        }
    }
}

/* 255 bytes of FF are 65025 = FE01; of n bytes of FF the sum is 256 - n. What lies behind does not count. */
TEST(the_sum_of_0_to_255_bytes_is_the_low_byte)
{
    uint8_t bytes[256];
    memset(bytes, 0xFF, sizeof bytes);
    assert_int_equal(fathom_dyp_checksum(bytes, 0), 0);
    for (unsigned n = 1; n != 256; n++) assert_int_equal(fathom_dyp_checksum(bytes, (uint8_t)n), 256 - n);
    assert_int_equal(fathom_dyp_checksum(bytes, 255), 0x01);
    assert_int_equal(fathom_dyp_checksum(a05_frame, 9), 0x60);
}
