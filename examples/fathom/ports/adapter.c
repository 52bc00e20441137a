/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): realpath */
#include "ports/adapter.h"

#include <ctype.h>
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "output/words.h"

const char *adapter_sysfs = "/sys";
const char *adapter_dev = "/dev";

/* ---- sysfs ---- */

/* Reads the only line of an attribute. Returns false and sets "" if there is none. */
static bool read_attribute(const char *folder, const char *name, char word[64])
{
    char path[PATH_MAX];
    word[0] = '\0';
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return false;
    FILE *const file = fopen(path, "re");
    if (file == NULL) return false;
    if (fgets(word, 64, file) == NULL) word[0] = '\0';
    (void)fclose(file);
    word[strcspn(word, "\n")] = '\0';
    return true;
}

static bool tty_folder(const char *name, char folder[PATH_MAX])
{
    char link[PATH_MAX];
    return snprintf(link, sizeof link, "%s/class/tty/%s/device", adapter_sysfs, name) < (int)sizeof link &&
           realpath(link, folder) != NULL;
}

unsigned adapter_latency_ms(const char *path)
{
    char real[PATH_MAX];
    char folder[PATH_MAX];
    char word[64];
    if (realpath(path, real) == NULL || !tty_folder(last_part(real), folder)) return 0;
    return read_attribute(folder, "latency_timer", word) ? (unsigned)strtoul(word, NULL, 10) : 0;
}

/*
 * Names the socket of the USB device in a folder such as /sys/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1.2: the folder
 * of the controller, and -1.2. The number of the bus does not count, since the kernel may find the controllers again in
 * another order.
 */
static void name_socket(usb_t *usb, const char *folder)
{
    const char *const name = last_part(folder);
    const char *bus = strstr(folder, "/usb");
    while (bus != NULL && isdigit((unsigned char)bus[4]) == 0) bus = strstr(bus + 1, "/usb");
    if (bus == NULL) bus = name;
    (void)snprintf(usb->place, sizeof usb->place, "%.31s", name);
    (void)snprintf(usb->socket, sizeof usb->socket, "%.*s %s", (int)(bus - folder), folder,
                   name + strcspn(name, "-"));
}

/*
 * The `device` of a tty is the interface (cdc_acm: .../1-2/1-2:1.0), or a port below it (usb-serial:
 * .../1-2/1-2:1.0/ttyUSB0). The USB device is the first folder above that has an idVendor. False: there is none.
 */
static bool read_usb(usb_t *usb, const char *tty)
{
    char folder[PATH_MAX];
    char port[64];
    char interface[64] = "";
    char vendor[64] = "";
    char product[64];
    memset(usb, 0, sizeof *usb);
    if (!tty_folder(tty, folder)) return false;
    (void)read_attribute(folder, "port_number", port);
    while (strchr(folder, '/') != NULL && !read_attribute(folder, "idVendor", vendor)) {
        if (interface[0] == '\0') (void)read_attribute(folder, "bInterfaceNumber", interface);
        *strrchr(folder, '/') = '\0';
    }
    if (vendor[0] == '\0') return false;
    (void)read_attribute(folder, "idProduct", product);
    (void)read_attribute(folder, "serial", usb->serial);
    (void)snprintf(usb->tty, sizeof usb->tty, "%.31s", tty);
    (void)snprintf(usb->identity, sizeof usb->identity, "%.8s %.8s %s %.8s %.8s", vendor, product,
                   usb->serial, interface, port);
    name_socket(usb, folder);
    return true;
}

/* ---- twins ---- */

typedef struct {
    usb_t *all;
    size_t count;
} list_t;

static list_t present;        /* the adapters that are plugged in */
static list_t shared;         /* those whose identity another one had at the same time */
static unsigned unknown_ttys; /* that have appeared, and about which nothing is known; one may be a twin */

static void append(list_t *list, const usb_t *usb)
{
    list->all = reallocate(list->all, (list->count + 1) * sizeof *list->all);
    list->all[list->count++] = *usb;
}

static bool is_twin(const usb_t *usb, const usb_t *other)
{
    return strcmp(usb->identity, other->identity) == 0 && strcmp(usb->socket, other->socket) != 0;
}

static bool is_shared(const usb_t *usb)
{
    for (size_t i = 0; i != shared.count; i++)
        if (strcmp(shared.all[i].identity, usb->identity) == 0) return true;
    return false;
}

static void add_present(const usb_t *usb)
{
    for (size_t i = 0; i != present.count; i++)
        if (is_twin(&present.all[i], usb) && !is_shared(usb)) append(&shared, usb);
    append(&present, usb);
}

static void list_present(void)
{
    char folder[PATH_MAX];
    (void)snprintf(folder, sizeof folder, "%s/class/tty", adapter_sysfs);
    DIR *const ttys = opendir(folder);
    const struct dirent *entry = NULL;
    present.count = 0;
    while (ttys != NULL && (entry = readdir(ttys)) != NULL) { /* NOLINT(concurrency-mt-unsafe): one thread */
        usb_t usb;
        if (read_usb(&usb, entry->d_name)) add_present(&usb);
    }
    if (ttys != NULL) (void)closedir(ttys);
}

int adapter_fd(void)
{
    static int fd = -1;
    if (fd >= 0) return fd;
    fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (fd >= 0 && inotify_add_watch(fd, adapter_dev, IN_CREATE) < 0) {
        (void)close(fd);
        fd = -1;
    }
    return fd;
}

