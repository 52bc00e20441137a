/* SPDX-License-Identifier: MIT */
/* A pseudo terminal with a simulated line behind it, in real time. A program opens it like a serial port. */
#define _DEFAULT_SOURCE /* FIONREAD, rates above 38400; harmless where unknown */
#define _XOPEN_SOURCE   700

#include "pty.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { UNREAD_MOST = 255 };
static const uint32_t longest_wait_us = UINT32_C(600000000); /* sim.h: at least every 30 minutes */

static const struct {
    speed_t speed;
    uint32_t baud;
} rates[] = {
    {B1200, 1200},   {B2400, 2400},     {B4800, 4800},     {B9600, 9600}, {B19200, 19200}, {B38400, 38400},
#ifdef B230400 /* not in POSIX, but everywhere */
    {B57600, 57600}, {B115200, 115200}, {B230400, 230400},
#endif
};

uint32_t fathom_sim_pty_now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)((uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u);
}

/* ---- the link ---- */

/* Was it left behind by a pty that was killed? Then it leads to a terminal that is gone, or whose number is this
 * one's. */
static bool is_left_behind(const char *link, const char *path)
{
    char to[FATHOM_SIM_PTY_PATH];
    const ssize_t length = readlink(link, to, sizeof to - 1);
    const size_t folder = (size_t)(strrchr(path, '/') - path) + 1;
    if (length < 0) return false;
    to[length] = '\0';
    return strncmp(to, path, folder) == 0 && (strcmp(to, path) == 0 || access(to, F_OK) < 0);
}

/* One that is replaced is never missing: the new one has another name first. */
static int make_link(const char *path, const char *link)
{
    char fresh[FATHOM_SIM_PTY_LINK + 24];
    if (symlink(path, link) == 0) return 0;
    if (errno != EEXIST) return -1;
    if (!is_left_behind(link, path)) {
        errno = EEXIST;
        return -1;
    }
    (void)snprintf(fresh, sizeof fresh, "%s.%ld", link, (long)getpid());
    if (symlink(path, fresh) < 0) return -1;
    if (rename(fresh, link) == 0) return 0;
    const int why = errno;
    (void)unlink(fresh);
    errno = why;
    return -1;
}

static void remove_link(const char *path, const char *link)
{
    char now[FATHOM_SIM_PTY_PATH];
    const ssize_t length = readlink(link, now, sizeof now);
    if (length >= 0 && (size_t)length == strlen(path) && memcmp(now, path, (size_t)length) == 0)
        (void)unlink(link);
}

/* ---- the terminal ---- */

static speed_t speed_of(uint32_t baud)
{
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
        if (rates[i].baud == baud) return rates[i].speed;
    return B9600;
}

/* 0: one that no device has */
static uint32_t baud_of(speed_t speed)
{
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
        if (rates[i].speed == speed) return rates[i].baud;
    return 0;
}

static int make_raw(int fd, uint32_t baud)
{
    struct termios raw;
    if (tcgetattr(fd, &raw) < 0) return -1;
    raw.c_iflag = 0;
    raw.c_oflag = 0;
    raw.c_lflag = 0;
    raw.c_cflag = CS8 | CREAD | CLOCAL;
    raw.c_cc[VMIN] = 1;
    raw.c_cc[VTIME] = 0;
    if (cfsetispeed(&raw, speed_of(baud)) < 0 || cfsetospeed(&raw, speed_of(baud)) < 0) return -1;
    return tcsetattr(fd, TCSANOW, &raw);
}

static int set_flags(int fd)
{
    const int flags = fcntl(fd, F_GETFL);
    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0) return -1;
    return fcntl(fd, F_SETFD, FD_CLOEXEC);
}

