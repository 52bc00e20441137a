/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #7 and #10 to #15: what stays where it is. */

static fathom_status_t warm_up(void) { return fathom_hps167s_set_warm_up_s(&hps, (uint8_t)desk.argument); }
static fathom_status_t measures(void)
{
    return fathom_hps167s_set_measures_after_power_on(&hps, desk.argument != 0);
}
static fathom_status_t termination(void) { return fathom_hps167s_set_termination(&hps, desk.argument != 0); }
static fathom_status_t reconnect(void)
{
    return fathom_hps167s_set_reconnect_time_ms(&hps, (uint32_t)desk.argument);
}
static fathom_status_t offset(void)
{
    return fathom_hps167s_set_distance_offset_mm(&hps, (int16_t)desk.argument);
}
static fathom_status_t filter(void)
{
    return fathom_hps167s_set_filter_sensitivity(&hps, (int16_t)desk.argument);
}
static fathom_status_t load_user(void) { return fathom_hps167s_load_user_settings(&hps); }
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&hps); }
static fathom_status_t address(void) { return fathom_hps167s_set_address(&hps, (uint8_t)desk.argument); }
static fathom_status_t load_factory(void) { return fathom_hps167s_load_factory_settings(&hps); }

#define ASK_1    HPS_1(1, OK, 0)
#define FAILS(s) HPS_2(1, s, 0, 0)
/* Tables 21, 27 and 29; table 37. */
#define PUTS(address, value, ends) HPS_WRITE(1, address, value, ends, 0)
#define RECONNECT(high, low)                                                                                 \
    {                                                                                                        \
        {1, 0x10, 0, 0x20, 0, 2}, OK, {high, low}, 0                                                         \
    }

/* ---- with read-back ---- */

static const struct {
    fathom_status_t (*set)(void);
    int32_t value;
    uint16_t after[4];
} changes[] = {
    {warm_up, 9, {0xFFFF, 0x0900, 0x0000, 0xB401}},
    {warm_up, 255, {0xFFFF, 0xFF00, 0x0000, 0xB401}},
    {warm_up, 0, {0xFFFF, 0x0000, 0x0000, 0xB401}},
    {measures, 0, {0xFF00, 0x0500, 0x0000, 0xB401}},
    {termination, 0, {0x00FF, 0x0500, 0x0000, 0xB401}},
    {reconnect, 0, {0xFFFF, 0x0500, 0x0000, 0x0001}},
    /* 65556 = 18 * 3642 = 0001 0014 */
    {reconnect, 65556, {0xFFFF, 0x0500, 0x0100, 0x1401}},
};

HPS_SUITE;

TEST(a_new_driver_has_written_nothing_and_had_no_response_to_a_reset_whatever_stood_in_the_memory)
{
    hps.unit.is_written = true;
    hps.reset_response = 0;
    hps_start();
    assert_false(fathom_hps167s_is_written(&hps));
    assert_int_equal(hps.reset_response, FATHOM_HPS167S_NO_RESET_RESPONSE);
    assert_int_equal(hps.reset_response, 0xFFFF);
}

TEST(what_is_so_already_is_not_written)
{
    for (unsigned i = 0; i != COUNT(changes); i++) {
        const uint16_t *const r = changes[i].after;
        hps_set_up(NULL);
        desk.argument = changes[i].value;
        PLAY(changes[i].set, OK, TELLS(r[0], r[1], r[2], r[3]));
    }
}

TEST(the_reconnect_time_goes_with_its_low_word_first_as_an_option)
{
    hps_config.low_word_first = true;
    hps_start();
    desk.argument = 65556;
    PLAY(reconnect, OK, TELLS(0xFFFF, 0x0500, 0x1200, 0x0001), /* 18 ms */
         RECONNECT(20, 1), TELLS(0xFFFF, 0x0500, 0x1400, 0x0101));
}

TEST(a_write_is_not_retried_and_the_readings_are)
{
    hps_config.modbus.retries = desk.retries = 3;
    hps_start();
    desk.timeout_us = 1000000;
    desk.argument = 9;
    PLAY(warm_up, OK, FACTORY, PUTS(0x0A, 9, OK), TELLS(0xFFFF, 0x0900, 0x0000, 0xB401));
}

/* modbus_setting.h, 1: where one was written and did not read so, that is no word of another. */
TEST(a_value_that_did_not_show_is_doubted_until_it_is_set_and_no_other_is)
{
    desk.argument = 9;
    PLAY(warm_up, FATHOM_ERR_DIFFERS, FACTORY, PUTS(0x0A, 9, OK), FACTORY);
    desk.argument = 0;
    PLAY(measures, FATHOM_ERR_DIFFERS, FACTORY, PUTS(0x12, 0, OK), FACTORY);
    desk.argument = 1;
    PLAY(termination, OK, FACTORY);
    desk.argument = 0;
    PLAY(termination, OK, FACTORY, PUTS(0x13, 0, OK), TELLS(0x00FF, 0x0500, 0x0000, 0xB401));
    desk.argument = 5;
    PLAY(warm_up, OK, FACTORY, PUTS(0x0A, 5, OK), FACTORY);
}

