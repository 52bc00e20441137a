/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* O_PATH */
#include "gpio_chip.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker gives these names */
int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __real_ioctl(int fd, unsigned long request, ...);
int __wrap_ioctl(int fd, unsigned long request, ...);
ssize_t __real_read(int fd, void *bytes, size_t length);
ssize_t __wrap_read(int fd, void *bytes, size_t length);
int __real_close(int fd);
int __wrap_close(int fd);

gpio_chip_t chip;

static int chip_fd;

static int give(int error)
{
    errno = error;
    return -1;
}

static bool interrupts(void)
{
    if (chip.interrupts == 0) return false;
    chip.interrupts--;
    return true;
}

static chip_line_t *line_of(int fd)
{
    for (unsigned i = 0; i != CHIP_OPEN_LINES; i++)
        if (fd > 0 && chip.lines[i].fd == fd) return &chip.lines[i];
    return NULL;
}

int __wrap_open(const char *path, int flags, ...)
{
    if (strcmp(path, "/dev/gpiochip0") != 0) return __real_open(path, flags);
    if (interrupts()) return give(EINTR);
    if (chip.open_error != 0) return give(chip.open_error);
    chip.open_flags = flags;
    chip.open_chips++;
    chip_fd = __real_open("/dev/null", O_RDWR);
    return chip_fd;
}

static int take_line(struct gpio_v2_line_request *request)
{
    if (chip.request_error != 0) {
        chip.refused++;
        return give(chip.request_error);
    }
    for (unsigned i = 0; i != CHIP_OPEN_LINES; i++) {
        chip_line_t *const line = &chip.lines[i];
        if (line->fd != 0) continue;
        memset(line, 0, sizeof *line);
        line->request = *request;
        line->level = request->config.num_attrs != 0 && (request->config.attrs[0].attr.values & 1u) != 0;
        request->fd = line->fd = __real_open("/dev/null", chip.is_rigid ? O_PATH : O_RDONLY);
        chip.opened++;
        return 0;
    }
    return give(ENOMEM);
}

static int ask_chip(unsigned long request, void *argument)
{
    switch (request) {
    case GPIO_GET_CHIPINFO_IOCTL:
        if (chip.chip_error != 0) return give(chip.chip_error);
        ((struct gpiochip_info *)argument)->lines = CHIP_LINES;
        return 0;
    case GPIO_V2_GET_LINEINFO_IOCTL:
        if (chip.info_error != 0) return give(chip.info_error);
        memcpy(((struct gpio_v2_line_info *)argument)->consumer, chip.consumer, sizeof chip.consumer);
        return 0;
    case GPIO_V2_GET_LINE_IOCTL:
        return take_line(argument);
    default:
        return give(EINVAL);
    }
}

static int ask_line(chip_line_t *line, unsigned long request, struct gpio_v2_line_values *values)
{
    if (values->mask != 1u) return give(EINVAL);
    if (request == GPIO_V2_LINE_GET_VALUES_IOCTL) {
        if (chip.level_error != 0) return give(chip.level_error);
        values->bits = line->level ? 1u : 0u;
        return 0;
    }
    if (request != GPIO_V2_LINE_SET_VALUES_IOCTL ||
        (line->request.config.flags & GPIO_V2_LINE_FLAG_OUTPUT) == 0)
        return give(EINVAL);
    if (chip.set_error != 0) return give(chip.set_error);
    line->level = (values->bits & 1u) != 0;
    line->sets++;
    return 0;
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *const argument = va_arg(arguments, void *);
    va_end(arguments);
    chip_line_t *const line = line_of(fd);
    const bool is_chip = chip.open_chips != 0 && fd == chip_fd;
    if (line == NULL && !is_chip) return __real_ioctl(fd, request, argument);
    if (interrupts()) return give(EINTR);
    return is_chip ? ask_chip(request, argument) : ask_line(line, request, argument);
}

ssize_t __wrap_read(int fd, void *bytes, size_t length)
{
    chip_line_t *const line = line_of(fd);
    if (line == NULL) return __real_read(fd, bytes, length);
    if (interrupts()) return give(EINTR);
    if (chip.read_error != 0) return give(chip.read_error);
    /* One that would wait fails the test, instead of never ending. */
    if ((fcntl(fd, F_GETFL) & O_NONBLOCK) == 0) return give(EDEADLK);
    if (chip.short_read != 0) return chip.short_read;
    if (line->events == 0 && chip.is_endless) chip_edge(line, true, 0);
    if (line->events == 0) return give(EAGAIN);
    if (length < sizeof line->queue[0]) return give(EINVAL);
    memcpy(bytes, &line->queue[line->first], sizeof line->queue[0]);
    line->first = (line->first + 1) % FATHOM_GPIO_QUEUE;
    line->events--;
    return (ssize_t)sizeof line->queue[0];
}

int __wrap_close(int fd)
{
    chip_line_t *const line = line_of(fd);
    if (line != NULL) line->fd = 0;
    if (chip.open_chips != 0 && fd == chip_fd) chip.open_chips--;
    return __real_close(fd);
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

void chip_reset(void)
{
    for (unsigned i = 0; i != CHIP_OPEN_LINES; i++)
        if (chip.lines[i].fd != 0) (void)__real_close(chip.lines[i].fd);
    memset(&chip, 0, sizeof chip);
    chip_fd = -1;
}

void chip_lose(chip_line_t *line, bool high)
{
    line->level = high;
    line->last_seqno++;
}

void chip_edge(chip_line_t *line, bool high, uint64_t time_us)
{
    chip_lose(line, high);
    if (line->events == FATHOM_GPIO_QUEUE) {
        line->first = (line->first + 1) % FATHOM_GPIO_QUEUE;
        line->events--;
    }
    struct gpio_v2_line_event *const event = &line->queue[(line->first + line->events) % FATHOM_GPIO_QUEUE];
    memset(event, 0, sizeof *event);
    event->timestamp_ns = time_us * 1000u;
    event->id = high ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
    event->offset = line->request.offsets[0];
    event->seqno = line->last_seqno;
    event->line_seqno = line->last_seqno;
    line->events++;
}
