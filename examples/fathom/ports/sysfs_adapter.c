/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): realpath */
#include "ports/sysfs_adapter.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The last name of a path. */
static const char *last_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static void copy_word(char word[SYSFS_WORD], const char *text)
{
    (void)snprintf(word, SYSFS_WORD, "%.*s", SYSFS_WORD - 1, text);
}

/* The one line of an attribute; false, and "", where there is none. */
static bool read_attribute(const char *folder, const char *name, char word[SYSFS_WORD])
{
    char path[PATH_MAX];
    word[0] = '\0';
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return false;
    FILE *const file = fopen(path, "re");
    if (file == NULL) return false;
    const bool is_read = fgets(word, SYSFS_WORD, file) != NULL;
    (void)fclose(file);
    if (!is_read) word[0] = '\0';
    word[strcspn(word, "\n")] = '\0';
    return is_read;
}

/*
 * A tty's `device` is the interface (cdc_acm: .../1-2/1-2:1.0), or a port below it (usb-serial:
 * .../1-2/1-2:1.0/ttyUSB0); the USB device is the first one above that has an idVendor.
 */
static bool identify_tty(sysfs_adapter_t *adapter, const char *sysfs, const char *name)
{
    char link[PATH_MAX];
    char folder[PATH_MAX];
    memset(adapter, 0, sizeof *adapter);
    if (snprintf(link, sizeof link, "%s/class/tty/%s/device", sysfs, name) >= (int)sizeof link ||
        realpath(link, folder) == NULL)
        return false;
    (void)read_attribute(folder, "port_number", adapter->port);
    while (strchr(folder, '/') != NULL) {
        if (adapter->interface[0] == '\0')
            (void)read_attribute(folder, "bInterfaceNumber", adapter->interface);
        if (read_attribute(folder, "idVendor", adapter->vendor)) break;
        *strrchr(folder, '/') = '\0';
    }
    if (adapter->vendor[0] == '\0') {
        memset(adapter, 0, sizeof *adapter);
        return false;
    }
    (void)read_attribute(folder, "idProduct", adapter->product);
    (void)read_attribute(folder, "serial", adapter->serial);
    copy_word(adapter->socket, last_name(folder));
    return true;
}

static bool is_same_make(const sysfs_adapter_t *a, const sysfs_adapter_t *b)
{
    return strcmp(a->vendor, b->vendor) == 0 && strcmp(a->product, b->product) == 0 &&
           strcmp(a->serial, b->serial) == 0 && strcmp(a->interface, b->interface) == 0 &&
           strcmp(a->port, b->port) == 0;
}

static bool is_it(const sysfs_adapter_t *adapter, const sysfs_adapter_t *other)
{
    return is_same_make(adapter, other) &&
           (!adapter->needs_socket || strcmp(adapter->socket, other->socket) == 0);
}

/* One that cannot be told from it but by its socket: makers give a whole series the serial number 0001. */
static bool is_double(const sysfs_adapter_t *adapter, const sysfs_adapter_t *other)
{
    return is_same_make(adapter, other) && strcmp(adapter->socket, other->socket) != 0;
}

/* The first tty of which this is so; its name goes to *name. */
static bool find_tty(const sysfs_adapter_t *adapter, const char *sysfs,
                     bool (*is_wanted)(const sysfs_adapter_t *adapter, const sysfs_adapter_t *other),
                     char name[SYSFS_NAME])
{
    char folder[PATH_MAX];
    bool is_found = false;
    if (snprintf(folder, sizeof folder, "%s/class/tty", sysfs) >= (int)sizeof folder) return false;
    DIR *const ttys = opendir(folder);
    if (ttys == NULL) return false;
    const struct dirent *entry = NULL;
    while (!is_found && (entry = readdir(ttys)) != NULL) { /* NOLINT(concurrency-mt-unsafe): one thread */
        sysfs_adapter_t other;
        is_found = identify_tty(&other, sysfs, entry->d_name) && is_wanted(adapter, &other);
        if (is_found) (void)snprintf(name, SYSFS_NAME, "%s", entry->d_name);
    }
    (void)closedir(ttys);
    return is_found;
}

bool sysfs_adapter_identify(sysfs_adapter_t *adapter, const char *sysfs, const char *path)
{
    char real[PATH_MAX];
    char other[SYSFS_NAME];
    memset(adapter, 0, sizeof *adapter);
    if (realpath(path, real) == NULL || !identify_tty(adapter, sysfs, last_name(real))) return false;
    adapter->needs_socket = adapter->serial[0] == '\0' || find_tty(adapter, sysfs, is_double, other);
    return true;
}

bool sysfs_adapter_find(const sysfs_adapter_t *adapter, const char *sysfs, char path[SYSFS_PATH])
{
    char name[SYSFS_NAME];
    if (adapter->vendor[0] == '\0' || !find_tty(adapter, sysfs, is_it, name)) return false;
    (void)snprintf(path, SYSFS_PATH, "/dev/%s", name);
    return true;
}

unsigned sysfs_adapter_latency_ms(const char *sysfs, const char *path)
{
    char real[PATH_MAX];
    char folder[PATH_MAX];
    char word[SYSFS_WORD];
    if (realpath(path, real) == NULL ||
        snprintf(folder, sizeof folder, "%s/class/tty/%s/device", sysfs, last_name(real)) >=
            (int)sizeof folder ||
        !read_attribute(folder, "latency_timer", word))
        return 0;
    return (unsigned)strtoul(word, NULL, 10);
}