void adapter_look(void)
{
    union {
        struct inotify_event event; /* for its alignment */
        char bytes[4096];
    } buffer;
    const int fd = adapter_fd();
    ssize_t length = 0;
    if (fd < 0) unknown_ttys++;
    while (fd >= 0 && (length = read(fd, buffer.bytes, sizeof buffer.bytes)) > 0) {
        for (const char *at = buffer.bytes; at < buffer.bytes + length;) {
            const struct inotify_event *const event = (const struct inotify_event *)(const void *)at;
            usb_t usb;
            const bool is_tty = event->len != 0 && strncmp(event->name, "tty", 3) == 0;
            if (event->len == 0 || (is_tty && !read_usb(&usb, event->name))) unknown_ttys++;
            at += sizeof *event + event->len;
        }
    }
    list_present();
}

/* ---- advice ---- */

static const char unknown_adapter[] =
    "nothing is known about this adapter, so any adapter at this path will be read";

/* Makers give such serial numbers to a whole series: 0001, 000000, 123456789. Each character repeats the one before it
 * or follows it. */
static bool is_counted(const char *serial)
{
    for (; serial[0] != '\0' && serial[1] != '\0'; serial++) {
        const bool is_wrapped = serial[0] == '9' && (serial[1] == '0' || serial[1] == 'A');
        if (serial[1] != serial[0] && serial[1] != serial[0] + 1 && !is_wrapped) return false;
    }
    return true;
}

/* Returns why the identity does not find the adapter; NULL: it does, or there is none. */
static const char *advice_for(const adapter_t *adapter)
{
    const char *const name = last_part(adapter->wanted);
    const bool is_usb = strncmp(name, "ttyUSB", 6) == 0 || strncmp(name, "ttyACM", 6) == 0;
    if (adapter->known.tty[0] == '\0') return adapter->was_open && is_usb ? unknown_adapter : NULL;
    if (adapter->known.serial[0] == '\0') return "this adapter has no serial number";
    if (is_shared(&adapter->known) || adapter->unknown_ttys != unknown_ttys)
        return "another adapter has, or may have had, the same serial number";
    return is_counted(adapter->known.serial) ? "other adapters may have the same serial number" : NULL;
}

const char *adapter_doubt(const adapter_t *adapter)
{
    if (!adapter->is_moved || !is_shared(&adapter->known)) return NULL;
    return "another adapter with the same serial number was plugged in after this one had moved to another "
           "USB socket, so the right one is unknown; start again with its link in /dev/serial/by-path";
}

const char *adapter_advice(adapter_t *adapter)
{
    static char text[256];
    const char *const advice = adapter->wanted != NULL ? advice_for(adapter) : NULL;
    if (advice == adapter->advice || adapter_doubt(adapter) != NULL) return NULL;
    adapter->advice = advice;
    if (advice == NULL || advice == unknown_adapter) return advice;
    (void)snprintf(text, sizeof text, "%s. Plug this adapter into the same USB socket (%s)", advice,
                   adapter->known.place);
    return text;
}

/* ---- finding ---- */

/* Nothing is known yet: the adapter behind the path. */
static const char *find_first(adapter_t *adapter)
{
    char real[PATH_MAX];
    char by_id[PATH_MAX];
    if (realpath(adapter->wanted, real) == NULL || !read_usb(&adapter->found, last_part(real))) return NULL;
    adapter_look();
    (void)snprintf(by_id, sizeof by_id, "%s/serial/by-id/", adapter_dev);
    if (is_shared(&adapter->found) && strncmp(adapter->wanted, by_id, strlen(by_id)) == 0)
        return "several adapters have this identity; name the right one by its link in /dev/serial/by-path";
    return NULL;
}

static const char *find_again(adapter_t *adapter)
{
    const usb_t *const known = &adapter->known;
    adapter_look();
    const char *const doubt = adapter_doubt(adapter);
    if (doubt != NULL) return doubt;
    for (size_t i = 0; i != present.count; i++) {
        const usb_t *const usb = &present.all[i];
        if (strcmp(usb->identity, known->identity) != 0) continue;
        if (!is_twin(usb, known) || advice_for(adapter) == NULL) adapter->found = *usb;
        if (!is_twin(usb, known)) break;
    }
    return adapter->found.tty[0] != '\0' ? NULL : "";
}

const char *adapter_find(adapter_t *adapter, const char *wanted)
{
    adapter->wanted = wanted;
    memset(&adapter->found, 0, sizeof adapter->found);
    const char *const reason = adapter->known.tty[0] == '\0' ? find_first(adapter) : find_again(adapter);
    if (adapter->found.tty[0] != '\0')
        (void)snprintf(adapter->path, sizeof adapter->path, "%s/%s", adapter_dev, adapter->found.tty);
    return reason;
}

bool adapter_open(adapter_t *adapter)
{
    usb_t now;
    adapter->was_open = true;
    if (adapter->found.tty[0] == '\0') return true;
    adapter_look();
    if (!read_usb(&now, adapter->found.tty) || strcmp(now.identity, adapter->found.identity) != 0 ||
        is_twin(&now, &adapter->found))
        return false;
    if (is_twin(&now, &adapter->known)) adapter->is_moved = true;
    adapter->known = now;
    adapter->unknown_ttys = unknown_ttys;
    adapter->advice = NULL;
    return true;
}
