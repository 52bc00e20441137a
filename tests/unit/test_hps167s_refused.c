/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* hps167s_settings.h: what holds after a setting that the device refused, or that was not confirmed. */

static const fathom_line_settings_t factory = {19200, FATHOM_PARITY_EVEN, 1};
static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};

static fathom_status_t set_baud(void) { return fathom_hps167s_set_baud(&desk.hps, (uint32_t)desk.argument); }
static fathom_status_t set_warm_up(void) { return fathom_hps167s_set_warm_up_s(&desk.hps, 200); }
static fathom_status_t set_address_1(void) { return fathom_hps167s_set_address(&desk.hps, 1); }
static fathom_status_t set_reconnect(void)
{
    return fathom_hps167s_set_reconnect_time_ms(&desk.hps, (uint32_t)desk.argument);
}
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&desk.hps); }

#define OK        FATHOM_READY
#define SILENT    FATHOM_ERR_NO_ANSWER
#define EXCEPTION FATHOM_ERR_EXCEPTION

/* Tables 9, 11, 19, 21, 23 and 25. */
#define ONE(unit, ends, baud)                                                                                \
    {                                                                                                        \
        {unit, 3, 0, 1, 0, 3}, ends, {0x1409, 0x1B02, 0x0100, 0}, baud                                       \
    }
#define TWO(unit, ends, warm_up, code, baud)                                                                 \
    {                                                                                                        \
        {unit, 3, 0, 2, 0, 4}, ends, {0xFFFF, warm_up * 256u, 0x0000, 0xB400 + code}, baud                   \
    }
#define IS(unit, warm_up, code, baud) TWO(unit, OK, warm_up, code, baud), TWO(unit, OK, warm_up, code, baud)
#define WRITE(unit, command, value, ends, baud)                                                              \
    {                                                                                                        \
        {unit, 6, 0, command, 0, value}, ends, {2}, baud                                                     \
    }
#define RESET(unit, ends, says, baud)                                                                        \
    {                                                                                                        \
        {unit, 3, 0, 9, 0, 1}, ends, {says}, baud                                                            \
    }

/* Until when is silence no error? Of warm_up_s seconds and one time-out of 500 ms. */
static void assert_warm_up(uint32_t warm_up_s)
{
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    desk.fake.now_us += warm_up_s * 1000000u + 499999;
    desk_is_silent(FATHOM_ERR_WARMING_UP);
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    desk.fake.now_us += warm_up_s * 1000000u + 500000;
    desk_is_silent(FATHOM_ERR_NO_ANSWER);
}

DESK_SUITE;

/* #7: "fathom_hps167s_power_on then counts with it": with what the device has. */
TEST(a_warm_up_that_was_refused_does_not_count)
{
    desk_start();
    assert_int_equal(desk_play(set_warm_up, ROWS(IS(1, 5, 1, 0), WRITE(1, 0x0A, 200, EXCEPTION, 0))),
                     FATHOM_ERR_EXCEPTION);
    assert_warm_up(5);
}

/* #9: "sensor->next_baud is not 0, and fathom_hps167s_power_on moves the driver": only where the device says so. */
TEST(after_a_baud_rate_that_was_refused_power_on_moves_nothing)
{
    desk_start_at(1, &factory);
    desk.argument = 115200;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 5, 1, 19200), TWO(1, SILENT, 5, 1, 115200),
                                              WRITE(1, 0x11, 3, EXCEPTION, 19200))),
                     FATHOM_ERR_EXCEPTION);
    assert_int_equal(desk.hps.next_baud, 0);
    fathom_hps167s_power_on(&desk.hps);
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_WARMING_UP);
    desk_asks(1, 19200);
}

/* The rate is the one that the driver is at, so there is no other one to look for it. */
TEST(after_an_unconfirmed_code_of_the_same_rate_the_next_setting_does_not_look_elsewhere)
{
    desk_start_at(1, &factory);
    desk.argument = 19200;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 5, 3, 19200), WRITE(1, 0x11, 1, OK, 19200),
                                              TWO(1, SILENT, 5, 1, 19200))),
                     FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(desk_play(set_warm_up, ROWS(IS(1, 200, 1, 19200))), FATHOM_READY);
}

/* The same where it is not: "from now on the driver asks at both in turns until it is answered", and no setting begins
 * before, the factory reset least of all. */
TEST(nothing_is_reset_before_a_device_that_is_sought_has_answered)
{
    desk_start_at(1, &factory);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 5, 1, 19200), TWO(1, SILENT, 5, 1, 57600),
                                              WRITE(1, 0x11, 2, SILENT, 19200), TWO(1, SILENT, 5, 1, 57600),
                                              TWO(1, SILENT, 5, 1, 19200))),
                     FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(desk_play(reset, ROWS(ONE(1, SILENT, 19200))), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(reset, ROWS(ONE(1, OK, 57600), IS(1, 5, 2, 57600), TWO(1, SILENT, 5, 1, 19200),
                                           RESET(1, OK, 1, 57600), IS(1, 5, 1, 19200))),
                     FATHOM_READY);
    desk_asks(1, 19200);
}

