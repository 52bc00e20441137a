/* SPDX-License-Identifier: MIT */
/* fathom request: what leaves, that nothing dangerous leaves unasked, and what it prints of what comes back. The CRCs are
 * those of the datasheets, or computed bit by bit from the polynomial 0xA001. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

/* ---- a far end that says what the test says ---- */

/* 9600 8N1: a character of 10 bits takes 1041.7 us. */
enum { CHARACTER_US = 1042, MOST = 256 };

static struct {
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
} far;

static uint32_t far_now(void *ctx) { return far.now_us; }

static void come(uint8_t byte, uint32_t at_us)
{
    far.at_us[far.count] = at_us;
    far.coming[far.count++] = byte;
}

static int far_write(void *ctx, const uint8_t *bytes, size_t length)
{
    memcpy(far.sent + far.sent_length, bytes, length);
    far.sent_length += length;
    far.writes++;
    for (uint32_t i = 0; i != length && far.echoes; i++) come(bytes[i], far.now_us + (i + 1) * CHARACTER_US);
    far.leaves_us = far.now_us + (uint32_t)length * CHARACTER_US;
    for (uint32_t i = 0; i != far.length; i++)
        come(far.answer[i], far.leaves_us + far.delay_us + (i + 1) * CHARACTER_US);
    return (int)length;
}

static int far_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    size_t n = 0;
    if (far.babbles && far.now_us / 2000 != far.babbled) {
        far.babbled = far.now_us / 2000;
        bytes[n++] = 0x55;
    }
    for (; n != capacity && far.taken != far.count && far.at_us[far.taken] <= far.now_us; n++)
        bytes[n] = far.coming[far.taken++];
    return (int)n;
}

static bool far_sent(void *ctx) { return far.now_us >= far.leaves_us; }

static int far_set_line(void *ctx, const fathom_line_settings_t *settings) { return 1; }

static void far_idle(void *ctx, uint32_t max_us)
{
    const uint32_t most_us = far.babbles ? 2000 : 10000;
    uint32_t by_us = max_us < most_us ? max_us : most_us;
    if (far.taken != far.count && far.at_us[far.taken] - far.now_us < by_us)
        by_us = far.at_us[far.taken] - far.now_us;
    far.now_us += by_us != 0 ? by_us : 1;
}

/* Bytes in hex, up to the end of the line. */
static size_t bytes_of(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned byte;
    for (; sscanf(text, "%2x", &byte) == 1; text += text[2] == ' ' ? 3 : 2) bytes[count++] = (uint8_t)byte;
    return count;
}

/* From now on it answers with these bytes in hex, 20 ms after the request. */
static void far_answers(const char *answer)
{
    memset(&far, 0, sizeof far);
    far.delay_us = 20000;
    far.length = bytes_of(answer, far.answer);
    far.tool = (tool_line_t){
        .uart = {.read = far_read, .write = far_write, .sent = far_sent, .set_line = far_set_line},
        .clock = {far_now, NULL},
        .idle = far_idle};
}

/* fathom request LINE: it ends so, and says this on stdout and this on stderr. One request has left at most, and what it
 * says of it is true. */
static void far_run(int status, const char *out, const char *err, const char *line)
{
    const tool_run_t *const run = tool_run(&far.tool, "request %s --port line", line);
    const char *const printed = strstr(run->out, "sent      ");
    uint8_t sent[MOST];
    if (run->status != status || strstr(run->out, out) == NULL || strstr(run->err, err) == NULL)
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
    assert_in_range(far.writes, 0, 1);
    if (printed == NULL) return;
    assert_int_equal(bytes_of(printed + 10, sent), far.sent_length);
    assert_memory_equal(sent, far.sent, far.sent_length);
}

typedef struct {
    const char *line;
    const char *answer;
    int status;
    const char *out;
    const char *err;
} transaction_t;

static void transact(const transaction_t *rows, size_t count, bool echoes, uint32_t delay_us)
{
    for (size_t i = 0; i != count; i++) {
        far_answers(rows[i].answer);
        far.echoes = echoes;
        far.delay_us = delay_us;
        far_run(rows[i].status, rows[i].out, rows[i].err, rows[i].line);
        assert_int_equal(far.writes, rows[i].status == 2 ? 0 : 1);
    }
}

