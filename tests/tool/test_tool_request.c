/* SPDX-License-Identifier: MIT */
/* fathom request: what leaves, what it says of what comes back, and that nothing dangerous leaves unasked. The CRCs are
 * those of the datasheets, or computed bit by bit from the polynomial 0xA001. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

/* ---- a far end that says what the test says ---- */

/* 9600 8N1: a character of 10 bits takes 1041.7 us. */
enum { CHARACTER_US = 1042, MOST = 256 };

typedef struct {
    uint32_t now_us;
    uint32_t leaves_us; /* the end of the last request */
    uint32_t delay_us;  /* from there to the first character of the response, at its beginning */
    bool echoes;
    uint8_t sent[MOST]; /* by the tool, all of it */
    size_t sent_length;
    unsigned writes;
    uint8_t answer[MOST];
    size_t length;
    uint8_t coming[2 * MOST]; /* echo and response */
    uint32_t at_us[2 * MOST]; /* when each is there */
    size_t count;
    size_t taken;
    bool babbles; /* a byte every 2 ms, less than the silence of 3.5 characters */
    uint32_t babbled;
    tool_line_t tool;
} far_end_t;

static far_end_t far_end;

static uint32_t far_now(void *ctx) { return far_end.now_us; }

static void come(uint8_t byte, uint32_t at_us)
{
    far_end.at_us[far_end.count] = at_us;
    far_end.coming[far_end.count++] = byte;
}

static int far_write(void *ctx, const uint8_t *bytes, size_t length)
{
    memcpy(far_end.sent + far_end.sent_length, bytes, length);
    far_end.sent_length += length;
    far_end.writes++;
    for (uint32_t i = 0; i != length && far_end.echoes; i++)
        come(bytes[i], far_end.now_us + (i + 1) * CHARACTER_US);
    far_end.leaves_us = far_end.now_us + (uint32_t)length * CHARACTER_US;
    for (uint32_t i = 0; i != far_end.length; i++)
        come(far_end.answer[i], far_end.leaves_us + far_end.delay_us + (i + 1) * CHARACTER_US);
    return (int)length;
}

static int far_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    size_t n = 0;
    if (far_end.babbles && far_end.now_us / 2000 != far_end.babbled) {
        far_end.babbled = far_end.now_us / 2000;
        bytes[n++] = 0x55;
    }
    for (; n != capacity && far_end.taken != far_end.count && far_end.at_us[far_end.taken] <= far_end.now_us;
         n++)
        bytes[n] = far_end.coming[far_end.taken++];
    return (int)n;
}

static bool far_sent(void *ctx) { return far_end.now_us >= far_end.leaves_us; }

static int far_set_line(void *ctx, const fathom_line_settings_t *settings) { return 1; }

static void far_idle(void *ctx, uint32_t max_us)
{
    const uint32_t most_us = far_end.babbles ? 2000 : 10000;
    uint32_t by_us = max_us < most_us ? max_us : most_us;
    if (far_end.taken != far_end.count && far_end.at_us[far_end.taken] - far_end.now_us < by_us)
        by_us = far_end.at_us[far_end.taken] - far_end.now_us;
    far_end.now_us += by_us != 0 ? by_us : 1;
}

/* Bytes in hex, as a test writes them. */
static size_t bytes_of(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned byte;
    for (; sscanf(text, "%2x", &byte) == 1; text += text[2] == ' ' ? 3 : 2) bytes[count++] = (uint8_t)byte;
    return count;
}

/* It answers with this 20 ms after the request. */
static void far_answers(const char *answer)
{
    memset(&far_end, 0, sizeof far_end);
    far_end.delay_us = 20000;
    far_end.length = bytes_of(answer, far_end.answer);
    far_end.tool = (tool_line_t){
        .uart = {.read = far_read, .write = far_write, .sent = far_sent, .set_line = far_set_line},
        .clock = {far_now, NULL},
        .idle = far_idle};
}

static void expect_sent(const char *bytes)
{
    uint8_t expected[MOST];
    const size_t length = bytes_of(bytes, expected);
    assert_int_equal(far_end.sent_length, length);
    assert_memory_equal(far_end.sent, expected, length);
}

