/* SPDX-License-Identifier: MIT */
/* What the devices do with forced choices, and what holds for all seeds. */
#include "test_host.h"

#include "second_device.h" /* the check codes */

static host_t host, again;

#define OVERRIDES(...)                                                                                       \
    (const second_override_t[]){__VA_ARGS__},                                                                \
        sizeof((const second_override_t[]){__VA_ARGS__}) / sizeof(second_override_t)

static void open_device(second_kind_t kind, int32_t mm, const second_override_t *overrides, size_t count)
{
    second_config_t config = {
        .kind = kind, .scene = {{mm, mm, mm, mm}}, .overrides = overrides, .override_count = count};
    host_open(&host, &config);
    host_power(&host, true);
    host_run(&host, 12000000);
}

static const char *ask(const char *request)
{
    host_request(&host, request);
    return host_answer(&host, 450000);
}

static second_state_t now(void) { return second_state(&host.device[0]); }

static void cycle_power(void)
{
    host_power(&host, false);
    host_run(&host, host.now_us + 100000);
    host_power(&host, true);
    host_run(&host, host.now_us + 12000000);
}

/* HPS-167S: the ID. */
static void test_hps_new_id_from_old_or_new(void **state)
{
    (void)state;
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_id_answer", 0}));
    assert_true(strncmp(ask("01 06 00 10 00 07"), "01 06 00 10 00 07", 17) == 0);
    assert_int_equal(now().address, 7);
    assert_string_equal(ask("01 03 00 01 00 03"), "");
    assert_true(strncmp(ask("07 03 00 01 00 03"), "07 03 06", 8) == 0);

    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_id_answer", 1}));
    assert_true(strncmp(ask("01 06 00 10 00 07"), "07 06 00 10 00 07", 17) == 0);
    cycle_power();
    assert_int_equal(now().address, 7);
    const second_event_t *setting = last_event(&host.device[0], SECOND_EVENT_SETTING);
    assert_int_equal(setting->reg, 0x10);
    assert_true(setting->old_value == 1 && setting->new_value == 7 && setting->flash_writes == 1);
}

