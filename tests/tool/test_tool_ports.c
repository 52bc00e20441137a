/* SPDX-License-Identifier: MIT */
/* What a command makes of the sensors and ports that the user has named, and `fathom info` of several. */
#include "tool_bench.h"

#include <string.h>

#include "cli/rows.h"

EACH_BEGINS(bench_begin())

static const suite_t suite = {.set_up = begins};

/* ---- the options ---- */

enum { WORDS = 8, TEXT = 256 };

static site_t site;

/* `text`: words with blanks between them. */
static void set(const char *text, const sensor_defaults_t *defaults)
{
    static char copy[TEXT];
    char *words[WORDS];
    int count = 0;
    assert_true(strlen(text) < sizeof copy);
    (void)strcpy(copy, text);
    for (char *word = strtok(copy, " "); word != NULL; word = strtok(NULL, " ")) words[count++] = word;
    site_free(&site);
    assert_true(sensor_words(&site, defaults, words, count, &(origin_t){.command = "read"}));
}

#define SET(text, ...)   set(text, &(const sensor_defaults_t){__VA_ARGS__})
#define KEY(key, number) .keys.value[key] = (number), .keys.has[key] = true

static const port_options_t *port(size_t number)
{
    const line_t *line = site.lines;
    for (; number != 0 && line != NULL; number--) line = line->next;
    assert_non_null(line);
    return &line->settings;
}

static void expect_sensor(size_t i, const char *name, const char *mode, size_t number)
{
    assert_string_equal(site.sensors[i]->name, name);
    assert_string_equal(site.sensors[i]->mode->name, mode);
    assert_ptr_equal(site.sensors[i]->port, port(number));
}

static void expect_line(const fathom_line_settings_t *line, uint32_t baud, uint8_t parity, uint8_t stop_bits)
{
    assert_int_equal(line->baud, baud);
    assert_int_equal(line->parity, parity);
    assert_int_equal(line->stop_bits, stop_bits);
}

TEST(sensors_with_one_port_share_it_and_are_asked)
{
    SET("a16 hps167s:2@y a05:2 a16@x hps167s:5@y", .path = "z");
    assert_int_equal(site.line_count, 3);
    assert_string_equal(port(0)->path, "z");
    assert_string_equal(port(1)->path, "y");
    assert_string_equal(port(2)->path, "x");
    expect_sensor(0, "a16:1", "modbus", 0);
    expect_sensor(1, "hps167s:2", "modbus", 1);
    expect_sensor(2, "a05:2", "modbus", 0);
    expect_sensor(3, "a16", "auto", 2); /* alone, and without an address */
    expect_sensor(4, "hps167s:5", "modbus", 1);
    assert_int_equal(port(1)->station_count, 2);
}

TEST(the_port_of_an_option_is_the_same_as_one_behind_a_sensor)
{
    SET("a16:3 hps167s:2@x", .path = "x");
    assert_int_equal(site.line_count, 1);
    /* 9600 8N1 and 19200 8E1: opened at the slower */
    assert_true(port(0)->has_mixed_lines);
    expect_line(&port(0)->line, 9600, FATHOM_PARITY_NONE, 1);
    expect_line(&site.sensors[1]->line, 19200, FATHOM_PARITY_EVEN, 1);
}

TEST(names_that_are_the_same_have_the_port_behind_them)
{
    SET("a16@/dev/ttyUSB0 a16@/dev/ttyUSB1 a05@/dev/ttyS2 a16:1@tcp:h hps167s:7@x gate=hps167s:7@y",
        .path = NULL);
    expect_sensor(0, "a16@ttyUSB0", "auto", 0);
    expect_sensor(1, "a16@ttyUSB1", "auto", 1);
    expect_sensor(2, "a05", "auto", 2);
    expect_sensor(3, "a16:1", "modbus", 3);
    expect_sensor(4, "hps167s:7", "modbus", 4);
    expect_sensor(5, "gate", "modbus", 5);
    SET("a05=a16@1/x a05@2/y", .path = NULL);
    expect_sensor(0, "a05", "auto", 0);
    expect_sensor(1, "a05@y", "auto", 1);
}

