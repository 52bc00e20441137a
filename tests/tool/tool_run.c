/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream; stdout is a variable */
#include "tool_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/commands.h"

enum { WORDS = 300, TEXT = 10000, PORTS = 256, CHIPS = 4 };
static const uint64_t longest_us = UINT64_C(7200000000);
static const uint64_t began_utc_us = UINT64_C(1764000000000000); /* 2025-11-24, 16:00 */

/* A port that was opened. */
typedef struct {
    const tool_port_t *port;
    fathom_posix_uart_t *posix;
} open_t;

/* Lines that were opened. */
typedef struct machine machine_t;
typedef struct {
    machine_t *machine;
    tool_chip_t *chip;
    pins_t *pins;
} opened_pins_t;

struct machine {
    const tool_line_t *line;
    uint32_t last_us; /* of the line's clock */
    uint64_t now_us;  /* since the begin */
    bool is_endless;
    open_t opened[PORTS]; /* of line->ports */
    opened_pins_t pins[CHIPS];
};

static uint64_t now_us(void *ctx)
{
    machine_t *const machine = ctx;
    const fathom_clock_t *const clock = &machine->line->clock;
    const uint32_t now = clock->now_us(clock->ctx);
    machine->now_us += fathom_elapsed_us(now, machine->last_us);
    machine->last_us = now;
    return machine->now_us;
}

static uint64_t utc_us(void *ctx) { return began_utc_us + now_us(ctx); }

/* ---- ports ---- */

static int refuse(fathom_posix_uart_t *port, fathom_posix_status_t error, const char *text)
{
    port->error = error;
    (void)snprintf(port->text, sizeof port->text, "%s: %s", port->path, text);
    return -1;
}

static int lose(const open_t *opened)
{
    opened->posix->is_lost = true;
    return refuse(opened->posix, FATHOM_POSIX_ERR_LOST, "unplugged");
}

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const open_t *const opened = ctx;
    const fathom_uart_t *const uart = &opened->port->uart;
    return opened->port->is_away ? lose(opened) : uart->read(uart->ctx, bytes, capacity, rx);
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const open_t *const opened = ctx;
    const fathom_uart_t *const uart = &opened->port->uart;
    return opened->port->is_away ? lose(opened) : uart->write(uart->ctx, bytes, length);
}

static bool port_sent(void *ctx)
{
    const open_t *const opened = ctx;
    const fathom_uart_t *const uart = &opened->port->uart;
    return opened->port->is_away || uart->sent(uart->ctx);
}

static int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const open_t *const opened = ctx;
    const fathom_uart_t *const uart = &opened->port->uart;
    return opened->port->is_away ? lose(opened) : uart->set_line(uart->ctx, settings);
}

/* Which of the line's ports that is. */
static bool find_port(machine_t *machine, const char *path, fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    const tool_line_t *const line = machine->line;
    if (line->port_count == 0) {
        *uart = line->uart;
        return true;
    }
    for (size_t i = 0; i != line->port_count; i++) {
        if (strcmp(line->ports[i].path, path) != 0 || line->ports[i].is_away) continue;
        machine->opened[i] = (open_t){&line->ports[i], port};
        *uart = (fathom_uart_t){.read = port_read,
                                .write = port_write,
                                .sent = port_sent,
                                .set_line = port_set_line,
                                .ctx = &machine->opened[i]};
        return true;
    }
    return false;
}

/* As fathom_posix_open: what came before is thrown away. */
static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    uint8_t bytes[64];
    fathom_rx_t rx;
    memset(port, 0, sizeof *port);
    port->fd = -1;
    (void)snprintf(port->path, sizeof port->path, "%s", path);
    if (!find_port(ctx, path, port, uart)) {
        refuse(port, FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
        return false;
    }
    if (uart->set_line != NULL && uart->set_line(uart->ctx, settings) < 0) {
        refuse(port, FATHOM_POSIX_ERR_REFUSED, "refused");
        return false;
    }
    do memset(&rx, 0, sizeof rx);
    while (uart->read(uart->ctx, bytes, sizeof bytes, &rx) > 0);
    return true;
}

static void close_port(void *ctx, fathom_posix_uart_t *port) {}

/* ---- pins ---- */

static bool is_lost(const opened_pins_t *opened)
{
    fathom_gpio_t *const line = &opened->pins->lines[0];
    if (!opened->chip->is_away) return false;
    line->is_lost = true;
    line->error = FATHOM_GPIO_ERR_LOST;
    (void)snprintf(line->text, sizeof line->text, "%s: the chip has gone", opened->chip->path);
    return true;
}

static void set_trigger(void *ctx, bool high)
{
    const opened_pins_t *const opened = ctx;
    const fathom_pin_t *const pin = &opened->chip->trigger;
    if (!is_lost(opened)) pin->set(pin->ctx, high);
}

static bool get_in(void *ctx)
{
    const opened_pins_t *const opened = ctx;
    const fathom_pin_t *const pin = &opened->chip->in;
    return !is_lost(opened) && pin->get(pin->ctx);
}

static void arm(void *ctx)
{
    const opened_pins_t *const opened = ctx;
    const fathom_capture_t *const capture = &opened->chip->capture;
    if (!is_lost(opened)) capture->arm(capture->ctx);
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    const opened_pins_t *const opened = ctx;
    const fathom_capture_t *const capture = &opened->chip->capture;
    if (is_lost(opened)) return -1;
    const int taken = capture->take(capture->ctx, pulse);
    /* By the clock of the host, which begins at 0. */
    const uint32_t now = (uint32_t)now_us(opened->machine);
    pulse->end_us = now - fathom_elapsed_us(opened->machine->last_us, pulse->end_us);
    return taken;
}

