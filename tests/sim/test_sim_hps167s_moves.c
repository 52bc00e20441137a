/* SPDX-License-Identifier: MIT */
#include "hps_stage.h"

/* Commands #8, #9 and #6 of the HPS-167S through the driver, at a simulated one: it moves and is followed. */

#define DEFAULTS ((fathom_sim_hps167s_config_t){.unit = 1})

static const uint32_t loops_us[] = {0, 20 * MS};

#define IN_BOTH_LOOPS for (unsigned loop = 0; loop != 2; loop++)

static fathom_hps167s_temperature_t temperature;

static fathom_status_t four(void) { return fathom_hps167s_temperature(&stage.hps, &temperature); }
static fathom_status_t six(void) { return fathom_hps167s_restore_factory_settings(&stage.hps); }
static fathom_status_t eight(void) { return fathom_hps167s_set_address(&stage.hps, (uint8_t)stage.argument); }
static fathom_status_t nine(void) { return fathom_hps167s_set_baud(&stage.hps, (uint32_t)stage.argument); }

static fathom_status_t with(fathom_status_t (*command)(void), int32_t argument)
{
    stage.argument = argument;
    return carry_out(command);
}

static uint32_t wear(void) { return device()->counters.flash_writes; }

static const suite_t suite = {BENCH_ROUNDS};

/* ---- where it is ---- */

TEST(an_address_is_followed_and_not_set_twice)
{
    for (unsigned from_new = 0; from_new != 2; from_new++) {
        IN_BOTH_LOOPS
        {
            set_stage(loops_us[loop],
                      (fathom_sim_hps167s_config_t){.unit = 1, .answers_from_new = from_new != 0}, NULL);
            assert_int_equal(with(eight, 32), FATHOM_READY);
            assert_int_equal(device()->unit, 32);
            assert_measures(32, TARGET_MM);
            assert_int_equal(with(eight, 32), FATHOM_READY);
            assert_int_equal(wear(), 1);
        }
    }
}

TEST(an_address_at_which_another_answers_is_not_given)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        add(1, (fathom_sim_hps167s_config_t){.unit = 5});
        assert_int_equal(with(eight, 5), FATHOM_ERR_IN_USE);
        assert_int_equal(device()->unit, 1);
        assert_int_equal(wear() + stage.sim[1].device.counters.flash_writes, 0);
        assert_measures(1, TARGET_MM);
    }
}

TEST(without_confirmation_it_is_at_one_of_the_two_addresses)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, NULL);
        silence_from(2, 1000);
        assert_int_equal(with(eight, 5), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(device()->unit, 5);
        assert_int_equal(wear(), 1);
    }
}

TEST(what_waits_for_the_old_address_is_cancelled)
{
    set_stage(0, DEFAULTS, NULL);
    uint16_t values[4];
    fathom_modbus_request_t request = {.exchange = {.timeout_us = 100 * MS}};
    fathom_modbus_request_t other = {.exchange = {.timeout_us = 100 * MS}};
    fathom_modbus_read_holding_registers(&request.message, 1, 0x0008, 4, values);
    fathom_modbus_read_holding_registers(&other.message, 9, 0x0008, 4, values);
    stage.argument = 5;
    while (device()->counters.writes == 0) {
        assert_int_equal(eight(), FATHOM_PENDING);
        pass();
    }
    assert_int_equal(fathom_modbus_client_submit(&stage.line, &request), FATHOM_PENDING);
    assert_int_equal(fathom_modbus_client_submit(&stage.line, &other), FATHOM_PENDING);
    assert_int_equal(carry_out(eight), FATHOM_READY);
    assert_int_equal(request.exchange.status, FATHOM_ERR_CANCELLED);
    assert_int_equal(request.exchange.attempts, 0);
    assert_int_equal(other.exchange.status, FATHOM_ERR_NO_ANSWER);
}

/* ---- at which rate it is ---- */

TEST(a_rate_is_followed_there_and_back)
{
    static const uint32_t bauds[] = {57600, 115200, 230400};
    IN_BOTH_LOOPS
    {
        for (unsigned i = 0; i != 3; i++) {
            set_stage(loops_us[loop], DEFAULTS, &factory);
            assert_int_equal(with(nine, (int32_t)bauds[i]), FATHOM_READY);
            assert_int_equal(device()->settings.baud, bauds[i]);
            assert_int_equal(wear(), 1);
            assert_measures(1, TARGET_MM);
            assert_int_equal(with(nine, (int32_t)bauds[i]), FATHOM_READY);
            assert_int_equal(wear(), 1);
            assert_int_equal(with(nine, 19200), FATHOM_READY);
            assert_int_equal(device()->settings.baud, 19200);
            assert_measures(1, TARGET_MM);
        }
    }
}

TEST(a_rate_from_the_next_power_on_is_followed_then)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], (fathom_sim_hps167s_config_t){.unit = 1, .baud_at_power_on = true},
                  &factory);
        assert_int_equal(with(nine, 115200), FATHOM_READY);
        assert_int_equal(stage.hps.next_baud, 115200);
        assert_int_equal(device()->settings.baud, 19200);
        assert_measures(1, TARGET_MM);
        fathom_sim_power_cycle(&stage.wire, device(), 0, stage.clock.now_us);
        fathom_hps167s_power_on(&stage.hps);
        assert_int_equal(device()->settings.baud, 115200);
        assert_measures(1, TARGET_MM);
        assert_int_equal(wear(), 1);
    }
}

