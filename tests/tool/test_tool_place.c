/* SPDX-License-Identifier: MIT */
/* The word by which a user names a sensor and where it is: what comes of right ones, and what is said of wrong ones. Any
 * word is tried by tests/verify/fuzz. */
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

/* Each is printed as it was written, with its keys in the order of port_key_t. */
TEST(right_words_have_their_parts)
{
    static const struct {
        const char *word;
        const char *address;
        const char *mode;
    } rows[] = {
        {"a16", NULL, NULL},
        {"a16:3", "3", NULL},
        {"a16:modbus", NULL, "modbus"},
        {"a16::modbus", "", "modbus"},
        {"a16:", "", NULL},
        {"a05:2:dyp", "2", "dyp"},
        {"a16:x", NULL, "x"}, /* the address and the mode are parsed with the sensor */
        {"a16:1x", "1x", NULL},
        {"a16:1:", "1", ""},
        {"a16:modbus:1", NULL, "modbus:1"},
        {"tank=hps167s:7", "7", NULL},
        {"7=a16", NULL, NULL},
        {"A-z_9.=a16", NULL, NULL},
        {"abcdefghijabcdefghijabcdefghijX=a16", NULL, NULL},
        {"a16@/dev/ttyUSB0", NULL, NULL},
        {"a16@./a=b@c:1", NULL, NULL},
        {"hps167s:8@tcp:10.0.0.7", "8", NULL},
        {"hps167s@tcp:[::1]:1502", NULL, NULL},
        {"a=a16:1:modbus@x,baud=57600,parity=odd,stop=2,rs485=on,echo=off", "1", "modbus"},
        {"a16@x,rs485=off,echo=auto", NULL, NULL},
        {"a16@gpiochip0,trigger=17,echo=27", NULL, NULL},
        {"a05@/dev/gpiochip12,in=0,bias=up", NULL, NULL},
        {"a05@gpiochip1,in=65535,bias=as-is", NULL, NULL},
        {"a16@gpiochip/x,baud=9600", NULL, NULL}, /* what is no chip is a tty */
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        char printed[WORD];
        if (!parse(&place, rows[i].word, word)) fail_msg("%s: %s", rows[i].word, message);
        print(&place, printed);
        assert_string_equal(printed, rows[i].word);
        assert_string_equal(message, "");
        assert_true((place.address == NULL) == (rows[i].address == NULL));
        assert_true((place.mode == NULL) == (rows[i].mode == NULL));
        if (place.address != NULL) assert_string_equal(place.address, rows[i].address);
        if (place.mode != NULL) assert_string_equal(place.mode, rows[i].mode);
    }
}

/* The numbers are those of other headers: hal.h, line.h and fathom_gpio.h. */
TEST(values_are_those_of_the_library)
{
    static const struct {
        const char *word;
        port_key_t key;
        uint32_t value;
    } rows[] = {
        {"a16@x,baud=230400", KEY_BAUD, 230400},  {"a16@x,parity=even", KEY_PARITY, FATHOM_PARITY_EVEN},
        {"a16@x,stop=1", KEY_STOP_BITS, 1},       {"a16@x,rs485=on", KEY_RS485, 1},
        {"a16@x,echo=on", KEY_ECHO, 2},           {"a16@gpiochip0,in=5", KEY_IN, 5},
        {"a16@gpiochip0,bias=down", KEY_BIAS, 2}, {"a16@gpiochip0,bias=off", KEY_BIAS, 3}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        sensor_word_t place;
        char word[WORD];
        assert_true(parse(&place, rows[i].word, word));
        assert_int_equal(place.keys.value[rows[i].key], rows[i].value);
    }
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
