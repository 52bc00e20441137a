/* SPDX-License-Identifier: MIT */
/* What the A16 and the A05 do with forced choices. */
#include "second_host.h"

/* A16 */
TEST(a16_rx_selects_the_value)
{
    open_device(SECOND_A16_AUTO, 1000, OVERRIDES({"a16_settling", 0}));
    second_scene_t scene = {{2000, SECOND_NOTHING, SECOND_NOTHING, SECOND_NOTHING}};
    second_scene(&host.device[0], &scene, host.now_us);
    host_run(&host, host.now_us + 2000000);
    assert_int_equal(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->sent[0], 1000);
    second_rx_level(&host.device[0], true, host.now_us);
    host_run(&host, host.now_us + 1000000);
    const second_event_t *event = last_event(&host.device[0], SECOND_EVENT_MEASUREMENT);
    assert_true(event->served_real && event->sent[0] == 2000);
    second_rx_level(&host.device[0], false, host.now_us);
    host_run(&host, host.now_us + 600000);
    assert_int_equal(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->sent[0], 1000);
    host_run(&host, host.now_us + 3000000);
    assert_int_equal(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->sent[0], 2000);
}

TEST(a16_nothing_in_front)
{
    static const int64_t values[] = {65535, 65533, 0, 16348};
    for (size_t i = 0; i < 4; i++) {
        open_device(SECOND_A16_AUTO, SECOND_NOTHING, OVERRIDES({"a16_nothing", values[i]}));
        const second_event_t *event = last_event(&host.device[0], SECOND_EVENT_MEASUREMENT);
        assert_true(event->no_target && event->sent[0] == values[i] && event->true_mm[0] == SECOND_NOTHING);
    }
    open_device(SECOND_A16_AUTO, SECOND_NOTHING, OVERRIDES({"a16_nothing", -2}));
    assert_int_equal(host.got_len, 0);
}

TEST(a16_trigger)
{
    for (int64_t early = 0; early < 3; early++) {
        open_device(
            SECOND_A16_CONTROLLED, 1953,
            OVERRIDES({"a16_early_trigger", early}, {"a16_trigger_width_us", 500}, {"a16_t2_us", 90000}));
        uint64_t begin_us = host.now_us + 1000;
        second_rx_level(&host.device[0], true, begin_us);
        second_rx_level(&host.device[0], false, begin_us + 499); /* too short */
        begin_us += 20000;
        second_rx_level(&host.device[0], true, begin_us);
        second_rx_level(&host.device[0], false, begin_us + 500);
        second_rx_level(&host.device[0], true, begin_us + 50000); /* too early */
        second_rx_level(&host.device[0], false, begin_us + 50500);
        host_run(&host, begin_us + 400000);
        assert_int_equal(host.got_len, early == 2 ? 8 : 4);
        assert_true(host.got[0].start_us == begin_us + (early == 1 ? 140000 : 90000));
    }
}

/* A byte 00 at 9600 is a pulse of 9 bits, 937 us. */
TEST(a16_byte_as_trigger)
{
    open_device(SECOND_A16_CONTROLLED, 1953, OVERRIDES({"a16_trigger_width_us", 900}));
    host_send_hex(&host, "FF");
    assert_string_equal(host_response(&host, 200000), "");
    host_send_hex(&host, "00");
    assert_string_equal(host_response(&host, 200000), "FF 07 A1 A7");
}

TEST(a16_modes)
{
    open_device(SECOND_A16_RS232, 754,
                OVERRIDES({"a16_period_us", 3000000}, {"a16_linger", 2}, {"a16_linger_when", 0}));
    assert_true(now().automatic);
    assert_string_equal(ask("01 03 01 00 00 01"), "FF 02 F2 F3 FF 02 F2 F3 01 03 02 02 F2 38 A1");
    assert_false(now().automatic);
    host_run(&host, host.now_us + 10000000);
    size_t before = host.got_len;
    ask("01 06 02 02 00 01");
    assert_true(now().automatic);
    host_run(&host, host.now_us + 3500000);
    assert_int_equal(host.got_len - before, 8 + 4);
    ask("01 06 02 02 00 00");
    assert_false(now().automatic);
    cycle_power();
    assert_true(now().automatic);

    open_device(SECOND_A16_RS232, 754, OVERRIDES({"a16_period_us", 3000000}, {"a16_first_command", 1}));
    assert_string_equal(ask("01 03 01 00 00 01"), "");
    assert_string_equal(ask("01 03 01 00 00 01"), "01 03 02 02 F2 38 A1");
}

