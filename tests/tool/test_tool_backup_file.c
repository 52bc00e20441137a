/* SPDX-License-Identifier: MIT */
/* What fathom restore makes of a file that a person has edited: each mistake is told with its line, and nothing is
 * sent. */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

static int set_up(void **state)
{
    bench_begin();
    desk_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){0});
    bench_a16((fathom_sim_a16_config_t){0});
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = desk_end};

static uint32_t requests(void)
{
    return bench.hps167s.device.counters.requests + bench.a16.device.counters.requests;
}

/* The file is refused with just this line on the standard error, in which %s is its path. */
static void refuses(int status, const char *sensor, const char *words)
{
    char line[512];
    const tool_run_t *const run =
        tool_run(&bench.tool, "restore %s --port line --file %s", sensor, desk_path("unit"));
    (void)snprintf(line, sizeof line, "fathom: %s:%s\n", desk_path("unit"), words);
    assert_string_equal(run->err, line);
    assert_string_equal(run->out, "");
    assert_int_equal(run->status, status);
    assert_int_equal(requests(), 0);
}

TEST(every_mistake_in_a_file_is_told_with_its_line_and_nothing_is_sent)
{
    static const char *const rows[][2] = {
        {"", " the line 'sensor = hps167s' is missing. Is this a file of 'fathom save'?"},
        {"# nothing\n\n", " the line 'sensor = hps167s' is missing. Is this a file of 'fathom save'?"},
        {"warm-up = 5\n", "1: the line 'warm-up' comes before the line 'sensor = hps167s'"},
        {"sensor = a16\n", "1: the file belongs to 'a16', and the sensor is an hps167s"},
        {"sensor = hps167s\nsensor = hps167s\n", "2: sensor occurs twice"},
        {"sensor = hps167s\n\nwarm-up 5\n", "3: 'warm-up 5' does not have the form NAME = VALUE"},
        {"sensor = hps167s\nwarm-up = 256\n", "2: warm-up takes 0 to 255 s, not '256'"},
        {"sensor = hps167s\nwarm-up = 5 s\n", "2: warm-up takes 0 to 255 s, not '5 s'"},
        {"sensor = hps167s\nwarm-up =\n", "2: warm-up takes 0 to 255 s, not ''"},
        {"sensor = hps167s\nwarm-up = = 5\n", "2: warm-up takes 0 to 255 s, not '= 5'"},
        {"sensor = hps167s\ntermination = yes # on\n", "2: termination takes off, on, not 'yes'"},
        {"sensor = hps167s\nreconnect-time = 100\n",
         "2: reconnect-time takes 0 to 2147483646, a multiple of 18 ms, not '100'"},
        {"sensor = hps167s\naddress = 0\n", "2: address takes 1 to 32, not '0'"},
        {"sensor = hps167s\nwarm-up = 5\nwarm-up = 5\n", "3: warm-up occurs in line 2 already"},
        {"sensor = hps167s\nwarm-up = not readable\nwarm-up = 5\n", "3: warm-up occurs in line 2 already"},
        {"sensor = hps167s\nwarmup = 5\n",
         "2: 'warmup' is no setting that 'fathom save' prints for an hps167s"},
        {"sensor = hps167s\nWarm-up = 5\n",
         "2: 'Warm-up' is no setting that 'fathom save' prints for an hps167s"},
        {"sensor = hps167s\n= 5\n", "2: '' is no setting that 'fathom save' prints for an hps167s"},
        {"sensor = hps167s\ntemperature = 25.0\n",
         "2: 'temperature' is no setting that 'fathom save' prints for an hps167s"},
        {"sensor = hps167s\nbaud-code = 1\n",
         "2: 'baud-code' is no setting that 'fathom save' prints for an hps167s"},
        {"sensor = hps167s\nuuid = 0039002542345714203438350106070500390025423457142034383501060705\n",
         "2: the value of uuid is too long"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        desk_write("unit", rows[i][0]);
        refuses(2, "hps167s", rows[i][1]);
    }
}

/* ESC [ is how a terminal is told to do things, and so is 9B, in UTF-8 C2 9B, alone. */
TEST(what_drives_a_terminal_is_refused_and_not_printed)
{
    static const char *const rows[] = {"uuid = 00\x1b[2J",
                                       "uuid = 00\x9b"
                                       "2J",
                                       "uuid = 00\xc2\x9b"
                                       "2J",
                                       "warm-up = \a5",
                                       "warm-up\x1b]0;x\a = 5",
                                       "\x1b[31m",
                                       "warm-up = 5\r6",
                                       "uuid = \x7f",
                                       "uuid = \xc3\xa4"};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        char text[128];
        (void)snprintf(text, sizeof text, "sensor = hps167s\n%s\n", rows[i]);
        desk_write("unit", text);
        refuses(2, "hps167s", "2: the line has a character that cannot be printed or is not ASCII");
    }
    desk_write("unit", "sensor = \x1b[2J\n");
    refuses(2, "hps167s", "1: the line has a character that cannot be printed or is not ASCII");
    desk_write("unit", "sensor = hps167s # \xc3\xa4 and \x1b[2J\n");
    const tool_run_t *const run =
        tool_run(&bench.tool, "restore hps167s --port line --file %s", desk_path("unit"));
    assert_int_equal(run->status, 0);
    assert_null(strchr(run->out, 0x1b));
    assert_null(strchr(run->err, 0x1b));
}

