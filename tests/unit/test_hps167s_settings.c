/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

/* Commands #7 and #10 to #15: what stays where it is. */

static fathom_hps167s_t *hps(void) { return &desk.hps; }

static fathom_status_t warm_up(void) { return fathom_hps167s_set_warm_up_s(hps(), (uint8_t)desk.argument); }
static fathom_status_t measures(void)
{
    return fathom_hps167s_set_measures_after_power_on(hps(), desk.argument != 0);
}
static fathom_status_t termination(void) { return fathom_hps167s_set_termination(hps(), desk.argument != 0); }
static fathom_status_t reconnect(void)
{
    return fathom_hps167s_set_reconnect_time_ms(hps(), (uint32_t)desk.argument);
}
static fathom_status_t offset(void)
{
    return fathom_hps167s_set_distance_offset_mm(hps(), (int16_t)desk.argument);
}
static fathom_status_t filter(void)
{
    return fathom_hps167s_set_filter_sensitivity(hps(), (int16_t)desk.argument);
}
static fathom_status_t load_user(void) { return fathom_hps167s_load_user_settings(hps()); }
static fathom_status_t load_factory(void) { return fathom_hps167s_load_factory_settings(hps()); }

#define ASK_1                                                                                                \
    {                                                                                                        \
        {1, 3, 0, 1, 0, 3}, FATHOM_READY, {0x1409, 0x1B02, 0x0100, 0}, 0                                     \
    }
#define TELLS(...)                                                                                           \
    {                                                                                                        \
        {1, 3, 0, 2, 0, 4}, FATHOM_READY, {__VA_ARGS__}, 0                                                   \
    }
#define IS(...) TELLS(__VA_ARGS__), TELLS(__VA_ARGS__) /* two answers that agree */
#define FAILS(s)                                                                                             \
    {                                                                                                        \
        {1, 3, 0, 2, 0, 4}, s, {0, 0, 0, 0}, 0                                                               \
    }

/* Table 12: termination FF, automatic FF, warm-up 5 s, reconnect 180 ms, rate 1. */
#define FACTORY IS(0xFFFF, 0x0500, 0x0000, 0xB401)

/* ---- with read-back ---- */

/* Tables 21, 27, 29 and 37 with the values beside them. */
static const struct {
    fathom_status_t (*set)(void);
    int32_t value;
    row_t write;
    uint16_t after[4];
} changes[] = {
    {warm_up, 9, {{1, 6, 0, 0x0A, 0, 9}, FATHOM_READY, {0}, 0}, {0xFFFF, 0x0900, 0x0000, 0xB401}},
    {warm_up, 255, {{1, 6, 0, 0x0A, 0, 255}, FATHOM_READY, {0}, 0}, {0xFFFF, 0xFF00, 0x0000, 0xB401}},
    {warm_up, 0, {{1, 6, 0, 0x0A, 0, 0}, FATHOM_READY, {0}, 0}, {0xFFFF, 0x0000, 0x0000, 0xB401}},
    {measures, 0, {{1, 6, 0, 0x12, 0, 0}, FATHOM_READY, {0}, 0}, {0xFF00, 0x0500, 0x0000, 0xB401}},
    {termination, 0, {{1, 6, 0, 0x13, 0, 0}, FATHOM_READY, {0}, 0}, {0x00FF, 0x0500, 0x0000, 0xB401}},
    {reconnect, 0, {{1, 0x10, 0, 0x20, 0, 2}, FATHOM_READY, {0, 0}, 0}, {0xFFFF, 0x0500, 0x0000, 0x0001}},
    /* 65556 = 18 * 3642 = 0001 0014 */
    {reconnect,
     65556,
     {{1, 0x10, 0, 0x20, 0, 2}, FATHOM_READY, {1, 20}, 0},
     {0xFFFF, 0x0500, 0x0100, 0x1401}},
};

enum { CHANGES = sizeof changes / sizeof *changes };

DESK_SUITE;

TEST(each_value_is_read_written_once_and_read_back)
{
    for (unsigned i = 0; i != CHANGES; i++) {
        const uint16_t *const r = changes[i].after;
        desk_set_up(NULL);
        desk_start();
        desk.argument = changes[i].value;
        assert_int_equal(
            desk_play(changes[i].set, ROWS(FACTORY, changes[i].write, IS(r[0], r[1], r[2], r[3]))),
            FATHOM_READY);
    }
}

