/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Every command and setting, with every kind of fault at each of its frames in turn. Afterwards the device has to be
 * where the outcome says, it was told at most once, and the driver works. */

enum { RUNS = 120 };
static unsigned problems;
/* Of `job`, after `what`. */
#define problem(...)                                                                                         \
    (print_error("%s, %s: ", job->name, what), print_error(__VA_ARGS__), print_error("\n"), problems++)

#define BIT(kind) FATHOM_SIM_FAULT_BIT(FATHOM_SIM_FAULT_##kind)
/* What can look like a response at an address where no device is, or run into the request there. */
#define ALL_THAT_SEND                                                                                        \
    (BIT(UNASKED) | BIT(NOISE) | BIT(DUPLICATE) | BIT(BREAK) | BIT(LATE) | BIT(DELAY) | BIT(TRAILING) |      \
     BIT(UNIT) | BIT(ECHO))

/*
 * Is it a fault to be tried here? What is measured is no setting. An A16 sends no unsolicited Modbus frame,
 * and one with a distance cannot be told from one with a setting: each has one register.
 */
static bool is_fit(uint8_t kind)
{
    if (s.model == A16 && kind == FATHOM_SIM_FAULT_UNASKED) return false;
    if (!fathom_sim_fault_applies(kind, bench.device)) return false;
    return !(kind == FATHOM_SIM_FAULT_STUCK || kind == FATHOM_SIM_FAULT_INTERFERENCE ||
             kind == FATHOM_SIM_FAULT_FAULT || kind == FATHOM_SIM_FAULT_NO_TARGET);
}

/*
 * Is this what the headers say of the outcome? kinds: of the faults. What cannot be told apart on a wire is excepted:
 * an exception instead of an acknowledgement; a line that begins to echo between the reading and a writing that has no
 * read-back.
 */
static void judge(const job_t *job, fathom_status_t status, uint32_t kinds, const char *what)
{
    const uint32_t has = job->has();
    const uint32_t writes = kept_commands();
    if (writes > 1) problem("%u commands kept", (unsigned)writes);
    if (has != job->before && has != job->wanted) problem("has %u", (unsigned)has);
    switch (status) {
    case FATHOM_OK:
        if (has != job->wanted && (job->kind != WRITE_ONLY || (kinds & BIT(ECHO)) == 0))
            problem("READY, but it is not so");
        break;
    case FATHOM_ERR_UNCONFIRMED:
        if (job->kind == READS) problem("unconfirmed");
        break;
    case FATHOM_ERR_IN_USE:
        if (job->kind != MOVES || writes != 0 || (kinds & ALL_THAT_SEND) == 0) problem("in use");
        break;
    case FATHOM_ERR_NO_RESPONSE:
    case FATHOM_ERR_CHECKSUM:
    case FATHOM_ERR_MALFORMED:
    case FATHOM_ERR_DIFFERS:
    case FATHOM_ERR_EXCEPTION:
    case FATHOM_ERR_ECHO:
    case FATHOM_ERR_PORT:
    case FATHOM_ERR_CANCELLED:
        if (has != job->before && (kinds & BIT(EXCEPTION)) == 0)
            problem("%s, but it was changed", fathom_status_name(status));
        break;
    default:
        problem("says %s", fathom_status_name(status));
    }
}

/* With no more faults: it measures where driver and device are at one place, and can be set. */
static void expect_works(const job_t *job, fathom_status_t status, const char *what)
{
    rest(8 * SECOND); /* what is late or without power comes back in that time */
    const bool seeks = s.model == HPS && s.driver.hps.is_seeking;
    if (!same_place() && !seeks) {
        if (status != FATHOM_ERR_UNCONFIRMED) problem("device and driver apart");
        return;
    }
    if (!recovers()) problem("does not work afterwards");
    const fathom_status_t again = carry_out(job->call);
    if (again != FATHOM_OK) problem("then %d", (int)again);
    if (job->has() != job->wanted && job->has != jobs[0].has && job->kind != WRITE_ONLY && job->before != 0)
        problem("set again, but it is not so");
    if (!recovers()) problem("set again, then it does not work");
}

