/* SPDX-License-Identifier: MIT */
/* The program sleeps, wakes late, or its clock jumps: no reading is of another time than its time_us, and none is
 * lost. */
#include "wire_users.h"

enum { SECOND_US = 1000000, TIMEOUT_US = 100000, LONG_SLEEP_US = 300 * SECOND_US };

static void open_user(user_kind_t kind, wire_us_t turn_us, uint64_t seed)
{
    users_forget();
    wire_open(user_byte_us(kind), seed);
    desk_open(DESK_ALL, turn_us, turn_us / 20);
    (void)user_add(kind, 1, 0);
}

/* Polls in turns until the user has a reading, at most for a time. The judge checks its age. */
static bool has_reading(user_t *user, wire_us_t within_us)
{
    for (const wire_us_t end_us = wire.now_us + within_us; wire.now_us < end_us;) {
        desk_turn();
        if (user_poll(user) != FATHOM_OK) continue;
        while (user_poll(user) == FATHOM_OK) { /* the other probes of the same response */
        }
        return true;
    }
    return false;
}

/* 63 bytes, as the receive buffers of common cores. The unit goes on while the board sleeps. */
TEST(after_a_sleep_no_reading_is_of_the_time_before_it)
{
    static const wire_us_t turns_us[] = {1000, 10000, 50000};
    for (unsigned kind = 0; kind != USER_A16_CONTROLLED; kind++)
        for (unsigned t = 0; t != 3; t++) {
            open_user((user_kind_t)kind, turns_us[t], kind);
            wire.ring_size = 63;
            for (unsigned round = 0; round != DESK_SHARE(50u, 3u); round++) {
                for (unsigned i = 0; i != 5; i++) assert_true(has_reading(&users[0], 4 * SECOND_US));
                users_slept(LONG_SLEEP_US);
                wire_run(LONG_SLEEP_US);
                (void)user_poll(&users[0]); /* the judge compares time_us with the measurement */
            }
            assert_int_equal(users[0].chances, 0);
        }
}

/* The same, and the program initialises the line and its driver after each sleep. */
TEST(after_a_sleep_and_init_no_reading_is_of_the_time_before_it)
{
    for (unsigned kind = 0; kind != USER_KINDS; kind++) {
        open_user((user_kind_t)kind, 10000, kind);
        wire.ring_size = 63;
        for (unsigned round = 0; round != DESK_SHARE(50u, 3u); round++) {
            for (unsigned i = 0; i != 5; i++) assert_true(has_reading(&users[0], 4 * SECOND_US));
            user_deinit(&users[0]);
            wire_run(LONG_SLEEP_US);
            if (user_is_stream((user_kind_t)kind))
                assert_int_equal(fathom_line_init_listening(&desk.line, &desk.config), FATHOM_OK);
            else
                assert_int_equal(fathom_line_init(&desk.line, &desk.config), FATHOM_OK);
            user_init(&users[0]);
            assert_int_not_equal(user_poll(&users[0]), FATHOM_OK); /* there is nothing new yet */
        }
    }
}

/* A response that waits in the port is as old as the sleep: up to the time-out and half a second it counts. */
TEST(a_response_that_waited_longer_than_its_time_out_is_no_reading)
{
    static const struct {
        wire_us_t sleep_us;
        bool counts;
    } sleeps[] = {{90000, true},   {300000, true},         {550000, true},
                  {700000, false}, {2 * SECOND_US, false}, {LONG_SLEEP_US, false}};
    for (unsigned t = 1; t <= 20; t++)
        for (size_t s = 0; s != sizeof sleeps / sizeof *sleeps; s++) {
            desk_request_t request = {0};
            wire_open(WIRE_BYTE_9600_US, t);
            wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS, .answer_us = 50000});
            desk_open(DESK_ALL, t * 500, 0);
            desk_run(20000);
            desk_read(&request, 0x0101, 1, TIMEOUT_US, 0);
            while (wire.host_frames == 0) {
                desk_turn();
                (void)fathom_line_poll(&desk.line);
            }
            wire_run(sleeps[s].sleep_us);
            (void)fathom_line_poll(&desk.line);
            if (!sleeps[s].counts) {
                assert_int_not_equal(desk_status(&request), FATHOM_OK);
                assert_true(desk_count(FATHOM_LINE_OLD_BYTES) != 0);
            }
            assert_int_equal(desk_wait(&request, 4 * TIMEOUT_US),
                             sleeps[s].counts ? FATHOM_OK : FATHOM_ERR_NO_RESPONSE);
        }
}

/* A program that sleeps for fathom_due_us() or until a byte arrives, and wakes late. */
static void sleep_late(user_t *user, wire_us_t late_us)
{
    const uint32_t due_us = fathom_due_us(&user->sensor, 1);
    if (wire_waiting() != 0) {
        wire_run(10);
        return;
    }
    wire_sleep(due_us == FATHOM_NO_DEADLINE ? 4 * (wire_us_t)SECOND_US : due_us);
    wire_run(late_us + 1);
}

