/* SPDX-License-Identifier: MIT */
#ifndef NOTIFY_H
#define NOTIFY_H

#include <stdbool.h>
#include <stdint.h>

/* Tells the service manager how things are, by the datagrams that sd_notify(3) documents. Where none has started the program,
 * nothing is told. */

enum { NOTIFY_TEXT = 256 };

typedef struct {
    int fd;               /* -1: nothing is told */
    uint32_t watchdog_us; /* so often it wants to be told that all is well; 0: it does not */
    uint64_t watched_us;  /* when that was told last */
    char status[NOTIFY_TEXT];
} notify_t;

void notify_begin(notify_t *notify);
void notify_end(notify_t *notify);

/* It is ready; it reads its file anew, and is ready again; it ends. */
void notify_ready(const notify_t *notify);
void notify_reloading(const notify_t *notify, uint64_t monotonic_us);
void notify_stopping(const notify_t *notify);

/* One line for people, if it is another one than before. */
void notify_status(notify_t *notify, const char *text);

/* Before each sleep: tells that all is well when it is time for that. Returns how long the sleep may take. */
uint32_t notify_tick(notify_t *notify, uint64_t now_us);

#endif
