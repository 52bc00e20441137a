/* SPDX-License-Identifier: MIT */
#ifndef ADAPTER_IDENTITY_H
#define ADAPTER_IDENTITY_H

#include "ports/adapter.h"

/* For adapter.c alone: reads sysfs, and watches the folder of the device files. */

/* The last name of a path. */
const char *adapter_last_name(const char *path);

/* Reads the identity of a tty, "ttyUSB0". False: it is no USB adapter, and *identity is all "". */
bool adapter_identity_read(adapter_identity_t *identity, const char *name);

/* Is there such a tty? */
bool adapter_identity_is_there(const char *name);

/* Is this the name of a USB adapter, so that something should be known about it? */
bool adapter_identity_is_expected(const char *path);

/* Calls `each` with every tty that is a USB adapter. */
void adapter_identities_each(void (*each)(void *ctx, const adapter_identity_t *identity), void *ctx);

/* The socket does not count. */
bool adapter_identity_is_same(const adapter_identity_t *one, const adapter_identity_t *other);

/* The same interface and number of the port, of any make? */
bool adapter_identity_is_same_port(const adapter_identity_t *one, const adapter_identity_t *other);

/* ---- changes ---- */

typedef struct {
    void (*is_new)(const char *name); /* a device file appeared: "ttyUSB0" */
    void (*is_removed)(const char *name);
    void (*is_missed)(void); /* changes were lost */
} adapter_changes_t;

/* Starts to watch. False: the system cannot. */
bool adapter_changes_start(void);

/* Reports the changes since the last call, in their order. */
void adapter_changes_read(const adapter_changes_t *changes);

/* Reports each change at once, in a loop. */
void adapter_changes_watch(fathom_loop_t *loop, const adapter_changes_t *changes);

#endif
