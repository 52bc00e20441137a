/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* The commands of the HPS-167S through the driver, at a simulated one. What befalls a change of its address is in
 * test_commission_address.c. */

enum { TARGET_MM = 2083 };

static fathom_hps167s_t *const hps = &s.driver.hps;
static int32_t argument; /* of the command */
static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;
static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t one(void) { return fathom_hps167s_get_interface_version(hps, &version); }
static fathom_status_t two(void) { return fathom_hps167s_get_configuration(hps, &is); }
static fathom_status_t three(void) { return fathom_hps167s_get_details(hps, &details); }
static fathom_status_t four(void) { return fathom_hps167s_get_temperature(hps, &temperature); }
static fathom_status_t six(void) { return fathom_hps167s_restore_factory_settings(hps); }
static fathom_status_t seven(void) { return fathom_hps167s_set_warm_up_s(hps, (uint8_t)argument); }
static fathom_status_t nine(void) { return fathom_hps167s_set_baud(hps, (uint32_t)argument); }
static fathom_status_t ten(void) { return fathom_hps167s_set_measures_after_power_on(hps, argument != 0); }
static fathom_status_t eleven(void) { return fathom_hps167s_set_termination(hps, argument != 0); }
static fathom_status_t twelve(void) { return fathom_hps167s_set_distance_offset_mm(hps, (int16_t)argument); }
static fathom_status_t thirteen_user(void) { return fathom_hps167s_load_user_settings(hps); }
static fathom_status_t thirteen_factory(void) { return fathom_hps167s_load_factory_settings(hps); }
static fathom_status_t fourteen(void)
{
    return fathom_hps167s_set_filter_sensitivity(hps, (int16_t)argument);
}
static fathom_status_t fifteen(void) { return fathom_hps167s_set_reconnect_time_ms(hps, (uint32_t)argument); }

static fathom_status_t with(fathom_status_t (*command)(void), int32_t its_argument)
{
    argument = its_argument;
    return carry_out(command);
}

static void set(uint32_t loop_us, hps_config_t config, const fathom_line_settings_t *at)
{
    stage_begin(&bench_19200, false, loop_us);
    bench.fixed = FIXED(TARGET_MM);
    s.model = HPS;
    const fathom_hps167s_config_t driver = {.modbus.line_settings = at,
                                            .modbus.address = config.address != 0 ? config.address : 1,
                                            .modbus.timeout_us = 100 * MS};
    assert_int_equal(fathom_hps167s_init(hps, &s.modbus, &driver), FATHOM_OK);
    s.sensor = sensor_of(&s.driver, HPS);
    add_hps(config);
    set_faults(1);
}

static void cut_power(void) { fathom_sim_power_cycle(&bench.line, bench.device, 0, s.clock.now_us); }

#define DEFAULTS      ((hps_config_t){0})
#define IN_BOTH_LOOPS for (unsigned l = 0; l != 2; l++)

static const suite_t suite = {BENCH_ROUNDS};

TEST(commands_1_to_4_tell_what_the_device_has)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], DEFAULTS, NULL);
        assert_int_equal(carry_out(one), FATHOM_OK);
        assert_int_equal(version.year, 2020);
        assert_int_equal(carry_out(two), FATHOM_OK);
        assert_true(is.termination && is.measures_after_power_on);
        assert_int_equal(is.baud, 19200);
        assert_int_equal(is.reconnect_time_ms, 180);
        assert_int_equal(carry_out(three), FATHOM_OK);
        assert_int_equal(details.year, 2019);
        assert_int_equal(carry_out(four), FATHOM_OK);
        assert_int_equal(temperature.temperature_dc, 250);
        bench.hps.temperature_f = -40;
        assert_int_equal(carry_out(four), FATHOM_OK);
        assert_int_equal(temperature.temperature_dc, -400);
        assert_measures(1, TARGET_MM);
        COUNTED(.flash_writes = NONE, .resets = NONE, .resets_refused = NONE, .exceptions = NONE);
    }
}

