/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #8 and #6, after which the device is at another address. #9 has a file of its own. */

static const fathom_line_settings_t factory = {19200, FATHOM_PARITY_EVEN, 1};
static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};

static fathom_status_t set_address(void)
{
    return fathom_hps167s_set_address(&desk.hps, (uint8_t)desk.argument);
}
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&desk.hps); }

#define OK        FATHOM_READY
#define NOBODY    FATHOM_ERR_NO_ANSWER
#define EXCEPTION FATHOM_ERR_EXCEPTION

/* Tables 9, 11, 19 and 23. */
#define ONE(unit, ends, baud)                                                                                \
    {                                                                                                        \
        {unit, 3, 0, 1, 0, 3}, ends, {0x1409, 0x1B02, 0x0100, 0}, baud                                       \
    }
#define TWO(unit, ends, code, baud)                                                                          \
    {                                                                                                        \
        {unit, 3, 0, 2, 0, 4}, ends, {0xFFFF, 0x0500, 0x0000, 0xB400 + code}, baud                           \
    }
#define IS(unit, code, baud) TWO(unit, OK, code, baud), TWO(unit, OK, code, baud)
#define MOVE(unit, to, ends)                                                                                 \
    {                                                                                                        \
        {unit, 6, 0, 0x10, 0, to}, ends, {2}, 0                                                              \
    }
#define RESET(unit, ends, says, baud)                                                                        \
    {                                                                                                        \
        {unit, 3, 0, 9, 0, 1}, ends, {says}, baud                                                            \
    }

DESK_SUITE;

/* ---- #8 ---- */

TEST(the_driver_follows_the_device_to_its_address)
{
    desk_start();
    desk.argument = 32;
    assert_int_equal(
        desk_play(set_address, ROWS(ONE(1, OK, 0), ONE(32, NOBODY, 0), MOVE(1, 32, OK), ONE(32, OK, 0))),
        FATHOM_READY);
    assert_int_equal(desk.fake.unit_cancels, 1);
    assert_int_equal(desk.fake.cancelled_unit, 1);
    desk_asks(32, 0);
    desk_answers();
    assert_int_equal(desk.sample.unit, 32);
}

TEST(addresses_are_1_to_32)
{
    desk_start();
    for (unsigned address = 0; address != 256; address++) {
        const fathom_status_t status = fathom_hps167s_set_address(&desk.hps, (uint8_t)address);
        assert_int_equal(status, address == 0 || address > 32 ? FATHOM_ERR_ARGUMENT : FATHOM_PENDING);
        fathom_hps167s_cancel(&desk.hps);
        desk.fake.submits = 0;
        desk.fake.now_us += 20000;
    }
}

TEST(the_address_that_it_has_is_not_written)
{
    desk_start();
    desk.argument = 1;
    assert_int_equal(desk_play(set_address, ROWS(ONE(1, OK, 0))), FATHOM_READY);
}

TEST(an_address_where_somebody_answers_is_in_use)
{
    desk_start();
    desk.argument = 5;
    assert_int_equal(desk_play(set_address, ROWS(ONE(1, OK, 0), ONE(5, OK, 0))), FATHOM_ERR_IN_USE);
    desk_asks(1, 0);
}

/* It may acknowledge from the new address, where nobody was asked. */
TEST(an_acknowledgement_from_the_new_address_is_as_good)
{
    desk_start();
    desk.argument = 5;
    assert_int_equal(
        desk_play(set_address, ROWS(ONE(1, OK, 0), ONE(5, NOBODY, 0), MOVE(1, 5, NOBODY), ONE(5, OK, 0))),
        FATHOM_READY);
    desk_asks(5, 0);
}

TEST(a_device_that_answers_at_neither_address_is_unconfirmed)
{
    desk_start();
    desk.argument = 5;
    assert_int_equal(desk_play(set_address, ROWS(ONE(1, OK, 0), ONE(5, NOBODY, 0), MOVE(1, 5, OK),
                                                 ONE(5, NOBODY, 0), ONE(1, NOBODY, 0))),
                     FATHOM_ERR_UNCONFIRMED);
    desk_asks(1, 0);
}