/* Nothing is kept from one row to the next. */
#define TRANSACTIONS_AT(name, echoes, delay_us, ...)                                                         \
    TEST(name)                                                                                               \
    {                                                                                                        \
        static const transaction_t rows[] = {__VA_ARGS__};                                                   \
        transact(rows, sizeof rows / sizeof rows[0], echoes, delay_us);                                      \
    }
#define TRANSACTIONS(name, ...) TRANSACTIONS_AT(name, false, 20000, __VA_ARGS__)

static int set_up(void **state)
{
    bench_begin();
    far_answers("");
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Runs `fathom request` at the simulated sensors. */
static const tool_run_t *request(int status, const char *line)
{
    const tool_run_t *const run = tool_run(&bench.tool, "request %s --port line", line);
    if (run->status != status) fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
    return run;
}

/* ---- simulated sensors ---- */

TEST(a_read_of_an_a16_is_shown_in_all_its_meanings)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *run = request(0, "1 3 0x0101 --sensor a16");
    /* 1234 mm are 0x04D2 */
    assert_string_equal(run->out, "sent      01 03 01 01 00 01 D4 36\n"
                                  "received  01 03 02 04 D2 3A D9\n"
                                  "0x0101    unsigned  1234  signed   1234  hex 04D2\n"
                                  "        a16      0x0101 real-time-distance 1234 mm\n");
    assert_non_null(strstr(run->err, "ends the automatic output of an A16 with RS232"));
    assert_int_equal(bench.a16.device.counters.requests, 1);
    run = request(0, "1 3 0x0101 1 --sensor a16 --format json");
    assert_string_equal(
        run->out,
        "{\"address\":1,\"function\":3,\"status\":\"answered\",\"sent\":\"01 03 01 01 00 01 D4 36\","
        "\"received\":\"01 03 02 04 D2 3A D9\",\"registers\":[{\"register\":\"0x0101\","
        "\"unsigned\":1234,\"signed\":1234,\"hex\":\"04D2\",\"ascii\":null}],\"meanings\":"
        "[{\"model\":\"a16\",\"source\":\"A16 6(3)\",\"what\":\"0x0101 real-time-distance\","
        "\"fields\":{\"real_time_distance_mm\":1234},\"notes\":{}}]}\n");
}

TEST(with_the_sensor_go_its_line_and_what_the_answer_means)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    const tool_run_t *run = request(0, "7 3 8 4 --sensor hps167s");
    assert_int_equal(bench.line.settings.baud, 19200);
    assert_int_equal(bench.line.settings.parity, FATHOM_PARITY_EVEN);
    assert_non_null(strstr(run->out, "hps167s  #5 single measurement\n"));
    assert_non_null(strstr(run->out, "1234 mm\n"));
    assert_null(strstr(run->err, "automatic output")); /* of an HPS-167S there is none that ends */
    (void)request(1, "7 3 8 4 --timeout 300");         /* 9600 8N1 */
    assert_int_equal(bench.line.settings.baud, 9600);
    assert_null(strstr(request(0, "7 3 8 4 --baud 19200 --parity even")->out, "#5"));
}

TEST(a_write_sets_the_register)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *run = request(0, "1 6 0x0200 5 --yes --echo off");
    /* A16 6(4), example 3 */
    assert_string_equal(run->out, "sent      01 06 02 00 00 05 48 71\nreceived  01 06 02 00 00 05 48 71\n");
    assert_non_null(strstr(run->err, "fathom: if it is a16: set 0x0200 address 5\n"));
    assert_int_equal(bench.a16.device.address, 5);
    assert_int_equal(bench.a16.device.counters.writes, 1);
}

TEST(a_write_of_many_is_decoded_and_obeyed)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 1});
    /* #15: 180 ms, ten times 18 */
    const tool_run_t *const run = request(0, "1 16 0x0020 0 180 --sensor hps167s --yes");
    assert_non_null(strstr(run->out, "sent      01 10 00 20 00 02 04 00 00 00 B4 F1 C0\n"
                                     "received  01 10 00 20 00 02 40 02\n"));
    assert_non_null(strstr(run->err, "#15 reconnect time: reconnect-time 180 ms\n"));
    assert_int_equal(bench.hps167s.reconnect_ms, 180);
}

