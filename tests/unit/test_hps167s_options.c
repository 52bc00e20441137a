/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Warm-up, and what counts as a distance: the options of measuring. */

static const uint16_t measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};
static const uint16_t abnormal[4] = {0xFFFF, 0x0000, 0x00FF, 0xFFFF}; /* #5 */

/* Asks at once and ends it after us. */
static fathom_status_t ends_after(uint32_t us, fathom_status_t status)
{
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    assert_non_null(desk.fake.request);
    desk.fake.now_us += us;
    if (status == FATHOM_ERR_EXCEPTION)
        fake_modbus_refuse(&desk.fake, 4);
    else
        fake_modbus_fail(&desk.fake, status);
    const fathom_status_t as = desk_poll();
    desk_assert_guard(&desk.sample, sizeof desk.sample);
    desk.fake.now_us += 20000;
    return as;
}

static fathom_status_t says(const uint16_t *registers)
{
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, registers, 4);
    const fathom_status_t as = desk_poll();
    desk.fake.now_us += 20000;
    return as;
}

DESK_SUITE;

/* ---- warm-up ---- */

TEST(silence_damage_refusal_and_the_abnormal_packet_are_warming_up)
{
    desk_start();
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(ends_after(10000, FATHOM_ERR_NO_ANSWER), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_CHECKSUM), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_EXCEPTION), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_PORT), FATHOM_ERR_PORT);
    assert_int_equal(says(abnormal), FATHOM_ERR_WARMING_UP);
    desk_assert_guard(&desk.sample, sizeof desk.sample);
    assert_int_equal(desk.hps.implausible, 0);
    assert_int_equal(says(measured), FATHOM_READY); /* if it does measure, it does */
    assert_int_equal(desk.sample.sequence, 1);
    assert_int_equal(says(abnormal), FATHOM_ERR_WARMING_UP);
}

TEST(without_power_on_they_are_what_they_are)
{
    desk_start();
    assert_int_equal(ends_after(10000, FATHOM_ERR_NO_ANSWER), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(ends_after(10000, FATHOM_ERR_EXCEPTION), FATHOM_ERR_EXCEPTION);
    assert_int_equal(says(abnormal), FATHOM_READY);
    assert_int_equal(desk.sample.kind, FATHOM_FAULT);
}

/* Until when is silence no error: seconds of the config and one time-out. 0 is the factory's 5. */
TEST(the_warm_up_is_an_option_and_its_last_question_counts)
{
    static const uint32_t rows[][3] = {
        {0, 0, 5500000}, {1, 0, 1500000}, {9, 0, 9500000}, {255, 0, 255500000}, {2, 170000, 2170000}};
    for (unsigned i = 0; i != 5; i++) {
        for (unsigned late = 0; late != 2; late++) {
            desk_set_up(NULL);
            desk.config.warm_up_s = (uint8_t)rows[i][0];
            desk.config.timeout_us = rows[i][1];
            desk_start();
            fathom_hps167s_power_on(&desk.hps);
            assert_int_equal(ends_after(rows[i][2] - 1 + late, FATHOM_ERR_NO_ANSWER),
                             late == 0 ? FATHOM_ERR_WARMING_UP : FATHOM_ERR_NO_ANSWER);
            assert_int_equal(says(abnormal), FATHOM_READY);
            assert_int_equal(desk.sample.kind, FATHOM_FAULT);
        }
    }
}

static fathom_status_t nine(void) { return fathom_hps167s_set_warm_up_s(&desk.hps, 9); }
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&desk.hps); }

#define IS(warm_up)                                                                                          \
    {{1, 3, 0, 2, 0, 4}, FATHOM_READY, {0xFFFF, warm_up * 256, 0x0000, 0xB401}, 0},                          \
    {                                                                                                        \
        {1, 3, 0, 2, 0, 4}, FATHOM_READY, {0xFFFF, warm_up * 256, 0x0000, 0xB401}, 0                         \
    }

