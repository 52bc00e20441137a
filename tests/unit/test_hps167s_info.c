/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #2 and #4. */

static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t configuration(void)
{
    memset(&is, DESK_GUARD, sizeof is);
    return fathom_hps167s_configuration(&desk.hps, &is);
}

static fathom_status_t read_temperature(void)
{
    memset(&temperature, DESK_GUARD, sizeof temperature);
    return fathom_hps167s_temperature(&desk.hps, &temperature);
}

/* Tables 11 and 15. */
#define ASK_2                                                                                                \
    {                                                                                                        \
        1, 3, 0, 2, 0, 4                                                                                     \
    }
#define ASK_4                                                                                                \
    {                                                                                                        \
        1, 3, 0, 4, 0, 1                                                                                     \
    }

/* Table 12: termination FF, automatic 00, warm-up 5, 00 00 00 B4 = 180 ms, rate 1. */
#define TELLS    0xFF00, 0x0500, 0x0000, 0xB401
#define TELLS_2  0xFF00, 0x0500, 0x0000, 0xB402
#define MEASURES 0x0823, 0xDCB2, 0x0701, 0x0000 /* the example of #5 */

DESK_SUITE;

/* ---- #2 ---- */

TEST(the_configuration_is_believed_when_two_answers_agree)
{
    desk_start();
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS}, 0}, {ASK_2, FATHOM_READY, {TELLS}, 0})),
        FATHOM_READY);
    assert_true(is.termination);
    assert_false(is.measures_after_power_on);
    assert_int_equal(is.warm_up_s, 5);
    assert_int_equal(is.reconnect_time_ms, 180);
    assert_int_equal(is.baud, 19200);
}

TEST(every_member_of_the_configuration_is_its_own_bytes)
{
    static const struct {
        uint16_t registers[4];
        bool termination, measures;
        uint8_t warm_up_s;
        uint32_t reconnect_ms, baud;
    } rows[] = {
        {{0x0000, 0x0000, 0x0000, 0x0001}, false, false, 0, 0, 19200},
        {{0x00FF, 0xFF00, 0x0000, 0x1202}, false, true, 255, 18, 57600},
        {{0xFF00, 0x0500, 0x0000, 0xB403}, true, false, 5, 180, 115200},
        /* 01020307 hexadecimal = 16909063 = 18 * 939392 + 7, so 01020300 */
        {{0xFFFF, 0x0501, 0x0203, 0x0004}, true, true, 5, 0x01020300, 230400},
        /* The highest bit of each byte set: FEDCBA98 = 4275878552 = 18 * 237548808 + 8, so FEDCBA90 */
        {{0x00FF, 0x05FE, 0xDCBA, 0x9001}, false, true, 5, 0xFEDCBA90, 19200},
    };
    for (unsigned i = 0; i != 5; i++) {
        const uint16_t *const r = rows[i].registers;
        desk_set_up(NULL);
        desk_start();
        assert_int_equal(desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {r[0], r[1], r[2], r[3]}, 0},
                                                       {ASK_2, FATHOM_READY, {r[0], r[1], r[2], r[3]}, 0})),
                         FATHOM_READY);
        assert_int_equal(is.termination, rows[i].termination);
        assert_int_equal(is.measures_after_power_on, rows[i].measures);
        assert_int_equal(is.warm_up_s, rows[i].warm_up_s);
        assert_int_equal(is.reconnect_time_ms, rows[i].reconnect_ms);
        assert_int_equal(is.baud, rows[i].baud);
    }
}

TEST(a_measurement_in_its_place_is_passed_over)
{
    desk_start();
    assert_int_equal(
        desk_play(configuration,
                  ROWS({ASK_2, FATHOM_READY, {MEASURES}, 0}, {ASK_2, FATHOM_READY, {TELLS}, 0},
                       {ASK_2, FATHOM_READY, {MEASURES}, 0}, {ASK_2, FATHOM_READY, {TELLS_2}, 0},
                       {ASK_2, FATHOM_READY, {MEASURES}, 0}, {ASK_2, FATHOM_READY, {MEASURES}, 0},
                       {ASK_2, FATHOM_READY, {TELLS_2}, 0})),
        FATHOM_READY);
    assert_int_equal(is.baud, 57600);
}