TEST(a_sleeper_that_wakes_half_a_second_late_loses_no_frame)
{
    static const user_kind_t streams[] = {USER_A16_AUTO, USER_A05_AUTO};
    static const wire_us_t periods_us[] = {100000, 1000000, 1990000, 3000000};
    static const wire_us_t lates_us[] = {0, 1000, 100000, 500000};
    for (unsigned k = 0; k != 2; k++)
        for (unsigned p = 0; p != 4; p++)
            for (unsigned l = 0; l != 4; l++) {
                unsigned frames;
                open_user(streams[k], 1000, p);
                users[0].unit->period_us = periods_us[p];
                desk.turn_us = lates_us[l];
                for (const wire_us_t end_us = wire.now_us + DESK_SHARE(600u, 60u) * SECOND_US;
                     wire.now_us < end_us;) {
                    sleep_late(&users[0], lates_us[l]);
                    (void)user_poll(&users[0]);
                }
                /* Each whole frame is one that was delivered, or that a newer one replaced before it was polled. */
                frames = user_frames(&users[0]);
                assert_int_equal(desk_count(FATHOM_LINE_OLD_BYTES), 0);
                /* All but the first and the last, and one in 50 whose place is not sure (stream.h). */
                assert_in_range(frames + 2, users[0].unit->unsolicited * 98 / 100,
                                users[0].unit->unsolicited + 2);
            }
}

/* A clock that was set back a little stands still. */
TEST(a_clock_that_runs_back_by_50_ms_loses_no_response)
{
    for (unsigned t = 1; t <= 20; t++) {
        desk_request_t request = {0};
        wire_open(WIRE_BYTE_9600_US, t);
        wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS, .answer_us = 80000});
        desk_open(DESK_ALL, t * 500, 0);
        desk_run(20000);
        desk_read(&request, 0x0101, 1, TIMEOUT_US, 0);
        desk_run(20000);
        wire.skew_us = -50000;
        assert_int_equal(desk_wait(&request, 4 * TIMEOUT_US), FATHOM_OK);
    }
}

TEST(bytes_in_the_port_at_init_are_dropped_and_counted)
{
    wire_open(WIRE_BYTE_9600_US, 1);
    wire.noise = (wire_noise_t){.period_us = WIRE_BYTE_9600_US, .next_us = wire.now_us};
    wire_run(200 * WIRE_BYTE_9600_US - 1);
    wire.noise.next_us = WIRE_NEVER;
    wire_run(SECOND_US);
    assert_int_equal(wire_waiting(), 200);
    desk_open(DESK_ALL, 1000, 0);
    desk_run(20000);
    assert_int_equal(desk_count(FATHOM_LINE_OLD_BYTES), 200);
    assert_int_equal(desk_count(FATHOM_LINE_DROPPED_BYTES), 0);
}

/* fathom_line_flush() is for a sleep whose length the clock does not show. */
TEST(after_a_flush_no_reading_is_of_the_time_before_it)
{
    open_user(USER_A16_AUTO, 10000, 1);
    wire.ring_size = 63;
    assert_true(has_reading(&users[0], 2 * SECOND_US));
    wire_run(LONG_SLEEP_US);
    wire.skew_us = -(int64_t)LONG_SLEEP_US; /* the clock stood still */
    fathom_line_flush(&desk.line);
    users[0].since_us = wire.now_us;
    assert_true(has_reading(&users[0], 2 * SECOND_US));
}
TEST(a_clock_that_runs_back_by_50_ms_each_second_makes_no_stream_stale)
{
    for (unsigned kind = USER_HPS167S_AUTO; kind <= USER_A05_AUTO; kind++) {
        open_user((user_kind_t)kind, 2000, kind);
        assert_true(has_reading(&users[0], 2 * SECOND_US));
        for (unsigned second = 0; second != 20; second++) {
            wire.skew_us -= 50000;
            for (const wire_us_t end_us = wire.now_us + SECOND_US; wire.now_us < end_us;) {
                desk_turn();
                const fathom_status_t status = user_poll(&users[0]);
                if (status < 0) print_message("%s: %s\n", user_name(kind), fathom_status_name(status));
                assert_true(status >= 0);
            }
        }
        assert_true(users[0].ready >= 20 * 9);
    }
}

/* fathom_line_break() reads the clock too, and must not hide the pause from the next poll. */
TEST(after_a_sleep_and_a_break_no_reading_is_of_the_time_before_it)
{
    open_user(USER_A05_AUTO, 10000, 1);
    wire.ring_size = 63;
    assert_true(has_reading(&users[0], 2 * SECOND_US));
    users_slept(LONG_SLEEP_US);
    wire_run(LONG_SLEEP_US);
    assert_int_equal(fathom_line_break(&desk.line, true), FATHOM_OK);
    assert_int_equal(fathom_line_break(&desk.line, false), FATHOM_OK);
    (void)has_reading(&users[0], SECOND_US); /* the judge compares time_us with the measurement */
}
