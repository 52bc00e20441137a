/* SPDX-License-Identifier: MIT */
#ifndef ADAPTER_H
#define ADAPTER_H

#include <stdbool.h>

/*
 * A USB serial adapter, as Linux describes it below /sys. After the adapter was unplugged it is found again under any
 * name, and no other adapter is opened in its place:
 *
 * 1. The identity is vendor, product, serial number, interface, and the number of the port. If two adapters in different
 *    USB sockets have the same identity at any time of the run, this identity finds neither.
 * 2. The identity finds the adapter if its serial number can be its own, and if no tty appeared about which nothing is
 *    known. Otherwise the adapter is found in the same socket only.
 * 3. A link in /dev/serial/by-id names an identity. If two adapters have it, the link opens neither.
 * 4. If nothing is known about an adapter, it is found by its path.
 */

/* Attributes of an adapter, as far as they fit. */
typedef struct {
    char tty[32];       /* "ttyUSB0"; "": nothing is known */
    char serial[64];    /* "": none, as in a CH340 */
    char identity[128]; /* rule 1, in one text */
    char socket[192];   /* the controller, and the ports of the hubs from there */
    char place[32];     /* the socket as the kernel names it, "1-2.3" */
} usb_t;

/* All zeros: nothing is known. */
typedef struct {
    char path[40]; /* the present one, such as "/dev/ttyUSB1"; "": the path that the user named */
    /* private */
    const char *wanted; /* the path that the user named */
    usb_t known;        /* the adapter that was open */
    usb_t found;        /* by adapter_find() */
    bool was_open;
    bool is_moved;         /* it was found in another socket */
    unsigned unknown_ttys; /* when it was opened */
    const char *advice;    /* the newest one */
} adapter_t;

/*
 * Finds the adapter and sets `path`. Call it before each opening. wanted: the path that the user named, which may be a
 * link. Returns NULL, or "" if the adapter is not plugged in, or the reason why it must not be opened.
 */
const char *adapter_find(adapter_t *adapter, const char *wanted);

/* Call it after `path` was opened. False: another adapter took this path since adapter_find(); close it. */
bool adapter_open(adapter_t *adapter);

/* Returns NULL, or why it is unknown which of two adapters was opened first. Then the open one must not be read. */
const char *adapter_doubt(const adapter_t *adapter);

/* What a user has to know about finding an adapter that was unplugged. NULL: nothing new since the last call. */
const char *adapter_advice(adapter_t *adapter);

/* Returns a descriptor that is readable when ttys have appeared, for adapter_look(). -1: there is none. Without it,
 * adapter_find() considers an adapter that was plugged in for a moment one about which nothing is known. */
int adapter_fd(void);
void adapter_look(void);

/* Returns how long an adapter keeps received bytes back, in ms; 0: unknown. */
unsigned adapter_latency_ms(const char *path);

/* The folders of sysfs and of the device files. Tests have others. */
extern const char *adapter_sysfs;
extern const char *adapter_dev;

#endif