TEST(all_units_obey_a_broadcast_and_none_is_waited_for)
{
    bench_a16((fathom_sim_a16_config_t){.address = 9});
    const tool_run_t *const run = request(0, "0 6 0x0205 1 --yes --timeout 9000");
    assert_string_equal(run->out, "sent      00 06 02 05 00 01 58 62\n");
    assert_non_null(strstr(run->err, "sent to all units. None of them responds"));
    /* 66 ms of listening, 8.3 of the request and 200 of the turnaround */
    assert_in_range(run->took_us, 266000, 300000);
}

TEST(a_read_of_0x0009_resets_an_hps167s_if_that_is_meant)
{
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    const tool_run_t *const run = request(2, "7 3 9 1 --sensor hps167s");
    assert_non_null(strstr(run->err, "a read of 0x0009 resets an HPS-167S"));
    assert_int_equal(bench.hps167s.device.counters.requests, 0);
    (void)request(0, "7 3 9 1 --sensor hps167s --yes");
    assert_int_equal(bench.hps167s.device.address, 1);
}

/* The RS232 variant sends every 100 ms until it is asked. */
TEST(an_a16_that_sends_by_itself_is_asked_between_its_frames)
{
    bench.line.full_duplex = true;
    bench_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO});
    assert_non_null(strstr(request(0, "1 3 0x0101")->out, "0x0101    unsigned  1234 "));
}

/* ---- what leaves, and what does not ---- */

#define ASKS   "Nothing was sent yet. To confirm that, add --yes."
#define RESETS "a read of 0x0009 resets"
TRANSACTIONS(
    without_yes_nothing_dangerous_leaves, {"1 6 0x0200 5", "", 2, "", ASKS},
    {"1 6 0x0200 5", "", 2, "", "the request writes"}, {"1 16 0x0205 1 2", "", 2, "", "the request writes"},
    {"1 5 00 00 ff 00", "", 2, "", "function 5 (0x05) is in none of the datasheets; its effect is unknown"},
    {"1 0x2b 0e 01 00", "", 2, "", "function 43 (0x2B) is in none of the datasheets"},
    {"1 23 00 00 00 01 00 00 00 01 02 00 00", "", 2, "", "function 23 (0x17) is in none"},
    {"1 10 02 05 00 01 02 00 00", "", 2, "", "in hex: 0x10, which is 16"},
    {"1 6 0x0015 0xFF", "", 2, "", "hps167s: resets the device's settings"}, /* HPS-167S #13 */
    {"1 3 0x0009", "", 2, "", RESETS}, {"1 3 8 2", "", 2, "", RESETS}, {"1 3 0 10", "", 2, "", RESETS},
    {"1 4 9 1", "", 2, "", RESETS}, {"1 4 8 4", "", 2, "", RESETS}, {"1 3 8 3", "", 2, "", RESETS},
    {"1 3 3 12", "", 2, "", RESETS}, {"1 3 3 12", "", 2, "", ASKS},
    {"0 3 0x0101", "", 2, "", "unit 0 is all units, or an A16 or A05"},
    {"0 6 0x0200 5", "", 2, "", "unit 0 is all units: all obey"}, {"0 3 0x0101", "", 2, "", ASKS},
    {"255 3 0x0101", "", 2, "", "unit 255: each A16 and A05 obeys"}, {"255 3 0x0101", "", 2, "", ASKS})

/* Those of HPS-167S #5 and #3 go over it, and are none of it. */
#define SILENCE "no byte was received"
TRANSACTIONS(a_read_beside_0x0009_needs_no_yes, {"1 3 0 9", "", 1, "", SILENCE},
             {"1 3 8 4", "", 1, "", SILENCE}, {"1 3 3 11", "", 1, "", SILENCE},
             {"1 3 10 1", "", 1, "", SILENCE}, {"1 3 8 1", "", 1, "", SILENCE},
             {"1 4 0x0101", "", 1, "", SILENCE}, {"1 1 00 09 00 01", "", 1, "", SILENCE},
             {"1 2 00 09 00 01", "", 1, "", SILENCE})

