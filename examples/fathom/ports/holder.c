/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): statx, realpath */
#include "ports/holder.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include "output/words.h"
#include "ports/adapter.h"

const char *holder_proc = "/proc";

/* ---- files of a process ---- */

enum { TEXT = 512 };

/* Reads the beginning of a file. Returns false and sets "" if there is none. */
__attribute__((format(printf, 2, 3))) static bool read_file(char text[TEXT], const char *format, ...)
{
    char path[PATH_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(path, sizeof path, format, arguments);
    va_end(arguments);
    FILE *const file = fopen(path, "re");
    const size_t length = file != NULL ? fread(text, 1, TEXT - 1, file) : 0;
    text[length] = '\0';
    if (file != NULL) (void)fclose(file);
    return length != 0;
}

static DIR *open_descriptors(int pid)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%d/fd", holder_proc, pid);
    return opendir(path);
}

/* ---- who has which device open ---- */

/* Linux, Documentation/admin-guide/devices.txt */
enum { MEMORY_MAJOR = 1, PTMX_MAJOR = 5, PTMX_MINOR = 2, PTY_MAJOR = 136 };

/* A device that a process has open. Containers have pseudo terminals of the same number in other file systems. */
typedef struct {
    dev_t device;
    dev_t system; /* the file system of a pseudo terminal; 0: unknown, or another device */
    int pid;
    int fd; /* -1: it is the controlling terminal */
    bool is_master;
} use_t;

static use_t *uses; /* by all other processes that this user can see */
static size_t use_count;
static bool has_hidden; /* processes whose descriptors this user cannot see */

static void add_use(use_t use)
{
    enum { CHUNK = 64 };
    if (use_count % CHUNK == 0) uses = reallocate(uses, (use_count + CHUNK) * sizeof *uses);
    uses[use_count++] = use;
}

static dev_t system_of(dev_t device, dev_t system) { return major(device) == PTY_MAJOR ? system : 0; }

/* The stat of the file of an unreachable server would wait for it. */
static void add_descriptor(int pid, int folder, const char *name)
{
    struct statx status;
    if (!isdigit((unsigned char)name[0]) ||
        statx(folder, name, AT_STATX_DONT_SYNC | AT_NO_AUTOMOUNT, STATX_TYPE, &status) != 0 ||
        !S_ISCHR(status.stx_mode) || status.stx_rdev_major == MEMORY_MAJOR)
        return;
    use_t use = {.device = makedev(status.stx_rdev_major, status.stx_rdev_minor),
                 .pid = pid,
                 .fd = (int)strtol(name, NULL, 10)};
    use.system = system_of(use.device, makedev(status.stx_dev_major, status.stx_dev_minor));
    use.is_master = use.device == makedev(PTMX_MAJOR, PTMX_MINOR);
    if (use.is_master) {
        char text[TEXT];
        (void)read_file(text, "%s/%d/fdinfo/%d", holder_proc, pid, use.fd);
        const char *const index = strstr(text, "tty-index:");
        if (index == NULL) return;
        use.device = makedev(PTY_MAJOR, (unsigned)strtoul(index + strlen("tty-index:"), NULL, 10));
    }
    add_use(use);
}

/* Every user may read the number of the controlling terminal: it follows the state, the parent, the group and the
 * session (proc_pid_stat(5)). */
static void add_terminal(int pid)
{
    char text[TEXT];
    (void)read_file(text, "%s/%d/stat", holder_proc, pid);
    const char *at = strrchr(text, ')');
    for (unsigned field = 0; at != NULL && field != 5; field++) at = strchr(at + 1, ' ');
    const unsigned number = at != NULL ? (unsigned)strtoul(at, NULL, 10) : 0;
    if (number == 0) return;
    add_use((use_t){.device = makedev(number >> 8 & 0xFFFu, (number & 0xFFu) | (number >> 12 & 0xFFF00u)),
                    .pid = pid,
                    .fd = -1});
}

static void search_process(int pid)
{
    DIR *const descriptors = open_descriptors(pid);
    const struct dirent *entry = NULL;
    if (descriptors == NULL && errno == EACCES) {
        has_hidden = true;
        add_terminal(pid);
    }
    while (descriptors != NULL && (entry = readdir(descriptors)) != NULL) /* NOLINT: one thread */
        add_descriptor(pid, dirfd(descriptors), entry->d_name);
    if (descriptors != NULL) (void)closedir(descriptors);
}