static int set_up(void **state)
{
    bench_begin();
    far_answers("");
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* At the far end: it ends so, says this on stdout and this on stderr, and one request has left at most. */
static void far_run(int status, const char *out, const char *err, const char *line)
{
    const tool_run_t *const run = tool_run(&far_end.tool, "request %s --port line", line);
    if (run->status != status || strstr(run->out, out) == NULL || strstr(run->err, err) == NULL)
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
    assert_in_range(far_end.writes, 0, 1);
}

/* ---- simulated sensors ---- */

TEST(a_read_of_an_a16_is_shown_in_all_its_meanings)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *const run = tool_run(&bench.tool, "request 1 3 0x0101 --sensor a16 --port line");
    assert_int_equal(run->status, 0);
    /* 1234 mm are 0x04D2 */
    assert_string_equal(run->out, "sent      01 03 01 01 00 01 D4 36\n"
                                  "received  01 03 02 04 D2 3A D9\n"
                                  "0x0101    unsigned  1234  signed   1234  hex 04D2\n"
                                  "        a16      0x0101 real-time distance: distance 1234 mm\n");
    assert_non_null(strstr(run->err, "ends the automatic output of an A16 with RS232"));
    assert_int_equal(bench.a16.device.counters.requests, 1);
}

TEST(three_probes_of_an_a05_are_three_lines)
{
    bench_a05((fathom_sim_a05_config_t){.address = 1});
    bench.scene = (fathom_sim_fixed_t){{1000, 250, 659, 2426}};
    const tool_run_t *const run = tool_run(&bench.tool, "request 1 3 0x0107 3 --port line");
    assert_int_equal(run->status, 0);
    /* A05 3(4)1, example 3 */
    assert_string_equal(run->out, "sent      01 03 01 07 00 03 B5 F6\n"
                                  "received  01 03 06 00 FA 02 93 09 7A 8F 47\n"
                                  "0x0107    unsigned   250  signed    250  hex 00FA\n"
                                  "0x0108    unsigned   659  signed    659  hex 0293\n"
                                  "0x0109    unsigned  2426  signed   2426  hex 097A\n");
}

TEST(with_the_sensor_go_its_line_and_what_the_answer_means)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    const tool_run_t *run = tool_run(&bench.tool, "request 7 3 8 4 --sensor hps167s --port line");
    assert_int_equal(run->status, 0);
    assert_int_equal(bench.line.settings.baud, 19200);
    assert_int_equal(bench.line.settings.parity, FATHOM_PARITY_EVEN);
    assert_non_null(strstr(run->out, "hps167s  #5 single measurement\n"));
    assert_non_null(strstr(run->out, "1234 mm\n"));
    assert_null(strstr(run->err, "automatic output")); /* of an HPS-167S there is none that ends */
    run = tool_run(&bench.tool, "request 7 3 8 4 --timeout 300 --port line"); /* 9600 8N1 */
    assert_int_equal(run->status, 1);
    assert_int_equal(bench.line.settings.baud, 9600);
    run = tool_run(&bench.tool, "request 7 3 8 4 --baud 19200 --parity even --port line");
    assert_int_equal(run->status, 0);
    assert_null(strstr(run->out, "#5"));
}

TEST(json_is_an_object_with_the_bytes)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *const run =
        tool_run(&bench.tool, "request 1 3 0x0101 1 --sensor a16 --format json --port line");
    assert_int_equal(run->status, 0);
    assert_string_equal(
        run->out, "{\"unit\":1,\"function\":3,\"status\":\"answered\",\"sent\":\"01 03 01 01 00 01 D4 36\","
                  "\"received\":\"01 03 02 04 D2 3A D9\",\"registers\":[{\"register\":\"0x0101\","
                  "\"unsigned\":1234,\"signed\":1234,\"hex\":\"04D2\",\"ascii\":null}],\"meanings\":"
                  "[{\"sensor\":\"a16\",\"source\":\"A16 6(3)\",\"what\":\"0x0101 real-time distance\","
                  "\"fields\":{\"distance_mm\":1234},\"notes\":{}}]}\n");
}