#define NONE "no response from unit 1 at "
TRANSACTIONS(numbers_are_decimal_or_hex_and_bytes_are_hex,
             {"1 3 257", "", 1, "sent      01 03 01 01 00 01 D4 36\n", NONE},
             {"0x1 0x03 0x0101 0x2", "", 1, "sent      01 03 01 01 00 02 94 37\n", NONE},
             {"1 4 0x0101", "", 1, "sent      01 04 01 01 00 01 61 F6\n", NONE},
             /* real 200, measured 215 (HPS-167S #12) */
             {"1 06 0x0014 -15 --yes", "", 1, "sent      01 06 00 14 FF F1 49 BA\n", NONE},
             {"1 0x10 0x20 0 180 --yes", "", 1, "sent      01 10 00 20 00 02 04 00 00 00 B4 F1 C0\n", NONE},
             {"1 43 0x0e 1 0 --yes", "", 1, "sent      01 2B 0E 01 00 70 77\n", NONE},
             {"1 1 00 00 00 08", "", 1, "sent      01 01 00 00 00 08 3D CC\n", NONE},
             {"1 3 0x0009 1 --yes", "", 1, "sent      01 03 00 09 00 01 54 08\n", NONE}) /* HPS-167S #6 */

#define UNIT     "UNIT is from 0 to 255, in decimal or as 0x in hex, not "
#define FUNCTION "FUNCTION is from 1 to 127"
#define REGISTER "REGISTER is from 0 to 65535"
#define VALUE    "VALUE is from -32768 to 65535"
REFUSES(wrong_words_are_refused, "request --port line", {"", "the unit is missing."},
        {"1", "the function is missing."}, {"256 3 1", UNIT "'256'"}, {"-1 3 1", UNIT "'-1'"},
        {"a16 3 1", UNIT "'a16'"}, {"1 0 1", FUNCTION}, {"1 0x80 1", FUNCTION}, {"1 read 1", FUNCTION},
        {"1 3", "the register is missing"}, {"1 3 65536", REGISTER}, {"1 3 0x", REGISTER},
        {"1 3 0x-5", REGISTER}, {"1 3 +5", REGISTER}, {"1 3 99999999999999999999", REGISTER},
        {"1 3 0x01G1", REGISTER}, {"1 6 1 -0x5", VALUE}, {"1 6 1 65536", VALUE},
        {"1 6 1 -32769", VALUE ", in decimal or as 0x in hex, not '-32769'"},
        {"1 3 0x0101 0", "COUNT is from 1 to 125"}, {"1 3 0x0101 126", "COUNT is from 1 to 125"},
        {"1 3 0xFFFF 2", "2 registers from 0xFFFF on go beyond 0xFFFF"},
        {"1 16 0xFFFF 1 2", "2 registers from 0xFFFF on go beyond 0xFFFF"},
        {"1 3 1 1 1", "a read has a register and a count; '1' is too much"},
        {"1 6 1", "function 6 writes one value, not 0. Function 16 writes several."},
        {"1 6 1 2 3", "function 6 writes one value, not 2. Function 16 writes several."},
        {"1 16 1", "function 16 writes 1 to 123 values, not 0"},
        {"1 43 0e 100", "function 43 takes bytes in hex, such as 0e, not '100'"},
        {"1 43 xy", "function 43 takes bytes in hex, such as 0e, not 'xy'"})

REFUSES(wrong_options_are_refused, "request 1 3 1", {"", "--port is missing"},
        {"--sensor b17",
         "unknown sensor 'b17'. It is one of a16, a05, hps167s, or a name of 'fathom models'."},
        {"--baud 1200", "--baud is '1200'. It takes 9600,"},
        {"--parity mark", "--parity is 'mark'. It takes none, even or odd."},
        {"--stop-bits 3", "--stop-bits is '3'. It takes a whole number from 1 to 2"},
        {"--echo yes", "--echo is 'yes'. It takes auto, off or on."},
        {"--timeout 0", "--timeout is '0'. It takes a whole number from 1 to 600000 ms."},
        {"--format csv", "--format is 'csv'. It takes text or json."},
        {"--retries 2", "unknown option '--retries'."})

