/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Every command and setting of the drivers that ask, each with a value that the device does not have at first. */

static fathom_a16_modbus_t *const a16 = &s.driver.a16;
static fathom_a05_modbus_t *const a05 = &s.driver.a05;
static fathom_a05_dyp_t *const dyp = &s.driver.dyp;
static fathom_hps167s_t *const hps = &s.driver.hps;

/* What is asked for, in `out`, is there with OK, and untouched without. */
#define ASKS(name, type, before, ask, is_right, is_untouched)                                                \
    static fathom_status_t name(void)                                                                        \
    {                                                                                                        \
        type out = before;                                                                                   \
        const fathom_status_t status = ask;                                                                  \
        assert_true(status == FATHOM_OK ? (is_right) : (is_untouched));                                      \
        return status;                                                                                       \
    }
/* Of a struct, what is not 0 before. */
#define WITH(...)                                                                                            \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }

/* ---- A16 (6(3)) ---- */

static fathom_status_t a16_set_0200(void) { return fathom_a16_modbus_set_address(a16, 5); }
static fathom_status_t a16_set_0202(void)
{
    return fathom_a16_modbus_set_operating_mode(a16, FATHOM_A16_AUTOMATIC);
}
static fathom_status_t a16_set_0205(void)
{
    return fathom_a16_modbus_set_switch_polarity(a16, FATHOM_A16_NEGATIVE);
}
static fathom_status_t a16_set_0206(void) { return fathom_a16_modbus_set_switch_threshold_mm(a16, 16350); }
static fathom_status_t a16_set_0207(void)
{
    return fathom_a16_modbus_set_automatic_value(a16, FATHOM_REAL_TIME);
}

ASKS(a16_0200, uint8_t, 99, fathom_a16_modbus_get_address(a16, &out), out == 1, out == 99)
ASKS(a16_0205, fathom_a16_polarity_t, FATHOM_A16_NEGATIVE, fathom_a16_modbus_get_switch_polarity(a16, &out),
     out == FATHOM_A16_POSITIVE, out == FATHOM_A16_NEGATIVE)
ASKS(a16_0206, uint16_t, 9, fathom_a16_modbus_get_switch_threshold_mm(a16, &out), out == 1000, out == 9)
ASKS(a16_0207, fathom_dyp_value_t, FATHOM_REAL_TIME, fathom_a16_modbus_get_automatic_value(a16, &out),
     out == FATHOM_PROCESSED, out == FATHOM_REAL_TIME)
ASKS(a16_0101, fathom_sample_t, WITH(.distance_mm = 9),
     fathom_a16_modbus_measure(a16, FATHOM_REAL_TIME, &out), out.distance_mm == 1234 && out.address == 1,
     out.distance_mm == 9 && out.address == 0)

static uint32_t a16_unit(void) { return bench.a16.device.address; }
static uint32_t a16_polarity(void) { return bench.a16.polarity; }
static uint32_t a16_threshold(void) { return bench.a16.threshold_mm; }
static uint32_t a16_automatic(void) { return bench.a16.data_type; }

/* ---- A05 (2(3)5, 3(3)) ---- */

static fathom_status_t a05_set_0200(void) { return fathom_a05_modbus_set_address(a05, 5); }
ASKS(a05_0200, uint8_t, 99, fathom_a05_modbus_get_address(a05, &out), out == 1, out == 99)
static fathom_status_t dyp_03(void) { return fathom_a05_dyp_broadcast_address(dyp, 5); }
static uint32_t a05_unit(void) { return bench.a05.device.address; }

/* ---- HPS-167S (3, #1 to #15) ---- */

ASKS(hps_1, fathom_hps167s_version_t, WITH(.year = 9), fathom_hps167s_get_interface_version(hps, &out),
     out.year == 2020 && out.month == 9 && out.day == 27 && out.major == 2, out.year == 9)
ASKS(hps_2, fathom_hps167s_configuration_t, WITH(.baud = 9), fathom_hps167s_get_configuration(hps, &out),
     out.baud == 19200 && out.reconnect_time_ms == 180 && out.warm_up_s == 0 && out.termination &&
         out.measures_after_power_on,
     out.baud == 9)
ASKS(hps_3, fathom_hps167s_details_t, WITH(.year = 9), fathom_hps167s_get_details(hps, &out),
     out.year == 2019, out.year == 9) /* 13 09 17 */
ASKS(hps_4, fathom_hps167s_temperature_t, WITH(.fahrenheit = 9), fathom_hps167s_get_temperature(hps, &out),
     out.fahrenheit == 77 && out.temperature_dc == 250, out.fahrenheit == 9) /* (77 - 32) * 50 / 9 */

