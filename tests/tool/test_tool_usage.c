/* SPDX-License-Identifier: MIT */
/* Wrong usage: exit status 2 and one line that says what is wrong, before anything is sent; and the help. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "cli/rows.h"

enum { WORD = 400 };

EACH_BEGINS(bench_begin())

static const suite_t suite = {.set_up = begins};

static const refused_t wrong[] = {
    {"reed", "unknown command 'reed'. Did you mean read?"},
    {"--versoin", "unknown option '--versoin'."},
    {"help poort", "unknown command or topic 'poort'. Did you mean ports?"},
    {"help foo", "unknown command or topic 'foo'. See 'fathom --help'."},
    {"read b17 -p x", "unknown sensor 'b17'. It is one of a16, a05, hps167s, or a name of 'fathom models'."},
    {"help read set", "help takes one command or topic."},
    /* options */
    {"read a16 -p x --fast", "unknown option '--fast'."},
    {"read a16 -p x --prot y", "unknown option '--prot'. Did you mean --port?"},
    {"read a16 -p x --inter 5",
     "unknown option '--inter'. Did you mean "}, /* options cannot be abbreviated */
    {"read a16 -p x -x", "unknown option '-x'."},
    {"read a16 -p", "--port needs a value: PORT."},
    {"sim a16 -p x", "unknown option '-p'."},
    {"read a16 -p x -p y", "--port is given twice."},
    {"read a16 -p x --reconnect=1", "--reconnect takes no value."},
    {"read a16 -p x --count 0", "--count is '0'. It takes a whole number from 1 to 1000000000."},
    {"read a16 -p x --count -1", "--count is '-1'."},
    {"read a16 -p x --count +1", "--count is '+1'."},
    {"read a16 -p x --count 1e3", "--count is '1e3'."},
    {"read a16 -p x --count 18446744073709551617", "--count is '18446744073709551617'."},
    {"read a16 -p x --count=", "--count is ''."},
    {"read a16 -p x --interval 2147484",
     "--interval is '2147484'. It takes a whole number from 0 to 2147483 ms."},
    {"read a16 -p x --timeout 600001", "--timeout is '600001'. It takes a whole number from 1 to 600000 ms."},
    {"read a16 -p x --retries 255", "--retries is '255'."},
    {"read a16 -p x --address 255", "--address is '255'."},
    {"read hps167s -p x --address 33", "--address is 33. hps167s takes a whole number from 1 to 32."},
    {"read a16 -p x --format jsno", "--format is 'jsno'. It takes text, json or csv."},
    {"read a16 -p x --parity Even", "--parity is 'Even'. It takes none, even or odd."},
    {"read a16 -p x --stop-bits 3", "--stop-bits is '3'."},
    {"read a16 -p x --baud 12345",
     "--baud is '12345'. It takes 9600, 19200, 38400, 57600, 115200 or 230400."},
    {"read a16 -p x --echo yes", "--echo is 'yes'. It takes auto, off or on."},
    {"read a16 -p x --stats=0", "--stats is '0'. It takes a whole number from 1 to 4000 s."},
    {"read a16 -p x --stats 5", "unknown sensor '5'."},
    {"read a16 -p x --no-header", "--no-header has no effect without --format csv."},
    {"read a16 -p x --output o --rotate hour", "--rotate is 'hour'. It takes day."},
    {"read a16 -p x --output=", "--output is ''. It takes the name of a file."},
    {"read a05 -p x --probes 1,1",
     "--probes is '1,1'. It takes numbers from 1 to 4, each once, such as 1,2."},
    {"read a05 -p x --probes 1,", "--probes is '1,'."},
    {"read a05 -p x --probes 1-3", "--probes is '1-3'."},
    {"read a16 -p x --means 0", "--means: 0 has no value."},
    {"read a16 -p x --means 0=far", "--means: 0 is 'far'. It takes unknown, no-target, interference, "},
    {"read a16 -p x --means FFFD=fault", "--means: unknown key 'FFFD'. Did you mean fffd?"},
    {"read a16 -p x --means 0=fault,", "--means: unknown key ''."},
    {"watch a16 -p x --count 3", "unknown option '--count'."},
    {"watch a16 -p x --level mounting=2300",
     "unknown option '--level'. Did you mean --level of 'fathom read'?"},
    /* sensors */
    {"read", "no sensor is named."},
    {"read a02yyu2 -p x", "unknown sensor 'a02yyu2'. Did you mean a02yyuw?"},
    {"read a02 -p x", "unknown sensor 'a02'. Did you mean one of a02yyuw, a02yytw, a02yymw, a02yy4w?"},
    {"read A12 -p x", "unknown sensor 'A12'. Did you mean one of a12bnytw, a12-rs485?"},
    {"models a0", "Did you mean one of a01anyub, a01cnyub, a02yyuw, a02yytw, a06blyt, a02yymw?"},
    {"read hc-sr -p x", "unknown sensor 'hc-sr'. Did you mean hc-sr04?"},
    {"read SEN0208 -p x", "unknown sensor 'SEN0208'. It is one of a16, a05, hps167s, or a name of"},
    {"read DYP-A12 -p x", "unknown sensor 'DYP-A12'. Did you mean one of a12bnytw, a12-rs485?"},
    {"read colour -p x", "It is one of a16, a05, hps167s, or a name of 'fathom models'."},
    {"read us-100 -p x", "a us-100 cannot be read: on a UART it sends two bytes without header and sum."},
    {"read TFmini -p x", "a TFmini cannot be read: its frames are others. 'fathom models' lists what can."},
    {"read a02yyuw:modbus -p x", "unknown mode of a02yyuw 'modbus'. It is one of auto."},
    {"read SEN0311@tcp:h", "a02yyuw in mode auto needs a serial port or a converter"},
    {"info a02yyuw -p x", "a02yyuw receives no requests, so it has no address and no settings"},
    {"read hc-sr04 -p x", "hc-sr04 in mode pwm needs GPIO lines, such as "
                          "hc-sr04:pwm@gpiochip0,trigger=17,echo=27."},
    {"read hc-sr04",
     "the GPIO lines are missing. Write them behind the sensor: hc-sr04@gpiochip0,trigger=17,echo=27."},
    {"read jsn-sr04t:free", "Write them behind the sensor: jsn-sr04t:free@gpiochip0,echo=27."},
    {"read aj-sr04m:controlled@x,trigger=gpiochip0/17", "aj-sr04m in mode controlled has no trigger=."},
    {"models a16 a05", "models takes one name."},
    {"models a02yyu2", "unknown sensor 'a02yyu2'. Did you mean a02yyuw?"},
    {"read a16", "--port is missing, such as --port /dev/ttyUSB0."},
    {"read hps167s -p x --mode dyp", "unknown mode of hps167s 'dyp'."},
    {"read a16:1: -p x", "unknown mode of a16 ''."},
    {"read a16:1:modbsu -p x", "unknown mode of a16 'modbsu'. Did you mean modbus?"},
    {"read a16:0:auto -p x", "'0' is no address of a16. It takes a whole number from 1 to 254."},
    {"read a05:255:modbus -p x", "'255' is no address of a05. It takes a whole number from 0 to 254."},
    {"read hps167s:33 -p x", "'33' is no address of hps167s. It takes a whole number from 1 to 32."},
    {"read a16:1 --address 5 -p x", "'a16:1' has an address already. Leave --address out."},
    {"read a16:modbus --mode auto -p x", "'a16:modbus' has a mode already. Leave --mode out."},
    {"read a16:1 a05:2 --mode modbus -p x", "with several sensors, write --address and --mode behind each"},
    /* sensors that share a line */
    {"read a16 a05:2:auto -p x", "a05 in mode auto sends automatically and cannot share a line."},
    {"read a16:1 a05:1 -p x", "a16:1 and a05:1 have the same address, so both would respond at once."},
    {"read a05:1:modbus a05:2:dyp -p x",
     "a damaged response in mode dyp can change the address of another a05"},
    {"read a16:1:controlled hps167s:7 -p x", "a16 in mode controlled"},
    {"read a16:1:controlled -p tcp:x", "a16 in mode controlled needs a serial port"},
    {"read a16:1 hps167s:1 -p tcp:x", "a16:1 and hps167s:1 have the same address"},
    {"read t=a16@x t=a05@y", "two sensors have the name t. Give each its own name, such as one=a05."},
    {"read a16:3@x,baud=9600 a16:4@x,baud=19200", "a16:4@x: another sensor at this port has another baud=."},
    /* ports */
    {"read hps167s -p x,baud=57600",
     "--port takes no keys. Write them behind the sensor: hps167s@x,baud=57600."},
    {"read a05:relay", "the GPIO lines are missing. Write them behind the sensor: a05:relay@gpiochip0,in=5."},
    {"read hps167s@tcp:", "tcp:: "},
    {"read a16@tcp:h",
     "a16 in mode auto needs a serial port. Over TCP, use Modbus: a16:modbus, or a converter "
     "that passes raw bytes: rtu-tcp:HOST:PORT."},
    {"read a16@rtu-tcp:h", "rtu-tcp:h: the port is missing, such as in rtu-tcp:192.168.1.20:8899."},
    {"read a16:controlled@rtu-tcp:h:1",
     "a16 in mode controlled needs a serial port, which can send a break."},
    {"read a16@rtu-tcp:h:1,baud=9600", "a16@rtu-tcp:h:1 has keys, but a port over TCP has none."},
    {"read a16@rtu-tcp:h:1 --baud 9600", "rtu-tcp:h:1 has no line settings: set the line in the gateway"},
    {"request 1 3 0 1 --port tcp:h --pieces", "tcp:h has no line settings: set the line in the gateway"},
    {"read a16@/dev/gpiochip0,in=1",
     "a16 in mode auto needs a serial port, and /dev/gpiochip0 is a GPIO chip."},
    {"read a=a16:switch@gpiochip0,in=3 b=a05:relay@/dev/gpiochip0,in=3", "line 3 of gpiochip0 is used twice"},
    /* commands for one sensor */
    {"info a16:1:auto -p x", "a16 in mode auto receives no requests. Leave the mode out."},
    {"get a16 address", "--port is missing"},
    {"get a16 -p x colour", "unknown setting of a16 'colour'. It is one of "},
    {"get hps167s -p x offset", "unknown setting of hps167s 'offset'. Did you mean distance-offset?"},
    {"get a16 -p x switch-treshold",
     "unknown setting of a16 'switch-treshold'. Did you mean switch-threshold?"},
    {"get a16 -p x operating-mode", "operating-mode is write-only."},
    {"get a16 -p x address more", "'more' is one word too many."},
    {"info a16 -p x --interval 5", "unknown option '--interval'."},
    {"set a16 -p x", "the setting is missing. 'fathom get a16' lists the settings."},
    {"set a16 -p x address", "the value is missing."},
    {"set hps167s -p x termination=off", "the setting and its value are two words. Write: termination off."},
    {"request hps167s:7 -p x", "UNIT is from 0 to 255, in decimal or as 0x in hex"},
    {"read hps167s 7 -p x",
     "unknown sensor '7'. An address stands behind its sensor and a colon, such as hps167s:7."},
    {"save a16 -p x --output a16.txt", "unknown option '--output'. Did you mean --file?"},
    {"scan line1", "scan accepts options only. Use --port line1."},
    {"publish", "FILE is missing, such as /etc/fathom/site.yaml."},
    {"set a16 -p x address 255", "address is '255'. It takes 1 to 254."},
    {"set a16 -p x address 0", "A unit at address 0 may not be found again"},
    {"set hps167s -p x address 0 --may-not-be-found-again", "address is '0'. It takes 1 to 32."},
    {"set a16:0 -p x switch-threshold 500", "a write to address 0 goes to all units"},
    {"set a16 -p x distance 5", "distance is read-only."},
    {"set hps167s -p x reconnect-time 19", "reconnect-time is '19'."},
    {"set a05 --mode modbus -p x every-address 5", "--mode is modbus, but this needs mode dyp."},
    {"reset a16 interface -p x", "a16 cannot be reset. Only an hps167s can."},
    {"reset hps167s -p x", "say what to reset: interface or sensor."},
    {"reset hps167s interface -p x", "To confirm that, add --yes."},
};

