/* SPDX-License-Identifier: MIT */
#include "cli/rows.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "output/words.h"

/* ---- keys of ports ---- */

#define KEY(key) .at = offsetof(port_keys_t, value[key]), .size = sizeof(uint32_t), HAS(port_keys_t, has[key])

/* "gpiochip0/17": stores the number of the chip above that of the line. */
static bool parse_chip_line(const char *text, void *member)
{
    static const char name[] = "gpiochip";
    char chip[32];
    uint32_t number = 0;
    uint32_t line = 0;
    const char *const rest = next_word(text, '/', chip, sizeof chip);
    if (rest == NULL || strncmp(chip, name, sizeof name - 1) != 0 ||
        !number_parse(chip + sizeof name - 1, 0, UINT16_MAX, &number) ||
        !number_parse(rest, 0, UINT16_MAX, &line))
        return false;
    *(uint32_t *)member = number << 16 | line;
    return true;
}

/* The words of a choice stand in the order of its enumeration. */
const option_t serial_keys[] = {
    {"baud", "N", "Baud rate", KIND_ONE_OF, .words = PORT_BAUDS, KEY(KEY_BAUD)},
    {"parity", "P", "Parity", KIND_CHOICE, .words = PORT_PARITIES, KEY(KEY_PARITY)},
    {"stop", "N", "Stop bits, 1 or 2", KIND_NUMBER, .min = 1, .max = 2, KEY(KEY_STOP_BITS)},
    {"rs485", "on|off", "Transceiver switched by the kernel's driver", KIND_CHOICE, .words = "off on",
     KEY(KEY_RS485)},
    {"echo", "E", "Echo of the adapter", KIND_CHOICE, .words = "auto off on", KEY(KEY_ECHO)},
    {"pieces", "on|off", "Responses in pieces, with pauses", KIND_CHOICE, .words = "off on", KEY(KEY_PIECES)},
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

/* Does a key follow in it behind a comma? Then it was meant to stand behind a sensor. */
static bool path_has_keys(const char *path)
{
    const option_table_t tables[] = {{serial_keys, 0}, {chip_keys, 0}, {NULL, 0}};
    const char *const comma = strchr(path, ',');
    char key[16];
    option_walk_t walk;
    return comma != NULL && next_word(comma + 1, '=', key, sizeof key) != NULL &&
           option_find(&walk, tables, key);
}

/* ---- models and modes ---- */

/* Lists the names that begin with this one, and no aliases, at most SIMILAR: "one of a02yyuw, a02yytw". */
enum { SIMILAR = 6, SIMILAR_TEXT = 128 };
static unsigned list_similar(char text[SIMILAR_TEXT], const char *begin)
{
    const char *other = NULL;
    unsigned count = 0;
    for (size_t n = 0; count != SIMILAR && (other = model_relative(n)) != NULL; n++) {
        if (strncasecmp(other, begin, strlen(begin)) != 0 || strcmp(model_find(other)->name, other) != 0)
            continue;
        (void)snprintf(text + strlen(text), SIMILAR_TEXT - strlen(text), "%s%s",
                       count++ != 0 ? ", " : "one of ", other);
    }
    return count;
}

const model_t *model_word(const char *name, const origin_t *origin)
{
    nearest_t nearest = {.word = name};
    char similar[SIMILAR_TEXT] = "";
    const model_t *const model = model_find(name);
    const char *other = NULL;
    const char *const why = model_unreadable(name);
    if (model != NULL) return model;
    if (why != NULL) {
        (void)reject(origin, "a %s cannot be read: %s. 'fathom models' lists what can.", name, why);
        return NULL;
    }
    for (size_t n = 0; (other = model_relative(n)) != NULL; n++) nearest_try(&nearest, other);
    const char *const begin = strncasecmp(name, "DYP-", 4) == 0 ? name + 4 : name; /* without the maker */
    if (begin[0] != '\0' && list_similar(similar, begin) > 1) nearest = (nearest_t){name, similar, 0, ""};
    nearest.known[0] = '\0';
    for (size_t i = 0; i != model_count; i++) nearest_try(&nearest, models[i].name);
    list_add(nearest.known, sizeof nearest.known, "or a name of 'fathom models'");
    if (name[0] != '\0' && strspn(name, "0123456789") == strlen(name))
        (void)reject(
            origin,
            "unknown sensor '%s'. An address stands behind its sensor and a colon, such as hps167s:%s.", name,
            name);
    else
        (void)reject_unknown(origin, "sensor", "", &nearest, true);
    return NULL;
}

static const model_mode_t *find_mode(const model_t *model, nearest_t *nearest)
{
    for (const model_mode_t *mode = model->modes; mode != model->modes + MODEL_MODES && mode->name != NULL;
         mode++) {
        if (strcmp(nearest->word, mode->name) == 0) return mode;
        nearest_try(nearest, mode->name);
    }
    return NULL;
}

const model_mode_t *mode_word(const model_t *model, const char *name, const origin_t *origin)
{
    char what[80];
    nearest_t nearest = {.word = name};
    const model_mode_t *const mode = find_mode(model, &nearest);
    (void)snprintf(what, sizeof what, "mode of %s", model->name);
    if (mode == NULL) (void)reject_unknown(origin, what, "", &nearest, true);
    return mode;
}

/* ---- the word ---- */

bool sensor_name_is_good(const char *text, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    if (length == 0 || length >= SENSOR_NAME_SIZE || strchr("-_.", text[0]) != NULL) return false;
    return strspn(text, letters) >= length;
}

/* model[:ADDRESS][:MODE] */
static bool parse_sensor(sensor_word_t *sensor, const char *text, size_t length)
{
    const bool is_short = length < sizeof sensor->parts; /* no sensor has a longer name */
    memcpy(sensor->parts, text, is_short ? length : sizeof sensor->parts - 1);
    char *const first = is_short ? strchr(sensor->parts, ':') : NULL;
    if (first != NULL) {
        char *const second = isalpha((unsigned char)first[1]) ? first : strchr(first + 1, ':');
        if (second != first) sensor->address = first + 1;
        if (second != NULL) {
            sensor->mode = second + 1;
            *second = '\0';
        }
        *first = '\0';
    }
    sensor->model = model_word(sensor->parts, &sensor->origin);
    return sensor->model != NULL;
}

static bool parse_port(sensor_word_t *sensor, char *port)
{
    origin_t its = sensor->origin;
    char *const comma = strchr(port, ',');
    if (comma != NULL) *comma = '\0';
    sensor->port = port;
    if (port[0] == '\0')
        return reject(&its, "%s names no port. Write the port behind @, such as @/dev/ttyUSB0.",
                      sensor->word);
    if (comma == NULL) return true;
    if (port_kind(port) == PORT_GATEWAY || port_kind(port) == PORT_RAW)
        return reject(&its, "%s has keys, but a port over TCP has none. Set the line in the gateway.",
                      sensor->word);
    its.within = sensor->word;
    return option_set_keys(port_kind(port) == PORT_PINS ? chip_keys : serial_keys, comma + 1, &sensor->keys,
                           &its);
}

bool sensor_word_parse(sensor_word_t *sensor, char *word, const origin_t *origin)
{
    char *const at = strchr(word, '@');
    const size_t length = at != NULL ? (size_t)(at - word) : strlen(word);
    const char *const equals = memchr(word, '=', length);
    const size_t name_length = equals != NULL ? (size_t)(equals - word) : 0;
    const size_t begin = equals != NULL ? name_length + 1 : 0;
    *sensor = (sensor_word_t){.origin = *origin, .word = word};
    if (equals != NULL && !sensor_name_is_good(word, name_length))
        return reject(origin,
                      "'%.*s' is no name of a sensor. A name has at most %d letters, digits, '-', '_' and "
                      "'.', and begins with a letter or a digit, such as tank-1=a16.",
                      (int)name_length, word, SENSOR_NAME_SIZE - 1);
    memcpy(sensor->name, word, name_length);
    return parse_sensor(sensor, word + begin, length - begin) && (at == NULL || parse_port(sensor, at + 1));
}

bool sensor_word_address(const sensor_word_t *word, const model_mode_t *mode, uint8_t *address)
{
    const model_t *const model = word->model;
    const uint8_t least = model_least_address(model, mode);
    uint32_t number = *address;
    if (word->address == NULL || word->address[0] == '\0') return true;
    if (!number_parse(word->address, least, model->max_address, &number))
        return reject(&word->origin, "'%s' is no address of %s. It takes a whole number from %u to %u.",
                      word->address, model->name, least, model->max_address);
    *address = (uint8_t)number;
    return true;
}

/* ---- the port of a sensor ---- */

bool pins_example(const model_mode_t *mode, const char *chip, char text[PORT_EXAMPLE])
{
    static const uint8_t examples[] = {17, 27, 5};
    (void)snprintf(text, PORT_EXAMPLE, "%.20s", chip);
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const size_t length = strlen(text);
        if ((mode->pins >> i & 1u) != 0)
            (void)snprintf(text + length, PORT_EXAMPLE - length, ",%s=%u", port_key_name(KEY_TRIGGER + i),
                           examples[i]);
    }
    return mode->pins != 0;
}