static void with_fault(const job_t *job, uint8_t kind, uint32_t frame, uint32_t loop_us, uint8_t echo,
                       uint32_t us)
{
    char what[80];
    set_up_for(job, loop_us, echo);
    if (echo == FATHOM_LINE_ECHO_AUTO) bench.line.echo = (frame & 1) != 0;
    set_faults(1); /* which keep an echo that is there */
    bench.fault.clock = &s.clock;
    if (!is_fit(kind)) return;
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&bench.fault, kind, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    assert_non_null(rule);
    rule->us = us;
    snprintf(what, sizeof what, "%s at frame %u, loop %u us, echo %u, us %u", fathom_sim_fault_name(kind),
             (unsigned)frame, (unsigned)loop_us, echo, (unsigned)us);
    const fathom_status_t status = carry_out(job->call);
    judge(job, status, FATHOM_SIM_FAULT_BIT(kind), what);
    fathom_sim_fault_enable(&bench.fault, false);
    if (kind == FATHOM_SIM_FAULT_EXCEPTION && !same_place()) return;
    expect_works(job, status, what);
}

/* Two starts are enough: each takes the loops and echoes another way round, and the wrap has a test of its own
 * (test_commission_interrupted.c). */
static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(no_fault_at_any_frame_makes_an_outcome_untrue)
{
    static unsigned start; /* which one of bench_starts_us */
    unsigned l = 5 * start++;
    for (unsigned j = 0; j != jobs_count; j++)
        for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++)
            for (uint32_t frame = 1; frame <= 6; frame++, l++)
                with_fault(&jobs[j], kind, frame, loops_us[l % 4], (uint8_t)(l % 3), 0);
    assert_int_equal(problems, 0);
}

static uint32_t random_state;
static uint32_t any(uint32_t below)
{
    random_state = random_state * UINT32_C(1664525) + UINT32_C(1013904223);
    return (random_state >> 8) % below;
}

/* Four kinds at once, each of them at a third of the frames, on a port that knows this or that, with or without a
 * measurement before. */
TEST(many_faults_at_once_make_no_outcome_untrue)
{
    char what[80];
    random_state = bench_start_us;
    for (unsigned round = 0; round != RUNS; round++) {
        const job_t *const job = &jobs[round % jobs_count];
        const uint32_t seed = random_state;
        set_up_for(job, loops_us[any(4)], (uint8_t)any(3));
        if (s.config.echo == FATHOM_LINE_ECHO_AUTO) bench.line.echo = any(2) != 0;
        s.port.knows = (uint8_t)any(32);
        snprintf(what, sizeof what, "seed %lu", (unsigned long)seed);
        set_faults(seed);
        bench.fault.clock = &s.clock;
        uint32_t kinds = 0;
        while (kinds == 0 || any(4) != 0) {
            const uint8_t kind = (uint8_t)(1 + any(FATHOM_SIM_FAULT_END - 1));
            if (!is_fit(kind)) continue;
            fathom_sim_fault_rule_t *const rule = fathom_sim_fault_add(&bench.fault, kind, 300000, 0);
            /* A copy that comes later is an unsolicited frame. */
            if (rule != NULL && kind != FATHOM_SIM_FAULT_DUPLICATE && any(2) != 0)
                rule->us = 1 + any(300 * MS);
            kinds |= FATHOM_SIM_FAULT_BIT(kind);
        }
        for (uint32_t i = any(4); i != 0; i--) (void)measure();
        for (uint32_t i = any(3); i != 0; i--) {
            (void)fathom_poll(&s.sensor, &s.sample);
            pass();
        }
        const fathom_status_t status = carry_out(job->call);
        judge(job, status, kinds, what);
        fathom_sim_fault_enable(&bench.fault, false);
        if ((kinds & BIT(EXCEPTION)) != 0 && !same_place()) continue;
        expect_works(job, status, what);
    }
    assert_int_equal(problems, 0);
}
