/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Command #9, after which the device is at another rate, now or from the next power-on. */

static fathom_status_t set_baud(void) { return fathom_hps167s_set_baud(&hps, (uint32_t)desk.argument); }

/* Table 25 */
#define RATE(unit, code, ends, baud) HPS_WRITE(unit, 0x11, code, ends, baud)

HPS_SUITE;

TEST(the_driver_follows_the_device_to_its_rate)
{
    static const uint32_t bauds[] = {57600, 115200, 230400};
    for (uint8_t i = 0; i != 3; i++) {
        const uint8_t code = (uint8_t)(i + 2);
        PLAY_AT(1, &hps_factory, (int32_t)bauds[i], set_baud, OK, IS(1, 1, 19200),
                TWO(1, SILENT, 0, bauds[i]), RATE(1, code, OK, 19200), IS(1, code, bauds[i]));
        assert_int_equal(hps.next_baud, 0);
        assert_int_equal(fake.cancelled_unit, 1);
        hps_asks(1, bauds[i]);
        hps_answers();
        desk.argument = 19200; /* and back */
        PLAY(set_baud, OK, IS(1, code, bauds[i]), TWO(1, SILENT, 0, 19200), RATE(1, 1, OK, bauds[i]),
             IS(1, 1, 19200));
        hps_asks(1, 19200);
        assert_true(hps.unit.line_settings == &hps.moved[0] || hps.unit.line_settings == &hps.moved[1]);
        hps_answers();
        desk.argument = (int32_t)bauds[i]; /* and there again */
        PLAY(set_baud, OK, IS(1, 1, 19200), TWO(1, SILENT, 0, bauds[i]), RATE(1, code, OK, 19200),
             IS(1, code, bauds[i]));
        hps_asks(1, bauds[i]);
    }
}

TEST(only_the_four_rates_are_taken_and_only_where_the_settings_are_named)
{
    static const uint32_t wrong[] = {0, 1, 2, 3, 4, 9600, 19201, 38400, 115201, 460800};
    hps_start_at(1, &hps_factory);
    for (unsigned i = 0; i != COUNT(wrong); i++)
        assert_int_equal(fathom_hps167s_set_baud(&hps, wrong[i]), FATHOM_ERR_ARGUMENT);
    hps_start_at(1, NULL);
    assert_int_equal(fathom_hps167s_set_baud(&hps, 115200), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fake.submits + fake.polls, 0);
}

/* Table 12 has no encoding of the rate: with a code that #9 does not have, where it answers says more. */
TEST(a_code_that_is_not_ours_keeps_no_rate_from_being_set_or_found)
{
    PLAY_AT(1, &hps_factory, 115200, set_baud, OK, IS(1, 0, 19200), TWO(1, SILENT, 0, 115200),
            RATE(1, 3, OK, 19200), IS(1, 0x73, 115200));
    hps_asks(1, 115200);
    hps_answers();
    desk.argument = 19200;
    PLAY(set_baud, OK, IS(1, 5, 115200), TWO(1, SILENT, 0, 19200), RATE(1, 1, OK, 115200), IS(1, 0, 19200));
    PLAY(set_baud, OK, IS(1, 0, 19200)); /* it is so already */
    PLAY_AT(1, &hps_factory, 115200, set_baud, FATHOM_ERR_DIFFERS, IS(1, 0, 19200), TWO(1, SILENT, 0, 115200),
            RATE(1, 3, OK, 19200), TWO(1, SILENT, 0, 115200), IS(1, 0, 19200));
}

/* #9: 01 is 19200, and "the others are all 19200bps"; it answers at 115200. */
TEST(only_a_code_of_9_tells_a_rate_that_waits_for_power_on)
{
    static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    PLAY_AT(1, &fast, 19200, set_baud, OK, IS(1, 1, 115200));
    assert_int_equal(hps.next_baud, 19200);
    PLAY_AT(1, &fast, 115200, set_baud, OK, IS(1, 0, 115200));
    assert_int_equal(hps.next_baud, 0);
}

TEST(a_rate_that_no_sensor_has_is_refused_and_the_next_setting_is_not_blind)
{
    hps_start_at(1, &hps_factory);
    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
    desk.argument = 9600;
    assert_int_equal(set_baud(), FATHOM_ERR_ARGUMENT);
    desk.argument = 19200;
    PLAY(set_baud, OK, IS(1, 1, 19200));
}

FOLLOWS(a_rate_that_the_port_cannot_do_is_not_set, 1, 19200, 1, &hps_factory, 230400, set_baud,
        FATHOM_ERR_UNSUPPORTED, IS(1, 1, 19200), TWO(1, FATHOM_ERR_UNSUPPORTED, 0, 230400))

/* Another device of this address at the new rate. */
FOLLOWS(a_rate_where_a_device_answers_is_in_use, 3, 19200, 3, &hps_factory, 57600, set_baud,
        FATHOM_ERR_IN_USE, IS(3, 1, 19200), IS(3, 2, 57600))

#define LATER(code, baud)                                                                                    \
    IS(1, 1, 19200), TWO(1, SILENT, 0, baud), RATE(1, code, OK, 19200), TWO(1, SILENT, 0, baud),             \
        IS(1, code, 19200)

