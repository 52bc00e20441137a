/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Warm-up, and what counts as a distance: the options of measuring. */

/* Asks at once, and is answered after us: with these registers, or so. */
static fathom_status_t says_after(uint32_t us, const uint16_t *registers, fathom_status_t status)
{
    PENDS(desk_poll());
    assert_non_null(fake.request);
    fake.now_us += us;
    if (registers != NULL)
        fake_modbus_response(&fake, registers, 4);
    else
        fake_modbus_fail(&fake, status);
    fake.submits = 0;
    status = desk_poll();
    fake.now_us += 20000;
    return status;
}

static fathom_status_t ends_after(uint32_t us, fathom_status_t status)
{
    return says_after(us, NULL, status);
}
static fathom_status_t says(const uint16_t *registers) { return says_after(0, registers, OK); }

HPS_SUITE;

/* ---- warm-up ---- */

TEST(silence_damage_refusal_and_the_abnormal_packet_are_warming_up)
{
    fathom_hps167s_power_on(&hps);
    assert_int_equal(ends_after(10000, SILENT), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_CHECKSUM), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_EXCEPTION), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(10000, FATHOM_ERR_PORT), FATHOM_ERR_PORT);
    assert_int_equal(says(hps_abnormal), FATHOM_ERR_WARMING_UP);
    assert_int_equal(hps.implausible, 0);
    assert_int_equal(says(hps_measured), OK); /* if it does measure, it does */
    assert_int_equal(desk.sample.sequence, 1);
    assert_int_equal(says(hps_abnormal), FATHOM_ERR_WARMING_UP);
}

/* Until when is silence no error: seconds of the config and one time-out. 0 is the factory's 5. */
TEST(the_warm_up_is_an_option_and_its_last_request_counts)
{
    static const uint32_t rows[][3] = {
        {0, 0, 5500000}, {1, 0, 1500000}, {9, 0, 9500000}, {255, 0, 255500000}, {2, 170000, 2170000}};
    for (unsigned i = 0; i != 5; i++) {
        for (unsigned late = 0; late != 2; late++) {
            hps_set_up(NULL);
            hps_config.warm_up_s = (uint8_t)rows[i][0];
            hps_config.modbus.timeout_us = rows[i][1];
            hps_start();
            fathom_hps167s_power_on(&hps);
            assert_int_equal(ends_after(rows[i][2] - 1 + late, SILENT),
                             late == 0 ? FATHOM_ERR_WARMING_UP : SILENT);
            assert_int_equal(says(hps_abnormal), OK);
            assert_int_equal(desk.sample.kind, FATHOM_FAULT);
        }
    }
}

#define WARMS_UP(s) TELLS(0xFFFF, (s)*256, 0x0000, 0xB401)

static fathom_status_t nine(void) { return fathom_hps167s_set_warm_up_s(&hps, 9); }
static fathom_status_t reset(void) { return fathom_hps167s_restore_factory_settings(&hps); }

TEST(a_warm_up_that_was_set_counts_from_then_on)
{
    hps_config.warm_up_s = 1;
    hps_start();
    PLAY(nine, OK, WARMS_UP(1), HPS_WRITE(1, 0x0A, 9, OK, 0), WARMS_UP(9));
    fake.now_us += 20000;
    fathom_hps167s_power_on(&hps);
    assert_int_equal(ends_after(9000000, SILENT), FATHOM_ERR_WARMING_UP);
    PLAY(reset, OK, WARMS_UP(9), HPS_6(1, OK, 1, 0), WARMS_UP(5));
    fake.now_us += 20000;
    fathom_hps167s_power_on(&hps);
    assert_int_equal(ends_after(5400000, SILENT), FATHOM_ERR_WARMING_UP);
    assert_int_equal(ends_after(100000, SILENT), SILENT);
}

/* ---- what is a distance ---- */

typedef struct {
    fathom_hps167s_limits_t limits;
    struct {
        uint16_t raw;
        uint8_t kind; /* 0: refused */
    } is[4];
} limits_t;

