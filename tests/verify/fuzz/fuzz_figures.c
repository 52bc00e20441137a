/* SPDX-License-Identifier: MIT */
#include "fathom/codec/crc16.h"
#include "fathom/codec/pulse_width.h"
#include "fuzz.h"

/* crc16.h, both sources of it, and pulse_width.h. crc16_small.c is linked under this name. */
uint16_t fathom_crc16_small(const uint8_t *bytes, uint8_t length);

static void check_crc(const uint8_t *bytes, uint8_t length)
{
    const uint16_t crc = fuzz_crc(bytes, length);
    PROMISE(fathom_crc16(bytes, length) == crc, "crc16.h: the polynomial's definition");
    PROMISE(fathom_crc16_small(bytes, length) == crc, "crc16.h: both sources say the same");
    uint8_t sealed[255];
    if (length > 253) return;
    if (length != 0) memcpy(sealed, bytes, length);
    fuzz_seal(sealed, length);
    PROMISE(fathom_crc16(sealed, (uint8_t)(length + 2)) == 0, "crc16.h: over a frame with its CRC it is 0");
}

static uint16_t no_more(uint64_t mm) { return (uint16_t)(mm < UINT16_MAX ? mm : UINT16_MAX); }

static void check_pulse(uint32_t width_us, int16_t air_dc)
{
    /* to the nearest: (4w + 11.5) / 23, and nothing is a half */
    const uint16_t mm = no_more(((uint64_t)width_us * 8 + 23) / 46);
    PROMISE(fathom_pulse_width_mm(width_us) == mm, "pulse_width.h: width_us * 4 / 23 to the nearest");
    /* There and back: w * (331.3 + 0.606 * dc / 10) / 2000 mm, in 1 / 20000000. */
    int32_t dc = air_dc < -400 ? -400 : air_dc;
    if (dc > 850) dc = 850;
    const uint64_t speed = (uint64_t)(3313000 + 606 * dc);
    const uint16_t in_air = no_more((width_us * speed + 10000000u) / 20000000u);
    PROMISE(fathom_pulse_width_mm_in_air(width_us, air_dc) == in_air,
            "pulse_width.h: 331.3 + 0.606 * degC m/s, to the nearest, a half up");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint32_t width_us = fuzz_long() >> (fuzz_byte() & 15);
    check_pulse(width_us, (int16_t)fuzz_word());
    size_t length;
    uint8_t *const bytes = fuzz_rest(255, &length);
    check_crc(bytes, (uint8_t)length);
    PROMISE(fathom_crc16(NULL, 0) == 0xFFFF, "crc16.h: NULL when length is 0 gives FFFF");
    free(bytes);
    return 0;
}