TEST(wrong_usage_is_rejected_in_one_line_before_anything_is_sent)
{
    for (size_t i = 0; i != sizeof wrong / sizeof wrong[0]; i++) assert_refused(wrong[i].line, wrong[i].text);
    assert_int_equal(bench.a16.device.counters.requests, 0);
}

/* A number below zero is a value or a word wherever it stands. */
TEST(a_negative_value_may_stand_between_options)
{
    static const char *const lines[] = {"set hps167s distance-offset -15 --port line",
                                        "set --port line hps167s distance-offset -15",
                                        "set hps167s --port line distance-offset -15 --timeout 900"};
    for (size_t i = 0; i != sizeof lines / sizeof lines[0]; i++) {
        bench_begin();
        bench_hps167s((fathom_sim_hps167s_config_t){0});
        const tool_run_t *const run = tool_run(&bench.tool, "%s", lines[i]);
        if (run->status != 0) fail_msg("%s: exit status %d\n%s", lines[i], run->status, run->err);
    }
}

/* The first words of its lines are the commands, the topics, and others. */
TEST(each_help_fits_80_columns_and_that_of_a_command_60_lines)
{
    char overview[4096];
    char page[8192];
    unsigned pages = 0;
    (void)snprintf(overview, sizeof overview, "%s", tool_run(&bench.tool, "help")->out);
    for (const char *line = overview; line != NULL; line = strchr(line + 1, '\n')) {
        char name[16] = "";
        if (sscanf(line, "\n  %15[a-z]", name) != 1) continue;
        const tool_run_t *const run = tool_run(&bench.tool, "help %s", name);
        const bool is_command = strncmp(run->out, "Usage: fathom ", 14) == 0;
        unsigned lines = 0;
        if (run->status == 2) continue;
        pages++;
        assert_string_equal(run->err, "");
        for (const char *at = run->out; *at != '\0'; lines++) {
            const size_t length = strcspn(at, "\n");
            if (length > 80) fail_msg("%s: %.*s", name, (int)length, at);
            at += length + 1;
        }
        if (is_command && lines > 60) fail_msg("%s: %u lines", name, lines);
        (void)snprintf(page, sizeof page, "%s", run->out);
        if (is_command) assert_string_equal(tool_run(&bench.tool, "%s -h", name)->out, page);
    }
    assert_int_equal(pages, 16 + 23);
}

