/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Command #9, after which the device is at another rate, now or from the next power-on. */

static const fathom_line_settings_t factory = {19200, FATHOM_PARITY_EVEN, 1};

static fathom_status_t set_baud(void) { return fathom_hps167s_set_baud(&desk.hps, (uint32_t)desk.argument); }

#define OK     FATHOM_READY
#define NOBODY FATHOM_ERR_NO_ANSWER

/* Tables 9, 11 and 25. */
#define ONE(unit, ends, baud)                                                                                \
    {                                                                                                        \
        {unit, 3, 0, 1, 0, 3}, ends, {0x1409, 0x1B02, 0x0100, 0}, baud                                       \
    }
#define TWO(unit, ends, code, baud)                                                                          \
    {                                                                                                        \
        {unit, 3, 0, 2, 0, 4}, ends, {0xFFFF, 0x0500, 0x0000, 0xB400 + code}, baud                           \
    }
#define IS(unit, code, baud) TWO(unit, OK, code, baud), TWO(unit, OK, code, baud)
#define RATE(unit, code, ends, baud)                                                                         \
    {                                                                                                        \
        {unit, 6, 0, 0x11, 0, code}, ends, {2}, baud                                                         \
    }

DESK_SUITE;

TEST(the_driver_follows_the_device_to_its_rate)
{
    static const uint32_t bauds[] = {57600, 115200, 230400};
    for (uint8_t i = 0; i != 3; i++) {
        const uint8_t code = (uint8_t)(i + 2);
        desk_start_at(1, &factory);
        desk.argument = (int32_t)bauds[i];
        assert_int_equal(desk_play(set_baud, ROWS(IS(1, 1, 19200), TWO(1, NOBODY, 0, bauds[i]),
                                                  RATE(1, code, OK, 19200), IS(1, code, bauds[i]))),
                         FATHOM_READY);
        assert_int_equal(desk.hps.next_baud, 0);
        assert_int_equal(desk.fake.cancelled_unit, 1);
        desk_asks(1, bauds[i]);
        desk_answers();
        desk.argument = 19200; /* and back */
        assert_int_equal(desk_play(set_baud, ROWS(IS(1, code, bauds[i]), TWO(1, NOBODY, 0, 19200),
                                                  RATE(1, 1, OK, bauds[i]), IS(1, 1, 19200))),
                         FATHOM_READY);
        desk_asks(1, 19200);
        desk_answers();
        desk.argument = (int32_t)bauds[i]; /* and there again */
        assert_int_equal(desk_play(set_baud, ROWS(IS(1, 1, 19200), TWO(1, NOBODY, 0, bauds[i]),
                                                  RATE(1, code, OK, 19200), IS(1, code, bauds[i]))),
                         FATHOM_READY);
        desk_asks(1, bauds[i]);
    }
}

TEST(only_the_four_rates_are_taken_and_only_where_the_settings_are_named)
{
    static const uint32_t wrong[] = {0, 1, 2, 3, 4, 9600, 19201, 38400, 115201, 460800};
    desk_start_at(1, &factory);
    for (unsigned i = 0; i != sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(fathom_hps167s_set_baud(&desk.hps, wrong[i]), FATHOM_ERR_ARGUMENT);
    desk_start_at(1, NULL);
    assert_int_equal(fathom_hps167s_set_baud(&desk.hps, 115200), FATHOM_ERR_ARGUMENT);
    assert_int_equal(desk.fake.submits + desk.fake.polls, 0);
}

TEST(the_rate_that_it_has_is_not_written)
{
    desk_start_at(1, &factory);
    desk.argument = 19200;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 1, 19200))), FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 0);
    desk_asks(1, 19200);
}

TEST(a_rate_that_the_port_cannot_do_is_not_set)
{
    desk_start_at(1, &factory);
    desk.argument = 230400;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 1, 19200), TWO(1, FATHOM_ERR_UNSUPPORTED, 0, 230400))),
                     FATHOM_ERR_UNSUPPORTED);
    desk_asks(1, 19200);
}

/* Another device of this address at the new rate. */
TEST(a_rate_where_somebody_answers_is_in_use)
{
    desk_start_at(3, &factory);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud, ROWS(IS(3, 1, 19200), IS(3, 2, 57600))), FATHOM_ERR_IN_USE);
    desk_asks(3, 19200);
}

#define LATER(code, baud)                                                                                    \
    IS(1, 1, 19200), TWO(1, NOBODY, 0, baud), RATE(1, code, OK, 19200), TWO(1, NOBODY, 0, baud),             \
        IS(1, code, 19200)

TEST(a_rate_from_the_next_power_on_is_asked_at_then)
{
    desk_start_at(1, &factory);
    desk.argument = 115200;
    assert_int_equal(desk_play(set_baud, ROWS(LATER(3, 115200))), FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 115200);
    desk_asks(1, 19200);
    desk_answers();
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(desk.hps.next_baud, 0);
    desk_asks(1, 115200);
    desk_answers();
    for (unsigned i = 0; i != 3; i++) { /* and it stays there */
        desk_asks(1, 115200);
        desk_is_silent(FATHOM_ERR_NO_ANSWER);
    }
}