TEST(a16_address)
{
    open_device(SECOND_A16_RS485, 754, OVERRIDES({"mb_address_effect", 0}, {"mb_address_kept", 0}));
    assert_true(strncmp(ask("01 06 02 00 00 05"), "01 06 02 00 00 05", 17) == 0);
    assert_string_equal(ask("01 03 01 00 00 01"), "");
    assert_true(strncmp(ask("05 03 01 00 00 01"), "05 03 02 02 F2", 14) == 0);
    cycle_power();
    assert_int_equal(now().address, 1);
    open_device(SECOND_A16_RS485, 754, OVERRIDES({"mb_address_effect", 1}, {"mb_ff_read", 2}));
    ask("01 06 02 00 00 05");
    assert_int_equal(now().address, 1);
    assert_true(strncmp(ask("FF 03 01 00 00 01"), "FF 03 02 02 F2", 14) == 0);
    cycle_power();
    assert_int_equal(now().address, 5);
}

TEST(a16_two_values_in_one_frame)
{
    open_device(SECOND_A16_RS485, 754, OVERRIDES({"a16_two_values", 8}));
    assert_true(strncmp(ask("01 03 01 00 00 02"), "01 03 04 02 F2 02 F2", 20) == 0);
    assert_int_equal(count_events(&host.device[0], SECOND_EVENT_MEASUREMENT), 2);
    assert_true(strncmp(ask("01 03 01 01 00 02"), "01 83 02", 8) == 0);
    assert_true(strncmp(ask("01 03 02 02 00 01"), "01 83 02", 8) == 0);
}

/* A05 */
TEST(a05_probes_not_fitted)
{
    const second_override_t forced[] = {
        {"a05_unfitted", -1}, {"a05_unfitted_value", 4660}, {"a05_sample_at", 0}};
    second_config_t config = {.kind = SECOND_A05_RS485,
                              .fitted = 0x05,
                              .scene = {{1000, 2000, 1953, 3562}},
                              .overrides = forced,
                              .override_count = 3};
    host_open(&host, &config);
    host_power(&host, true);
    host_run(&host, 3000000);
    host_send_hex(&host, "55 AA 01 01 01");
    assert_string_equal(host_response(&host, 300000), "55 AA 01 01 03 E8 12 34 07 A1 12 34 20");
    const second_event_t *event = last_event(&host.device[0], SECOND_EVENT_MEASUREMENT);
    assert_int_equal(event->fitted, 0x05);
    assert_int_equal(event->probes, 0x0F);
    assert_true(event->true_mm[0] == 1000 && event->true_mm[1] == SECOND_NOTHING &&
                event->true_mm[2] == 1953);
    assert_true(strncmp(ask("01 03 01 07 00 01"), "01 03 02 12 34", 14) == 0);
}

TEST(a05_response_times)
{
    for (uint64_t seed = 1; seed <= 100; seed++) {
        second_config_t config = {.kind = SECOND_A05_RS485, .seed = seed, .scene = {{500, 500, 500, 500}}};
        host_open(&host, &config);
        host_power(&host, true);
        host_run(&host, 3000000);
        for (int one = 0; one < 2; one++) {
            uint64_t begin_us = host.now_us + 1;
            host_send_hex(&host, one != 0 ? "55 AA 01 12 12" : "55 AA 01 01 01");
            uint64_t end_us = host.now_us;
            host_response(&host, 500000);
            assert_int_equal(host.got_len - host.read_len, one != 0 ? 7 : 13);
            bool from_end = second_choice(&host.device[0], CHOICE_a05_t2_from) == 0;
            bool to_start = second_choice(&host.device[0], CHOICE_a05_t2_to) == 0;
            uint64_t from_us = from_end ? end_us : begin_us;
            uint64_t to_us = to_start ? host.got[host.read_len].start_us : host.got[host.got_len - 1].end_us;
            uint64_t t2_us = to_us - from_us, shortest_us = one != 0 ? 65000 : 200000;
            /* The wire's times are cut to whole microseconds. */
            assert_true(t2_us + 2 >= shortest_us && t2_us <= shortest_us + 10000 + 2);
        }
    }
}