TEST(settings_with_read_back_are_written_once_and_kept)
{
    static const struct {
        fathom_status_t (*set)(void);
        int32_t value;
    } settings[] = {{seven, 9}, {ten, 0}, {eleven, 0}, {fifteen, 65556}};
    IN_BOTH_LOOPS
    {
        set(loops_us[l], DEFAULTS, NULL);
        for (unsigned i = 0; i != 8; i++) { /* each twice: then it is so already */
            assert_int_equal(with(settings[i / 2].set, settings[i / 2].value), FATHOM_OK);
            COUNTED(.flash_writes = i / 2 + 1);
        }
        cut_power();
        assert_int_equal(carry_out(two), FATHOM_OK);
        assert_int_equal(is.warm_up_s, 9);
        assert_false(is.measures_after_power_on || is.termination);
        assert_int_equal(is.reconnect_time_ms, 65556);
        assert_int_equal(is.baud, 19200);
        COUNTED(.writes_refused = NONE);
    }
}

/* Responses: two to #2, then the acknowledgement is the third frame, and the reading the fourth. */
TEST(a_lost_confirmation_is_unconfirmed_and_a_lost_acknowledgement_is_not)
{
    static const struct {
        uint32_t frame, run;
        fathom_status_t status;
    } rows[] = {{3, 1000, FATHOM_ERR_UNCONFIRMED}, {3, 1, FATHOM_OK}, {4, 1000, FATHOM_ERR_UNCONFIRMED}};
    for (unsigned n = 0; n != 6; n++) {
        set(loops_us[n / 3], DEFAULTS, NULL);
        silence_from(rows[n % 3].frame, rows[n % 3].run);
        assert_int_equal(with(seven, 9), rows[n % 3].status);
        COUNTED(.flash_writes = 1);
    }
}

TEST(write_only_commands_are_acknowledged)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], DEFAULTS, NULL);
        assert_int_equal(with(twelve, -15), FATHOM_OK);
        assert_measures(1, TARGET_MM - 15);
        assert_int_equal(with(fourteen, -100), FATHOM_OK);
        assert_int_equal(bench.hps.sensor.filter, -100);
        assert_int_equal(carry_out(thirteen_factory), FATHOM_OK);
        COUNTED(.resets = 1);
        assert_measures(1, TARGET_MM);
        assert_int_equal(carry_out(thirteen_user), FATHOM_OK);
        assert_measures(1, TARGET_MM - 15);
        COUNTED(.resets = 1);
    }
}

TEST(a_write_only_command_is_told_once_where_the_line_echoes)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], (hps_config_t){.offset_adds = true}, NULL);
        bench.line.echo = true;
        set_faults(1); /* which keep an echo that is there */
        assert_int_equal(with(twelve, 7), FATHOM_OK);
        assert_measures(1, TARGET_MM + 7);
        fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
        assert_int_equal(with(twelve, 7), FATHOM_ERR_NO_RESPONSE);
    }
}

TEST(silence_refusal_and_the_abnormal_packet_of_a_warm_up_are_no_error)
{
    for (unsigned n = 0; n != 6; n++) {
        const uint8_t says = (uint8_t)(n % 3);
        set(loops_us[n / 3], (hps_config_t){.warm_up_s = 5, .warm_up_says = says}, NULL);
        const uint32_t start_us = s.clock.now_us;
        fathom_hps167s_power_on(hps);
        fathom_status_t status;
        unsigned warming = 0;
        for (; (status = measure()) == FATHOM_ERR_WARMING_UP; warming++)
            if (s.loop_us == 0 && says != 0) pass_us(50 * MS);
        assert_int_equal(status, FATHOM_OK);
        assert_true(warming > 3);
        assert_int_equal(s.sample.kind, FATHOM_TARGET);
        assert_in_range(since_us(start_us), 5 * SECOND, 5 * SECOND + 500 * MS);
    }
}

/* ---- #9: at which rate it is ---- */

TEST(a_rate_is_followed_there_and_back)
{
    static const uint32_t bauds[] = {57600, 115200, 230400};
    for (unsigned n = 0; n != 6; n++) {
        const int32_t baud = (int32_t)bauds[n % 3];
        set(loops_us[n / 3], DEFAULTS, &bench_19200);
        for (unsigned i = 0; i != 2; i++) { /* and once more: it is so already */
            assert_int_equal(with(nine, baud), FATHOM_OK);
            assert_int_equal(bench.device->settings.baud, baud);
            COUNTED(.flash_writes = 1);
            assert_measures(1, TARGET_MM);
        }
        assert_int_equal(with(nine, 19200), FATHOM_OK);
        assert_int_equal(bench.device->settings.baud, 19200);
        assert_measures(1, TARGET_MM);
    }
}

