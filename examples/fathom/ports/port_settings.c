/* SPDX-License-Identifier: MIT */
#include "ports/port_settings.h"

#include <string.h>
#include <sys/stat.h>

#include "ports/tcp_address.h"

bool port_path_has_gateway(const char *path) { return tcp_names(path); }

bool port_path_has_pins(const char *path)
{
    static const char chip[] = "gpiochip";
    return !tcp_names(path) && strncmp(port_last_part(path), chip, sizeof chip - 1) == 0;
}

bool port_path_has_line(const char *path)
{
    return !port_path_has_gateway(path) && !port_path_has_pins(path);
}

const char *port_path_error(const char *path)
{
    tcp_address_t address;
    return tcp_names(path) ? tcp_parse(path, &address) : NULL;
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

/* Leaves *value alone if neither has the key. */
static bool get(const port_keys_t *keys, const port_keys_t *defaults, port_key_t key, uint32_t *value)
{
    const port_keys_t *const from = keys->has[key] ? keys : defaults;
    if (!from->has[key]) return false;
    *value = from->value[key];
    return true;
}

/* -1: none. The trigger of a serial port has the number of its chip above (sensor_word.c). */
static int32_t pin(const port_keys_t *keys, port_key_t key)
{
    return keys->has[key] ? (int32_t)(keys->value[key] & UINT16_MAX) : -1;
}

void port_options_take(port_options_t *port, const port_keys_t *defaults)
{
    static const port_keys_t none;
    uint32_t rs485 = 0;
    uint32_t echo = 0;
    if (!port_path_has_line(port->path)) defaults = &none;
    (void)get(&port->keys, defaults, KEY_RS485, &rs485);
    (void)get(&port->keys, defaults, KEY_ECHO, &echo);
    port->rs485 = rs485 != 0;
    port->echo = (uint8_t)echo;
    port->pins =
        (pin_options_t){.trigger = pin(&port->keys, KEY_TRIGGER),
                        .chip = port->keys.has[KEY_TRIGGER] ? (port->keys.value[KEY_TRIGGER] >> 16) + 1 : 0,
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

port_settings_t port_options_settings(const port_options_t *port)
{
    return (port_settings_t){
        .path = port->path, .line = port->line, .echo = port->echo, .rs485 = port->rs485, .pins = port->pins};
}
