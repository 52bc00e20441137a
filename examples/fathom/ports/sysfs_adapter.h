/* SPDX-License-Identifier: MIT */
#ifndef SYSFS_ADAPTER_H
#define SYSFS_ADAPTER_H

#include <stdbool.h>
#include <stddef.h>

/*
 * A USB serial adapter, as Linux describes it below /sys: by this it is known again when it is plugged in under
 * another name. The sysfs root is a parameter for the tests' sake; SYSFS_ROOT is the real one.
 */
#define SYSFS_ROOT "/sys"

enum { SYSFS_WORD = 64, SYSFS_NAME = 256, SYSFS_PATH = SYSFS_NAME + 8 };

typedef struct {
    char vendor[SYSFS_WORD];    /* idVendor; "" when this is no USB adapter, or nothing is known of it */
    char product[SYSFS_WORD];   /* idProduct */
    char serial[SYSFS_WORD];    /* "" where the adapter has none, as the CH340 */
    char socket[SYSFS_WORD];    /* where it is plugged in, "1-2.3" */
    char interface[SYSFS_WORD]; /* of an adapter with several ports, which of them: "00" */
    char port[SYSFS_WORD];      /* and where one interface has several: the driver's number of it */
    bool needs_socket;          /* it has no serial number, or another one here has the same */
} sysfs_adapter_t;

/* Of a port that is open or could be; path may be a link to it. False, and all of it "", when it is no tty of a
 * USB adapter. */
bool sysfs_adapter_identify(sysfs_adapter_t *adapter, const char *sysfs, const char *path);

/*
 * Looks for the adapter among all ttys. True: *path is where it is now, such as /dev/ttyUSB1. One with a serial
 * number of its own is found in any socket; one that needs_socket could be taken for another of its make, so it
 * is found in its socket only.
 */
bool sysfs_adapter_find(const sysfs_adapter_t *adapter, const char *sysfs, char path[SYSFS_PATH]);

/* How long it keeps what has come before it hands that over, in ms; 0: nothing is known of that. */
unsigned sysfs_adapter_latency_ms(const char *sysfs, const char *path);

#endif
