/* SPDX-License-Identifier: MIT */
/* The simulation itself: every frame that the datasheets print comes out of the devices, with the choices at the printed
 * example; and what holds for all seeds. */
#include "second_device.h" /* the check codes */

#include <string.h>

#include "suite.h"

/* A host on the wire of one device. */
static struct {
    second_device_t device;
    uint64_t now_us;
    second_line_t line;
    second_byte_t got[262144];
    size_t got_len, read_len;
} host;

static void host_hears(void *context, const second_byte_t *byte)
{
    (void)context;
    assert_true(host.got_len < sizeof host.got / sizeof host.got[0]);
    host.got[host.got_len++] = *byte;
}

static void host_run(uint64_t for_us)
{
    host.now_us += for_us;
    second_run(&host.device, host.now_us, host_hears, NULL);
}

static void host_power(bool on)
{
    second_power(&host.device, on, host.now_us);
    host_run(1);
}

/* The device has had power for that long. */
static void host_open(const second_config_t *config, uint64_t powered_us)
{
    host.now_us = 0;
    host.got_len = host.read_len = 0;
    assert_true(second_init(&host.device, config));
    host.line = second_state(&host.device).line;
    host_power(true);
    host_run(powered_us);
}

/* Sends and runs up to the end of the last byte. */
static void host_send(const uint8_t *bytes, size_t len)
{
    uint64_t bits = 9U + (host.line.parity != 'N' ? 1U : 0U) + host.line.stop_bits;
    uint64_t begin_us = host.now_us + 1;
    for (size_t i = 0; i < len; i++)
        second_host_byte(&host.device, bytes[i], begin_us + i * bits * 1000000 / host.line.baud,
                         begin_us + (i + 1) * bits * 1000000 / host.line.baud, host.line);
    host.read_len = host.got_len;
    host_run(1 + len * bits * 1000000 / host.line.baud);
}

static size_t from_hex(const char *hex, uint8_t *bytes)
{
    size_t len = 0;
    unsigned value;
    int used;
    while (sscanf(hex, " %2x%n", &value, &used) == 1) {
        bytes[len++] = (uint8_t)value;
        hex += used;
    }
    return len;
}

static void host_send_hex(const char *hex)
{
    uint8_t bytes[64];
    host_send(bytes, from_hex(hex, bytes));
}

/* Adds the CRC of a Modbus frame; bit by bit, as HPS-167S 2.2.5 tells. */
static void host_request(const char *hex)
{
    uint8_t bytes[64];
    size_t len = from_hex(hex, bytes);
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < len; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1);
    }
    bytes[len++] = (uint8_t)(crc & 0xFF);
    bytes[len++] = (uint8_t)(crc >> 8);
    host_send(bytes, len);
}

/* What came since the last request, as hex; waits first. */
static const char *host_response(uint64_t wait_us)
{
    static char hex[3 * 256];
    host_run(wait_us);
    hex[0] = '\0';
    size_t used = 0;
    for (size_t i = host.read_len; i < host.got_len && used + 4 < sizeof hex; i++)
        used +=
            (size_t)snprintf(hex + used, sizeof hex - used, used == 0 ? "%02X" : " %02X", host.got[i].value);
    return hex;
}

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
    /* what public programs print (tests/unit/test_hps167_frames.c) */
    {"HPS-167 single", SECOND_HPS167, ONE(1753), "0A 22 00 00 00 00 00 00 AE 57",
     "0A 0D 01 01 01 06 D9 DC B2 07 01 00 00 .."},
    {"HPS-167 stop", SECOND_HPS167, ONE(1753), "0A 30 01 00 00 00 00 00 BC 6F", "0A 03 01 F1 D1"},
    {"HPS-167 temperature", SECOND_HPS167, ONE(1753), "0A 3F 01 00 00 00 00 00 36 86", "0A 04 09 C4 .."},
    {"HPS-167 stop with 00", SECOND_HPS167, ONE(1753), "0A 30 00 00 00 00 00 00 BC 6F", ""},
    {"HPS abnormal", HPS, ONE(2083), "01 03 00 07 00 04", "01 83 02 C0 F1"},
};

