/* SPDX-License-Identifier: MIT */
#include "ports/channel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output/words.h"
#include "ports/line_text.h"
#include "ports/tcp_address.h"

/* What the line has to know of a serial port, ... */
static void suit_serial(channel_t *channel, const fathom_line_settings_t *settings)
{
    channel->parts.silence_us = fathom_silence_us(settings);
    channel->parts.gap_us = CHANNEL_RESPONSE_GAP_US;
    channel->parts.echo = channel->echo;
    channel->parts.senders = &fathom_line_senders;
    channel->parts.masters = &fathom_line_masters;
}

/* ... and of a connection, where responses come whole and need no silence between them. */
static void suit_tcp(channel_t *channel)
{
    channel->parts.silence_us = 100; /* the least (line.h) */
    channel->parts.gap_us = 1000;
    channel->parts.echo = FATHOM_LINE_ECHO_OFF;
    channel->parts.senders = NULL; /* The server assigns each response to its request. */
    channel->parts.masters = NULL;
}

void channel_suit(channel_t *channel, const fathom_line_settings_t *settings)
{
    if (channel->tcp != NULL)
        suit_tcp(channel);
    else
        suit_serial(channel, settings);
}

static uint32_t now_us(void *ctx)
{
    const channel_t *const channel = ctx;
    return (uint32_t)channel->host->now_us(channel->host->ctx);
}

/* The user who has set it a while ago is to know why it is this port. */
static void tell_environment(fathom_posix_uart_t *port, const char *path)
{
    const char *const other = getenv("FATHOM_PORT"); /* NOLINT(concurrency-mt-unsafe): one thread */
    const size_t length = strlen(port->text);
    if (other != NULL && strcmp(other, path) == 0)
        (void)snprintf(port->text + length, sizeof port->text - length,
                       " (FATHOM_PORT in the environment names this port)");
}

static bool open_any(channel_t *channel, const char *path, const fathom_line_settings_t *settings)
{
    const host_t *const host = channel->host;
    channel->tcp = NULL;
    if (!tcp_names(path)) return host->open(host->ctx, path, settings, &channel->port, &channel->uart);
    channel->tcp = tcp_open(path, &channel->port, &channel->uart);
    return channel->tcp != NULL;
}

/* The port is open: a line on it. */
static void begin(channel_t *channel)
{
    if (channel->source != NULL) channel->uart = fathom_loop_uart(channel->source, &channel->uart);
    channel->clock = (fathom_clock_t){now_us, channel};
    listener_begin(&channel->listener, &channel->uart, &channel->clock);
    channel->parts.uart = &channel->uart;
    channel->parts.clock = &channel->clock;
    channel->parts.frame = channel->frame;
    channel->parts.frame_size = sizeof channel->frame;
    channel->parts.find_echo = fathom_line_find_echo;
    channel->parts.marks = fathom_line_marks;
    channel->parts.count = fathom_line_count;
    channel->parts.counters = channel->counters;
    (void)fathom_line_init(&channel->line, &channel->parts); /* all of it is there */
    channel->modbus = fathom_modbus_client_with_zero(&channel->line);
}

bool channel_open(channel_t *channel, const host_t *host, const char *path,
                  const fathom_line_settings_t *settings)
{
    channel->host = host;
    if (!open_any(channel, path, settings)) {
        tell_environment(&channel->port, path);
        return false;
    }
    channel_suit(channel, settings);
    if (channel->rs485 &&
        fathom_posix_set_rs485(&channel->port, &(fathom_posix_rs485_t){0}) != FATHOM_POSIX_OK) {
        channel_close(channel);
        return false;
    }
    begin(channel);
    return true;
}

bool channel_open_pins(channel_t *channel, const host_t *host, const char *chip, const pin_options_t *wanted)
{
    channel->host = host;
    channel->is_chip = host->open_pins(host->ctx, chip, wanted, &channel->pins, &channel->port);
    if (!channel->is_chip) {
        tell_environment(&channel->port, chip);
        return false;
    }
    channel->clock = (fathom_clock_t){now_us, channel};
    listener_begin(&channel->listener, &channel->uart, &channel->clock); /* hears nothing */
    return true;
}

void channel_look(channel_t *channel)
{
    if (channel->is_chip) pins_look(&channel->pins, &channel->port);
}

bool channel_begin_tcp(channel_t *channel, const host_t *host, const char *path, unsigned turn)
{
    channel->host = host;
    channel->tcp = tcp_begin(path, turn, &channel->port);
    if (channel->tcp == NULL) tell_environment(&channel->port, path);
    return channel->tcp != NULL;
}

fathom_status_t channel_go_on(channel_t *channel)
{
    const fathom_status_t status = tcp_go_on(channel->tcp, &channel->uart);
    if (status == FATHOM_ERR_PORT) tell_environment(&channel->port, channel->port.path);
    if (status != FATHOM_OK) return status;
    suit_tcp(channel);
    begin(channel);
    return FATHOM_OK;
}

void channel_close(channel_t *channel)
{
    if (channel->is_chip)
        channel->host->close_pins(channel->host->ctx, &channel->pins, &channel->port);
    else if (channel->tcp == NULL)
        channel->host->close(channel->host->ctx, &channel->port);
    else
        tcp_close(channel->tcp);
    channel->tcp = NULL;
    channel->is_chip = false;
}

void channel_listen(channel_t *channel, uint32_t for_us)
{
    const host_t *const host = channel->host;
    const uint64_t end_us = host->now_us(host->ctx) + for_us;
    for (uint64_t at_us; (at_us = host->now_us(host->ctx)) < end_us && !host->has_ended(host->ctx);) {
        if (fathom_line_poll(&channel->line) < 0) return;
        host->wait(host->ctx, &channel->port, (uint32_t)(end_us - at_us), false);
    }
}

bool channel_has_break(const channel_t *channel)
{
    return channel->uart.set_break != NULL && !channel->port.is_pty;
}
