/* SPDX-License-Identifier: MIT */
/* An HPS-167S that sends measurements by itself, as tables 12 and 18 and #10 allow, 54 a second. */
#include "tool_bench.h"

#include <string.h>

static int set_up(void **state)
{
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18500});
    return 0;
}

static const suite_t suite = {.set_up = set_up};

TEST(scan_names_it_and_sends_nothing)
{
    const tool_run_t *const run = tool_run(&bench.tool, "scan --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(run->out, "hps167s  address 1    19200 8E1    sends answers unasked"));
    assert_int_equal(bench.hps167s.device.counters.requests, 0);
}

TEST(scan_asks_it_when_told_and_takes_what_comes_unasked_for_no_second_answer)
{
    for (uint32_t seed = 0; seed != 20; seed++) {
        bench_begin();
        bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18500 + 997 * seed, .seed = seed});
        const tool_run_t *const run =
            tool_run(&bench.tool, "scan --wake --baud 19200 --address 1-3 --port line");
        assert_int_equal(run->status, 0);
        assert_non_null(strstr(run->out, "hps167s  address 1 "));
        assert_null(strstr(run->out, "twice"));
        assert_null(strstr(run->err, "two"));
    }
}
