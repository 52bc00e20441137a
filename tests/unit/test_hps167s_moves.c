/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #8 and #6, after which the device is at another address, #9 has a file of its own; and hps167s_settings.h: what
 * holds after a setting that the device refused, or that was not confirmed. */

static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};

static fathom_status_t set_address(void) { return fathom_hps167s_set_address(&hps, (uint8_t)desk.argument); }
static fathom_status_t set_baud(void) { return fathom_hps167s_set_baud(&hps, (uint32_t)desk.argument); }
static fathom_status_t set_warm_up(void) { return fathom_hps167s_set_warm_up_s(&hps, 200); }
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&hps); }

#define EXCEPTION FATHOM_ERR_EXCEPTION
/* Table 23 */
#define MOVE(unit, to, ends) HPS_WRITE(unit, 0x10, to, ends, 0)

HPS_SUITE;

/* ---- #8 ---- */

TEST(the_driver_follows_the_device_to_its_address)
{
    PLAY_AT(1, NULL, 32, set_address, OK, HPS_1(1, OK, 0), HPS_1(32, SILENT, 0), MOVE(1, 32, OK),
            HPS_1(32, OK, 0));
    assert_int_equal(fake.unit_cancels, 1);
    assert_int_equal(fake.cancelled_unit, 1);
    hps_asks(32, 0);
    hps_answers();
    assert_int_equal(desk.sample.address, 32);
}

TEST(addresses_are_1_to_32)
{
    for (unsigned address = 0; address != 256; address++) {
        const fathom_status_t status = fathom_hps167s_set_address(&hps, (uint8_t)address);
        assert_int_equal(status, address == 0 || address > 32 ? FATHOM_ERR_ARGUMENT : FATHOM_PENDING);
        fathom_hps167s_cancel(&hps);
        fake.submits = 0;
        fake.now_us += 20000;
    }
}

FOLLOWS(an_address_where_a_device_answers_is_in_use, 1, 0, 1, NULL, 5, set_address, FATHOM_ERR_IN_USE,
        HPS_1(1, OK, 0), HPS_1(5, OK, 0))

/* It may acknowledge from the new address, where no device was asked. */
FOLLOWS(an_acknowledgement_from_the_new_address_is_as_good, 5, 0, 1, NULL, 5, set_address, OK,
        HPS_1(1, OK, 0), HPS_1(5, SILENT, 0), MOVE(1, 5, SILENT), HPS_1(5, OK, 0))

FOLLOWS(a_device_that_answers_at_neither_address_is_unconfirmed, 1, 0, 1, NULL, 5, set_address,
        FATHOM_ERR_UNCONFIRMED, HPS_1(1, OK, 0), HPS_1(5, SILENT, 0), MOVE(1, 5, OK), HPS_1(5, SILENT, 0),
        HPS_1(1, SILENT, 0))

/* ---- #6 ---- */

TEST(a_reset_device_is_followed_to_19200)
{
    PLAY_AT(7, &fast, 0, reset, OK, IS(7, 3, 115200), TWO(1, SILENT, 0, 19200), HPS_6(7, OK, 1, 115200),
            IS(1, 1, 19200));
    assert_int_equal(hps.next_baud, 0);
    hps_asks(1, 19200);
    PLAY_AT(1, &fast, 0, reset, OK, IS(1, 3, 115200), TWO(1, SILENT, 0, 19200), HPS_6(1, OK, 1, 115200),
            IS(1, 1, 19200));
    hps_asks(1, 19200);
}

TEST(a_reset_whose_rate_waits_for_power_on_is_followed_then)
{
    PLAY_AT(1, &fast, 0, reset, OK, IS(1, 3, 115200), TWO(1, SILENT, 0, 19200), HPS_6(1, OK, 1, 115200),
            TWO(1, SILENT, 0, 19200), IS(1, 1, 115200));
    assert_int_equal(hps.next_baud, 19200);
    hps_asks(1, 115200);
    fathom_hps167s_power_on(&hps);
    hps_asks(1, 19200);
}