static void search_processes(void)
{
    DIR *const processes = opendir(holder_proc);
    const struct dirent *entry = NULL;
    use_count = 0;
    has_hidden = processes == NULL;
    while (processes != NULL && (entry = readdir(processes)) != NULL) { /* NOLINT: one thread */
        const int pid = (int)strtol(entry->d_name, NULL, 10);
        if (pid > 0 && pid != getpid()) search_process(pid);
    }
    if (processes != NULL) (void)closedir(processes);
}

/* Ports that fail at the same time share a search. */
static void search_again(void)
{
    enum { SHARED_US = 200000, EVERY_US = 60000000, MOST = 3 };
    static uint64_t searched_us;
    static uint64_t paid_until_us; /* each search costs a minute, and up to three are paid later */
    const uint64_t now_us = fathom_posix_now_us() + (uint64_t)MOST * EVERY_US;
    if (searched_us != 0 && now_us - searched_us < SHARED_US) return;
    if (paid_until_us + EVERY_US > now_us) return;
    if (paid_until_us < now_us - (uint64_t)MOST * EVERY_US)
        paid_until_us = now_us - (uint64_t)MOST * EVERY_US;
    paid_until_us += EVERY_US;
    searched_us = now_us;
    search_processes();
}

static bool is_far_end(int pid, dev_t device)
{
    for (size_t i = 0; i != use_count; i++)
        if (uses[i].is_master && uses[i].pid == pid && uses[i].device == device) return true;
    return false;
}

/* The process may have closed it since the search. */
static bool is_used_still(const use_t *use)
{
    char path[PATH_MAX];
    struct stat status;
    if (use->fd < 0) return kill(use->pid, 0) == 0 || errno == EPERM;
    (void)snprintf(path, sizeof path, "%s/%d/fd/%d", holder_proc, use->pid, use->fd);
    return stat(path, &status) == 0 && status.st_rdev == use->device;
}

/* Returns the process with the lowest number, and sets the number of processes. 0: none. */
static int find_process(dev_t device, dev_t system, unsigned *count)
{
    int first = 0;
    int newest = 0; /* the descriptors of a process follow each other */
    *count = 0;
    for (size_t i = 0; i != use_count; i++) {
        const use_t *const use = &uses[i];
        if (use->device != device || use->is_master || use->pid == newest ||
            (use->system != 0 && use->system != system) || is_far_end(use->pid, device) ||
            !is_used_still(use))
            continue;
        newest = use->pid;
        if ((*count)++ == 0) first = newest;
    }
    return first;
}

/* ---- other evidence ---- */

/* Returns true if a word of the text is this tty. A word of the kernel's command line is console=ttyS0,115200. */
static bool names_tty(const char *text, const char *before, const char *tty)
{
    const size_t length = strlen(before);
    for (text += strspn(text, " \n"); *text != '\0'; text += strspn(text, " \n")) {
        const size_t end = strcspn(text, " \n");
        if (strncmp(text, before, length) == 0 && strcspn(text + length, ", \n") == strlen(tty) &&
            strncmp(text + length, tty, strlen(tty)) == 0)
            return true;
        text += end;
    }
    return false;
}

static bool is_console(const char *tty)
{
    char text[TEXT];
    return read_file(text, "%s/class/tty/console/active", adapter_sysfs)
               ? names_tty(text, "", tty)
               : read_file(text, "%s/cmdline", holder_proc) && names_tty(text, "console=", tty);
}

/* Returns true if another program changed the settings: one that waits for lines of text, or reads another rate. */
static bool is_changed(const fathom_posix_uart_t *serial, const struct termios *tty)
{
    static const struct {
        uint32_t baud;
        speed_t speed;
    } rates[] = {{9600, B9600},   {19200, B19200},   {38400, B38400},
                 {57600, B57600}, {115200, B115200}, {230400, B230400}};
    for (size_t i = 0; i != sizeof rates / sizeof rates[0]; i++)
        if (rates[i].speed == cfgetospeed(tty) && rates[i].baud != serial->line.baud) return true;
    return tty->c_lflag != 0 || tty->c_iflag != 0 || tty->c_cc[VMIN] == 0;
}