TEST(two_answers_that_differ_are_not_enough)
{
    desk_start();
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS}, 0}, {ASK_2, FATHOM_READY, {TELLS_2}, 0},
                                      {ASK_2, FATHOM_READY, {TELLS_2}, 0})),
        FATHOM_READY);
    assert_int_equal(is.baud, 57600);
}

#define TWICE                                                                                                \
    {ASK_2, FATHOM_READY, {TELLS}, 0}, { ASK_2, FATHOM_READY, {TELLS_2}, 0 }

TEST(after_eight_answers_without_agreement_it_gives_up)
{
    desk_start();
    assert_int_equal(desk_play(configuration, ROWS(TWICE, TWICE, TWICE, TWICE)), FATHOM_ERR_MALFORMED);
    desk_assert_guard(&is, sizeof is);
    /* the next time counts anew: one more of the last kind is no agreement */
    assert_int_equal(desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS_2}, 0},
                                                   {ASK_2, FATHOM_READY, {TELLS_2}, 0})),
                     FATHOM_READY);
}

/* Each differs from an answer to #2 in one thing. */
TEST(what_cannot_be_an_answer_to_2_never_counts)
{
    static const uint16_t wrong[][4] = {
        {0x01FF, 0x0500, 0x0000, 0xB401},
        {0xFF01, 0x0500, 0x0000, 0xB401},
        {0xFEFF, 0x0500, 0x0000, 0xB401},
        {0xFFFE, 0x0500, 0x0000, 0xB401},
        {0xFFFF, 0x0500, 0x0000, 0xB400},
        {0xFFFF, 0x0500, 0x0000, 0xB405},
        {0xFFFF, 0x0500, 0x0000, 0xB301},
        {0xFFFF, 0x0500, 0x0000, 0xB501},
        {0xFFFF, 0x0500, 0x0001, 0xB401},
        {0xFFFF, 0x0500, 0x0100, 0xB401},
        {0xFFFF, 0x0501, 0x0000, 0xB401},
        /* the abnormal packet of #5 */
        {0xFFFF, 0x0000, 0x00FF, 0xFFFF},
    };
    for (unsigned i = 0; i != sizeof wrong / sizeof *wrong; i++) {
        const uint16_t *const r = wrong[i];
        const row_t row = {ASK_2, FATHOM_READY, {r[0], r[1], r[2], r[3]}, 0};
        desk_set_up(NULL);
        desk_start();
        assert_false(fathom_hps167s_may_be_configuration(&desk.hps, r));
        assert_int_equal(desk_play(configuration, ROWS(row, row, row, row, row, row, row, row)),
                         FATHOM_ERR_MALFORMED);
        desk_assert_guard(&is, sizeof is);
    }
}

TEST(an_error_ends_it_and_the_next_time_begins_anew)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION};
    desk_start();
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS}, 0},
                                                       {ASK_2, errors[i], {2, 0, 0, 0}, 0})),
                         errors[i]);
        desk_assert_guard(&is, sizeof is);
    }
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS}, 0}, {ASK_2, FATHOM_READY, {TELLS}, 0})),
        FATHOM_READY);
}

/* A target at exactly 255 mm with just these figures, sent unasked: it was measured just before. */
TEST(what_was_measured_last_is_no_configuration)
{
    static const uint16_t near[4] = {0x00FF, 0x0100, 0x0000, 0xB401};
    const row_t row = {ASK_2, FATHOM_READY, {0x00FF, 0x0100, 0x0000, 0xB401}, 0};
    desk_start();
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, near, 4);
    assert_int_equal(desk_poll(), FATHOM_READY);
    assert_int_equal(desk.sample.distance_mm, 255);
    assert_true(fathom_hps167s_may_be_configuration(&desk.hps, near));
    assert_int_equal(desk_play(configuration, ROWS(row, row, row, row, row, row, row, row)),
                     FATHOM_ERR_MALFORMED);
}

