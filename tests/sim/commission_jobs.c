/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* Every command and setting of the drivers that ask, each with a value that the device does not have at first. */

/* ---- A16 (6(3)) ---- */

static fathom_status_t a16_set_address(commission_t *s) { return fathom_a16_set_address(&s->driver.a16, 5); }
static fathom_status_t a16_set_polarity(commission_t *s)
{
    return fathom_a16_set_switch_polarity(&s->driver.a16, FATHOM_A16_NEGATIVE);
}
static fathom_status_t a16_set_threshold(commission_t *s)
{
    return fathom_a16_set_switch_threshold_mm(&s->driver.a16, 16350);
}
static fathom_status_t a16_set_automatic(commission_t *s)
{
    return fathom_a16_set_automatic_value(&s->driver.a16, FATHOM_A16_REAL_TIME);
}
static fathom_status_t a16_set_mode(commission_t *s)
{
    return fathom_a16_set_operating_mode(&s->driver.a16, FATHOM_A16_AUTOMATIC);
}

static fathom_status_t a16_address(commission_t *s)
{
    uint8_t address = 99;
    const fathom_status_t status = fathom_a16_address(&s->driver.a16, &address);
    assert_int_equal(address, status == FATHOM_READY ? 1 : 99);
    return status;
}
static fathom_status_t a16_polarity(commission_t *s)
{
    fathom_a16_polarity_t polarity = FATHOM_A16_NEGATIVE;
    const fathom_status_t status = fathom_a16_switch_polarity(&s->driver.a16, &polarity);
    assert_int_equal(polarity, status == FATHOM_READY ? FATHOM_A16_POSITIVE : FATHOM_A16_NEGATIVE);
    return status;
}
static fathom_status_t a16_threshold(commission_t *s)
{
    uint16_t threshold_mm = 9;
    const fathom_status_t status = fathom_a16_switch_threshold_mm(&s->driver.a16, &threshold_mm);
    assert_int_equal(threshold_mm, status == FATHOM_READY ? 1000 : 9);
    return status;
}
static fathom_status_t a16_automatic(commission_t *s)
{
    fathom_a16_value_t value = FATHOM_A16_REAL_TIME;
    const fathom_status_t status = fathom_a16_automatic_value(&s->driver.a16, &value);
    assert_int_equal(value, status == FATHOM_READY ? FATHOM_A16_PROCESSED : FATHOM_A16_REAL_TIME);
    return status;
}
static fathom_status_t a16_measure(commission_t *s)
{
    fathom_sample_t sample = {.distance_mm = 9};
    const fathom_status_t status = fathom_a16_measure(&s->driver.a16, FATHOM_A16_REAL_TIME, &sample);
    assert_int_equal(sample.distance_mm, status == FATHOM_READY ? 1234 : 9);
    assert_int_equal(sample.unit, status == FATHOM_READY ? 1 : 0);
    return status;
}

static uint32_t a16_unit(const commission_t *s) { return s->device[0].a16.device.unit; }
static uint32_t a16_has_polarity(const commission_t *s) { return s->device[0].a16.polarity; }
static uint32_t a16_has_threshold(const commission_t *s) { return s->device[0].a16.threshold_mm; }
static uint32_t a16_has_automatic(const commission_t *s) { return s->device[0].a16.data_type; }
static uint32_t a16_was_told(const commission_t *s) { return s->device[0].a16.device.counters.writes; }

/* ---- A05 (2(3)5, 3(3)) ---- */

static fathom_status_t a05_set_address(commission_t *s)
{
    return fathom_a05_modbus_set_address(&s->driver.a05, 5);
}
static fathom_status_t a05_address(commission_t *s)
{
    uint8_t address = 99;
    const fathom_status_t status = fathom_a05_modbus_address(&s->driver.a05, &address);
    assert_int_equal(address, status == FATHOM_READY ? 1 : 99);
    return status;
}
static fathom_status_t dyp_set_address(commission_t *s)
{
    return fathom_a05_dyp_set_every_address(&s->driver.dyp, 5);
}
static uint32_t a05_unit(const commission_t *s) { return s->device[0].a05.device.unit; }

