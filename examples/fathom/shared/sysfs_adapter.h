/* SPDX-License-Identifier: MIT */
#ifndef SYSFS_ADAPTER_H
#define SYSFS_ADAPTER_H

#include <stdbool.h>
#include <stddef.h>

/*
 * A USB serial adapter, as Linux describes it below /sys: by this it is known again when it is plugged in under
 * another name. The sysfs root is a parameter for the tests' sake; ADAPTER_SYSFS is the real one.
 */
#define ADAPTER_SYSFS "/sys"

enum { ADAPTER_WORD = 64, ADAPTER_NAME = 256, ADAPTER_PATH = ADAPTER_NAME + 8 };

typedef struct {
    char vendor[ADAPTER_WORD];    /* idVendor; "" when this is no USB adapter, or nothing is known of it */
    char product[ADAPTER_WORD];   /* idProduct */
    char serial[ADAPTER_WORD];    /* "" where the adapter has none, as the CH340 */
    char socket[ADAPTER_WORD];    /* where it is plugged in, "1-2.3" */
    char interface[ADAPTER_WORD]; /* of an adapter with several ports, which of them: "00" */
    char port[ADAPTER_WORD];      /* and where one interface has several: the driver's number of it */
    bool needs_socket;            /* it has no serial number, or another one here has the same */
} adapter_t;

/* Of a port that is open or could be; path may be a link to it. False, and all of it "", when it is no tty of a
 * USB adapter. */
bool adapter_identify(adapter_t *adapter, const char *sysfs, const char *path);

/*
 * Looks for the adapter among all ttys. True: *path is where it is now, such as /dev/ttyUSB1. One with a serial
 * number of its own is found in any socket; one that needs_socket could be taken for another of its make, so it
 * is found in its socket only.
 */
bool adapter_find(const adapter_t *adapter, const char *sysfs, char path[ADAPTER_PATH]);

/* How long it keeps what has come before it hands that over, in ms; 0: nothing is known of that. */
unsigned adapter_latency_ms(const char *sysfs, const char *path);

#endif