/* #6: "it refused". Nothing of the factory's holds then. */
TEST(after_a_reset_that_was_refused_rate_and_warm_up_are_as_before)
{
    desk_start_at(1, &fast);
    desk.config.warm_up_s = 9;
    desk_start();
    assert_int_equal(desk_play(reset, ROWS(IS(1, 9, 3, 115200), TWO(1, SILENT, 9, 1, 19200),
                                           RESET(1, EXCEPTION, 4, 115200))),
                     FATHOM_ERR_EXCEPTION);
    assert_int_equal(desk.hps.next_baud, 0);
    assert_warm_up(9);
    desk_asks(1, 115200);
}

/* Its own error code stays in reset_answer; that is not the next setting's. */
TEST(after_a_reset_that_was_refused_other_settings_can_be_made)
{
    desk_start();
    assert_int_equal(desk_play(reset, ROWS(IS(1, 5, 1, 0), RESET(1, OK, 2, 0))), FATHOM_ERR_EXCEPTION);
    assert_int_equal(desk.hps.reset_answer, 2);
    assert_int_equal(
        desk_play(set_warm_up, ROWS(IS(1, 5, 1, 0), WRITE(1, 0x0A, 200, OK, 0), IS(1, 200, 1, 0))),
        FATHOM_READY);
    assert_warm_up(200);
}

/* "if the device is elsewhere, address 1 at 19200 is asked": it is not elsewhere by now. */
TEST(a_device_that_was_moved_to_address_1_is_reset_without_looking_there)
{
    desk_start_at(7, NULL);
    assert_int_equal(desk_play(set_address_1, ROWS(ONE(7, OK, 0), ONE(1, SILENT, 0), WRITE(7, 0x10, 1, OK, 0),
                                                   ONE(1, OK, 0))),
                     FATHOM_READY);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 5, 1, 0), RESET(1, OK, 1, 0), IS(1, 5, 1, 0))),
                     FATHOM_READY);
}

/* The same where another caller has asked #2 and left its outcome, which the first call of the reset then takes. */
TEST(it_is_not_looked_for_either_when_the_configuration_has_been_answered_before)
{
    static const uint16_t is[4] = {0xFFFF, 0x0500, 0x0000, 0xB401};
    fathom_hps167s_configuration_t configuration;
    desk_start_at(7, NULL);
    assert_int_equal(desk_play(set_address_1, ROWS(ONE(7, OK, 0), ONE(1, SILENT, 0), WRITE(7, 0x10, 1, OK, 0),
                                                   ONE(1, OK, 0))),
                     FATHOM_READY);
    for (unsigned n = 0; n != 2; n++) {
        assert_int_equal(fathom_hps167s_configuration(&desk.hps, &configuration), FATHOM_PENDING);
        desk.fake.now_us += 20000;
        assert_int_equal(fathom_hps167s_configuration(&desk.hps, &configuration), FATHOM_PENDING);
        fake_modbus_answer(&desk.fake, is, 4);
    }
    assert_int_equal(desk_play(reset, ROWS(RESET(1, OK, 1, 0), IS(1, 5, 1, 0))), FATHOM_READY);
}

/* #9: "from now on the driver asks at both in turns": also where the port breaks before the old rate could be asked. */
static fathom_status_t set_baud_until_the_port_breaks(void)
{
    if (desk.fake.ends == FATHOM_ERR_PORT) desk.fake.carrier = FATHOM_ERR_PORT;
    return set_baud();
}

TEST(a_device_is_sought_at_both_rates_when_the_port_breaks_while_the_new_one_is_confirmed)
{
    desk_start_at(1, &factory);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud_until_the_port_breaks,
                               ROWS(IS(1, 5, 1, 19200), TWO(1, SILENT, 5, 1, 57600),
                                    WRITE(1, 0x11, 2, OK, 19200), TWO(1, FATHOM_ERR_PORT, 5, 1, 57600))),
                     FATHOM_ERR_UNCONFIRMED);
    desk.fake.carrier = FATHOM_PENDING;
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_NO_ANSWER);
    desk_asks(1, 57600);
    desk_answers();
}

/* #15. 01000008 hexadecimal = 16777224 = 18 * 932068. */
TEST(a_reconnect_time_of_four_bytes_is_written_with_all_of_them)
{
    desk_start();
    desk.argument = 16777224;
    assert_int_equal(
        desk_play(set_reconnect, ROWS(IS(1, 5, 1, 0), {{1, 0x10, 0, 0x20, 0, 2}, OK, {0x0100, 0x0008}, 0},
                                      {{1, 3, 0, 2, 0, 4}, OK, {0xFFFF, 0x0501, 0x0000, 0x0801}, 0},
                                      {{1, 3, 0, 2, 0, 4}, OK, {0xFFFF, 0x0501, 0x0000, 0x0801}, 0})),
        FATHOM_READY);
}