/* path: of all sensors that have none of their own; NULL: not given. */
static bool check_common_port(const sensor_word_t *word, const char *path)
{
    char example[PORT_EXAMPLE];
    nearest_t nearest = {.word = word->mode};
    const model_mode_t *const mode =
        word->mode != NULL ? find_mode(word->model, &nearest) : word->model->modes;
    if (path != NULL && !path_has_keys(path)) return true;
    if (path != NULL)
        return reject(&word->origin, "--port takes no keys. Write them behind the sensor: %s@%s.", word->word,
                      path);
    if (mode != NULL && pins_example(mode, "gpiochip0", example))
        return reject(&word->origin, "the GPIO lines are missing. Write them behind the sensor: %s@%s.",
                      word->word, example);
    return reject(&word->origin,
                  "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
}

/* Puts the sensor on the line of its port, and adds its keys. A chip has a line for each sensor. */
static bool set_port(site_t *site, sensor_t *sensor, const sensor_word_t *word, const char *path)
{
    if (word->port == NULL && !check_common_port(word, path)) return false;
    if (word->port != NULL) path = word->port;
    const bool has_pins = port_kind(path) == PORT_PINS;
    line_t *line = site->lines;
    while (line != NULL && (has_pins || !port_is_same(line->settings.path, path))) line = line->next;
    if (line == NULL) line = site_add_line(site, path);
    line_add(line, sensor);
    port_keys_t *const keys = &line->settings.keys;
    for (port_key_t key = 0; key != PORT_KEYS; key++) {
        if (!word->keys.has[key]) continue;
        if (keys->has[key] && keys->value[key] != word->keys.value[key])
            return reject(&word->origin,
                          "%s: another sensor at this port has another %s=. Write it at one of them.",
                          word->word, port_key_name(key));
        keys->value[key] = word->keys.value[key];
        keys->has[key] = true;
    }
    return true;
}

static bool suits_chip(const sensor_t *sensor, const origin_t *origin)
{
    const port_options_t *const port = sensor->port;
    const model_mode_t *const mode = sensor->mode;
    const char *const model = sensor->model->name;
    char example[PORT_EXAMPLE];
    (void)pins_example(mode, port->path, example);
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const bool is_given = port->keys.has[KEY_TRIGGER + i];
        const bool is_needed = (mode->pins >> i & 1u) != 0;
        const char *const name = port_key_name(KEY_TRIGGER + i);
        if (is_needed && !is_given)
            return reject(origin, "%s in mode %s needs %s=, such as @%s.", model, mode->name, name, example);
        if (!is_needed && is_given)
            return reject(origin, "%s in mode %s has no %s=. Write it such as @%s.", model, mode->name, name,
                          example);
    }
    if (!mode->is_contact && port->keys.has[KEY_NEAR])
        return reject(origin, "%s in mode %s reports distances and has no near=. Write it such as @%s.",
                      model, mode->name, example);
    return true;
}