TEST(no_other_device_may_be_at_address_1)
{
    PLAY_AT(7, NULL, 0, reset, FATHOM_ERR_IN_USE, IS(7, 1, 0), IS(1, 1, 0));
    assert_int_equal(hps.reset_response, FATHOM_HPS167S_NO_RESET_RESPONSE);
    hps_asks(7, 0);
}

TEST(a_reset_without_a_response_shows_in_where_the_device_is)
{
    PLAY_AT(7, NULL, 0, reset, OK, IS(7, 1, 0), TWO(1, SILENT, 0, 0), HPS_6(7, SILENT, 0, 0), IS(1, 1, 0));
    hps_asks(1, 0);
    PLAY_AT(7, NULL, 0, reset, SILENT, IS(7, 1, 0), TWO(1, SILENT, 0, 0), HPS_6(7, SILENT, 0, 0),
            TWO(1, SILENT, 0, 0), IS(7, 1, 0));
    hps_asks(7, 0);
    PLAY_AT(7, NULL, 0, reset, FATHOM_ERR_UNCONFIRMED, IS(7, 1, 0), TWO(1, SILENT, 0, 0),
            HPS_6(7, SILENT, 0, 0), TWO(1, SILENT, 0, 0), TWO(7, SILENT, 0, 0));
    hps_asks(7, 0);
}

FOLLOWS(a_reset_without_a_response_shows_in_its_rate_too, 1, 19200, 1, &fast, 0, reset, OK, IS(1, 3, 115200),
        TWO(1, SILENT, 0, 19200), HPS_6(1, SILENT, 0, 115200), IS(1, 1, 19200))

/* It is where it was, which shows nothing. */
TEST(a_reset_without_a_response_at_address_1_is_unconfirmed)
{
    PLAY_AT(1, NULL, 0, reset, FATHOM_ERR_UNCONFIRMED, IS(1, 1, 0), HPS_6(1, SILENT, 0, 0), IS(1, 1, 0));
    PLAY_AT(1, &fast, 0, reset, FATHOM_ERR_UNCONFIRMED, IS(1, 3, 115200), TWO(1, SILENT, 0, 19200),
            HPS_6(1, SILENT, 0, 115200), TWO(1, SILENT, 0, 19200), IS(1, 3, 115200));
}

TEST(a_reset_is_never_retried_and_can_be_done_again)
{
    hps_config.modbus.retries = desk.retries = 2;
    hps_start();
    for (unsigned times = 0; times != 2; times++)
        PLAY(reset, OK, IS(1, 1, 0), HPS_6(1, OK, 1, 0), IS(1, 1, 0));
}

/* ---- refused or unconfirmed ---- */

/* Responses to #2 with this warm-up and the code of the rate; and two that agree. */
#define TWO_OF(unit, ends, warm_up, code, baud)                                                              \
    HPS_2(unit, ends, baud, 0xFFFF, (warm_up)*256u, 0x0000, 0xB400 + code)
#define IS_OF(unit, warm_up, code, baud)                                                                     \
    TWO_OF(unit, OK, warm_up, code, baud), TWO_OF(unit, OK, warm_up, code, baud)

/* Until when is silence no error? Of warm_up_s seconds and one time-out of 500 ms. */
static void assert_warm_up(uint32_t warm_up_s)
{
    fathom_hps167s_power_on(&hps);
    PENDS(desk_poll());
    fake.now_us += warm_up_s * 1000000u + 499999;
    hps_is_silent(FATHOM_ERR_WARMING_UP);
    fathom_hps167s_power_on(&hps);
    PENDS(desk_poll());
    fake.now_us += warm_up_s * 1000000u + 500000;
    hps_is_silent(SILENT);
}

/* #9: "sensor->next_baud is not 0, and fathom_hps167s_power_on moves the driver": only where the device says so. */
TEST(after_a_baud_rate_that_was_refused_power_on_moves_nothing)
{
    PLAY_AT(1, &hps_factory, 115200, set_baud, FATHOM_ERR_EXCEPTION, IS_OF(1, 5, 1, 19200),
            TWO_OF(1, SILENT, 5, 1, 115200), HPS_WRITE(1, 0x11, 3, EXCEPTION, 19200));
    assert_int_equal(hps.next_baud, 0);
    fathom_hps167s_power_on(&hps);
    hps_asks(1, 19200);
    hps_is_silent(FATHOM_ERR_WARMING_UP);
    hps_asks(1, 19200);
}

