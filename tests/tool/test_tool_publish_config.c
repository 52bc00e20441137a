/* SPDX-License-Identifier: MIT */
/* The configuration file of fathom publish: what it means, and what is said of what is wrong in it. */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

EACH_BEGINS((bench_begin(), desk_begin()))

static const suite_t suite = {.set_up = begins, .tear_down = desk_end};

enum { LINES = 32, TEXT = 4096 };

/* A configuration in which all is right; a test changes a line of it. */
static const char *const right[LINES] = {
    "site: mill/north",
    "interval: 500",
    "broker:",
    "  host: mill.lan",
    "  user: reader",
    "  port: 1884",
    "queue: {messages: 500}",
    "lines:",
    "  - port: /dev/ttyUSB0",
    "    baud: 9600",
    "    sensors:",
    "      - name: tank",
    "        sensor: a16:1:modbus",
    "        median: 5",
    "        level: {mounting: 2300, height: 2000, capacity: 5000}",
    "      - name: bumper",
    "        sensor: a05:2:modbus",
    "        probes: 1,2",
    "  - port: tcp:10.0.0.7",
    "    sensors:",
    "      - name: gate",
    "        sensor: hps167s:7",
    "        interval: 1000",
    "        alarm: {when: near<500/600, unknown: on, no-response: off}",
};

/* Line `number`, from 1, is this one instead; 0: none is. */
static const tool_run_t *check(unsigned number, const char *line)
{
    char text[TEXT] = "";
    for (unsigned i = 0; i != LINES && right[i] != NULL; i++) {
        (void)strcat(text, i + 1 == number ? line : right[i]);
        (void)strcat(text, "\n");
    }
    desk_write("site.yaml", text);
    return tool_run(&bench.tool, "publish --check %s", desk_path("site.yaml"));
}

static void expect_refusal(unsigned number, const char *line, unsigned at, const char *words)
{
    char expected[1200];
    const tool_run_t *const run = check(number, line);
    (void)snprintf(expected, sizeof expected, "fathom publish: %s:%u: %s", desk_path("site.yaml"), at, words);
    if (run->status != 2 || strncmp(run->err, expected, strlen(expected)) != 0)
        fail_msg("'%s': exit status %d\n%sinstead of\n%s", line, run->status, run->err, expected);
    assert_string_equal(run->out, "");
    assert_ptr_equal(strchr(run->err, '\n'), run->err + strlen(run->err) - 1);
}

/* ---- what it means ---- */

TEST(check_prints_a_table_of_sensors_and_topics)
{
    static const char expected[] = "broker     mill.lan port 1884\n"
                                   "client     fathom-mill-north, user reader\n"
                                   "topics     fathom/mill/north/\n"
                                   "           Only one computer may have this client id and these topics.\n"
                                   "queue      500 messages, 4194304 bytes\n"
                                   "discovery  homeassistant\n"
                                   "           fathom/mill/north/status\n"
                                   "           fathom/mill/north/publisher\n"
                                   "tank       a16:1:modbus@/dev/ttyUSB0, 500 ms, median 5, level\n"
                                   "           fathom/mill/north/tank/state\n"
                                   "           fathom/mill/north/tank/level\n"
                                   "           fathom/mill/north/tank/availability\n"
                                   "           fathom/mill/north/tank/counters\n"
                                   "bumper     a05:2:modbus@/dev/ttyUSB0, 500 ms\n"
                                   "           fathom/mill/north/bumper/1/state\n"
                                   "           fathom/mill/north/bumper/2/state\n"
                                   "           fathom/mill/north/bumper/availability\n"
                                   "           fathom/mill/north/bumper/counters\n"
                                   "gate       hps167s:7:modbus@tcp:10.0.0.7, 1000 ms, alarm near<500/600\n"
                                   "           fathom/mill/north/gate/state\n"
                                   "           fathom/mill/north/gate/alarm\n"
                                   "           fathom/mill/north/gate/availability\n"
                                   "           fathom/mill/north/gate/counters\n";
    const tool_run_t *const run = check(0, "");
    assert_int_equal(run->status, 0);
    assert_string_equal(run->err, "");
    assert_string_equal(run->out, expected);
}

/* Line `number` instead of the right one, and what the table has then. */
TEST(a_line_may_be_otherwise)
{
    static const struct {
        unsigned number;
        const char *line;
        const char *out;
    } lines[] = {
        {15, "        level: mounting=2300,height=2000,capacity=5000", ", median 5, level\n"},
        {24, "        alarm: near<500/600,unknown=on,no-response=off", ", alarm near<500/600\n"},
        {2, "discovery: off", "discovery  off\n"},
        {2, "discovery: ha/x", "discovery  ha/x\n"},
        {1, "# no site", "/, from the name of this host\n"},
        {2, "prefix: p", "a16:1:modbus@/dev/ttyUSB0, 1000 ms"}, /* without an interval */
        {12, "      - name: 5", "5          a16:1:modbus@"},    /* no sensor has five probes */
        {6, "  tls: {}", "broker     mill.lan port 8883, TLS\n"},
    };
    for (size_t i = 0; i != sizeof lines / sizeof lines[0]; i++) {
        const tool_run_t *const run = check(lines[i].number, lines[i].line);
        if (run->status != 0 || strstr(run->out, lines[i].out) == NULL)
            fail_msg("%s:\n%s%s", lines[i].line, run->out, run->err);
    }
}

/* ---- what is wrong in it ---- */

#define NOT_PRINTABLE "a text has a character that cannot be printed, such as a tab. Leave it out.\n"
#define TOPICS        "It takes letters, digits, '-', '_' and '.', at most 100, with / between levels."

