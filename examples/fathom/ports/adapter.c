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

const char *adapter_sysfs = "/sys";
const char *adapter_dev = "/dev";

static adapter_t *open_ones;
static int changes_fd = -1; /* inotify(7), of the folder of the device files */

static const char *last_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

/* ---- sysfs ---- */

/* Reads the only line of an attribute. Returns false and sets "" if there is none. */
static bool read_attribute(const char *folder, const char *name, char word[ADAPTER_SERIAL])
{
    char path[PATH_MAX];
    word[0] = '\0';
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return false;
    FILE *const file = fopen(path, "re");
    if (file == NULL) return false;
    if (fgets(word, ADAPTER_SERIAL, file) == NULL) word[0] = '\0';
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

/*
 * The socket of the USB device in a folder such as /sys/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1.2: the folder of
 * the controller, and 1.2. The number of the bus does not count, since the kernel may find the controllers again in
 * another order.
 */
static void name_socket(adapter_facts_t *facts, const char *folder)
{
    const char *const name = last_name(folder);
    const char *bus = strstr(folder, "/usb");
    while (bus != NULL && isdigit((unsigned char)bus[4]) == 0) bus = strstr(bus + 1, "/usb");
    if (bus == NULL) bus = name;
    (void)snprintf(facts->place, sizeof facts->place, "%.*s", ADAPTER_NAME - 1, name);
    (void)snprintf(facts->socket, sizeof facts->socket, "%.*s %s", (int)(bus - folder), folder,
                   name + strcspn(name, "-"));
}

/*
 * The `device` of a tty is the interface (cdc_acm: .../1-2/1-2:1.0), or a port below it (usb-serial:
 * .../1-2/1-2:1.0/ttyUSB0). The USB device is the first folder above that has an idVendor. False: there is none.
 */
static bool read_facts(adapter_facts_t *facts, const char *name)
{
    char folder[PATH_MAX];
    char port[ADAPTER_SERIAL];
    char interface[ADAPTER_SERIAL] = "";
    char vendor[ADAPTER_SERIAL] = "";
    char product[ADAPTER_SERIAL];
    memset(facts, 0, sizeof *facts);
    if (!tty_folder(name, folder)) return false;
    (void)read_attribute(folder, "port_number", port);
    while (strchr(folder, '/') != NULL && !read_attribute(folder, "idVendor", vendor)) {
        if (interface[0] == '\0') (void)read_attribute(folder, "bInterfaceNumber", interface);
        *strrchr(folder, '/') = '\0';
    }
    if (vendor[0] == '\0') return false;
    (void)read_attribute(folder, "idProduct", product);
    (void)read_attribute(folder, "serial", facts->serial);
    (void)snprintf(facts->name, sizeof facts->name, "%.*s", ADAPTER_NAME - 1, name);
    (void)snprintf(facts->identity, sizeof facts->identity, "%.8s %.8s %s %.8s %.8s", vendor, product,
                   facts->serial, interface, port);
    name_socket(facts, folder);
    return true;
}

unsigned adapter_latency_ms(const char *path)
{
    char real[PATH_MAX];
    char folder[PATH_MAX];
    char word[ADAPTER_SERIAL];
    if (realpath(path, real) == NULL || !tty_folder(last_name(real), folder)) return 0;
    return read_attribute(folder, "latency_timer", word) ? (unsigned)strtoul(word, NULL, 10) : 0;
}

/* Looks among all ttys for adapters with this identity. Returns how many there are; *in_socket is the one in the same
 * socket, *elsewhere one in another socket. */
static unsigned search(const adapter_facts_t *wanted, adapter_facts_t *in_socket, adapter_facts_t *elsewhere)
{
    char folder[PATH_MAX];
    unsigned count = 0;
    memset(in_socket, 0, sizeof *in_socket);
    memset(elsewhere, 0, sizeof *elsewhere);
    (void)snprintf(folder, sizeof folder, "%s/class/tty", adapter_sysfs);
    DIR *const ttys = opendir(folder);
    const struct dirent *entry = NULL;
    while (ttys != NULL && (entry = readdir(ttys)) != NULL) { /* NOLINT(concurrency-mt-unsafe): one thread */
        adapter_facts_t other;
        if (!read_facts(&other, entry->d_name) || strcmp(wanted->identity, other.identity) != 0) continue;
        count++;
        *(strcmp(wanted->socket, other.socket) == 0 ? in_socket : elsewhere) = other;
    }
    if (ttys != NULL) (void)closedir(ttys);
    return count;
}

/* ---- twins ---- */

static void note_twin(adapter_t *adapter)
{
    adapter->is_shared = true;
    if (adapter->is_moved) adapter->is_doubtful = true;
}

bool adapter_is_doubtful(const adapter_t *adapter) { return adapter->is_doubtful; }

static bool is_there(const char *name)
{
    char path[PATH_MAX];
    return snprintf(path, sizeof path, "%s/class/tty/%s", adapter_sysfs, name) < (int)sizeof path &&
           access(path, F_OK) == 0;
}

static bool is_usb_name(const char *name)
{
    return strncmp(name, "ttyUSB", 6) == 0 || strncmp(name, "ttyACM", 6) == 0;
}

/* A device file appeared. If nothing is known about the tty behind it, since it is being removed or was removed, it may
 * have been a twin. */
static void note_new(adapter_t *adapter, const char *name)
{
    adapter_facts_t other;
    if (!adapter->is_present) return;
    if (!read_facts(&other, name))
        adapter->is_shared = adapter->is_shared || is_usb_name(name) || !is_there(name);
    else if (strcmp(adapter->known.identity, other.identity) == 0 &&
             strcmp(adapter->known.socket, other.socket) != 0)
        note_twin(adapter);
}

static void note_change(const struct inotify_event *event)
{
    const bool is_tty = event->len != 0 && strncmp(event->name, "tty", 3) == 0;
    for (adapter_t *adapter = open_ones; adapter != NULL; adapter = adapter->next) {
        if ((event->mask & IN_Q_OVERFLOW) != 0) adapter->is_shared = true;
        if (is_tty && (event->mask & IN_CREATE) != 0) note_new(adapter, event->name);
        if (is_tty && (event->mask & IN_DELETE) != 0 && strcmp(adapter->known.name, event->name) == 0)
            adapter->is_present = false;
    }
}

/* In their order: a twin that came after the loss of an adapter is its own return. */
static void read_changes(void)
{
    union {
        struct inotify_event event; /* for its alignment */
        char bytes[4096];
    } buffer;
    ssize_t length = 0;
    while (changes_fd >= 0 && (length = read(changes_fd, buffer.bytes, sizeof buffer.bytes)) > 0) {
        for (const char *at = buffer.bytes; at < buffer.bytes + length;) {
            const struct inotify_event *const event = (const struct inotify_event *)(const void *)at;
            note_change(event);
            at += sizeof *event + event->len;
        }
    }
}

static bool start_watching(void)
{
    if (changes_fd >= 0) return true;
    changes_fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (changes_fd < 0 || inotify_add_watch(changes_fd, adapter_dev, IN_CREATE | IN_DELETE) >= 0)
        return changes_fd >= 0;
    (void)close(changes_fd);
    changes_fd = -1;
    return false;
}

static int source_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return changes_fd;
}