/* ---- #6 ---- */

TEST(a_reset_device_is_followed_to_address_1)
{
    desk_start_at(7, NULL);
    assert_int_equal(
        desk_play(reset, ROWS(IS(7, 1, 0), TWO(1, NOBODY, 0, 0), RESET(7, OK, 1, 0), IS(1, 1, 0))),
        FATHOM_READY);
    assert_int_equal(desk.hps.reset_answer, 1);
    assert_int_equal(desk.fake.cancelled_unit, 7);
    desk_asks(1, 0);
}

TEST(a_reset_device_is_followed_to_19200)
{
    desk_start_at(7, &fast);
    assert_int_equal(desk_play(reset, ROWS(IS(7, 3, 115200), TWO(1, NOBODY, 0, 19200),
                                           RESET(7, OK, 1, 115200), IS(1, 1, 19200))),
                     FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 0);
    desk_asks(1, 19200);
    desk_start_at(1, &fast);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 3, 115200), TWO(1, NOBODY, 0, 19200),
                                           RESET(1, OK, 1, 115200), IS(1, 1, 19200))),
                     FATHOM_READY);
    desk_asks(1, 19200);
}

TEST(where_it_is_at_home_already_its_word_and_a_reading_are_enough)
{
    desk_start_at(1, &factory);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 1, 19200), RESET(1, OK, 1, 19200), IS(1, 1, 19200))),
                     FATHOM_READY);
    desk_asks(1, 19200);
    desk_start_at(1, &factory);
    assert_int_equal(
        desk_play(reset, ROWS(IS(1, 1, 19200), RESET(1, OK, 1, 19200), TWO(1, NOBODY, 0, 19200))),
        FATHOM_ERR_UNCONFIRMED);
}

TEST(a_reset_whose_rate_waits_for_power_on_is_followed_then)
{
    desk_start_at(1, &fast);
    assert_int_equal(
        desk_play(reset, ROWS(IS(1, 3, 115200), TWO(1, NOBODY, 0, 19200), RESET(1, OK, 1, 115200),
                              TWO(1, NOBODY, 0, 19200), IS(1, 1, 115200))),
        FATHOM_READY);
    assert_int_equal(desk.hps.next_baud, 19200);
    desk_asks(1, 115200);
    fathom_hps167s_power_on(&desk.hps);
    desk_asks(1, 19200);
}

TEST(nobody_else_may_be_at_address_1)
{
    desk_start_at(7, NULL);
    assert_int_equal(desk_play(reset, ROWS(IS(7, 1, 0), IS(1, 1, 0))), FATHOM_ERR_IN_USE);
    assert_int_equal(desk.hps.reset_answer, FATHOM_HPS167S_NO_RESET_ANSWER);
    desk_asks(7, 0);
}

/* Table 20: "otherwise an error code will be returned". */
TEST(the_devices_own_error_code_is_kept)
{
    static const uint16_t codes[] = {0, 2, 0x00FF, 0x0100};
    for (unsigned i = 0; i != 4; i++) {
        desk_start_at(7, NULL);
        assert_int_equal(desk_play(reset, ROWS(IS(7, 1, 0), TWO(1, NOBODY, 0, 0), RESET(7, OK, codes[i], 0))),
                         FATHOM_ERR_EXCEPTION);
        assert_int_equal(desk.hps.reset_answer, codes[i]);
        desk_asks(7, 0);
        desk_start_at(1, NULL);
        assert_int_equal(desk_play(reset, ROWS(IS(1, 1, 0), RESET(1, OK, codes[i], 0))),
                         FATHOM_ERR_EXCEPTION);
        assert_int_equal(desk.hps.reset_answer, codes[i]);
    }
}

