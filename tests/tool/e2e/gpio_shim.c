/* SPDX-License-Identifier: MIT */
/*
 * A GPIO chip for test_loop_program.py and test_controlled.py, to be preloaded. The lines of /dev/gpiochip0 are one: its level is what the file
 * GPIO_LEVEL begins with, "0" or "1"; its events are what is written to the FIFO GPIO_EVENTS, a struct
 * gpio_v2_line_event each; each level of an output, also the first one, is added to the file GPIO_LOG.
 */
#define _GNU_SOURCE 1
#include <fcntl.h>
#include <linux/gpio.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static int open_really(const char *path, int flags)
{
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, 0);
}

int open(const char *path, int flags, ...)
{
    return open_really(strcmp(path, "/dev/gpiochip0") == 0 ? "/dev/null" : path, flags);
}

static void log_level(bool high)
{
    const int file =
        (int)syscall(SYS_openat, AT_FDCWD, getenv("GPIO_LOG"), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (file < 0 || write(file, high ? "1" : "0", 1) != 1) abort();
    close(file);
}

int ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *const out = va_arg(arguments, void *);
    va_end(arguments);
    switch (request) {
    case GPIO_GET_CHIPINFO_IOCTL:
        memset(out, 0, sizeof(struct gpiochip_info));
        ((struct gpiochip_info *)out)->lines = 54;
        return 0;
    case GPIO_V2_GET_LINEINFO_IOCTL:
        return 0;
    case GPIO_V2_GET_LINE_IOCTL: /* writable, so that there is always a writer, and no hang-up */
        ((struct gpio_v2_line_request *)out)->fd = open_really(getenv("GPIO_EVENTS"), O_RDWR);
        if ((((struct gpio_v2_line_request *)out)->config.flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0)
            log_level((((struct gpio_v2_line_request *)out)->config.attrs[0].attr.values & 1) != 0);
        return 0;
    case GPIO_V2_LINE_SET_VALUES_IOCTL:
        log_level((((struct gpio_v2_line_values *)out)->bits & 1) != 0);
        return 0;
    case GPIO_V2_LINE_GET_VALUES_IOCTL: {
        char level = '0';
        const int file = open_really(getenv("GPIO_LEVEL"), O_RDONLY);
        if (file < 0 || read(file, &level, 1) != 1) abort();
        close(file);
        ((struct gpio_v2_line_values *)out)->bits = level == '1';
        return 0;
    }
    default:
        return (int)syscall(SYS_ioctl, fd, request, out);
    }
}
