/* SPDX-License-Identifier: MIT */
/* Every command of the tool in one process: what it prints, what it does to the device, and that nothing of it is left
 * for the next one. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

EACH_BEGINS(bench_begin())

static const suite_t suite = {.set_up = begins};

static const fathom_sim_a16_config_t any_a16;
static const fathom_sim_hps167s_config_t any_hps167s;

/* Runs a command that writes nothing. It prints these texts, with | between them, in this order, and ends after some
 * milliseconds. */
static void prints(const char *line, uint32_t least_ms, uint32_t most_ms, const char *texts)
{
    char copy[200];
    const tool_run_t *const run = tool_run(&bench.tool, "%s --port line", line);
    const char *at = run->out;
    (void)snprintf(copy, sizeof copy, "%s", texts);
    for (const char *text = strtok(copy, "|"); text != NULL; text = strtok(NULL, "|")) {
        at = strstr(at, text);
        if (run->status != 0 || at == NULL)
            fail_msg("%s: '%s' is not in\n%s%s", line, text, run->out, run->err);
        at++;
    }
    assert_in_range(run->took_us, least_ms * 1000, most_ms * 1000);
    assert_int_equal(bench.a16.device.counters.writes, 0);
    assert_int_equal(bench.a05.device.counters.writes, 0);
    assert_int_equal(bench.hps167s.device.counters.writes, 0);
    if (bench.line.full_duplex) assert_int_equal(bench.a16.device.counters.requests, 0);
    bench_begin();
}

TEST(each_command_prints_what_the_sensors_report_and_writes_nothing)
{
    bench.line.full_duplex = true;
    bench_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO}); /* a frame each 100 ms */
    prints("read a16 --count 20 --format csv", 1900, 2100, ",1234,1234\n|,1234,1234\n|,1234,1234\n");
    bench_a05((fathom_sim_a05_config_t){.address = 9});
    bench.scene = (fathom_sim_fixed_t){{1000, 2000, 3000, FATHOM_SIM_NO_TARGET}};
    prints("read a05:9:modbus --count 1 --format csv", 0, 1000,
           ",1000,1000\n|,2000,2000\n|,3000,3000\n|no_target");
    bench_hps167s(any_hps167s);
    prints("read hps167s --count 2 --format json", 0, 1000,
           "\"utc\":\"2025-11-24T16:00:0|\"distance_mm\":1234|\n{|\"distance_mm\":1234");
    bench_a16(any_a16);
    prints("info a16", 0, 5000, "\naddress                    1\n|\nswitch-threshold           1000 mm\n");
    bench_a05((fathom_sim_a05_config_t){.address = 9});
    prints("info a05:9", 0, 5000, "\naddress                    9\n");
    bench_hps167s((fathom_sim_hps167s_config_t){.no_termination = true});
    /* 77 degrees Fahrenheit are (77 - 32) * 5 / 9 = 25.0 Celsius */
    prints("info hps167s", 0, 5000, "\ntemperature                25.0|\ntermination                off\n");
    bench_a16((fathom_sim_a16_config_t){.address = 2});
    bench_a05((fathom_sim_a05_config_t){.address = 3});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 32});
    /* 8 s of listening, 32 addresses at 150 ms and at 100 ms, and a second for each sensor at most */
    prints("scan", 13000, 22000, "a16      address 2  |a05      address 3  |hps167s  address 32 ");
    bench_hps167s(any_hps167s);
    prints("watch hps167s --duration 3", 3000, 3000,
           " 0.0 s  |\n     1.0 s  hps167s:1 1.234 m |\n     2.0 s  hps167s:1 1.234 m ");
}

TEST(a_line_without_a_sensor_is_no_response_within_the_time_out)
{
    const tool_run_t *const run =
        tool_run(&bench.tool, "read a16:1:modbus --timeout 400 --count 1 --port line");
    assert_int_equal(run->status, 1);
    assert_string_equal(run->out, "");
    assert_non_null(strstr(run->err, "no byte was received"));
    /* the time-out, and the request of 8 characters of 10 bits at 9600: 8.3 ms */
    assert_in_range(run->took_us, 400000, 450000);
}