static const struct {
    unsigned number;
    const char *line;
    unsigned at;
    const char *words;
} rows[] = {
    {2, "intervall: 500", 2, "unknown key 'intervall'. Did you mean interval?\n"},
    {4, "  hots: mill.lan", 4, "broker: unknown key 'hots'. Did you mean host?\n"},
    {10, "    boud: 9600", 10, "lines: unknown key 'boud'. Did you mean baud?\n"},
    {14, "        medain: 5", 14, "sensors: unknown key 'medain'. Did you mean median?\n"},
    {15, "        level: {mounting: 2300, hight: 2000, capacity: 5000}", 15,
     "level: unknown key 'hight'. Did you mean height?\n"},
    {6, "  password: secret", 6,
     "broker: a password does not belong in this file. Write it to a file that only this user can read"},
    {7, "queue: 500", 7, "queue is a text. It takes a map with messages or bytes.\n"},
    {1, "site: [mill]", 1, "site is a list. " TOPICS "\n"},
    {14, "        median: {of: 5}", 14, "sensors: median is a map. It takes a whole number from 3 to 15.\n"},
    {8, "lines: none\nx:", 8, "lines is a text. It takes a list of maps, each with port and sensors.\n"},
    {2, "interval:", 2, "interval is empty. It takes a whole number from 0 to 2147483 ms.\n"},
    {14, "        median: five", 14, "sensors: median is 'five'."},
    {14, "        median: 16", 14, "sensors: median is '16'. It takes a whole number from 3 to 15.\n"},
    {2, "interval: -1", 2, "interval is '-1'. It takes a whole number from 0 to 2147483 ms.\n"},
    {6, "  port: 65536", 6, "broker: port is '65536'. It takes a whole number from 1 to 65535.\n"},
    {14, "        gate: 5", 14, "sensors: gate has no effect without median.\n"},
    {10, "    baud: 12", 10, "lines: baud is '12'. It takes 9600, 19200, "},
    {10, "    bias: up", 10, "lines: unknown key 'bias'."},
    {19, "  - port: tcp:10.0.0.7\n    baud: 9600", 20,
     "lines: unknown key 'baud'. It is one of port, sensors.\n"},
    {13, "        sensor: b17", 13,
     "unknown sensor 'b17'. It is one of a16, a05, hps167s, or a name of 'fathom models'.\n"},
    {13, "        sensor: a16:1:telnet", 13, "unknown mode of a16 'telnet'."},
    {14, "        probes: 1,2", 14, "probes has no effect on a16 (modbus)."},
    {17, "        sensor: a05:1:modbus", 17,
     "tank and bumper have the same address, so both would respond at once.\n"},
    {16, "      - name: tank", 17,
     "two sensors have the name tank, in line 13 too. Change name: of one of them.\n"},
    {12, "      - name: 4", 12,
     "name is '4'. In fathom/mill/north it has the topics of a probe of another site's sensor. Take another "
     "name, such as s4.\n"},
    {12, "      - name: a/b", 12, "name is 'a/b'. It takes at most 31 letters, digits, '-', '_' and '.'"},
    {1, "site: mill/#", 1, "site is 'mill/#'. " TOPICS "\n"},
    {14, "        sensor: a16", 14, "sensors: sensor is given twice, in line 13 too.\n"},
    {12, "      -", 13, "sensors: name is missing. It takes at most 31 letters"},
    {3, "x:", 3, "unknown key 'x'."},
    {6, "  password-file: /nowhere/pw", 6,
     "broker: password-file: cannot read /nowhere/pw: No such file or directory.\n"},
    {6, "  password-credential: mqtt", 6,
     "password-credential: CREDENTIALS_DIRECTORY is not set. The unit needs a line LoadCredential=mqtt:"},
    {6, "  tls: {certificate-file: /dev/null}", 6, "tls: certificate-file and key-file belong together."},
    {8, "lines: {", 9, "this is no YAML: "},
    {24, "        alarm: {when: near<500, unknown: on}", 24,
     "alarm: no-response is missing. It takes on or off.\n"},
    {1, "\"\\e[2J\": mill", 1, NOT_PRINTABLE},
    {6, "  password-file: \"/pw\\u009B2J\"", 6, NOT_PRINTABLE},
    {2, "discovery: \"a\\0b\"", 2, NOT_PRINTABLE},
    {7, "---", 7, "a second document begins. Write all into one, without a line of ---.\n"},
    {9, "  - port: /dev/ttyUSB0,baud=9600", 9,
     "port is '/dev/ttyUSB0,baud=9600'. Write keys in lines of their own, such as baud: 9600.\n"},
};

TEST(what_is_wrong_is_told_with_its_line_and_what_to_write)
{
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        expect_refusal(rows[i].number, rows[i].line, rows[i].at, rows[i].words);
}

/* A kilobyte. */
TEST(a_topic_that_is_too_long_is_refused)
{
    char line[1100] = "site: ";
    memset(line + strlen(line), 'x', 1024);
    expect_refusal(1, line, 1, "site is 'xxxxxxxx");
    assert_null(strstr(check(1, "site: x")->err, "site"));
}

TEST(one_file_that_is_not_empty_is_named)
{
    char line[400];
    desk_write("empty.yaml", "# nothing\n");
    (void)snprintf(line, sizeof line, "publish --check %s", desk_path("empty.yaml"));
    assert_refused(line, "empty.yaml:1: the file is empty. It takes at least broker and lines.");
    (void)snprintf(line, sizeof line, "publish --check %s", desk_path("none.yaml"));
    assert_refused(line, "none.yaml: No such file or directory.");
    assert_refused("publish", "FILE is missing, such as ");
    assert_refused("publish one two", "2 files are named. Name one.");
}