static int open_terminal(fathom_sim_pty_t *pty)
{
    pty->master = posix_openpt(O_RDWR | O_NOCTTY);
    if (pty->master < 0 || grantpt(pty->master) < 0 || unlockpt(pty->master) < 0) return -1;
    const char *const path = ptsname(pty->master);
    if (path == NULL) return -1;
    if (strlen(path) >= sizeof pty->path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    memcpy(pty->path, path, strlen(path) + 1);
    pty->slave = open(pty->path, O_RDWR | O_NOCTTY);
    if (pty->slave < 0 || set_flags(pty->slave) < 0 || set_flags(pty->master) < 0) return -1;
    return make_raw(pty->slave, pty->line->settings.baud);
}

int fathom_sim_pty_open(fathom_sim_pty_t *pty, fathom_sim_line_t *line, const fathom_sim_pty_config_t *config)
{
    const char *const link = config != NULL ? config->link : NULL;
    memset(pty, 0, sizeof *pty);
    pty->line = line;
    pty->opened = line->settings;
    pty->master = pty->slave = -1;
    pty->ignore_baud = config != NULL && config->ignore_baud;
    if (link != NULL && strlen(link) >= sizeof pty->link) {
        errno = ENAMETOOLONG;
        return -1;
    }
    if (open_terminal(pty) == 0 && (link == NULL || make_link(pty->path, link) == 0)) {
        if (link != NULL) memcpy(pty->link, link, strlen(link) + 1);
        return 0;
    }
    const int why = errno;
    fathom_sim_pty_close(pty);
    errno = why;
    return -1;
}

void fathom_sim_pty_close(fathom_sim_pty_t *pty)
{
    if (pty->link[0] != '\0') remove_link(pty->path, pty->link);
    pty->link[0] = '\0';
    if (pty->slave >= 0) (void)close(pty->slave);
    if (pty->master >= 0) (void)close(pty->master);
    pty->master = pty->slave = -1;
}

/* ---- a step ---- */

static bool nothing_now(void) { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/* Parity and stop bits do not come through: of two devices with one rate the first one is right. */
static fathom_line_settings_t settings_at(const fathom_sim_pty_t *pty, uint32_t baud)
{
    fathom_line_settings_t settings = pty->opened;
    settings.baud = baud;
    for (const fathom_sim_device_t *device = pty->line->devices; device != NULL; device = device->next)
        if (device->settings.baud == baud) return device->settings;
    return settings;
}

/* What the client has set is what its UART would be at. */
static int follow_baud(fathom_sim_pty_t *pty)
{
    struct termios seen;
    const fathom_line_settings_t *const now = &pty->line->settings;
    if (pty->ignore_baud) return 0;
    if (tcgetattr(pty->slave, &seen) < 0) return -1;
    const uint32_t baud = baud_of(cfgetospeed(&seen));
    /* a rate that is not in the table: no device has it, and the line needs one */
    const fathom_line_settings_t wanted = settings_at(pty, baud != 0 ? baud : 1200);
    if (wanted.baud == now->baud && wanted.parity == now->parity && wanted.stop_bits == now->stop_bits)
        return 0;
    /* From where the line stands, so that a late call does not simulate what follows at the old rate. */
    fathom_sim_set_line(pty->line, &wanted, pty->line->now_us);
    return 0;
}

static int take_from_client(fathom_sim_pty_t *pty, uint32_t now_us)
{
    uint8_t bytes[FATHOM_SIM_QUEUE];
    for (;;) {
        size_t space = FATHOM_SIM_QUEUE - fathom_sim_queued(pty->line, now_us);
        if (space == 0) return 0; /* the rest waits in the terminal, as behind a slow UART */
        const ssize_t count = read(pty->master, bytes, space);
        if (count < 0) return nothing_now() ? 0 : -1;
        if (count == 0) return 0;
        /* It has set its rate before it wrote, perhaps since that was looked at last. */
        if (follow_baud(pty) < 0) return -1;
        (void)fathom_sim_receive(pty->line, bytes, (size_t)count, now_us);
    }
}

/* The client has not read for long: what waits is old, and new bytes are worth more. */
static void forget_old(const fathom_sim_pty_t *pty)
{
    int unread = 0;
    if (ioctl(pty->slave, FIONREAD, &unread) == 0 && unread >= UNREAD_MOST)
        (void)tcflush(pty->slave, TCIFLUSH);
}

/* A byte is coming, or one follows before t3.5 has passed. */
static bool is_in_a_frame(const fathom_sim_line_t *line)
{
    const uint32_t silence_us = fathom_sim_silence_us(&line->settings);
    for (const fathom_sim_device_t *device = line->devices; device != NULL; device = device->next) {
        const fathom_sim_sender_t *const sender = &device->sender;
        if (fathom_sim_sender_idle(sender)) continue;
        if (sender->on_wire ||
            fathom_sim_until_us(fathom_sim_sender_next_us(sender), line->now_us) < silence_us)
            return true;
    }
    return false;
}

/*
 * A frame is handed over when its last bit has come, as a USB adapter does with bytes that follow each other:
 * byte by byte, a system that is busy with something else would put silences into it.
 */
static int give_to_client(fathom_sim_pty_t *pty, uint32_t now_us)
{
    fathom_sim_run(pty->line, now_us);
    if (is_in_a_frame(pty->line)) return 0;
    for (;;) {
        if (pty->pending_length == 0) {
            pty->pending_length =
                (uint8_t)fathom_sim_transmit(pty->line, now_us, pty->pending, sizeof pty->pending);
            if (pty->pending_length == 0) return 0;
            forget_old(pty);
        }
        const ssize_t count = write(pty->master, pty->pending, pty->pending_length);
        if (count <= 0) return count == 0 || nothing_now() ? 0 : -1;
        pty->pending_length = (uint8_t)(pty->pending_length - count);
        memmove(pty->pending, pty->pending + count, pty->pending_length);
    }
}

int fathom_sim_pty_pump(fathom_sim_pty_t *pty, uint32_t *due_us)
{
    const uint32_t now_us = fathom_sim_pty_now_us();
    if (follow_baud(pty) < 0 || take_from_client(pty, now_us) < 0 || give_to_client(pty, now_us) < 0)
        return -1;
    *due_us = fathom_sim_due_us(pty->line, now_us);
    if (*due_us > longest_wait_us) *due_us = longest_wait_us;
    return 0;
}

int fathom_sim_pty_fd(const fathom_sim_pty_t *pty) { return pty->master; }

const char *fathom_sim_pty_path(const fathom_sim_pty_t *pty) { return pty->path; }
