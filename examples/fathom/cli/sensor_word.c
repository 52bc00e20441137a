/* SPDX-License-Identifier: MIT */
#include "cli/sensor_word.h"

#include <stdio.h>
#include <string.h>

#include "output/words.h"

/* ---- keys of ports ---- */

#define KEY(key) .at = offsetof(port_keys_t, value[key]), .size = sizeof(uint32_t), HAS(port_keys_t, has[key])
#define BAUDS    "9600 19200 38400 57600 115200 230400"

/* "gpiochip0/17": stores the number of the chip above that of the line. */
static bool parse_chip_line(const char *text, void *member)
{
    static const char name[] = "gpiochip";
    char chip[sizeof "65535"];
    uint32_t number = 0;
    uint32_t line = 0;
    const char *const slash = strchr(text, '/');
    if (slash == NULL || strncmp(text, name, sizeof name - 1) != 0) return false;
    text += sizeof name - 1;
    if (slash < text || (size_t)(slash - text) >= sizeof chip) return false;
    (void)snprintf(chip, sizeof chip, "%.*s", (int)(slash - text), text);
    if (!number_parse(chip, 0, UINT16_MAX, &number) || !number_parse(slash + 1, 0, UINT16_MAX, &line))
        return false;
    *(uint32_t *)member = number << 16 | line;
    return true;
}

/* The words of a choice stand in the order of its enumeration. */
const option_t serial_keys[] = {
    {"baud", "N", "Baud rate", KIND_ONE_OF, .words = BAUDS, KEY(KEY_BAUD)},
    {"parity", "P", "Parity", KIND_CHOICE, .words = "none even odd", KEY(KEY_PARITY)},
    {"stop", "N", "Stop bits, 1 or 2", KIND_NUMBER, .min = 1, .max = 2, KEY(KEY_STOP_BITS)},
    {"rs485", "on|off", "Transceiver switched by the kernel's driver", KIND_CHOICE, .words = "off on",
     KEY(KEY_RS485)},
    {"echo", "E", "Echo of the adapter", KIND_CHOICE, .words = "auto off on", KEY(KEY_ECHO)},
    {"trigger", "CHIP/LINE", "GPIO line to the sensor's RX, instead of a break", KIND_CUSTOM,
     .parse = parse_chip_line, .takes = "a chip and a line, such as gpiochip0/17", KEY(KEY_TRIGGER)},
    {.name = NULL},
};

const option_t chip_keys[] = {
    {"trigger", "LINE", "Line to the sensor's RX, an output", KIND_NUMBER, .max = UINT16_MAX,
     KEY(KEY_TRIGGER)},
    {"echo", "LINE", "Line from the sensor's TX, with pulses", KIND_NUMBER, .max = UINT16_MAX,
     KEY(KEY_PULSE)},
    {"in", "LINE", "Line of the switch or of the relay contact", KIND_NUMBER, .max = UINT16_MAX, KEY(KEY_IN)},
    {"bias", "BIAS", "Pull resistor of the inputs", KIND_CHOICE, .words = "as-is up down off", KEY(KEY_BIAS)},
    {"near", "LEVEL", "Level that means near", KIND_CHOICE, .min = PINS_NEAR_LOW, .words = "low high",
     KEY(KEY_NEAR)},
    {.name = NULL},
};

const char *port_key_name(port_key_t key)
{
    return key < KEY_TRIGGER ? serial_keys[key].name : chip_keys[key - KEY_TRIGGER].name;
}

bool port_path_has_keys(const char *path)
{
    const option_table_t tables[] = {{serial_keys, 0}, {chip_keys, 0}, {NULL, 0}};
    const char *const comma = strchr(path, ',');
    option_walk_t key;
    if (comma == NULL) return false;
    const size_t length = strcspn(comma + 1, "=");
    return comma[1 + length] == '=' && option_find(&key, tables, comma + 1, length);
}

/* ---- models and modes ---- */

const model_t *model_word(const char *name, const origin_t *origin)
{
    char known[80] = "";
    nearest_t nearest = {.word = name};
    for (size_t i = 0; i != model_count; i++) {
        if (strcmp(name, models[i].name) == 0) return &models[i];
        nearest_try(&nearest, models[i].name);
        list_add(known, sizeof known, models[i].name);
    }
    (void)reject_unknown(origin, "sensor", "", &nearest, known);
    return NULL;
}