TEST(more_than_a_frame_holds_is_refused)
{
    char line[800] = "1 65";
    for (int i = 0; i != 252; i++) strcat(line, " ff");
    far_run(2, "", "at most 251 bytes behind its function, not 252", line);
    strcpy(line, "1 16 0");
    for (int i = 0; i != 124; i++) strcat(line, " 1");
    far_run(2, "", "writes 1 to 123 values, not 124", line);
}

/* ---- what comes back ---- */

TRANSACTIONS(registers_are_unsigned_signed_hex_and_text,
             /* 0xFA24 is 64036, and 64036 - 65536 = -1500 */
             {"1 3 0x0101 2", "01 03 04 41 42 FA 24 0C A0", 0,
              "0x0101    unsigned 16706  signed  16706  hex 4142  ascii \"AB\"\n"
              "0x0102    unsigned 64036  signed  -1500  hex FA24\n",
              ""},
             {"1 3 0x0101 2", "01 03 04 80 00 7F FF B3 83", 0,
              "unsigned 32768  signed -32768  hex 8000\n0x0102    unsigned 32767  signed  32767  hex 7FFF\n",
              ""},
             /* A05 3(4)1, example 3 */
             {"1 3 0x0107 3", "01 03 06 00 FA 02 93 09 7A 8F 47", 0,
              "sent      01 03 01 07 00 03 B5 F6\n"
              "received  01 03 06 00 FA 02 93 09 7A 8F 47\n"
              "0x0107    unsigned   250  signed    250  hex 00FA\n"
              "0x0108    unsigned   659  signed    659  hex 0293\n"
              "0x0109    unsigned  2426  signed   2426  hex 097A\n",
              ""},
             /* a quote and a backslash */
             {"1 3 0x0101 --format json", "01 03 02 22 5C A0 DD", 0, "\"ascii\":\"\\\"\\\\\"}", ""})

TRANSACTIONS(
    what_comes_back_is_told,
    {"1 4 0x0101", "01 04 02 02 EF F9 DC", 0, "0x0101    unsigned   751  signed    751  hex 02EF\n", ""},
    {"1 1 00 00 00 08", "01 01 01 55 91 B7", 0, "received  01 01 01 55 91 B7\n", ""},
    {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63", 0,
     "received  01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63\n", ""},
    /* addresses with a meaning of their own */
    {"255 3 0x0101 --yes", "05 03 02 02 EF 09 68", 0, "received  05 03 02 02 EF 09 68\n", ""},
    {"0 3 0x0101 --yes", "00 03 02 02 EF C5 68", 0, "received  00 03 02 02 EF C5 68\n", ""},
    {"0 6 0x0205 1 --yes", "00 06 02 05 00 01 58 62", 0, "", "sent to all units"},
    /* noise before it, and more behind it */
    {"1 3 0x0101", "55 FE 80 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
     "3 bytes arrived in addition to the response.\n"},
    {"1 3 0x0101", "01 03 02 02 EF F8 A8 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
     "7 bytes arrived in addition to the response: two units may have this address.\n"},
    {"1 3 0x0101", "01 03 02 02 EF F8 A8 02 03 02 02 EF BC A8", 0, "received  01 03 02 02 EF F8 A8\n",
     "7 bytes arrived in addition to the response: another unit responded also.\n"})

TRANSACTIONS(a_refusal_is_explained,
             {"1 3 0x0101", "01 83 02 C0 F1", 1, "received  01 83 02 C0 F1\n",
              "unit 1 refused: exception 02 (illegal data address): the sensor has no such register\n"},
             {"1 3 0x0101 --sensor hps167s", "01 83 02 C0 F1", 1, "",
              "the sensor has no such register; HPS table 39: illegal start address or register address\n"},
             {"1 3 0x0101 --sensor a16", "01 83 02 C0 F1", 1, "", "the datasheet of a16 has no exceptions\n"},
             {"1 6 0x0200 5 --yes", "01 86 04 43 A3", 1, "", "exception 04 (server device failure): "},
             {"1 0x2b 0e 01 00 --yes", "01 AB 01 9E F0", 1, "", "exception 01 (illegal function): "},
             {"1 3 0x0101 --format json", "01 83 02 C0 F1", 1,
              "\"status\":\"exception\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"received\":\"01 83 02 C0 F1\","
              "\"exception\":{\"code\":2,\"name\":\"illegal data address\"}",
              ""})

