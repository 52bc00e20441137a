/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #2 and #4. */

static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t configuration(void)
{
    memset(&is, GUARD, sizeof is);
    const fathom_status_t status = fathom_hps167s_get_configuration(&hps, &is);
    if (status != FATHOM_OK) assert_guard(&is, sizeof is);
    return status;
}

static fathom_status_t read_temperature(void)
{
    memset(&temperature, GUARD, sizeof temperature);
    const fathom_status_t status = fathom_hps167s_get_temperature(&hps, &temperature);
    if (status != FATHOM_OK) assert_guard(&temperature, sizeof temperature);
    return status;
}

/* Table 15. */
#define HPS_4(ends, value)                                                                                   \
    {                                                                                                        \
        {1, 3, 0, 4, 0, 1}, ends, {value}, 0                                                                 \
    }

/* Table 12: termination FF, automatic 00, warm-up 5, 00 00 00 B4 = 180 ms, rate 1. */
#define RATE_1   0xFF00, 0x0500, 0x0000, 0xB401
#define RATE_2   0xFF00, 0x0500, 0x0000, 0xB402
#define MEASURES 0x0823, 0xDCB2, 0x0701, 0x0000 /* the example of #5 */

static const uint16_t rate_1[4] = {RATE_1};

HPS_SUITE;

/* ---- #2 ---- */

TEST(every_member_of_the_configuration_is_its_own_bytes)
{
    static const struct {
        uint16_t registers[4];
        bool termination, measures;
        uint8_t warm_up_s;
        uint32_t reconnect_ms, baud;
    } rows[] = {
        {{RATE_1}, true, false, 5, 180, 19200},
        {{0x0000, 0x0000, 0x0000, 0x0001}, false, false, 0, 0, 19200},
        {{0x0000, 0x0000, 0x0000, 0x0000}, false, false, 0, 0, 19200},
        /* 01000000 hexadecimal = 16777216 = 18 * 932067 + 10 */
        {{0x0000, 0x0101, 0x0000, 0x0000}, false, false, 1, 0x01000000, 19200},
        {{0x00FF, 0xFF00, 0x0000, 0x1202}, false, true, 255, 18, 57600},
        {{0xFF00, 0x0500, 0x0000, 0xB403}, true, false, 5, 180, 115200},
        /* 01020307 hexadecimal = 16909063 = 18 * 939392 + 7, so 01020300 */
        {{0xFFFF, 0x0501, 0x0203, 0x0004}, true, true, 5, 0x01020300, 230400},
        /* The highest bit of each byte set: FEDCBA98 = 4275878552 = 18 * 237548808 + 8, so FEDCBA90 */
        {{0x00FF, 0x05FE, 0xDCBA, 0x9001}, false, true, 5, 0xFEDCBA90, 19200},
        /* 000003E8 = 1000 = 18 * 55 + 10; #9: "the others are all 19200bps" */
        {{0xFFFF, 0x0500, 0x0003, 0xE800}, true, true, 5, 1000, 19200},
        {{0xFFFF, 0x0500, 0x0000, 0x0105}, true, true, 5, 1, 19200},
        {{0x0000, 0x00FF, 0xFFFF, 0xFFFF}, false, false, 0, 0xFFFFFFFF, 19200},
    };
    for (unsigned i = 0; i != COUNT(rows); i++) {
        const uint16_t *const r = rows[i].registers;
        hps_set_up(NULL);
        PLAY(configuration, OK, TELLS(r[0], r[1], r[2], r[3]));
        assert_int_equal(is.termination, rows[i].termination);
        assert_int_equal(is.measures_after_power_on, rows[i].measures);
        assert_int_equal(is.warm_up_s, rows[i].warm_up_s);
        assert_int_equal(is.reconnect_time_ms, rows[i].reconnect_ms);
        assert_int_equal(is.baud, rows[i].baud);
        assert_int_equal(is.baud_code, r[3] % 256);
    }
}