TEST(an_option_without_an_effect_is_a_notice)
{
    const tool_run_t *run = tool_run(&bench.tool, "read a16 --port /nowhere --retries 7 --count 1");
    assert_non_null(
        strstr(run->err, "--retries has no effect on a16 in mode auto, which sends no requests."));
    run = tool_run(&bench.tool, "read a16 --port /nowhere --retries 7 --count 1 --quiet");
    assert_null(strstr(run->err, "no effect"));
}

/* ---- the word that names a sensor ---- */

static void parse(sensor_word_t *place, const char *text, char word[WORD])
{
    (void)snprintf(word, WORD, "%s", text);
    assert_true(sensor_word_parse(place, word, &(origin_t){.command = "read"}));
}

static void expect_part(const char *part, const char *expected, const char *word)
{
    if ((part == NULL) != (expected == NULL) || (part != NULL && strcmp(part, expected) != 0))
        fail_msg("%s", word);
}

TEST(right_words_have_their_parts)
{
    static const struct {
        const char *word;
        const char *name;
        const char *address;
        const char *mode;
        const char *port;
    } rows[] = {
        {"a16", "", NULL, NULL, NULL},
        {"a16:3", "", "3", NULL, NULL},
        {"a16:modbus", "", NULL, "modbus", NULL},
        {"a16::modbus", "", "", "modbus", NULL},
        {"a16:", "", "", NULL, NULL},
        {"a05:2:dyp", "", "2", "dyp", NULL},
        {"a16:x", "", NULL, "x", NULL}, /* the address and the mode are parsed with the sensor */
        {"a16:1x", "", "1x", NULL, NULL},
        {"a16:1:", "", "1", "", NULL},
        {"a16:modbus:1", "", NULL, "modbus:1", NULL},
        {"tank=hps167s:7", "tank", "7", NULL, NULL},
        {"7=a16", "7", NULL, NULL, NULL},
        {"A-z_9.=a16", "A-z_9.", NULL, NULL, NULL},
        {"abcdefghijabcdefghijabcdefghijX=a16", "abcdefghijabcdefghijabcdefghijX", NULL, NULL, NULL},
        {"a16@/dev/ttyUSB0", "", NULL, NULL, "/dev/ttyUSB0"},
        {"a16@./a=b@c:1", "", NULL, NULL, "./a=b@c:1"},
        {"hps167s:8@tcp:10.0.0.7", "", "8", NULL, "tcp:10.0.0.7"},
        {"hps167s@tcp:[::1]:1502", "", NULL, NULL, "tcp:[::1]:1502"},
        {"a=a16:1:modbus@x,baud=57600", "a", "1", "modbus", "x"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        parse(&place, rows[i].word, word);
        assert_non_null(strstr(rows[i].word, place.model->name));
        expect_part(place.name, rows[i].name, rows[i].word);
        expect_part(place.address, rows[i].address, rows[i].word);
        expect_part(place.mode, rows[i].mode, rows[i].word);
        expect_part(place.port, rows[i].port, rows[i].word);
    }
}

/* The numbers are those of other headers: hal.h, line.h and fathom_gpio.h. */
TEST(values_are_those_of_the_library)
{
    static const struct {
        const char *word;
        port_key_t key;
        uint32_t value;
    } rows[] = {{"a16@x,baud=230400", KEY_BAUD, 230400},
                {"a16@x,parity=even", KEY_PARITY, FATHOM_PARITY_EVEN},
                {"a16@x,stop=1", KEY_STOP_BITS, 1},
                {"a16@x,rs485=on", KEY_RS485, 1},
                {"a16@x,echo=on", KEY_ECHO, 2},
                {"a16@gpiochip0,in=5", KEY_IN, 5},
                {"a16@gpiochip0,bias=down", KEY_BIAS, 2},
                {"a16@gpiochip0,bias=off", KEY_BIAS, 3},
                {"a16@x,baud=57600,parity=odd,stop=2,rs485=on,echo=off", KEY_ECHO, 1},
                {"a16@x,echo=auto,rs485=off,baud=9600", KEY_RS485, 0},
                {"a05@/dev/gpiochip12,in=0,bias=up", KEY_BIAS, 1},
                {"a05@gpiochip1,in=65535,bias=as-is", KEY_IN, 65535},
                {"a16@gpiochip0,trigger=17,echo=27", KEY_PULSE, 27},
                {"a16@gpiochip/x,baud=9600", KEY_BAUD, 9600} /* what is no chip is a tty */};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        parse(&place, rows[i].word, word);
        assert_true(place.keys.has[rows[i].key]);
        assert_int_equal(place.keys.value[rows[i].key], rows[i].value);
    }
}