/* ---- blind ---- */

TEST(each_setting_can_be_written_blind_but_the_offset_and_the_reset)
{
    static const struct {
        fathom_status_t (*set)(void);
        row_t write;
    } rows[] = {{warm_up, PUTS(0x0A, 1, OK)},     {address, PUTS(0x10, 1, OK)},
                {measures, PUTS(0x12, 0xFF, OK)}, {termination, PUTS(0x13, 0xFF, OK)},
                {load_user, PUTS(0x15, 0, OK)},   {load_factory, PUTS(0x15, 0xFF, OK)},
                {filter, PUTS(0x16, 1, OK)}};
    desk.argument = 1;
    for (unsigned i = 0; i != COUNT(rows); i++) {
        assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
        assert_int_equal(desk_play(rows[i].set, &rows[i].write, 1), FATHOM_ERR_UNCONFIRMED);
        assert_true(fathom_hps167s_is_written(&hps));
    }
    desk.argument = 18;
    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
    PLAY(reconnect, FATHOM_ERR_UNCONFIRMED, RECONNECT(0, 18));
    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
    assert_int_equal(offset(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
    assert_int_equal(reset(), FATHOM_ERR_ARGUMENT);
    assert_null(fake.request);
}

/* hps167s_settings.h: "The setting after it is not blind, whatever its result is." */
TEST(a_setting_after_a_refused_argument_is_not_blind)
{
    static const struct {
        fathom_status_t (*set)(void);
        int32_t argument;
    } refused[] = {{offset, 1}, {reset, 0}, {reconnect, 17}, {address, 0}, {address, 33}};
    for (unsigned i = 0; i != COUNT(refused); i++) {
        hps_set_up(NULL);
        desk.argument = refused[i].argument;
        assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
        assert_int_equal(refused[i].set(), FATHOM_ERR_ARGUMENT);
        desk.argument = 0;
        PLAY(termination, OK, FACTORY, PUTS(0x13, 0, OK), TELLS(0x00FF, 0x0500, 0x0000, 0xB401));
    }
}

TEST(a_refused_argument_leaves_the_blind_setting_in_progress_blind)
{
    desk.argument = 0;
    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), OK);
    PART(termination, PUTS(0x13, 0, OK));
    desk.argument = 17;
    assert_int_equal(reconnect(), FATHOM_ERR_ARGUMENT);
    desk.argument = 0;
    assert_int_equal(termination(), FATHOM_ERR_UNCONFIRMED);
}

/* ---- to all units ---- */

static fathom_status_t measures_all(void)
{
    return fathom_hps167s_broadcast_measures_after_power_on(&hps, desk.argument != 0);
}
static fathom_status_t termination_all(void)
{
    return fathom_hps167s_broadcast_termination(&hps, desk.argument != 0);
}

/* modbus_unit.h, rule 5: a setting that is not called for 5 s and 16 calls of other functions ends. */
static void begins_behind_the_abandoned_one(fathom_status_t (*set)(void), int32_t argument)
{
    fathom_status_t status = FATHOM_ERR_BUSY;
    desk.argument = argument;
    for (unsigned calls = 1; status == FATHOM_ERR_BUSY; calls++) {
        assert_true(calls <= 16);
        fake.now_us += 1000000;
        status = set();
        assert_int_equal(status, calls < 16 ? FATHOM_ERR_BUSY : FATHOM_PENDING);
    }
    fake.submits = 0;
}

static void begins_behind_an_abandoned_setting(fathom_status_t (*set)(void), int32_t argument)
{
    hps_set_up(NULL);
    desk.argument = 0;
    PENDS(termination());
    begins_behind_the_abandoned_one(set, argument);
}

TEST(an_abandoned_setting_gives_way_to_another_setting)
{
    begins_behind_an_abandoned_setting(warm_up, 9);
    PLAY(warm_up, OK, FACTORY, PUTS(0x0A, 9, OK), TELLS(0xFFFF, 0x0900, 0x0000, 0xB401));
    begins_behind_an_abandoned_setting(termination, 1); /* the same with another value */
    PLAY(termination, OK, FACTORY);
    begins_behind_an_abandoned_setting(offset, -15);
    PLAY(offset, OK, ASK_1, PUTS(0x14, 0xFFF1, OK));
}

TEST(an_abandoned_setting_gives_way_to_a_broadcast_which_reads_nothing)
{
    begins_behind_an_abandoned_setting(measures_all, 1);
    PLAY(measures_all, FATHOM_ERR_UNCONFIRMED, HPS_WRITE(0, 0x12, 0xFF, OK, 0));
}

