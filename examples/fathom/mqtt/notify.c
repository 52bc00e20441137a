/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): SOCK_CLOEXEC */
#include "mqtt/notify.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "fathom/hal.h"

static const char *variable(const char *name)
{
    const char *const value = getenv(name); /* NOLINT(concurrency-mt-unsafe): no thread writes it */
    return value != NULL ? value : "";
}

static int connect_to(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const size_t length = strlen(path);
    if ((path[0] != '/' && path[0] != '@') || length >= sizeof address.sun_path) return -1;
    memcpy(address.sun_path, path, length);
    if (path[0] == '@') address.sun_path[0] = '\0'; /* an abstract name */
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, size) == 0) return fd;
    if (fd >= 0) (void)close(fd);
    return -1;
}

void notify_init(notify_t *notify)
{
    memset(notify, 0, sizeof *notify);
    notify->fd = connect_to(variable("NOTIFY_SOCKET"));
    const char *const pid = variable("WATCHDOG_PID");
    const unsigned long long usec = strtoull(variable("WATCHDOG_USEC"), NULL, 10);
    const bool is_ours = pid[0] == '\0' || strtol(pid, NULL, 10) == (long)getpid();
    /* Half of what it waits for, as sd_watchdog_enabled(3) advises. */
    if (is_ours && usec / 2 < FATHOM_NO_DEADLINE) notify->watchdog_us = (uint32_t)(usec / 2);
}

void notify_deinit(notify_t *notify)
{
    if (notify->fd >= 0) (void)close(notify->fd);
    notify->fd = -1;
}

static void send_text(const notify_t *notify, const char *text)
{
    if (notify->fd >= 0 && send(notify->fd, text, strlen(text), MSG_NOSIGNAL) < 0)
        return; /* the manager does not listen now */
}

void notify_ready(const notify_t *notify) { send_text(notify, "READY=1"); }

void notify_stopping(const notify_t *notify) { send_text(notify, "STOPPING=1"); }

void notify_reloading(const notify_t *notify, uint64_t monotonic_us)
{
    char text[64];
    (void)snprintf(text, sizeof text, "RELOADING=1\nMONOTONIC_USEC=%" PRIu64, monotonic_us);
    send_text(notify, text);
}

void notify_status(notify_t *notify, const char *text)
{
    char line[NOTIFY_TEXT + 8];
    if (strncmp(notify->status, text, NOTIFY_TEXT - 1) == 0) return;
    (void)snprintf(notify->status, NOTIFY_TEXT, "%s", text);
    (void)snprintf(line, sizeof line, "STATUS=%s", notify->status);
    send_text(notify, line);
}

uint32_t notify_tick(notify_t *notify, uint64_t now_us)
{
    if (notify->watchdog_us == 0 || notify->fd < 0) return FATHOM_NO_DEADLINE;
    if (notify->watched_us == 0 || now_us - notify->watched_us >= notify->watchdog_us) {
        notify->watched_us = now_us;
        send_text(notify, "WATCHDOG=1");
    }
    return (uint32_t)(notify->watched_us + notify->watchdog_us - now_us);
}
