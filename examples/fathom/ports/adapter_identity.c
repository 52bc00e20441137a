/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): realpath */
#include "ports/adapter_identity.h"

#include <ctype.h>
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

const char *adapter_sysfs = "/sys";
const char *adapter_dev = "/dev";

const char *adapter_last_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

/* ---- sysfs ---- */

/* Reads the only line of an attribute. False, and "": there is none. */
static bool read_attribute(const char *folder, const char *name, char *word, size_t capacity)
{
    char path[PATH_MAX];
    word[0] = '\0';
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return false;
    FILE *const file = fopen(path, "re");
    if (file == NULL) return false;
    const bool is_read = fgets(word, (int)capacity, file) != NULL;
    (void)fclose(file);
    if (!is_read) word[0] = '\0';
    word[strcspn(word, "\n")] = '\0';
    return is_read;
}

static bool device_folder(const char *name, char folder[PATH_MAX])
{
    char link[PATH_MAX];
    return snprintf(link, sizeof link, "%s/class/tty/%s/device", adapter_sysfs, name) < (int)sizeof link &&
           realpath(link, folder) != NULL;
}

/*
 * The socket of the USB device in a folder such as /sys/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1.2: the folder of
 * the controller, the speed of its bus (a controller has one for USB 2 and one for USB 3), and 1.2. The number of the
 * bus may change when the kernel finds the controllers again.
 */
static void name_socket(adapter_identity_t *identity, const char *folder)
{
    char bus[PATH_MAX];
    char speed[ADAPTER_NAME] = "";
    const char *const ports = strchr(adapter_last_name(folder), '-');
    const char *root = folder;
    size_t length = strlen(folder);
    (void)snprintf(identity->place, sizeof identity->place, "%.*s", ADAPTER_NAME - 1,
                   adapter_last_name(folder));
    while ((root = strstr(root, "/usb")) != NULL) {
        if (isdigit((unsigned char)root[4]) != 0 && strchr(root + 1, '/') != NULL) {
            length = (size_t)(root - folder);
            (void)snprintf(bus, sizeof bus, "%.*s", (int)(strchr(root + 1, '/') - folder), folder);
            (void)read_attribute(bus, "speed", speed, sizeof speed);
        }
        root++;
    }
    (void)snprintf(identity->socket, sizeof identity->socket, "%.*s %s %s", (int)length, folder, speed,
                   ports != NULL ? ports + 1 : "");
}

/*
 * The `device` of a tty is the interface (cdc_acm: .../1-2/1-2:1.0), or a port below it (usb-serial:
 * .../1-2/1-2:1.0/ttyUSB0). The USB device is the first folder above that has an idVendor.
 */
bool adapter_identity_read(adapter_identity_t *identity, const char *name)
{
    char folder[PATH_MAX];
    memset(identity, 0, sizeof *identity);
    if (!device_folder(name, folder)) return false;
    (void)read_attribute(folder, "port_number", identity->port, sizeof identity->port);
    while (strchr(folder, '/') != NULL) {
        if (identity->interface[0] == '\0')
            (void)read_attribute(folder, "bInterfaceNumber", identity->interface, sizeof identity->interface);
        if (read_attribute(folder, "idVendor", identity->vendor, sizeof identity->vendor)) break;
        *strrchr(folder, '/') = '\0';
    }
    if (identity->vendor[0] == '\0') {
        memset(identity, 0, sizeof *identity);
        return false;
    }
    (void)read_attribute(folder, "idProduct", identity->product, sizeof identity->product);
    (void)read_attribute(folder, "serial", identity->serial, sizeof identity->serial);
    name_socket(identity, folder);
    (void)snprintf(identity->name, sizeof identity->name, "%.*s", ADAPTER_NAME - 1, name);
    return true;
}

bool adapter_identity_is_there(const char *name)
{
    char path[PATH_MAX];
    return snprintf(path, sizeof path, "%s/class/tty/%s", adapter_sysfs, name) < (int)sizeof path &&
           access(path, F_OK) == 0;
}

