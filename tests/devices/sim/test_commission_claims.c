/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* What the headers say of every command: one at a time, across the wrap of the clock at any step, left alone less and
 * less often, and back at once. */

static void with_a_second(const job_t *first, const job_t *second)
{
    set_up_for(first, 20 * MS, FATHOM_LINE_ECHO_AUTO);
    const uint32_t start_us = s.clock.now_us;
    unsigned refused = 0;
    fathom_status_t status;
    while ((status = first->call()) == FATHOM_PENDING) {
        const fathom_status_t other = second->call();
        if (other != FATHOM_ERR_BUSY) fail_msg("%s during %s: %d", second->name, first->name, (int)other);
        refused++;
        assert_ends(start_us);
        pass();
    }
    assert_int_equal(status, FATHOM_OK);
    assert_true(refused != 0);
    assert_int_equal(first->has(), first->wanted);
    assert_int_equal(kept_commands(), first->kind == READS ? 0 : 1);
    assert_int_not_equal(second->call(), FATHOM_ERR_BUSY); /* its turn now */
}

/*
 * What is write-only begins with a request that others ask too, and as long as that is not answered neither has begun:
 * who is called next gets the response. The other one is BUSY; nothing is lost, and nothing is written that its caller
 * does not know of.
 */
static void one_of_the_two(const job_t *first, const job_t *second)
{
    set_up_for(first, 20 * MS, FATHOM_LINE_ECHO_AUTO);
    const job_t *const both[] = {first, second};
    const uint32_t start_us = s.clock.now_us;
    bool is_over[2] = {false, false};
    uint32_t expected = 0;
    while (!is_over[0] || !is_over[1]) {
        for (unsigned i = 0; i != 2; i++) {
            if (is_over[i]) continue;
            const fathom_status_t status = both[i]->call();
            if (status == FATHOM_PENDING || status == FATHOM_ERR_BUSY) continue;
            assert_int_equal(status, FATHOM_OK);
            is_over[i] = true;
            if (both[i]->kind != READS) expected++;
        }
        assert_ends(start_us);
        pass();
    }
    assert_int_equal(kept_commands(), expected);
}

/* Two starts: none of these is about the time that there is; the wrap has a test of its own. */
static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(a_command_is_busy_for_as_long_as_another_is_not_finished)
{
    for (const job_t *first = jobs; first != jobs + jobs_count; first++)
        for (const job_t *second = jobs; second != jobs + jobs_count; second++) {
            if (first->model != second->model || first->unit != second->unit || first->call == second->call)
                continue;
            if (first->kind == KEPT || first->kind == MOVES)
                with_a_second(first, second);
            else if (second->kind == READS || second->kind == WRITE_ONLY)
                one_of_the_two(first, second);
        }
}

TEST(the_clock_may_wrap_at_any_step)
{
    const uint32_t start_us = bench_start_us;
    for (unsigned j = 0; j != jobs_count; j++)
        for (uint32_t before_us = 0; before_us < 3 * SECOND; before_us += 61 * MS + 7) {
            bench_start_us = (uint32_t)(0u - before_us);
            set_up_for(&jobs[j], loops_us[(before_us & 1) == 0], FATHOM_LINE_ECHO_AUTO);
            assert_int_equal(carry_out(jobs[j].call), FATHOM_OK);
            assert_int_equal(jobs[j].has(), jobs[j].wanted);
            assert_true(recovers());
        }
    bench_start_us = start_us;
}

static uint32_t time_of_next_outcome_us(fathom_status_t expected)
{
    const uint32_t start_us = s.clock.now_us;
    assert_int_equal(measure(), expected);
    return since_us(start_us);
}

TEST(a_dead_unit_is_left_alone_for_longer_and_longer_but_for_commands)
{
    /* Time-outs of fathom_poll: a16_modbus.h, a05_modbus.h, a05_dyp.h, hps167s.h. */
    static const uint32_t timeouts_us[] = {1 * SECOND, 600 * MS, 500 * MS, 500 * MS};
    for (unsigned j = 0; j != jobs_count; j++) {
        const uint32_t timeout_us = timeouts_us[jobs[j].model];
        set_up_for(&jobs[j], 0, FATHOM_LINE_ECHO_AUTO);
        fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
        for (unsigned n = 0; n != 3; n++) (void)time_of_next_outcome_us(FATHOM_ERR_NO_RESPONSE);
        /* The quarantine is waited for meanwhile: two time-outs from one request to the next at least. */
        for (uint32_t alone = 1; alone <= 16; alone *= 2) {
            const uint32_t took_us = time_of_next_outcome_us(FATHOM_ERR_NO_RESPONSE);
            assert_in_range(took_us, (alone + 1) * timeout_us, (alone + 1) * timeout_us + 50 * MS);
        }
        /* A command is asked at once; no device is there. */
        const uint32_t start_us = s.clock.now_us;
        assert_int_equal(carry_out(jobs[j].call), FATHOM_ERR_NO_RESPONSE);
        assert_true(since_us(start_us) <= 3 * SECOND);
        assert_int_equal(kept_commands(), 0);
        /* Back again: a command finds it at once, and with its response the measurement goes on as before. */
        attach(bench.device);
        rest(2 * SECOND);
        assert_int_equal(carry_out(jobs[j].call), FATHOM_OK);
        assert_true(time_of_next_outcome_us(FATHOM_OK) <= SECOND);
    }
}

TEST(a_broken_port_is_said_by_every_poll_until_it_works_again)
{
    for (unsigned j = 0; j != jobs_count; j++) {
        set_up_for(&jobs[j], 1 * MS, FATHOM_LINE_ECHO_AUTO);
        assert_int_equal(measure(), FATHOM_OK);
        while (fathom_poll(&s.sensor, &s.sample) == FATHOM_OK) continue;
        s.broken = -1;
        for (unsigned i = 0; i != 50; i++) {
            assert_int_equal(fathom_poll(&s.sensor, &s.sample), FATHOM_ERR_PORT);
            assert_int_equal(jobs[j].call(), FATHOM_ERR_PORT);
            pass_us(1 * MS);
        }
        s.broken = 0;
        assert_int_equal(measure(), FATHOM_OK);
        assert_int_equal(carry_out(jobs[j].call), FATHOM_OK);
        assert_int_equal(jobs[j].has(), jobs[j].wanted);
    }
}