/* Can a sensor be read in its mode at this port? */
static bool suits_port(const sensor_t *sensor, const origin_t *origin)
{
    const port_options_t *const port = sensor->port;
    const model_mode_t *const mode = sensor->mode;
    const char *const model = sensor->model->name;
    char example[PORT_EXAMPLE];
    if (port->kind == PORT_GATEWAY || port->kind == PORT_RAW) {
        tcp_address_t address;
        const char *const wrong = tcp_parse(port->path, &address);
        if (wrong != NULL) return reject(origin, "%s: %s.", port->path, wrong);
        if (port->kind == PORT_RAW && mode->is_triggered && !mode_starts_by_byte(mode))
            return reject(origin, "%s in mode %s needs a serial port, which can send a break.", model,
                          mode->name);
        if (mode->is_modbus || (port->kind == PORT_RAW && mode->pins == 0)) return true;
        if (model_mode_of(sensor->model, NULL)->name == NULL)
            return reject(origin, "%s in mode %s needs %s, and has no Modbus.", model, mode->name,
                          mode->pins != 0 ? "GPIO lines"
                                          : "a serial port or a converter that passes raw bytes, "
                                            "rtu-tcp:HOST:PORT");
        return reject(
            origin,
            "%s in mode %s needs a serial port. Over TCP, use Modbus: %s:modbus, or a converter that "
            "passes raw bytes: rtu-tcp:HOST:PORT.",
            model, mode->name, model);
    }
    const bool has_pins = pins_example(mode, "gpiochip0", example);
    if (port->kind != PORT_PINS && port->keys.has[KEY_TRIGGER] && (mode->may_pins & MODEL_PIN_TRIGGER) == 0)
        return reject(origin, "%s in mode %s has no trigger=. Leave it out.", model, mode->name);
    if (port->kind == PORT_PINS && !has_pins)
        return reject(origin, "%s in mode %s needs a serial port, and %s is a GPIO chip.", model, mode->name,
                      port->path);
    if (port->kind != PORT_PINS && has_pins)
        return reject(origin, "%s in mode %s needs GPIO lines, such as %s:%s@%s.", model, mode->name, model,
                      mode->name, example);
    return !has_pins || suits_chip(sensor, origin);
}

