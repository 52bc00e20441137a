/* SPDX-License-Identifier: MIT */
#include "cli/port_options.h"

#include <string.h>
#include <sys/stat.h>

#include "cli/command.h"
#include "cli/options.h"
#include "ports/line_text.h"
#include "ports/tcp_address.h"

port_kind_t port_kind(const char *path, size_t length)
{
    static const char chip[] = "gpiochip";
    size_t last = length;
    while (last != 0 && path[last - 1] != '/') last--;
    if (tcp_names(path)) return PORT_TCP;
    return strncmp(path + last, chip, sizeof chip - 1) == 0 ? PORT_CHIP : PORT_TTY;
}

const char *port_last_part(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

bool port_is_same(const char *one, const char *other)
{
    struct stat first;
    struct stat second;
    if (strcmp(one, other) == 0) return true;
    return stat(one, &first) == 0 && stat(other, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

/* ---- values ---- */

static bool take_word(const char *const *words, const char *text, uint32_t *value)
{
    for (uint32_t i = 0; words[i] != NULL; i++) {
        if (strcmp(text, words[i]) != 0) continue;
        *value = i;
        return true;
    }
    return false;
}

static bool take_parity(const char *text, uint32_t *value)
{
    uint8_t parity = 0;
    if (!parity_parse(text, &parity)) return false;
    *value = parity;
    return true;
}

static bool take_stop_bits(const char *text, uint32_t *value) { return number_parse(text, 1, 2, value); }

static bool take_rs485(const char *text, uint32_t *value)
{
    static const char *const words[] = {"off", "on", NULL};
    return take_word(words, text, value);
}

/* In the order of fathom_line_parts_t.echo: found out, told that there is none, told that there is. */
static bool take_echo(const char *text, uint32_t *value)
{
    static const char *const words[] = {"auto", "off", "on", NULL};
    return take_word(words, text, value);
}

static bool take_line(const char *text, uint32_t *value) { return number_parse(text, 0, UINT16_MAX, value); }

/* In the order of fathom_gpio_bias_t. */
static bool take_bias(const char *text, uint32_t *value)
{
    static const char *const words[] = {"as-is", "up", "down", "off", NULL};
    return take_word(words, text, value);
}

/* In the order of pins_near_t, of which the first is never written. */
static bool take_near(const char *text, uint32_t *value)
{
    static const char *const words[] = {"", "low", "high", NULL};
    return take_word(words, text, value) && *value != PINS_NEAR_USUAL;
}

/* ---- keys ---- */

static const char a_line[] = "the number of a line from 0 to 65535";

static const struct {
    const char *name;
    port_kind_t kind;
    const char *takes;
    bool (*take)(const char *text, uint32_t *value);
} rows[PORT_KEYS] = {
    [KEY_BAUD] = {"baud", PORT_TTY, "9600, 19200, 38400, 57600, 115200 or 230400", baud_parse},
    [KEY_PARITY] = {"parity", PORT_TTY, "none, even or odd", take_parity},
    [KEY_STOP_BITS] = {"stop", PORT_TTY, "a whole number from 1 to 2", take_stop_bits},
    [KEY_RS485] = {"rs485", PORT_TTY, "on or off", take_rs485},
    [KEY_ECHO] = {"echo", PORT_TTY, "auto, on or off", take_echo},
    [KEY_TRIGGER] = {"trigger", PORT_CHIP, a_line, take_line},
    [KEY_PULSE] = {"echo", PORT_CHIP, a_line, take_line},
    [KEY_IN] = {"in", PORT_CHIP, a_line, take_line},
    [KEY_BIAS] = {"bias", PORT_CHIP, "as-is, up, down or off", take_bias},
    [KEY_NEAR] = {"near", PORT_CHIP, "high or low", take_near},
};

bool port_keys_has(const port_keys_t *keys, port_key_t key) { return (keys->given >> key & 1u) != 0; }

const char *port_key_name(port_key_t key) { return rows[key].name; }

const char *port_key_takes(port_key_t key) { return rows[key].takes; }

static void set(port_keys_t *keys, size_t key, uint32_t value)
{
    keys->value[key] = value;
    keys->given |= (uint16_t)(1u << key);
}

bool port_path_has_keys(const char *path)
{
    const char *const comma = strchr(path, ',');
    if (comma == NULL) return false;
    const size_t length = strcspn(comma + 1, "=");
    for (size_t key = 0; key != PORT_KEYS; key++)
        if (strlen(rows[key].name) == length && strncmp(rows[key].name, comma + 1, length) == 0 &&
            comma[1 + length] == '=')
            return true;
    return false;
}

/* PORT_KEYS: there is none, which is said. */
static size_t find(const char *command, const char *word, port_kind_t kind, const char *name, size_t length)
{
    char known[80] = "";
    for (size_t key = 0; key != PORT_KEYS; key++) {
        if (rows[key].kind != kind) continue;
        if (strlen(rows[key].name) == length && strncmp(rows[key].name, name, length) == 0) return key;
        list_add(known, sizeof known, rows[key].name);
    }
    (void)usage_error(command, "%s: %s has no key '%.*s', only %s", word,
                      kind == PORT_CHIP ? "a GPIO chip" : "a serial port", (int)length, name, known);
    return PORT_KEYS;
}

static bool take_pair(port_keys_t *keys, const char *command, const char *word, port_kind_t kind,
                      const char *pair, size_t length)
{
    enum { LONGEST = 16 };
    char text[LONGEST] = "";
    uint32_t value = 0;
    size_t name_length = 0;
    while (name_length != length && pair[name_length] != '=') name_length++;
    const size_t key = find(command, word, kind, pair, name_length);
    if (key == PORT_KEYS) return false;
    if (name_length == length) {
        (void)usage_error(command, "%s: the value of %s is missing: %s", word, rows[key].name,
                          rows[key].takes);
        return false;
    }
    const char *const given = pair + name_length + 1;
    const size_t given_length = length - name_length - 1;
    if (given_length < sizeof text) memcpy(text, given, given_length);
    if (given_length >= sizeof text || !rows[key].take(text, &value)) {
        (void)usage_error(command, "%s: %s takes %s, not '%.*s'", word, rows[key].name, rows[key].takes,
                          (int)given_length, given);
        return false;
    }
    if (port_keys_has(keys, (port_key_t)key)) {
        (void)usage_error(command, "%s: %s stands there twice", word, rows[key].name);
        return false;
    }
    set(keys, key, value);
    return true;
}

bool port_keys_parse(port_keys_t *keys, const char *command, const char *word, port_kind_t kind,
                     const char *list)
{
    if (kind == PORT_TCP) {
        (void)usage_error(command, "%s: a port over TCP has no keys, for the line is the gateway's", word);
        return false;
    }
    for (;;) {
        const size_t length = strcspn(list, ",");
        if (!take_pair(keys, command, word, kind, list, length)) return false;
        if (list[length] == '\0') return true;
        list += length + 1;
    }
}

bool port_keys_options(port_keys_t *keys, const char *command, const char *const given[PORT_KEYS])
{
    for (size_t key = 0; key != PORT_KEYS; key++) {
        uint32_t value = 0;
        if (given[key] == NULL) continue;
        if (!rows[key].take(given[key], &value)) {
            (void)usage_error(command, "--%s takes %s, not '%s'",
                              key == KEY_STOP_BITS ? "stop-bits" : rows[key].name, rows[key].takes,
                              given[key]);
            return false;
        }
        set(keys, key, value);
    }
    return true;
}

bool port_keys_add(port_keys_t *keys, const char *command, const char *word, const port_keys_t *others)
{
    for (size_t key = 0; key != PORT_KEYS; key++) {
        if (!port_keys_has(others, (port_key_t)key)) continue;
        if (port_keys_has(keys, (port_key_t)key) && keys->value[key] != others->value[key]) {
            (void)usage_error(command,
                              "%s: another sensor at this port has another %s; let it stand at one of them",
                              word, rows[key].name);
            return false;
        }
        set(keys, key, others->value[key]);
    }
    return true;
}

/* ---- the port ---- */

/* *value stays where neither says it. */
static bool get(const port_keys_t *keys, const port_keys_t *defaults, port_key_t key, uint32_t *value)
{
    const port_keys_t *const from = port_keys_has(keys, key) ? keys : defaults;
    if (!port_keys_has(from, key)) return false;
    *value = from->value[key];
    return true;
}

static int32_t pin(const port_keys_t *keys, port_key_t key)
{
    return port_keys_has(keys, key) ? (int32_t)keys->value[key] : -1;
}

void port_options_take(port_options_t *port, const port_keys_t *defaults)
{
    static const port_keys_t none;
    uint32_t rs485 = 0;
    uint32_t echo = 0;
    if (port_kind(port->path, strlen(port->path)) != PORT_TTY) defaults = &none;
    (void)get(&port->keys, defaults, KEY_RS485, &rs485);
    (void)get(&port->keys, defaults, KEY_ECHO, &echo);
    port->rs485 = rs485 != 0;
    port->echo = (uint8_t)echo;
    port->pins = (pin_options_t){.trigger = pin(&port->keys, KEY_TRIGGER),
                                 .echo = pin(&port->keys, KEY_PULSE),
                                 .in = pin(&port->keys, KEY_IN),
                                 .bias = (uint8_t)port->keys.value[KEY_BIAS],
                                 .near = (uint8_t)port->keys.value[KEY_NEAR]};
}

void port_options_line(const port_options_t *port, const port_keys_t *defaults, fathom_line_settings_t *line)
{
    uint32_t value = 0;
    if (get(&port->keys, defaults, KEY_BAUD, &value)) line->baud = value;
    if (get(&port->keys, defaults, KEY_STOP_BITS, &value)) {
        line->stop_bits = (uint8_t)value;
        /* Two of them take the place of the parity bit: a character has 11 bits either way (HPS-167S 2.2.2). */
        if (value == 2) line->parity = FATHOM_PARITY_NONE;
    }
    if (get(&port->keys, defaults, KEY_PARITY, &value)) line->parity = (uint8_t)value;
}

void port_options_help(FILE *to)
{
    (void)fputs(
        "  --port PATH       of every sensor without @PORT: a serial port (/dev/ttyUSB0, or the link of "
        "`fathom "
        "sim`); a\n"
        "                    Modbus TCP server or gateway, for mode modbus: tcp:HOST, tcp:HOST:PORT (502 if "
        "not "
        "given),\n"
        "                    tcp:[IPV6]:PORT; or, of read and watch, a GPIO chip for modes on "
        "pins: gpiochip0\n" OPTIONS_PORT_HELP
        "  --baud N          of serial ports, if not the factory's: 9600, 19200, 38400, 57600, 115200 or "
        "230400\n"
        "  --parity P        if not the factory's: none, even or odd\n"
        "  --stop-bits N     if not the factory's 1: 2, which means no parity too unless --parity is given\n"
        "  --echo ECHO       does the adapter return what it sends? auto (default: found out), on or off\n"
        "  --rs485           the kernel's driver drives the transceiver: RTS is on while bytes leave\n"
        "  @PORT,KEY=VALUE   of this port alone, and before the options: of a serial port baud= parity= "
        "stop= echo= and\n"
        "                    rs485=on|off; of a GPIO chip trigger= echo= in= (its lines, from 0),\n"
        "                    bias=as-is|up|down|off and near=high|low; of tcp: none. Sensors with the same "
        "PORT share\n"
        "                    it, and what stands behind one goes for all\n",
        to);
}
