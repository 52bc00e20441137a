/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #8 and #6, after which the device is at another address. #9 has a file of its own. */

static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};

static fathom_status_t set_address(void) { return fathom_hps167s_set_address(&hps, (uint8_t)desk.argument); }
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
