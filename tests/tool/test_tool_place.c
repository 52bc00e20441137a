/* SPDX-License-Identifier: MIT */
/* The word by which a user names a sensor and where it is: what comes of right ones, what is said of wrong ones, and that
 * no word whatever does harm. */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream; stderr is a variable */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/sensor_words.h"

/* ---- a word, and its place as a word again ---- */

enum { WORD = 400 };

static char message[WORD * 2]; /* on the standard error by the last parse */

static bool parse(sensor_word_t *place, const char *text, char word[WORD])
{
    char *err = NULL;
    size_t size = 0;
    FILE *const own = stderr;
    assert_true(strlen(text) < WORD);
    (void)snprintf(word, WORD, "%s", text);
    stderr = open_memstream(&err, &size);
    const origin_t origin = {.command = "read"};
    const bool is_right = sensor_word_parse(place, word, &origin);
    (void)fclose(stderr);
    stderr = own;
    (void)snprintf(message, sizeof message, "%s", err);
    free(err);
    return is_right;
}

static const char *value_text(port_key_t key, uint32_t value)
{
    static const char *const words[PORT_KEYS][4] = {
        [KEY_PARITY] = {"none", "even", "odd"},
        [KEY_RS485] = {"off", "on"},
        [KEY_ECHO] = {"auto", "off", "on"},
        [KEY_BIAS] = {"as-is", "up", "down", "off"},
    };
    static char number[16];
    if (value < 4 && words[key][0] != NULL) return words[key][value];
    (void)snprintf(number, sizeof number, "%u", (unsigned)value);
    return number;
}

static void add(char word[WORD], const char *before, const char *text)
{
    const size_t length = strlen(word);
    if (text != NULL) (void)snprintf(word + length, WORD - length, "%s%s", before, text);
}

/* The keys in the order of port_key_t. */
static void print(const sensor_word_t *place, char word[WORD])
{
    word[0] = '\0';
    if (place->name[0] != '\0') add(word, place->name, "=");
    add(word, "", place->model->name);
    add(word, ":", place->address);
    add(word, ":", place->mode);
    add(word, "@", place->port);
    for (port_key_t key = 0; key != PORT_KEYS; key++) {
        if (!place->keys.has[key]) continue;
        add(word, ",", port_key_name(key));
        add(word, "=", value_text(key, place->keys.value[key]));
    }
}

/* ---- right ones ---- */

