/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/dyp_stream.h"

/* A05 1(3). The datasheets' frames both ways: tests/unit/test_frames.c. */
static const uint8_t a05_frame[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

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