/* An unasked frame was taken for the answer, and the answer comes when a measurement is being waited for. */
TEST(what_was_told_last_is_no_measurement)
{
    static const uint16_t told[4] = {0x00FF, 0x0500, 0x0000, 0xB401}; /* termination off; or 255 mm */
    static const uint16_t other[4] = {0x00FF, 0x0500, 0x0000, 0xB402};
    desk_start();
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {0x00FF, 0x0500, 0x0000, 0xB401}, 0},
                                      {ASK_2, FATHOM_READY, {0x00FF, 0x0500, 0x0000, 0xB401}, 0})),
        FATHOM_READY);
    desk.fake.now_us += 20000;
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, told, 4);
    assert_int_equal(desk_poll(), FATHOM_ERR_MALFORMED);
    desk_assert_guard(&desk.sample, sizeof desk.sample);
    assert_int_equal(desk.hps.implausible, 1);
    desk.fake.now_us += 20000;
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, other, 4);
    assert_int_equal(desk_poll(), FATHOM_READY);
    assert_int_equal(desk.sample.distance_mm, 255);
}

TEST(the_configuration_given_up_begins_anew)
{
    desk_start();
    assert_int_equal(configuration(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, (const uint16_t[]){TELLS}, 4);
    desk.fake.now_us += 20000;
    assert_int_equal(configuration(), FATHOM_PENDING);
    assert_int_equal(fathom_hps167s_temperature(&desk.hps, &temperature), FATHOM_ERR_BUSY);
    fathom_hps167s_cancel(&desk.hps);
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {TELLS}, 0}, {ASK_2, FATHOM_READY, {TELLS}, 0})),
        FATHOM_READY);
}

TEST(a_second_command_does_not_disturb_it)
{
    desk_start();
    assert_int_equal(read_temperature(), FATHOM_PENDING);
    assert_int_equal(configuration(), FATHOM_ERR_BUSY);
    desk_assert_guard(&is, sizeof is);
    fake_modbus_answer(&desk.fake, (const uint16_t[]){77}, 1);
    assert_int_equal(read_temperature(), FATHOM_READY);
    assert_int_equal(temperature.temperature_dc, 250);
}

/* ---- its options ---- */

TEST(how_many_answers_have_to_agree_is_an_option)
{
    const row_t row = {ASK_2, FATHOM_READY, {TELLS}, 0};
    desk.config.same_answers = 1;
    desk_start();
    assert_int_equal(desk_play(configuration, &row, 1), FATHOM_READY);
    desk_set_up(NULL);
    desk.config.same_answers = 3;
    desk_start();
    assert_int_equal(desk_play(configuration, ROWS(row, row, row)), FATHOM_READY);
    desk_set_up(NULL);
    desk.config.same_answers = 8;
    desk_start();
    assert_int_equal(desk_play(configuration, ROWS(row, row, row, row, row, row, row, row)), FATHOM_READY);
    desk.config.same_answers = 9;
    assert_int_equal(fathom_hps167s_init(&desk.hps, &desk.config), FATHOM_ERR_ARGUMENT);
}

/* #9: "the others are all 19200bps". */
TEST(other_baud_codes_can_be_19200)
{
    static const uint16_t codes[] = {0x00, 0x05, 0xFF};
    for (unsigned i = 0; i != 3; i++) {
        const uint16_t last = (uint16_t)(0xB400 + codes[i]);
        desk_set_up(NULL);
        desk.config.unknown_baud_is_19200 = true;
        desk_start();
        assert_int_equal(
            desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {0xFF00, 0x0500, 0x0000, last}, 0},
                                          {ASK_2, FATHOM_READY, {0xFF00, 0x0500, 0x0000, last}, 0})),
            FATHOM_READY);
        assert_int_equal(is.baud, 19200);
    }
}