static bool poll_source(fathom_loop_source_t *source)
{
    (void)source;
    read_changes();
    return true;
}

void adapter_watch(fathom_loop_t *loop)
{
    static const fathom_loop_kind_t kind = {.fd = source_fd, .poll = poll_source};
    static fathom_loop_source_t source;
    if (!start_watching()) return;
    source = (fathom_loop_source_t){.kind = &kind};
    fathom_loop_add(loop, &source);
}

/* ---- advice ---- */

enum { ADVICE_NONE, ADVICE_NO_SERIAL, ADVICE_COUNTED, ADVICE_SHARED, ADVICE_DOUBTFUL, ADVICE_PATH };

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

/* Why the identity does not find the adapter. */
static int advice_for(const adapter_t *adapter)
{
    const bool is_usb = is_usb_name(last_name(adapter->wanted));
    if (adapter->known.name[0] == '\0') return adapter->was_open && is_usb ? ADVICE_PATH : ADVICE_NONE;
    if (adapter->is_doubtful) return ADVICE_DOUBTFUL;
    if (adapter->known.serial[0] == '\0') return ADVICE_NO_SERIAL;
    if (adapter->is_shared) return ADVICE_SHARED;
    return is_counted(adapter->known.serial) ? ADVICE_COUNTED : ADVICE_NONE;
}

