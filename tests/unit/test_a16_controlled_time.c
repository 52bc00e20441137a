/* SPDX-License-Identifier: MIT */
#include "controlled_rig.h"

#include <string.h>

#include "suite.h"

static const uint8_t wrong_sum[] = {0xFF, 0x07, 0xA1, 0xA6};

/* ---- in time or not ---- */

/* What begins in time and ends too late is damaged as far as it came: CHECKSUM. */
static const struct {
    uint32_t after_us;
    fathom_status_t status;
    uint16_t late;
} times[] = {
    {30 * MS, FATHOM_ERR_NO_ANSWER, 1},  {79900, FATHOM_ERR_NO_ANSWER, 1},
    {80 * MS, FATHOM_READY, 0},          {94 * MS, FATHOM_READY, 0},
    {114 * MS, FATHOM_READY, 0},         {130 * MS, FATHOM_READY, 0},
    {130200, FATHOM_ERR_CHECKSUM, 1},    {133 * MS, FATHOM_ERR_CHECKSUM, 1},
    {134 * MS, FATHOM_ERR_NO_ANSWER, 1},
};

static const suite_t suite = {.set_up = controlled_set_up};

TEST(a_frame_answers_80_to_130_ms_after_the_edge_and_is_late_else)
{
    for (unsigned i = 0; i != sizeof times / sizeof *times; i++) {
        controlled_start();
        controlled_run_to_break(1, 50);
        controlled_answer(controlled_1953, times[i].after_us);
        assert_int_equal(controlled_outcome(50), times[i].status);
        rig_run(20 * MS, 50);
        assert_int_equal(controlled.a16.late, times[i].late);
        assert_int_equal(rig.samples, times[i].status == FATHOM_READY);
    }
}

TEST(both_ends_of_the_time_are_options)
{
    static const uint32_t after_us[] = {39900, 40 * MS, 60 * MS, 60200};
    controlled.config.earliest_us = 40 * MS;
    controlled.config.latest_us = 60 * MS;
    for (unsigned i = 0; i != 4; i++) {
        controlled_start();
        controlled_run_to_break(1, 50);
        controlled_answer(controlled_1953, after_us[i]);
        assert_int_equal(controlled_outcome(50) == FATHOM_READY, i == 1 || i == 2);
    }
}

TEST(no_answer_is_said_at_130_ms_and_the_next_trigger_follows)
{
    controlled_run_to_break(1, 100);
    rig_run(2 * MS, 100);
    rig_run(127900, 100);
    assert_int_equal(rig.fake.breaks, 1);
    rig.fake.now_us += 100;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(rig.fake.breaks, 2);
}

TEST(a_damaged_answer_is_a_wrong_checksum_and_the_next_one_is_not)
{
    controlled_run_to_break(1, 100);
    controlled_answer(wrong_sum, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_CHECKSUM);
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_NO_ANSWER);
}

/* Bytes before the time of an answer are none. */
TEST(noise_right_after_the_trigger_is_no_damaged_answer)
{
    controlled_run_to_break(1, 100);
    controlled_answer(wrong_sum, 20 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_NO_ANSWER);
    controlled_answer(wrong_sum, 20 * MS);
    controlled_answer(controlled_1953, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_READY);
}

TEST(a_late_answer_is_not_that_of_the_next_trigger_and_the_count_stops)
{
    controlled.a16.late = UINT16_MAX - 1;
    controlled_run_to_break(1, 100);
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(controlled_outcome(100), FATHOM_ERR_NO_ANSWER);
        controlled_answer(controlled_511, 30 * MS); /* of the trigger before, 160 ms after it */
    }
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(controlled.a16.late, UINT16_MAX);
    controlled_answer(controlled_1953, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_READY);
    assert_int_equal(rig.sample.distance_mm, 1953);
}

/* With an answer taken, a second one to the same trigger has no business. */
TEST(a_second_frame_to_one_trigger_is_late)
{
    controlled_run_to_break(1, 100);
    controlled_answer(controlled_1953, 90 * MS);
    controlled_answer(controlled_511, 105 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_READY);
    rig_run(24 * MS, 100);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(controlled.a16.late, 1);
}

