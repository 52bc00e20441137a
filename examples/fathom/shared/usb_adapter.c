/* SPDX-License-Identifier: MIT */
#include "shared/usb_adapter.h"

#include <stdio.h>

/* When an adapter has just come, the system needs a moment until it may be used, and other programs (modem managers)
 * try it first. */
enum { TRIES_UNTIL_TOLD = 6 };

const char *plug_path(const plug_t *plug) { return plug->found[0] != '\0' ? plug->found : plug->path; }

static void tell(plug_t *plug, const fathom_posix_uart_t *port)
{
    const fathom_posix_status_t error = fathom_posix_error(port);
    plug->repeats = error == plug->error ? plug->repeats + 1 : 1;
    plug->error = error;
    if (error != FATHOM_POSIX_ERR_NOT_FOUND && plug->repeats == TRIES_UNTIL_TOLD)
        (void)fprintf(stderr, "fathom: still waiting: %s\n", fathom_posix_error_text(port));
}

bool plug_try(plug_t *plug, channel_t *channel, const host_t *host, const fathom_line_settings_t *settings)
{
    const bool is_usb = plug->adapter.vendor[0] != '\0';
    if (is_usb && !adapter_find(&plug->adapter, ADAPTER_SYSFS, plug->found)) return false;
    if (!channel_open(channel, host, plug_path(plug), settings)) {
        tell(plug, &channel->port);
        return false;
    }
    plug->error = FATHOM_POSIX_OK;
    plug->repeats = 0;
    (void)adapter_identify(&plug->adapter, ADAPTER_SYSFS, plug_path(plug));
    return true;
}
