/* SPDX-License-Identifier: MIT */
/* What the HPS-167S does with forced choices. */
#include "second_host.h"

/* HPS-167S: the ID. */
TEST(hps_new_id_from_old_or_new)
{
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_id_response", 0}));
    assert_true(strncmp(ask("01 06 00 10 00 07"), "01 06 00 10 00 07", 17) == 0);
    assert_int_equal(now().address, 7);
    assert_string_equal(ask("01 03 00 01 00 03"), "");
    assert_true(strncmp(ask("07 03 00 01 00 03"), "07 03 06", 8) == 0);

    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_id_response", 1}));
    assert_true(strncmp(ask("01 06 00 10 00 07"), "07 06 00 10 00 07", 17) == 0);
    cycle_power();
    assert_int_equal(now().address, 7);
    const second_event_t *setting = last_event(&host.device[0], SECOND_EVENT_SETTING);
    assert_int_equal(setting->reg, 0x10);
    assert_true(setting->old_value == 1 && setting->new_value == 7 && setting->flash_writes == 1);
}

TEST(hps_broadcast_is_done_silently)
{
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_broadcast_reset", 0}));
    assert_string_equal(ask("00 06 00 10 00 07"), "");
    assert_int_equal(now().address, 7);
    assert_string_equal(ask("00 03 00 09 00 01"), "");
    assert_int_equal(now().address, 7);
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_broadcast_reset", 1}));
    ask("01 06 00 10 00 07");
    assert_string_equal(ask("00 03 00 09 00 01"), "");
    assert_int_equal(now().address, 1);
}

/* HPS-167S: the rate. */
TEST(hps_new_rate_at_three_times)
{
    static const char *const set = "01 06 00 11 00 03";
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_baud_effect", 0}));
    assert_true(strncmp(ask(set), set, 17) == 0);
    assert_int_equal(host.got[host.got_len - 1].line.baud, 19200);
    assert_int_equal(now().line.baud, 115200);
    host.line.baud = 115200;
    assert_true(strncmp(ask("01 03 00 01 00 03"), "01 03 06", 8) == 0);
    assert_int_equal(host.got[host.got_len - 1].line.baud, 115200);

    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_baud_effect", 1}, {"hps_baud_kept", 0}));
    assert_true(strncmp(ask(set), set, 17) == 0);
    assert_int_equal(host.got[host.got_len - 1].line.baud, 115200);
    cycle_power();
    assert_int_equal(now().line.baud, 19200);

    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_baud_effect", 2}, {"hps_baud_kept", 0}));
    assert_true(strncmp(ask(set), set, 17) == 0);
    assert_int_equal(now().line.baud, 19200);
    cycle_power();
    assert_int_equal(now().line.baud, 115200);
}

TEST(hps_factory_reset_in_three_orders)
{
    static const struct {
        int64_t order;
        uint8_t response_id;
        uint32_t response_baud, baud;
    } rows[] = {{0, 5, 57600, 19200}, {1, 1, 19200, 19200}, {2, 1, 57600, 57600}};
    for (size_t i = 0; i < 3; i++) {
        open_device(SECOND_HPS167S, 2083,
                    OVERRIDES({"hps_reset_order", rows[i].order}, {"hps_baud_code", 2}));
        host.line.baud = 57600;
        ask("01 06 00 10 00 05");
        const char *response = ask("05 03 00 09 00 01");
        assert_string_equal(response + 2,
                            rows[i].response_id == 1 ? " 03 02 00 01 79 84" : " 03 02 00 01 88 44");
        assert_int_equal(host.got[host.got_len - 7].value, rows[i].response_id);
        assert_int_equal(host.got[host.got_len - 1].line.baud, rows[i].response_baud);
        assert_int_equal(now().address, 1);
        assert_int_equal(now().line.baud, rows[i].baud);
        assert_int_equal(count_events(&host.device[0], SECOND_EVENT_RESET), 1);
        cycle_power();
        assert_int_equal(now().line.baud, 19200);
    }
}

TEST(hps_configuration)
{
    open_device(SECOND_HPS167S, 2083,
                OVERRIDES({"hps_reconnect_ms", 100}, {"hps_reconnect_order", 0}, {"hps_baud_code", 255},
                          {"hps_termination", 0}));
    assert_true(strncmp(ask("01 03 00 02 00 04"), "01 03 08 00 FF 05 00 00 00 64 FF", 32) == 0);
    ask("01 06 00 13 00 FF");
    ask("01 06 00 12 00 00");
    ask("01 10 00 20 00 02 04 00 01 51 80"); /* 86400 = 18 * 4800 */
    assert_true(strncmp(ask("01 03 00 02 00 04"), "01 03 08 FF 00 05 00 01 51 80 FF", 32) == 0);
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_reconnect_order", 2}, {"hps_reconnect_odd", 7}));
    ask("01 10 00 20 00 02 04 00 65 00 00"); /* 101 ms, low word first */
    assert_true(strncmp(ask("01 03 00 02 00 04"), "01 03 08 FF FF 05 00 5A 00 00 01", 32) == 0);
}

