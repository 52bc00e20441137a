/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): accept4, SOCK_CLOEXEC, struct ucred */
#include "commands/publish/claim.h"

#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { CALLERS = 128 }; /* other processes from one claim_tick() to the next */

static int new_socket(void) { return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

/* FNV-1a, since the texts together are longer than a name. */
static uint64_t hash(uint64_t key, const char *text)
{
    do {
        key = (key ^ (uint8_t)*text) * UINT64_C(0x100000001B3);
    } while (*text++ != '\0');
    return key;
}

/* Returns the number of the process that listens; 0: unknown, for example because it is in a container. */
static long owner_of(const struct sockaddr_un *address, socklen_t size)
{
    struct ucred owner = {.pid = 0};
    socklen_t length = sizeof owner;
    const int fd = new_socket();
    if (fd < 0) return 0;
    if (connect(fd, (const struct sockaddr *)address, size) == 0)
        (void)getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &owner, &length);
    (void)close(fd);
    return owner.pid;
}

static void report_owner(const publish_settings_t *settings, long owner)
{
    char process[40] = "another process";
    if (owner > 0) (void)snprintf(process, sizeof process, "process %ld", owner);
    (void)fprintf(stderr,
                  "fathom: %s publishes the site %s to broker %s port %u already. End that process, or write "
                  "another site: into %s.\n",
                  process, settings->site, settings->broker.host, settings->broker.port, settings->path);
}

bool claim_site(claim_t *claim, const publish_settings_t *settings)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const broker_settings_t *const broker = &settings->broker;
    const uint64_t basis = UINT64_C(0xCBF29CE484222325) ^ broker->port;
    const uint64_t key = hash(hash(hash(basis, broker->host), settings->prefix), settings->site);
    if (claim->fd != 0 && claim->key == key) return true;
    /* The name begins with a zero, which makes it an abstract one. */
    const int length =
        snprintf(address.sun_path + 1, sizeof address.sun_path - 1, "fathom-publish-%016" PRIx64, key);
    const socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
    const int fd = new_socket();
    if (fd < 0) return true; /* without sockets there is no broker */
    if (bind(fd, (const struct sockaddr *)&address, size) != 0 && errno == EADDRINUSE) {
        (void)close(fd);
        report_owner(settings, owner_of(&address, size));
        return false;
    }
    (void)listen(fd, CALLERS);
    claim_end(claim);
    *claim = (claim_t){fd, key};
    return true;
}

void claim_tick(const claim_t *claim)
{
    int fd;
    if (claim->fd == 0) return;
    while ((fd = accept4(claim->fd, NULL, NULL, SOCK_CLOEXEC)) >= 0) (void)close(fd);
}

void claim_end(claim_t *claim)
{
    if (claim->fd != 0) (void)close(claim->fd);
    claim->fd = 0;
}
