/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fake_modbus.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/hps167s_info.h"

/* Every figure that an HPS-167S can send where two responses have one shape, and every temperature. */

static fathom_modbus_request_t *pending;

static fathom_status_t submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    (void)line;
    request->transaction.status = FATHOM_PENDING;
    request->transaction.attempts = 1;
    pending = request;
    return FATHOM_PENDING;
}

static fake_modbus_t bus;
static const fathom_modbus_t modbus = {.line = &bus.line, .submit = submit};
static fathom_hps167s_t hps;

static void start(uint8_t steps_per_degree)
{
    const fathom_hps167s_config_t config = {.steps_per_degree = steps_per_degree};
    fake_modbus_init(&bus);
    assert_int_equal(fathom_hps167s_init(&hps, &modbus, &config), FATHOM_OK);
}

/* Whatever the other bytes are: some of each. */
TEST(of_all_distances_only_255_mm_can_look_like_a_configuration)
{
    static const uint16_t others[][3] = {{0x0500, 0x0000, 0xB401}, {0xFFFF, 0xFFFF, 0xFFFF}, {0, 0, 0}};
    for (uint32_t raw = 0; raw != 65536; raw++) {
        for (unsigned i = 0; i != 3; i++) {
            const uint16_t registers[4] = {(uint16_t)raw, others[i][0], others[i][1], others[i][2]};
            const bool is_two_switches = raw % 256 % 255 == 0 && raw / 256 % 255 == 0;
            fathom_sample_t sample;
            assert_int_equal(fathom_hps167s_may_be_configuration(registers), is_two_switches);
            if (is_two_switches && fathom_hps167s_decode(registers, &sample) == FATHOM_OK)
                assert_int_equal(raw, 255);
        }
    }
}

/* Table 12 has no encoding of the rate, and no rule for the reconnect time. */
TEST(every_reconnect_time_and_baud_code_can_be_a_configuration)
{
    for (uint32_t ms = 0; ms != 65536; ms++) {
        const uint16_t registers[4] = {0x00FF, 0x0500, (uint16_t)(ms >> 8),
                                       (uint16_t)((ms & 0xFF) << 8 | ms % 256)};
        if (!fathom_hps167s_may_be_configuration(registers)) fail_msg("%lu ms", (unsigned long)ms);
    }
}

/* All ones in distance, ambient and precision, nought in magnitude; the exponent is not named. */
TEST(the_abnormal_packet_is_never_a_configuration)
{
    for (unsigned exponent = 0; exponent != 256; exponent++) {
        const uint16_t registers[4] = {0xFFFF, 0, (uint16_t)(exponent << 8 | 0xFF), 0xFFFF};
        assert_false(fathom_hps167s_may_be_configuration(registers));
    }
}

static fathom_status_t ask(uint16_t raw, fathom_hps167s_temperature_t *out)
{
    bus.now_us += 20000;
    assert_int_equal(fathom_hps167s_get_temperature(&hps, out), FATHOM_PENDING);
    *pending->message.values = raw;
    pending->transaction.status = FATHOM_OK;
    return fathom_hps167s_get_temperature(&hps, out);
}

/* tenths * 9 * steps is (raw - 32 * steps) * 50, rounded to the nearest: they differ by half of 9 * steps at most. */
TEST(every_temperature_is_exact_to_half_a_tenth_or_refused)
{
    static const struct {
        uint8_t steps;
        unsigned refused; /* of 65536 */
    } rows[] = {{1, 65536 - 11797}, {2, 65536 - 23593}, {4, 65536 - 47186}, {10, 0}, {100, 0}, {255, 0}};
    for (unsigned i = 0; i != 6; i++) {
        const long steps = rows[i].steps;
        unsigned refused = 0;
        start(rows[i].steps);
        for (long raw = -32768; raw != 32768; raw++) {
            fathom_hps167s_temperature_t out;
            const long exact = (raw - 32 * steps) * 50;
            memset(&out, 0xA5, sizeof out);
            const fathom_status_t status = ask((uint16_t)(raw & 0xFFFF), &out);
            if (status != FATHOM_OK) {
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
