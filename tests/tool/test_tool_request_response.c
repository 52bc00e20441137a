/* SPDX-License-Identifier: MIT */
/* fathom request: what it says of what comes back. The CRCs are those of the datasheets, or computed bit by bit from the
 * polynomial 0xA001. */
#include "request_far_end.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

static int set_up(void **state)
{
    bench_begin();
    far_answers("");
    return 0;
}

static const suite_t suite = {.set_up = set_up};

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
         "unit 1 refused: exception 02 (illegal data address): the sensor has no such register\n"},
        {"1 3 0x0101 --sensor hps167s", "01 83 02 C0 F1", 1, "",
         "the sensor has no such register; HPS table 39: illegal start address or register address\n"},
        {"1 3 0x0101 --sensor a16", "01 83 02 C0 F1", 1, "", "the datasheet of a16 has no exceptions\n"},
        {"1 6 0x0200 5 --yes", "01 86 04 43 A3", 1, "", "exception 04 (server device failure): "},
        {"1 0x2b 0e 01 00 --yes", "01 AB 01 9E F0", 1, "", "exception 01 (illegal function): "},
        {"1 3 0x0101 --format json", "01 83 02 C0 F1", 1,
         "\"status\":\"exception\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"received\":\"01 83 02 C0 F1\","
         "\"exception\":{\"code\":2,\"name\":\"illegal data address\"}",
         ""},
        /* damaged: a bit of the CRC, of the value; half a frame, which leaves open what is the rest */
        {"1 3 0x0101", "01 03 02 02 EF F8 A9", 1, "heard     01 03 02 02 EF F8 A9\n",
         "damaged response from unit 1 at "},
        {"1 3 0x0101", "01 03 02 12 EF F8 A8", 1, "heard     01 03 02 12 EF F8 A8\n",
         "damaged response from unit 1 at "},
        {"1 3 0x0101 --format json", "01 03 02 02 EF F8 A9", 1,
         "\"status\":\"damaged\",\"sent\":\"01 03 01 01 00 01 D4 36\",\"heard\":\"01 03 02 02 EF F8 A9\"",
         ""},
        {"1 3 0x0101", "01 03 02 02", 1, "heard     01 03 02 02\n", "damaged response from unit 1 at "},
        {"1 0x2b 0e 01 00 --yes", "01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64", 1,
         "heard     01 2B 0E 01 01 00 00 01 00 03 41 42 43 2D 64\n", "damaged response from unit 1 at "},
        /* another unit, another function, another count, another register */
        {"1 3 0x0101", "02 03 02 02 EF BC A8", 1, "heard     02 03 02 02 EF BC A8\n",
         "but address 2 responds. Try UNIT 2"},
        {"1 3 0x0101", "01 04 02 02 EF F9 DC", 1, "heard     01 04 02 02 EF F9 DC\n",
         "the response does not fit the request"},
        {"1 3 0x0101 2", "01 03 02 02 EF F8 A8", 1, "", "the response does not fit the request"},
        /* a write of one register that is not ours: the acknowledgement equals the request of another master */
        {"1 6 0x0200 5 --yes", "01 06 02 05 00 01 59 B3", 1, "",
         "another master asked this unit at the same time"},
        {"1 5 00 00 ff 00 --yes", "01 05 00 01 FF 00 DD FA", 1, "", "the response does not fit the request"},
        /* no frame, and nothing */
        {"1 3 0x0101", "55 FE 80", 1, "heard     55 FE 80\n", "bytes were received, but no Modbus frame. "},
        {"1 3 0x0101", "", 1, "sent      01 03 01 01 00 01 D4 36\n",
         "no byte was received. Check the power, whether A and B (or RX and TX) are swapped, UNIT, and "
         "--baud"},
        {"1 3 0x0101 --format json", "", 1, "\"status\":\"no_response\"", ""},
        /* noise before it, and more behind it */
        {"1 3 0x0101", "55 FE 80 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "3 bytes arrived in addition to the response.\n"},
        {"1 3 0x0101", "01 03 02 02 EF F8 A8 01 03 02 02 EF F8 A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "7 bytes arrived in addition to the response: two units may have this address.\n"},
        {"1 3 0x0101", "01 03 02 02 EF F8 A8 02 03 02 02 EF BC A8", 0, "received  01 03 02 02 EF F8 A8\n",
         "7 bytes arrived in addition to the response: another unit responded also.\n"},
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
    assert_non_null(strstr(run->out, "a05      0x0200 address 5\n"));
    assert_null(strstr(run->out, "a16"));
    run = tool_run(&far_end.tool, "request 1 6 0x0200 5 --sensor a05 --port line");
    assert_non_null(strstr(run->err, "if it is a05: set 0x0200"));
    assert_null(strstr(run->err, "if it is a16"));
    run = tool_run(&far_end.tool, "request 255 6 0x0200 5 --port line");
    assert_non_null(strstr(run->err, "if it is a16: set 0x0200"));
    run = tool_run(&far_end.tool, "request 32 6 0x0016 5 --port line");
    assert_non_null(strstr(run->err, "if it is hps167s: #14 filter sensitivity: filter-sensitivity 5\n"));
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
    far_run(1, "sent ", "fathom: the command ended before the response arrived\n", "1 3 0x0101");
    assert_in_range(far_end.now_us, 200000, 210000);
}

/* line.h, rule of the busy line: 66 ms of listening, 1 s of waiting for a silence, 8.3 ms of the request, 1 s. */
TEST(a_read_leaves_after_1_s_on_a_line_that_is_never_silent)
{
    far_end.babbles = true;
    far_run(1, "sent ",
            "fathom: cannot send a request to unit 1 at line (9600 8N1): the line was never silent, ",
            "1 3 0x0101");
    assert_int_equal(far_end.writes, 1);
    assert_in_range(far_end.now_us, 2074000, 2180000);
}

TEST(a_write_does_not_leave_on_a_line_that_is_never_silent)
{
    far_end.babbles = true;
    far_run(1, "", "fathom: cannot send a request to unit 1 at line (9600 8N1): the line was never silent, ",
            "--yes 1 6 0x0200 2");
    assert_int_equal(far_end.writes, 0);
    assert_in_range(far_end.now_us, 1066000, 1180000);
}

/* A read of 0x0009 resets an HPS-167S. */
TEST(a_read_that_resets_does_not_leave_on_a_line_that_is_never_silent)
{
    far_end.babbles = true;
    far_run(1, "", "the line was never silent, ", "--yes 1 3 0x0009");
    assert_int_equal(far_end.writes, 0);
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
        far_run(1, "heard ", "only the tool's own request was received", lines[i]);
    }
}

/* Whenever it comes: only what acknowledges 5 and 6, and perhaps another function, equals its request. */
TEST(a_copy_of_what_is_acknowledged_otherwise_is_an_echo)
{
    far_answers("01 03 01 01 00 01 D4 36");
    far_run(1, "heard ", "only the tool's own request was received", "1 3 0x0101");
    far_answers("01 10 02 05 00 01 02 00 01 44 05");
    far_run(1, "heard ", "only the tool's own request was received", "1 16 0x0205 1 --yes");
    /* this one has the shape of a response, of three bytes */
    far_answers("01 03 03 01 00 01 D5 8E");
    far_run(1, "heard ", "only the tool's own request was received", "1 3 0x0301");
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
        {1000, "", 1, "heard ", "only the tool's own request was received"},
        {5000, "", 0, "heard ", "unit 1 acknowledged the request, unless the adapter returned it"},
        {40000, "", 0, "\"status\":\"answered_or_echo\"", "acknowledged the request, unless"},
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
    far_run(1, "sent      01 03 01 01 00 01 D4 36\n", "no byte was received", "1 3 0x0101");
}
