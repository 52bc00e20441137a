/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* What the headers say of every command: one at a time, across the wrap of the clock at any step, left alone less and
 * less often, and back at once. */

/* ---- one at a time ---- */

static void with_a_second(const job_t *first, const job_t *second)
{
    static commission_t s;
    set_up(&s, first->model, first->unit, 20 * MS, FATHOM_LINE_ECHO_AUTO);
    const uint32_t start_us = s.clock.now_us;
    unsigned refused = 0;
    for (;;) {
        const fathom_status_t status = first->call(&s);
        if (status != FATHOM_PENDING) {
            assert_int_equal(status, FATHOM_READY);
            break;
        }
        const fathom_status_t other = second->call(&s);
        if (other != FATHOM_ERR_BUSY) fail_msg("%s during %s: %d", second->name, first->name, (int)other);
        refused++;
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 60 * SECOND);
        pass(&s);
    }
    assert_true(refused != 0);
    assert_int_equal(first->has(&s), first->wanted);
    assert_int_equal(told(&s), first->kind == READS ? 0 : 1);
    assert_int_not_equal(second->call(&s), FATHOM_ERR_BUSY); /* its turn now */
}

/*
 * What is write-only begins with a question that others ask too, and as long as that is not answered neither has begun:
 * who is called next gets the answer. The other one is BUSY; nothing is lost, and nothing is written that its caller
 * does not know of.
 */
static void one_of_the_two(const job_t *first, const job_t *second)
{
    static commission_t s;
    set_up(&s, first->model, first->unit, 20 * MS, FATHOM_LINE_ECHO_AUTO);
    const job_t *const both[] = {first, second};
    const uint32_t start_us = s.clock.now_us;
    bool is_over[2] = {false, false};
    uint32_t expected = 0;
    while (!is_over[0] || !is_over[1]) {
        for (unsigned i = 0; i != 2; i++) {
            if (is_over[i]) continue;
            const fathom_status_t status = both[i]->call(&s);
            if (status == FATHOM_PENDING || status == FATHOM_ERR_BUSY) continue;
            assert_int_equal(status, FATHOM_READY);
            is_over[i] = true;
            if (both[i]->kind != READS) expected++;
        }
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 60 * SECOND);
        pass(&s);
    }
    assert_int_equal(told(&s), expected);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(a_command_is_busy_for_as_long_as_another_is_not_finished)
{
    for (unsigned a = 0; a != jobs_count; a++)
        for (unsigned b = 0; b != jobs_count; b++) {
            const job_t *const first = &jobs[a];
            const job_t *const second = &jobs[b];
            if (first->model != second->model || first->unit != second->unit || first->call == second->call)
                continue;
            if (first->kind == KEPT || first->kind == MOVES)
                with_a_second(first, second);
            else if (second->kind == READS || second->kind == WRITE_ONLY)
                one_of_the_two(first, second);
        }
}

/* ---- the wrap ---- */

TEST(the_clock_may_wrap_at_any_step)
{
    static commission_t s;
    const uint32_t start_us = bench_start_us;
    for (unsigned j = 0; j != jobs_count; j++)
        for (uint32_t before_us = 0; before_us < 3 * SECOND; before_us += 61 * MS + 7) {
            bench_start_us = (uint32_t)(0u - before_us);
            set_up(&s, jobs[j].model, jobs[j].unit, (before_us & 1) != 0 ? 0 : 20 * MS,
                   FATHOM_LINE_ECHO_AUTO);
            assert_int_equal(run(&s, &jobs[j]), FATHOM_READY);
            assert_int_equal(jobs[j].has(&s), jobs[j].wanted);
            assert_true(recovers(&s));
        }
    bench_start_us = start_us;
}

/* ---- a unit that does not answer ---- */

static uint32_t time_of_next_outcome_us(commission_t *s, fathom_status_t expected)
{
    fathom_sample_t sample;
    const uint32_t start_us = s->clock.now_us;
    assert_int_equal(measure(s, &sample), expected);
    return fathom_elapsed_us(s->clock.now_us, start_us);
}

TEST(a_dead_unit_is_left_alone_for_longer_and_longer_but_for_commands)
{
    /* Time-outs of fathom_poll: a16_modbus.h, a05_modbus.h, a05_dyp.h, hps167s.h. */
    static const uint32_t timeouts_us[] = {1 * SECOND, 600 * MS, 500 * MS, 500 * MS};
    for (unsigned j = 0; j != jobs_count; j++) {
        static commission_t s;
        const job_t *const job = &jobs[j];
        const uint32_t timeout_us = timeouts_us[job->model];
        set_up(&s, job->model, job->unit, 0, FATHOM_LINE_ECHO_AUTO);
        fathom_sim_detach(&s.wire, device_of(&s, 0), s.clock.now_us);
        for (unsigned n = 0; n != 3; n++) (void)time_of_next_outcome_us(&s, FATHOM_ERR_NO_ANSWER);
        /* An owed answer is waited for meanwhile: two time-outs from one request to the next at least. */
        for (uint32_t alone = 1; alone <= 16; alone *= 2) {
            const uint32_t took_us = time_of_next_outcome_us(&s, FATHOM_ERR_NO_ANSWER);
            assert_in_range(took_us, (alone + 1) * timeout_us, (alone + 1) * timeout_us + 50 * MS);
        }
        /* A command is asked at once; nobody is there. */
        const uint32_t start_us = s.clock.now_us;
        assert_int_equal(run(&s, job), FATHOM_ERR_NO_ANSWER);
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) <= 3 * SECOND);
        assert_int_equal(told(&s), 0);
        /* Back again: a command finds it at once, and with its answer the measurement goes on as before. */
        fathom_sim_attach(&s.wire, device_of(&s, 0), s.clock.now_us);
        rest(&s, 2 * SECOND);
        assert_int_equal(run(&s, job), FATHOM_READY);
        assert_true(time_of_next_outcome_us(&s, FATHOM_READY) <= SECOND);
    }
}

/* ---- a broken port ---- */

TEST(a_broken_port_is_said_by_every_poll_until_it_works_again)
{
    for (unsigned j = 0; j != jobs_count; j++) {
        static commission_t s;
        fathom_sample_t sample;
        set_up(&s, jobs[j].model, jobs[j].unit, 1 * MS, FATHOM_LINE_ECHO_AUTO);
        const fathom_sensor_t sensor = sensor_of(&s);
        assert_int_equal(measure(&s, &sample), FATHOM_READY);
        while (fathom_poll(&sensor, &sample) == FATHOM_READY) continue;
        s.broken = -1;
        for (unsigned i = 0; i != 50; i++) {
            assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_ERR_PORT);
            assert_int_equal(jobs[j].call(&s), FATHOM_ERR_PORT);
            fathom_sim_clock_advance(&s.clock, 1 * MS);
        }
        s.broken = 0;
        assert_int_equal(measure(&s, &sample), FATHOM_READY);
        assert_int_equal(run(&s, &jobs[j]), FATHOM_READY);
        assert_int_equal(jobs[j].has(&s), jobs[j].wanted);
    }
}
