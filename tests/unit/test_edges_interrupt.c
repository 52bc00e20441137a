/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* REG_EFL */
#include <string.h>

#include "suite.h"
#include <signal.h>
#include <sys/time.h>
#include <ucontext.h>

#include "fathom/engine/edges.h"

/*
 * A signal stops the main loop between any two of its instructions and runs to its end before the loop goes on: what an
 * interrupt does on a microcontroller. Each one feeds more pulses than there is room for, with widths that can be told
 * from their ends, so that one which was written to while it was read would show. Time is a count of the pulses: a
 * machine under load makes the test slower and nothing else.
 */
enum { TAKEN = 10000, PERIOD_US = 50, SPACING_US = 5000, AT_ONCE = FATHOM_EDGES_PULSES + 2 };

static const uint32_t start_us = UINT32_C(0xFFFF0000); /* wraps on the way */

static fathom_edges_t edges;
static volatile uint32_t end_us; /* of the last pulse */

/* 1..4093 us, prime, so that no bit of it is that of the end. */
static uint32_t width_of(uint32_t of_end_us) { return of_end_us % 4093 + 1; }

static void on_signal(int number)
{
    (void)number;
    for (unsigned i = 0; i != AT_ONCE; i++) {
        end_us += SPACING_US;
        fathom_edges_feed(&edges, true, end_us - width_of(end_us));
        fathom_edges_feed(&edges, false, end_us);
    }
}

TEST(pulses_that_an_interrupt_feeds_are_whole_and_in_order)
{
    const struct itimerval every = {{0, PERIOD_US}, {0, PERIOD_US}};
    const struct itimerval never = {{0, 0}, {0, 0}};
    const fathom_capture_t capture = fathom_edges_capture(&edges);
    struct sigaction action;
    uint32_t before_us = start_us;
    unsigned taken = 0;
    unsigned arms = 0;
    end_us = start_us;
    fathom_edges_init(&edges, NULL);
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
    assert_int_equal(setitimer(ITIMER_REAL, &every, NULL), 0);
    for (unsigned turn = 0; taken < TAKEN; turn++) {
        fathom_pulse_t pulse;
        if (turn % 64 == 0) {
            capture.arm(capture.ctx); /* and forget some */
            arms++;
        }
        while (capture.take(capture.ctx, &pulse) == 1) {
            const uint32_t since_us = pulse.end_us - before_us;
            assert_int_equal(pulse.width_us, width_of(pulse.end_us));
            assert_true(since_us >= SPACING_US && since_us <= INT32_MAX);
            assert_int_equal(since_us % SPACING_US, 0);
            before_us = pulse.end_us;
            taken++;
        }
    }
    assert_int_equal(setitimer(ITIMER_REAL, &never, NULL), 0);
    assert_true(arms > 0);
    assert_int_equal(edges.missed, 0);
    assert_int_not_equal(edges.lost, 0);
}

/*
 * The same at every instruction of take(), one after the other: the processor is told to trap after each of them, and
 * the trap is the interrupt. Where there is no such flag the random times above have to do.
 */
#if defined(__x86_64__) && defined(__linux__)
enum { TRAP_FLAG = 0x100, ALL_STEPS = 5000 };

static unsigned steps_left; /* instructions until the interrupt; 0: it was there */

static void on_trap(int number, siginfo_t *info, void *context)
{
    (void)info;
    if (steps_left != 0 && --steps_left == 0) {
        ((ucontext_t *)context)->uc_mcontext.gregs[REG_EFL] &= ~(long long)TRAP_FLAG;
        on_signal(number);
    }
}

/* Past the 128 bytes below the stack pointer, which may be in use. */
static inline void trap(bool on)
{
    if (on)
        __asm__ volatile(
            "lea -128(%%rsp), %%rsp\n\tpushfq\n\torq $0x100, (%%rsp)\n\tpopfq\n\tlea 128(%%rsp), %%rsp" ::
                : "memory", "cc");
    else
        __asm__ volatile(
            "lea -128(%%rsp), %%rsp\n\tpushfq\n\tandq $~0x100, (%%rsp)\n\tpopfq\n\tlea 128(%%rsp), %%rsp" ::
                : "memory", "cc");
}

TEST(an_interrupt_at_any_instruction_of_take_leaves_pulses_whole_and_in_order)
{
    const fathom_capture_t capture = fathom_edges_capture(&edges);
    struct sigaction action;
    unsigned step = 0;
    bool was_within = true;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = on_trap;
    action.sa_flags = SA_SIGINFO;
    assert_int_equal(sigaction(SIGTRAP, &action, NULL), 0);
    while (was_within) {
        fathom_pulse_t pulse;
        end_us = start_us;
        fathom_edges_init(&edges, NULL);
        capture.arm(capture.ctx);
        on_signal(0); /* it is full */
        steps_left = ++step;
        trap(true);
        int has = capture.take(capture.ctx, &pulse);
        trap(false);
        was_within = steps_left == 0;
        steps_left = 0;
        uint32_t before_us = start_us;
        unsigned taken = 0;
        for (; has == 1; has = capture.take(capture.ctx, &pulse)) {
            assert_int_equal(pulse.width_us, width_of(pulse.end_us));
            assert_true(pulse.end_us - before_us <= (uint32_t)2 * AT_ONCE * SPACING_US);
            assert_true(pulse.end_us != before_us);
            before_us = pulse.end_us;
            taken++;
        }
        assert_in_range(taken, FATHOM_EDGES_PULSES, FATHOM_EDGES_PULSES + 1);
        assert_true(step < ALL_STEPS);
    }
    assert_true(step > 20);
}
#endif
