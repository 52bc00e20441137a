/* SPDX-License-Identifier: MIT */
#include "commands/publish/reload.h"

#include <string.h>

#include "reading/poll_change.h"

static uint64_t now_us(const reload_t *reload) { return reload->loop->host->now_us(reload->loop->host->ctx); }

bool reload_begin(reload_t *reload, const char *command)
{
    char path[CONFIG_PATH];
    (void)snprintf(path, sizeof path, "%s", reload->config->path);
    if (reload->is_waiting) config_free(&reload->next); /* for one that holds no more */
    reload->is_waiting = false;
    reload->next.sensors.beside = &reload->loop->options;
    if (!config_load(&reload->next, reload->configs, command, path)) return false;
    reload->is_waiting = true;
    reload->since_us = now_us(reload);
    return true;
}

/* The client is another one. With TLS always, since its files may have been changed. */
static bool is_other_broker(const config_t *one, const config_t *other)
{
    const broker_config_t *const broker = &one->broker;
    const broker_config_t *const that = &other->broker;
    return broker->has_tls || that->has_tls || broker->port != that->port ||
           broker->keep_alive_s != that->keep_alive_s || strcmp(broker->host, that->host) != 0 ||
           strcmp(broker->client_id, that->client_id) != 0 || strcmp(broker->user, that->user) != 0 ||
           strcmp(broker->password_file, that->password_file) != 0 || strcmp(one->site, other->site) != 0 ||
           strcmp(one->prefix, other->prefix) != 0;
}

static bool is_read(const poll_loop_t *loop, size_t slot)
{
    for (size_t i = 0; i != loop->options.station_count; i++)
        if (loop->options.stations[i]->slot == slot) return true;
    return false;
}

static void take_stations(reload_t *reload, bool is_renamed)
{
    const sensor_options_t *const options = &reload->loop->options;
    for (size_t slot = 0; slot != STATION_SLOTS; slot++)
        if (!is_read(reload->loop, slot)) publisher_remove(reload->publisher, slot);
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        results_config_t *const config = &reload->configs[station->slot];
        const results_config_t *const wanted = &reload->configs[reload->next.sensors.stations[i]->slot];
        const bool is_new = config == wanted;
        const bool has_changed = is_new || !results_config_is_same(config, wanted);
        if (has_changed && !is_new) results_config_copy(config, wanted);
        if (has_changed) results_add(reload->results, station, config);
        if ((has_changed || is_renamed) && !publisher_add(reload->publisher, station))
            (void)fprintf(stderr, "fathom: %s: there is no memory left\n", station->name);
    }
}

static void take_config(reload_t *reload)
{
    const bool is_other = is_other_broker(reload->config, &reload->next);
    const bool is_renamed = strcmp(reload->config->site, reload->next.site) != 0 ||
                            strcmp(reload->config->prefix, reload->next.prefix) != 0 ||
                            strcmp(reload->config->discovery, reload->next.discovery) != 0;
    (void)publisher_begin_change(reload->publisher);
    config_free(reload->config);
    *reload->config = reload->next;
    take_stations(reload, is_renamed);
    publisher_end_change(reload->publisher, is_other);
}

bool reload_tick(reload_t *reload)
{
    enum { PATIENCE_US = 2000000 };
    if (!reload->is_waiting) return false;
    if (!poll_loop_change(reload->loop, &reload->next.sensors,
                          now_us(reload) - reload->since_us > PATIENCE_US))
        return false;
    reload->is_waiting = false;
    take_config(reload);
    return true;
}
