/* SPDX-License-Identifier: MIT */
/*
 * The line settings of a tty: from fathom_line_settings_t to struct termios and back. Settings are read back, and the
 * previous ones are restored if the driver did not keep them.
 */
#define _DEFAULT_SOURCE 1 /* CRTSCTS, rates above 38400 */
#include <errno.h>
#include <stdio.h>
#include <termios.h>

#include "internal/posix_port.h"

/* The bits of c_cflag that define a frame on the wire. */
#define FRAME_BITS (CSIZE | PARENB | PARODD | CMSPAR | CSTOPB | CRTSCTS)

typedef struct {
    uint32_t baud;
    speed_t speed;
} rate_t;

static const rate_t rates[] = {
    {1200, B1200},     {2400, B2400},     {4800, B4800},     {9600, B9600},     {19200, B19200},
    {38400, B38400},   {57600, B57600},   {115200, B115200}, {230400, B230400}, {460800, B460800},
    {500000, B500000}, {576000, B576000}, {921600, B921600},
};
enum { RATES = sizeof rates / sizeof rates[0] };

static const rate_t *rate_of_baud(uint32_t baud)
{
    for (size_t i = 0; i != RATES; i++)
        if (rates[i].baud == baud) return &rates[i];
    return NULL;
}

static uint32_t baud_of_speed(speed_t speed)
{
    for (size_t i = 0; i != RATES; i++)
        if (rates[i].speed == speed) return rates[i].baud;
    return B9600 == 9600 ? (uint32_t)speed : 0; /* Since glibc 2.42 a speed_t is the rate itself. */
}

/* The limit is 2.5 %, because a driver may report the rate that its divider really makes. */
static bool near(speed_t got, speed_t asked)
{
    const uint32_t baud = baud_of_speed(asked);
    const uint32_t real = baud_of_speed(got);
    const uint32_t off = real > baud ? real - baud : baud - real;
    return off <= baud / 40;
}

/* Writes a text like "19200 8E1". A rate without a name, which another program can set, is "?". */
static void describe(const struct termios *tty, char *text, size_t capacity)
{
    const tcflag_t bits = tty->c_cflag;
    char baud[16] = "?";
    const uint32_t known = baud_of_speed(cfgetospeed(tty));
    if (known != 0) (void)snprintf(baud, sizeof baud, "%lu", (unsigned long)known);
    const char *const parity = (bits & PARENB) == 0 ? "N" : (bits & PARODD) != 0 ? "O" : "E";
    const int data_bits = (bits & CSIZE) == CS8   ? 8
                          : (bits & CSIZE) == CS7 ? 7
                          : (bits & CSIZE) == CS6 ? 6
                                                  : 5;
    (void)snprintf(text, capacity, "%s %d%s%d%s", baud, data_bits, parity, (bits & CSTOPB) != 0 ? 2 : 1,
                   (bits & CRTSCTS) != 0 ? " with flow control" : "");
}

static void wanted(struct termios *tty, const fathom_line_settings_t *settings, speed_t speed)
{
    /* Nothing is translated, dropped, marked, echoed or made a signal, not even a break or a byte of wrong
     * parity. cfmakeraw would leave INPCK and IXOFF as they are. */
    tty->c_iflag = 0;
    tty->c_oflag = 0;
    tty->c_lflag = 0;
    tty->c_cflag = CS8 | CREAD | CLOCAL;
    if (settings->parity != FATHOM_PARITY_NONE) tty->c_cflag |= PARENB;
    if (settings->parity == FATHOM_PARITY_ODD) tty->c_cflag |= PARODD;
    if (settings->stop_bits == 2) tty->c_cflag |= CSTOPB;
    /* With O_NONBLOCK and VMIN 1, read(2) distinguishes "no bytes" (EAGAIN) from a hang-up (0 bytes). With VMIN 0 it
     * does not. */
    tty->c_cc[VMIN] = 1;
    tty->c_cc[VTIME] = 0;
    (void)cfsetospeed(tty, speed);
    (void)cfsetispeed(tty, speed);
}