TEST(after_power_on_both_rates_are_asked_in_turns_until_it_answers)
{
    desk_start_at(1, &factory);
    desk.argument = 115200;
    assert_int_equal(desk_play(set_baud, ROWS(LATER(3, 115200))), FATHOM_READY);
    fathom_hps167s_power_on(&desk.hps);
    desk_asks(1, 115200);
    desk_is_silent(FATHOM_ERR_WARMING_UP);
    fathom_hps167s_power_on(&desk.hps); /* again */
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_WARMING_UP);
    desk_asks(1, 115200);
    fake_modbus_fail(&desk.fake, FATHOM_ERR_CHECKSUM);
    assert_int_equal(desk_poll(), FATHOM_ERR_CHECKSUM); /* by now it should be warm */
    desk_asks(1, 19200);
    fake_modbus_fail(&desk.fake, FATHOM_ERR_CANCELLED); /* tells nothing */
    assert_int_equal(desk_poll(), FATHOM_ERR_CANCELLED);
    desk_asks(1, 19200);
    desk_answers();
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_NO_ANSWER);
    desk_asks(1, 19200);
}

/* Whatever it says, it says it there. */
TEST(any_word_of_the_device_tells_where_it_is)
{
    for (unsigned i = 0; i != 3; i++) {
        desk_start_at(1, &factory);
        desk.config.warm_up_s = 1;
        desk_start();
        desk.argument = 115200;
        assert_int_equal(desk_play(set_baud, ROWS(LATER(3, 115200))), FATHOM_READY);
        fathom_hps167s_power_on(&desk.hps);
        if (i == 0) { /* past the warm-up */
            desk.fake.now_us += 3000000;
            assert_int_equal(desk_poll(), FATHOM_PENDING);
            desk.fake.now_us += 3000000;
            fake_modbus_refuse(&desk.fake, 4);
            assert_int_equal(desk_poll(), FATHOM_ERR_EXCEPTION);
        } else if (i == 1) {
            assert_int_equal(desk_poll(), FATHOM_PENDING);
            fake_modbus_refuse(&desk.fake, 4);
            assert_int_equal(desk_poll(), FATHOM_ERR_WARMING_UP);
        } else {
            assert_int_equal(desk_poll(), FATHOM_PENDING);
            fake_modbus_fail(&desk.fake, FATHOM_ERR_MALFORMED);
            assert_int_equal(desk_poll(), FATHOM_ERR_MALFORMED);
        }
        desk_asks(1, 115200);
        desk_is_silent(FATHOM_ERR_NO_ANSWER);
        desk_asks(1, 115200);
    }
}

/* The application was started anew: the device says 115200 and answers at 19200. */
TEST(a_rate_that_waits_for_power_on_is_known_from_the_device)
{
    desk_start_at(1, &factory);
    desk.argument = 115200;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 3, 19200))), FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 115200);
    desk.argument = 19200; /* changed my mind */
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 3, 19200), RATE(1, 1, OK, 19200), IS(1, 1, 19200))),
                     FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 0);
    fathom_hps167s_power_on(&desk.hps);
    desk_asks(1, 19200);
}

#define LOST                                                                                                 \
    IS(1, 1, 19200), TWO(1, NOBODY, 0, 57600), RATE(1, 2, NOBODY, 19200), TWO(1, NOBODY, 0, 57600),          \
        TWO(1, NOBODY, 0, 19200)

TEST(an_unconfirmed_rate_is_looked_for_at_both)
{
    desk_start_at(1, &factory);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud, ROWS(LOST)), FATHOM_ERR_UNCONFIRMED);
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_NO_ANSWER);
    desk_asks(1, 57600);
    desk_answers();
    desk_asks(1, 57600);
}

/* The next setting begins with finding it. */
TEST(a_setting_waits_until_the_device_is_found)
{
    desk_start_at(1, &factory);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud, ROWS(LOST)), FATHOM_ERR_UNCONFIRMED);
    desk.argument = 230400;
    assert_int_equal(desk_play(set_baud, ROWS(ONE(1, NOBODY, 19200))), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(set_baud, ROWS(ONE(1, OK, 57600), IS(1, 2, 57600), TWO(1, NOBODY, 0, 230400),
                                              RATE(1, 4, OK, 57600), IS(1, 4, 230400))),
                     FATHOM_READY);
    desk_asks(1, 230400);
}

TEST(an_unconfirmed_code_at_the_same_rate_is_not_looked_for_elsewhere)
{
    desk_start_at(1, &factory);
    desk.argument = 19200;
    assert_int_equal(
        desk_play(set_baud, ROWS(IS(1, 3, 19200), RATE(1, 1, OK, 19200), TWO(1, NOBODY, 0, 19200))),
        FATHOM_ERR_UNCONFIRMED);
    desk_asks(1, 19200);
    desk_is_silent(FATHOM_ERR_NO_ANSWER);
    desk_asks(1, 19200);
}

TEST(another_setting_does_not_touch_the_rate_that_is_being_set)
{
    desk_start_at(1, &factory);
    assert_int_equal(fathom_hps167s_set_baud(&desk.hps, 57600), FATHOM_PENDING);
    assert_int_equal(fathom_hps167s_set_baud(&desk.hps, 115200), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_hps167s_restore_factory_settings(&desk.hps), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_hps167s_set_termination(&desk.hps, true), FATHOM_ERR_BUSY);
    fathom_hps167s_cancel(&desk.hps);
    desk.argument = 57600;
    assert_int_equal(desk_play(set_baud, ROWS(IS(1, 1, 19200), TWO(1, NOBODY, 0, 57600),
                                              RATE(1, 2, OK, 19200), IS(1, 2, 57600))),
                     FATHOM_READY);
}