bool adapter_identity_is_expected(const char *path)
{
    const char *const name = adapter_last_name(path);
    return strncmp(name, "ttyUSB", 6) == 0 || strncmp(name, "ttyACM", 6) == 0 ||
           strncmp(path, "/dev/serial/", 12) == 0;
}

void adapter_identities_each(void (*each)(void *ctx, const adapter_identity_t *identity), void *ctx)
{
    char folder[PATH_MAX];
    if (snprintf(folder, sizeof folder, "%s/class/tty", adapter_sysfs) >= (int)sizeof folder) return;
    DIR *const ttys = opendir(folder);
    if (ttys == NULL) return;
    const struct dirent *entry = NULL;
    while ((entry = readdir(ttys)) != NULL) { /* NOLINT(concurrency-mt-unsafe): one thread */
        adapter_identity_t identity;
        if (adapter_identity_read(&identity, entry->d_name)) each(ctx, &identity);
    }
    (void)closedir(ttys);
}

bool adapter_identity_is_same_port(const adapter_identity_t *one, const adapter_identity_t *other)
{
    return strcmp(one->interface, other->interface) == 0 && strcmp(one->port, other->port) == 0;
}

bool adapter_identity_is_same(const adapter_identity_t *one, const adapter_identity_t *other)
{
    return strcmp(one->vendor, other->vendor) == 0 && strcmp(one->product, other->product) == 0 &&
           strcmp(one->serial, other->serial) == 0 && adapter_identity_is_same_port(one, other);
}

unsigned adapter_latency_ms(const char *path)
{
    char real[PATH_MAX];
    char folder[PATH_MAX];
    char word[ADAPTER_NAME];
    if (realpath(path, real) == NULL || !device_folder(adapter_last_name(real), folder) ||
        !read_attribute(folder, "latency_timer", word, sizeof word))
        return 0;
    return (unsigned)strtoul(word, NULL, 10);
}

/* ---- changes ---- */

static int changes_fd = -1;

bool adapter_changes_start(void)
{
    if (changes_fd >= 0) return true;
    changes_fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (changes_fd < 0 || inotify_add_watch(changes_fd, adapter_dev, IN_CREATE | IN_DELETE) >= 0)
        return changes_fd >= 0;
    (void)close(changes_fd);
    changes_fd = -1;
    return false;
}

static void report(const adapter_changes_t *changes, const struct inotify_event *event)
{
    const bool is_tty = event->len != 0 && strncmp(event->name, "tty", 3) == 0;
    if ((event->mask & IN_Q_OVERFLOW) != 0) changes->is_missed();
    if (is_tty && (event->mask & IN_CREATE) != 0) changes->is_new(event->name);
    if (is_tty && (event->mask & IN_DELETE) != 0) changes->is_removed(event->name);
}

void adapter_changes_read(const adapter_changes_t *changes)
{
    union {
        struct inotify_event event; /* for its alignment */
        char bytes[4096];
    } buffer;
    ssize_t length = 0;
    while (changes_fd >= 0 && (length = read(changes_fd, buffer.bytes, sizeof buffer.bytes)) > 0) {
        for (ssize_t at = 0; at < length;) {
            const struct inotify_event *const event = (const struct inotify_event *)(buffer.bytes + at);
            report(changes, event);
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
}

static const adapter_changes_t *loop_changes;

static int source_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return changes_fd;
}

static bool poll_source(fathom_loop_source_t *source)
{
    (void)source;
    adapter_changes_read(loop_changes);
    return true;
}

void adapter_changes_watch(fathom_loop_t *loop, const adapter_changes_t *changes)
{
    static const fathom_loop_kind_t kind = {.fd = source_fd, .poll = poll_source};
    static fathom_loop_source_t source;
    if (!adapter_changes_start()) return;
    loop_changes = changes;
    memset(&source, 0, sizeof source);
    source.kind = &kind;
    fathom_loop_add(loop, &source);
}
