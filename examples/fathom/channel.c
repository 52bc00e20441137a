/* SPDX-License-Identifier: MIT */
#include "channel.h"

#include <inttypes.h>
#include <stdio.h>

bool channel_open(channel_t *channel, const char *path, const fathom_line_settings_t *settings)
{
    const unsigned bits = 9u + (settings->parity != FATHOM_PARITY_NONE ? 1u : 0u) + settings->stop_bits;
    if (fathom_posix_open(&channel->port, path, settings) != FATHOM_POSIX_OK) return false;
    channel->uart = fathom_posix_uart(&channel->port);
    channel->clock = fathom_posix_clock();
    ear_begin(&channel->ear, &channel->uart, &channel->clock);
    channel->config.uart = &channel->uart;
    channel->config.clock = &channel->clock;
    channel->config.frame = channel->frame;
    channel->config.frame_size = sizeof channel->frame;
    channel->config.silence_us = FATHOM_T3_5_US(settings->baud, bits);
    channel->config.gap_us = CHANNEL_ANSWER_GAP_US;
    channel->config.echo = channel->echo;
    (void)fathom_line_init(&channel->line, &channel->config); /* all of it is there */
    channel->modbus = fathom_modbus_client(&channel->line);
    return true;
}

void channel_close(channel_t *channel) { fathom_posix_close(&channel->port); }

const char *settings_text(const fathom_line_settings_t *settings, char text[SETTINGS_TEXT])
{
    static const char parities[] = "NEO";
    (void)snprintf(text, SETTINGS_TEXT, "%" PRIu32 " 8%c%u", settings->baud, parities[settings->parity],
                   settings->stop_bits);
    return text;
}