/* Returns true if a device that was hung up can be opened again: it was not unplugged. While the kernel removes a
 * device, opening it fails, but its file may still be there. */
static bool is_there(int fd, const char *path)
{
    struct stat status;
    if (fstat(fd, &status) != 0 || status.st_nlink == 0) return false;
    const int again = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (again >= 0) (void)close(again);
    return again >= 0 || errno == EBUSY || errno == EACCES;
}

/* ---- what it means ---- */

/* Sets the name of the device below /dev, by which systemd and the kernel know it: "ttyS0", "pts/3". */
static void name_tty(char tty[TEXT], const char *path)
{
    char real[PATH_MAX];
    const char *name = realpath(path, real) != NULL ? real : path;
    if (strncmp(name, "/dev/", strlen("/dev/")) == 0)
        name += strlen("/dev/");
    else
        name = last_part(name);
    (void)snprintf(tty, TEXT, "%.64s", name);
}

/* Sets the service of systemd to which a process belongs; "": none, or one of a user. */
static void name_unit(char unit[TEXT], const char *process)
{
    char text[TEXT];
    (void)read_file(text, "%s/%s/cgroup", holder_proc, process);
    const char *const named = strstr(text, "name=systemd:");
    const char *const line = named != NULL ? named : strstr(text, "0::");
    unit[0] = '\0';
    if (line == NULL) return;
    (void)snprintf(unit, TEXT, "%.*s", (int)strcspn(line, "\n"), line);
    char *const last = strrchr(unit, '/');
    char *const end = last != NULL ? strstr(last, ".service") : NULL;
    if (end == NULL || end[strlen(".service")] != '\0' || strstr(unit, "/user.slice/") != NULL) {
        unit[0] = '\0';
        return;
    }
    *end = '\0';
    memmove(unit, last + 1, strlen(last));
}

static void name_program(holder_t *holder, int pid, unsigned count, const char *tty)
{
    char name[TEXT];
    char number[16];
    char unit[TEXT];
    char own[TEXT];
    (void)snprintf(number, sizeof number, "%d", pid);
    if (!read_file(name, "%s/%d/comm", holder_proc, pid)) return;
    name[strcspn(name, "\n")] = '\0';
    holder->program = 1;
    for (char *at = name; *at != '\0'; at++) {
        if (isprint((unsigned char)*at) == 0) *at = '?';
        holder->program = holder->program * 31 + (unsigned char)*at;
    }
    if (count > 1)
        (void)snprintf(holder->who, sizeof holder->who, "%.16s (process %d) and %u more", name, pid,
                       count - 1);
    else
        (void)snprintf(holder->who, sizeof holder->who, "%.16s (process %d)", name, pid);
    name_unit(unit, number);
    name_unit(own, "self");
    if (unit[0] == '\0' && (strstr(name, "getty") != NULL || strcmp(name, "login") == 0))
        (void)snprintf(unit, sizeof unit, "serial-getty@%.32s", tty);
    if (unit[0] != '\0' && strcmp(unit, own) != 0)
        (void)snprintf(holder->stop, sizeof holder->stop, "Stop it with 'sudo systemctl stop %.80s'", unit);
    else
        (void)strcpy(holder->stop, "Stop it");
}

void holder_find(holder_t *holder, const fathom_posix_uart_t *serial, const char *path)
{
    char tty[TEXT];
    struct stat status;
    struct termios settings;
    unsigned count = 0;
    *holder = (holder_t){.is_hidden = false};
    const int fd = fathom_posix_fd(serial);
    if (fd < 0 && fathom_posix_error(serial) != FATHOM_POSIX_ERR_IN_USE) return; /* it is simulated */
    if ((fd >= 0 ? fstat(fd, &status) : stat(path, &status)) != 0 || !S_ISCHR(status.st_mode)) return;
    if (fd >= 0 && tcgetattr(fd, &settings) == 0)
        holder->is_changed = is_changed(serial, &settings);
    else if (fd >= 0)
        holder->is_hung_up = is_there(fd, path);
    name_tty(tty, path);
    search_again();
    const int pid = find_process(status.st_rdev, system_of(status.st_rdev, status.st_dev), &count);
    if (pid != 0) name_program(holder, pid, count, tty);
    holder->is_hidden = has_hidden && holder->program == 0;
    holder->is_console = is_console(tty);
}
