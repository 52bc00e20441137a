/* SPDX-License-Identifier: MIT */
/* What the A05 keeps, and what it looks at when power comes: A05 1(1), 2(3)5, 3(4)2. */
#include "sim_bench.h"

static void set(uint8_t mode, a05_config_t config)
{
    bench.processed = FIXED(316, 250, 659, 2426);
    config.processed = PROCESSED;
    set_a05(mode, FIXED(1000, 2000, 1953, 3562), config);
}

#define DEFAULTS  ((a05_config_t){0})
#define REAL_TIME "FF 03 E8 07 D0 07 A1 0D EA 60" /* 1(3) */
#define AVERAGED  "FF 01 3C 00 FA 02 93 09 7A 4E"

EACH_BEGINS(set(FATHOM_SIM_A05_DYP, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(the_level_of_rx_at_power_on_selects_what_automatic_frames_say)
{
    set(FATHOM_SIM_A05_AUTO, DEFAULTS); /* floating or high */
    hear(320, AVERAGED);
    set(FATHOM_SIM_A05_AUTO, (a05_config_t){.real_time = true});
    hear(320, REAL_TIME);
}

TEST(the_level_counts_when_power_comes_and_not_later)
{
    set(FATHOM_SIM_A05_AUTO, DEFAULTS);
    bench.a05.real_time = true;
    hear(320, AVERAGED);
    cycle_power(100, 101);
    bench.a05.real_time = false;
    hear(320, REAL_TIME);
    cycle_power(100, 101); /* it is not kept */
    hear(320, AVERAGED);
}

TEST(what_is_asked_for_is_real_time_whatever_was_selected)
{
    transact("01 03 01 06 00 04 A5 F4", 450, "01 03 08 03 E8 07 D0 07 A1 0D EA A8 20");
    transact("55 AA 01 01 01", 250,
             "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62"); /* 2(3)3; the printed sum of the response is wrong */
}

TEST(without_processed_values_of_their_own_they_are_the_real_time_ones)
{
    set(FATHOM_SIM_A05_AUTO, DEFAULTS);
    bench.a05.device.processed.distance = NULL;
    hear(320, REAL_TIME);
}

TEST(the_address_is_kept_whichever_protocol_set_it)
{
    echoed("55 AA 05 03 07", 50); /* 2(3)5 */
    cycle_power(100, 101);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
    echoed("05 06 02 00 00 09 49 F0", 50);
    cycle_power(100, 101);
    transact("55 AA 09 10 18", 100, "55 AA 09 10 03 E8 03"); /* 55 + AA + 09 + 10 = 118, + 03 + E8 = 203 */
    COUNTED(.writes = 2, .flash_writes = 2);
}

TEST(flash_wears_also_when_the_address_is_what_it_was)
{
    ask("01 06 02 00 00 01 49 B2", 50);
    ask("55 AA 01 03 03", 50);
    COUNTED(.flash_writes = 2);
}

TEST(what_it_does_not_obey_is_counted)
{
    ask("01 06 02 00 00 FF C8 32", 50);
    ask("01 06 02 00 01 05 49 E1", 50);
    ask("01 06 01 06 00 05 A8 34", 50);
    ask("01 10 02 00 00 01 02 00 05 45 93", 50);
    ask("55 AA 00 03 02", 50); /* 00 and FF are no addresses */
    ask("55 AA FF 03 01", 50);
    transact("55 AA 05 03 00 00 07", 50, ""); /* another length */
    assert_int_equal(bench.a05.device.address, 1);
    COUNTED(.writes_refused = 7, .writes = NONE, .flash_writes = NONE);
    ask("55 AA 01 14 14", 100); /* refused, but no write */
    transact("01 03 01 0A 00 01 A5 F4", 100, "");
    COUNTED(.writes_refused = 7);
}

TEST(a_new_address_is_acknowledged_from_itself_as_an_option)
{
    set(FATHOM_SIM_A05_MODBUS, (a05_config_t){.answers_from_new = true});
    transact("01 06 02 00 00 05 48 71", 50, "05 06 02 00 00 05 49 F5");
}