TEST(a_write_sets_the_register)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *run = tool_run(&bench.tool, "request 1 6 0x0200 5 --yes --echo off --port line");
    assert_int_equal(run->status, 0);
    /* A16 6(4), example 3 */
    assert_string_equal(run->out, "sent      01 06 02 00 00 05 48 71\nreceived  01 06 02 00 00 05 48 71\n");
    assert_non_null(strstr(run->err, "fathom: if it is a16: set 0x0200 slave address: address 5\n"));
    assert_int_equal(bench.a16.device.address, 5);
    assert_int_equal(bench.a16.device.counters.writes, 1);
}

TEST(a_write_of_many_is_decoded_and_obeyed)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 1});
    /* #15: 180 ms, ten times 18 */
    const tool_run_t *const run =
        tool_run(&bench.tool, "request 1 16 0x0020 0 180 --sensor hps167s --yes --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(run->out, "sent      01 10 00 20 00 02 04 00 00 00 B4 F1 C0\n"
                                     "received  01 10 00 20 00 02 40 02\n"));
    assert_non_null(strstr(run->err, "#15 reconnect time: reconnect time 180 ms\n"));
    assert_int_equal(bench.hps167s.reconnect_ms, 180);
}

TEST(all_units_obey_a_broadcast_and_none_is_waited_for)
{
    bench_a16((fathom_sim_a16_config_t){.address = 9});
    const tool_run_t *const run =
        tool_run(&bench.tool, "request 0 6 0x0205 1 --yes --timeout 9000 --port line");
    assert_int_equal(run->status, 0);
    assert_string_equal(run->out, "sent      00 06 02 05 00 01 58 62\n");
    assert_non_null(strstr(run->err, "sent to all units, none of which answers"));
    /* 66 ms of listening, 8.3 of the request and 200 of the turnaround */
    assert_in_range(run->took_us, 266000, 300000);
}

TEST(a_read_of_0x0009_resets_an_hps167s_if_that_is_meant)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    const tool_run_t *run = tool_run(&bench.tool, "request 7 3 9 1 --sensor hps167s --port line");
    assert_int_equal(run->status, 2);
    assert_non_null(strstr(run->err, "a read of 0x0009 resets an HPS-167S"));
    assert_int_equal(bench.hps167s.device.counters.requests, 0);
    assert_int_equal(bench.hps167s.device.address, 7);
    run = tool_run(&bench.tool, "request 7 3 9 1 --sensor hps167s --yes --port line");
    assert_int_equal(run->status, 0);
    assert_int_equal(bench.hps167s.device.address, 1);
}

/* ---- what leaves, and what does not ---- */

