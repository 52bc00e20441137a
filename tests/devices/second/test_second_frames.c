/* SPDX-License-Identifier: MIT */
/* Every frame that the datasheets print comes out of the devices, with the choices at the printed example. */
#include "second_host.h"

#include "second_device.h" /* the check codes */

typedef struct {
    const char *name;
    second_kind_t kind;
    second_scene_t scene;
    const char *request, *response; /* response ending in "..": only its first bytes are printed */
} printed_t;

#define NONE SECOND_NOTHING
#define ONE(mm)                                                                                              \
    {                                                                                                        \
        {                                                                                                    \
            mm, NONE, NONE, NONE                                                                             \
        }                                                                                                    \
    }
#define FOUR                                                                                                 \
    {                                                                                                        \
        {                                                                                                    \
            1000, 2000, 1953, 3562                                                                           \
        }                                                                                                    \
    }
#define A16_BUS  SECOND_A16_RS485
#define A16_232  SECOND_A16_RS232
#define A05_BUS  SECOND_A05_RS485
#define A05_UART SECOND_A05_UART
#define HPS      SECOND_HPS167S

static const printed_t printed[] = {
    {"A16 6(4) ex 1", A16_BUS, ONE(754), "01 03 01 00 00 01 85 F6", "01 03 02 02 F2 38 A1"},
    {"A16 6(4) ex 2", A16_BUS, ONE(751), "01 03 01 01 00 01 D4 36", "01 03 02 02 EF F8 A8"},
    {"A16 6(4) ex 3", A16_BUS, ONE(754), "01 06 02 00 00 05 48 71", "01 06 02 00 00 05 48 71"},
    {"A16 6(4) ex 4", A16_232, ONE(754), "01 06 02 02 00 01 E8 72", "01 06 02 02 00 01 E8 72"},
    {"A16 6(4) ex 5", A16_232, ONE(754), "01 06 02 07 00 01 F8 73", "01 06 02 07 00 01 F8 73"},
    {"A16 6(4) ex 6", A16_BUS, ONE(754), "01 06 02 05 00 00 98 73", "01 06 02 05 00 00 98 73"},
    {"A16 6(4) last", A16_BUS, ONE(754), "01 06 02 06 07 D0 6B DF", "01 06 02 06 07 D0 6B DF"},
    {"A05 2(3)3", A05_BUS, FOUR, "55 AA 01 01 01", "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62"},
    {"A05 2(3)4", A05_BUS, ONE(1953), "55 AA 01 10 10", "55 AA 01 10 07 A1 B8"},
    {"A05 2(3)5", A05_BUS, FOUR, "55 AA 05 03 07", "55 AA 05 03 07"},
    {"A05 3(4)1 ex 1", A05_BUS, ONE(316), "01 03 01 06 00 01 65 F7", "01 03 02 01 3C B9 C5"},
    {"A05 3(4)1 ex 1", A05_UART, ONE(316), "01 03 01 06 00 01 65 F7", "01 03 02 01 3C B9 C5"},
    {"A05 3(4)1 ex 2",
     A05_BUS,
     {{NONE, 2331, NONE, NONE}},
     "01 03 01 07 00 01 34 37",
     "01 03 02 09 1B FE 1F"},
    {"A05 3(4)1 ex 3",
     A05_BUS,
     {{NONE, 250, 659, 2426}},
     "01 03 01 07 00 03 B5 F6",
     "01 03 06 00 FA 02 93 09 7A 8F 47"},
    {"A05 3(4)2", A05_BUS, FOUR, "01 06 02 00 00 05 48 71", "01 06 02 00 00 05 48 71"},
    {"HPS #1", HPS, ONE(2083), "01 03 00 01 00 03 54 0B", "01 03 06 .."},
    {"HPS #2", HPS, ONE(2083), "01 03 00 02 00 04 E5 C9", "01 03 08 .."},
    {"HPS #3", HPS, ONE(2083), "01 03 00 03 00 0B F4 0D",
     "01 03 16 B0 00 39 00 25 42 34 57 14 20 34 38 35 01 06 07 05 13 09 17 03 09 1A DC"},
    {"HPS #4", HPS, ONE(2083), "01 03 00 04 00 01 C5 CB", "01 03 02 .."},
    {"HPS #5", HPS, ONE(2083), "01 03 00 08 00 04 C5 CB", "01 03 08 08 23 DC B2 07 01 00 00 FD 41"},
    {"HPS #6", HPS, ONE(2083), "01 03 00 09 00 01 54 08", "01 03 02 00 01 79 84"},
    {"HPS #7", HPS, ONE(2083), "01 06 00 0A 00 05 69 CB", "01 06 00 0A 00 05 69 CB"},
    {"HPS #9", HPS, ONE(2083), "01 06 00 11 00 01 18 0F", "01 06 00 11 00 01 18 0F"},
    {"HPS #10", HPS, ONE(2083), "01 06 00 12 00 00 29 CF", "01 06 00 12 00 00 29 CF"},
    {"HPS #11", HPS, ONE(2083), "01 06 00 13 00 FF 38 4F", "01 06 00 13 00 FF 38 4F"},
    {"HPS #15", HPS, ONE(2083), "01 10 00 20 00 02 04 00 00 00 B4", "01 10 00 20 00 02 40 02"},
    {"HPS abnormal", HPS, ONE(2083), "01 03 00 07 00 04", "01 83 02 C0 F1"},
};

