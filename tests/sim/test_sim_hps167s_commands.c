/* SPDX-License-Identifier: MIT */
#include "hps_stage.h"

/* The commands of the HPS-167S through the driver, at a simulated one, but for those that move it. */

#define DEFAULTS ((fathom_sim_hps167s_config_t){.unit = 1})

static const uint32_t loops_us[] = {0, 20 * MS};

#define IN_BOTH_LOOPS for (unsigned loop = 0; loop != 2; loop++)

static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;
static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t one(void) { return fathom_hps167s_interface_version(&stage.hps, &version); }
static fathom_status_t two(void) { return fathom_hps167s_configuration(&stage.hps, &is); }
static fathom_status_t three(void) { return fathom_hps167s_details(&stage.hps, &details); }
static fathom_status_t four(void) { return fathom_hps167s_temperature(&stage.hps, &temperature); }
static fathom_status_t seven(void)
{
    return fathom_hps167s_set_warm_up_s(&stage.hps, (uint8_t)stage.argument);
}
static fathom_status_t ten(void)
{
    return fathom_hps167s_set_measures_after_power_on(&stage.hps, stage.argument != 0);
}
static fathom_status_t eleven(void)
{
    return fathom_hps167s_set_termination(&stage.hps, stage.argument != 0);
}
static fathom_status_t twelve(void)
{
    return fathom_hps167s_set_distance_offset_mm(&stage.hps, (int16_t)stage.argument);
}
static fathom_status_t thirteen_user(void) { return fathom_hps167s_load_user_settings(&stage.hps); }
static fathom_status_t thirteen_factory(void) { return fathom_hps167s_load_factory_settings(&stage.hps); }
static fathom_status_t fourteen(void)
{
    return fathom_hps167s_set_filter_sensitivity(&stage.hps, (int16_t)stage.argument);
}
static fathom_status_t fifteen(void)
{
    return fathom_hps167s_set_reconnect_time_ms(&stage.hps, (uint32_t)stage.argument);
}

static fathom_status_t with(fathom_status_t (*command)(void), int32_t argument)
{
    stage.argument = argument;
    return carry_out(command);
}

static uint32_t wear(void) { return device()->counters.flash_writes; }

static const suite_t suite = {BENCH_ROUNDS};

/* ---- what it tells ---- */

TEST(commands_1_to_4_tell_what_the_device_has)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        assert_int_equal(carry_out(one), FATHOM_READY);
        assert_int_equal(version.year, 2020);
        assert_int_equal(carry_out(two), FATHOM_READY);
        assert_true(is.termination && is.measures_after_power_on);
        assert_int_equal(is.baud, 19200);
        assert_int_equal(is.reconnect_time_ms, 180);
        assert_int_equal(carry_out(three), FATHOM_READY);
        assert_int_equal(details.year, 2019);
        assert_int_equal(carry_out(four), FATHOM_READY);
        assert_int_equal(temperature.temperature_dc, 250);
        stage.sim[0].temperature_f = -40;
        assert_int_equal(carry_out(four), FATHOM_READY);
        assert_int_equal(temperature.temperature_dc, -400);
        assert_measures(1, TARGET_MM);
        assert_int_equal(wear() + device()->counters.resets + device()->counters.resets_refused, 0);
        assert_int_equal(device()->counters.exceptions, 0);
    }
}

/* ---- what is read back ---- */

TEST(settings_with_read_back_are_written_once_and_kept)
{
    static const struct {
        fathom_status_t (*set)(void);
        int32_t value;
    } settings[] = {{seven, 9}, {ten, 0}, {eleven, 0}, {fifteen, 65556}};
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        for (unsigned i = 0; i != 4; i++) {
            assert_int_equal(with(settings[i].set, settings[i].value), FATHOM_READY);
            assert_int_equal(wear(), i + 1);
            assert_int_equal(with(settings[i].set, settings[i].value), FATHOM_READY); /* so already */
            assert_int_equal(wear(), i + 1);
        }
        fathom_sim_power_cycle(&stage.wire, device(), 0, stage.clock.now_us);
        assert_int_equal(carry_out(two), FATHOM_READY);
        assert_int_equal(is.warm_up_s, 9);
        assert_false(is.measures_after_power_on);
        assert_false(is.termination);
        assert_int_equal(is.reconnect_time_ms, 65556);
        assert_int_equal(is.baud, 19200);
        assert_int_equal(device()->counters.writes_refused, 0);
    }
}

/* Answers: two to #2, then the acknowledgement is the third frame, and the reading the fourth. */
TEST(a_lost_confirmation_is_unconfirmed_and_a_lost_acknowledgement_is_not)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        silence_from(3, 1000);
        assert_int_equal(with(seven, 9), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(wear(), 1);
        set_stage(loops_us[loop], DEFAULTS, NULL);
        silence_from(3, 1);
        assert_int_equal(with(seven, 9), FATHOM_READY);
        assert_int_equal(wear(), 1);
        set_stage(loops_us[loop], DEFAULTS, NULL);
        silence_from(4, 1000);
        assert_int_equal(with(seven, 9), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(wear(), 1);
    }
}

/* ---- what is not ---- */

TEST(write_only_commands_are_acknowledged)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        assert_int_equal(with(twelve, -15), FATHOM_READY);
        assert_measures(1, TARGET_MM - 15);
        assert_int_equal(with(fourteen, -100), FATHOM_READY);
        assert_int_equal(stage.sim[0].sensor.filter, -100);
        assert_int_equal(carry_out(thirteen_factory), FATHOM_READY);
        assert_int_equal(device()->counters.resets, 1);
        assert_measures(1, TARGET_MM);
        assert_int_equal(carry_out(thirteen_user), FATHOM_READY);
        assert_measures(1, TARGET_MM - 15);
        assert_int_equal(device()->counters.resets, 1);
    }
}

TEST(a_write_only_command_is_told_once_where_the_line_echoes)
{
    IN_BOTH_LOOPS
    {
        line_echoes = true;
        set_stage(loops_us[loop], (fathom_sim_hps167s_config_t){.unit = 1, .offset_adds = true}, NULL);
        line_echoes = false;
        assert_int_equal(with(twelve, 7), FATHOM_READY);
        assert_measures(1, TARGET_MM + 7);
        fathom_sim_detach(&stage.wire, device(), stage.clock.now_us);
        assert_int_equal(with(twelve, 7), FATHOM_ERR_NO_ANSWER);
    }
}

/* ---- warm-up ---- */

TEST(silence_refusal_and_the_abnormal_packet_of_a_warm_up_are_no_error)
{
    IN_BOTH_LOOPS
    {
        for (uint8_t says = 0; says != 3; says++) {
            set_stage(loops_us[loop],
                      (fathom_sim_hps167s_config_t){.unit = 1, .warm_up_s = 5, .warm_up_says = says}, NULL);
            const uint32_t start_us = stage.clock.now_us;
            fathom_hps167s_power_on(&stage.hps);
            fathom_status_t status;
            unsigned warming = 0;
            while ((status = measure()) == FATHOM_ERR_WARMING_UP) {
                warming++;
                if (stage.loop_us == 0 && says != 0) fathom_sim_clock_advance(&stage.clock, 50 * MS);
            }
            assert_int_equal(status, FATHOM_READY);
            assert_true(warming > 3);
            assert_int_equal(stage.sample.kind, FATHOM_TARGET);
            assert_in_range(fathom_elapsed_us(stage.clock.now_us, start_us), 5 * SECOND,
                            5 * SECOND + 500 * MS);
        }
    }
}
