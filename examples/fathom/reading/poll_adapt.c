/* SPDX-License-Identifier: MIT */
#include "reading/poll_adapt.h"

#include "reading/poll_attempt.h"
#include "reading/poll_port.h"

bool poll_may_adapt(const poll_port_t *port)
{
    if (!port->was_open || port->is_lost || port->is_waiting || port->is_done) return false;
    for (const station_t *station = port->stations; station != NULL; station = station->next)
        if (!mode_is_asked(station->mode)) return false;
    return true;
}

static bool has(const poll_port_t *port, const station_t *station)
{
    const station_t *at = port->stations;
    while (at != NULL && at != station) at = at->next;
    return at != NULL;
}

static void go_on(poll_port_t *port, station_t *station)
{
    listener_t *const listener = poll_listener_of(port, station);
    if (listener != station->listener) listener_take_over(listener, station->listener);
    station->listener = listener;
    reader_set_backoff_us(station->reader, poll_backoff_us(port));
}

void poll_adapt(poll_port_t *port, station_t *const *stations, size_t count)
{
    bool is_new[MAX_STATIONS_ON_A_LINE];
    station_t *const before = port->stations;
    for (size_t i = 0; i != count; i++) is_new[i] = !has(port, stations[i]);
    port->stations = NULL;
    port->station_count = 0;
    for (station_t *at = before, *next; at != NULL; at = next) {
        next = at->next;
        size_t i = 0;
        while (i != count && stations[i] != at) i++;
        if (i == count) reader_cancel(at->reader);
    }
    for (size_t i = count; i != 0; i--) poll_port_add(port, stations[i - 1]);
    port_set_slowest(&port->channel, &port->options->line);
    bool is_good = true;
    for (size_t i = 0; i != count; i++)
        if (!is_new[i]) go_on(port, stations[i]);
    for (size_t i = 0; i != count && is_good; i++)
        is_good = !is_new[i] || poll_port_begin_station(port, stations[i]);
    port->channel.listener.whose = poll_is_shared(port) ? poll_whose : NULL;
    port->channel.listener.now = poll_is_shared(port) ? poll_whose(port) : NULL;
    if (is_good)
        fathom_loop_wake(&port->source);
    else
        poll_port_give_up(port);
}