TEST(what_is_so_already_is_not_written)
{
    for (unsigned i = 0; i != CHANGES; i++) {
        const uint16_t *const r = changes[i].after;
        desk_set_up(NULL);
        desk_start();
        desk.argument = changes[i].value;
        assert_int_equal(desk_play(changes[i].set, ROWS(IS(r[0], r[1], r[2], r[3]))), FATHOM_READY);
    }
}

TEST(on_is_ff)
{
    desk_start();
    desk.argument = 1;
    assert_int_equal(desk_play(measures, ROWS(IS(0xFF00, 0x0500, 0x0000, 0xB401),
                                              {{1, 6, 0, 0x12, 0, 0xFF}, FATHOM_READY, {0}, 0}, FACTORY)),
                     FATHOM_READY);
    assert_int_equal(desk_play(termination, ROWS(IS(0x00FF, 0x0500, 0x0000, 0xB401),
                                                 {{1, 6, 0, 0x13, 0, 0xFF}, FATHOM_READY, {0}, 0}, FACTORY)),
                     FATHOM_READY);
}

TEST(a_reconnect_time_is_a_multiple_of_18)
{
    static const uint32_t wrong[] = {1, 17, 19, 181, 0xFFFFFFFF};
    desk_start();
    for (unsigned i = 0; i != 5; i++)
        assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), wrong[i]), FATHOM_ERR_ARGUMENT);
    assert_int_equal(desk.fake.submits + desk.fake.polls, 0);
    /* 4294967292 = 18 * 238609294 */
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), 0xFFFFFFFC), FATHOM_PENDING);
}

TEST(the_reconnect_time_goes_with_its_low_word_first_as_an_option)
{
    desk.config.low_word_first = true;
    desk_start();
    desk.argument = 65556;
    assert_int_equal(desk_play(reconnect, ROWS(IS(0xFFFF, 0x0500, 0x1200, 0x0001), /* 18 ms */
                                               {{1, 0x10, 0, 0x20, 0, 2}, FATHOM_READY, {20, 1}, 0},
                                               IS(0xFFFF, 0x0500, 0x1400, 0x0101))),
                     FATHOM_READY);
}

TEST(a_write_is_not_retried_and_the_readings_are)
{
    desk.config.retries = 3;
    desk_start();
    desk.argument = 9;
    unsigned writes = 0, reads = 0;
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned i = 0; i != 500 && status == FATHOM_PENDING; i++) {
        static const uint16_t before[] = {0xFFFF, 0x0500, 0x0000, 0xB401},
                              after[] = {0xFFFF, 0x0900, 0x0000, 0xB401};
        desk.fake.now_us += desk.step_us;
        status = warm_up();
        if (desk.fake.request == NULL || desk.fake.ends != FATHOM_PENDING) continue;
        const bool is_write = desk.fake.request->message.head[1] == 6;
        assert_int_equal(desk.fake.request->exchange.retries, is_write ? 0 : 3);
        assert_int_equal(desk.fake.request->exchange.timeout_us, 1000000);
        if (is_write)
            fake_modbus_acknowledge(&desk.fake);
        else
            fake_modbus_answer(&desk.fake, writes != 0 ? after : before, 4);
        writes += is_write;
        reads += !is_write;
    }
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(writes, 1);
    assert_int_equal(reads, 4);
}

TEST(what_goes_wrong_is_told_as_it_is)
{
    static const row_t write = {{1, 6, 0, 0x0A, 0, 9}, FATHOM_READY, {0}, 0};
    static const row_t refused = {{1, 6, 0, 0x0A, 0, 9}, FATHOM_ERR_EXCEPTION, {3}, 0};
    static const row_t lost = {{1, 6, 0, 0x0A, 0, 9}, FATHOM_ERR_NO_ANSWER, {0}, 0};
    desk_start();
    desk.argument = 9;
    assert_int_equal(desk_play(warm_up, ROWS(FAILS(FATHOM_ERR_NO_ANSWER))), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, refused)), FATHOM_ERR_EXCEPTION);
    assert_int_equal(desk.hps.unit.request.message.exception, 3);
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, write, FACTORY)), FATHOM_ERR_MALFORMED);
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, write, FAILS(FATHOM_ERR_CHECKSUM))),
                     FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, lost, FACTORY)), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, lost, IS(0xFFFF, 0x0900, 0x0000, 0xB401))),
                     FATHOM_READY);
}

/* ---- write-only ---- */

