/* SPDX-License-Identifier: MIT */
#include "ports/tcp_address.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "output/words.h"

static const char prefix[] = "tcp:";
static const char usual_port[] = "502"; /* MODBUS Messaging on TCP/IP V1.0b, 4.2.1 */

bool tcp_names(const char *path) { return strncmp(path, prefix, sizeof prefix - 1) == 0; }

static const char *parse_host(const char *from, size_t length, tcp_address_t *address)
{
    if (length == 0) return "the host is missing, such as in tcp:192.168.1.20";
    if (length >= sizeof address->host) return "the host's name is too long";
    memcpy(address->host, from, length);
    address->host[length] = '\0';
    return NULL;
}

/* The text behind the host is empty, or a colon and a number. */
static const char *parse_port(const char *from, tcp_address_t *address)
{
    uint32_t number = 0;
    if (*from == '\0')
        from = usual_port;
    else if (*from++ != ':' || !number_parse(from, 1, UINT16_MAX, &number) ||
             strlen(from) >= sizeof address->service)
        return "the port is a number from 1 to 65535, such as in tcp:192.168.1.20:502";
    (void)snprintf(address->service, sizeof address->service, "%s", from);
    return NULL;
}

const char *tcp_parse(const char *path, tcp_address_t *address)
{
    const char *host = path + sizeof prefix - 1;
    const char *end = strchr(host, ':');
    const char *behind = NULL;
    if (*host == '[') {
        end = strchr(++host, ']');
        if (end == NULL) return "the bracket behind the IPv6 address is missing";
        behind = end + 1;
    } else if (end != NULL && strchr(end + 1, ':') != NULL) {
        return "an IPv6 address stands in brackets, such as in tcp:[fd00::20]:502";
    } else {
        if (end == NULL) end = host + strlen(host);
        behind = end;
    }
    const char *const wrong = parse_host(host, (size_t)(end - host), address);
    return wrong != NULL ? wrong : parse_port(behind, address);
}