static fathom_status_t hps_6(void) { return fathom_hps167s_restore_factory_settings(hps); }
static fathom_status_t hps_7(void) { return fathom_hps167s_set_warm_up_s(hps, 9); }
static fathom_status_t hps_8(void) { return fathom_hps167s_set_address(hps, 5); }
static fathom_status_t hps_9(void) { return fathom_hps167s_set_baud(hps, 115200); }
static fathom_status_t hps_10(void) { return fathom_hps167s_set_measures_after_power_on(hps, false); }
static fathom_status_t hps_11(void) { return fathom_hps167s_set_termination(hps, false); }
static fathom_status_t hps_12(void) { return fathom_hps167s_set_distance_offset_mm(hps, -15); }
static fathom_status_t hps_13_user(void) { return fathom_hps167s_load_user_settings(hps); }
static fathom_status_t hps_13_factory(void) { return fathom_hps167s_load_factory_settings(hps); }
static fathom_status_t hps_14(void) { return fathom_hps167s_set_filter_sensitivity(hps, -100); }
static fathom_status_t hps_15(void)
{
    return fathom_hps167s_set_reconnect_time_ms(hps, 90000);
} /* two words */

static uint32_t hps_unit(void) { return bench.hps.device.address; }
static uint32_t hps_warm_up(void) { return bench.hps.warm_up_s; }
static uint32_t hps_code(void) { return bench.hps.baud_code; }
static uint32_t hps_output(void) { return bench.hps.auto_output; }
static uint32_t hps_termination(void) { return bench.hps.termination; }
static uint32_t hps_reconnect(void) { return bench.hps.reconnect_ms; }
static uint32_t hps_offset(void) { return (uint16_t)bench.hps.sensor.offset_mm; }
static uint32_t hps_filter(void) { return (uint16_t)bench.hps.sensor.filter; }

static uint32_t was_told(void) { return bench.device->counters.writes; }
static uint32_t was_reset(void) { return bench.device->counters.resets; }
static uint32_t nothing(void) { return 0; }

const job_t jobs[] = {
    {"A16 0x0200", a16_set_0200, a16_unit, 1, 5, A16, MOVES, 1},
    {"A16 0x0205", a16_set_0205, a16_polarity, 1, 0, A16, KEPT, 1},
    {"A16 0x0206", a16_set_0206, a16_threshold, 1000, 16350, A16, KEPT, 1},
    {"A16 0x0207", a16_set_0207, a16_automatic, 0, 1, A16, KEPT, 1},
    {"A16 0x0202", a16_set_0202, was_told, 0, 1, A16, WRITE_ONLY, 1},
    {"A16 read 0x0200", a16_0200, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0205", a16_0205, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0206", a16_0206, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0207", a16_0207, nothing, 0, 0, A16, READS, 1},
    {"A16 measure", a16_0101, nothing, 0, 0, A16, READS, 1},
    {"A05 0x0200", a05_set_0200, a05_unit, 1, 5, A05, MOVES, 1},
    {"A05 read 0x0200", a05_0200, nothing, 0, 0, A05, READS, 1},
    {"A05 55 AA 03", dyp_03, a05_unit, 1, 5, A05_DYP, MOVES, 1},
    {"HPS #1", hps_1, nothing, 0, 0, HPS, READS, 1},
    {"HPS #2", hps_2, nothing, 0, 0, HPS, READS, 1},
    {"HPS #3", hps_3, nothing, 0, 0, HPS, READS, 1},
    {"HPS #4", hps_4, nothing, 0, 0, HPS, READS, 1},
    {"HPS #6 at 1", hps_6, was_reset, 0, 1, HPS, MOVES, 1},
    {"HPS #6 at 7", hps_6, hps_unit, 7, 1, HPS, MOVES, 7},
    {"HPS #7", hps_7, hps_warm_up, 0, 9, HPS, KEPT, 1},
    {"HPS #8", hps_8, hps_unit, 1, 5, HPS, MOVES, 1},
    {"HPS #9", hps_9, hps_code, 1, 3, HPS, MOVES, 1},
    {"HPS #10", hps_10, hps_output, 1, 0, HPS, KEPT, 1},
    {"HPS #11", hps_11, hps_termination, 1, 0, HPS, KEPT, 1},
    {"HPS #12", hps_12, hps_offset, 0, 0xFFF1, HPS, WRITE_ONLY, 1},
    {"HPS #13 user", hps_13_user, was_told, 0, 1, HPS, WRITE_ONLY, 1},
    {"HPS #13 factory", hps_13_factory, was_told, 0, 1, HPS, WRITE_ONLY, 1},
    {"HPS #14", hps_14, hps_filter, 0, 0xFF9C, HPS, WRITE_ONLY, 1},
    {"HPS #15", hps_15, hps_reconnect, 180, 90000, HPS, KEPT, 1},
};
const unsigned jobs_count = sizeof jobs / sizeof jobs[0];