TEST(one_unit_and_all_are_not_mixed_and_a_cancelled_one_leaves_the_driver_where_it_was)
{
    hps_start_at(7, NULL);
    PENDS(termination_all());
    assert_int_equal(fake.request->message.head[0], 0);
    assert_int_equal(termination(), FATHOM_ERR_BUSY);
    PENDS(desk_poll());
    fathom_hps167s_cancel(&hps);
    assert_int_equal(hps.unit.address, 7);
    PART(termination, IS(7, 1, 0));
    assert_int_equal(termination_all(), FATHOM_ERR_BUSY);
    assert_int_equal(hps.unit.address, 7);
    PLAY(termination, OK, HPS_WRITE(7, 0x13, 0, OK, 0), HPS_2(7, OK, 0, 0x00FF, 0x0500, 0x0000, 0xB401),
         HPS_2(7, OK, 0, 0x00FF, 0x0500, 0x0000, 0xB401)); /* and it is read back */
}

TEST(what_was_sent_to_all_takes_nothing_back)
{
    desk.argument = 0;
    PLAY(termination, FATHOM_ERR_DIFFERS, FACTORY, PUTS(0x13, 0, OK), FACTORY);
    desk.argument = 1;
    PLAY(termination_all, FATHOM_ERR_UNCONFIRMED, HPS_WRITE(0, 0x13, 0xFF, OK, 0));
    PLAY(termination, OK, FACTORY, PUTS(0x13, 0xFF, OK), FACTORY);
}

TEST(what_goes_to_all_and_is_given_up_may_have_been_taken)
{
    desk.argument = 0;
    PLAY(termination, FATHOM_ERR_DIFFERS, FACTORY, PUTS(0x13, 0, OK), FACTORY);
    desk.argument = 1;
    PENDS(termination_all());
    fathom_hps167s_cancel(&hps);
    desk.argument = 0; /* which it tells now, and that may be as old as what it told before */
    PLAY(termination, OK, TELLS(0x00FF, 0x0500, 0x0000, 0xB401), PUTS(0x13, 0, OK),
         TELLS(0x00FF, 0x0500, 0x0000, 0xB401));
}

TEST(while_another_command_is_asked_nothing_goes_to_all)
{
    fathom_hps167s_version_t version;
    PENDS(fathom_hps167s_get_interface_version(&hps, &version));
    assert_int_equal(termination_all(), FATHOM_ERR_BUSY);
    assert_false(fathom_hps167s_is_written(&hps));
    assert_int_equal(hps.unit.address, 1);
}

/* ---- write-only ---- */

/* #12: "-15 = 0xFFF1". */
TEST(the_offset_and_the_filter_go_as_int16)
{
    static const struct {
        int32_t value;
        uint16_t word;
    } rows[] = {{-15, 0xFFF1}, {15, 15}, {-32768, 0x8000}, {32767, 0x7FFF}, {-100, 0xFF9C}};
    for (unsigned i = 0; i != 5; i++) {
        desk.argument = rows[i].value;
        PLAY(offset, OK, ASK_1, PUTS(0x14, rows[i].word, OK));
        PLAY(filter, OK, ASK_1, PUTS(0x16, rows[i].word, OK));
    }
}

#define LOAD(value, ends) PUTS(0x15, value, ends)

TEST(the_users_and_the_factorys_settings_are_loaded_by_functions_of_their_own)
{
    PLAY(load_user, OK, ASK_1, LOAD(0, OK));
    PLAY(load_factory, OK, ASK_1, LOAD(0xFF, OK));
}

TEST(a_setting_under_way_is_not_mixed_with_another_one_of_the_same_value)
{
    desk.argument = 18;
    PENDS(warm_up());
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(&hps, 18), FATHOM_ERR_BUSY);
}

/* Words that differ in the second place only: 65556 and 65574 ms. */
TEST(both_words_tell_a_reconnect_time_from_another)
{
    PENDS(fathom_hps167s_set_reconnect_time_ms(&hps, 65556));
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(&hps, 65574), FATHOM_ERR_BUSY);
    PENDS(fathom_hps167s_set_reconnect_time_ms(&hps, 65556));
}

TEST(a_device_that_is_not_there_is_told_nothing)
{
    static fathom_status_t (*const commands[])(void) = {offset, filter, load_user, load_factory};
    desk.argument = -15;
    for (unsigned i = 0; i != COUNT(commands); i++) {
        PLAY(filter, OK, ASK_1, PUTS(0x16, 0xFFF1, OK));
        assert_true(fathom_hps167s_is_written(&hps));
        PLAY(commands[i], SILENT, HPS_1(1, SILENT, 0));
        assert_false(fathom_hps167s_is_written(&hps));
    }
}
