/* SPDX-License-Identifier: MIT */
/*
 * Opens and closes a line of a GPIO chip, and has its pin and its capture of the HAL. Edges come as events of the
 * kernel with a time and a number, by which lost events are detected.
 */
#define _DEFAULT_SOURCE 1
#include <errno.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "internal/gpio_port.h"

/* Limit of events in one call: twice the longest queue of the kernel (gpiolib: 16 for each of 64 lines). A call finds
 * more events only if edges come as fast as they are read, and must return even then. */
enum { MOST_EVENTS = 2048 };

static int control(int fd, unsigned long request, void *argument)
{
    int result;
    do result = ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR);
    return result;
}

static bool is_usable(const fathom_gpio_t *gpio) { return gpio->is_open && !gpio->is_lost; }

/* ---- levels ---- */

static void set(void *ctx, bool high)
{
    fathom_gpio_t *const gpio = ctx;
    struct gpio_v2_line_values values = {.bits = high ? 1u : 0u, .mask = 1u};
    if (!is_usable(gpio)) return;
    if (control(gpio->fd, GPIO_V2_LINE_SET_VALUES_IOCTL, &values) != 0)
        fathom_gpio_fail_lost(gpio, "setting it", errno);
}

/* Returns the level. If the pin is lost, returns the newest known level: a contact that seems to open because the chip
 * was unplugged would be a reading. */
static bool get_level(void *ctx)
{
    fathom_gpio_t *const gpio = ctx;
    struct gpio_v2_line_values values = {.bits = 0, .mask = 1u};
    if (!is_usable(gpio)) return gpio->is_high;
    if (control(gpio->fd, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) == 0)
        gpio->is_high = (values.bits & 1u) != 0;
    else
        fathom_gpio_fail_lost(gpio, "reading its level", errno);
    return gpio->is_high;
}

/* ---- edges ---- */

static void feed(fathom_gpio_t *gpio, const struct gpio_v2_line_event *event)
{
    /* The kernel counts the events of a line from 1. If its queue is full, it drops the oldest (gpiolib,
     * linereq_put_event()). The missing events therefore came directly before this one. */
    const uint32_t lost = (uint32_t)(event->line_seqno - gpio->line_seqno - 1u);
    gpio->line_seqno = event->line_seqno;
    gpio->events++;
    if (lost != 0) {
        gpio->lost_events += lost;
        /* The level counts as high, with a rise of unknown time, so nothing counts before the next fall (edges.h). */
        gpio->edges.is_high = true;
        gpio->edges.is_timed = false;
    }
    fathom_edges_feed(&gpio->edges, event->id == GPIO_V2_LINE_EVENT_RISING_EDGE,
                      (uint32_t)(event->timestamp_ns / 1000u));
}

/* Feeds the oldest event. Returns 1 if there was one, 0 if the queue is empty, and -1 if the pin is lost. */
static int feed_one(fathom_gpio_t *gpio)
{
    struct gpio_v2_line_event event;
    ssize_t n;
    do n = read(gpio->fd, &event, sizeof event);
    while (n < 0 && errno == EINTR);
    if (n == (ssize_t)sizeof event) {
        feed(gpio, &event);
        return 1;
    }
    if (n < 0 && errno == EAGAIN) return 0;
    fathom_gpio_fail_lost(gpio, "reading its events", n < 0 ? errno : EIO);
    return -1;
}

static void arm(void *ctx)
{
    fathom_gpio_t *const gpio = ctx;
    const fathom_capture_t capture = fathom_edges_capture(&gpio->edges);
    if (!is_usable(gpio)) return;
    for (unsigned left = MOST_EVENTS; left != 0 && feed_one(gpio) > 0; left--)
        capture.arm(capture.ctx); /* This frees the places of the pulses. */
    /* A fall may have been missed. The level shows whether the next edge is a rise. */
    gpio->edges.is_high = get_level(gpio);
    gpio->edges.is_timed = false;
    capture.arm(capture.ctx);
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    fathom_gpio_t *const gpio = ctx;
    const fathom_capture_t capture = fathom_edges_capture(&gpio->edges);
    int fed = is_usable(gpio) ? 1 : -1;
    /* Events for which there is no place among the pulses stay in the queue of the kernel. */
    for (unsigned left = MOST_EVENTS; left != 0 && fed > 0 && !fathom_edges_is_full(&gpio->edges); left--)
        fed = feed_one(gpio);
    if (fed < 0) return -1;
    const int taken = capture.take(capture.ctx, pulse);
    return gpio->is_lost ? -1 : taken;
}

static bool get_after_events(void *ctx)
{
    fathom_gpio_t *const gpio = ctx;
    for (unsigned left = MOST_EVENTS; left != 0 && is_usable(gpio) && feed_one(gpio) > 0; left--) {
    }
    return get_level(gpio);
}

fathom_pin_t fathom_gpio_pin(fathom_gpio_t *gpio)
{
    fathom_pin_t pin;
    pin.set = gpio->is_output ? set : NULL;
    pin.get = gpio->is_output ? NULL : gpio->has_edges ? get_after_events : get_level;
    pin.ctx = gpio;
    return pin;
}

fathom_capture_t fathom_gpio_capture(fathom_gpio_t *gpio)
{
    const fathom_capture_t capture = {arm, take, gpio};
    return capture;
}

/* ---- opening ---- */