/* The same bytes by themselves and as a response: 255 mm that hold, or a response that comes late. */
TEST(what_is_heard_unasked_between_two_responses_takes_away_their_agreement)
{
    PART(configuration, HPS_2(1, OK, 0, RATE_1));
    PENDS(configuration());
    assert_false(fathom_hps167s_accept_unsolicited(&hps, rate_1, fake.now_us));
    PLAY(configuration, OK, TELLS(RATE_1), HPS_2(1, OK, 0, RATE_1));
    /* but not the one response that is still to come, where a measurement was taken for it */
    PART(configuration, HPS_2(1, OK, 0, RATE_1), HPS_2(1, OK, 0, MEASURES));
    PENDS(configuration());
    assert_false(fathom_hps167s_accept_unsolicited(&hps, rate_1, fake.now_us));
    PLAY(configuration, OK, TELLS(RATE_1));
    /* and only one: what comes after it takes it away */
    PART(configuration, HPS_2(1, OK, 0, RATE_1), HPS_2(1, OK, 0, MEASURES));
    PENDS(configuration());
    for (unsigned i = 0; i != 2; i++)
        assert_false(fathom_hps167s_accept_unsolicited(&hps, rate_1, fake.now_us));
    PLAY(configuration, OK, TELLS(RATE_1), HPS_2(1, OK, 0, RATE_1));
}

#define TWICE HPS_2(1, OK, 0, RATE_1), HPS_2(1, OK, 0, RATE_2)

TEST(after_eight_responses_without_agreement_it_gives_up)
{
    PLAY(configuration, FATHOM_ERR_MALFORMED, TWICE, TWICE, TWICE, TWICE);
    /* the next time counts anew: one more of the last kind is no agreement */
    PLAY(configuration, OK, TELLS(RATE_2));
}

/* Among unsolicited frames it is read 32 times: this row each time, and then the next call sees the last response. */
static void reads_32(const row_t *row)
{
    row_t rows[32];
    for (unsigned i = 0; i != COUNT(rows); i++) memcpy(&rows[i], row, sizeof *row);
    desk_part(configuration, rows, COUNT(rows));
}

static void never_believes(const row_t *row)
{
    reads_32(row);
    fathom_status_t status;
    while ((status = configuration()) == FATHOM_PENDING) {
        fake.now_us += 1000;
        assert_int_equal(fake.submits, 0);
    }
    assert_int_equal(status, FATHOM_ERR_MALFORMED);
}

/* The one response that is still to come has a measurement's shape: until the command's time-out (1 s) has passed there
 * is no outcome, and nothing is asked. */
TEST(where_unasked_frames_were_taken_for_it_it_gives_up_when_no_response_can_come_any_more)
{
    const row_t row = HPS_2(1, OK, 0, MEASURES);
    reads_32(&row);
    PENDS(configuration());
    fake.now_us += 999999;
    PENDS(configuration());
    desk_waits(0); /* nor is measured: that would put off the end */
    assert_int_equal(fathom_due_us(&desk.sensor, 1), 1);
    fake.now_us++;
    assert_int_equal(configuration(), FATHOM_ERR_MALFORMED);
    assert_int_equal(fake.submits, 0); /* since the last */
    /* and where there are none, at once */
    hps_set_up(NULL);
    PART(configuration, TWICE, TWICE, TWICE, TWICE);
    assert_int_equal(configuration(), FATHOM_ERR_MALFORMED);
}

/* Each differs from a response to #2 in one thing. */
TEST(what_cannot_be_a_response_to_2_never_counts)
{
    static const uint16_t wrong[][4] = {
        {0x01FF, 0x0500, 0x0000, 0xB401},
        {0xFF01, 0x0500, 0x0000, 0xB401},
        {0xFEFF, 0x0500, 0x0000, 0xB401},
        {0xFFFE, 0x0500, 0x0000, 0xB401},
        /* the abnormal packet of #5, whose exponent is not named */
        {0xFFFF, 0x0000, 0x00FF, 0xFFFF},
        {0xFFFF, 0x0000, 0x07FF, 0xFFFF},
        {0xFFFF, 0x0000, 0xFFFF, 0xFFFF},
    };
    for (unsigned i = 0; i != COUNT(wrong); i++) {
        const uint16_t *const r = wrong[i];
        const row_t row = HPS_2(1, OK, 0, r[0], r[1], r[2], r[3]);
        hps_set_up(NULL);
        assert_false(fathom_hps167s_may_be_configuration(r));
        never_believes(&row);
    }
}

