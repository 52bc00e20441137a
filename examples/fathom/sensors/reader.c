/* SPDX-License-Identifier: MIT */
#include "sensors/reader.h"

#include <string.h>

const char reader_modbus[] = "Modbus";

/* A connection has no line settings. */
static const fathom_line_settings_t *line_of(const channel_t *channel, const reader_settings_t *settings)
{
    return channel->tcp == NULL ? settings->line : NULL;
}

void reader_begin(reader_t *reader, channel_t *channel)
{
    memset(reader, 0, sizeof *reader);
    reader->line = &channel->line;
}

bool reader_has_break(reader_t *reader, const channel_t *channel)
{
    if (channel_has_break(channel)) return true;
    reader->refusal =
        "this port cannot hold its TX low (a break), which selects real-time values; try another "
        "adapter, or connect the sensor's RX to its ground and leave --value out";
    return false;
}

void reader_end_break(channel_t *channel)
{
    (void)fathom_line_break(&channel->line, false); /* a port that cannot end a break holds none */
}

fathom_modbus_config_t reader_config(const channel_t *channel, const reader_settings_t *settings)
{
    return (fathom_modbus_config_t){
        .line_settings = line_of(channel, settings),
        .period_us = settings->period_us,
        .timeout_us = settings->timeout_us,
        .backoff_us = settings->backoff_us,
        .address = settings->address,
        .address_zero = settings->address == 0,
        .retries = settings->retries,
    };
}

fathom_contact_timing_t reader_contact_timing(const channel_t *channel, const reader_settings_t *settings)
{
    enum { WITHOUT_EVENT_US = 1000000 }; /* A change without an event is seen within this time. */
    /* Without an interval, changes alone are readings, as far as the library allows. */
    const uint32_t repeat_us = settings->repeat_us != 0 ? settings->repeat_us : FATHOM_MAX_DURATION_US;
    return (fathom_contact_timing_t){.period_us = settings->period_us != 0 ? settings->period_us : repeat_us,
                                     .interval_us = channel->pins.wakes ? WITHOUT_EVENT_US : 0,
                                     .stale_us = settings->timeout_us};
}

bool reader_begin_contact(reader_t *reader, const channel_t *channel, fathom_contact_t *contact,
                          fathom_sensor_t sensor)
{
    reader->sensor = sensor;
    reader->sequence = &contact->sequence;
    reader->pins = &channel->pins;
    reader->is_paced = true;
    return true;
}

bool reader_got_unexpected_response(const reader_t *reader)
{
    return reader->unit != NULL && reader->unit->request.transaction.status == FATHOM_ERR_MALFORMED;
}

uint8_t reader_refused_probe(const reader_t *reader)
{
    return reader->response != NULL && !reader_got_unexpected_response(reader)
               ? reader->response->refused_probe
               : 0;
}

bool reader_has_more(const reader_t *reader)
{
    return reader->response != NULL && reader->response->left != 0;
}
