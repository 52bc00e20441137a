/* SPDX-License-Identifier: MIT */
#ifndef NOTIFY_H
#define NOTIFY_H

#include <stdbool.h>
#include <stdint.h>

/* Reports to the service manager, by the datagrams of sd_notify(3). Without a service manager nothing is sent. */

enum { NOTIFY_TEXT = 256 };

typedef struct {
    int fd;               /* -1: no service manager */
    uint32_t watchdog_us; /* from one message to its watchdog to the next; 0: it has none */
    uint64_t watched_us;  /* when the latest one was sent */
    char status[NOTIFY_TEXT];
} notify_t;

void notify_init(notify_t *notify);
void notify_deinit(notify_t *notify);

void notify_ready(const notify_t *notify);
void notify_reloading(const notify_t *notify, uint64_t monotonic_us); /* until notify_ready() */
void notify_stopping(const notify_t *notify);

/* Sends a line for people, if it changed. */
void notify_status(notify_t *notify, const char *text);

/* Call it before each sleep, for the watchdog. Returns the longest time to sleep in us. */
uint32_t notify_tick(notify_t *notify, uint64_t now_us);

#endif