TEST(after_power_on_both_rates_are_asked_in_turns_until_it_answers)
{
    PLAY_AT(1, &hps_factory, 115200, set_baud, OK, LATER(3, 115200));
    fathom_hps167s_power_on(&hps);
    hps_asks(1, 115200);
    hps_is_silent(FATHOM_ERR_WARMING_UP);
    fathom_hps167s_power_on(&hps); /* again */
    hps_asks(1, 19200);
    hps_is_silent(FATHOM_ERR_WARMING_UP);
    hps_asks(1, 115200);
    fake_modbus_fail(&fake, FATHOM_ERR_CHECKSUM);
    assert_int_equal(desk_poll(), FATHOM_ERR_CHECKSUM); /* by now it should be warm */
    hps_asks(1, 19200);
    fake_modbus_fail(&fake, FATHOM_ERR_CANCELLED); /* tells nothing */
    assert_int_equal(desk_poll(), FATHOM_ERR_CANCELLED);
    hps_asks(1, 19200);
    hps_answers();
    hps_asks(1, 19200);
    hps_is_silent(SILENT);
    hps_asks(1, 19200);
}

/* At the wrong rate a device that sends by itself keeps the line busy. */
TEST(after_power_on_a_busy_line_and_another_master_lead_to_the_other_rate_too)
{
    static const fathom_status_t failures[] = {FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER};
    PLAY_AT(1, &hps_factory, 115200, set_baud, OK, LATER(3, 115200));
    fathom_hps167s_power_on(&hps);
    fake.now_us += 6000000; /* past the warm-up */
    for (unsigned i = 0; i != 4; i++) {
        hps_asks(1, i % 2 == 0 ? 115200 : 19200);
        fake_modbus_fail(&fake, failures[i / 2]);
        assert_int_equal(desk_poll(), failures[i / 2]);
    }
    hps_asks(1, 115200);
    hps_answers();
}

/* The setting waits to ask where the device is, and the response to the measurement tells it. */
TEST(a_setting_goes_on_when_a_measurement_has_told_meanwhile_where_the_device_is)
{
    PLAY_AT(1, &hps_factory, 115200, set_baud, OK, LATER(3, 115200));
    fathom_hps167s_power_on(&hps);
    fake.now_us += 6000000; /* past the warm-up */
    hps_asks(1, 115200);
    desk.argument = 19200;
    assert_int_equal(set_baud(), FATHOM_PENDING);
    hps_answers();
    PLAY(set_baud, OK, IS(1, 3, 115200), TWO(1, SILENT, 0, 19200), RATE(1, 1, OK, 115200), IS(1, 1, 19200));
}

/* Whatever it says, it says it there. */
TEST(any_word_of_the_device_tells_where_it_is)
{
    for (unsigned i = 0; i != 3; i++) {
        PLAY_AT(1, &hps_factory, 115200, set_baud, OK, LATER(3, 115200));
        fathom_hps167s_power_on(&hps);
        desk_waits(3000000);
        if (i == 0) fake.now_us += 3000000; /* past the warm-up */
        if (i != 2)
            fake_modbus_refuse(&fake, 4);
        else
            fake_modbus_fail(&fake, FATHOM_ERR_MALFORMED);
        assert_int_equal(desk_poll(), i == 0   ? FATHOM_ERR_EXCEPTION
                                      : i == 1 ? FATHOM_ERR_WARMING_UP
                                               : FATHOM_ERR_MALFORMED);
        hps_asks(1, 115200);
        hps_is_silent(SILENT);
        hps_asks(1, 115200);
    }
}

/* The application was started anew: the device says 115200 and answers at 19200. */
TEST(a_rate_that_waits_for_power_on_is_known_from_the_device)
{
    PLAY_AT(1, &hps_factory, 115200, set_baud, OK, IS(1, 3, 19200));
    assert_int_equal(hps.next_baud, 115200);
    desk.argument = 19200; /* changed my mind */
    PLAY(set_baud, OK, IS(1, 3, 19200), RATE(1, 1, OK, 19200), IS(1, 1, 19200));
    assert_int_equal(hps.next_baud, 0);
    fathom_hps167s_power_on(&hps);
    hps_asks(1, 19200);
}

#define LOST                                                                                                 \
    IS(1, 1, 19200), TWO(1, SILENT, 0, 57600), RATE(1, 2, SILENT, 19200), TWO(1, SILENT, 0, 57600),          \
        TWO(1, SILENT, 0, 19200)

TEST(an_unconfirmed_rate_is_looked_for_at_both)
{
    PLAY_AT(1, &hps_factory, 57600, set_baud, FATHOM_ERR_UNCONFIRMED, LOST);
    hps_asks(1, 19200);
    hps_is_silent(SILENT);
    hps_asks(1, 57600);
    hps_answers();
    hps_asks(1, 57600);
}

/* The next setting begins with finding it. */
TEST(a_setting_waits_until_the_device_is_found)
{
    PLAY_AT(1, &hps_factory, 57600, set_baud, FATHOM_ERR_UNCONFIRMED, LOST);
    desk.argument = 230400;
    PLAY(set_baud, SILENT, HPS_1(1, SILENT, 19200));
    PLAY(set_baud, OK, HPS_1(1, OK, 57600), IS(1, 2, 57600), TWO(1, SILENT, 0, 230400), RATE(1, 4, OK, 57600),
         IS(1, 4, 230400));
    hps_asks(1, 230400);
}
