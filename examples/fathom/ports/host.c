/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): clock_gettime */
#include "ports/host.h"

#include <stddef.h>
#include <time.h>

#include "ports/events.h"

static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    (void)ctx;
    if (fathom_posix_open(port, path, settings) != FATHOM_POSIX_OK) return false;
    *uart = fathom_posix_uart(port);
    return true;
}

static void close_port(void *ctx, fathom_posix_uart_t *port)
{
    (void)ctx;
    fathom_posix_close(port);
}

static bool open_pins(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins,
                      fathom_posix_uart_t *port)
{
    (void)ctx;
    return pins_open(pins, chip, wanted, port);
}

static void close_pins(void *ctx, pins_t *pins, fathom_posix_uart_t *port)
{
    (void)ctx;
    pins_close(pins, port);
}

static uint64_t now_us(void *ctx)
{
    (void)ctx;
    return fathom_posix_now_us();
}

static uint64_t utc_us(void *ctx)
{
    struct timespec now = {0, 0};
    (void)ctx;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static bool begin(void *ctx)
{
    (void)ctx;
    return events_begin();
}

static bool has_ended(void *ctx)
{
    (void)ctx;
    return events_ended();
}

static bool is_output_gone(void *ctx)
{
    (void)ctx;
    return events_output_gone();
}

static void wait_for(void *ctx, const fathom_posix_uart_t *port, uint32_t max_us, bool watch_output)
{
    (void)ctx;
    if (port == NULL)
        events_wait(-1, 0, max_us, watch_output);
    else
        events_wait(fathom_posix_fd(port), fathom_posix_poll_events(port), max_us, watch_output);
}

static void attend(void *ctx, fathom_loop_t *loop)
{
    (void)ctx;
    events_attend(loop);
}

const host_t host_posix = {.open = open_port,
                           .close = close_port,
                           .open_pins = open_pins,
                           .close_pins = close_pins,
                           .now_us = now_us,
                           .utc_us = utc_us,
                           .begin = begin,
                           .has_ended = has_ended,
                           .is_output_gone = is_output_gone,
                           .wait = wait_for,
                           .attend = attend};
