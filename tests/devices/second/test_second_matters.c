/* SPDX-License-Identifier: MIT */
/* No value of a choice is dead: with everything else equal it changes what a device sends or when. */
#include "second_host.h"

static const char *const modbus_requests[] = {
    "01 03 01 00 00 01", "01 03 02 07 00 01", "01 03 01 00 00 02", "01 03 01 01 00 03", "01 03 01 06 00 04",
    "01 03 01 08 00 03", "01 03 01 07 00 01", "01 03 00 10 00 02", "01 03 00 13 00 01", "01 03 02 00 00 01",
    "01 03 02 02 00 01", "01 03 02 05 00 03", "01 03 33 33 00 01", "01 03 01 00 00 00", "01 03 01 00 00",
    "01 04 01 00 00 01", "FF 03 01 06 00 01", "FF 03 01 00 00 01", "01 06 01 00 00 01", "01 06 01 06 00 01",
    "01 06 33 33 00 01", "01 06 02 00 00 FF", "FF 06 02 06 00 09", "01 06 02 05 00 02", "01 06 02 05 00 00",
    "01 06 02 07 00 02", "01 06 02 07 00 01", "01 06 02 07 00 00", "01 06 02 02 00 03", "01 06 02 02 00 00",
    "01 06 02 02 00 01", "02 03 01 00 00 01", "01 03 01 00 00 01", "00 06 02 00 00 01", "00 06 02 00 00 06",
    "01 06 02 00 01 01", "01 06 02 00 01 09", "01 03 02 00 00 01", "01 06 02 00 00 00", "00 03 02 00 00 01",
    "FF 06 02 00 00 05", "05 06 02 07 00 01", "01 06 02 07 00 01"};
static const char *const hps_requests[] = {"01 03 00 01 00 03",
                                           "01 03 00 02 00 04",
                                           "01 03 00 03 00 0B",
                                           "01 03 00 04 00 01",
                                           "01 03 00 08 00 04",
                                           "01 06 00 0A 01 02",
                                           "01 03 00 02 00 04",
                                           "01 06 00 0A 00 09",
                                           "01 03 00 02 00 04",
                                           "01 06 00 11 00 09",
                                           "01 03 00 02 00 04",
                                           "01 06 00 12 00 03",
                                           "01 06 00 12 00 FF",
                                           "01 06 00 13 00 00",
                                           "01 06 00 13 00 FF",
                                           "01 06 00 14 FF F1",
                                           "01 06 00 14 FF F1",
                                           "01 03 00 08 00 04",
                                           "01 06 00 14 F0 00",
                                           "01 03 00 08 00 04",
                                           "01 06 00 15 00 03",
                                           "01 06 00 15 00 00",
                                           "01 03 00 08 00 04",
                                           "01 06 00 16 FF 9C",
                                           "01 06 00 16 02 00",
                                           "01 03 00 08 00 04",
                                           "01 03 33 33 00 01",
                                           "01 03 00 08 00 03",
                                           "01 03 00 08 00",
                                           "01 04 00 08 00 04",
                                           "01 10 00 20 00 02 04 00 00 00 65",
                                           "01 10 00 20 00 02 04 65 00 00 00",
                                           "01 10 00 20 00 02 04 00 65 00 00",
                                           "01 10 00 20 00 02 04 00 00 00 B4",
                                           "01 03 00 02 00 04",
                                           "01 10 00 20 00 01 02 00 65",
                                           "01 06 00 10 00 21",
                                           "01 06 00 10 00 01",
                                           "01 03 00 01 00 03",
                                           "00 03 00 09 00 01"};
static const char *const hps_ending[] = {"01 06 00 15 00 FF", "01 03 00 02 00 04", "01 06 00 10 00 03",
                                         "03 03 00 08 00 04"};
static const char *const dyp_requests[] = {
    "55 AA 01 01 01", "55 AA 01 10 10",    "55 AA 01 11 11", "55 AA 01 12 12",
    "55 AA FF 10 0E", "00 55 AA 01 13 13", "55 AA FF 03 01", "55 AA 01 01 01 55 AA 01 10 10"};

static void set_scene(int32_t a, int32_t b, int32_t c, int32_t d)
{
    second_scene_t scene = {{a, b, c, d}};
    second_scene(&host.device[0], &scene, host.now_us);
}

static void wait_us(uint64_t us) { host_run(&host, host.now_us + us); }

static void follow_rate(void) { host.line.baud = second_state(&host.device[0]).line.baud; }

static void ask_all(const char *const *requests, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        follow_rate();
        host_request(&host, requests[i]);
        wait_us(620000);
    }
}

static void level_pulse(uint64_t low_us)
{
    second_rx_level(&host.device[0], true, host.now_us + 1);
    second_rx_level(&host.device[0], false, host.now_us + 1 + low_us);
}

