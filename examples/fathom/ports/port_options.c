/* SPDX-License-Identifier: MIT */
#include "ports/port.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "output/words.h"

/* ---- paths ---- */

static const char tcp_prefix[] = "tcp:";

const char *port_last_part(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

port_kind_t port_kind(const char *path)
{
    if (strncmp(path, tcp_prefix, strlen(tcp_prefix)) == 0) return PORT_GATEWAY;
    return strncmp(port_last_part(path), "gpiochip", strlen("gpiochip")) == 0 ? PORT_PINS : PORT_SERIAL;
}

bool port_is_same(const char *one, const char *other)
{
    struct stat first;
    struct stat second;
    if (strcmp(one, other) == 0) return true;
    return stat(one, &first) == 0 && stat(other, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

const char *tcp_parse(const char *path, tcp_address_t *address)
{
    const char *const usual_port = "502"; /* MODBUS Messaging on TCP/IP V1.0b, 4.2.1 */
    const char *host = path + strlen(tcp_prefix);
    const char *const colon = strchr(host, ':');
    const char *end = colon != NULL ? colon : host + strlen(host);
    const char *service = end;
    uint32_t number = 0;
    if (*host == '[') {
        end = strchr(++host, ']');
        if (end == NULL) return "the bracket behind the IPv6 address is missing";
        service = end + 1;
    } else if (colon != NULL && strchr(colon + 1, ':') != NULL) {
        return "an IPv6 address stands in brackets, such as in tcp:[fd00::20]:502";
    }
    if (end == host) return "the host is missing, such as in tcp:192.168.1.20";
    if ((size_t)(end - host) >= sizeof address->host) return "the host's name is too long";
    (void)snprintf(address->host, sizeof address->host, "%.*s", (int)(end - host), host);
    if (*service == '\0')
        service = usual_port;
    else if (*service++ != ':' || !number_parse(service, 1, UINT16_MAX, &number) ||
             strlen(service) >= sizeof address->service)
        return "the port is a number from 1 to 65535, such as in tcp:192.168.1.20:502";
    (void)strcpy(address->service, service);
    return NULL;
}

/* ---- keys ---- */

/* Leaves *value unchanged if neither has the key. */
static bool get(const port_keys_t *keys, const port_keys_t *defaults, port_key_t key, uint32_t *value)
{
    const port_keys_t *const from = keys->has[key] ? keys : defaults;
    if (from->has[key]) *value = from->value[key];
    return from->has[key];
}

static int32_t pin(const port_keys_t *keys, port_key_t key)
{
    return keys->has[key] ? (int32_t)(keys->value[key] & UINT16_MAX) : -1;
}

void port_options_take(port_options_t *port, const port_keys_t *defaults)
{
    const port_keys_t *const keys = &port->keys;
    uint32_t rs485 = 0;
    uint32_t echo = 0;
    port->kind = port_kind(port->path);
    if (port->kind != PORT_SERIAL) defaults = keys;
    (void)get(keys, defaults, KEY_RS485, &rs485);
    (void)get(keys, defaults, KEY_ECHO, &echo);
    port->rs485 = rs485 != 0;
    port->echo = (uint8_t)echo;
    port->pins = (pin_options_t){.trigger = pin(keys, KEY_TRIGGER),
                                 .chip = keys->has[KEY_TRIGGER] ? (keys->value[KEY_TRIGGER] >> 16) + 1 : 0,
                                 .echo = pin(keys, KEY_PULSE),
                                 .in = pin(keys, KEY_IN),
                                 .bias = (uint8_t)keys->value[KEY_BIAS],
                                 .near = (uint8_t)keys->value[KEY_NEAR]};
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

/* ---- the settings of a line in words ---- */

const char *parity_name(uint8_t parity)
{
    static const char *const names[] = {
        [FATHOM_PARITY_NONE] = "none", [FATHOM_PARITY_EVEN] = "even", [FATHOM_PARITY_ODD] = "odd"};
    return names[parity];
}

const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT])
{
    (void)snprintf(text, LINE_TEXT, "%" PRIu32 " 8%c%u", settings->baud, "NEO"[settings->parity],
                   settings -> stop_bits);
    return text;
}