static void kinds_as_in(void **state)
{
    const limits_t *const row = *state;
    hps_set_up(NULL);
    fathom_hps167s_limits_t limits = row->limits;
    assert_int_equal(fathom_hps167s_set_limits(&hps, &limits), OK);
    for (unsigned i = 0; i != 4; i++) {
        const uint16_t registers[4] = {row->is[i].raw, 0xDCB2, 0x0701, 0x0000};
        const uint16_t refused = hps.implausible;
        assert_int_equal(says(registers), row->is[i].kind != 0 ? OK : FATHOM_ERR_MALFORMED);
        assert_int_equal(hps.implausible - refused, row->is[i].kind == 0);
        if (row->is[i].kind != 0) assert_int_equal(desk.sample.kind, row->is[i].kind);
    }
}

#define LIMITS(promise, max, over_range, ...)                                                                \
    static const limits_t promise = {{.max_mm = max, .over_range_mm = over_range}, {__VA_ARGS__}};           \
    TEST_ROW(promise, kinds_as_in, &promise)

LIMITS(by_default_distances_end_at_30000_and_over_range_begins_at_65530, 0, 0, {30000, FATHOM_TARGET},
       {30001, 0}, {65529, 0}, {65530, FATHOM_NO_TARGET})
LIMITS(the_largest_distance_is_an_option, 18000, 0, {18000, FATHOM_TARGET}, {18001, 0}, {65529, 0},
       {65530, FATHOM_NO_TARGET})
LIMITS(where_over_range_begins_is_an_option, 0, 65500, {65499, 0}, {65500, FATHOM_NO_TARGET},
       {65534, FATHOM_NO_TARGET}, {65535, 0})
LIMITS(the_two_limits_may_touch, 65533, 65534, {65533, FATHOM_TARGET}, {65534, FATHOM_NO_TARGET}, {65535, 0},
       {0, 0})

/* Features: "0.08 to 18 m". */
LIMITS(below_80_mm_is_below_its_range, 0, 0, {0, 0}, {1, FATHOM_UNKNOWN}, {79, FATHOM_UNKNOWN},
       {80, FATHOM_TARGET})

static const limits_t from_1 = {{.min_mm = 1},
                                {{0, 0}, {1, FATHOM_TARGET}, {79, FATHOM_TARGET}, {80, FATHOM_TARGET}}};
static const limits_t only_500 = {
    {.max_mm = 500, .min_mm = 500},
    {{1, FATHOM_UNKNOWN}, {499, FATHOM_UNKNOWN}, {500, FATHOM_TARGET}, {501, 0}}};
TEST_ROW(whatever_is_near_is_a_target_if_that_is_chosen, kinds_as_in, &from_1)
TEST_ROW(the_least_distance_may_be_the_largest, kinds_as_in, &only_500)

TEST(limits_that_are_out_of_order_are_refused_and_change_nothing)
{
    fathom_hps167s_limits_t wrong = {.over_range_mm = 30000};
    static const uint16_t largest[4] = {30000, 0xDCB2, 0x0701, 0x0003};
    assert_int_equal(fathom_hps167s_set_limits(&hps, &wrong), FATHOM_ERR_ARGUMENT);
    assert_int_equal(says(largest), OK);
    assert_int_equal(desk.sample.kind, FATHOM_TARGET);
}

/* Each differs from the abnormal packet (#5, table 18) in one thing: it does not say that the sensor has failed. */
TEST(all_ones_without_the_full_pattern_are_malformed_and_no_fault)
{
    static const uint16_t packets[][4] = {{0xFFFF, 0x0001, 0x00FF, 0xFFFF}, {0xFFFF, 0x0100, 0x00FF, 0xFFFF},
                                          {0xFFFF, 0x0000, 0x0000, 0xFFFF}, {0xFFFF, 0x0000, 0x00FE, 0xFFFF},
                                          {0xFFFF, 0x0000, 0x00FF, 0x0000}, {0xFFFF, 0x0000, 0x00FF, 0xFFFE},
                                          {0xFFFF, 0xDCB2, 0x0701, 0x0000}};
    for (uint16_t i = 0; i != COUNT(packets); i++) {
        assert_int_equal(says(packets[i]), FATHOM_ERR_MALFORMED);
        assert_int_equal(hps.implausible, i + 1);
    }
    fathom_hps167s_power_on(&hps); /* and no warming up either */
    assert_int_equal(says(packets[0]), FATHOM_ERR_MALFORMED);
}
