/* SPDX-License-Identifier: MIT */
#include <poll.h>
#include <string.h>

#include "internal/posix_loop.h"
#include "internal/posix_port.h"

/* ---- a read that asks only where something has come ---- */

/* The events of the loop are as old as its last look. A program that is stopped, or a computer that is busy or asleep, may
 * read the clock much later, and bytes that wait in the port are no silence. */
enum { OLD_US = 5000 };

static bool is_known_empty(const fathom_loop_source_t *source, uint64_t now_us)
{
    return source->is_open && source->is_watched && !source->is_readable &&
           (now_us - source->loop->sampled_us < OLD_US || now_us - source->sampled_us < OLD_US);
}

static int gated_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_loop_source_t *const source = ctx;
    const uint64_t now_us = source->is_open ? fathom_loop_now_us(source->loop) : 0;
    if (is_known_empty(source, now_us)) return 0;
    source->sampled_us = now_us;
    const int n = source->inner.read(source->inner.ctx, bytes, capacity, rx);
    const bool is_last = source->reads_all && !source->is_hung_up; /* of which no event tells a second time */
    if (n == 0 || (n > 0 && (size_t)n < capacity && is_last)) source->is_readable = false;
    return n;
}

static int inner_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_loop_source_t *const source = ctx;
    return source->inner.write(source->inner.ctx, bytes, length);
}

static bool inner_sent(void *ctx)
{
    const fathom_loop_source_t *const source = ctx;
    return source->inner.sent(source->inner.ctx);
}

static int inner_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const fathom_loop_source_t *const source = ctx;
    return source->inner.set_line(source->inner.ctx, settings);
}

static int inner_set_break(void *ctx, bool on)
{
    const fathom_loop_source_t *const source = ctx;
    return source->inner.set_break(source->inner.ctx, on);
}

static uint32_t inner_leaves_in_us(void *ctx)
{
    const fathom_loop_source_t *const source = ctx;
    return source->inner.leaves_in_us(source->inner.ctx);
}

fathom_uart_t fathom_loop_uart(fathom_loop_source_t *source, const fathom_uart_t *uart)
{
    source->inner = *uart;
    const fathom_uart_t gated = {.read = gated_read,
                                 .write = inner_write,
                                 .sent = inner_sent,
                                 .set_line = uart->set_line != NULL ? inner_set_line : NULL,
                                 .set_break = uart->set_break != NULL ? inner_set_break : NULL,
                                 .leaves_in_us = uart->leaves_in_us != NULL ? inner_leaves_in_us : NULL,
                                 .ctx = source};
    return gated;
}

/* ---- lines ---- */

static fathom_loop_line_t *line_of(fathom_loop_source_t *source) { return (fathom_loop_line_t *)source; }

static bool open_line(fathom_loop_source_t *source)
{
    fathom_loop_line_t *const line = line_of(source);
    return fathom_posix_open(&line->bus.port, line->path, &line->settings) == FATHOM_POSIX_OK;
}

static void close_line(fathom_loop_source_t *source) { fathom_posix_close(&line_of(source)->bus.port); }

static int line_fd(const fathom_loop_source_t *source)
{
    return fathom_posix_fd(&((const fathom_loop_line_t *)source)->bus.port);
}

static short line_events(const fathom_loop_source_t *source)
{
    return fathom_posix_poll_events(&((const fathom_loop_line_t *)source)->bus.port);
}

static bool poll_line(fathom_loop_source_t *source)
{
    return fathom_line_poll(&line_of(source)->bus.line) != FATHOM_ERR_PORT;
}

static uint32_t line_due_us(fathom_loop_source_t *source)
{
    return fathom_line_due_us(&line_of(source)->bus.line);
}

static const char *line_error_text(const fathom_loop_source_t *source)
{
    return fathom_posix_error_text(&((const fathom_loop_line_t *)source)->bus.port);
}

fathom_posix_status_t fathom_loop_add_line(fathom_loop_t *loop, fathom_loop_line_t *line, const char *path,
                                           const fathom_line_settings_t *settings)
{
    static const fathom_loop_kind_t kind = {open_line, close_line,  line_fd,        line_events,
                                            poll_line, line_due_us, line_error_text};
    if (loop == NULL || line == NULL || path == NULL || settings == NULL ||
        fathom_loop_has(loop, &line->source))
        return FATHOM_POSIX_ERR_ARGUMENT;
    memset(line, 0, sizeof *line);
    if (fathom_posix_check(&line->bus.port, settings) != FATHOM_POSIX_OK) return FATHOM_POSIX_ERR_ARGUMENT;
    line->source.kind = &kind;
    line->source.reads_all = true;
    line->path = path;
    line->settings = *settings;
    const fathom_uart_t uart = fathom_posix_uart(&line->bus.port);
    const fathom_uart_t gated = fathom_loop_uart(&line->source, &uart);
    fathom_posix_bus_set_up(&line->bus, &gated, settings);
    fathom_loop_add(loop, &line->source);
    return FATHOM_POSIX_OK;
}

/* ---- pins ---- */

static int pin_fd(const fathom_loop_source_t *source) { return ((const fathom_loop_pin_t *)source)->fd; }

/* Its chip may have gone, which a level does not tell. */
static bool open_pin(fathom_loop_source_t *source)
{
    struct pollfd entry = {.fd = pin_fd(source)}; /* a hang-up and errors are told unasked */
    return poll(&entry, 1, 0) <= 0;
}

static bool poll_pin(fathom_loop_source_t *source) { return !source->is_hung_up; }

void fathom_loop_add_pin(fathom_loop_t *loop, fathom_loop_pin_t *pin, int fd)
{
    static const fathom_loop_kind_t kind = {.open = open_pin, .fd = pin_fd, .poll = poll_pin};
    if (fathom_loop_has(loop, &pin->source)) return;
    memset(pin, 0, sizeof *pin);
    pin->source.kind = &kind;
    pin->fd = fd;
    fathom_loop_add(loop, &pin->source);
}
