/* SPDX-License-Identifier: MIT */
#ifndef ADAPTER_H
#define ADAPTER_H

#include <stdbool.h>

#include "fathom_loop.h"

/*
 * A USB serial adapter, as Linux describes it below /sys. After the adapter was unplugged it is found again under any
 * name, and no other adapter is opened in its place:
 *
 * 1. The identity is vendor, product, serial number, interface, and the number of the port. An adapter with the same
 *    identity in another USB socket is a twin.
 * 2. The identity alone finds the adapter if the serial number can be its own, and if no twin was plugged in since the
 *    adapter was opened. Otherwise the adapter is found in the same socket only.
 * 3. A link in /dev/serial/by-id names an identity. If a twin is plugged in, the link opens neither.
 * 4. If nothing is known about an adapter, it is found by its path.
 */

enum { ADAPTER_NAME = 32, ADAPTER_SERIAL = 64, ADAPTER_TEXT = 192 };

typedef struct {
    char name[ADAPTER_NAME];     /* of the tty, "ttyUSB0"; "": nothing is known */
    char serial[ADAPTER_SERIAL]; /* "": none, as in a CH340 */
    char identity[ADAPTER_TEXT]; /* rule 1, in one text */
    char socket[ADAPTER_TEXT];   /* the controller, and the ports of the hubs from there */
    char place[ADAPTER_NAME];    /* the socket as the kernel names it, "1-2.3" */
} adapter_facts_t;

/* All zeros: nothing is known. Do not move it while it is open. */
typedef struct adapter adapter_t;
struct adapter {
    char path[ADAPTER_TEXT]; /* the present one, such as "/dev/ttyUSB1"; "": the path that the user named */
    /* private */
    const char *wanted;    /* the path that the user named */
    adapter_facts_t known; /* about the adapter that was open */
    adapter_facts_t found; /* by adapter_find() */
    bool was_open;
    bool is_shared;   /* a twin is, or may have been, plugged in */
    bool is_moved;    /* it was found in another socket */
    bool is_doubtful; /* and then a twin was plugged in */
    bool is_present;  /* it is open and plugged in */
    int advice;       /* the newest one */
    adapter_t *next;  /* among those that are open */
};

/*
 * Finds the adapter and sets `path`. Call it before each opening. wanted: the path that the user named, which may be a
 * link. Returns NULL, or "" if the adapter is not plugged in, or the reason why it must not be opened.
 */
const char *adapter_find(adapter_t *adapter, const char *wanted);

/* Call it after `path` was opened. False: another adapter took this path since adapter_find(); close it. */
bool adapter_open(adapter_t *adapter);
void adapter_close(adapter_t *adapter);

/* Returns true if it is unknown which of two adapters was opened first. Then the open one must not be read. */
bool adapter_is_doubtful(const adapter_t *adapter);

/* What a user has to know about finding an adapter that was unplugged. NULL: nothing new since the last call. */
const char *adapter_advice(adapter_t *adapter);

/* Adds a source to a loop that examines each new adapter at once. Without it, adapters are examined by
 * adapter_find(), which considers an adapter that was plugged in for a moment a twin. */
void adapter_watch(fathom_loop_t *loop);

/* How long an adapter keeps received bytes back, in ms; 0: unknown. */
unsigned adapter_latency_ms(const char *path);

/* The folders of sysfs and of the device files. Tests have others. */
extern const char *adapter_sysfs;
extern const char *adapter_dev;

#endif