TEST(what_comes_of_right_words)
{
    const struct {
        const char *word;
        const char *name;
        const char *model;
        const char *address;
        const char *mode;
        const char *port;
        const char *keys; /* as they are printed */
    } rows[] = {
        {"a16", "", "a16", NULL, NULL, NULL, ""},
        {"a16:3", "", "a16", "3", NULL, NULL, ""},
        {"a16:modbus", "", "a16", NULL, "modbus", NULL, ""},
        {"a16::modbus", "", "a16", "", "modbus", NULL, ""},
        {"a16:", "", "a16", "", NULL, NULL, ""},
        {"a05:2:dyp", "", "a05", "2", "dyp", NULL, ""},
        /* the address and the mode are looked at with the sensor */
        {"a16:x", "", "a16", NULL, "x", NULL, ""},
        {"a16:1x", "", "a16", "1x", NULL, NULL, ""},
        {"a16:1:", "", "a16", "1", "", NULL, ""},
        {"a16:modbus:1", "", "a16", NULL, "modbus:1", NULL, ""},
        {"tank=hps167s:7", "tank", "hps167s", "7", NULL, NULL, ""},
        {"7=a16", "7", "a16", NULL, NULL, NULL, ""},
        {"A-z_9.=a16", "A-z_9.", "a16", NULL, NULL, NULL, ""},
        {"abcdefghijabcdefghijabcdefghijX=a16", "abcdefghijabcdefghijabcdefghijX", "a16", NULL, NULL, NULL,
         ""},
        {"a16@/dev/ttyUSB0", "", "a16", NULL, NULL, "/dev/ttyUSB0", ""},
        {"a16@./a=b@c:1", "", "a16", NULL, NULL, "./a=b@c:1", ""},
        {"hps167s:8@tcp:10.0.0.7", "", "hps167s", "8", NULL, "tcp:10.0.0.7", ""},
        {"hps167s@tcp:[::1]:1502", "", "hps167s", NULL, NULL, "tcp:[::1]:1502", ""},
        {"a=a16:1:modbus@x,baud=57600,parity=odd,stop=2,rs485=on,echo=off", "a", "a16", "1", "modbus", "x",
         ",baud=57600,parity=odd,stop=2,rs485=on,echo=off"},
        {"a16@x,echo=auto,rs485=off", "", "a16", NULL, NULL, "x", ",rs485=off,echo=auto"},
        {"a16@gpiochip0,trigger=17,echo=27", "", "a16", NULL, NULL, "gpiochip0", ",trigger=17,echo=27"},
        {"a05@/dev/gpiochip12,in=0,bias=up", "", "a05", NULL, NULL, "/dev/gpiochip12", ",in=0,bias=up"},
        {"a05@gpiochip1,bias=as-is,in=65535", "", "a05", NULL, NULL, "gpiochip1", ",in=65535,bias=as-is"},
        /* what is no chip is a tty */
        {"a16@gpiochip/x,baud=9600", "", "a16", NULL, NULL, "gpiochip/x", ",baud=9600"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        char expected[WORD] = "";
        char printed[WORD];
        if (!parse(&place, rows[i].word, word)) fail_msg("%s: %s", rows[i].word, message);
        assert_string_equal(place.name, rows[i].name);
        if (rows[i].name[0] != '\0') add(expected, rows[i].name, "=");
        add(expected, "", rows[i].model);
        add(expected, ":", rows[i].address);
        add(expected, ":", rows[i].mode);
        add(expected, "@", rows[i].port);
        add(expected, "", rows[i].keys);
        print(&place, printed);
        assert_string_equal(printed, expected);
        assert_string_equal(message, "");
    }
}

/* The numbers are those of other headers: hal.h, line.h and fathom_gpio.h. */
TEST(values_are_those_of_the_library)
{
    sensor_word_t place;
    char word[WORD];
    assert_true(parse(&place, "a16@x,baud=230400,parity=even,stop=1,rs485=on,echo=on", word));
    assert_int_equal(place.keys.value[KEY_BAUD], 230400);
    assert_int_equal(place.keys.value[KEY_PARITY], FATHOM_PARITY_EVEN);
    assert_int_equal(place.keys.value[KEY_STOP_BITS], 1);
    assert_int_equal(place.keys.value[KEY_RS485], 1);
    assert_int_equal(place.keys.value[KEY_ECHO], 2);
    assert_true(parse(&place, "a16@gpiochip0,in=5,bias=down", word));
    assert_int_equal(place.keys.value[KEY_IN], 5);
    assert_int_equal(place.keys.value[KEY_BIAS], 2);
    assert_true(parse(&place, "a16@gpiochip0,in=5,bias=off", word));
    assert_int_equal(place.keys.value[KEY_BIAS], 3);
}

/* ---- wrong ones ---- */

TEST(wrong_words_are_rejected_with_what_they_take)
{
    const struct {
        const char *word;
        const char *says;
    } rows[] = {
        {"", "unknown sensor ''. It is one of a16, a05, hps167s."},
        {"a17:1", "unknown sensor 'a17'. It is one of a16, a05, hps167s."},
        {"tank=", "unknown sensor ''."},
        {"a=b=a16", "unknown sensor 'b=a16'."},
        {"hps167s1234567890123456789012345678901234567890:1", "unknown sensor 'hps167s1234567890"},
        {"=a16", "'' is no name of a sensor."},
        {".a=a16", "'.a' is no name of a sensor. A name has at most 31 letters, digits, '-', '_' and '.'"},
        {"a b=a16", "'a b' is no name"},
        {"a:1=a16", "'a:1' is no name"},
        {"\xC3\xA4=a16", "is no name"},
        {"abcdefghijabcdefghijabcdefghijXY=a16", "is no name"},
        {"a16@", "a16@ names no port."},
        {"a16@,baud=9600", "a16@ names no port."},
        {"a16@x,", "a16@x: unknown key ''. It is one of baud, parity, stop, rs485, echo, trigger."},
        {"a16@x,baud=9600,,echo=on", "unknown key ''"},
        {"a16@x,=9600", "unknown key ''"},
        {"a16@x,Baud=9600", "unknown key 'Baud'. Did you mean baud?"},
        {"a16@x,bau=9600", "unknown key 'bau'. Did you mean baud?"},
        {"a16@x,in=1", "unknown key 'in'. It is one of baud, parity, stop, rs485, echo, trigger."},
        {"a16@gpiochip0,rs485=on", "unknown key 'rs485'. It is one of trigger, echo, in, bias, near."},
        {"a16@gpiochip0,17", "unknown key '17'."},
        {"a16@x,baud", "a16@x: baud has no value."},
        {"a16@x,baud=", "baud is ''. It takes 9600, 19200, 38400, 57600, 115200 or 230400."},
        {"a16@x,baud=9601", "baud is '9601'."},
        {"a16@x,baud=00000000000009600", "baud is '00000000000009600'."},
        {"a16@x,parity=even,parity=odd", "parity is given twice."},
        {"a16@x,parity=e", "parity is 'e'. It takes none, even or odd."},
        {"a16@x,stop=0", "stop is '0'. It takes a whole number from 1 to 2."},
        {"a16@x,rs485=yes", "rs485 is 'yes'. It takes off or on."},
        {"a16@x,echo=1", "echo is '1'. It takes auto, off or on."},
        {"a16@gpiochip0,echo=on", "echo is 'on'. It takes a whole number from 0 to 65535."},
        {"a16@gpiochip0,trigger=-1", "trigger is '-1'."},
        {"a16@gpiochip0,in=65536", "in is '65536'."},
        {"a16@gpiochip0,bias=", "bias is ''. It takes as-is, up, down or off."},
        {"hps167s@tcp:h,baud=9600", "a port over TCP has none."},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        if (parse(&place, rows[i].word, word)) fail_msg("'%s' is taken", rows[i].word);
        if (strstr(message, rows[i].says) == NULL) fail_msg("'%s': %s", rows[i].word, message);
    }
}

/* ---- any ---- */

static uint32_t seed;

static uint32_t any(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u; /* Numerical Recipes */
    return (seed >> 8) % below;
}

/* Parts of right ones and of none, so that some are right. */
static void make_word(char word[WORD])
{
    static const char *const parts[] = {
        "a16",    "a05",      "hps167s",        ":",       ":1",       ":modbus",  "@",        "@x",
        "@./tty", "@tcp:h:5", "@gpiochip0",     ",",       "=",        ",baud=",   ",baud=96", "00",
        "9600",   ",echo=on", ",parity=even",   ",stop=2", ",in=7",    ",bias=up", "tank=",    "t",
        ":dyp",   "0",        ",trigger=17",    ",echo=4", "\xFF",     "[",        "%s",       " ",
        "-",      "_.=",      "a16:1@/dev/tty", "a=a16@",  ",rs485=on"};
    const uint32_t count = 1 + any(6);
    word[0] = '\0';
    for (uint32_t i = 0; i != count; i++) add(word, "", parts[any(sizeof parts / sizeof parts[0])]);
    if (any(8) == 0) word[any((uint32_t)strlen(word))] = (char)(1 + any(255));
}

TEST(a_hundred_thousand_words_do_no_harm_and_those_that_are_taken_are_the_same_again)
{
    uint32_t taken = 0;
    seed = 20261123;
    for (uint32_t i = 0; i != 100000; i++) {
        sensor_word_t first;
        sensor_word_t second;
        char text[WORD];
        char word[WORD];
        char printed[WORD];
        char again[WORD];
        make_word(text);
        if (!parse(&first, text, word)) {
            assert_memory_equal(message, "fathom read: ", 13);
            continue;
        }
        taken++;
        print(&first, printed);
        if (!parse(&second, printed, word)) fail_msg("'%s' was '%s': %s", printed, text, message);
        print(&second, again);
        assert_string_equal(again, printed);
        assert_string_equal(first.name, second.name);
        assert_ptr_equal(first.model, second.model);
        assert_memory_equal(&first.keys, &second.keys, sizeof first.keys);
    }
    assert_in_range(taken, 1000, 99000);
}
