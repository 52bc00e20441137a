/* SPDX-License-Identifier: MIT */
/*
 * What a program or a port leaves unfinished: an abandoned command, a line that is initialised over its queue, a
 * held break, a port that accepts no bytes. Each driver that is polled still has an outcome within its bound, and
 * the line works again as soon as the obstacle has gone. user_poll() checks the bound.
 */
#include "wire_users.h"

enum { SECOND_US = 1000000, TIMEOUT_US = 100000 };

static const wire_us_t turns_us[] = {1000, 10000, 50000};
enum { TURNS = sizeof turns_us / sizeof *turns_us };

/* One driver of a kind on its line. A listening line has no queue. */
static user_t *open_user(user_kind_t kind, wire_us_t turn_us)
{
    users_forget();
    wire_open(user_byte_us(kind), kind + 1u);
    desk_open(DESK_ALL, turn_us, turn_us / 20);
    return user_add(kind, 1, 1);
}

static void poll_users(wire_us_t for_us)
{
    for (const wire_us_t end_us = wire.now_us + for_us; wire.now_us < end_us;) {
        desk_turn();
        for (unsigned i = 0; i != user_count; i++) (void)user_poll(&users[i]);
    }
}

static void expect_readings(void)
{
    unsigned before[USERS];
    for (unsigned i = 0; i != user_count; i++) before[i] = users[i].ready;
    poll_users(10u * SECOND_US);
    for (unsigned i = 0; i != user_count; i++) assert_true(users[i].ready > before[i]);
}

/* The obstacle is there for 30 s, and then goes. */
static void poll_through(bool *obstacle)
{
    *obstacle = true;
    poll_users(30u * SECOND_US);
    *obstacle = false;
    expect_readings();
}

static void through_obstacle(bool *obstacle, bool for_streams)
{
    for (unsigned kind = 0; kind != USER_KINDS; kind++) {
        if (user_is_stream((user_kind_t)kind) && !for_streams) continue;
        for (unsigned t = 0; t != TURNS; t++) {
            (void)open_user((user_kind_t)kind, turns_us[t]);
            expect_readings();
            poll_through(obstacle);
        }
    }
}

TEST(a_port_that_accepts_no_bytes_ends_each_wait) { through_obstacle(&wire.takes_no_bytes, false); }
TEST(a_port_that_fails_to_write_ends_each_wait) { through_obstacle(&wire.fails_to_write, false); }
TEST(a_port_that_never_finishes_sending_ends_each_wait) { through_obstacle(&wire.never_sends, false); }
TEST(a_port_that_refuses_a_break_ends_each_wait) { through_obstacle(&wire.refuses_break, true); }

TEST(a_silent_unit_ends_each_wait_in_spite_of_the_back_off)
{
    for (unsigned kind = 0; kind != USER_KINDS; kind++)
        for (unsigned t = 0; t != TURNS; t++) {
            user_t *const user = open_user((user_kind_t)kind, turns_us[t]);
            expect_readings();
            user->unit->is_dead = true;
            const wire_us_t period_us = user->unit->next_frame_us;
            user->unit->next_frame_us = WIRE_NEVER;
            poll_users(60u * SECOND_US);
            user->unit->is_dead = false;
            user->unit->next_frame_us = period_us != WIRE_NEVER ? wire.now_us : WIRE_NEVER;
            expect_readings();
        }
}

/* The sensor of the same line that goes on being polled is not held up by it. */
TEST(an_abandoned_command_holds_up_no_other_sensor)
{
    for (unsigned t = 0; t != TURNS; t++) {
        static fathom_hps167s_t abandoned;
        fathom_hps167s_version_t version;
        (void)open_user(USER_HPS167S, turns_us[t]);
        wire_add(&(wire_unit_t){.kind = WIRE_HPS167S, .address = 2, .answer_us = 2000});
        const fathom_hps167s_config_t config = {.modbus = {.address = 2}};
        assert_int_equal(fathom_hps167s_init(&abandoned, &desk.modbus, &config), FATHOM_OK);
        expect_readings();
        assert_int_equal(fathom_hps167s_get_interface_version(&abandoned, &version), FATHOM_PENDING);
        poll_users(60u * SECOND_US);
        expect_readings();
    }
}

TEST(an_abandoned_setting_holds_up_no_other_sensor)
{
    for (unsigned t = 0; t != TURNS; t++) {
        static fathom_hps167s_t abandoned;
        (void)open_user(USER_HPS167S, turns_us[t]);
        wire_add(&(wire_unit_t){.kind = WIRE_HPS167S, .address = 2, .answer_us = 2000});
        const fathom_hps167s_config_t config = {.modbus = {.address = 2}};
        assert_int_equal(fathom_hps167s_init(&abandoned, &desk.modbus, &config), FATHOM_OK);
        for (unsigned polls = 1; polls != 40; polls++) { /* it stops in each of its steps */
            fathom_hps167s_cancel(&abandoned);
            for (unsigned i = 0; i != polls; i++) {
                desk_turn();
                (void)fathom_hps167s_set_measures_after_power_on(&abandoned, polls % 2 != 0);
            }
            users_slept(polls * desk.turn_us * 2);
            poll_users(2u * SECOND_US);
        }
        expect_readings();
    }
}

TEST(a_held_break_ends_each_wait)
{
    for (unsigned kind = 0; kind != USER_KINDS; kind++) {
        if (user_is_stream((user_kind_t)kind)) continue;
        for (unsigned t = 0; t != TURNS; t++) {
            (void)open_user((user_kind_t)kind, turns_us[t]);
            expect_readings();
            while (fathom_line_break(&desk.line, true) != FATHOM_OK) poll_users(turns_us[t]);
            poll_users(30u * SECOND_US);
            assert_int_equal(fathom_line_break(&desk.line, false), FATHOM_OK);
            expect_readings();
        }
    }
}

/* After a watchdog or a lost cable a program initialises its line, and forgets its drivers. */
TEST(a_line_that_is_initialised_over_its_queue_ends_each_wait)
{
    for (unsigned kind = 0; kind != USER_KINDS; kind++) {
        if (user_is_stream((user_kind_t)kind)) continue;
        for (unsigned t = 0; t != TURNS; t++) {
            (void)open_user((user_kind_t)kind, turns_us[t]);
            for (unsigned round = 0; round != 40; round++) { /* in each phase of a request */
                poll_users(round * 7000u);
                desk_init_line();
                poll_users(6u * SECOND_US);
            }
            expect_readings();
        }
    }
}
TEST(a_port_that_fails_to_read_ends_each_wait) { through_obstacle(&wire.fails_to_read, true); }