TEST(decode_needs_no_line)
{
    /* the example of A16 6(2)1 */
    const tool_run_t *const run = tool_run(&bench.tool, "decode 01 03 01 00 00 01 85 F6");
    assert_int_equal(run->status, 0);
    assert_int_equal(run->took_us, 0);
    assert_non_null(strstr(run->out, "01 03 01 00 00 01 85 F6"));
}

TEST(set_moves_an_a16_to_another_address_where_it_is_read_then)
{
    bench_a16(any_a16);
    ASSERT_RUN(0, "set a16 address 200 --port line");
    assert_int_equal(bench.a16.device.address, 200);
    assert_int_equal(bench.a16.device.counters.writes, 1);
    ASSERT_RUN(1, "get a16 address --port line");
    assert_non_null(strstr(tool_run(&bench.tool, "get a16:200 address --port line")->out, "200\n"));
}

TEST(set_and_reset_change_what_they_name)
{
    bench_a05((fathom_sim_a05_config_t){0});
    ASSERT_RUN(0, "set a05 address 2 --port line");
    assert_int_equal(bench.a05.device.address, 2);
    ASSERT_RUN(0, "read a05:2:modbus --count 1 --port line");
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    assert_true(bench.hps167s.termination);
    ASSERT_RUN(0, "set hps167s:7 termination off --port line");
    assert_false(bench.hps167s.termination);
    ASSERT_RUN(0, "reset hps167s:7 --yes-restore-factory-settings --port line");
    assert_int_equal(bench.hps167s.device.address, 1);
    assert_true(bench.hps167s.termination);
}

static bool is_deaf; /* the host, once it has sent what resets a device */

static int write_and_be_deaf(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    if (bytes[3] == 0x09 || bytes[3] == 0x15) is_deaf = true; /* HPS-167S #6, #13 */
    return uart.write(ctx, bytes, length);
}

static int read_unless_deaf(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    const int n = uart.read(ctx, bytes, capacity, rx);
    return is_deaf && n > 0 ? 0 : n;
}

static const char *reset_unheard(const char *option)
{
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    is_deaf = false;
    bench.tool.uart.write = write_and_be_deaf;
    bench.tool.uart.read = read_unless_deaf;
    const tool_run_t *const run = tool_run(&bench.tool, "reset hps167s:7 %s --port line", option);
    assert_int_equal(run->status, 1);
    return run->err;
}

TEST(a_reset_that_is_not_acknowledged_says_what_is_not_known)
{
    assert_string_equal(
        reset_unheard("--yes-load-factory-sensor-settings"),
        "fathom: hps167s:7: the reset was sent, and no acknowledgement was received. The sensor "
        "may have its factory settings or not; they cannot be read back\n");
    assert_non_null(strstr(reset_unheard("--yes-restore-factory-settings"),
                           "It is at address 1, 19200 8E1, or still at address 7, 19200 8E1"));
}

/* An A16 at address 1 never measures 1 mm: 0x0100 with its address is that of a soil probe.
 * The datasheets print no meaning of 0 and of what is beyond the range; FFFD and FFFE are those of sister models. */
TEST(scan_calls_nothing_a_distance_that_is_none)
{
    const struct {
        int32_t value;
        const char *text;
    } rows[] = {{2, "  2 mm, probably an A16 "},
                {16350, "  16350 mm, an A16 "},
                {0, "  unknown (value 0), probably an A16 "},
                {16351, "  unknown (value 16351), probably an A16 "},
                {0xFFFD, "  no_target (value 65533), an A16 "},
                {0xFFFE, "  no_target (value 65534), an A16 "},
                {0xFFFF, "  unknown (value 65535), probably an A16 "}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        bench_begin();
        bench_a16(any_a16);
        bench.scene.value[0] = rows[i].value;
        assert_non_null(
            strstr(tool_run(&bench.tool, "scan --address 1 --baud 9600 --port line")->out, rows[i].text));
    }
}

TEST(the_user_can_end_a_command)
{
    bench_hps167s(any_hps167s);
    bench.tool.ctrl_c_us = 5000000;
    const tool_run_t *const run = tool_run(&bench.tool, "read hps167s --interval 1000 --stats --port line");
    assert_int_equal(run->status, 0);
    assert_in_range(run->took_us, 5000000, 5100000);
    assert_non_null(strstr(run->err, "attempts 5, failed 0"));
}