/* The kernel gives a line to one user only. `other` may be the same port. */
static bool suit_pins(const port_options_t *port, const port_options_t *other, const origin_t *origin)
{
    for (port_key_t one = KEY_TRIGGER; one <= KEY_IN; one++)
        for (port_key_t two = KEY_TRIGGER; two <= KEY_IN; two++) {
            const bool is_one = port == other && one >= two;
            if (is_one || !port->keys.has[one] || !other->keys.has[two] ||
                port->keys.value[one] != other->keys.value[two])
                continue;
            return reject(origin, "line %u of %s is used twice, as %s= and as %s=. Each needs its own line.",
                          (unsigned)port->keys.value[one], port->path, port_key_name(one),
                          port_key_name(two));
        }
    return true;
}

bool line_options_suit(const port_keys_t *options, const char *path, const origin_t *origin)
{
    port_key_t key = 0;
    if (port_kind(path) != PORT_GATEWAY && port_kind(path) != PORT_RAW) return true;
    while (key != PORT_KEYS && !options->has[key]) key++;
    return key == PORT_KEYS ||
           reject(
               origin,
               "%s has no line settings: set the line in the gateway, and leave options of a serial port out "
               "(--baud, --parity, --stop-bits, --rs485, --echo, --pieces).",
               path);
}

/* Takes the keys and the options of each port. A line is opened at the settings of its slowest sensor. */
static bool set_lines(const site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *words)
{
    bool has_serial = false;
    for (line_t *line = site->lines; line != NULL; line = line->next) {
        port_options_take(&line->settings, &defaults->keys);
        if (line->settings.kind == PORT_SERIAL) has_serial = true;
    }
    if (!has_serial && !line_options_suit(&defaults->keys, site->lines->settings.path, &words[0].origin))
        return false;
    for (size_t i = 0; i != site->sensor_count; i++) {
        sensor_t *const sensor = site->sensors[i];
        port_options_t *const port = sensor->port;
        sensor->line = sensor->model->line;
        port_options_line(port, &sensor->line);
        port->pins.idles_low = mode_idles_low(sensor->mode);
        if (port->line.baud == 0 || sensor->line.baud < port->line.baud) port->line = sensor->line;
    }
    for (size_t i = 0; i != site->sensor_count; i++) {
        const fathom_line_settings_t *const its = &site->sensors[i]->line;
        port_options_t *const port = site->sensors[i]->port;
        if (its->baud != port->line.baud || its->parity != port->line.parity) port->has_mixed_lines = true;
        for (const line_t *line = site->lines; port->kind == PORT_PINS && line != NULL; line = line->next)
            if (line->settings.kind == PORT_PINS &&
                strcmp(last_part(port->path), last_part(line->settings.path)) == 0 &&
                !suit_pins(port, &line->settings, &words[i].origin))
                return false;
    }
    return true;
}

