/* SPDX-License-Identifier: MIT */
#include "ports/usb_adapter.h"

/* When an adapter has just come, the system needs a moment until it may be used, and other programs (modem managers)
 * try it first. */
enum { TRIES_UNTIL_TOLD = 3 };

const char *usb_adapter_path(const usb_adapter_t *adapter)
{
    return adapter->found[0] != '\0' ? adapter->found : adapter->path;
}

static void note(usb_adapter_t *adapter, const fathom_posix_uart_t *port)
{
    const fathom_posix_status_t error = fathom_posix_error(port);
    adapter->repeats = error == adapter->error ? adapter->repeats + 1 : 1;
    adapter->error = error;
}

bool usb_adapter_is_overdue(const usb_adapter_t *adapter)
{
    return adapter->error != FATHOM_POSIX_ERR_NOT_FOUND && adapter->repeats == TRIES_UNTIL_TOLD;
}

bool usb_adapter_try(usb_adapter_t *adapter, channel_t *channel, const host_t *host,
                     const fathom_line_settings_t *settings)
{
    const bool is_usb = adapter->sysfs.vendor[0] != '\0';
    if (is_usb && !sysfs_adapter_find(&adapter->sysfs, SYSFS_ROOT, adapter->found)) {
        adapter->repeats = 0;
        return false;
    }
    if (!channel_open(channel, host, usb_adapter_path(adapter), settings)) {
        note(adapter, &channel->port);
        return false;
    }
    adapter->error = FATHOM_POSIX_OK;
    adapter->repeats = 0;
    (void)sysfs_adapter_identify(&adapter->sysfs, SYSFS_ROOT, usb_adapter_path(adapter));
    return true;
}