/* ---- one after the other ---- */

enum { COPY = 2048 };

static void copy_of(char to[COPY], const tool_run_t *run)
{
    assert_in_range(snprintf(to, COPY, "%d\n%s%s", run->status, run->out, run->err), 1, COPY - 1);
}

/* Wherever the command line was left by the one before: wrong words, help, a sensor that was not there. */
TEST(a_command_keeps_nothing_of_the_one_before)
{
    static const char *const befores[] = {"read",
                                          "read --help",
                                          "read a16 --bogus --port line",
                                          "read a16 hps167s:9 --parity",
                                          "read a16 a05:7:dyp --timeout 50 --count 9 --stats --port line",
                                          "get a05 --format json --port line address",
                                          "info hps167s:3 --address 3",
                                          "set a16 -- --port line",
                                          "save a16:7 --port line",
                                          "restore a05 --port line --file nowhere --as-new",
                                          "scan --port line --address 9 --listen 1 --format json",
                                          "watch a05:2:modbus --timeout 10 --duration 1 --port line",
                                          "--version",
                                          "bogus"};
    static const char command[] = "read hps167s --count 3 --timeout 300 --format csv --stats --port line";
    char alone[COPY];
    char after[COPY];
    for (size_t i = 0; i != sizeof befores / sizeof befores[0]; i++) {
        bench_begin();
        bench_hps167s(any_hps167s);
        copy_of(alone, tool_run(&bench.tool, command));
        assert_non_null(strstr(alone, "attempts 3, failed 0, readings 3\n"));
        (void)tool_run(&bench.tool, "%s", befores[i]);
        bench_begin();
        bench_hps167s(any_hps167s);
        copy_of(after, tool_run(&bench.tool, command));
        assert_string_equal(alone, after);
    }
}

/* Makers and users report 200 to 8000 mm, byte 01 with a resistor of 47k, and a high pulse without one. */
TEST(models_are_json_with_line_trigger_and_command)
{
    static const char module[] = "\"has_temperature\":false,\"is_certain\":true,\"aliases\":\"K02, "
                                 "AJ-SR04M-T-X\",\"maker\":\"\",\"note\":";
    static const char *const rows[][2] = {
        {"\"auto\",\"min_mm\":200,\"max_mm\":8000,\"line\":\"9600 8N1\",\"trigger\":null,",
         "\"R19 = 120k\",\"next\":\"fathom read aj-sr04m --port /dev/ttyUSB0\"}\n"},
        {"\"controlled\",\"min_mm\":200,\"max_mm\":8000,\"line\":\"9600 8N1\",\"trigger\":\"byte\","
         "\"trigger_byte\":1,",
         "\"R19 = 47k\",\"next\":\"fathom read aj-sr04m::controlled --port "
         "/dev/ttyUSB0\"}\n"},
        {"\"pwm\",\"min_mm\":200,\"max_mm\":8000,\"line\":null,\"trigger\":\"high_pulse\",",
         "\"R19 open, or 300k\",\"next\":\"fathom read aj-sr04m:pwm@gpiochip0,trigger=17,echo=27\"}\n"},
    };
    char expected[2000] = "";
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        (void)snprintf(expected + strlen(expected), sizeof expected - strlen(expected),
                       "{\"model\":\"aj-sr04m\",\"mode\":%s%s%s", rows[i][0], module, rows[i][1]);
    const tool_run_t *const run = tool_run(&bench.tool, "models k02 --format json");
    assert_int_equal(run->status, 0);
    assert_string_equal(run->out, expected);
}

TEST(models_say_which_have_a_temperature)
{
    assert_non_null(
        strstr(tool_run(&bench.tool, "models a02yy4w")->out, "  temperature: read with --temperature\n"));
    assert_null(strstr(tool_run(&bench.tool, "models a17ny4w")->out, "temperature"));
    assert_non_null(
        strstr(tool_run(&bench.tool, "models sen0591 --format json")->out, "\"has_temperature\":true,"));
}
