/* SPDX-License-Identifier: MIT */
/*
 * The errors of a pin: each function stores an error and its text in the pin and returns the error. The texts name what
 * failed, why, and what to try.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

#include "../posix/internal/describe.h"
#include "internal/gpio_port.h"

#ifndef ENOTSUPP
#define ENOTSUPP 524 /* an internal error of the kernel that its drivers return */
#endif

fathom_gpio_status_t fathom_gpio_error(const fathom_gpio_t *gpio) { return gpio->error; }

const char *fathom_gpio_error_text(const fathom_gpio_t *gpio) { return gpio->text; }

fathom_gpio_status_t fathom_gpio_fail(fathom_gpio_t *gpio, fathom_gpio_status_t error, const char *format,
                                      ...)
{
    va_list arguments;
    /* The path is far shorter than the text, so `head` is less than the size. */
    const int head =
        snprintf(gpio->text, sizeof gpio->text, "%s, line %lu: ", gpio->path[0] != 0 ? gpio->path : "pin",
                 (unsigned long)gpio->line);
    va_start(arguments, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): as in port/posix */
    (void)vsnprintf(gpio->text + head, sizeof gpio->text - (size_t)head, format, arguments);
    va_end(arguments);
    gpio->error = error;
    return error;
}

fathom_gpio_status_t fathom_gpio_fail_system(fathom_gpio_t *gpio, const char *what, int code)
{
    char text[80];
    return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_SYSTEM, "%s: %s", what,
                            fathom_posix_words(code, text, sizeof text));
}

void fathom_gpio_fail_lost(fathom_gpio_t *gpio, const char *what, int code)
{
    char text[80];
    (void)fathom_posix_words(code, text, sizeof text);
    gpio->is_lost = true;
    if (code == ENODEV || code == ENXIO)
        (void)fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_LOST, "the chip has gone (%s)", text);
    else
        (void)fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_LOST, "%s: %s", what, text);
}

static fathom_gpio_status_t fail_permission(fathom_gpio_t *gpio, const char *path)
{
    char text[sizeof gpio->text];
    return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_PERMISSION, "%s",
                            fathom_posix_describe_denied(path, "gpio", text, sizeof text));
}

fathom_gpio_status_t fathom_gpio_fail_open(fathom_gpio_t *gpio, const char *path, int code)
{
    switch (code) {
    case ENOENT:
    case ENOTDIR:
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_NOT_FOUND,
                                "no such chip; ls /dev/gpiochip* lists what is");
    case ENXIO:
    case ENODEV:
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_NOT_FOUND, "there is no chip behind this name");
    case EACCES:
    case EPERM:
        return fail_permission(gpio, path);
    case ENOTTY:
    case EISDIR:
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_NOT_A_CHIP,
                                "not a GPIO chip; ls /dev/gpiochip* lists those that are");
    default:
        return fathom_gpio_fail_system(gpio, "opening it", code);
    }
}

static fathom_gpio_status_t fail_in_use(fathom_gpio_t *gpio, const char *consumer)
{
    if (consumer[0] == 0)
        return fathom_gpio_fail(
            gpio, FATHOM_GPIO_ERR_IN_USE,
            "in use by another program or by a driver of the kernel; gpioinfo tells which");
    return fathom_gpio_fail(
        gpio, FATHOM_GPIO_ERR_IN_USE,
        "in use by \"%s\"; end that program, take the driver out of the board's set-up, or take "
        "another line (gpioinfo lists them)",
        consumer);
}

fathom_gpio_status_t fathom_gpio_fail_request(fathom_gpio_t *gpio, const char *consumer, bool is_output,
                                              int code)
{
    switch (code) {
    case EBUSY:
        return fail_in_use(gpio, consumer);
    case EACCES:
    case EPERM:
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_PERMISSION,
                                "this line is not for programs; take another one");
    case EIO: /* gpiolib: the chip does not have this direction, or the output is an interrupt too */
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_UNSUPPORTED, "it cannot be an %s; take another line",
                                is_output ? "output" : "input");
    case ENXIO: /* gpiolib, edge_detector_setup(): there is no interrupt. The chip itself has responded before. */
    case ENODEV:
        if (gpio->has_edges)
            return fathom_gpio_fail(
                gpio, FATHOM_GPIO_ERR_UNSUPPORTED,
                "its chip has no interrupt for it, so edges are not told; take a line that has one");
        return fathom_gpio_fail_open(gpio, gpio->path, ENODEV);
    case EINVAL:
    case EOPNOTSUPP:
    case ENOTSUPP:
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_UNSUPPORTED,
                                "the chip's driver refuses an %s like this%s; take another line",
                                is_output ? "output" : "input", gpio->has_edges ? ", with edges" : "");
    default:
        return fathom_gpio_fail_system(gpio, "taking it", code);
    }
}