/* A target at exactly 255 mm with just these figures, sent unasked: it was measured just before. */
TEST(what_was_measured_last_is_no_configuration)
{
    static const uint16_t near[4] = {0x00FF, 0x0000, 0x0000, 0xB401};
    const row_t row = HPS_2(1, OK, 0, 0x00FF, 0x0000, 0x0000, 0xB401);
    const row_t next = HPS_2(1, OK, 0, 0x00FF, 0x0000, 0x0000, 0xB402);
    PLAY(desk_poll, OK, HPS_5(OK, 0x00FF, 0x0000, 0x0000, 0xB401));
    assert_int_equal(desk.sample.distance_mm, 255);
    assert_true(fathom_hps167s_may_be_configuration(near));
    never_believes(&row);
    PLAY(configuration, OK, HPS_2(1, OK, 0, MEASURES), row, row, row); /* it is not the last any more */
    PLAY(desk_poll, OK, HPS_5(OK, 0x00FF, 0x0000, 0x0000, 0xB402));
    never_believes(&next);
}

/* An unasked frame was taken for the response, and the response comes when a measurement is being waited for:
 * termination off; or 255 mm. */
TEST(what_was_told_last_is_no_measurement)
{
    /* what lies behind the four registers, as 255 mm do behind what was reported, is none of them */
    static const uint16_t registers[5] = {0x00FF, 0x0500, 0x0000, 0xB401, 0x00FF};
    PLAY(configuration, OK, TELLS(0x00FF, 0x0500, 0x0000, 0xB401));
    PLAY(desk_poll, FATHOM_ERR_MALFORMED, HPS_5(OK, 0x00FF, 0x0500, 0x0000, 0xB401));
    assert_int_equal(hps.implausible, 1);
    PLAY(desk_poll, OK, HPS_5(OK, 0x00FF, 0x0500, 0x0000, 0xB402));
    assert_int_equal(desk.sample.distance_mm, 255);
    assert_false(fathom_hps167s_accept_unsolicited(&hps, registers, fake.now_us));
}

/* modbus_unit.h, rule 5: the responses of a read that was abandoned do not count for the next one. */
TEST(the_responses_of_an_abandoned_configuration_do_not_count)
{
    PART(configuration, HPS_2(1, OK, 0, RATE_2));
    PENDS(configuration());
    fake.now_us += 20000; /* more than the pace */
    PENDS(configuration());
    assert_non_null(fake.request); /* the second read, for which the program does not call again */
    for (unsigned i = 0; fake.cancels == 0; i++) {
        assert_true(i != 51);
        PENDS(desk_poll_after(100000));
    }
    desk_waits(20000);
    fake_modbus_response(&fake, hps_measured, 4);
    assert_int_equal(desk_poll(), OK);
    fake.submits = 0;
    PLAY(configuration, OK, TELLS(RATE_2));
}

/* 01000008 hexadecimal = 16777224. */
TEST(the_first_configuration_is_believed_whatever_stood_in_the_memory)
{
    static const uint16_t first[4] = {0x0000, 0x0101, 0x0000, 0x0801};
    memcpy(hps.last_measurement, first, sizeof first);
    hps_start();
    PLAY(configuration, OK, TELLS(0x0000, 0x0101, 0x0000, 0x0801));
    assert_int_equal(is.warm_up_s, 1);
    assert_int_equal(is.reconnect_time_ms, 16777224);
}

/* ---- how often it is asked ---- */

static uint32_t due_us(void) { return desk.sensor.due_us(desk.sensor.ctx); }

/* Calls until the next request is under way. */
static void asks(fathom_status_t (*command)(void))
{
    for (unsigned i = 0; fake.request == NULL || fake.ends != FATHOM_PENDING; i++) {
        assert_true(i < 1000);
        PENDS(command());
        if (fake.request == NULL) fake.now_us += 1000;
    }
}

/* hps167s_info.h: the requests come at irregular intervals, or a slow loop could keep step with the device. Of 31
 * intervals, at least one is in each eighth of the device's period. */
TEST(after_a_measurement_in_the_place_of_a_response_the_intervals_keep_no_step_with_the_device)
{
    enum { PARTS = 8, READS = 31 };
    unsigned in_part[PARTS] = {0};
    for (uint32_t n = 0; n != READS; n++) {
        asks(configuration);
        fake_modbus_response(&fake, hps_measured, 4);
        PENDS(configuration());
        assert_in_range(due_us(), FATHOM_HPS167S_MIN_PERIOD_US,
                        FATHOM_HPS167S_MIN_PERIOD_US + 131070); /* 2 * 65535 */
        in_part[due_us() % FATHOM_HPS167S_MIN_PERIOD_US * PARTS / FATHOM_HPS167S_MIN_PERIOD_US]++;
        fake.submits = 0;
    }
    for (unsigned i = 0; i != PARTS; i++) assert_true(in_part[i] != 0);
}