TEST(without_confirmation_both_rates_are_asked_until_it_answers)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], DEFAULTS, &bench_19200);
        silence_from(3, 1000); /* the acknowledgement, and all after it */
        assert_int_equal(with(nine, 115200), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(bench.device->settings.baud, 115200);
        COUNTED(.flash_writes = 1);
        fathom_sim_fault_enable(&bench.fault, false);
        fathom_status_t status = FATHOM_ERR_NO_RESPONSE;
        for (unsigned i = 0; i != 4 && status < 0; i++) status = measure();
        assert_int_equal(status, FATHOM_OK);
        assert_measures(1, TARGET_MM);
        COUNTED(.flash_writes = 1);
    }
}

/* Two of one address: after the change they would answer at once. */
TEST(a_rate_at_which_another_has_the_address_is_not_given)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], DEFAULTS, &bench_19200);
        fathom_sim_device_t *const other = add_other(1);
        other->settings.baud = 57600;
        assert_int_equal(with(nine, 57600), FATHOM_ERR_IN_USE);
        COUNTED(.flash_writes = NONE);
        COUNTED_BY(other, .flash_writes = NONE);
        assert_measures(1, TARGET_MM);
    }
}

/* ---- #6: the factory reset ---- */

TEST(a_reset_device_is_followed_home)
{
    static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    for (unsigned n = 0; n != 4; n++) {
        set(loops_us[n % 2], (hps_config_t){.address = 7, .baud_code = 3, .answers_from_new = n > 1}, &fast);
        assert_measures(7, TARGET_MM);
        assert_int_equal(carry_out(six), FATHOM_OK);
        COUNTED(.resets = 1, .resets_refused = NONE);
        assert_int_equal(bench.device->address, 1);
        assert_int_equal(bench.device->settings.baud, 19200);
        assert_measures(1, TARGET_MM);
    }
}

TEST(a_reset_is_not_sent_where_another_is_at_address_1)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], (hps_config_t){.address = 7}, NULL);
        const fathom_sim_device_t *const other = add_other(1);
        assert_int_equal(carry_out(six), FATHOM_ERR_IN_USE);
        COUNTED(.resets = NONE);
        COUNTED_BY(other, .resets = NONE);
        assert_measures(7, TARGET_MM);
    }
}

TEST(a_reset_whose_confirmation_is_lost_is_unconfirmed_and_sent_once)
{
    IN_BOTH_LOOPS
    {
        set(loops_us[l], (hps_config_t){.address = 7}, NULL);
        silence_from(3, 1000);
        assert_int_equal(carry_out(six), FATHOM_ERR_UNCONFIRMED);
        COUNTED(.resets = 1);
        assert_int_equal(bench.device->address, 1);
    }
}

/* #4 is asked, and answered too late with one degree Fahrenheit, 00 01: as if it were the response to #6. */
TEST(a_late_temperature_of_1_degree_is_not_taken_for_a_reset)
{
    IN_BOTH_LOOPS
    {
        for (uint32_t late_ms = 850; late_ms <= 2350; late_ms += 100) {
            set(loops_us[l], DEFAULTS, NULL);
            bench.hps.temperature_f = 1;
            FAULT(LATE, ALWAYS, 1)->us = late_ms * MS;
            silence_from(4, 1); /* after two to #2, the response to #6 */
            const fathom_status_t first = carry_out(four);
            assert_int_equal(first, late_ms < 1000 ? FATHOM_OK : FATHOM_ERR_NO_RESPONSE);
            const fathom_status_t status = carry_out(six);
            assert_true(status == FATHOM_ERR_UNCONFIRMED || status == FATHOM_ERR_NO_RESPONSE ||
                        status == FATHOM_ERR_MALFORMED);
            assert_int_equal(bench.device->counters.resets, status == FATHOM_ERR_UNCONFIRMED);
            assert_int_equal(hps->reset_response, FATHOM_HPS167S_NO_RESET_RESPONSE);
        }
    }
}