TEST(a05_level_at_power_on)
{
    static const struct {
        int64_t rule, instant_us;
        bool real;
    } rows[] = {{0, 300000, true}, {0, 600000, false}, {1, 0, true}, {2, 0, false}};
    for (size_t i = 0; i < 4; i++) {
        const second_override_t forced[] = {{"a05_level_rule", rows[i].rule},
                                            {"a05_level_instant_us", rows[i].instant_us}};
        second_config_t config = {.kind = SECOND_A05_UART, .overrides = forced, .override_count = 2};
        host_open(&host, &config);
        second_rx_level(&host.device[0], true, 0);
        second_rx_level(&host.device[0], false, 500000);
        host_power(&host, true);
        host_run(&host, 2000000);
        assert_int_equal(now().served_real, rows[i].real);
        second_rx_level(&host.device[0], true, host.now_us); /* too late to count */
        host_run(&host, 4000000);
        assert_int_equal(now().served_real, rows[i].real);
    }
}

TEST(a05_back_to_automatic)
{
    open_device(SECOND_A05_UART, 1000, OVERRIDES({"a05_back_us", 1000000}, {"a05_period_us", 3000000}));
    ask("01 03 01 06 00 01");
    assert_false(now().automatic);
    host_run(&host, host.now_us + 1000000);
    assert_true(now().automatic);
    open_device(SECOND_A05_UART, 1000, OVERRIDES({"a05_back_us", 0}, {"a05_period_us", 3000000}));
    ask("01 03 01 06 00 01");
    host_run(&host, host.now_us + 60000000);
    assert_false(now().automatic);
}

TEST(a05_many_probes)
{
    open_device(SECOND_A05_RS485, 1000, OVERRIDES({"a05_past_end", 7}, {"a05_alias_end", 0}));
    assert_true(strncmp(ask("01 03 01 08 00 03"), "01 03 04 03 E8 03 E8", 20) == 0);
    assert_true(strncmp(ask("01 03 00 10 00 03"), "01 03 06 03 E8 03 E8 03 E8", 26) == 0);
    assert_true(strncmp(ask("01 03 00 13 00 01"), "01 83 02", 8) == 0);
    open_device(SECOND_A05_RS485, 1000, OVERRIDES({"a05_past_end", 3}, {"a05_alias_many", 2}));
    assert_true(strncmp(ask("01 03 01 08 00 03"), "01 83 03", 8) == 0);
    assert_true(strncmp(ask("01 03 00 10 00 03"), "01 83 02", 8) == 0);
}

TEST(a05_request_behind_noise)
{
    for (int64_t search = 0; search < 2; search++) {
        open_device(SECOND_A05_RS485, 1953, OVERRIDES({"a05_dyp_search", search}));
        host_send_hex(&host, "00 55 AA 01 10 10");
        assert_string_equal(host_response(&host, 300000), search != 0 ? "55 AA 01 10 07 A1 B8" : "");
    }
}

/* Three sensors on one pair: each answers at its own address, and all take a 55 AA address. */
TEST(three_on_a_pair)
{
    for (uint64_t seed = 0; seed <= 100; seed++) {
        second_config_t config = {.kind = SECOND_A05_RS485, .seed = seed, .no_misprints = true};
        const second_override_t forced[] = {{"any_power_on_glitch", -1}, {"mb_ff_read", 0}};
        config.overrides = forced;
        config.override_count = 2;
        for (uint8_t i = 0; i < 3; i++) {
            config.scene.mm[0] = 1000 + i;
            config.address = (uint8_t)(i + 1);
            if (i == 0)
                host_open(&host, &config);
            else
                assert_true(second_init(&host.device[i], &config));
        }
        host.devices = 3;
        host_power(&host, true);
        host_run(&host, 3000000);
        char request[32], expected[32];
        for (unsigned i = 0; i < 3; i++) {
            snprintf(request, sizeof request, "%02X 03 01 06 00 01", i + 1);
            snprintf(expected, sizeof expected, "%02X 03 02 03 %02X", i + 1, 0xE8 + i);
            assert_true(strncmp(ask(request), expected, strlen(expected)) == 0);
            assert_int_equal(host.got_len - host.read_len, 7);
        }
        host_send_hex(&host, "55 AA 09 03 0B");
        host_response(&host, 500000);
        assert_int_equal(host.got_len - host.read_len, 15);
        for (unsigned i = 0; i < 3; i++) {
            bool at_once = second_choice(&host.device[i], CHOICE_a05_dyp_address_effect) == 0;
            assert_int_equal(second_state(&host.device[i]).address, at_once ? 9 : i + 1);
        }
    }
}