/* The response's length and CRC; the data in between is not printed. */
static void check_unprinted(const char *response, const char *start)
{
    uint8_t bytes[64];
    size_t len = from_hex(response, bytes), head = strlen(start) - 2;
    assert_true(strncmp(response, start, head) == 0);
    assert_int_equal(len, 5U + bytes[2]);
    assert_int_equal(second_wire_crc16(bytes, len), 0);
}

TEST(requests_get_the_printed_responses)
{
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        const printed_t *row = &printed[i];
        /* No automatic frame beside the request. */
        const second_override_t slow[] = {{"a16_period_us", 3000000}, {"a05_period_us", 3000000}};
        second_config_t config = {
            .kind = row->kind, .scene = row->scene, .overrides = slow, .override_count = 2};
        host_open(&host, &config);
        host_power(&host, true);
        host_run(&host, 12000000);
        /* Two requests are printed without their CRC, or not at all. */
        bool no_crc = strcmp(row->name, "HPS #15") == 0 || strcmp(row->name, "HPS abnormal") == 0;
        if (no_crc)
            host_request(&host, row->request);
        else
            host_send_hex(&host, row->request);
        const char *response = host_response(&host, 450000);
        if (strstr(row->response, "..") != NULL)
            check_unprinted(response, row->response);
        else
            assert_string_equal(response, row->response);
    }
}

/* The automatic frames, and the controlled one. */
TEST(frames_without_a_request)
{
    static const struct {
        second_kind_t kind;
        second_scene_t scene;
        const char *frame;
    } rows[] = {{SECOND_A16_AUTO, ONE(1953), "FF 07 A1 A7"},
                {SECOND_A16_RS232, ONE(1953), "FF 07 A1 A7"},
                {SECOND_A16_CONTROLLED, ONE(1953), "FF 07 A1 A7"},
                {SECOND_A05_UART, FOUR, "FF 03 E8 07 D0 07 A1 0D EA 60"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        second_config_t config = {.kind = rows[i].kind, .scene = rows[i].scene};
        host_open(&host, &config);
        host_power(&host, true);
        host_run(&host, 10000000);
        if (rows[i].kind == SECOND_A16_CONTROLLED) {
            assert_int_equal(host.got_len, 0);
            second_rx_level(&host.device[0], true, host.now_us);
            second_rx_level(&host.device[0], false, host.now_us + 100);
            host_run(&host, host.now_us + 200000);
            host.read_len = 0;
        } else {
            assert_true(host.got_len > strlen(rows[i].frame) / 3 + 1);
            host.read_len = host.got_len - (strlen(rows[i].frame) + 1) / 3;
        }
        assert_string_equal(host_response(&host, 0), rows[i].frame);
    }
}

/* A05 2(3)3 with the sum as it is printed there. */
TEST(the_misprinted_sum)
{
    const second_override_t forced = {"a05_all_sum", 1};
    second_config_t config = {.kind = A05_BUS, .scene = FOUR, .overrides = &forced, .override_count = 1};
    host_open(&host, &config);
    host_power(&host, true);
    host_run(&host, 3000000);
    host_send_hex(&host, "55 AA 01 01 01");
    assert_string_equal(host_response(&host, 300000), "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 60");
}

TEST(printed_check_codes)
{
    static const struct {
        const char *bytes;
        uint16_t crc;
    } rows[] = {{"63", 0x69FF},
                {"8C", 0xE5BE},
                {"7D", 0x617F},
                {"AA BB CC", 0x4523},
                {"00 00 AA BB CC", 0x8576},
                {"01 03 00 03 00 0B", 0x0DF4},
                {"01 01 01 06 D9 FC 8C 02 01 00 01", 0xF102},
                {"31 32 33 34 35 36 37 38 39", 0x4B37}};
    uint8_t bytes[16];
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        assert_int_equal(second_wire_crc16(bytes, from_hex(rows[i].bytes, bytes)), rows[i].crc);
    assert_int_equal(second_wire_sum8(bytes, from_hex("FF 07 A1", bytes)), 0xA7);
}