TEST(a_command_of_an_a16_is_no_line_of_a_file)
{
    desk_write("unit", "sensor = a16\noperating-mode = automatic\n");
    refuses(2, "a16", "2: 'operating-mode' is no setting that 'fathom save' prints for an a16");
    desk_write("unit", "sensor = a16\nautomatic-output = on\n");
    refuses(2, "a16", "2: 'automatic-output' is no setting that 'fathom save' prints for an a16");
}

/* A line of `length` bytes in all, second in the file. */
static void write_long(int length)
{
    char text[DESK_TEXT];
    (void)snprintf(text, sizeof text, "sensor = hps167s\nwarm-up = 5 #%0*d\n", length - 13, 0);
    assert_int_equal(strcspn(strchr(text, '\n') + 1, "\n"), length);
    desk_write("unit", text);
}

TEST(a_line_of_more_than_250_bytes_is_refused)
{
    write_long(251);
    refuses(2, "hps167s", "2: the line is longer than 250 characters");
    write_long(5000);
    refuses(2, "hps167s", "2: the line is longer than 250 characters");
    write_long(250);
    ASSERT_RUN(0, "restore hps167s --port line --file %s", desk_path("unit"));
    assert_int_equal(bench.hps167s.warm_up_s, 5);
}

TEST(what_is_no_text_is_refused)
{
    FILE *const file = fopen(desk_path("unit"), "w");
    assert_non_null(file);
    assert_int_equal(fwrite("sensor = hps167s\nwarm\0-up = 5\n", 1, 30, file), 30);
    assert_int_equal(fclose(file), 0);
    refuses(2, "hps167s", "2: the line has a byte 0, so this is no text file");
}

TEST(a_file_that_cannot_be_read_is_told)
{
    refuses(1, "hps167s", " No such file or directory");
    const tool_run_t *const run = tool_run(&bench.tool, "restore hps167s --port line --file /tmp");
    assert_int_equal(run->status, 1);
    assert_string_equal(run->err, "fathom: /tmp: Is a directory\n");
    assert_int_equal(requests(), 0);
}

/* Line ends of another system, blanks, no end of the last line, and lines taken out. */
TEST(a_file_may_look_otherwise)
{
    desk_write("unit", "\r\n# mine\r\n \tsensor=hps167s\t# this one\r\n\r\n  warm-up\t=  5 \r\n"
                       "uuid = not readable\r\ntermination=off#");
    ASSERT_RUN(0, "restore hps167s --port line --file %s", desk_path("unit"));
    assert_int_equal(bench.hps167s.warm_up_s, 5);
    assert_false(bench.hps167s.termination);
    assert_int_equal(bench.hps167s.device.counters.writes, 2);
}

TEST(a_command_line_without_what_it_needs_is_refused)
{
    static const char *const rows[][2] = {
        {"restore hps167s --port line", "--file is missing"},
        {"restore hps167s --file x", "--port is missing"},
        {"restore hps167s --file x --port line --format json", "unknown option '--format'"},
        {"restore hps167s --file x --port line more", "'more' is one word too many."},
        {"restore a05 --file x --port line --mode dyp", "--mode is dyp, but this needs mode modbus."},
        {"restore a16:0 --file x --port line", "a write to address 0 goes to all units"},
        {"save hps167s --port line --format json", "unknown option '--format'"},
        {"save hps167s --port line more", "'more' is one word too many."},
        {"save hps167s --port line --dry-run", "unknown option '--dry-run'"}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        const tool_run_t *const run = tool_run(&bench.tool, "%s", rows[i][0]);
        if (run->status != 2 || strstr(run->err, rows[i][1]) == NULL)
            fail_msg("%s: exit status %d\n%s", rows[i][0], run->status, run->err);
    }
    assert_int_equal(requests(), 0);
}

TEST(address_0_is_nothing_that_a_new_unit_gets)
{
    desk_write("unit", "sensor = a16\naddress = 0\n");
    const tool_run_t *const run =
        tool_run(&bench.tool, "restore a16 --port line --as-new --file %s", desk_path("unit"));
    assert_int_equal(run->status, 2);
    assert_non_null(strstr(run->err, "unit:2: with --as-new no sensor gets address 0"));
    assert_int_equal(requests(), 0);
    ASSERT_RUN(0, "restore a16 --port line --file %s", desk_path("unit"));
    assert_int_equal(bench.a16.device.counters.writes, 0);
}