TEST(among_measured_frames_that_were_heard_it_is_asked_out_of_step_from_the_first_response_on)
{
    assert_true(fathom_hps167s_accept_unsolicited(&hps, hps_measured, fake.now_us));
    asks(configuration);
    fake_modbus_response(&fake, rate_1, 4);
    PENDS(configuration());
    assert_in_range(due_us(), FATHOM_HPS167S_MIN_PERIOD_US + 1, FATHOM_HPS167S_MIN_PERIOD_US + 131070);
}

static fathom_status_t set_termination(void) { return fathom_hps167s_set_termination(&hps, false); }

/* FATHOM_ERR_BUSY: "another command or setting is not finished": that one does not notice. */
TEST(who_is_told_busy_costs_a_setting_no_response)
{
    asks(set_termination);
    fake_modbus_response(&fake, rate_1, 4);
    PENDS(set_termination()); /* one of two */
    assert_int_equal(configuration(), FATHOM_ERR_BUSY);
    PLAY(set_termination, OK, HPS_2(1, OK, 0, RATE_1), {{1, 6, 0, 0x13, 0, 0}, OK, {0}, 0},
         TELLS(0x0000, 0x0500, 0x0000, 0xB401));
}

/* ---- its options ---- */

TEST(how_many_responses_have_to_agree_is_an_option)
{
    static const row_t eight[] = {TELLS(RATE_1), TELLS(RATE_1), TELLS(RATE_1), TELLS(RATE_1)};
    static const uint8_t responses[] = {1, 3, 8};
    for (unsigned i = 0; i != COUNT(responses); i++) {
        hps_config.same_responses = responses[i];
        hps_start();
        assert_int_equal(desk_play(configuration, eight, responses[i]), OK);
    }
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
    for (unsigned i = 0; i != COUNT(rows); i++) {
        PLAY(read_temperature, OK, HPS_4(OK, rows[i].raw));
        assert_int_equal(temperature.fahrenheit, rows[i].fahrenheit);
        assert_int_equal(temperature.temperature_dc, rows[i].temperature_dc);
    }
}

/* 5931 degF are 32771.7 tenths, -5867 are -32772.2, and the ends of int16. */
TEST(a_temperature_that_does_not_fit_is_refused)
{
    static const uint16_t wrong[] = {5931, 0x7FFF, 0xE915, 0x8000};
    for (unsigned i = 0; i != 4; i++) PLAY(read_temperature, FATHOM_ERR_MALFORMED, HPS_4(OK, wrong[i]));
}

TEST(the_temperature_can_count_in_finer_steps)
{
    hps_config.steps_per_degree = 10;
    hps_start();
    PLAY(read_temperature, OK, HPS_4(OK, 770));
    assert_int_equal(temperature.fahrenheit, 770);
    assert_int_equal(temperature.temperature_dc, 250);
    PLAY(read_temperature, OK, HPS_4(OK, 0xFFFF));
    assert_int_equal(temperature.temperature_dc, -178); /* (-0.1 - 32) * 50 / 9 = -178.3 */
}

/* "for 2 s", and if more are asked for, more. */
TEST(after_an_unsolicited_frame_three_responses_have_to_agree_for_2_s)
{
    static const row_t four[] = {TELLS(RATE_1), TELLS(RATE_1)};
    static const struct {
        uint32_t after_us;
        uint8_t same_responses, needed;
    } rows[] = {{0, 1, 3}, {0, 2, 3}, {1000000, 2, 3}, {0, 4, 4}, {2000000, 2, 2}, {2000000, 1, 1}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        hps_set_up(NULL);
        hps_config.same_responses = rows[i].same_responses;
        hps_start();
        assert_true(fathom_hps167s_accept_unsolicited(&hps, hps_measured, fake.now_us));
        fake.now_us += rows[i].after_us;
        assert_int_equal(desk_play(configuration, four, rows[i].needed), OK);
    }
}

TEST(the_2_s_are_exact)
{
    hps_config.same_responses = 1;
    for (uint32_t before_us = 1999999; before_us <= 2000000; before_us++) {
        hps_start();
        assert_true(fathom_hps167s_accept_unsolicited(&hps, hps_measured, fake.now_us - before_us));
        asks(configuration);
        fake_modbus_response(&fake, rate_1, 4);
        assert_int_equal(configuration(), before_us == 1999999 ? FATHOM_PENDING : OK);
    }
}