/* The driver is told of a power-on that did not happen: it comes back to the rate before. */
TEST(a_device_that_stays_at_its_rate_is_found_there)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], (fathom_sim_hps167s_config_t){.unit = 1, .baud_at_power_on = true},
                  &factory);
        assert_int_equal(with(nine, 57600), FATHOM_READY);
        fathom_hps167s_power_on(&stage.hps);
        assert_int_equal(measure(), FATHOM_ERR_WARMING_UP);
        assert_measures(1, TARGET_MM);
    }
}

TEST(without_confirmation_both_rates_are_asked_until_it_answers)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, &factory);
        silence_from(3, 1000); /* the acknowledgement, and all after it */
        assert_int_equal(with(nine, 115200), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(device()->settings.baud, 115200);
        assert_int_equal(wear(), 1);
        fathom_sim_fault_enable(&stage.fault, false);
        fathom_status_t status = FATHOM_ERR_NO_ANSWER;
        for (unsigned i = 0; i != 4 && status < 0; i++) status = measure();
        assert_int_equal(status, FATHOM_READY);
        assert_measures(1, TARGET_MM);
        assert_int_equal(wear(), 1);
    }
}

/* Two of one address: after the change they would answer at once. */
TEST(a_rate_at_which_another_has_the_address_is_not_given)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], DEFAULTS, &factory);
        add(1, (fathom_sim_hps167s_config_t){.unit = 1, .baud_code = 2});
        assert_int_equal(with(nine, 57600), FATHOM_ERR_IN_USE);
        assert_int_equal(wear() + stage.sim[1].device.counters.flash_writes, 0);
        assert_measures(1, TARGET_MM);
    }
}

/* ---- the factory reset ---- */

static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};

TEST(a_reset_device_is_followed_home)
{
    for (unsigned from_new = 0; from_new != 2; from_new++) {
        IN_BOTH_LOOPS
        {
            set_stage(
                loops_us[loop],
                (fathom_sim_hps167s_config_t){.unit = 7, .baud_code = 3, .answers_from_new = from_new != 0},
                &fast);
            assert_measures(7, TARGET_MM);
            assert_int_equal(carry_out(six), FATHOM_READY);
            assert_int_equal(device()->counters.resets, 1);
            assert_int_equal(device()->counters.resets_refused, 0);
            assert_int_equal(device()->unit, 1);
            assert_int_equal(device()->settings.baud, 19200);
            assert_int_equal(measure(), FATHOM_READY);
            assert_int_equal(stage.sample.unit, 1);
        }
    }
}

TEST(a_reset_is_not_sent_where_another_is_at_address_1)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], (fathom_sim_hps167s_config_t){.unit = 7}, NULL);
        add(1, (fathom_sim_hps167s_config_t){.unit = 1});
        assert_int_equal(carry_out(six), FATHOM_ERR_IN_USE);
        assert_int_equal(device()->counters.resets + stage.sim[1].device.counters.resets, 0);
        assert_measures(7, TARGET_MM);
    }
}

TEST(a_reset_whose_confirmation_is_lost_is_unconfirmed_and_sent_once)
{
    IN_BOTH_LOOPS
    {
        set_stage(loops_us[loop], (fathom_sim_hps167s_config_t){.unit = 7}, NULL);
        silence_from(3, 1000);
        assert_int_equal(carry_out(six), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(device()->counters.resets, 1);
        assert_int_equal(device()->unit, 1);
    }
}

/* #4 is asked, and answered too late with one degree Fahrenheit, 00 01: as if it were the answer to #6. */
TEST(a_late_temperature_of_1_degree_is_not_taken_for_a_reset)
{
    IN_BOTH_LOOPS
    {
        for (uint32_t late_ms = 850; late_ms <= 2350; late_ms += 100) {
            set_stage(loops_us[loop], DEFAULTS, NULL);
            stage.sim[0].temperature_f = 1;
            fathom_sim_fault_rule_t *const rule =
                fathom_sim_fault_add(&stage.fault, FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_ALWAYS_PPM, 1);
            assert_non_null(rule);
            rule->us = late_ms * MS;
            silence_from(4, 1); /* after two to #2, the answer to #6 */
            const fathom_status_t first = carry_out(four);
            assert_int_equal(first, late_ms < 1000 ? FATHOM_READY : FATHOM_ERR_NO_ANSWER);
            const fathom_status_t status = carry_out(six);
            assert_true(status == FATHOM_ERR_UNCONFIRMED || status == FATHOM_ERR_NO_ANSWER ||
                        status == FATHOM_ERR_MALFORMED);
            assert_int_equal(device()->counters.resets, status == FATHOM_ERR_UNCONFIRMED);
            assert_int_equal(stage.hps.reset_answer, FATHOM_HPS167S_NO_RESET_ANSWER);
        }
    }
}
