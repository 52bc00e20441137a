/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* SOCK_NONBLOCK, getaddrinfo */
#include "ports/tcp_address.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "fathom_posix.h"
#include "output/words.h"
#include "ports/events.h"

static const char prefix[] = "tcp:";
static const char usual_port[] = "502"; /* MODBUS Messaging on TCP/IP V1.0b, 4.2.1 */

bool tcp_names(const char *path) { return strncmp(path, prefix, sizeof prefix - 1) == 0; }

static const char *take_host(const char *from, size_t length, tcp_address_t *address)
{
    if (length == 0) return "the host is missing, such as in tcp:192.168.1.20";
    if (length >= sizeof address->host) return "the host's name is too long";
    memcpy(address->host, from, length);
    address->host[length] = '\0';
    return NULL;
}

/* What stands behind the host: nothing, or a colon and a number. */
static const char *take_port(const char *from, tcp_address_t *address)
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
    const char *const host = path + sizeof prefix - 1;
    const char *end = strchr(host, ':');
    const char *wrong = NULL;
    if (*host == '[') {
        end = strchr(host, ']');
        if (end == NULL) return "the bracket behind the IPv6 address is missing";
        wrong = take_host(host + 1, (size_t)(end - host - 1), address);
        return wrong != NULL ? wrong : take_port(end + 1, address);
    }
    if (end != NULL && strchr(end + 1, ':') != NULL)
        return "an IPv6 address stands in brackets, such as in tcp:[fd00::20]:502";
    if (end == NULL) end = host + strlen(host);
    wrong = take_host(host, (size_t)(end - host), address);
    return wrong != NULL ? wrong : take_port(end, address);
}

int tcp_connect_look(int fd)
{
    struct pollfd entry = {fd, POLLOUT, 0};
    if (poll(&entry, 1, 0) <= 0) return EINPROGRESS;
    int error = 0;
    socklen_t length = sizeof error;
    return getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &length) == 0 ? error : errno;
}

/* The error of a connection that was begun: 0 when it stands, EINTR when the user has ended the command. */
static int outcome(int fd)
{
    const uint64_t deadline_us = fathom_posix_now_us() + TCP_CONNECT_S * 1000000u;
    for (;;) {
        const int error = tcp_connect_look(fd);
        const uint64_t now_us = fathom_posix_now_us();
        if (error != EINPROGRESS) return error;
        if (events_ended()) return EINTR;
        if (now_us >= deadline_us) return ETIMEDOUT;
        events_wait(fd, POLLOUT, (uint32_t)(deadline_us - now_us), false);
    }
}

/* The descriptor, or -1 and errno. The connection stands, or is under way. */
static int begin_to(const struct addrinfo *to)
{
    const int on = 1;
    const int fd = socket(to->ai_family, to->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, to->ai_protocol);
    if (fd < 0) return -1;
    if (connect(fd, to->ai_addr, to->ai_addrlen) != 0 && errno != EINPROGRESS) {
        const int error = errno;
        (void)close(fd);
        errno = error;
        return -1;
    }
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on,
                     sizeof on); /* a request is small, and waits for nothing */
    return fd;
}

/* The same, but it stands. */
static int connect_to(const struct addrinfo *to)
{
    const int fd = begin_to(to);
    if (fd < 0) return -1;
    const int error = outcome(fd);
    if (error == 0) return fd;
    (void)close(fd);
    errno = error;
    return -1;
}

static const char *advice_for(int error)
{
    switch (error) {
    case ECONNREFUSED:
        return "nothing serves this port; check it (502 is usual), and that Modbus TCP is switched on there";
    case ETIMEDOUT:
        return "nothing answers at this address; check it, the supply of what should be there, and firewalls";
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EADDRNOTAVAIL:
        return "there is no way to this address; check it, and the network of this machine";
    default:
        return "the connection failed";
    }
}

void tcp_connect_text(int error, char *text, size_t capacity)
{
    (void)snprintf(text, capacity, "%s: %s", strerror(error), advice_for(error));
}

/* NULL: what tcp_connect says. */
static struct addrinfo *look_up(const tcp_address_t *address, char *text, size_t capacity, bool *may_pass)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *list = NULL;
    const int looked_up = getaddrinfo(address->host, address->service, &hints, &list);
    *may_pass = looked_up == 0 || looked_up == EAI_AGAIN;
    if (looked_up == 0) return list;
    (void)snprintf(text, capacity,
                   "the host is not known: %s; check its name, or give its address in numbers",
                   gai_strerror(looked_up));
    return NULL;
}

int tcp_connect(const tcp_address_t *address, char *text, size_t capacity, bool *may_pass)
{
    struct addrinfo *const list = look_up(address, text, capacity, may_pass);
    if (list == NULL) return -1;
    int fd = -1;
    for (const struct addrinfo *to = list; to != NULL && fd < 0 && !events_ended(); to = to->ai_next)
        fd = connect_to(to);
    const int error = errno;
    freeaddrinfo(list);
    if (fd < 0) tcp_connect_text(error, text, capacity);
    return fd;
}

int tcp_connect_begin(const tcp_address_t *address, unsigned turn, char *text, size_t capacity,
                      bool *may_pass)
{
    struct addrinfo *const list = look_up(address, text, capacity, may_pass);
    if (list == NULL) return -1;
    const struct addrinfo *to = list;
    for (; turn != 0; turn--) to = to->ai_next != NULL ? to->ai_next : list;
    const int fd = begin_to(to);
    const int error = errno;
    freeaddrinfo(list);
    if (fd < 0) tcp_connect_text(error, text, capacity);
    return fd;
}