/* ---- sensors ---- */

/* Without a MODE a sensor is read in its first one; with an ADDRESS, or if sends_requests, in the first that sends
 * requests; each sensor has one. */
static bool set_mode(sensor_t *sensor, const sensor_word_t *word, const char *mode, bool sends_requests)
{
    if (word->mode != NULL) mode = word->mode;
    sensor->mode = sensor->model->modes;
    if (mode != NULL)
        sensor->mode = mode_word(sensor->model, mode, &word->origin);
    else if (sends_requests || word->address != NULL)
        while (sensor->mode->name != NULL && !mode_is_asked(sensor->mode)) sensor->mode++;
    if (sensor->mode == NULL || sensor->mode->name != NULL) return sensor->mode != NULL;
    return reject(&word->origin,
                  "%s receives no requests, so it has no address and no settings, and cannot share a line. "
                  "Read it alone: fathom read %s.",
                  sensor->model->name, sensor->model->name);
}

static bool set_sensor(sensor_t *sensor, const sensor_word_t *word, const sensor_defaults_t *defaults,
                       bool sends_requests)
{
    const model_t *const model = word->model;
    const origin_t *const origin = &word->origin;
    if (word->address != NULL && defaults->has_address)
        return reject(origin, "'%s' has an address already. Leave --address out.", word->word);
    if (word->mode != NULL && defaults->mode != NULL)
        return reject(origin, "'%s' has a mode already. Leave --mode out.", word->word);
    if (model == NULL) return false; /* sensor_word_parse() has rejected the word */
    sensor->model = model;
    if (!set_mode(sensor, word, defaults->mode, sends_requests)) return false;
    const uint8_t least = model_least_address(model, sensor->mode);
    sensor->address = defaults->has_address ? (uint8_t)defaults->address : FACTORY_ADDRESS;
    if (defaults->has_address && (defaults->address < least || defaults->address > model->max_address))
        return reject(origin, "--address is %u. %s takes a whole number from %u to %u.",
                      (unsigned)defaults->address, model->name, least, model->max_address);
    if (!sensor_word_address(word, sensor->mode, &sensor->address)) return false;
    sensor->has_own_name = word->name[0] != '\0';
    (void)snprintf(sensor->name, sizeof sensor->name, "%s", word->name);
    sensor_set_name(sensor);
    return true;
}

/* has_settings: each sensor is read at its own line settings; not so over TCP. */
static bool suit_each_other(const sensor_t *one, const sensor_t *other, bool has_settings,
                            const origin_t *origin)
{
    const bool is_same_line = one->line.baud == other->line.baud && one->line.parity == other->line.parity;
    if (one->address == other->address && (!has_settings || is_same_line))
        return reject(origin, "%s and %s have the same address, so both would respond at once.", one->name,
                      other->name);
    /* One flipped bit in a response 55 AA gives its address to every other A05 on the line. */
    if (one->model == other->model && (one->mode->can_move_others || other->mode->can_move_others))
        return reject(origin,
                      "a damaged response in mode dyp can change the address of another %s on the line. Use "
                      "Modbus for all of them, such as %s:modbus.",
                      one->model->name, one->mode->can_move_others ? one->name : other->name);
    return true;
}