static void restart(bool low)
{
    host_power(&host, false);
    second_rx_level(&host.device[0], low, host.now_us);
    wait_us(50000);
    host_power(&host, true);
    wait_us(600000);
    second_rx_level(&host.device[0], false, host.now_us);
}

static void a16_life(void)
{
    static const uint64_t widths_us[] = {1, 100, 500, 990, 1500, 3000};
    restart(true);
    wait_us(11000000);
    for (size_t i = 0; i < 6; i++) {
        level_pulse(widths_us[i]);
        if (i == 3) set_scene(1500, 0, 0, 0);
        wait_us(115000);
    }
    set_scene(SECOND_NOTHING, 0, 0, 0);
    level_pulse(2000);
    wait_us(8000000);
    second_rx_level(&host.device[0], true, host.now_us);
    set_scene(3000, 0, 0, 0);
    wait_us(3000000);
    second_rx_level(&host.device[0], false, host.now_us);
    wait_us(9000000);
}

/* The scene changes while a request is served, another request comes, and bytes come over the response. */
static void crowd(const char *request, const char *next)
{
    for (int32_t i = 0; i < 6; i++) {
        follow_rate();
        set_scene(1000 + i, 1000 + i, 1000 + i, 1000 + i);
        host_request(&host, request);
        wait_us(500);
        set_scene(2000 + i, 2000 + i, 2000 + i, i < 2 ? 2000 + i : SECOND_NOTHING);
        if (i % 2 == 0) {
            host_run(&host, host.now_us + 5000);
            host_request(&host, next);
        } else {
            size_t before = host.got_len;
            for (int k = 0; k < 500 && host.got_len == before; k++) wait_us(1000);
            host_request(&host, next);
        }
        wait_us(900000);
    }
}

static void hps_life(void)
{
    wait_us(3000000);
    ask_all(hps_requests, 5);
    wait_us(6000000);
    ask_all(hps_requests, sizeof hps_requests / sizeof hps_requests[0]);
    for (int i = 0; i < 40; i++) { /* failures by themselves */
        host_request(&host, "01 03 00 08 00 04");
        wait_us(200000);
    }
    host_send_hex(&host, "01 03 00 08 00 04 C5 C8");
    wait_us(600000);
    static const int32_t distances_mm[] = {SECOND_NOTHING, 70, 20000, 50000, 1, 1500};
    for (size_t i = 0; i < 6; i++) {
        set_scene(distances_mm[i], 0, 0, 0);
        ask_all(hps_requests + 4, 1);
    }
    ask_all(hps_requests + 15, 2);
    set_scene(5, 0, 0, 0);
    ask_all(hps_requests + 17, 1);
    ask_all(hps_requests + 20, 6);
    for (int i = 0; i < 10; i++) { /* the scene changes while a measurement runs */
        set_scene(1000 + i, 0, 0, 0);
        host_request(&host, "01 03 00 08 00 04");
        set_scene(2000 + i, 0, 0, 0);
        wait_us(300000);
    }
    crowd("01 03 00 01 00 03", "01 03 00 08 00 04");
    second_fault(&host.device[0], true, host.now_us);
    ask_all(hps_requests, 5);
    wait_us(2000000);
    second_fault(&host.device[0], false, host.now_us);
    host.line.parity = 'O';
    ask_all(hps_requests, 1);
    host.line.parity = 'E';
    host_send_hex(&host, "01 03 00 01");
    wait_us(1400);
    host_send_hex(&host, "00 03 54 0B");
    wait_us(300000);
    host_request(&host, "01 03 00 01 00 03"); /* right behind the end of a response */
    for (uint64_t was = host.got_len; host.got_len < was + 11 && host.now_us < 200000000;) wait_us(100);
    ask_all(hps_requests, 1);
    restart(false);
    wait_us(15000000);
    ask_all(hps_requests + 1, 1);
    ask_all(hps_ending, 4);
    host_request(&host, "03 06 00 11 00 02");
    wait_us(400000);
    follow_rate();
    host_request(&host, "03 03 00 09 00 01");
    wait_us(400000);
    restart(false);
    wait_us(15000000);
    ask_all(hps_requests, 5);
    ask_all(hps_requests + 23, 3);
    host_request(&host, "01 06 00 11 00 02");
    wait_us(400000);
    restart(false);
    wait_us(15000000);
    ask_all(hps_requests, 5);
}