const char *adapter_advice(adapter_t *adapter)
{
    static const char *const reasons[] = {
        [ADVICE_NO_SERIAL] = "this adapter has no serial number",
        [ADVICE_COUNTED] = "other adapters may have the same serial number",
        [ADVICE_SHARED] = "another adapter has, or may have had, the same serial number",
        [ADVICE_PATH] = "nothing is known about this adapter, so any adapter at this path will be read"};
    static char text[256];
    const int advice = advice_for(adapter);
    if (advice == adapter->advice) return NULL;
    adapter->advice = advice;
    if (advice == ADVICE_NONE || advice == ADVICE_DOUBTFUL) return NULL; /* port_error() reports the doubt */
    if (advice == ADVICE_PATH) return reasons[advice];
    (void)snprintf(text, sizeof text, "%s. Plug this adapter into the same USB socket (%s)", reasons[advice],
                   adapter->known.place);
    return text;
}

/* ---- finding ---- */

/* Nothing is known yet: the adapter behind the path. */
static const char *find_first(adapter_t *adapter)
{
    char real[PATH_MAX];
    char by_id[PATH_MAX];
    adapter_facts_t in_socket;
    adapter_facts_t elsewhere;
    adapter->path[0] = '\0';
    memset(&adapter->found, 0, sizeof adapter->found);
    if (realpath(adapter->wanted, real) == NULL || !read_facts(&adapter->found, last_name(real))) return NULL;
    (void)snprintf(adapter->path, sizeof adapter->path, "%s/%s", adapter_dev, adapter->found.name);
    (void)snprintf(by_id, sizeof by_id, "%s/serial/by-id/", adapter_dev);
    if (strncmp(adapter->wanted, by_id, strlen(by_id)) == 0 &&
        search(&adapter->found, &in_socket, &elsewhere) > 1)
        return "several adapters have this identity; name the right one by its link in /dev/serial/by-path";
    return NULL;
}

const char *adapter_find(adapter_t *adapter, const char *wanted)
{
    adapter_facts_t elsewhere;
    read_changes();
    adapter->wanted = wanted;
    if (adapter->known.name[0] == '\0') return find_first(adapter);
    if (search(&adapter->known, &adapter->found, &elsewhere) > 1) note_twin(adapter);
    if (adapter->is_doubtful)
        return "another adapter with the same serial number was plugged in after this one had moved to "
               "another "
               "USB socket, so the right one is unknown; start again with its link in /dev/serial/by-path";
    if (adapter->found.name[0] == '\0' && advice_for(adapter) == ADVICE_NONE) adapter->found = elsewhere;
    if (adapter->found.name[0] == '\0') return "";
    (void)snprintf(adapter->path, sizeof adapter->path, "%s/%s", adapter_dev, adapter->found.name);
    return NULL;
}

bool adapter_open(adapter_t *adapter)
{
    const adapter_facts_t found = adapter->found;
    adapter_facts_t now;
    adapter_facts_t elsewhere;
    adapter->was_open = true;
    if (found.name[0] == '\0') return true;
    /* The watch starts before the search, so that no twin is missed. */
    if (!start_watching()) adapter->is_shared = true;
    const unsigned count = search(&found, &now, &elsewhere);
    if (strcmp(now.name, found.name) != 0) return false;
    if (adapter->known.name[0] != '\0' && strcmp(adapter->known.socket, found.socket) != 0)
        adapter->is_moved = true;
    if (count > 1) note_twin(adapter);
    adapter->known = found;
    adapter->is_present = true;
    adapter->advice = ADVICE_NONE;
    adapter->next = open_ones;
    open_ones = adapter;
    return true;
}

void adapter_close(adapter_t *adapter)
{
    adapter_t **link = &open_ones;
    read_changes();
    while (*link != NULL && *link != adapter) link = &(*link)->next;
    if (*link != NULL) *link = adapter->next;
    adapter->is_present = false;
}