TEST(a_port_s_own_keys_win_over_the_options)
{
    SET("hps167s@x,baud=57600,rs485=off,echo=off hps167s@y hps167s@tcp:h", KEY(KEY_BAUD, 115200),
        KEY(KEY_PARITY, FATHOM_PARITY_ODD), KEY(KEY_ECHO, 2), KEY(KEY_RS485, 1));
    expect_line(&site.sensors[0]->line, 57600, FATHOM_PARITY_ODD, 1);
    assert_false(port(0)->keys.value[KEY_RS485]);
    assert_int_equal(port(0)->keys.value[KEY_ECHO], 1);
    expect_line(&site.sensors[1]->line, 115200, FATHOM_PARITY_ODD, 1);
    assert_true(port(1)->keys.value[KEY_RS485]);
    assert_int_equal(port(1)->keys.value[KEY_ECHO], 2);
    /* of no serial port */
    assert_false(port(2)->keys.value[KEY_RS485]);
    assert_int_equal(port(2)->keys.value[KEY_ECHO], 0);
}

/* HPS-167S 2.2.2: a character has 11 bits. */
TEST(two_stop_bits_take_the_place_of_the_parity_unless_it_is_given_too)
{
    SET("hps167s@x,stop=2 hps167s@y,stop=2,parity=even", .path = NULL);
    expect_line(&site.sensors[0]->line, 19200, FATHOM_PARITY_NONE, 2);
    expect_line(&site.sensors[1]->line, 19200, FATHOM_PARITY_EVEN, 2);
    SET("hps167s@x hps167s@y,stop=1", KEY(KEY_STOP_BITS, 2));
    expect_line(&site.sensors[0]->line, 19200, FATHOM_PARITY_NONE, 2);
    expect_line(&site.sensors[1]->line, 19200, FATHOM_PARITY_EVEN, 1);
}

TEST(keys_behind_one_sensor_go_for_all_at_the_port)
{
    SET("hps167s:1@x hps167s:2@x,baud=57600 hps167s:3@x,baud=57600,echo=on", .path = NULL);
    for (size_t i = 0; i != 3; i++) expect_line(&site.sensors[i]->line, 57600, FATHOM_PARITY_EVEN, 1);
    assert_false(port(0)->has_mixed_lines);
    assert_int_equal(port(0)->keys.value[KEY_ECHO], 2);
}

/* ---- fathom info ---- */

static const tool_run_t *info(const char *words)
{
    static tool_port_t ports[2];
    bench_a16((fathom_sim_a16_config_t){.address = 3});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    ports[0] = (tool_port_t){.path = "here", .uart = bench.tool.uart};
    ports[1] = (tool_port_t){.path = "gone", .is_away = true};
    bench.tool.ports = ports;
    bench.tool.port_count = 2;
    return tool_run(&bench.tool, "info %s", words);
}

static void expect_begin(const char *text, const char *begin)
{
    if (strncmp(text, begin, strlen(begin)) != 0) fail_msg("'%s' does not begin with '%s'", text, begin);
}

TEST(info_tells_one_sensor_after_the_other)
{
    const tool_run_t *const run = info("gate=hps167s:7@here a16:3@here");
    assert_int_equal(run->status, 0);
    expect_begin(run->out, "gate: hps167s, infrared time of flight, at address 7, 19200 8E1\n");
    assert_non_null(strstr(run->out, "\n\na16:3: a16, one ultrasonic probe, at address 3, 9600 8N1\n"));
    expect_begin(
        run->err,
        "fathom: gate: the termination resistor is on, as in every sensor from the factory; on a line "
        "with several, switch it off in all but the last with 'fathom set hps167s:7 --port here termination "
        "off'\n");
}

TEST(info_goes_on_where_a_sensor_or_its_port_fails)
{
    const tool_run_t *const run =
        info("lost=a16@gone mute=a16:9@here tank=a16:3@here --timeout 300 --format json");
    assert_int_equal(run->status, 1);
    expect_begin(
        run->out,
        "{\"name\":\"tank\",\"model\":\"a16\",\"mode\":\"modbus\",\"line\":\"9600 8N1\",\"address\":3,");
    assert_string_equal(strchr(run->out, '\n'), "\n"); /* one object, in one line */
    expect_begin(run->err, "fathom: gone: no such device\nfathom: mute: address: no response from a16:9");
}

TEST(info_of_one_has_no_name_before_its_text_unless_the_user_has_given_one)
{
    const tool_run_t *run = info("a16:3@here");
    expect_begin(run->out, "a16, one ultrasonic probe, at address");
    bench_begin();
    run = info("t=a16:3 --port here");
    expect_begin(run->out, "t: a16, one ultrasonic probe, at address");
}
