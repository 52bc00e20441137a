/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* hps167s.h and hps167s_info.h: memory that is not zero, and figures to their last digit. */

#define PERIOD_US FATHOM_HPS167S_MIN_PERIOD_US

static const uint16_t tells[4] = {0xFF00, 0x0500, 0x0000, 0xB401}; /* table 12: 180 ms, rate 1 */

static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t configuration(void) { return fathom_hps167s_get_configuration(&hps, &is); }
static fathom_status_t read_temperature(void) { return fathom_hps167s_get_temperature(&hps, &temperature); }
static fathom_status_t set_termination(void) { return fathom_hps167s_set_termination(&hps, false); }

#define ON  0xFF00, 0x0500, 0x0000, 0xB401
#define OFF 0x0000, 0x0500, 0x0000, 0xB401

static uint32_t due_us(void) { return desk.sensor.due_us(desk.sensor.ctx); }

/* Calls until the next request is under way. */
static void asks(fathom_status_t (*command)(void))
{
    for (unsigned i = 0; fake.request == NULL || fake.ends != FATHOM_PENDING; i++) {
        assert_true(i < 1000);
        PENDS(command());
        if (fake.request == NULL) fake.now_us += 1000;
    }
}

HPS_SUITE;

/* ---- memory that is not zero ---- */

TEST(a_new_driver_has_had_no_response_to_a_reset)
{
    assert_int_equal(hps.reset_response, FATHOM_HPS167S_NO_RESET_RESPONSE);
    assert_int_equal(hps.reset_response, 0xFFFF);
}

TEST(a_new_driver_has_written_nothing_whatever_stood_in_the_memory)
{
    hps.unit.is_written = true;
    hps_start();
    assert_false(fathom_hps167s_is_written(&hps));
}

/* 01000008 hexadecimal = 16777224. */
TEST(the_first_configuration_is_believed_whatever_stood_in_the_memory)
{
    static const uint16_t first[4] = {0x0000, 0x0101, 0x0000, 0x0801};
    memcpy(hps.last_measurement, first, sizeof first);
    hps_start();
    PLAY(configuration, OK, TELLS(0x0000, 0x0101, 0x0000, 0x0801));
    assert_int_equal(is.warm_up_s, 1);
    assert_int_equal(is.reconnect_time_ms, 16777224);
}

/* ---- how often it is asked ---- */

/* hps167s_info.h: the requests come at irregular intervals, or a slow loop could keep step with the device. Of 31
 * intervals, at least one is in each eighth of the device's period. */
TEST(after_a_measurement_in_the_place_of_a_response_the_intervals_keep_no_step_with_the_device)
{
    enum { PARTS = 8, READS = 31 };
    unsigned in_part[PARTS] = {0};
    for (uint32_t n = 0; n != READS; n++) {
        asks(configuration);
        fake_modbus_response(&fake, hps_measured, 4);
        PENDS(configuration());
        assert_in_range(due_us(), PERIOD_US, PERIOD_US + 131070); /* 2 * 65535 */
        in_part[due_us() % PERIOD_US * PARTS / PERIOD_US]++;
        fake.submits = 0;
    }
    for (unsigned i = 0; i != PARTS; i++) assert_true(in_part[i] != 0);
}

TEST(among_measured_frames_that_were_heard_it_is_asked_out_of_step_from_the_first_response_on)
{
    assert_true(fathom_hps167s_accept_unsolicited(&hps, hps_measured, fake.now_us));
    asks(configuration);
    fake_modbus_response(&fake, tells, 4);
    PENDS(configuration());
    assert_in_range(due_us(), PERIOD_US + 1, PERIOD_US + 131070);
}

/* ---- how many responses to #2 ---- */

/* "For 2 s after such a frame": of the last row there was none. */
TEST(for_2_s_to_the_microsecond_one_response_is_not_enough_and_a_new_driver_has_heard_nothing)
{
    static const uint32_t before_us[] = {1999999, 2000000, 0};
    hps_config.same_responses = 1;
    for (unsigned i = 0; i != 3; i++) {
        hps_start();
        if (i != 2)
            assert_true(fathom_hps167s_accept_unsolicited(&hps, hps_measured, fake.now_us - before_us[i]));
        asks(configuration);
        fake_modbus_response(&fake, tells, 4);
        assert_int_equal(configuration(), i == 0 ? FATHOM_PENDING : OK);
    }
}

/* FATHOM_ERR_BUSY: "another command or setting is not finished": that one does not notice. */
TEST(who_is_told_busy_costs_a_setting_no_response)
{
    asks(set_termination);
    fake_modbus_response(&fake, tells, 4);
    PENDS(set_termination()); /* one of two */
    assert_int_equal(configuration(), FATHOM_ERR_BUSY);
    PLAY(set_termination, OK, HPS_2(1, OK, 0, ON), {{1, 6, 0, 0x13, 0, 0}, OK, {0}, 0}, TELLS(OFF));
}

/* ---- #4 ---- */

/* (raw / 4 - 32) * 50 / 9 = (raw - 128) * 50 / 36, rounded: 32766.67, 32768.06, -32768.06, -32769.44 tenths. */
TEST(a_temperature_is_told_as_far_as_tenths_of_a_degree_fit)
{
    static const struct {
        uint16_t raw;
        fathom_status_t status;
        int16_t tenths;
    } rows[] = {{23720, OK, 32767},
                {23721, FATHOM_ERR_MALFORMED, 0},
                {0x10000 - 23465, OK, INT16_MIN},
                {0x10000 - 23466, FATHOM_ERR_MALFORMED, 0}};
    for (unsigned i = 0; i != 4; i++) {
        hps_set_up(NULL);
        hps_config.steps_per_degree = 4;
        hps_start();
        const row_t row = {{1, 3, 0, 4, 0, 1}, OK, {rows[i].raw}, 0};
        assert_int_equal(desk_play(read_temperature, &row, 1), rows[i].status);
        if (rows[i].status == OK) assert_int_equal(temperature.temperature_dc, rows[i].tenths);
    }
}