/* The response's length and CRC; the data in between is not printed. */
static void check_unprinted(const char *response, const char *start)
{
    uint8_t bytes[64];
    size_t len = from_hex(response, bytes), head = strlen(start) - 2;
    assert_true(strncmp(response, start, head) == 0);
    if (bytes[0] == 0x0A) {
        assert_int_equal(len, 2U + bytes[1]);
        assert_int_equal(second_hps167_crc(bytes + 2, len - 4), bytes[len - 2] * 256 + bytes[len - 1]);
        return;
    }
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
        host_open(&config, 12000000);
        /* Two requests are printed without their CRC, or not at all. */
        bool no_crc = strcmp(row->name, "HPS #15") == 0 || strcmp(row->name, "HPS abnormal") == 0;
        if (no_crc)
            host_request(row->request);
        else
            host_send_hex(row->request);
        const char *response = host_response(450000);
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
        host_open(&config, 10000000);
        if (rows[i].kind == SECOND_A16_CONTROLLED) {
            assert_int_equal(host.got_len, 0);
            second_rx_level(&host.device, true, host.now_us);
            second_rx_level(&host.device, false, host.now_us + 100);
            host_run(200000);
            host.read_len = 0;
        } else {
            assert_true(host.got_len > strlen(rows[i].frame) / 3 + 1);
            host.read_len = host.got_len - (strlen(rows[i].frame) + 1) / 3;
        }
        assert_string_equal(host_response(0), rows[i].frame);
    }
}

/* A05 2(3)3 with the sum as it is printed there. */
TEST(the_misprinted_sum)
{
    const second_override_t forced = {"a05_all_sum", 1};
    second_config_t config = {.kind = A05_BUS, .scene = FOUR, .overrides = &forced, .override_count = 1};
    host_open(&config, 3000000);
    host_send_hex("55 AA 01 01 01");
    assert_string_equal(host_response(300000), "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 60");
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

/* ---- all seeds ---- */

static bool checked_frame(const second_event_t *event, bool odd_sum)
{
    if (event->raw[0] == 0xFF && event->raw_len != 0 && event->function == 0) { /* an automatic frame */
        size_t skip = event->raw[1] == 0xFF && event->raw_len == 5 ? 1 : 0;
        size_t sum = (size_t)event->raw_len - 1;
        return second_wire_sum8(event->raw + skip, sum - skip) == event->raw[sum];
    }
    if (event->raw[0] == 0x55 && event->raw[1] == 0xAA)
        return odd_sum || second_wire_sum8(event->raw, event->raw_len - 1U) == event->raw[event->raw_len - 1];
    if (event->raw[0] == 0x0A) { /* no Modbus unit has this address here */
        const size_t crc = event->raw_len - 2U;
        return second_hps167_crc(event->raw + 2, crc - 2) == event->raw[crc] * 256 + event->raw[crc + 1];
    }
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

static void live(second_kind_t kind, uint64_t seed)
{
    const second_config_t config = {
        .kind = kind, .seed = seed, .fitted = (uint8_t)(1 + seed % 15), .scene = {{1500, 2500, 3500, 4500}}};
    const second_scene_t scene = {{SECOND_NOTHING, 700, 90000, 40}};
    host_open(&config, 9000000);
    for (int i = 0; i < 4; i++) {
        if (kind == SECOND_HPS167) {
            host_send_hex("0A 22 00 00 00 00 00 00 AE 57");
        } else if (request_of(kind) != NULL) {
            host_request(request_of(kind));
        } else {
            second_rx_level(&host.device, true, host.now_us + 10);
            second_rx_level(&host.device, false, host.now_us + 2000);
        }
        host_run(600000);
        if (i == 2) second_scene(&host.device, &scene, host.now_us);
    }
    host_power(false);
    host_run(100000);
}

/* Bytes follow each other, frames carry the right check codes, the log tells what was on the wire. */
TEST(all_seeds_keep_the_wire_in_order)
{
    for (int kind = 0; kind < SECOND_RELATIVE; kind++) {
        size_t frames = 0;
        for (uint64_t seed = 1; seed <= 300; seed++) {
            live((second_kind_t)kind, seed);
            const second_device_t *d = &host.device;
            for (size_t i = 1; i < host.got_len; i++) {
                assert_true(host.got[i].start_us >= host.got[i - 1].end_us);
                assert_true(host.got[i].end_us > host.got[i].start_us);
            }
            size_t at = 0;
            bool odd_sum = second_choice(d, CHOICE_a05_all_sum) != 0;
            for (uint64_t i = 0; i < second_log_count(d); i++) {
                const second_event_t *event = second_log_at(d, i);
                bool sent = event->kind == SECOND_EVENT_MEASUREMENT || event->kind == SECOND_EVENT_RESPONSE;
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
