/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/hps167s.h"

/* A distance of 31000 mm is none that an HPS-167S can mean (its range ends at 18 m). */
TEST(refused_values_are_counted_and_the_count_stops_at_65535)
{
    static const uint16_t refused[] = {31000, 0xDCB2, 0x0701, 0};
    static fathom_hps167s_t hps;
    fake_modbus_t fake;
    fathom_sample_t sample;
    fake_modbus_init(&fake);
    const fathom_hps167s_config_t config = {.modbus = &fake.modbus, .clock = &fake.clock};
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    hps.implausible = 65533;
    for (unsigned i = 0; i != 4; i++) {
        fake.now_us += 1000000;
        assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
        assert_int_equal(fake.submits, i + 1);
        fake_modbus_answer(&fake, refused, 4);
        assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_ERR_MALFORMED);
        assert_int_equal(hps.implausible, i == 0 ? 65534 : 65535);
    }
}