static bool same(const struct termios *asked, const struct termios *got, bool is_pty)
{
    /* Linux, pty_set_termios(): a pseudo terminal drops PARENB; PARODD and CSTOPB stay. */
    const tcflag_t frame_bits = is_pty ? FRAME_BITS & ~(tcflag_t)PARENB : FRAME_BITS;
    return near(cfgetospeed(got), cfgetospeed(asked)) && near(cfgetispeed(got), cfgetispeed(asked)) &&
           (got->c_cflag & frame_bits) == (asked->c_cflag & frame_bits) && got->c_iflag == asked->c_iflag &&
           (got->c_oflag & OPOST) == 0 && got->c_lflag == asked->c_lflag &&
           got->c_cc[VMIN] == asked->c_cc[VMIN] && got->c_cc[VTIME] == asked->c_cc[VTIME];
}

static int set(int fd, const struct termios *tty)
{
    int result;
    do result = tcsetattr(fd, TCSANOW, tty);
    while (result != 0 && errno == EINTR);
    return result;
}

/* Returns the rate. If the settings are not allowed, returns NULL and stores the error. */
static const rate_t *checked(fathom_posix_uart_t *port, const fathom_line_settings_t *settings)
{
    const rate_t *const rate = rate_of_baud(settings->baud);
    if (settings->parity > FATHOM_PARITY_ODD || settings->stop_bits < 1 || settings->stop_bits > 2) {
        (void)fathom_posix_fail(port, FATHOM_POSIX_ERR_ARGUMENT,
                                "parity %u (0 none, 1 even, 2 odd) or %u stop bits (1 or 2) is no setting",
                                settings->parity, settings->stop_bits);
        return NULL;
    }
    if (rate == NULL)
        (void)fathom_posix_fail(port, FATHOM_POSIX_ERR_ARGUMENT, "%lu baud is not a standard rate",
                                (unsigned long)settings->baud);
    return rate;
}

fathom_posix_status_t fathom_posix_check(fathom_posix_uart_t *port, const fathom_line_settings_t *settings)
{
    return checked(port, settings) == NULL ? port->error : FATHOM_POSIX_OK;
}

fathom_posix_status_t fathom_posix_apply(fathom_posix_uart_t *port, const fathom_line_settings_t *settings)
{
    const rate_t *const rate = checked(port, settings);
    if (rate == NULL) return port->error;

    struct termios before;
    if (tcgetattr(port->fd, &before) != 0)
        return fathom_posix_fail_system(port, "reading its settings", errno);
    struct termios asked = before;
    wanted(&asked, settings, rate->speed);

    /* If the tty dropped a bit and nothing else changed (8E1 after 8N1 on a pseudo terminal), glibc returns EINVAL. If
     * something else changed too, glibc returns 0. Only the settings that are read back show the result. */
    int code = set(port->fd, &asked) != 0 ? errno : 0;
    struct termios got;
    if ((code == 0 || code == EINVAL) && tcgetattr(port->fd, &got) != 0) code = errno;
    if (code != 0 && code != EINVAL) {
        (void)set(port->fd, &before);
        return fathom_posix_fail_system(port, "changing its settings", code);
    }
    if (!same(&asked, &got, port->is_pty)) {
        char asked_text[48];
        char got_text[48];
        describe(&asked, asked_text, sizeof asked_text);
        describe(&got, got_text, sizeof got_text);
        (void)set(port->fd, &before);
        return fathom_posix_fail(port, FATHOM_POSIX_ERR_REFUSED,
                                 "settings refused: asked for raw %s, the driver set %s%s", asked_text,
                                 got_text, got.c_lflag == 0 && got.c_iflag == 0 ? "" : ", not raw");
    }
    port->line = *settings;
    return FATHOM_POSIX_OK;
}
