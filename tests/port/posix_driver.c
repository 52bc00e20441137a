/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, makedev */
#include "posix_driver.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

/* NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker gives these names */
int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __real_fstat(int fd, struct stat *status);
int __wrap_fstat(int fd, struct stat *status);
int __real_tcgetattr(int fd, struct termios *tty);
int __wrap_tcgetattr(int fd, struct termios *tty);
int __real_tcsetattr(int fd, int when, const struct termios *tty);
int __wrap_tcsetattr(int fd, int when, const struct termios *tty);
int __real_tcflush(int fd, int queue);
int __wrap_tcflush(int fd, int queue);
int __real_ioctl(int fd, unsigned long request, ...);
int __wrap_ioctl(int fd, unsigned long request, ...);
ssize_t __real_read(int fd, void *bytes, size_t length);
ssize_t __wrap_read(int fd, void *bytes, size_t length);
ssize_t __real_write(int fd, const void *bytes, size_t length);
ssize_t __wrap_write(int fd, const void *bytes, size_t length);

posix_driver_t driver;

static int port_fd; /* the calls on others are left alone */

static int give(int error)
{
    errno = error;
    return -1;
}

int __wrap_open(const char *path, int flags, ...)
{
    if (driver.open_interrupts > 0) {
        driver.open_interrupts--;
        return give(EINTR);
    }
    if (driver.open_error != 0) return give(driver.open_error);
    port_fd = __real_open(path, flags);
    return port_fd;
}

int __wrap_fstat(int fd, struct stat *status)
{
    if (fd == port_fd && driver.stat_error != 0) return give(driver.stat_error);
    const int result = __real_fstat(fd, status);
    if (fd == port_fd && driver.is_8250) status->st_rdev = makedev(4, 65); /* ttyS1 */
    if (fd == port_fd && driver.is_usb) status->st_rdev = makedev(188, 0); /* ttyUSB0 */
    return result;
}

int __wrap_tcgetattr(int fd, struct termios *tty)
{
    if (fd == port_fd && driver.get_error != 0 && driver.get_error_after-- <= 0)
        return give(driver.get_error);
    const int result = __real_tcgetattr(fd, tty);
    if (fd == port_fd && driver.is_8250 && !driver.drops_parity && (tty->c_cflag & PARODD) != 0)
        tty->c_cflag |= PARENB; /* the pseudo terminal below has dropped it */
    if (fd == port_fd && driver.sets != 0 && driver.changes != NULL) driver.changes(tty);
    return result;
}

int __wrap_tcflush(int fd, int queue)
{
    if (fd == port_fd && driver.flush_error != 0) return give(driver.flush_error);
    return __real_tcflush(fd, queue);
}

int __wrap_tcsetattr(int fd, int when, const struct termios *tty)
{
    struct termios taken = *tty;
    if (fd != port_fd) return __real_tcsetattr(fd, when, tty);
    driver.sets++;
    if (driver.set_interrupts > 0) {
        driver.set_interrupts--;
        return give(EINTR);
    }
    if (driver.most != 0 && cfgetospeed(tty) > driver.most) {
        (void)cfsetospeed(&taken, B9600);
        (void)cfsetispeed(&taken, B9600);
    }
    if (driver.drops_stop) taken.c_cflag &= ~(tcflag_t)CSTOPB;
    if (driver.keeps_echo) taken.c_lflag |= ECHO;
    const int result = __real_tcsetattr(fd, when, &taken);
    return driver.set_error != 0 ? give(driver.set_error) : result;
}

static uint32_t at_most(uint32_t value, uint32_t most) { return most != 0 && value > most ? most : value; }

static int rs485(unsigned long request, struct serial_rs485 *out)
{
    if (!driver.has_rs485) return give(ENOTTY);
    if (request == TIOCGRS485) {
        if (driver.rs485_get_error != 0 && driver.rs485_get_error_after-- <= 0)
            return give(driver.rs485_get_error);
        *out = driver.rs485;
        return 0;
    }
    driver.rs485_sets++;
    if (driver.rs485_error != 0) return give(driver.rs485_error);
    out->flags = (out->flags & ~driver.rs485_drops) | driver.rs485_adds;
    out->delay_rts_before_send = at_most(out->delay_rts_before_send, driver.rs485_delay_most);
    out->delay_rts_after_send = at_most(out->delay_rts_after_send, driver.rs485_delay_most);
    driver.rs485 = *out; /* the kernel tells so as well */
    return 0;
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *const out = va_arg(arguments, void *);
    va_end(arguments);
    if (fd != port_fd) return __real_ioctl(fd, request, out);
    switch (request) {
    case TIOCEXCL:
    case TIOCNXCL:
        driver.exclusive += request == TIOCEXCL ? 1 : -1;
        driver.exclusive_calls++;
        return driver.exclusive_error != 0 ? give(driver.exclusive_error) : 0;
    case TIOCSBRK:
    case TIOCCBRK:
        driver.break_calls++;
        if (driver.break_error != 0) return give(driver.break_error);
        driver.breaks += request == TIOCSBRK ? 1 : -1;
        return 0;
    case TIOCOUTQ:
        if (driver.queue_error != 0) return give(driver.queue_error);
        *(int *)out = driver.queued;
        return 0;
    case TIOCSERGETLSR:
        if (driver.lsr_error != 0) return give(driver.lsr_error);
        *(int *)out = driver.lsr;
        return 0;
    case TIOCSRS485:
    case TIOCGRS485:
        return rs485(request, out);
    case TIOCGICOUNT: {
        if (driver.count_error != 0) return give(driver.count_error);
        struct serial_icounter_struct *const counts = out;
        counts->parity = 11;
        counts->frame = 22;
        counts->overrun = 30;
        counts->buf_overrun = 3;
        counts->brk = 44;
        return 0;
    }
    default:
        return __real_ioctl(fd, request, out);
    }
}

ssize_t __wrap_read(int fd, void *bytes, size_t length)
{
    if (fd == port_fd && length > driver.read_most) driver.read_most = length;
    if (fd == port_fd && driver.read_interrupts > 0) {
        driver.read_interrupts--;
        return give(EINTR);
    }
    if (fd == port_fd && driver.read_error != 0) return give(driver.read_error);
    return __real_read(fd, bytes, length);
}

ssize_t __wrap_write(int fd, const void *bytes, size_t length)
{
    if (fd != port_fd) return __real_write(fd, bytes, length);
    driver.writes++;
    if (driver.write_interrupts > 0) {
        driver.write_interrupts--;
        return give(EINTR);
    }
    if (driver.write_refusals > 0) {
        driver.write_refusals--;
        return give(EAGAIN);
    }
    if (driver.write_error != 0) return give(driver.write_error);
    if (driver.write_most != 0 && length > (size_t)driver.write_most) length = (size_t)driver.write_most;
    return __real_write(fd, bytes, length);
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

void posix_driver_reset(void)
{
    memset(&driver, 0, sizeof driver);
    driver.lsr = TIOCSER_TEMT;
    port_fd = -1;
}
