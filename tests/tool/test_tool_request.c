/* SPDX-License-Identifier: MIT */
/* fathom request: what leaves, and that nothing dangerous leaves unasked. The CRCs are those of the datasheets, or computed
 * bit by bit from the polynomial 0xA001. */
#include "request_far_end.h"
#include "tool_bench.h"

#include <string.h>

static int set_up(void **state)
{
    bench_begin();
    far_answers("");
    return 0;
}

static const suite_t suite = {.set_up = set_up};

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
                                  "        a16      0x0101 real-time-distance 1234 mm\n");
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
        run->out,
        "{\"address\":1,\"function\":3,\"status\":\"answered\",\"sent\":\"01 03 01 01 00 01 D4 36\","
        "\"received\":\"01 03 02 04 D2 3A D9\",\"registers\":[{\"register\":\"0x0101\","
        "\"unsigned\":1234,\"signed\":1234,\"hex\":\"04D2\",\"ascii\":null}],\"meanings\":"
        "[{\"model\":\"a16\",\"source\":\"A16 6(3)\",\"what\":\"0x0101 real-time-distance\","
        "\"fields\":{\"real_time_distance_mm\":1234},\"notes\":{}}]}\n");
}

TEST(a_write_sets_the_register)
{
    bench_a16((fathom_sim_a16_config_t){.address = 1});
    const tool_run_t *run = tool_run(&bench.tool, "request 1 6 0x0200 5 --yes --echo off --port line");
    assert_int_equal(run->status, 0);
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
    const tool_run_t *const run =
        tool_run(&bench.tool, "request 1 16 0x0020 0 180 --sensor hps167s --yes --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(run->out, "sent      01 10 00 20 00 02 04 00 00 00 B4 F1 C0\n"
                                     "received  01 10 00 20 00 02 40 02\n"));
    assert_non_null(strstr(run->err, "#15 reconnect time: reconnect-time 180 ms\n"));
    assert_int_equal(bench.hps167s.reconnect_ms, 180);
}

TEST(all_units_obey_a_broadcast_and_none_is_waited_for)
{
    bench_a16((fathom_sim_a16_config_t){.address = 9});
    const tool_run_t *const run =
        tool_run(&bench.tool, "request 0 6 0x0205 1 --yes --timeout 9000 --port line");
    assert_int_equal(run->status, 0);
    assert_string_equal(run->out, "sent      00 06 02 05 00 01 58 62\n");
    assert_non_null(strstr(run->err, "sent to all units. None of them responds"));
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
        {"1 5 00 00 ff 00", "function 5 (0x05) is in none of the datasheets; its effect is unknown"},
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
        far_run(2, "", "Nothing was sent yet. To confirm that, add --yes.", rows[i].line);
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
        far_run(1, "", "no byte was received", lines[i]);
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
        far_run(1, "", "no response from unit 1 at ", rows[i].line);
        far_expect_sent(rows[i].bytes);
    }
}

TEST(wrong_usage_is_told_and_nothing_leaves)
{
    static const struct {
        const char *line;
        const char *says;
    } rows[] = {
        {"", "the unit is missing."},
        {"1", "the function is missing."},
        {"256 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not '256'"},
        {"-1 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not '-1'"},
        {"a16 3 1", "UNIT is from 0 to 255, in decimal or as 0x in hex, not 'a16'"},
        {"1 0 1", "FUNCTION is from 1 to 127"},
        {"1 0x80 1", "FUNCTION is from 1 to 127"},
        {"1 read 1", "FUNCTION is from 1 to 127"},
        {"1 3", "the register is missing"},
        {"1 3 65536", "REGISTER is from 0 to 65535"},
        {"1 3 0x", "REGISTER is from 0 to 65535"},
        {"1 3 0x-5", "REGISTER is from 0 to 65535"},
        {"1 3 +5", "REGISTER is from 0 to 65535"},
        {"1 3 99999999999999999999", "REGISTER is from 0 to 65535"},
        {"1 6 1 -0x5 --yes", "VALUE is from -32768 to 65535"},
        {"1 3 0x01G1", "REGISTER is from 0 to 65535"},
        {"1 3 0x0101 0", "COUNT is from 1 to 125"},
        {"1 3 0x0101 126", "COUNT is from 1 to 125"},
        {"1 3 0xFFFF 2", "2 registers from 0xFFFF on go beyond 0xFFFF"},
        {"1 3 1 1 1", "a read has a register and a count; '1' is too much"},
        {"1 6 1 --yes", "function 6 writes one value, not 0. Function 16 writes several."},
        {"1 6 1 2 3 --yes", "function 6 writes one value, not 2. Function 16 writes several."},
        {"1 6 1 65536 --yes", "VALUE is from -32768 to 65535"},
        {"1 6 1 -32769 --yes", "VALUE is from -32768 to 65535, in decimal or as 0x in hex, not '-32769'"},
        {"1 16 1 --yes", "function 16 writes 1 to 123 values, not 0"},
        {"1 16 0xFFFF 1 2 --yes", "2 registers from 0xFFFF on go beyond 0xFFFF"},
        {"1 43 0e 100 --yes", "function 43 takes bytes in hex, such as 0e, not '100'"},
        {"1 43 xy --yes", "function 43 takes bytes in hex, such as 0e, not 'xy'"},
        {"1 3 1 --sensor a17", "unknown sensor 'a17'. It is one of a16, a05, hps167s."},
        {"1 3 1 --baud 1200", "--baud is '1200'. It takes 9600,"},
        {"1 3 1 --parity mark", "--parity is 'mark'. It takes none, even or odd."},
        {"1 3 1 --stop-bits 3", "--stop-bits is '3'. It takes a whole number from 1 to 2"},
        {"1 3 1 --echo yes", "--echo is 'yes'. It takes auto, off or on."},
        {"1 3 1 --timeout 0", "--timeout is '0'. It takes a whole number from 1 to 600000 ms."},
        {"1 3 1 --format csv", "--format is 'csv'. It takes text or json."},
        {"1 3 1 --retries 2", "unknown option '--retries'."},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) far_run(2, "", rows[i].says, rows[i].line);
    assert_int_equal(far_end.sent_length, 0);
    const tool_run_t *const run = tool_run(&far_end.tool, "request 1 3 1");
    assert_int_equal(run->status, 2);
    assert_non_null(strstr(run->err, "--port is missing"));
}
