/* SPDX-License-Identifier: MIT */
/* An HPS-167S that sends measurements by itself, as tables 12 and 18 and #10 allow, 54 a second: every command works
 * all the same, and says nothing false. */
#include "tool_bench.h"

#include <string.h>

static int set_up(void **state)
{
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18500});
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* A command, and what it prints. */
static void works(void **state)
{
    const char *const *const row = *state;
    for (uint32_t phase_us = 0; phase_us < 18500; phase_us += 700) {
        bench_begin();
        bench_hps167s((fathom_sim_hps167s_config_t){.unasked_us = 18500, .seed = phase_us});
        fathom_sim_clock_advance(&bench.clock, 1000000 + phase_us);
        const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", row[0]);
        if (run->status != 0 || strstr(run->out, row[1]) == NULL)
            fail_msg("%s: exit status %d\n%s%s", row[0], run->status, run->out, run->err);
    }
}

#define WORKS(name, command, text)                                                                           \
    static const char *const row_##name[] = {command, text};                                                 \
    TEST_ROW(name, works, row_##name)

WORKS(read_works, "read hps167s --count 20 --format csv", ",1234,1234,")
WORKS(watch_works, "watch hps167s --duration 2", " 1.234 m ")
WORKS(the_version_is_told, "get hps167s interface-version", " 2.1.0 of 2020-09-27\n")
WORKS(the_details_are_told, "get hps167s uuid", " 00390025423457142034383501060705\n")
WORKS(the_temperature_is_told, "get hps167s temperature", " 25.0 degC\n")
WORKS(the_reconnect_time_is_told, "get hps167s reconnect-time", " 180 ms\n")
WORKS(the_output_is_ended, "set hps167s measure-after-power-on off", "measure-after-power-on is off")
WORKS(the_termination_is_set, "set hps167s termination off", "termination is off")
WORKS(the_warm_up_is_set, "set hps167s warm-up 10", "warm-up is 10")
WORKS(the_reconnect_time_is_set, "set hps167s reconnect-time 1800", "reconnect-time is 1800")
WORKS(the_address_is_set, "set hps167s address 7", "address is 7")
WORKS(the_rate_is_set, "set hps167s baud 57600", "baud is 57600")
WORKS(the_filter_is_set, "set hps167s filter-sensitivity 10",
      "filter-sensitivity: 10 was written and acknowledged")
WORKS(the_interface_is_reset, "reset hps167s --yes-restore-factory-settings", "has its factory settings")
WORKS(the_sensor_is_reset, "reset hps167s --yes-load-factory-sensor-settings",
      "it loads its factory settings")

TEST(scan_names_it_and_sends_nothing)
{
    const tool_run_t *const run = tool_run(&bench.tool, "scan --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(run->out, "hps167s  address 1    19200 8E1    sends unsolicited responses"));
    assert_int_equal(bench.hps167s.device.counters.requests, 0);
}

TEST(scan_asks_it_when_told_and_takes_what_comes_unasked_for_no_second_response)
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
