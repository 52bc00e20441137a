/* SPDX-License-Identifier: MIT */
#include "reading/station.h"

#include <inttypes.h>
#include <string.h>

void station_name(station_t *station)
{
    if (station->has_own_name) return;
    (void)snprintf(station->name, sizeof station->name, station->mode->has_address ? "%s:%u" : "%s",
                   station->model->name, station->address);
}

static bool is_same_line(const station_t *one, const station_t *other)
{
    return one->line.baud == other->line.baud && one->line.parity == other->line.parity;
}

static bool is_same_window(const fathom_dyp_window_t *one, const fathom_dyp_window_t *other)
{
    return one->min_mm == other->min_mm && one->max_mm == other->max_mm &&
           one->value_fffd == other->value_fffd && one->value_fffe == other->value_fffe &&
           one->value_ffff == other->value_ffff && one->value_0 == other->value_0;
}

static bool is_same_reading(const reader_settings_t *one, const reader_settings_t *other)
{
    return one->timeout_us == other->timeout_us && one->period_us == other->period_us &&
           one->repeat_us == other->repeat_us && is_same_window(&one->window, &other->window) &&
           one->temperature_us == other->temperature_us && one->registers == other->registers &&
           one->probes == other->probes && one->value == other->value && one->has_value == other->has_value &&
           one->retries == other->retries;
}

bool station_is_same(const station_t *one, const station_t *other)
{
    return strcmp(one->name, other->name) == 0 && one->model == other->model && one->mode == other->mode &&
           one->address == other->address && one->line.stop_bits == other->line.stop_bits &&
           is_same_line(one, other) && is_same_reading(&one->settings, &other->settings);
}

bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings)
{
    return reader_open(&station->reader, station->mode, channel, settings);
}

void station_refusal(const station_t *station, char *text, size_t capacity)
{
    (void)snprintf(text, capacity, "%s: %s", station->name, reader_refusal(station->reader));
}

bool station_is_raised(station_t *station, char *text, size_t capacity)
{
    const uint32_t interval_us = station->settings.period_us;
    const uint32_t period_us = reader_facts(station->reader).least_period_us;
    if (interval_us == 0 || interval_us >= period_us || station->is_raise_told) return false;
    station->is_raise_told = true;
    (void)snprintf(text, capacity,
                   "asked every %.4g ms, which is the least it can do (--interval %" PRIu32 ")",
                   period_us / 1000.0, interval_us / 1000);
    return true;
}

void station_json(json_t *json, const station_t *station)
{
    json_string(json, "sensor", station->name);
    json_string(json, "model", station->model->name);
    json_string(json, "mode", station->mode->name);
}
