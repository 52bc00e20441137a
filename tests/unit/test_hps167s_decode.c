/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/hps167s_registers.h"

enum { GUARD = 0xA5 };

static fathom_sample_t sample;

/* Command #5: 08 23, DC B2, 07, 01, 00 00. */
static const uint16_t measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};

static void assert_guard(const void *object, size_t size)
{
    for (size_t i = 0; i != size; i++) assert_int_equal(((const uint8_t *)object)[i], GUARD);
}

/* The rule, stated apart: 80..30000 a distance, below that it is below its range, 65530..65534 nothing in range; else,
 * and these are figures of no abnormal packet, it cannot be. */
static int kind_of(uint32_t raw)
{
    if (raw == 65535) return 0;
    if (raw / 10 == 6553) return FATHOM_NO_TARGET; /* 65530..65534, 65535 is gone */
    if (raw == 0) return 0;
    if (raw < 80) return FATHOM_UNKNOWN;
    return raw <= 30000 ? FATHOM_TARGET : 0;
}

TEST(every_distance_is_what_the_rule_says)
{
    unsigned counted[7] = {0};
    for (uint32_t raw = 0; raw != 65536; raw++) {
        const uint16_t registers[4] = {(uint16_t)raw, 0xDCB2, 0x0742, 0x1234};
        const int kind = kind_of(raw);
        memset(&sample, GUARD, sizeof sample);
        counted[kind]++;
        assert_int_equal(fathom_hps167s_decode(registers, &sample),
                         kind == 0 ? FATHOM_ERR_MALFORMED : FATHOM_OK);
        if (kind == 0) {
            assert_guard(&sample, sizeof sample);
            continue;
        }
        assert_int_equal(sample.kind, kind);
        assert_int_equal(sample.raw, raw);
        assert_int_equal(sample.distance_mm, kind == FATHOM_TARGET ? raw : 0);
        assert_int_equal(sample.ambient, 0x42);
        assert_int_equal(sample.precision, 0x1234);
        assert_false(sample.interference);
        assert_int_equal(sample.magnitude, 7231744);
    }
    assert_int_equal(counted[FATHOM_TARGET], 29921);
    assert_int_equal(counted[FATHOM_UNKNOWN], 79);
    assert_int_equal(counted[FATHOM_NO_TARGET], 5);
}

TEST(decode_leaves_the_members_that_are_not_the_devices)
{
    memset(&sample, GUARD, sizeof sample);
    assert_int_equal(fathom_hps167s_decode(measured, &sample), FATHOM_OK);
    assert_int_equal(sample.time_us, 0xA5A5A5A5);
    assert_int_equal(sample.sequence, 0xA5A5);
    assert_int_equal(sample.model, GUARD);
    assert_int_equal(sample.address, GUARD);
    assert_int_equal(sample.probe, GUARD);
}

TEST(the_magnitude_is_exact_up_to_an_exponent_of_16_and_refused_beyond)
{
    for (unsigned exponent = 0; exponent != 256; exponent++) {
        const uint16_t registers[4] = {2083, 0xFFFF, (uint16_t)(exponent * 256), 0};
        const uint16_t over_range[4] = {65530, 0, (uint16_t)(exponent * 256), 0};
        const fathom_status_t expected = exponent <= 16 ? FATHOM_OK : FATHOM_ERR_MALFORMED;
        uint32_t magnitude = 65535;
        for (unsigned i = 0; i != exponent && i != 16; i++) magnitude *= 2;
        memset(&sample, GUARD, sizeof sample);
        assert_int_equal(fathom_hps167s_decode(registers, &sample), expected);
        if (exponent <= 16)
            assert_true(sample.magnitude == magnitude);
        else
            assert_guard(&sample, sizeof sample);
        assert_int_equal(fathom_hps167s_decode(over_range, &sample), expected);
    }
}
