/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/engine/fair_share.h"

/* What a fair share keeps of each unit, to the microsecond. */

static fathom_fair_share_t share;

static int begin(void **state)
{
    set_up(state);
    fathom_fair_share(&share, &bench.line);
    return 0;
}

static const suite_t suite = {.set_up = begin};

TEST(all_have_used_nothing_at_first_whatever_the_memory_held)
{
    uint8_t *const bytes = (uint8_t *)&share;
    for (size_t i = 0; i != sizeof share; i++) bytes[i] = (uint8_t)(i * 37 + 1);
    fathom_fair_share(&share, &bench.line);
    for (unsigned i = 0; i != FATHOM_FAIR_SHARE_UNITS; i++) {
        assert_int_equal(share.units[i].ahead_us, 0);
        assert_int_equal(share.units[i].hold_us, 0);
        assert_int_equal(share.units[i].again_us, UINT16_MAX); /* "never yet" */
    }
    assert_null(share.held_for);
    assert_int_equal(share.since_us, bench.line.polled_us);
}

/* again_us: "so soon after that it asked again; 65535: later". */
TEST(how_soon_one_asked_again_stops_at_65535_us)
{
    static const uint32_t after_us[] = {65534, 65535, 65536, 70000};
    for (size_t i = 0; i != COUNT_OF(after_us); i++) {
        share.turns.ended(&share.turns, 7, 1000);
        share.turns.asked(&share.turns, 7, 1000 + after_us[i]);
        assert_int_equal(share.units[7].again_us, i == 0 ? 65534 : 65535);
    }
}

/* "from the silence before the request on": that of the config. */
TEST(the_silence_before_a_request_is_used_time)
{
    static const uint16_t gaps_us[] = {T3_5_US, 0};
    for (size_t i = 0; i != COUNT_OF(gaps_us); i++) {
        bench.config.silence_us = gaps_us[i];
        run(20000);
        ask_1(0);
        run(100);
        expect_written(i + 1);
        assert_int_equal(bench.line.polled_us - share.since_us, i == 0 ? T3_5_US : 4011);
        run(REQUEST_US);
        response_1(754);
    }
}

/* No time passes for those who ask when the next one is due. */
TEST(what_is_due_is_asked_without_use_of_time)
{
    ask_1(0);
    run(REQUEST_US);
    response_1(754);
    ask_other(2);
    run(1000);
    (void)due();
    assert_int_equal(share.since_us, share.units[1].ended_us);
}

/* Unit 16 asked 1 ms after its responses, and asks no more; for unit 2, whose last took 400 ms, the line is held. */
static int hold(void **state)
{
    (void)begin(state);
    ask(&bench.request, 16, &bench.value, 0);
    run(REQUEST_US);
    deliver_response(16, 111);
    ask_other(2);
    share.units[2].ahead_us = 100000;
    share.units[2].hold_us = 50000;
    share.units[0].again_us = 1000;
    return 0;
}

static const suite_t held = {.set_up = hold};

TEST_IN(held, what_is_held_back_leaves_when_it_was_due_and_nothing_is_held_any_more)
{
    const uint32_t held_us = due();
    assert_in_range(held_us, 49900, 50000);
    bench.fake.now_us += held_us - 1;
    poll_line();
    expect_written(1);
    expect_due(1);
    bench.fake.now_us++;
    poll_line();
    expect_written(2);
    assert_null(share.held_for);
    assert_int_equal(share.since_us, bench.line.polled_us); /* until here it was unit 16's */
}

TEST_IN(held, one_that_asked_just_as_late_as_the_hold_time_is_over_is_not_waited_for)
{
    share.units[0].again_us = 49999;
    assert_in_range(due(), 49000, 50000);
    share.units[0].again_us = 50000;
    assert_in_range(due(), 0, T3_5_US);
}