/* ---- HPS-167S (3, #1 to #15) ---- */

static fathom_status_t hps_set_warm_up(commission_t *s)
{
    return fathom_hps167s_set_warm_up_s(&s->driver.hps, 9);
}
static fathom_status_t hps_set_address(commission_t *s)
{
    return fathom_hps167s_set_address(&s->driver.hps, 5);
}
static fathom_status_t hps_set_baud(commission_t *s)
{
    return fathom_hps167s_set_baud(&s->driver.hps, 115200);
}
static fathom_status_t hps_set_measures(commission_t *s)
{
    return fathom_hps167s_set_measures_after_power_on(&s->driver.hps, false);
}
static fathom_status_t hps_set_termination(commission_t *s)
{
    return fathom_hps167s_set_termination(&s->driver.hps, false);
}
static fathom_status_t hps_set_reconnect(commission_t *s)
{
    return fathom_hps167s_set_reconnect_time_ms(&s->driver.hps, 90000); /* 0x15F90: both words */
}
static fathom_status_t hps_set_offset(commission_t *s)
{
    return fathom_hps167s_set_distance_offset_mm(&s->driver.hps, -15);
}
static fathom_status_t hps_set_filter(commission_t *s)
{
    return fathom_hps167s_set_filter_sensitivity(&s->driver.hps, -100);
}
static fathom_status_t hps_load_user(commission_t *s)
{
    return fathom_hps167s_load_user_settings(&s->driver.hps);
}
static fathom_status_t hps_load_factory(commission_t *s)
{
    return fathom_hps167s_load_factory_settings(&s->driver.hps);
}
static fathom_status_t hps_restore(commission_t *s)
{
    return fathom_hps167s_restore_factory_settings(&s->driver.hps);
}

static fathom_status_t hps_version(commission_t *s)
{
    fathom_hps167s_version_t out = {.year = 9};
    const fathom_status_t status = fathom_hps167s_interface_version(&s->driver.hps, &out);
    assert_int_equal(out.year, status == FATHOM_READY ? 2020 : 9);
    if (status == FATHOM_READY) {
        assert_int_equal(out.month, 9);
        assert_int_equal(out.day, 27);
        assert_int_equal(out.major, 2);
    }
    return status;
}
static fathom_status_t hps_configuration(commission_t *s)
{
    fathom_hps167s_configuration_t out = {.baud = 9};
    const fathom_status_t status = fathom_hps167s_configuration(&s->driver.hps, &out);
    assert_int_equal(out.baud, status == FATHOM_READY ? 19200 : 9);
    if (status == FATHOM_READY) {
        assert_int_equal(out.reconnect_time_ms, 180);
        assert_int_equal(out.warm_up_s, 0);
        assert_true(out.termination);
        assert_true(out.measures_after_power_on);
    }
    return status;
}
static fathom_status_t hps_details(commission_t *s)
{
    fathom_hps167s_details_t out = {.year = 9};
    const fathom_status_t status = fathom_hps167s_details(&s->driver.hps, &out);
    assert_int_equal(out.year, status == FATHOM_READY ? 2019 : 9); /* 13 09 17 */
    return status;
}
static fathom_status_t hps_temperature(commission_t *s)
{
    fathom_hps167s_temperature_t out = {.fahrenheit = 9};
    const fathom_status_t status = fathom_hps167s_temperature(&s->driver.hps, &out);
    assert_int_equal(out.fahrenheit, status == FATHOM_READY ? 77 : 9);
    if (status == FATHOM_READY) assert_int_equal(out.temperature_dc, 250); /* (77 - 32) * 50 / 9 */
    return status;
}