/* Stamped at 131 ms, read at 139 ms, when the poll before was at 119 ms: it may have come in time but for the stamp. */
TEST(the_ports_time_stamps_decide_where_there_are_any)
{
    for (uint32_t came_us = 129 * MS; came_us <= 131 * MS; came_us += MS) {
        controlled_start();
        controlled_run_to_break(1, 100);
        const uint32_t edge_us = rig.fake.now_us;
        rig_run(119 * MS, 1 * MS);
        fake_receive_rx(&rig.fake, 20 * MS, controlled_1953, 4,
                        (fathom_rx_t){edge_us + came_us, FATHOM_RX_TIMED});
        assert_int_equal(controlled_outcome(20 * MS),
                         came_us <= 130 * MS ? FATHOM_READY : FATHOM_ERR_NO_ANSWER);
        if (came_us <= 130 * MS) assert_int_equal(rig.sample.time_us, edge_us + came_us);
        if (came_us > 130 * MS) assert_int_equal(controlled.a16.late, 1);
    }
}

/* ---- loops and the clock ---- */

TEST(every_trigger_is_one_sample_in_loops_from_100_us_to_300_ms_and_across_the_wrap)
{
    static const uint32_t steps_us[] = {100, 1000, 3333, 20000, 33000, 300000};
    static const uint32_t starts_us[] = {0,
                                         UINT32_MAX - 1000,
                                         UINT32_MAX - 60000,
                                         UINT32_MAX - 100000,
                                         UINT32_MAX - 250000,
                                         UINT32_C(0x7FFFF000)};
    for (unsigned s = 0; s != sizeof steps_us / sizeof *steps_us; s++) {
        for (unsigned n = 0; n != sizeof starts_us / sizeof *starts_us; n++) {
            unsigned triggers = 0;
            controlled_start_at(starts_us[n]);
            rig.fake.step_us = n % 2 * 7; /* a clock that goes on within a poll */
            while (rig.samples != 6) {
                rig.fake.now_us += steps_us[s];
                const fathom_status_t status = rig_poll();
                assert_true(status == FATHOM_PENDING || status == FATHOM_READY);
                if (status == FATHOM_READY)
                    assert_int_equal(rig.sample.distance_mm, rig.samples % 2 != 0 ? 1953 : 511);
                assert_in_range(rig.fake.breaks, rig.samples, rig.samples + 1);
                if (rig.fake.breaks == triggers) continue;
                triggers++;
                controlled_answer(triggers % 2 != 0 ? controlled_1953 : controlled_511,
                                  90 * MS + triggers % 6 * 4 * MS + FRAME_US);
            }
            assert_int_equal(controlled.a16.late, 0);
        }
    }
}

TEST(who_sleeps_as_long_as_it_is_due_gets_a_sample_a_trigger)
{
    unsigned polls = 0;
    unsigned answered = 0;
    while (rig.samples != 5) {
        uint32_t due_us = fathom_due_us(&rig.sensor, 1);
        assert_true(++polls < 200);
        if (rig.fake.breaks > answered) { /* the bytes wake it */
            answered = rig.fake.breaks;
            fake_receive(&rig.fake, 100 * MS, controlled_1953, 4);
        }
        if (!fake_drained(&rig.fake)) {
            const uint32_t comes_us = rig.fake.chunks[rig.fake.first].at_us - rig.fake.now_us;
            if (comes_us < due_us) due_us = comes_us;
        }
        rig.fake.now_us += due_us;
        rig_poll();
    }
    assert_int_equal(rig.fake.breaks, 5);
    assert_int_equal(controlled.a16.late, 0);
}

/* Its stream has a deadline of its own, 71 minutes, which is no concern of the user's. */
TEST(hours_without_an_answer_are_one_no_answer_a_trigger)
{
    unsigned no_answers = 0;
    for (unsigned i = 0; i != 40000; i++) {
        rig.fake.now_us += 135 * MS;
        rig.fake.busy_until_us = rig.fake.now_us; /* what left 35 minutes ago would come, to the fake */
        const fathom_status_t status = rig_poll();
        assert_true(status == FATHOM_PENDING || status == FATHOM_ERR_NO_ANSWER);
        no_answers += status == FATHOM_ERR_NO_ANSWER;
    }
    assert_true(no_answers > 15000);
    assert_int_equal(rig.stales, 0);
    assert_int_equal(controlled.a16.late, 0);
}