/* 0001 0012 is 65554 the one way, 18 * 65536 + 1 the other; 0012 0000 the other way is 18. */
TEST(the_reconnect_time_can_have_its_low_word_first)
{
    desk.config.low_word_first = true;
    desk_start();
    assert_int_equal(
        desk_play(configuration, ROWS({ASK_2, FATHOM_READY, {0xFF00, 0x0500, 0x1200, 0x0001}, 0},
                                      {ASK_2, FATHOM_READY, {0xFF00, 0x0500, 0x1200, 0x0001}, 0})),
        FATHOM_READY);
    assert_int_equal(is.reconnect_time_ms, 18);
}

/* ---- #4 ---- */

/* By hand: (F - 32) * 50 / 9. */
TEST(the_temperature_is_fahrenheit_and_tenths_of_celsius)
{
    static const struct {
        uint16_t raw;
        int16_t fahrenheit, temperature_dc;
    } rows[] = {
        {32, 32, 0},
        {212, 212, 1000},
        {77, 77, 250},
        {33, 33, 6} /* 5.56 */,
        {34, 34, 11},
        {31, 31, -6},
        {0, 0, -178},
        {0xFFD8, -40, -400},
        {0xFFFF, -1, -183},
        {1, 1, -172},
        {5930, 5930, 32767},
        {5929, 5929, 32761},
        {0xE916, -5866, -32767},
        {0xE917, -5865, -32761},
    };
    desk_start();
    for (unsigned i = 0; i != sizeof rows / sizeof *rows; i++) {
        assert_int_equal(desk_play(read_temperature, ROWS({ASK_4, FATHOM_READY, {rows[i].raw, 0, 0, 0}, 0})),
                         FATHOM_READY);
        assert_int_equal(temperature.fahrenheit, rows[i].fahrenheit);
        assert_int_equal(temperature.temperature_dc, rows[i].temperature_dc);
    }
}

/* 5931 degF are 32771.7 tenths, -5867 are -32772.2, and the ends of int16. */
TEST(a_temperature_that_does_not_fit_is_refused)
{
    static const uint16_t wrong[] = {5931, 0x7FFF, 0xE915, 0x8000};
    desk_start();
    for (unsigned i = 0; i != 4; i++) {
        assert_int_equal(desk_play(read_temperature, ROWS({ASK_4, FATHOM_READY, {wrong[i], 0, 0, 0}, 0})),
                         FATHOM_ERR_MALFORMED);
        desk_assert_guard(&temperature, sizeof temperature);
    }
}

TEST(the_temperature_can_count_in_finer_steps)
{
    desk.config.steps_per_degree = 10;
    desk_start();
    assert_int_equal(desk_play(read_temperature, ROWS({ASK_4, FATHOM_READY, {770, 0, 0, 0}, 0})),
                     FATHOM_READY);
    assert_int_equal(temperature.fahrenheit, 770);
    assert_int_equal(temperature.temperature_dc, 250);
    assert_int_equal(desk_play(read_temperature, ROWS({ASK_4, FATHOM_READY, {0xFFFF, 0, 0, 0}, 0})),
                     FATHOM_READY);
    assert_int_equal(temperature.temperature_dc, -178); /* (-0.1 - 32) * 50 / 9 = -178.3 */
}

TEST(an_error_of_the_temperature_writes_nothing)
{
    desk_start();
    assert_int_equal(desk_play(read_temperature, ROWS({ASK_4, FATHOM_ERR_CHECKSUM, {0, 0, 0, 0}, 0})),
                     FATHOM_ERR_CHECKSUM);
    desk_assert_guard(&temperature, sizeof temperature);
}