static void modbus_life(second_kind_t kind)
{
    size_t count = sizeof modbus_requests / sizeof modbus_requests[0];
    restart(true);
    wait_us(1500000);
    ask_all(modbus_requests, 1);
    crowd("01 03 01 00 00 01", "01 03 01 01 00 01");
    crowd("01 03 01 06 00 01", "01 03 01 09 00 01");
    wait_us(8000000);
    ask_all(modbus_requests, 1);
    set_scene(SECOND_NOTHING, 0, 0, 0);
    ask_all((const char *const[]){"01 03 01 01 00 01", "01 03 01 01 00 01"}, 2);
    if (kind == SECOND_A05_RS485) {
        ask_all(modbus_requests, 1);
        for (size_t i = 0; i < sizeof dyp_requests / sizeof dyp_requests[0]; i++) {
            host_send_hex(&host, dyp_requests[i]);
            set_scene(1000 + (int32_t)i, 2000, 3000, 4000);
            wait_us(600000);
        }
    }
    set_scene(SECOND_NOTHING, SECOND_NOTHING, 2222, 3333);
    wait_us(8000000);
    host_request(&host, "02 03 01 00 00 01");
    wait_us(2000000);
    ask_all(modbus_requests, count);
    host_request(&host, "01 03 01 07 00 01"); /* two at once */
    host_run(&host, host.now_us + 5000);
    host_request(&host, "01 03 01 01 00 01");
    wait_us(15000000);
    ask_all(modbus_requests, 2);
    restart(false);
    wait_us(4000000);
    ask_all(modbus_requests, count);
    host_send_hex(&host, "55 AA 00 03 02");
    wait_us(300000);
    ask_all((const char *const[]){"00 03 02 00 00 01", "00 06 02 00 00 01"}, 2);
    host_send_hex(&host, "55 AA 01 03 03");
    wait_us(600000);
    ask_all(modbus_requests, 1);
    restart(false);
    wait_us(4000000);
    ask_all(modbus_requests, count);
}

static void mix(uint64_t *digest, uint64_t value) { *digest = (*digest ^ value) * UINT64_C(0x100000001B3); }

/* A life with all that can happen; what was sent, and what the log says, as one number. */
static uint64_t live(second_kind_t kind, uint64_t seed, const second_override_t *forced)
{
    second_config_t config = {
        .kind = kind, .seed = seed, .fitted = 0x0D, .scene = {{1000, 2000, 3000, 4000}}};
    config.overrides = forced;
    config.override_count = 1;
    host_open(&host, &config);
    host.line = second_state(&host.device[0]).line;
    host_power(&host, true);
    wait_us(2500000);
    if (kind == SECOND_HPS167S)
        hps_life();
    else if (kind == SECOND_A16_AUTO || kind == SECOND_A16_CONTROLLED || kind >= SECOND_TALKERS)
        a16_life();
    else
        modbus_life(kind);
    level_pulse(700);
    level_pulse(5000);
    wait_us(300000);
    host.line.baud *= 2;
    host_send_hex(&host, "01 03 01 00 00 01 85 F6");
    wait_us(500000);
    uint64_t digest = 1;
    for (size_t i = 0; i < host.got_len; i++) {
        mix(&digest, host.got[i].value);
        mix(&digest, host.got[i].start_us);
        mix(&digest, host.got[i].line.baud + (uint64_t)host.got[i].line.parity);
    }
    for (uint64_t i = 0; i < second_log_count(&host.device[0]); i++) {
        const second_event_t *event = second_log_at(&host.device[0], i);
        if (event == NULL) continue;
        mix(&digest, (uint64_t)event->kind << 8 | event->address);
        mix(&digest, event->time_us + (uint64_t)event->new_value);
    }
    return digest;
}

static bool differs(second_kind_t kind, const second_choice_row_t *row, int64_t a, int64_t b)
{
    for (uint64_t seed = 1; seed <= 40; seed++) {
        const second_override_t one = {row->name, a}, other = {row->name, b};
        if (live(kind, seed, &one) != live(kind, seed, &other)) return true;
    }
    return false;
}

/* On a register there is no frame to leave out. */
static bool same_by_definition(second_kind_t kind, int c, int64_t a, int64_t b)
{
    return kind == SECOND_A16_RS485 && ((c == CHOICE_a16_before_ready && a == 1 && b == 0) ||
                                        (c == CHOICE_a16_nothing && a == -2 && b == 65535));
}

TEST(every_value_changes_something)
{
    int dead = 0;
    for (int c = 0; c < CHOICE_COUNT; c++) {
        const second_choice_row_t *row = second_choice_row((second_choice_t)c);
        for (int k = 0; k < SECOND_KINDS; k++) {
            second_kind_t kind = (second_kind_t)k;
            if ((row->kinds >> k & 1) == 0) continue;
            if (row->values == NULL && !differs(kind, row, row->low, row->high)) {
                print_message("%s: dead for kind %d\n", row->name, k);
                dead++;
            }
            for (size_t i = 1; i < row->value_count; i++) {
                for (size_t j = 0; j < i; j++) {
                    if (same_by_definition(kind, c, row->values[i].value, row->values[j].value)) continue;
                    if (differs(kind, row, row->values[i].value, row->values[j].value)) continue;
                    print_message("%s: %lld and %lld are the same for kind %d\n", row->name,
                                  (long long)row->values[i].value, (long long)row->values[j].value, k);
                    dead++;
                }
            }
        }
    }
    assert_int_equal(dead, 0);
}
