/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#include "fathom/hps167s_info.h"

/* Every figure that an HPS-167S can send where two answers have one shape, and every temperature. */

static fathom_modbus_request_t *pending;

static fathom_status_t submit(void *ctx, fathom_modbus_request_t *request)
{
    (void)ctx;
    request->exchange.status = FATHOM_PENDING;
    request->exchange.attempts = 1;
    pending = request;
    return FATHOM_PENDING;
}

static fathom_status_t poll(void *ctx)
{
    (void)ctx;
    return FATHOM_PENDING;
}

static uint32_t clock_us;

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return clock_us;
}

static const fathom_modbus_t modbus = {.submit = submit, .poll = poll};
static const fathom_clock_t clock = {.now_us = now_us};
static fathom_hps167s_t hps;

static void start(uint8_t steps_per_degree)
{
    const fathom_hps167s_config_t config = {
        .modbus = &modbus, .clock = &clock, .steps_per_degree = steps_per_degree};
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
}

/* With the other bytes of the usual answer: warm-up 5 s, reconnect 180 ms. */
TEST(of_all_distances_only_255_mm_can_look_like_a_configuration)
{
    unsigned distances = 0;
    start(0);
    for (uint32_t raw = 0; raw != 65536; raw++) {
        bool may_be = false;
        for (unsigned code = 0; code != 256; code++) {
            const uint16_t registers[4] = {(uint16_t)raw, 0x0500, 0x0000, (uint16_t)(0xB400 + code)};
            fathom_sample_t sample;
            if (!fathom_hps167s_may_be_configuration(&hps, registers)) continue;
            assert_in_range(code, 1, 4);
            if (fathom_hps167s_decode(registers, &sample) == FATHOM_READY && sample.kind == FATHOM_TARGET)
                may_be = true;
            else
                assert_true(raw == 0x0000 || raw == 0xFF00 || raw == 0xFFFF);
        }
        if (!may_be) continue;
        distances++;
        assert_int_equal(raw, 255);
    }
    assert_int_equal(distances, 1);
}

/* Of 65536 last halves of a reconnect time one in 18 is a multiple: 3641 with the first half 0. */
TEST(the_reconnect_time_lets_one_frame_in_18_through)
{
    unsigned passed = 0;
    start(0);
    for (uint32_t ms = 0; ms != 65536; ms++) {
        const uint16_t registers[4] = {0x00FF, 0x0500, (uint16_t)(ms >> 8), (uint16_t)((ms & 0xFF) << 8 | 1)};
        const bool may_be = fathom_hps167s_may_be_configuration(&hps, registers);
        assert_int_equal(may_be, ms % 18 == 0);
        passed += may_be;
    }
    assert_int_equal(passed, 3641);
}

/* All ones in distance, ambient and precision, nought in magnitude; the exponent is not named. */
TEST(the_abnormal_packet_is_never_a_configuration)
{
    start(0);
    for (unsigned exponent = 0; exponent != 256; exponent++) {
        const uint16_t registers[4] = {0xFFFF, 0, (uint16_t)(exponent << 8 | 0xFF), 0xFFFF};
        assert_false(fathom_hps167s_may_be_configuration(&hps, registers));
    }
}

static fathom_status_t ask(uint16_t raw, fathom_hps167s_temperature_t *out)
{
    clock_us += 20000;
    assert_int_equal(fathom_hps167s_temperature(&hps, out), FATHOM_PENDING);
    *pending->message.values = raw;
    pending->exchange.status = FATHOM_READY;
    return fathom_hps167s_temperature(&hps, out);
}

/* tenths * 9 * steps is (raw - 32 * steps) * 50, rounded to the nearest: they differ by half of 9 * steps at most. */
TEST(every_temperature_is_exact_to_half_a_tenth_or_refused)
{
    static const struct {
        uint8_t steps;
        unsigned refused; /* of 65536 */
    } rows[] = {{1, 65536 - 11797}, {2, 65536 - 23593}, {10, 0}, {100, 0}, {255, 0}};
    for (unsigned i = 0; i != 5; i++) {
        const long steps = rows[i].steps;
        unsigned refused = 0;
        start(rows[i].steps);
        for (long raw = -32768; raw != 32768; raw++) {
            fathom_hps167s_temperature_t out;
            const long exact = (raw - 32 * steps) * 50;
            memset(&out, 0xA5, sizeof out);
            const fathom_status_t status = ask((uint16_t)(raw & 0xFFFF), &out);
            if (status != FATHOM_READY) {
                assert_int_equal(status, FATHOM_ERR_MALFORMED);
                assert_true(labs(exact) * 2 > (2 * 32767 + 1) * 9 * steps);
                assert_int_equal((uint16_t)out.fahrenheit, 0xA5A5);
                refused++;
                continue;
            }
            assert_int_equal(out.fahrenheit, raw);
            assert_true(labs(out.temperature_dc * 9 * steps - exact) * 2 <= 9 * steps);
        }
        assert_int_equal(refused, rows[i].refused);
    }
}
