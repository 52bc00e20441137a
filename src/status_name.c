/* SPDX-License-Identifier: MIT */
#include "fathom/status.h"

/* The names of the statuses. All names are in one array, which is smaller than a table of pointers. */

const char *fathom_status_name(fathom_status_t status)
{
    /* In falling order of the numbers, from FATHOM_PENDING on. A table of pointers would need 4 bytes for each name. */
    static const char names[] = "PENDING\0OK\0ARGUMENT\0PORT\0NO_RESPONSE\0CHECKSUM\0EXCEPTION\0MALFORMED\0"
                                "STALE\0CANCELLED\0BUSY\0CAPACITY\0ECHO\0UNSUPPORTED\0WARMING_UP\0"
                                "UNCONFIRMED\0IN_USE\0DIFFERS\0LINE_BUSY\0OTHER_MASTER";
    const char *name = names;
    if ((status > FATHOM_PENDING) || (status < FATHOM_ERR_OTHER_MASTER)) return "?";
    for (int left = FATHOM_PENDING - (int)status; left != 0; left--)
        while (*name++ != '\0') {
        }
    return name;
}
