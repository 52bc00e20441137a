/* SPDX-License-Identifier: MIT */
/* USB adapters for test_reconnect.py, to be preloaded: /sys, /dev and the files /dev/ttyUSB... are those in the folder
 * USB_ROOT, where a device file is a link to a pseudo terminal. */
#define _GNU_SOURCE 1
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/syscall.h>
#include <unistd.h>

static int is_tty(const char *path) { return strncmp(path, "/dev/ttyUSB", 11) == 0; }

static const char *moved(const char *path)
{
    static char other[PATH_MAX];
    if (!is_tty(path) && strcmp(path, "/dev") != 0 && strncmp(path, "/sys/", 5) != 0) return path;
    (void)snprintf(other, sizeof other, "%s%s", getenv("USB_ROOT"), path);
    return other;
}

int open(const char *path, int flags, ...)
{
    return (int)syscall(SYS_openat, AT_FDCWD, moved(path), flags, 0);
}

FILE *fopen(const char *path, const char *mode)
{
    FILE *(*const real)(const char *, const char *) =
        (FILE * (*)(const char *, const char *)) dlsym(RTLD_NEXT, "fopen");
    return real(moved(path), mode);
}

/* A device file is no link to the program. */
char *realpath(const char *path, char *resolved)
{
    char *(*const real)(const char *, char *) = (char *(*)(const char *, char *))dlsym(RTLD_NEXT, "realpath");
    if (!is_tty(path)) return real(moved(path), resolved);
    char link[PATH_MAX];
    return readlink(moved(path), link, sizeof link) > 0 ? strcpy(resolved, path) : NULL;
}

int access(const char *path, int mode) { return (int)syscall(SYS_faccessat, AT_FDCWD, moved(path), mode); }

DIR *opendir(const char *path)
{
    DIR *(*const real)(const char *) = (DIR * (*)(const char *)) dlsym(RTLD_NEXT, "opendir");
    return real(moved(path));
}

int inotify_add_watch(int fd, const char *path, unsigned mask)
{
    return (int)syscall(SYS_inotify_add_watch, fd, moved(path), mask);
}