/* The same where it is not: "from now on the driver asks at both in turns until it is answered", and no setting begins
 * before, the factory reset least of all. */
TEST(nothing_is_reset_before_a_device_that_is_sought_has_answered)
{
    PLAY_AT(1, &hps_factory, 57600, set_baud, FATHOM_ERR_UNCONFIRMED, IS_OF(1, 5, 1, 19200),
            TWO_OF(1, SILENT, 5, 1, 57600), HPS_WRITE(1, 0x11, 2, SILENT, 19200),
            TWO_OF(1, SILENT, 5, 1, 57600), TWO_OF(1, SILENT, 5, 1, 19200));
    PLAY(reset, SILENT, HPS_1(1, SILENT, 19200));
    PLAY(reset, OK, HPS_1(1, OK, 57600), IS_OF(1, 5, 2, 57600), TWO_OF(1, SILENT, 5, 1, 19200),
         HPS_6(1, OK, 1, 57600), IS_OF(1, 5, 1, 19200));
    hps_asks(1, 19200);
}

/* Address 1 at 19200 is probed if the device is elsewhere: it is not elsewhere by now. */
TEST(a_device_that_was_moved_to_address_1_is_reset_without_looking_there)
{
    PLAY_AT(7, NULL, 1, set_address, OK, HPS_1(7, OK, 0), HPS_1(1, SILENT, 0), HPS_WRITE(7, 0x10, 1, OK, 0),
            HPS_1(1, OK, 0));
    PLAY(reset, OK, IS_OF(1, 5, 1, 0), HPS_6(1, OK, 1, 0), IS_OF(1, 5, 1, 0));
}

/* The rate is the one that the driver is at, so there is no other one to look for it. */
TEST(after_an_unconfirmed_code_of_the_same_rate_the_next_setting_looks_for_no_device)
{
    PLAY_AT(1, &hps_factory, 19200, set_baud, FATHOM_ERR_UNCONFIRMED, IS_OF(1, 5, 3, 19200),
            HPS_WRITE(1, 0x11, 1, OK, 19200), TWO_OF(1, SILENT, 5, 1, 19200));
    PLAY(set_warm_up, OK, IS_OF(1, 200, 1, 19200));
}

/* #6: "it refused". Nothing of the factory's holds then. */
TEST(after_a_reset_that_was_refused_rate_and_warm_up_are_as_before)
{
    hps_start_at(1, &fast);
    hps_config.warm_up_s = 9;
    hps_start();
    PLAY(reset, FATHOM_ERR_EXCEPTION, IS_OF(1, 9, 3, 115200), TWO_OF(1, SILENT, 9, 1, 19200),
         HPS_6(1, EXCEPTION, 4, 115200));
    assert_int_equal(hps.next_baud, 0);
    assert_warm_up(9);
    hps_asks(1, 115200);
}

/* Its own error code stays in reset_response; that is not the next setting's. */
TEST(after_a_reset_that_was_refused_other_settings_can_be_made)
{
    PLAY(reset, FATHOM_ERR_EXCEPTION, IS_OF(1, 5, 1, 0), HPS_6(1, OK, 2, 0));
    assert_int_equal(hps.reset_response, 2);
    PLAY(set_warm_up, OK, IS_OF(1, 5, 1, 0), HPS_WRITE(1, 0x0A, 200, OK, 0), IS_OF(1, 200, 1, 0));
    assert_warm_up(200);
}

TEST(an_address_is_not_set_while_another_setting_is_in_progress)
{
    assert_int_equal(fathom_hps167s_set_warm_up_s(&hps, 5), FATHOM_PENDING);
    assert_int_equal(fathom_hps167s_set_address(&hps, 7), FATHOM_ERR_BUSY);
}