static void test_hps_broadcast_is_done_silently(void **state)
{
    (void)state;
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
static void test_hps_new_rate_at_three_times(void **state)
{
    (void)state;
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

static void test_hps_factory_reset_in_three_orders(void **state)
{
    (void)state;
    static const struct {
        int64_t order;
        uint8_t answer_id;
        uint32_t answer_baud, baud;
    } rows[] = {{0, 5, 57600, 19200}, {1, 1, 19200, 19200}, {2, 1, 57600, 57600}};
    for (size_t i = 0; i < 3; i++) {
        open_device(SECOND_HPS167S, 2083,
                    OVERRIDES({"hps_reset_order", rows[i].order}, {"hps_baud_code", 2}));
        host.line.baud = 57600;
        ask("01 06 00 10 00 05");
        const char *answer = ask("05 03 00 09 00 01");
        assert_string_equal(answer + 2, rows[i].answer_id == 1 ? " 03 02 00 01 79 84" : " 03 02 00 01 88 44");
        assert_int_equal(host.got[host.got_len - 7].value, rows[i].answer_id);
        assert_int_equal(host.got[host.got_len - 1].line.baud, rows[i].answer_baud);
        assert_int_equal(now().address, 1);
        assert_int_equal(now().line.baud, rows[i].baud);
        assert_int_equal(count_events(&host.device[0], SECOND_EVENT_RESET), 1);
        cycle_power();
        assert_int_equal(now().line.baud, 19200);
    }
}

static void test_hps_configuration(void **state)
{
    (void)state;
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

static void test_hps_offset(void **state)
{
    (void)state;
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

static void test_hps_over_range_and_fault(void **state)
{
    (void)state;
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

static void test_hps_warm_up(void **state)
{
    (void)state;
    static const struct {
        int64_t how;
        const char *answer;
    } rows[] = {{0, ""}, {4, "01 83 04 40 F3"}, {7, "01 03 08 FF FF 00 00 00 FF FF FF"}};
    for (size_t i = 0; i < 3; i++) {
        open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_warm_measure", rows[i].how}));
        host_power(&host, false);
        host_power(&host, true);
        uint64_t power_on_us = host.now_us;
        host_run(&host, power_on_us + 4000000);
        const char *answer = ask("01 03 00 08 00 04");
        assert_true(strncmp(answer, rows[i].answer, strlen(rows[i].answer)) == 0);
        assert_true(rows[i].how != 0 || answer[0] == '\0');
        host_run(&host, power_on_us + 5000001);
        assert_true(strncmp(ask("01 03 00 08 00 04"), "01 03 08 08 23", 14) == 0);
    }
}

static void test_hps_unasked_output(void **state)
{
    (void)state;
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

static void test_hps_refusals(void **state)
{
    (void)state;
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_wrong_count", 2}, {"hps_illegal_function", 1}));
    assert_string_equal(ask("01 03 00 08 00 05"), "01 83 02 C0 F1");
    assert_true(strncmp(ask("01 04 00 08 00 04"), "01 84 01", 8) == 0);
    host_send_hex(&host, "01 03 00 08 00 04 C5 C8"); /* as the text misprints it */
    assert_string_equal(host_answer(&host, 450000), "");
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_wrong_count", 8}, {"hps_bad_crc", 3}));
    assert_true(strncmp(ask("01 03 00 08 00 05"), "01 03 08 08 23", 14) == 0);
    host_send_hex(&host, "01 03 00 08 00 04 C5 C8");
    assert_true(strncmp(host_answer(&host, 450000), "01 83 03", 8) == 0);
}

/* 3 characters of silence inside a request. */
static void test_hps_gap_in_a_request(void **state)
{
    (void)state;
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

static void test_hps_other_line_settings(void **state)
{
    (void)state;
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_other_parity", 0}));
    host.line.parity = 'N';
    assert_string_equal(ask("01 03 00 01 00 03"), "");
    assert_true(count_events(&host.device[0], SECOND_EVENT_NOISE) > 0);
    open_device(SECOND_HPS167S, 2083, OVERRIDES({"hps_other_parity", 2}));
    host.line.parity = 'O';
    assert_true(strncmp(ask("01 03 00 01 00 03"), "01 03 06", 8) == 0);
    assert_int_equal(host.got[host.got_len - 1].line.parity, 'O');
}

/* A16 */
static void test_a16_rx_selects_the_value(void **state)
{
    (void)state;
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

static void test_a16_nothing_in_front(void **state)
{
    (void)state;
    static const int64_t values[] = {65535, 65533, 0, 16348};
    for (size_t i = 0; i < 4; i++) {
        open_device(SECOND_A16_AUTO, SECOND_NOTHING, OVERRIDES({"a16_nothing", values[i]}));
        const second_event_t *event = last_event(&host.device[0], SECOND_EVENT_MEASUREMENT);
        assert_true(event->no_target && event->sent[0] == values[i] && event->true_mm[0] == SECOND_NOTHING);
    }
    open_device(SECOND_A16_AUTO, SECOND_NOTHING, OVERRIDES({"a16_nothing", -2}));
    assert_int_equal(host.got_len, 0);
}

static void test_a16_trigger(void **state)
{
    (void)state;
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
static void test_a16_byte_as_trigger(void **state)
{
    (void)state;
    open_device(SECOND_A16_CONTROLLED, 1953, OVERRIDES({"a16_trigger_width_us", 900}));
    host_send_hex(&host, "FF");
    assert_string_equal(host_answer(&host, 200000), "");
    host_send_hex(&host, "00");
    assert_string_equal(host_answer(&host, 200000), "FF 07 A1 A7");
}

static void test_a16_modes(void **state)
{
    (void)state;
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

static void test_a16_address(void **state)
{
    (void)state;
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

static void test_a16_two_values_in_one_frame(void **state)
{
    (void)state;
    open_device(SECOND_A16_RS485, 754, OVERRIDES({"a16_two_values", 8}));
    assert_true(strncmp(ask("01 03 01 00 00 02"), "01 03 04 02 F2 02 F2", 20) == 0);
    assert_int_equal(count_events(&host.device[0], SECOND_EVENT_MEASUREMENT), 2);
    assert_true(strncmp(ask("01 03 01 01 00 02"), "01 83 02", 8) == 0);
    assert_true(strncmp(ask("01 03 02 02 00 01"), "01 83 02", 8) == 0);
}

/* A05 */
static void test_a05_probes_not_fitted(void **state)
{
    (void)state;
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
    assert_string_equal(host_answer(&host, 300000), "55 AA 01 01 03 E8 12 34 07 A1 12 34 20");
    const second_event_t *event = last_event(&host.device[0], SECOND_EVENT_MEASUREMENT);
    assert_int_equal(event->fitted, 0x05);
    assert_int_equal(event->probes, 0x0F);
    assert_true(event->true_mm[0] == 1000 && event->true_mm[1] == SECOND_NOTHING &&
                event->true_mm[2] == 1953);
    assert_true(strncmp(ask("01 03 01 07 00 01"), "01 03 02 12 34", 14) == 0);
}

static void test_a05_answer_times(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 100; seed++) {
        second_config_t config = {.kind = SECOND_A05_RS485, .seed = seed, .scene = {{500, 500, 500, 500}}};
        host_open(&host, &config);
        host_power(&host, true);
        host_run(&host, 3000000);
        for (int one = 0; one < 2; one++) {
            uint64_t begin_us = host.now_us + 1;
            host_send_hex(&host, one != 0 ? "55 AA 01 12 12" : "55 AA 01 01 01");
            uint64_t end_us = host.now_us;
            host_answer(&host, 500000);
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

static void test_a05_level_at_power_on(void **state)
{
    (void)state;
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

static void test_a05_back_to_automatic(void **state)
{
    (void)state;
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

static void test_a05_many_probes(void **state)
{
    (void)state;
    open_device(SECOND_A05_RS485, 1000, OVERRIDES({"a05_past_end", 7}, {"a05_alias_end", 0}));
    assert_true(strncmp(ask("01 03 01 08 00 03"), "01 03 04 03 E8 03 E8", 20) == 0);
    assert_true(strncmp(ask("01 03 00 10 00 03"), "01 03 06 03 E8 03 E8 03 E8", 26) == 0);
    assert_true(strncmp(ask("01 03 00 13 00 01"), "01 83 02", 8) == 0);
    open_device(SECOND_A05_RS485, 1000, OVERRIDES({"a05_past_end", 3}, {"a05_alias_many", 2}));
    assert_true(strncmp(ask("01 03 01 08 00 03"), "01 83 03", 8) == 0);
    assert_true(strncmp(ask("01 03 00 10 00 03"), "01 83 02", 8) == 0);
}

static void test_a05_request_behind_noise(void **state)
{
    (void)state;
    for (int64_t search = 0; search < 2; search++) {
        open_device(SECOND_A05_RS485, 1953, OVERRIDES({"a05_dyp_search", search}));
        host_send_hex(&host, "00 55 AA 01 10 10");
        assert_string_equal(host_answer(&host, 300000), search != 0 ? "55 AA 01 10 07 A1 B8" : "");
    }
}

/* Three sensors on one pair: each answers its own address, and all take a 55 AA address. */
static void test_three_on_a_pair(void **state)
{
    (void)state;
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
        host_answer(&host, 500000);
        assert_int_equal(host.got_len - host.read_len, 15);
        for (unsigned i = 0; i < 3; i++) {
            bool at_once = second_choice(&host.device[i], CHOICE_a05_dyp_address_effect) == 0;
            assert_int_equal(second_state(&host.device[i]).address, at_once ? 9 : i + 1);
        }
    }
}

/* For all seeds. */
static bool checked_frame(const second_event_t *event, bool odd_sum)
{
    if (event->raw[0] == 0xFF && event->raw_len != 0 && event->function == 0) { /* an automatic frame */
        size_t skip = event->raw[1] == 0xFF && event->raw_len == 5 ? 1 : 0;
        size_t sum = (size_t)event->raw_len - 1;
        return second_wire_sum8(event->raw + skip, sum - skip) == event->raw[sum];
    }
    if (event->raw[0] == 0x55 && event->raw[1] == 0xAA)
        return odd_sum || second_wire_sum8(event->raw, event->raw_len - 1U) == event->raw[event->raw_len - 1];
    return second_wire_crc16(event->raw, event->raw_len) == 0;
}

static const char *request_of(second_kind_t kind)
{
    static const char *const requests[SECOND_KINDS] = {
        [SECOND_A16_RS232] = "01 03 01 01 00 01", [SECOND_A16_RS485] = "01 03 01 00 00 01",
        [SECOND_A05_UART] = "01 03 01 06 00 04",  [SECOND_A05_RS485] = "01 03 01 06 00 04",
        [SECOND_HPS167S] = "01 03 00 08 00 04",
    };
    return requests[kind];
}

static void live(host_t *h, second_kind_t kind, uint64_t seed, uint64_t step_us)
{
    second_config_t config = {
        .kind = kind, .seed = seed, .fitted = (uint8_t)(1 + seed % 15), .scene = {{1500, 2500, 3500, 4500}}};
    host_open(h, &config);
    h->step_us = step_us;
    h->line = second_state(&h->device[0]).line;
    host_power(h, true);
    host_run(h, 9000000);
    second_scene_t scene = {{SECOND_NOTHING, 700, 90000, 40}};
    for (int i = 0; i < 4; i++) {
        if (request_of(kind) != NULL) {
            host_request(h, request_of(kind));
        } else {
            second_rx_level(&h->device[0], true, h->now_us + 10);
            second_rx_level(&h->device[0], false, h->now_us + 2000);
        }
        host_run(h, h->now_us + 600000);
        if (i == 2) second_scene(&h->device[0], &scene, h->now_us);
    }
    host_power(h, false);
    host_run(h, h->now_us + 100000);
}

/* Bytes follow each other, frames carry the right check codes, the log tells what was on the wire. */
static void test_all_seeds_keep_the_wire_in_order(void **state)
{
    (void)state;
    for (int kind = 0; kind < SECOND_KINDS; kind++) {
        size_t frames = 0;
        for (uint64_t seed = 1; seed <= 300; seed++) {
            live(&host, (second_kind_t)kind, seed, 0);
            const second_device_t *d = &host.device[0];
            for (size_t i = 1; i < host.got_len; i++) {
                assert_true(host.got[i].start_us >= host.got[i - 1].end_us);
                assert_true(host.got[i].end_us > host.got[i].start_us);
            }
            size_t at = 0;
            bool odd_sum = second_choice(d, CHOICE_a05_all_sum) != 0;
            for (uint64_t i = 0; i < second_log_count(d); i++) {
                const second_event_t *event = second_log_at(d, i);
                bool sent = event->kind == SECOND_EVENT_MEASUREMENT || event->kind == SECOND_EVENT_ANSWER;
                if (!sent || event->end_us > second_log_at(d, second_log_count(d) - 1)->time_us) continue;
                assert_true(checked_frame(event, odd_sum));
                while (at < host.got_len && host.got[at].start_us < event->start_us) at++;
                for (size_t k = 0; k < event->raw_len; k++)
                    assert_int_equal(host.got[at + k].value, event->raw[k]);
                frames++;
            }
            assert_int_equal(second_state(d).lost, 0);
        }
        assert_true(frames > 300);
    }
}

/* A request for a measurement is answered, whatever the seed, when the text says so. */
static void test_all_seeds_answer_a_plain_request(void **state)
{
    (void)state;
    for (int kind = SECOND_A16_CONTROLLED; kind < SECOND_KINDS; kind++) {
        for (uint64_t seed = 1; seed <= 300; seed++) {
            live(&host, (second_kind_t)kind, seed, 0);
            const second_device_t *d = &host.device[0];
            size_t asked = 0, expected = 4;
            for (uint64_t i = 0; i < second_log_count(d); i++) {
                const second_event_t *event = second_log_at(d, i);
                if (event->kind == SECOND_EVENT_MEASUREMENT && event->asked && !event->fault) asked++;
            }
            /* What may cost an answer: the first only switches; no frame without a target; a failure; and an
               unasked frame that the request ran into. */
            bool first_switches =
                (kind == SECOND_A16_RS232 && second_choice(d, CHOICE_a16_first_command) != 0) ||
                (kind == SECOND_A05_UART && second_choice(d, CHOICE_a05_first_command) != 0);
            if (first_switches) expected -= second_choice(d, CHOICE_a05_back_us) == 1000000 ? 4 : 1;
            if (kind == SECOND_A16_CONTROLLED && second_choice(d, CHOICE_a16_nothing) == -2) expected--;
            bool unasked =
                second_choice(d, CHOICE_hps_unasked) != 0 && second_choice(d, CHOICE_hps_auto_out) != 0;
            if (kind == SECOND_HPS167S && unasked) continue;
            if (kind == SECOND_HPS167S && second_choice(d, CHOICE_hps_fault_every) != 0) continue;
            if (asked < expected) fail_msg("kind %d seed %u: %zu answers", kind, (unsigned)seed, asked);
        }
    }
}

/* The same seed gives the same bytes, in whatever steps the device is run. */
static void test_all_seeds_are_repeatable(void **state)
{
    (void)state;
    for (int kind = 0; kind < SECOND_KINDS; kind++) {
        for (uint64_t seed = 1; seed <= 60; seed++) {
            live(&host, (second_kind_t)kind, seed, 0);
            live(&again, (second_kind_t)kind, seed, 333);
            assert_int_equal(host.got_len, again.got_len);
            for (size_t i = 0; i < host.got_len; i++) {
                assert_int_equal(host.got[i].value, again.got[i].value);
                assert_true(host.got[i].start_us == again.got[i].start_us);
            }
            assert_true(second_log_count(&host.device[0]) == second_log_count(&again.device[0]));
        }
    }
}

static void test_the_log_is_a_ring(void **state)
{
    (void)state;
    open_device(SECOND_A16_AUTO, 1000, OVERRIDES({"a16_period_us", 50000}));
    host.got_len = 0;
    for (int i = 0; i < 5; i++) {
        host_run(&host, host.now_us + 50000000);
        host.got_len = 0;
    }
    uint64_t count = second_log_count(&host.device[0]);
    assert_true(count > SECOND_LOG_EVENTS);
    assert_null(second_log_at(&host.device[0], count));
    assert_non_null(second_log_at(&host.device[0], count - SECOND_LOG_EVENTS));
    assert_null(second_log_at(&host.device[0], count - SECOND_LOG_EVENTS - 1));
}

static void test_breaks_and_power_off(void **state)
{
    (void)state;
    for (int64_t as = 0; as < 2; as++) {
        open_device(SECOND_A16_RS485, 754, OVERRIDES({"any_break_as", as}));
        second_rx_level(&host.device[0], true, host.now_us);
        second_rx_level(&host.device[0], false, host.now_us + 5000);
        host_run(&host, host.now_us + 10000);
        const second_event_t *noise = last_event(&host.device[0], SECOND_EVENT_NOISE);
        assert_true(noise != NULL && noise->new_value == as);
        assert_string_equal(ask("01 03 01 00 00 01"), "01 03 02 02 F2 38 A1");
    }
    host_request(&host, "01 03 01 00 00 01");
    host_run(&host, host.now_us + 12000); /* 10 ms and two of the seven bytes */
    host_power(&host, false);
    assert_int_equal(last_event(&host.device[0], SECOND_EVENT_POWER)->old_value, 6);
    assert_true(second_next_us(&host.device[0]) == SECOND_NEVER);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hps_new_id_from_old_or_new),
        cmocka_unit_test(test_hps_broadcast_is_done_silently),
        cmocka_unit_test(test_hps_new_rate_at_three_times),
        cmocka_unit_test(test_hps_factory_reset_in_three_orders),
        cmocka_unit_test(test_hps_configuration),
        cmocka_unit_test(test_hps_offset),
        cmocka_unit_test(test_hps_over_range_and_fault),
        cmocka_unit_test(test_hps_warm_up),
        cmocka_unit_test(test_hps_unasked_output),
        cmocka_unit_test(test_hps_refusals),
        cmocka_unit_test(test_hps_gap_in_a_request),
        cmocka_unit_test(test_hps_other_line_settings),
        cmocka_unit_test(test_a16_rx_selects_the_value),
        cmocka_unit_test(test_a16_nothing_in_front),
        cmocka_unit_test(test_a16_trigger),
        cmocka_unit_test(test_a16_byte_as_trigger),
        cmocka_unit_test(test_a16_modes),
        cmocka_unit_test(test_a16_address),
        cmocka_unit_test(test_a16_two_values_in_one_frame),
        cmocka_unit_test(test_a05_probes_not_fitted),
        cmocka_unit_test(test_a05_answer_times),
        cmocka_unit_test(test_a05_level_at_power_on),
        cmocka_unit_test(test_a05_back_to_automatic),
        cmocka_unit_test(test_a05_many_probes),
        cmocka_unit_test(test_a05_request_behind_noise),
        cmocka_unit_test(test_three_on_a_pair),
        cmocka_unit_test(test_all_seeds_keep_the_wire_in_order),
        cmocka_unit_test(test_all_seeds_answer_a_plain_request),
        cmocka_unit_test(test_all_seeds_are_repeatable),
        cmocka_unit_test(test_the_log_is_a_ring),
        cmocka_unit_test(test_breaks_and_power_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