static uint64_t bias_flag(fathom_gpio_bias_t bias)
{
    switch (bias) {
    case FATHOM_GPIO_BIAS_PULL_UP:
        return GPIO_V2_LINE_FLAG_BIAS_PULL_UP;
    case FATHOM_GPIO_BIAS_PULL_DOWN:
        return GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN;
    case FATHOM_GPIO_BIAS_DISABLED:
        return GPIO_V2_LINE_FLAG_BIAS_DISABLED;
    default:
        return 0;
    }
}

/* Requests the line from an open chip. */
static fathom_gpio_status_t take_line(fathom_gpio_t *gpio, int chip_fd, uint64_t flags, bool high)
{
    struct gpiochip_info chip = {.lines = 0};
    if (control(chip_fd, GPIO_GET_CHIPINFO_IOCTL, &chip) != 0)
        return fathom_gpio_fail_open(gpio, gpio->path, errno == EINVAL ? ENOTTY : errno);
    if (gpio->line >= chip.lines)
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_NO_LINE,
                                "the chip has the lines 0 to %lu; gpioinfo lists them",
                                (unsigned long)chip.lines - 1);

    struct gpio_v2_line_info info = {.offset = gpio->line};
    if (control(chip_fd, GPIO_V2_GET_LINEINFO_IOCTL, &info) != 0)
        return errno == EINVAL || errno == ENOTTY
                   ? fathom_gpio_fail(
                         gpio, FATHOM_GPIO_ERR_UNSUPPORTED,
                         "this kernel has version 1 of the GPIO interface only; Linux 5.10 has version 2")
                   : fathom_gpio_fail_request(gpio, "", gpio->is_output, errno);

    struct gpio_v2_line_request request = {.num_lines = 1};
    request.offsets[0] = gpio->line;
    (void)snprintf(request.consumer, sizeof request.consumer, "fathom");
    request.config.flags = flags;
    if (gpio->is_output) {
        request.config.num_attrs = 1;
        request.config.attrs[0].attr.id = GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES;
        request.config.attrs[0].attr.values = high ? 1u : 0u;
        request.config.attrs[0].mask = 1u;
    }
    if (gpio->has_edges) request.event_buffer_size = FATHOM_GPIO_QUEUE;
    if (control(chip_fd, GPIO_V2_GET_LINE_IOCTL, &request) != 0) {
        info.consumer[sizeof info.consumer - 1] = 0;
        return fathom_gpio_fail_request(gpio, info.consumer, gpio->is_output, errno);
    }
    gpio->fd = request.fd;
    /* The descriptor of a line blocks, even if that of the chip does not. */
    if (fcntl(gpio->fd, F_SETFL, O_NONBLOCK) == 0) return FATHOM_GPIO_OK;
    const int code = errno;
    (void)close(gpio->fd);
    return fathom_gpio_fail_system(gpio, "making its reads return at once", code);
}

static fathom_gpio_status_t open_line(fathom_gpio_t *gpio, const char *chip, uint32_t line, uint64_t flags,
                                      bool high)
{
    if (gpio == NULL) return FATHOM_GPIO_ERR_ARGUMENT;
    memset(gpio, 0, sizeof *gpio);
    gpio->line = line;
    gpio->is_output = (flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0;
    gpio->has_edges = (flags & GPIO_V2_LINE_FLAG_EDGE_RISING) != 0;
    if (chip == NULL || chip[0] == 0)
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_ARGUMENT, "no chip was named, such as gpiochip0");
    const int length =
        snprintf(gpio->path, sizeof gpio->path, "%s%s", strchr(chip, '/') == NULL ? "/dev/" : "", chip);
    if (length < 0 || (size_t)length >= sizeof gpio->path)
        return fathom_gpio_fail(gpio, FATHOM_GPIO_ERR_ARGUMENT, "a path has %lu characters at most",
                                (unsigned long)sizeof gpio->path - 1);

    int chip_fd;
    do chip_fd = open(gpio->path, O_RDWR | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    while (chip_fd < 0 && errno == EINTR);
    if (chip_fd < 0) return fathom_gpio_fail_open(gpio, gpio->path, errno);
    const fathom_gpio_status_t status = take_line(gpio, chip_fd, flags, high);
    (void)close(chip_fd); /* The line has its own descriptor. */
    gpio->is_open = status == FATHOM_GPIO_OK;
    return status;
}

fathom_gpio_status_t fathom_gpio_open_output(fathom_gpio_t *gpio, const char *chip, uint32_t line, bool high)
{
    return open_line(gpio, chip, line, GPIO_V2_LINE_FLAG_OUTPUT, high);
}

fathom_gpio_status_t fathom_gpio_open_input(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias)
{
    return open_line(gpio, chip, line, GPIO_V2_LINE_FLAG_INPUT | bias_flag(bias), false);
}

fathom_gpio_status_t fathom_gpio_open_edges(fathom_gpio_t *gpio, const char *chip, uint32_t line,
                                            fathom_gpio_bias_t bias)
{
    const fathom_gpio_status_t status = open_line(gpio, chip, line,
                                                  GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING |
                                                      GPIO_V2_LINE_FLAG_EDGE_FALLING | bias_flag(bias),
                                                  false);
    if (status != FATHOM_GPIO_OK) return status;
    gpio->level.get = get_level;
    gpio->level.ctx = gpio;
    fathom_edges_init(&gpio->edges, &gpio->level);
    return FATHOM_GPIO_OK;
}

void fathom_gpio_close(fathom_gpio_t *gpio)
{
    if (gpio == NULL || !gpio->is_open) return;
    (void)close(gpio->fd); /* After EINTR Linux has closed the descriptor too. */
    gpio->is_open = false;
}

int fathom_gpio_fd(const fathom_gpio_t *gpio) { return gpio->is_open ? gpio->fd : -1; }
