/* SPDX-License-Identifier: MIT */
#ifndef USB_ADAPTER_H
#define USB_ADAPTER_H

#include "ports/channel.h"
#include "ports/sysfs_adapter.h"

/* Where a port is plugged in: finds and opens it again after it was lost. */
typedef struct {
    const char *path;      /* as the user gave it */
    sysfs_adapter_t sysfs; /* behind it when it was last open; not one of USB: all "" */
    char found[SYSFS_PATH];
    fathom_posix_status_t error; /* of the last try, ... */
    uint32_t repeats;            /* ... so often in a row */
} usb_adapter_t;

/*
 * Tries once. A USB adapter is looked for by what it is, anything else by its path. False: it is not there, or not
 * to be had.
 */
bool usb_adapter_try(usb_adapter_t *adapter, channel_t *channel, const host_t *host,
                     const fathom_line_settings_t *settings);

/* After a try: has it now failed so often, for something else than "not there", that it is to be told? True once. */
bool usb_adapter_is_overdue(const usb_adapter_t *adapter);

/* Where it is. */
const char *usb_adapter_path(const usb_adapter_t *adapter);

#endif
