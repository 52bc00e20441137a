/* SPDX-License-Identifier: MIT */
#include "models/readers.h"

#include <string.h>

static const char modbus[] = "Modbus";

/* A connection has no line settings. */
static const fathom_line_settings_t *line_of(const channel_t *channel, const reader_settings_t *settings)
{
    return channel->tcp == NULL ? settings->line : NULL;
}

static void begin(reader_t *reader, channel_t *channel)
{
    memset(reader, 0, sizeof *reader);
    reader->line = &channel->line;
}

static bool begin_auto(reader_t *reader, fathom_dyp_auto_t *base, fathom_sensor_t sensor)
{
    reader->sensor = sensor;
    reader->stream = &base->stream;
    reader->values = base->answer.values;
    reader->value_count = (uint8_t)(base->stream.length / 2 - 1);
    reader->answer = &base->answer;
    reader->sequence = &base->answer.sequence;
    return true;
}

static bool begin_asked(reader_t *reader, fathom_dyp_modbus_t *base, fathom_sensor_t sensor,
                        const char *protocol)
{
    reader->sensor = sensor;
    reader->protocol = protocol;
    reader->is_paced = true;
    reader->unit = &base->unit;
    reader->values = base->answer.values;
    reader->value_count = (uint8_t)base->question.last;
    reader->answer = &base->answer;
    reader->sequence = &base->answer.sequence;
    return true;
}

bool reader_a16_auto(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_auto_t *const driver = &reader->driver.a16_auto;
    const fathom_a16_auto_config_t config = {
        .line = &channel->line,
        .stale_us = settings->timeout_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
    };
    begin(reader, channel);
    return fathom_a16_auto_init(driver, &config) == FATHOM_READY &&
           begin_auto(reader, &driver->base, fathom_a16_auto_sensor(driver));
}

bool reader_a05_auto(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_auto_t *const driver = &reader->driver.a05_auto;
    const fathom_a05_auto_config_t config = {
        .line = &channel->line,
        .stale_us = settings->timeout_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
        .probes = settings->probes,
    };
    begin(reader, channel);
    return fathom_a05_auto_init(driver, &config) == FATHOM_READY &&
           begin_auto(reader, &driver->base, fathom_a05_auto_sensor(driver));
}

/* Triggered by a break of the port, whose TX is the module's RX. */
bool reader_a16_controlled(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_controlled_t *const driver = &reader->driver.a16_controlled;
    const fathom_a16_controlled_config_t config = {
        .line = &channel->line,
        .trigger = fathom_output_line_break(&channel->line),
        .period_us = settings->period_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
    };
    begin(reader, channel);
    if (fathom_a16_controlled_init(driver, &config) != FATHOM_READY) return false;
    reader->sensor = fathom_a16_controlled_sensor(driver);
    reader->stream = &driver->stream;
    reader->values = driver->values;
    reader->value_count = 1;
    reader->answer = &driver->answer;
    reader->sequence = &driver->answer.sequence;
    reader->is_paced = true;
    return true;
}

/* What all that are asked have in common. Address 0 is the driver's to refuse, where the device cannot be there. */
static fathom_modbus_config_t asked(const channel_t *channel, const reader_settings_t *settings,
                                    const fathom_modbus_t *transport)
{
    return (fathom_modbus_config_t){
        .transport = transport,
        .settings = line_of(channel, settings),
        .period_us = settings->period_us,
        .timeout_us = settings->timeout_us,
        .backoff_us = settings->backoff_us,
        .address = settings->address,
        .address_zero = settings->address == 0,
        .retries = settings->retries,
    };
}

bool reader_a16_modbus(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_modbus_t *const driver = &reader->driver.a16_modbus;
    const fathom_a16_modbus_config_t config = {
        .modbus = asked(channel, settings, &channel->modbus),
        .window = settings->window,
    };
    begin(reader, channel);
    return fathom_a16_modbus_init(driver, &config) == FATHOM_READY &&
           begin_asked(reader, &driver->base, fathom_a16_modbus_sensor(driver), modbus);
}

bool reader_a05_modbus(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_modbus_t *const driver = &reader->driver.a05_modbus;
    const fathom_a05_modbus_config_t config = {
        .modbus = asked(channel, settings, &channel->modbus),
        .window = settings->window,
        .probes = settings->probes,
    };
    begin(reader, channel);
    return fathom_a05_modbus_init(driver, &config) == FATHOM_READY &&
           begin_asked(reader, &driver->base, fathom_a05_modbus_sensor(driver), modbus);
}

bool reader_a05_dyp(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_dyp_t *const driver = &reader->driver.a05_dyp;
    const fathom_a05_dyp_config_t config = {
        .modbus = asked(channel, settings, &channel->dyp),
        .window = settings->window,
        .probes = settings->probes,
    };
    begin(reader, channel);
    return fathom_a05_dyp_init(driver, &config) == FATHOM_READY &&
           begin_asked(reader, &driver->base, fathom_a05_dyp_sensor(driver), "55 AA");
}

bool reader_hps167s(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_hps167s_t *const driver = &reader->driver.hps167s;
    const fathom_hps167s_config_t config = {
        .modbus = asked(channel, settings, &channel->modbus),
    };
    begin(reader, channel);
    if (fathom_hps167s_init(driver, &config) != FATHOM_READY) return false;
    reader->sensor = fathom_hps167s_sensor(driver);
    reader->protocol = modbus;
    reader->is_paced = true;
    reader->unit = &driver->unit;
    reader->sequence = &driver->sequence;
    reader->values = driver->answer;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    return true;
}

bool reader_was_answered_wrong(const reader_t *reader)
{
    return reader->unit != NULL && reader->unit->request.exchange.status == FATHOM_ERR_MALFORMED;
}

uint8_t reader_refused_probe(const reader_t *reader)
{
    return reader->answer != NULL && !reader_was_answered_wrong(reader) ? reader->answer->refused_probe : 0;
}

bool reader_has_more(const reader_t *reader) { return reader->answer != NULL && reader->answer->left != 0; }