/* #12: "-15 = 0xFFF1". */
TEST(the_offset_and_the_filter_go_as_int16)
{
    static const struct {
        int32_t value;
        uint8_t high, low;
    } rows[] = {{-15, 0xFF, 0xF1}, {15, 0, 15}, {-32768, 0x80, 0}, {32767, 0x7F, 0xFF}, {-100, 0xFF, 0x9C}};
    desk_start();
    for (unsigned i = 0; i != 5; i++) {
        const row_t twelve = {{1, 6, 0, 0x14, rows[i].high, rows[i].low}, FATHOM_READY, {0}, 0};
        const row_t fourteen = {{1, 6, 0, 0x16, rows[i].high, rows[i].low}, FATHOM_READY, {0}, 0};
        desk.argument = rows[i].value;
        assert_int_equal(desk_play(offset, ROWS(ASK_1, twelve)), FATHOM_READY);
        assert_int_equal(desk_play(filter, ROWS(ASK_1, fourteen)), FATHOM_READY);
    }
}

#define LOAD(value, ends)                                                                                    \
    {                                                                                                        \
        {1, 6, 0, 0x15, 0, value}, ends, {2}, 0                                                              \
    }

TEST(the_users_and_the_factorys_settings_are_loaded_by_functions_of_their_own)
{
    desk_start();
    assert_int_equal(desk_play(load_user, ROWS(ASK_1, LOAD(0, FATHOM_READY))), FATHOM_READY);
    assert_int_equal(desk_play(load_factory, ROWS(ASK_1, LOAD(0xFF, FATHOM_READY))), FATHOM_READY);
}

TEST(one_is_not_taken_for_the_other_while_it_is_under_way)
{
    desk_start();
    assert_int_equal(load_user(), FATHOM_PENDING);
    fake_modbus_answer(&desk.fake, (const uint16_t[]){0x1409, 0x1B02, 0x0100}, 3);
    desk.fake.now_us += 20000;
    assert_int_equal(load_user(), FATHOM_PENDING);
    desk.fake.now_us += 20000;
    assert_int_equal(load_user(), FATHOM_PENDING);
    assert_non_null(desk.fake.request);
    assert_int_equal(desk.fake.request->message.head[5], 0);
    assert_int_equal(load_factory(), FATHOM_ERR_BUSY);
    assert_int_equal(offset(), FATHOM_ERR_BUSY);
    fake_modbus_acknowledge(&desk.fake);
    assert_int_equal(load_factory(), FATHOM_ERR_BUSY);
    assert_int_equal(load_user(), FATHOM_READY);
    assert_int_equal(desk.fake.submits, 2);
}

TEST(a_setting_under_way_is_not_mixed_with_another_value)
{
    desk_start();
    desk.argument = 9;
    assert_int_equal(warm_up(), FATHOM_PENDING);
    desk.argument = 10;
    assert_int_equal(warm_up(), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), 18), FATHOM_ERR_BUSY);
    fathom_hps167s_cancel(hps());
    assert_int_equal(desk_play(warm_up, ROWS(FACTORY, {{1, 6, 0, 0x0A, 0, 10}, FATHOM_READY, {0}, 0},
                                             IS(0xFFFF, 0x0A00, 0x0000, 0xB401))),
                     FATHOM_READY);
}

/* Words that differ in the second place only: 65556 and 65574 ms. */
TEST(both_words_tell_a_reconnect_time_from_another)
{
    desk_start();
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), 65556), FATHOM_PENDING);
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), 65574), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_hps167s_set_reconnect_time_ms(hps(), 65556), FATHOM_PENDING);
}

TEST(a_device_that_is_not_there_is_told_nothing)
{
    static const row_t silence = {{1, 3, 0, 1, 0, 3}, FATHOM_ERR_NO_ANSWER, {0}, 0};
    desk_start();
    desk.argument = -15;
    assert_int_equal(desk_play(offset, &silence, 1), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(filter, &silence, 1), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(load_user, &silence, 1), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_play(load_factory, &silence, 1), FATHOM_ERR_NO_ANSWER);
}

TEST(an_error_of_a_write_only_command_is_told_and_it_is_not_sent_again)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_ECHO, FATHOM_ERR_MALFORMED};
    for (unsigned i = 0; i != 5; i++) {
        desk_set_up(NULL);
        desk.config.retries = 3;
        desk_start();
        assert_int_equal(desk_play(load_factory, ROWS(ASK_1, LOAD(0xFF, errors[i]))), errors[i]);
        desk.fake.now_us += 2000000;
        assert_int_equal(desk_poll(), FATHOM_PENDING);
        fake_modbus_assert_asked(&desk.fake, desk.fake.submits, 1, 0x0008, 4);
    }
}