/* Can sensor `i` be read together with those before it? */
static bool suits_line(const site_t *site, size_t i, const origin_t *origin)
{
    const sensor_t *const sensor = site->sensors[i];
    const port_options_t *const port = sensor->port;
    const char *const model = sensor->model->name;
    if (port->station_count > MAX_SENSORS_ON_A_LINE)
        return reject(origin, "%s has %zu sensors. A line has at most %d.", port->path, port->station_count,
                      MAX_SENSORS_ON_A_LINE);
    if (port->station_count > 1 && !mode_is_asked(sensor->mode))
        return reject(origin,
                      "%s in mode %s sends automatically and cannot share a line. Use a mode that sends "
                      "requests, such as %s:%u:modbus.",
                      model, sensor->mode->name, model, sensor->address);
    for (size_t j = 0; j != i; j++)
        if (site->sensors[j]->port == port &&
            !suit_each_other(site->sensors[j], sensor, port_has_settings(port->kind), origin))
            return false;
    return true;
}

/* ---- names ---- */

/* Adds the port to a name that the user did not choose. Characters that JSON or CSV would have to quote become "_". */
static void add_port(sensor_t *sensor)
{
    const size_t length = strlen(sensor->name);
    (void)snprintf(sensor->name + length, sizeof sensor->name - length, "@%s", last_part(sensor->port->path));
    for (char *at = sensor->name; *at != '\0'; at++)
        if (strchr("\"\\,", *at) != NULL || (unsigned char)*at < ' ') *at = '_';
}

/* Sensors at different ports with the same name, which the user did not choose, get their ports as a part of it. */
static bool set_names(const site_t *site, const sensor_word_t *words)
{
    bool is_ambiguous[MAX_SENSORS] = {false};
    sensor_t *const *const sensors = site->sensors;
    for (size_t i = 0; i != site->sensor_count; i++)
        for (size_t j = 0; j != site->sensor_count && !sensors[i]->has_own_name; j++)
            if (sensors[i]->port != sensors[j]->port && strcmp(sensors[i]->name, sensors[j]->name) == 0)
                is_ambiguous[i] = true;
    for (size_t i = 0; i != site->sensor_count; i++)
        if (is_ambiguous[i]) add_port(sensors[i]);
    for (size_t i = 0; i != site->sensor_count; i++)
        for (size_t j = 0; j != i; j++) {
            const sensor_t *const sensor = sensors[i];
            if (strcmp(sensors[j]->name, sensor->name) != 0) continue;
            if (words[i].origin.file != NULL)
                return reject(&words[i].origin,
                              "two sensors have the name %s, in line %u too. Change name: of one of them.",
                              sensor->name, words[j].origin.line);
            return reject(&words[i].origin,
                          "two sensors have the name %s. Give each its own name, such as one=%s.",
                          sensor->name, sensor->model->name);
        }
    return true;
}

/* ---- all of them ---- */

/* In the order in which a user corrects it. */
bool sensors_add(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *words, int count)
{
    for (int i = 0; i != count; i++)
        if (!set_port(site, site_add_sensor(site), &words[i], defaults->path)) return false;
    for (int i = 0; i != count; i++) {
        sensor_t *const sensor = site->sensors[i];
        const bool sends_requests = site->asks_all || sensor->port->station_count > 1;
        if (!set_sensor(sensor, &words[i], defaults, sends_requests)) return false;
    }
    if (!set_lines(site, defaults, words)) return false;
    for (int i = 0; i != count; i++)
        if (!suits_line(site, (size_t)i, &words[i].origin)) return false;
    if (!set_names(site, words)) return false;
    for (int i = 0; i != count; i++)
        if (!suits_port(site->sensors[i], &words[i].origin)) return false;
    return true;
}

bool sensor_words(site_t *site, const sensor_defaults_t *defaults, char **words, int count,
                  const origin_t *origin)
{
    static sensor_word_t sensors[MAX_SENSORS];
    if (count == 0) return reject(origin, "no sensor is named. Name one of a16, a05 and hps167s.");
    if (count > MAX_SENSORS)
        return reject(origin, "%d sensors are named. At most %d can be.", count, MAX_SENSORS);
    if (count > 1 && (defaults->has_address || defaults->mode != NULL))
        return reject(origin, "with several sensors, write --address and --mode behind each, such as "
                              "a16:1:modbus.");
    for (int i = 0; i != count; i++)
        if (!sensor_word_parse(&sensors[i], words[i], origin)) return false;
    return sensors_add(site, defaults, sensors, count);
}