TEST(a_warm_up_that_was_set_counts_from_then_on)
{
    desk.config.warm_up_s = 1;
    desk_start();
    assert_int_equal(desk_play(nine, ROWS(IS(1), {{1, 6, 0, 0x0A, 0, 9}, FATHOM_READY, {0}, 0}, IS(9))),
                     FATHOM_READY);
    desk.fake.now_us += 20000;
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(ends_after(9000000, FATHOM_ERR_NO_ANSWER), FATHOM_ERR_WARMING_UP);
    assert_int_equal(desk_play(reset, ROWS(IS(9), {{1, 3, 0, 9, 0, 1}, FATHOM_READY, {1}, 0}, IS(5))),
                     FATHOM_READY);
    desk.fake.now_us += 20000;
    fathom_hps167s_power_on(&desk.hps);
    assert_int_equal(ends_after(5400000, FATHOM_ERR_NO_ANSWER), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(100000, FATHOM_ERR_NO_ANSWER), FATHOM_ERR_NO_ANSWER);
}

TEST(power_forgets_what_was_under_way)
{
    fathom_hps167s_configuration_t is;
    desk_start();
    assert_int_equal(fathom_hps167s_configuration(&desk.hps, &is), FATHOM_PENDING);
    fathom_hps167s_power_on(&desk.hps);
    assert_null(desk.fake.request);
    assert_int_equal(says(measured), FATHOM_READY);
}

/* ---- what is a distance ---- */

static int kind_of(uint16_t raw)
{
    const uint16_t registers[4] = {raw, 0xDCB2, 0x0701, 0x0000};
    desk.fake.submits = 0;
    return says(registers) == FATHOM_READY ? desk.sample.kind : 0;
}

TEST(the_largest_distance_is_an_option)
{
    desk_start();
    assert_int_equal(kind_of(30000), FATHOM_TARGET);
    assert_int_equal(kind_of(30001), 0);
    desk_set_up(NULL);
    desk.config.limits.max_mm = 18000;
    desk_start();
    assert_int_equal(kind_of(18000), FATHOM_TARGET);
    assert_int_equal(kind_of(18001), 0);
    assert_int_equal(kind_of(65530), FATHOM_NO_TARGET);
    assert_int_equal(desk.hps.implausible, 1);
}

TEST(where_over_range_begins_is_an_option)
{
    desk_start();
    assert_int_equal(kind_of(65529), 0);
    assert_int_equal(kind_of(65530), FATHOM_NO_TARGET);
    desk_set_up(NULL);
    desk.config.limits.over_range_mm = 65500;
    desk_start();
    assert_int_equal(kind_of(65499), 0);
    assert_int_equal(kind_of(65500), FATHOM_NO_TARGET);
    assert_int_equal(kind_of(65534), FATHOM_NO_TARGET);
    assert_int_equal(kind_of(65535), FATHOM_FAULT);
}

TEST(limits_that_make_no_sense_are_refused)
{
    static const uint16_t wrong[][2] = {{0, 65535}, {0, 30000}, {65530, 0}, {100, 100}, {65534, 65534}};
    for (unsigned i = 0; i != 5; i++) {
        desk.config.limits.max_mm = wrong[i][0];
        desk.config.limits.over_range_mm = wrong[i][1];
        assert_int_equal(fathom_hps167s_init(&desk.hps, &desk.config), FATHOM_ERR_ARGUMENT);
    }
    desk.config.limits.max_mm = 65533;
    desk.config.limits.over_range_mm = 65534;
    assert_int_equal(fathom_hps167s_init(&desk.hps, &desk.config), FATHOM_READY);
}

/* Never a distance, whatever the rest of the packet says. */
TEST(all_ones_are_a_fault_without_the_full_pattern_too)
{
    static const uint16_t packets[][4] = {{0xFFFF, 0x0001, 0x00FF, 0xFFFF},
                                          {0xFFFF, 0x0000, 0x0000, 0xFFFF},
                                          {0xFFFF, 0x0000, 0x00FF, 0x0000},
                                          {0xFFFF, 0xDCB2, 0x0701, 0x0000}};
    desk_start();
    for (unsigned i = 0; i != 4; i++) {
        assert_int_equal(says(packets[i]), FATHOM_READY);
        assert_int_equal(desk.sample.kind, FATHOM_FAULT);
        assert_int_equal(desk.sample.distance_mm, 0);
    }
}