static bool refuse_chip(pins_t *pins, fathom_gpio_status_t error, const char *path, const char *text)
{
    pins->lines[0].error = error;
    (void)snprintf(pins->lines[0].text, sizeof pins->lines[0].text, "%s: %s", path, text);
    return false;
}

static bool open_pins(void *ctx, const char *path, const pin_options_t *wanted, pins_t *pins)
{
    machine_t *const machine = ctx;
    tool_chip_t *const chip = machine->line->chip;
    memset(pins, 0, sizeof *pins);
    pins->fd = -1;
    if (chip == NULL || strcmp(chip->path, path) != 0 || chip->is_away)
        return refuse_chip(pins, FATHOM_GPIO_ERR_NOT_FOUND, path, "no such chip");
    if (chip->refusal != NULL) return refuse_chip(pins, FATHOM_GPIO_ERR_IN_USE, path, chip->refusal);
    opened_pins_t *const opened = &machine->pins[chip->opened++ % CHIPS];
    *opened = (opened_pins_t){machine, chip, pins};
    chip->asked = *wanted;
    pins->wanted = *wanted;
    pins->missed = &chip->missed;
    pins->lost_events = &chip->lost_events;
    if (wanted->trigger >= 0) pins->trigger = (fathom_pin_t){.set = set_trigger, .ctx = opened};
    if (wanted->trigger >= 0) set_trigger(opened, true);
    if (wanted->echo >= 0) pins->capture = (fathom_capture_t){arm, take, opened};
    if (wanted->in >= 0) pins->in = (fathom_pin_t){.get = get_in, .ctx = opened};
    return true;
}

static void close_pins(void *ctx, pins_t *pins) { ((machine_t *)ctx)->line->chip->closed++; }

static bool begin(void *ctx) { return true; }

static bool has_ended(void *ctx)
{
    machine_t *const machine = ctx;
    const uint64_t ctrl_c_us = machine->line->ctrl_c_us;
    const uint64_t now = now_us(ctx);
    if (now >= longest_us) machine->is_endless = true;
    return machine->is_endless || (ctrl_c_us != 0 && now >= ctrl_c_us);
}

static bool is_output_gone(void *ctx) { return false; }

static void wait_for(void *ctx, int fd, short events, uint32_t max_us, bool watch_output)
{
    const tool_line_t *const line = ((const machine_t *)ctx)->line;
    line->idle(line->ctx, max_us != 0 ? max_us : 1);
    (void)now_us(ctx);
}

/* Whatever has happened may have been on any port. */
static void sleep_for(void *ctx, fathom_loop_t *loop, uint32_t max_us)
{
    wait_for(ctx, -1, 0, max_us, true);
    for (fathom_loop_source_t *source = loop->sources; source != NULL; source = source->next)
        fathom_loop_wake(source);
}

/* Signals and the output do not end a sleep here. */
static void attend(void *ctx, fathom_loop_t *loop) {}

/* Appends the JSON of a run to the file that FATHOM_JSON_LINES names, for test_schema.py. */
static void keep_json(const char *text)
{
    const char *const path = getenv("FATHOM_JSON_LINES");
    FILE *const to = path != NULL && strchr(text, '{') != NULL ? fopen(path, "a") : NULL;
    if (to == NULL) return;
    for (const char *end; (end = strchr(text, '\n')) != NULL; text = end + 1)
        if (text[0] == '{') (void)fprintf(to, "%.*s\n", (int)(end - text), text);
    (void)fclose(to);
}

/* Into argv, whose first word is "fathom". */
static int split(char *text, char *argv[WORDS])
{
    static char name[] = "fathom";
    int count = 1;
    argv[0] = name;
    for (char *word = strtok(text, " "); word != NULL; word = strtok(NULL, " ")) {
        assert_true(count < WORDS - 1);
        argv[count++] = word;
    }
    argv[count] = NULL;
    return count;
}

static machine_t machine; /* of the present run */

host_t tool_host(const tool_line_t *line)
{
    machine = (machine_t){.line = line, .last_us = line->clock.now_us(line->clock.ctx)};
    return (host_t){.open = open_port,
                    .close = close_port,
                    .open_pins = open_pins,
                    .close_pins = close_pins,
                    .now_us = now_us,
                    .utc_us = utc_us,
                    .begin = begin,
                    .has_ended = has_ended,
                    .is_output_gone = is_output_gone,
                    .wait = wait_for,
                    .loop = {.now_us = now_us, .sleep = sleep_for, .ctx = &machine},
                    .attend = attend,
                    .ctx = &machine};
}

const tool_run_t *tool_run(const tool_line_t *line, const char *format, ...)
{
    static tool_run_t run;
    static char *out;
    static char *err;
    const host_t host = tool_host(line);
    static char text[TEXT];
    char *argv[WORDS];
    size_t out_size;
    size_t err_size;
    va_list arguments;
    va_start(arguments, format);
    assert_in_range(vsnprintf(text, sizeof text, format, arguments), 1, sizeof text - 1);
    va_end(arguments);
    const int argc = split(text, argv);
    free(out);
    free(err);
    FILE *const own_stdout = stdout;
    FILE *const own_stderr = stderr;
    stdout = open_memstream(&out, &out_size);
    stderr = open_memstream(&err, &err_size);
    run.status = run_command(&host, argc, argv);
    (void)fclose(stdout);
    (void)fclose(stderr);
    stdout = own_stdout;
    stderr = own_stderr;
    keep_json(out);
    keep_json(err);
    run.out = out;
    run.err = err;
    run.took_us = now_us(&machine);
    if (machine.is_endless) fail_msg("it does not end: fathom %s ...\n%s%s", argv[1], out, err);
    return &run;
}