TEST(a_modbus_exception_is_told_from_that)
{
    desk_start_at(1, NULL);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 1, 0), RESET(1, EXCEPTION, 4, 0))), FATHOM_ERR_EXCEPTION);
    assert_int_equal(desk.hps.reset_answer, FATHOM_HPS167S_NO_RESET_ANSWER);
    assert_int_equal(desk.hps.unit.request.message.exception, 4);
}

TEST(a_reset_without_an_answer_shows_in_where_the_device_is)
{
    desk_start_at(7, NULL);
    assert_int_equal(
        desk_play(reset, ROWS(IS(7, 1, 0), TWO(1, NOBODY, 0, 0), RESET(7, NOBODY, 0, 0), IS(1, 1, 0))),
        FATHOM_READY);
    desk_asks(1, 0);
    desk_start_at(7, NULL);
    assert_int_equal(desk_play(reset, ROWS(IS(7, 1, 0), TWO(1, NOBODY, 0, 0), RESET(7, NOBODY, 0, 0),
                                           TWO(1, NOBODY, 0, 0), IS(7, 1, 0))),
                     FATHOM_ERR_NO_ANSWER);
    desk_asks(7, 0);
    desk_start_at(7, NULL);
    assert_int_equal(desk_play(reset, ROWS(IS(7, 1, 0), TWO(1, NOBODY, 0, 0), RESET(7, NOBODY, 0, 0),
                                           TWO(1, NOBODY, 0, 0), TWO(7, NOBODY, 0, 0))),
                     FATHOM_ERR_UNCONFIRMED);
    desk_asks(7, 0);
}

TEST(a_reset_without_an_answer_shows_in_its_rate_too)
{
    desk_start_at(1, &fast);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 3, 115200), TWO(1, NOBODY, 0, 19200),
                                           RESET(1, NOBODY, 0, 115200), IS(1, 1, 19200))),
                     FATHOM_READY);
    desk_asks(1, 19200);
}

/* It is where it was, which shows nothing. */
TEST(a_reset_without_an_answer_at_address_1_is_unconfirmed)
{
    desk_start_at(1, NULL);
    assert_int_equal(desk_play(reset, ROWS(IS(1, 1, 0), RESET(1, NOBODY, 0, 0), IS(1, 1, 0))),
                     FATHOM_ERR_UNCONFIRMED);
    desk_start_at(1, &fast);
    assert_int_equal(
        desk_play(reset, ROWS(IS(1, 3, 115200), TWO(1, NOBODY, 0, 19200), RESET(1, NOBODY, 0, 115200),
                              TWO(1, NOBODY, 0, 19200), IS(1, 3, 115200))),
        FATHOM_ERR_UNCONFIRMED);
}

TEST(a_device_that_is_not_there_is_not_reset)
{
    desk_start_at(1, NULL);
    desk.config.retries = 2;
    desk_start();
    assert_int_equal(desk_play(reset, ROWS(TWO(1, NOBODY, 0, 0))), FATHOM_ERR_NO_ANSWER);
}

TEST(a_reset_is_never_retried_and_can_be_done_again)
{
    desk_start_at(1, NULL);
    desk.config.retries = 2;
    desk_start();
    for (unsigned times = 0; times != 2; times++) {
        unsigned resets = 0;
        fathom_status_t status = FATHOM_PENDING;
        for (unsigned i = 0; i != 500 && status == FATHOM_PENDING; i++) {
            static const uint16_t told[] = {0xFFFF, 0x0500, 0x0000, 0xB401}, done[] = {1};
            desk.fake.now_us += desk.step_us;
            status = reset();
            if (desk.fake.request == NULL || desk.fake.ends != FATHOM_PENDING) continue;
            const bool is_reset = desk.fake.request->message.head[3] == 9;
            resets += is_reset;
            assert_int_equal(desk.fake.request->exchange.retries, is_reset ? 0 : 2);
            fake_modbus_answer(&desk.fake, is_reset ? done : told, is_reset ? 1 : 4);
        }
        assert_int_equal(status, FATHOM_READY);
        assert_int_equal(resets, 1);
    }
}