static uint32_t hps_unit(const commission_t *s) { return s->device[0].hps.device.unit; }
static uint32_t hps_has_warm_up(const commission_t *s) { return s->device[0].hps.warm_up_s; }
static uint32_t hps_has_code(const commission_t *s) { return s->device[0].hps.baud_code; }
static uint32_t hps_has_output(const commission_t *s) { return s->device[0].hps.auto_output; }
static uint32_t hps_has_termination(const commission_t *s) { return s->device[0].hps.termination; }
static uint32_t hps_has_reconnect(const commission_t *s) { return s->device[0].hps.reconnect_ms; }
static uint32_t hps_has_offset(const commission_t *s) { return (uint16_t)s->device[0].hps.sensor.offset_mm; }
static uint32_t hps_has_filter(const commission_t *s) { return (uint16_t)s->device[0].hps.sensor.filter; }
static uint32_t hps_was_told(const commission_t *s) { return s->device[0].hps.device.counters.writes; }
static uint32_t hps_was_reset(const commission_t *s) { return s->device[0].hps.device.counters.resets; }

static uint32_t nothing(const commission_t *s)
{
    (void)s;
    return 0;
}

const job_t jobs[] = {
    {"A16 0x0200", a16_set_address, a16_unit, 1, 5, A16, MOVES, 1},
    {"A16 0x0205", a16_set_polarity, a16_has_polarity, 1, 0, A16, KEPT, 1},
    {"A16 0x0206", a16_set_threshold, a16_has_threshold, 1000, 16350, A16, KEPT, 1},
    {"A16 0x0207", a16_set_automatic, a16_has_automatic, 0, 1, A16, KEPT, 1},
    {"A16 0x0202", a16_set_mode, a16_was_told, 0, 1, A16, WRITE_ONLY, 1},
    {"A16 read 0x0200", a16_address, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0205", a16_polarity, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0206", a16_threshold, nothing, 0, 0, A16, READS, 1},
    {"A16 read 0x0207", a16_automatic, nothing, 0, 0, A16, READS, 1},
    {"A16 measure", a16_measure, nothing, 0, 0, A16, READS, 1},
    {"A05 0x0200", a05_set_address, a05_unit, 1, 5, A05, MOVES, 1},
    {"A05 read 0x0200", a05_address, nothing, 0, 0, A05, READS, 1},
    {"A05 55 AA 03", dyp_set_address, a05_unit, 1, 5, A05_DYP, MOVES, 1},
    {"HPS #1", hps_version, nothing, 0, 0, HPS, READS, 1},
    {"HPS #2", hps_configuration, nothing, 0, 0, HPS, READS, 1},
    {"HPS #3", hps_details, nothing, 0, 0, HPS, READS, 1},
    {"HPS #4", hps_temperature, nothing, 0, 0, HPS, READS, 1},
    {"HPS #6 at 1", hps_restore, hps_was_reset, 0, 1, HPS, MOVES, 1},
    {"HPS #6 at 7", hps_restore, hps_unit, 7, 1, HPS, MOVES, 7},
    {"HPS #7", hps_set_warm_up, hps_has_warm_up, 0, 9, HPS, KEPT, 1},
    {"HPS #8", hps_set_address, hps_unit, 1, 5, HPS, MOVES, 1},
    {"HPS #9", hps_set_baud, hps_has_code, 1, 3, HPS, MOVES, 1},
    {"HPS #10", hps_set_measures, hps_has_output, 1, 0, HPS, KEPT, 1},
    {"HPS #11", hps_set_termination, hps_has_termination, 1, 0, HPS, KEPT, 1},
    {"HPS #12", hps_set_offset, hps_has_offset, 0, 0xFFF1, HPS, WRITE_ONLY, 1},
    {"HPS #13 user", hps_load_user, hps_was_told, 0, 1, HPS, WRITE_ONLY, 1},
    {"HPS #13 factory", hps_load_factory, hps_was_told, 0, 1, HPS, WRITE_ONLY, 1},
    {"HPS #14", hps_set_filter, hps_has_filter, 0, 0xFF9C, HPS, WRITE_ONLY, 1},
    {"HPS #15", hps_set_reconnect, hps_has_reconnect, 180, 90000, HPS, KEPT, 1},
};
const unsigned jobs_count = sizeof jobs / sizeof jobs[0];
