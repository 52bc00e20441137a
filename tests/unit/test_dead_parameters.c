/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fake_modbus.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a16_settings.h"
#include "line_bench.h"

/* A request outlives the call that made it: it may point to nothing of that call. */

/* Does the pointer live as long as the sensor, if it points anywhere? */
static bool lives(const uint16_t *values, const void *sensor, size_t size)
{
    const uintptr_t at = (uintptr_t)values;
    const uintptr_t first = (uintptr_t)sensor;
    return values == NULL || (at >= first && at < first + size);
}

static fake_modbus_t modbus;

TEST(a_setting_over_modbus_keeps_no_pointer_to_its_parameter)
{
    static const uint16_t is_10000[] = {10000};
    fathom_a16_modbus_t a16;
    fake_modbus_init(&modbus);
    assert_int_equal(fathom_a16_modbus_init(&a16, &modbus.modbus, NULL), FATHOM_OK);
    assert_int_equal(fathom_a16_modbus_set_switch_threshold_mm(&a16, 500), FATHOM_PENDING);
    fake_modbus_response(&modbus, is_10000, 1);
    for (unsigned i = 0; modbus.submits != 2; i++) {
        assert_true(i != 1000);
        modbus.now_us += 1000;
        assert_int_equal(fathom_a16_modbus_set_switch_threshold_mm(&a16, 500), FATHOM_PENDING);
    }
    assert_int_equal(modbus.log[1][1], FATHOM_MODBUS_WRITE_SINGLE_REGISTER);
    assert_int_equal(modbus.log[1][4] * 256 + modbus.log[1][5], 500);
    assert_true(lives(modbus.request->message.values, &a16, sizeof a16));
}
