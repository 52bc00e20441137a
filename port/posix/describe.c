/* SPDX-License-Identifier: MIT */
/*
 * Error texts that the ports of Linux share. They name the words of the system, and the group or the udev rule that
 * gives access to a device.
 */
#undef _GNU_SOURCE        /* with it, strerror_r is another function */
#define _DEFAULT_SOURCE 1 /* getgrgid_r, strerror_r */
#include "internal/describe.h"

#include <grp.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* strerror(3) is not safe with threads. */
const char *fathom_posix_words(int code, char *text, size_t capacity)
{
    if (strerror_r(code, text, capacity) != 0) (void)snprintf(text, capacity, "error %d", code);
    return text;
}

const char *fathom_posix_describe_denied(const char *path, const char *usual_group, char *text,
                                         size_t capacity)
{
    static const char denied[] = "permission denied";
    struct stat status;
    if (stat(path, &status) != 0) {
        (void)snprintf(text, capacity, "%s: a folder on its way is closed to you", denied);
        return text;
    }

    char memory[1024]; /* the group's name and members; a longer entry is shown as its number */
    char number[16];
    struct group entry;
    struct group *group = NULL;
    const int found = getgrgid_r(status.st_gid, &entry, memory, sizeof memory, &group);
    (void)snprintf(number, sizeof number, "%lu", (unsigned long)status.st_gid);
    const char *const name = found == 0 && group != NULL ? entry.gr_name : number;

    /* No user should join the group root. If the group may not read and write, joining it does not help. */
    const unsigned mode = (unsigned)status.st_mode & 07777u;
    if (status.st_gid == 0 || (mode & (S_IRGRP | S_IWGRP)) != (S_IRGRP | S_IWGRP))
        (void)snprintf(text, capacity,
                       "%s: it belongs to the group %s with mode %04o, so joining a group does not help; "
                       "a udev rule (GROUP=\"%s\", MODE=\"0660\") or root can",
                       denied, name, mode, usual_group);
    else
        (void)snprintf(text, capacity,
                       "%s: it belongs to the group %s; join it with: sudo usermod -aG %s $USER "
                       "and log in again",
                       denied, name, name);
    return text;
}