TEST(without_yes_nothing_dangerous_leaves)
{
    static const struct {
        const char *line;
        const char *says;
    } rows[] = {
        {"1 6 0x0200 5", "the request writes"},
        {"1 16 0x0205 1 2", "the request writes"},
        {"1 5 00 00 ff 00", "function 5 (0x05) is in none of the datasheets"},
        {"1 0x2b 0e 01 00", "function 43 (0x2B) is in none of the datasheets"},
        {"1 23 00 00 00 01 00 00 00 01 02 00 00", "function 23 (0x17) is in none"},
        {"1 10 02 05 00 01 02 00 00", "in hex: 0x10, which is 16"},
        {"1 6 0x0015 0xFF", "hps167s: resets the device's settings"}, /* HPS-167S #13 */
        {"1 3 0x0009", "a read of 0x0009 resets"},
        {"1 3 8 2", "a read of 0x0009 resets"},
        {"1 3 0 10", "a read of 0x0009 resets"},
        {"1 4 9 1", "a read of 0x0009 resets"},
        {"1 4 8 4", "a read of 0x0009 resets"},
        {"1 3 8 3", "a read of 0x0009 resets"},
        {"1 3 3 12", "a read of 0x0009 resets"},
        {"0 3 0x0101", "unit 0 is all units, or an A16 or A05"},
        {"0 6 0x0200 5", "unit 0 is all units: all obey"},
        {"255 3 0x0101", "unit 255: each A16 and A05 obeys"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        far_answers("01 06 02 00 00 05 48 71");
        far_run(2, "", rows[i].says, rows[i].line);
        far_run(2, "", "nothing was sent; --yes sends it all the same", rows[i].line);
        assert_int_equal(far_end.sent_length, 0);
    }
}

/* Those of HPS-167S #5 and #3 go over it, and are none of it. */
TEST(a_read_beside_0x0009_needs_no_yes)
{
    static const char *const lines[] = {"1 3 0 9", "1 3 8 4",    "1 3 3 11",        "1 3 10 1",
                                        "1 3 8 1", "1 4 0x0101", "1 1 00 09 00 01", "1 2 00 09 00 01"};
    for (size_t i = 0; i != sizeof lines / sizeof lines[0]; i++) {
        far_answers("");
        far_run(1, "", "nothing was heard at all", lines[i]);
        assert_int_equal(far_end.writes, 1);
    }
}

TEST(numbers_are_decimal_or_hex_and_bytes_are_hex)
{
    static const struct {
        const char *line;
        const char *bytes;
    } rows[] = {
        {"1 3 257", "01 03 01 01 00 01 D4 36"},
        {"0x1 0x03 0x0101 0x2", "01 03 01 01 00 02 94 37"},
        {"1 4 0x0101", "01 04 01 01 00 01 61 F6"},
        {"1 06 0x0014 -15 --yes", "01 06 00 14 FF F1 49 BA"}, /* real 200, measured 215 (HPS-167S #12) */
        {"1 0x10 0x20 0 180 --yes", "01 10 00 20 00 02 04 00 00 00 B4 F1 C0"},
        {"1 43 0x0e 1 0 --yes", "01 2B 0E 01 00 70 77"},
        {"1 1 00 00 00 08", "01 01 00 00 00 08 3D CC"},
        {"1 3 0x0009 1 --yes", "01 03 00 09 00 01 54 08"}, /* HPS-167S #6 */
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        far_answers("");
        far_run(1, "", "no response from address 1", rows[i].line);
        expect_sent(rows[i].bytes);
    }
}

TEST(wrong_usage_is_told_and_nothing_leaves)
{
    static const struct {
        const char *line;
        const char *says;
    } rows[] = {
        {"", "which unit?"},
        {"1", "which function?"},
        {"256 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not '256'"},
        {"-1 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not '0xFFFF'"},
        {"a16 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not 'a16'"},
        {"1 0 1", "FUNCTION is from 1 to 127"},
        {"1 0x80 1", "FUNCTION is from 1 to 127"},
        {"1 read 1", "FUNCTION is from 1 to 127"},
        {"1 3", "which register?"},
        {"1 3 65536", "REGISTER is from 0 to 65535"},
        {"1 3 0x", "REGISTER is from 0 to 65535"},
        {"1 3 0x01G1", "REGISTER is from 0 to 65535"},
        {"1 3 0x0101 0", "COUNT is from 1 to 125"},
        {"1 3 0x0101 126", "COUNT is from 1 to 125"},
        {"1 3 0xFFFF 2", "2 registers from 0xFFFF on go beyond 0xFFFF"},
        {"1 3 1 1 1", "a read takes a register and how many; '1' is too much"},
        {"1 6 1 --yes", "function 6 writes one value (several: function 16), not 0"},
        {"1 6 1 2 3 --yes", "function 6 writes one value (several: function 16), not 2"},
        {"1 6 1 65536 --yes", "VALUE is from 0 to 65535"},
        {"1 6 1 -32769 --yes", "there is no option -"},
        {"1 16 1 --yes", "function 16 writes 1 to 123 values"},
        {"1 16 0xFFFF 1 2 --yes", "function 16 writes 1 to 123 values, up to register 0xFFFF"},
        {"1 43 0e 100 --yes", "function 43 takes bytes in hex, such as 0e, not '100'"},
        {"1 43 xy --yes", "function 43 takes bytes in hex, such as 0e, not 'xy'"},
        {"1 3 1 --sensor a17", "there is no sensor 'a17', only a16, a05, hps167s"},
        {"1 3 1 --baud 1200", "--baud takes 9600,"},
        {"1 3 1 --parity mark", "--parity takes none, even or odd, not 'mark'"},
        {"1 3 1 --stop-bits 3", "--stop-bits takes a whole number from 1 to 2"},
        {"1 3 1 --echo yes", "--echo takes auto, on or off, not 'yes'"},
        {"1 3 1 --timeout 0", "--timeout takes a whole number from 1 to 600000"},
        {"1 3 1 --format csv", "there is no format 'csv', only text, json"},
        {"1 3 1 --retries 2", "there is no option --retries"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) far_run(2, "", rows[i].says, rows[i].line);
    assert_int_equal(far_end.sent_length, 0);
    const tool_run_t *const run = tool_run(&far_end.tool, "request 1 3 1");
    assert_int_equal(run->status, 2);
    assert_non_null(strstr(run->err, "--port is missing"));
}

/* ---- what comes back ---- */

TEST(registers_are_unsigned_signed_hex_and_text)
{
    far_answers("01 03 04 41 42 FA 24 0C A0"); /* 0xFA24 is 64036, and 64036 - 65536 = -1500 */
    far_run(0,
            "0x0101    unsigned 16706  signed  16706  hex 4142  ascii \"AB\"\n"
            "0x0102    unsigned 64036  signed  -1500  hex FA24\n",
            "", "1 3 0x0101 2");
    far_answers("01 03 04 80 00 7F FF B3 83");
    far_run(0, "unsigned 32768  signed -32768  hex 8000\n0x0102    unsigned 32767  signed  32767  hex 7FFF\n",
            "", "1 3 0x0101 2");
    far_answers("01 03 02 22 5C A0 DD"); /* a quote and a backslash */
    far_run(0, "\"ascii\":\"\\\"\\\\\"}", "", "1 3 0x0101 --format json");
}

TEST(what_comes_back_is_told)
{
    static const struct {
        const char *line;
        const char *answer;
        int status;
        const char *out;
        const char *err;
    } rows[] = {
        {"1 4 0x0101", "01 04 02 02 EF F9 DC", 0, "0x0101    unsigned   751  signed    751  hex 02EF\n", ""},
        {"1 1 00 00 00 08", "01 01 01 55 91 B7", 0, "received  01 01 01 55 91 B7\n", ""},
        {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63", 0,
         "received  01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63\n", ""},
        /* refused */
        {"1 3 0x0101", "01 83 02 C0 F1", 1, "received  01 83 02 C0 F1\n",
         "unit 1 refused: exception 02 (illegal data address): it has no such register\n"},
        {"1 3 0x0101 --sensor hps167s", "01 83 02 C0 F1", 1, "",
         "it has no such register; HPS table 39: illegal start address or register address\n"},
        {"1 3 0x0101 --sensor a16", "01 83 02 C0 F1", 1, "", "no exceptions are in the datasheet of a16\n"},
        {"1 6 0x0200 5 --yes", "01 86 04 43 A3", 1, "", "exception 04 (server device failure): "},
        {"1 0x2b 0e 01 00 --yes", "01 AB 01 9E F0", 1, "", "exception 01 (illegal function): "},
        {"1 3 0x0101 --format json", "01 83 02 C0 F1", 1,
         "\"status\":\"exception\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"received\":\"01 83 02 C0 F1\","
         "\"exception\":{\"code\":2,\"name\":\"illegal data address\"}",
         ""},
        /* damaged: a bit of the CRC, of the value; half a frame, which leaves open what is the rest */
        {"1 3 0x0101", "01 03 02 02 EF F8 A9", 1, "heard     01 03 02 02 EF F8 A9\n", "was damaged; "},
        {"1 3 0x0101", "01 03 02 12 EF F8 A8", 1, "heard     01 03 02 12 EF F8 A8\n", "was damaged; "},
        {"1 3 0x0101 --format json", "01 03 02 02 EF F8 A9", 1,
         "\"status\":\"damaged\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"heard\":\"01 03 02 02 EF F8 A9\"",
         ""},
        {"1 3 0x0101", "01 03 02 02", 1, "heard     01 03 02 02\n", "was damaged; "},
        {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64", 1,
         "heard     01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64\n", "was damaged; "},
        /* another unit, another function, another count, another register */
        {"1 3 0x0101", "02 03 02 02 EF BC A8", 1, "heard     02 03 02 02 EF BC A8\n",
         "it was address 2 that was heard; try UNIT 2"},
        {"1 3 0x0101", "01 04 02 02 EF F9 DC", 1, "heard     01 04 02 02 EF F9 DC\n",
         "unit 1 answered something else than was asked"},
        {"1 3 0x0101 2", "01 03 02 02 EF F8 A8", 1, "", "unit 1 answered something else than was asked"},
        {"1 6 0x0200 5 --yes", "01 06 02 05 00 01 59 B3", 1, "", "unit 1 answered something else"},
        {"1 5 00 00 ff 00 --yes", "01 05 00 01 FF 00 DD FA", 1, "", "unit 1 answered something else"},
        /* no frame, and nothing */
        {"1 3 0x0101", "55 FE 80", 1, "heard     55 FE 80\n", "bytes were heard, but no Modbus frame; "},
        {"1 3 0x0101", "", 1, "sent      01 03 01 01 00 01 D4 36\n",
         "nothing was heard at all; check the supply, A and B (or RX and TX) swapped, UNIT, and --baud"},
        {"1 3 0x0101 --format json", "", 1, "\"status\":\"no_response\"", ""},
        /* noise before it, and more behind it */
        {"1 3 0x0101", "55 FE 80 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "3 bytes more came than the response\n"},
        {"1 3 0x0101", "01 03 02 02 EF F8 A8 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "7 bytes more came: two units may have this address\n"},
        {"1 3 0x0101", "01 03 02 02 EF F8 A8 02 03 02 02 EF BC A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "7 bytes more came: another unit has answered too\n"},
        /* addresses with a meaning of their own */
        {"255 3 0x0101 --yes", "05 03 02 02 EF 09 68", 0, "received  05 03 02 02 EF 09 68\n", ""},
        {"0 3 0x0101 --yes", "00 03 02 02 EF C5 68", 0, "received  00 03 02 02 EF C5 68\n", ""},
        {"0 6 0x0205 1 --yes", "00 06 02 05 00 01 58 62", 0, "", "sent to all units"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        far_answers(rows[i].answer);
        far_run(rows[i].status, rows[i].out, rows[i].err, rows[i].line);
        assert_int_equal(far_end.writes, 1);
    }
}

TEST(only_the_sensor_that_was_named_and_could_be_there_is_guessed)
{
    far_answers("01 03 02 00 05 78 47");
    const tool_run_t *run = tool_run(&far_end.tool, "request 1 3 0x0200 --sensor a05 --port line");
    assert_non_null(strstr(run->out, "a05      0x0200 slave address: address 5\n"));
    assert_null(strstr(run->out, "a16"));
    run = tool_run(&far_end.tool, "request 1 6 0x0200 5 --sensor a05 --port line");
    assert_non_null(strstr(run->err, "if it is a05: set 0x0200"));
    assert_null(strstr(run->err, "if it is a16"));
    run = tool_run(&far_end.tool, "request 255 6 0x0200 5 --port line");
    assert_non_null(strstr(run->err, "if it is a16: set 0x0200"));
    run = tool_run(&far_end.tool, "request 32 6 0x0016 5 --port line");
    assert_non_null(strstr(run->err, "if it is hps167s: #14 filter sensitivity: filter sensitivity 5\n"));
    run = tool_run(&far_end.tool, "request 33 6 0x0016 5 --port line"); /* beyond its addresses */
    assert_null(strstr(run->err, "if it is"));
}

TEST(an_answer_after_the_time_out_is_none_and_the_time_out_is_kept)
{
    far_answers("01 03 02 02 EF F8 A8");
    far_end.delay_us = 301000;
    const tool_run_t *const run = tool_run(&far_end.tool, "request 1 3 0x0101 --timeout 300 --port line");
    assert_int_equal(run->status, 1);
    assert_int_equal(far_end.writes, 1);
    far_answers("");
    (void)tool_run(&far_end.tool, "request 1 3 0x0101 --port line");
    assert_in_range(far_end.now_us, 1074000, 1085000); /* 66 ms of listening, 8.3 of the request, 1 s */
}

TEST(the_user_can_end_it)
{
    far_end.tool.ctrl_c_us = 200000;
    far_run(1, "sent ", "fathom: ended before the response came\n", "1 3 0x0101");
    assert_in_range(far_end.now_us, 200000, 210000);
}

/* It waits for a silence for 10 s and twice the time-out. */
TEST(a_line_that_is_never_silent_is_given_up)
{
    far_end.babbles = true;
    far_run(1, "", "the line was not silent; nothing was sent\n", "1 3 0x0101");
    assert_int_equal(far_end.writes, 0);
    assert_in_range(far_end.now_us, 12000000, 12200000);
}

/* The RS232 variant sends every 100 ms until it is asked. */
TEST(an_a16_that_sends_by_itself_is_asked_between_its_frames)
{
    bench.line.full_duplex = true;
    bench_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO});
    const tool_run_t *const run = tool_run(&bench.tool, "request 1 3 0x0101 --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(run->out, "0x0101    unsigned  1234 "));
}

/* ---- echo ---- */

TEST(behind_an_adapter_that_echoes_the_answer_is_the_second)
{
    far_answers("01 03 02 02 EF F8 A8");
    far_end.echoes = true;
    far_run(0, "received  01 03 02 02 EF F8 A8\n0x0101 ", "", "1 3 0x0101");
    far_answers("01 06 02 00 00 05 48 71");
    far_end.echoes = true;
    far_run(0, "received  01 06 02 00 00 05 48 71\n", "", "1 6 0x0200 5 --yes");
    far_answers("01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63");
    far_end.echoes = true;
    far_run(0, "received  01 2B 0E 01 01 00", "", "1 0x2b 0e 01 00 --yes");
}

TEST(an_echo_alone_is_no_answer)
{
    static const char *const lines[] = {"1 3 0x0101", "1 6 0x0200 5 --yes", "1 16 0x0205 1 --yes",
                                        "1 8 00 00 12 34 --yes", "1 6 0x0200 5 --yes --echo on"};
    for (size_t i = 0; i != sizeof lines / sizeof lines[0]; i++) {
        far_answers("");
        far_end.echoes = true;
        far_run(1, "heard ", "only the tool's own request came back", lines[i]);
    }
}

/* Whenever it comes: only what acknowledges 5 and 6, and perhaps another function, equals its request. */
TEST(a_copy_of_what_is_acknowledged_otherwise_is_an_echo)
{
    far_answers("01 03 01 01 00 01 D4 36");
    far_run(1, "heard ", "only the tool's own request came back", "1 3 0x0101");
    far_answers("01 10 02 05 00 01 02 00 01 44 05");
    far_run(1, "heard ", "only the tool's own request came back", "1 16 0x0205 1 --yes");
    /* this one has the shape of a response, of three bytes */
    far_answers("01 03 03 01 00 01 D5 8E");
    far_run(1, "heard ", "only the tool's own request came back", "1 3 0x0301");
}

/* A copy is an acknowledgement or an echo. 8 characters leave in 8.3 ms; an adapter holds their echo back for up to
 * 60 ms; an acknowledgement comes 3.5 + 8 characters, 12.0 ms, after that at the earliest. */
TEST(one_copy_of_a_write_is_judged_by_its_time)
{
    static const struct {
        uint32_t delay_us;
        const char *options;
        int status;
        const char *out;
        const char *err;
    } rows[] = {
        {1000, "", 1, "heard ", "only the tool's own request came back"},
        {5000, "", 0, "heard ", "unit 1 has acknowledged, unless the adapter returns what it sends"},
        {40000, "", 0, "\"status\":\"answered_or_echo\"", "has acknowledged, unless"},
        {60000, "", 0, "received  01 06 02 00 00 05 48 71\n", ""},
        {5000, "--echo off", 0, "received  01 06 02 00 00 05 48 71\n", ""},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        char line[80];
        far_answers("01 06 02 00 00 05 48 71");
        far_end.delay_us = rows[i].delay_us;
        (void)snprintf(line, sizeof line, "1 6 0x0200 5 --yes %s%s", rows[i].options,
                       rows[i].out[0] == '"' ? " --format json" : "");
        far_run(rows[i].status, rows[i].out, rows[i].err, line);
    }
}

/* ---- nothing is kept ---- */

TEST(a_request_keeps_nothing_of_the_one_before)
{
    far_answers("01 03 02 02 EF F8 A8");
    far_end.echoes = true;
    far_run(0, "received ", "", "1 3 0x0101");
    far_answers("");
    far_run(1, "sent      01 03 01 01 00 01 D4 36\n", "nothing was heard at all", "1 3 0x0101");
}