#define DAMAGED "damaged response from unit 1 at "
#define UNFIT   "the response does not fit the request"
TRANSACTIONS(
    what_is_no_response_is_told,
    /* damaged: a bit of the CRC, of the value; half a frame, which leaves open what is the rest */
    {"1 3 0x0101", "01 03 02 02 EF F8 A9", 1, "heard     01 03 02 02 EF F8 A9\n", DAMAGED},
    {"1 3 0x0101", "01 03 02 12 EF F8 A8", 1, "heard     01 03 02 12 EF F8 A8\n", DAMAGED},
    {"1 3 0x0101 --format json", "01 03 02 02 EF F8 A9", 1,
     "\"status\":\"damaged\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"heard\":\"01 03 02 02 EF F8 A9\"", ""},
    {"1 3 0x0101", "01 03 02 02", 1, "heard     01 03 02 02\n", DAMAGED},
    {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64", 1,
     "heard     01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64\n", DAMAGED},
    /* another unit, another function, another count, another register */
    {"1 3 0x0101", "02 03 02 02 EF BC A8", 1, "heard     02 03 02 02 EF BC A8\n",
     "but address 2 responds. Try UNIT 2"},
    {"1 3 0x0101", "01 04 02 02 EF F9 DC", 1, "heard     01 04 02 02 EF F9 DC\n", UNFIT},
    {"1 3 0x0101 2", "01 03 02 02 EF F8 A8", 1, "", UNFIT},
    /* a write of one register that is not ours: the acknowledgement equals the request of another master */
    {"1 6 0x0200 5 --yes", "01 06 02 05 00 01 59 B3", 1, "",
     "another master asked this unit at the same time"},
    {"1 5 00 00 ff 00 --yes", "01 05 00 01 FF 00 DD FA", 1, "", UNFIT},
    /* no frame, and nothing */
    {"1 3 0x0101", "55 FE 80", 1, "heard     55 FE 80\n", "bytes were received, but no Modbus frame. "},
    {"1 3 0x0101", "", 1, "sent      01 03 01 01 00 01 D4 36\n",
     "no byte was received. Check the power, whether A and B (or RX and TX) are swapped, UNIT, and --baud"},
    {"1 3 0x0101 --format json", "", 1, "\"status\":\"no_response\"", ""})

TRANSACTIONS_AT(a_response_after_the_time_out_is_none, false, 301000,
                {"1 3 0x0101 --timeout 300", "01 03 02 02 EF F8 A8", 1, "sent ", ""})

TEST(only_the_sensor_that_was_named_and_could_be_there_is_guessed)
{
    static const struct {
        const char *line, *printed, *not_printed;
    } rows[] = {
        {"1 3 0x0200 --sensor a05", "a05      0x0200 address 5\n", "a16"},
        {"1 6 0x0200 5 --sensor a05", "if it is a05: set 0x0200", "if it is a16"},
        {"255 6 0x0200 5", "if it is a16: set 0x0200", "if it is hps167s"},
        {"32 6 0x0016 5", "if it is hps167s: #14 filter sensitivity: filter-sensitivity 5\n", "if it is a16"},
        {"33 6 0x0016 5", "", "if it is"}, /* beyond the addresses of an HPS-167S */
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        far_answers("01 03 02 00 05 78 47");
        const tool_run_t *const run = tool_run(&far.tool, "request %s --port line", rows[i].line);
        if ((strstr(run->out, rows[i].printed) == NULL && strstr(run->err, rows[i].printed) == NULL) ||
            strstr(run->out, rows[i].not_printed) != NULL || strstr(run->err, rows[i].not_printed) != NULL)
            fail_msg("%s:\n%s%s", rows[i].line, run->out, run->err);
    }
}

/* ---- when it ends ---- */

