/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Every command and setting, interrupted after each of its steps: given up, by power-on, by another driver that cancels
 * all requests to the unit, by a port that breaks for a while, by a device that loses its power. */

static unsigned problems;
/* Of `job`, after `what`. */
#define problem(...)                                                                                         \
    (print_error("%s, %s: ", job->name, what), print_error(__VA_ARGS__), print_error("\n"), problems++)

typedef enum { GIVE_UP, POWER_ON, CANCEL_UNIT, BREAK_PORT, UNPLUG, CUT_POWER, ACTS } act_t;
static const char *const act_names[] = {"given up",    "power-on",         "cancel_unit",
                                        "port broken", "port broken long", "power cut"};

/* OK, or an error, after which the device has what the outcome says. */
static void judge(const job_t *job, fathom_status_t status, const char *what)
{
    const uint32_t has = job->has();
    if (kept_commands() > 1) problem("%u commands kept", (unsigned)kept_commands());
    if (has != job->before && has != job->wanted) problem("has %u", (unsigned)has);
    if (status == FATHOM_OK && has != job->wanted) problem("READY, but it is not so");
    if (status == FATHOM_OK || status == FATHOM_ERR_UNCONFIRMED) return;
    if (status == FATHOM_ERR_BUSY || status == FATHOM_ERR_IN_USE || status == FATHOM_ERR_ARGUMENT)
        problem("says %s", fathom_status_name(status));
    if (has != job->before && job->kind != WRITE_ONLY)
        problem("%s, but it was changed", fathom_status_name(status));
}

/* The job until its end, with a port that may be broken for the first `broken` rounds. */
static fathom_status_t go_on(const job_t *job, unsigned broken)
{
    const uint32_t start_us = s.clock.now_us;
    for (unsigned round = 0;; round++) {
        s.broken = round < broken ? -1 : 0;
        const fathom_status_t status = job->call();
        if (status != FATHOM_PENDING) return status;
        (void)fathom_poll(&s.sensor, &s.sample);
        if (s.broken != 0)
            pass_us(1 * MS);
        else
            pass();
        assert_ends(start_us);
    }
}

static void expect_works(const job_t *job, bool may_move, const char *what)
{
    s.broken = 0;
    /* The warm-up too: so long silence at a new place does not prove that no device is there. */
    rest(8 * SECOND);
    if (!same_place() && !(s.model == HPS && s.driver.hps.is_seeking)) {
        if (job->kind != MOVES || !may_move || kept_commands() == 0) problem("driver and device apart");
        return;
    }
    if (!recovers()) problem("does not work afterwards");
    const fathom_status_t again = carry_out(job->call);
    if (again != FATHOM_OK) problem("then %d", (int)again);
    if (job->kind == KEPT && job->has() != job->wanted) problem("then not so");
    if (kept_commands() > (job->kind == KEPT ? 1u : 2u))
        problem("%u commands kept", (unsigned)kept_commands());
    if (!recovers()) problem("set again, then it does not work");
}

/* False: the job had ended before that step. */
static bool interrupted(const job_t *job, unsigned act, unsigned step, uint32_t loop_us, uint8_t echo)
{
    char what[80];
    set_up_for(job, loop_us, echo);
    snprintf(what, sizeof what, "%s after %u steps of %u us", act_names[act], step, (unsigned)loop_us);
    for (unsigned i = 0; i != step; i++)
        if (round_of(job->call) != FATHOM_PENDING) return false;
    switch (act) {
    case GIVE_UP:
    case POWER_ON:
        if (act == GIVE_UP)
            cancel();
        else
            power_on();
        if (unit_of()->address != job->unit) problem("not where it was");
        expect_works(job, true, what);
        return true;
    case CANCEL_UNIT:
        fathom_line_cancel_unit(&s.line, unit_of()->address);
        break;
    case CUT_POWER:
        fathom_sim_power_cycle(&bench.line, bench.device, 300 * MS, s.clock.now_us);
        break;
    default:
        break;
    }
    const fathom_status_t status = go_on(job, act == BREAK_PORT ? 1 : act == UNPLUG ? 3000 : 0);
    judge(job, status, what);
    expect_works(job, status == FATHOM_ERR_UNCONFIRMED, what);
    return true;
}

/* Each start of the clock takes every fifth step, so that with FATHOM_LONG each step is taken. The steps of two starts
 * are enough where not: the kinds of interruption and the loops begin at different ones. */
static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(whatever_interrupts_a_command_it_ends_as_it_says_and_works_again)
{
    static unsigned start; /* which one of bench_starts_us */
    for (unsigned j = 0; j != jobs_count; j++)
        for (unsigned act = 0; act != ACTS; act++)
            for (unsigned l = 0; l != 2; l++) {
                unsigned step = (start + 2 * (act + l)) % BENCH_STARTS;
                while (interrupted(&jobs[j], act, step, loops_us[l], (uint8_t)(step % 3)))
                    step += BENCH_STARTS;
            }
    start++;
    assert_int_equal(problems, 0);
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