TEST(hps_offset)
{
    open_device(SECOND_HPS167S, 215, OVERRIDES({"hps_offset_sum", 0}));
    ask("01 06 00 14 FF F1"); /* -15, as printed */
    ask("01 06 00 14 FF F1");
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 00 C8", 14) == 0);
    open_device(SECOND_HPS167S, 215, OVERRIDES({"hps_offset_sum", 1}));
    ask("01 06 00 14 FF F1");
    ask("01 06 00 14 FF F1");
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 00 B9", 14) == 0);
    ask("01 06 00 15 00 FF");
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 00 D7", 14) == 0);
    open_device(SECOND_HPS167S, 215, OVERRIDES({"hps_offset_effect", 1}));
    ask("01 06 00 14 FF F1");
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 00 D7", 14) == 0);
    ask("01 06 00 15 00 00");
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 00 C8", 14) == 0);
}

TEST(hps_over_range_and_fault)
{
    open_device(
        SECOND_HPS167S, SECOND_NOTHING,
        OVERRIDES({"hps_over_range", 65530}, {"hps_over_magnitude", 0}, {"hps_over_precision", 65535}));
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 FF FA 00 00 00 01 FF FF", 32) == 0);
    assert_true(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->no_target);
    second_fault(&host.device[0], true, host.now_us);
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 FF FF 00 00 00 FF FF FF", 32) == 0);
    assert_true(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->fault);
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_fault_single", 4}));
    second_fault(&host.device[0], true, host.now_us);
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 83 04", 8) == 0);
    assert_int_equal(last_event(&host.device[0], SECOND_EVENT_REFUSED)->exception, 4);
    second_fault(&host.device[0], false, host.now_us);
    assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 08 23", 14) == 0);
}

TEST(hps_warm_up)
{
    static const struct {
        int64_t how;
        const char *response;
    } rows[] = {{0, ""}, {4, "01 83 04 40 F3"}, {7, "01 03 08 FF FF 00 00 00 FF FF FF"}};
    for (size_t i = 0; i < 3; i++) {
        open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_warm_measure", rows[i].how}));
        host_power(&host, false);
        host_power(&host, true);
        uint64_t power_on_us = host.now_us;
        host_run(&host, power_on_us + 4000000);
        const char *response = ask("01 03 00 08 00 04");
        assert_true(strncmp(response, rows[i].response, strlen(rows[i].response)) == 0);
        assert_true(rows[i].how != 0 || response[0] == '\0');
        host_run(&host, power_on_us + 5000001);
        assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 08 23", 14) == 0);
    }
}

TEST(hps_unasked_output)
{
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_unasked", 1}, {"hps_unasked_us", 100000}));
    /* Alive at 0.5 s, warm at 5 s; then ten frames of 13 bytes a second up to 12 s. */
    assert_true(host.got_len / 13 >= 69 && host.got_len / 13 <= 71);
    assert_true(now().automatic && !last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->asked);
    second_fault(&host.device[0], true, host.now_us);
    size_t before = host.got_len;
    host_run(&host, host.now_us + 170000); /* reconnection time 180 ms */
    assert_true(host.got_len - before <= 13);
    host_run(&host, host.now_us + 200000);
    assert_true(last_event(&host.device[0], SECOND_EVENT_MEASUREMENT)->fault);
    second_fault(&host.device[0], false, host.now_us);
    ask("01 06 00 12 00 00"); /* counts at the next power-on */
    assert_true(now().automatic);
    cycle_power();
    assert_false(now().automatic);

    open_device(SECOND_HPS167S, 2083,
                OVERRIDES({"hps_unasked", 1}, {"hps_unasked_request", 2}, {"hps_unasked_us", 150000}));
    ask("01 03 00 01 00 03");
    host_run(&host, host.now_us + 100000);
    before = host.got_len;
    host_run(&host, host.now_us + 2000000);
    assert_int_equal(host.got_len, before);
}

TEST(hps_refusals)
{
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_wrong_count", 2}, {"hps_illegal_function", 1}));
    assert_string_equal(ask("01 03 00 08 00 05"), "01 83 02 C0 F1");
    assert_true(strncmp(ask("01 04 00 08 00 04"), "01 84 01", 8) == 0);
    host_send_hex(&host, "01 03 00 08 00 04 C5 C8"); /* as the text misprints it */
    assert_string_equal(host_response(&host, 450000), "");
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_wrong_count", 8}, {"hps_bad_crc", 3}));
    assert_true(strncmp(ask("01 03 00 08 00 05"), "01 03 08 08 23", 14) == 0);
    host_send_hex(&host, "01 03 00 08 00 04 C5 C8");
    assert_true(strncmp(host_response(&host, 450000), "01 83 03", 8) == 0);
}

/* 3 characters of silence inside a request. */
TEST(hps_gap_in_a_request)
{
    uint8_t bytes[8];
    size_t len = from_hex("01 03 00 08 00 04 C5 CB", bytes);
    for (int64_t rule = 0; rule < 2; rule++) {
        open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_gap_inside", rule}));
        host_send(&host, bytes, 4);
        host_run(&host, host.now_us + 3 * 573);
        size_t before = host.got_len;
        host_send(&host, bytes + 4, len - 4);
        host_run(&host, host.now_us + 300000);
        assert_int_equal(host.got_len - before, rule == 0 ? 0 : 13);
    }
}

TEST(hps_other_line_settings)
{
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_other_parity", 0}));
    host.line.parity = 'N';
    assert_string_equal(ask("01 03 00 01 00 03"), "");
    assert_true(count_events(&host.device[0], SECOND_EVENT_NOISE) > 0);
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_other_parity", 2}));
    host.line.parity = 'O';
    assert_true(strncmp(ask("01 03 00 01 00 03"), "01 03 06", 8) == 0);
    assert_int_equal(host.got[host.got_len - 1].line.parity, 'O');
}