const model_mode_t *mode_word(const model_t *model, const char *name, const origin_t *origin)
{
    char known[80] = "";
    char what[80];
    nearest_t nearest = {.word = name};
    for (const model_mode_t *mode = model->modes; mode != model->modes + MODEL_MODES && mode->name != NULL;
         mode++) {
        if (strcmp(name, mode->name) == 0) return mode;
        nearest_try(&nearest, mode->name);
        list_add(known, sizeof known, mode->name);
    }
    (void)snprintf(what, sizeof what, "mode of %s", model->name);
    (void)reject_unknown(origin, what, "", &nearest, known);
    return NULL;
}

/* ---- the word ---- */

bool sensor_name_is_good(const char *text, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    if (length == 0 || length >= SENSOR_NAME_SIZE || strchr("-_.", text[0]) != NULL) return false;
    return strspn(text, letters) >= length;
}

static bool parse_name(sensor_word_t *sensor, const char *word, size_t length, const origin_t *origin)
{
    if (sensor_name_is_good(word, length)) {
        memcpy(sensor->name, word, length);
        return true;
    }
    return reject(
        origin,
        "'%.*s' is no name of a sensor. A name has at most %d letters, digits, '-', '_' and '.', and "
        "begins with a letter or a digit, such as tank-1=a16.",
        (int)length, word, SENSOR_NAME_SIZE - 1);
}

static bool is_letter(char character)
{
    return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
}

/* model[:ADDRESS][:MODE] */
static bool parse_sensor(sensor_word_t *sensor, const char *text, size_t length, const origin_t *origin)
{
    const bool is_short = length < sizeof sensor->parts; /* no sensor has a longer name */
    memcpy(sensor->parts, text, is_short ? length : sizeof sensor->parts - 1);
    char *const first = is_short ? strchr(sensor->parts, ':') : NULL;
    if (first != NULL) {
        char *const second = is_letter(first[1]) ? first : strchr(first + 1, ':');
        if (second != first) sensor->address = first + 1;
        if (second != NULL) {
            sensor->mode = second + 1;
            *second = '\0';
        }
        *first = '\0';
    }
    sensor->model = model_word(sensor->parts, origin);
    return sensor->model != NULL;
}

static bool parse_port(sensor_word_t *sensor, char *port, const origin_t *origin)
{
    origin_t its = *origin;
    char *const comma = strchr(port, ',');
    if (comma != NULL) *comma = '\0';
    sensor->port = port;
    if (port[0] == '\0')
        return reject(origin, "%s names no port. Write the port behind @, such as @/dev/ttyUSB0.",
                      sensor->word);
    if (comma == NULL) return true;
    if (port_path_has_gateway(port))
        return reject(origin, "%s has keys, but a port over TCP has none. Set the line in the gateway.",
                      sensor->word);
    its.within = sensor->word;
    return option_set_keys(port_path_has_pins(port) ? chip_keys : serial_keys, comma + 1, &sensor->keys,
                           &its);
}

bool sensor_word_parse(sensor_word_t *sensor, char *word, const origin_t *origin)
{
    char *const at = strchr(word, '@');
    const size_t length = at != NULL ? (size_t)(at - word) : strlen(word);
    const char *const equals = memchr(word, '=', length);
    const char *const text = equals != NULL ? equals + 1 : word;
    memset(sensor, 0, sizeof *sensor);
    sensor->word = word;
    if (equals != NULL && !parse_name(sensor, word, (size_t)(equals - word), origin)) return false;
    return parse_sensor(sensor, text, length - (size_t)(text - word), origin) &&
           (at == NULL || parse_port(sensor, at + 1, origin));
}

bool sensor_word_address(const sensor_word_t *sensor, const model_mode_t *mode, uint8_t *address,
                         const origin_t *origin)
{
    const model_t *const model = sensor->model;
    const uint8_t least = model_least_address(model, mode);
    uint32_t number = *address;
    if (sensor->address == NULL || sensor->address[0] == '\0') return true;
    if (!number_parse(sensor->address, least, model->max_address, &number))
        return reject(origin, "'%s' is no address of %s. It takes a whole number from %u to %u.",
                      sensor->address, model->name, least, model->max_address);
    *address = (uint8_t)number;
    return true;
}