TEST(the_time_out_is_kept_and_the_user_can_end_it)
{
    far_run(1, "sent ", "", "1 3 0x0101");
    assert_in_range(far.now_us, 1074000, 1085000); /* 66 ms of listening, 8.3 of the request, 1 s */
    far_answers("");
    far.tool.ctrl_c_us = 200000;
    far_run(1, "sent ", "fathom: the command ended before the response arrived\n", "1 3 0x0101");
    assert_in_range(far.now_us, 200000, 210000);
}

/* line.h, rule of the busy line: 66 ms of listening, 1 s of waiting for a silence, 8.3 ms of the request, 1 s. A read of
 * 0x0009 resets an HPS-167S. */
TEST(only_a_harmless_read_leaves_on_a_line_that_is_never_silent)
{
    static const struct {
        const char *line;
        unsigned writes;
        uint32_t least_us, most_us;
    } rows[] = {{"1 3 0x0101", 1, 2074000, 2180000},
                {"--yes 1 6 0x0200 2", 0, 1066000, 1180000},
                {"--yes 1 3 0x0009", 0, 1066000, 1180000}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        far_answers("");
        far.babbles = true;
        far_run(1, rows[i].writes != 0 ? "sent " : "",
                "fathom: cannot send a request to unit 1 at line (9600 8N1): the line was never silent, ",
                rows[i].line);
        assert_int_equal(far.writes, rows[i].writes);
        assert_in_range(far.now_us, rows[i].least_us, rows[i].most_us);
    }
}

/* ---- echo ---- */

TRANSACTIONS_AT(behind_an_adapter_that_echoes_the_answer_is_the_second, true, 20000,
                {"1 3 0x0101", "01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n0x0101 ", ""},
                {"1 6 0x0200 5 --yes", "01 06 02 00 00 05 48 71", 0, "received  01 06 02 00 00 05 48 71\n",
                 ""},
                {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 63", 0,
                 "received  01 2B 0E 01 01 00", ""})

#define OWN "only the tool's own request was received"
TRANSACTIONS_AT(an_echo_alone_is_no_answer, true, 20000, {"1 3 0x0101", "", 1, "heard ", OWN},
                {"1 6 0x0200 5 --yes", "", 1, "heard ", OWN}, {"1 16 0x0205 1 --yes", "", 1, "heard ", OWN},
                {"1 8 00 00 12 34 --yes", "", 1, "heard ", OWN},
                {"1 6 0x0200 5 --yes --echo on", "", 1, "heard ", OWN})

/* Whenever it comes: only what acknowledges 5 and 6, and perhaps another function, equals its request. The last one has
 * the shape of a response, of three bytes. */
TRANSACTIONS(a_copy_of_what_is_acknowledged_otherwise_is_an_echo,
             {"1 3 0x0101", "01 03 01 01 00 01 D4 36", 1, "heard ", OWN},
             {"1 16 0x0205 1 --yes", "01 10 02 05 00 01 02 00 01 44 05", 1, "heard ", OWN},
             {"1 3 0x0301", "01 03 03 01 00 01 D5 8E", 1, "heard ", OWN})

/* A copy is an acknowledgement or an echo. 8 characters leave in 8.3 ms; an adapter holds their echo back for up to
 * 60 ms; an acknowledgement comes 3.5 + 8 characters, 12.0 ms, after that at the earliest. */
#define WRITES "1 6 0x0200 5 --yes "
#define COPY   "01 06 02 00 00 05 48 71"
TRANSACTIONS_AT(a_copy_after_1_ms_is_an_echo, false, 1000, {WRITES, COPY, 1, "heard ", OWN})
TRANSACTIONS_AT(a_copy_after_5_ms_may_be_both, false, 5000,
                {WRITES, COPY, 0, "heard ",
                 "unit 1 acknowledged the request, unless the adapter returned it"},
                {WRITES "--echo off", COPY, 0, "received  " COPY "\n", ""})
TRANSACTIONS_AT(a_copy_after_40_ms_may_be_both, false, 40000,
                {WRITES "--format json", COPY, 0, "\"status\":\"answered_or_echo\"",
                 "acknowledged the request, unless"})
TRANSACTIONS_AT(a_copy_after_60_ms_is_an_acknowledgement, false, 60000,
                {WRITES, COPY, 0, "received  " COPY "\n", ""})