REFUSES(wrong_words_are_rejected_with_what_they_take, "read --port x",
        {"b17:1", "unknown sensor 'b17'. It is one of a16, a05, hps167s, or a name of 'fathom models'."},
        {"tank=", "unknown sensor ''."}, {"a=b=a16", "unknown sensor 'b=a16'."},
        {"hps167s1234567890123456789012345678901234567890:1", "unknown sensor 'hps167s1234567890"},
        {"=a16", "'' is no name of a sensor."},
        {".a=a16", "'.a' is no name of a sensor. A name has at most 31 letters, digits, '-', '_' and '.'"},
        {"a:1=a16", "'a:1' is no name"}, {"\xC3\xA4=a16", "is no name"},
        {"abcdefghijabcdefghijabcdefghijXY=a16", "is no name"}, {"a16@", "a16@ names no port."},
        {"a16@,baud=9600", "a16@ names no port."},
        {"a16@x,", "a16@x: unknown key ''. It is one of baud, parity, stop, rs485, echo, pieces, trigger."},
        {"a16@x,baud=9600,,echo=on", "unknown key ''"}, {"a16@x,=9600", "unknown key ''"},
        {"a16@x,Baud=9600", "unknown key 'Baud'. Did you mean baud?"},
        {"a16@x,bau=9600", "unknown key 'bau'. Did you mean baud?"},
        {"a16@x,in=1", "unknown key 'in'. It is one of baud, parity, stop, rs485, echo, pieces, trigger."},
        {"a16@gpiochip0,rs485=on", "unknown key 'rs485'. It is one of trigger, echo, in, bias, near."},
        {"a16@gpiochip0,17", "unknown key '17'."}, {"a16@x,baud", "a16@x: baud has no value."},
        {"a16@x,baud=", "baud is ''. It takes 9600, 19200, 38400, 57600, 115200 or 230400."},
        {"a16@x,baud=9601", "baud is '9601'."},
        {"a16@x,baud=00000000000009600", "baud is '00000000000009600'."},
        {"a16@x,parity=even,parity=odd", "parity is given twice."},
        {"a16@x,parity=e", "parity is 'e'. It takes none, even or odd."},
        {"a16@x,stop=0", "stop is '0'. It takes a whole number from 1 to 2."},
        {"a16@x,rs485=yes", "rs485 is 'yes'. It takes off or on."},
        {"a16@x,echo=1", "echo is '1'. It takes auto, off or on."},
        {"a16@gpiochip0,echo=on", "echo is 'on'. It takes a whole number from 0 to 65535."},
        {"a16@gpiochip0,trigger=-1", "trigger is '-1'."}, {"a16@gpiochip0,in=65536", "in is '65536'."},
        {"a16@gpiochip0,bias=", "bias is ''. It takes as-is, up, down or off."},
        {"hps167s@tcp:h,baud=9600", "a port over TCP has none."})
