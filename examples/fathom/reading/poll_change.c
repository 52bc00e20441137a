/* SPDX-License-Identifier: MIT */
#include "reading/poll_change.h"

#include <string.h>

#include "reading/poll_adapt.h"
#include "reading/poll_port.h"

/* What becomes of the ports: by the number of the loop's port, and of that of `next`. */
typedef struct {
    poll_loop_t *loop;
    const sensor_options_t *next;
    bool stays[MAX_PORTS];  /* as it is */
    bool adapts[MAX_PORTS]; /* stays open, and has other sensors */
    bool is_taken[MAX_PORTS];
    size_t place[MAX_PORTS];  /* of each of next's ports: the loop's */
    sensor_options_t options; /* the new ones */
} plan_t;

/* ---- what has changed ---- */

static bool is_same_line(const fathom_line_settings_t *one, const fathom_line_settings_t *other)
{
    return one->baud == other->baud && one->parity == other->parity && one->stop_bits == other->stop_bits;
}

static bool is_same_keys(const port_keys_t *one, const port_keys_t *other)
{
    for (int key = 0; key != PORT_KEYS; key++)
        if (one->has[key] != other->has[key] || (one->has[key] && one->value[key] != other->value[key]))
            return false;
    return true;
}

static bool is_same_path(const port_options_t *one, const port_options_t *other)
{
    return strcmp(one->path, other->path) == 0 && is_same_keys(&one->keys, &other->keys);
}

static bool is_same_port(const port_options_t *one, const port_options_t *other)
{
    return is_same_path(one, other) && is_same_line(&one->line, &other->line) &&
           one->has_mixed_lines == other->has_mixed_lines && one->station_count == other->station_count;
}

static const station_t *next_station(const plan_t *plan, size_t port, size_t number)
{
    for (size_t i = 0; i != plan->next->station_count; i++)
        if (plan->next->stations[i]->port == port && number-- == 0) return plan->next->stations[i];
    return NULL;
}

/* Has the loop's port all that next's has, in the same order? */
static bool stays(const plan_t *plan, size_t here, size_t there)
{
    const poll_port_t *const port = &plan->loop->ports[here];
    size_t number = 0;
    if (port->is_left || plan->loop->options.ports[here].station_count == 0 ||
        !is_same_port(&plan->loop->options.ports[here], &plan->next->ports[there]))
        return false;
    for (const station_t *station = port->stations; station != NULL; station = station->next)
        if (!station_is_same(station, next_station(plan, there, number++))) return false;
    return true;
}

/* Can its sensors come and go while it is open? */
static bool adapts(const plan_t *plan, size_t here, size_t there)
{
    const poll_port_t *const port = &plan->loop->ports[here];
    if (port->is_left || plan->loop->options.ports[here].station_count == 0 || !poll_may_adapt(port) ||
        !is_same_path(&plan->loop->options.ports[here], &plan->next->ports[there]))
        return false;
    for (size_t i = 0; i != plan->next->station_count; i++) {
        const station_t *const station = plan->next->stations[i];
        if (station->port == there && !(mode_is_asked(station->mode) && station->mode->has_address))
            return false;
    }
    return true;
}

/* Finds the loop's port for each of next's of which that is so. */
static void place_those(plan_t *plan, bool (*is_so)(const plan_t *plan, size_t here, size_t there),
                        bool is_so_of[MAX_PORTS])
{
    for (size_t there = 0; there != plan->next->port_count; there++)
        for (size_t here = 0; here != plan->loop->options.port_count && plan->place[there] == MAX_PORTS;
             here++) {
            if (plan->is_taken[here] || !is_so(plan, here, there)) continue;
            plan->place[there] = here;
            plan->is_taken[here] = true;
            is_so_of[here] = true;
        }
}

static void plan_ports(plan_t *plan)
{
    for (size_t there = 0; there != plan->next->port_count; there++) plan->place[there] = MAX_PORTS;
    place_those(plan, stays, plan->stays);
    place_those(plan, adapts, plan->adapts);
    for (size_t there = 0; there != plan->next->port_count; there++) {
        if (plan->place[there] != MAX_PORTS) continue;
        plan->place[there] = 0;
        while (plan->is_taken[plan->place[there]]) plan->place[there]++;
        plan->is_taken[plan->place[there]] = true;
    }
}

static bool is_open(const plan_t *plan, size_t here) { return plan->stays[here] || plan->adapts[here]; }

/* ---- what is under way ---- */

/* Is it read there in `next` too, as it is now? */
static bool goes_on(const plan_t *plan, size_t here, const station_t *station)
{
    for (size_t i = 0; i != plan->next->station_count; i++) {
        const station_t *const wanted = plan->next->stations[i];
        if (plan->place[wanted->port] == here && station_is_same(station, wanted)) return true;
    }
    return false;
}

/* Is a request of it under way that would be given up? Where the port stays open, only those that go. */
static bool is_busy(const plan_t *plan, size_t here)
{
    const poll_port_t *const port = &plan->loop->ports[here];
    for (const station_t *station = port->stations; station != NULL; station = station->next) {
        if (port->is_lost || !port->was_open || !reader_facts(station->reader).is_in_progress) continue;
        if (!(plan->adapts[here] && goes_on(plan, here, station))) return true;
    }
    return false;
}

static bool is_any_busy(const plan_t *plan)
{
    for (size_t here = 0; here != plan->loop->options.port_count; here++)
        if (!plan->stays[here] && is_busy(plan, here)) return true;
    return false;
}

/* ---- the change ---- */

/* The one that is read now as it is in `next`; else next's own. */
static station_t *find_station(const plan_t *plan, station_t *wanted)
{
    const sensor_options_t *const options = &plan->loop->options;
    const char *const path = plan->next->ports[wanted->port].path;
    for (size_t i = 0; i != options->station_count; i++)
        if (station_is_same(options->stations[i], wanted) &&
            strcmp(options->ports[options->stations[i]->port].path, path) == 0)
            return options->stations[i];
    return wanted;
}

static void find_stations(plan_t *plan)
{
    for (size_t i = 0; i != plan->next->station_count; i++)
        plan->options.stations[i] = find_station(plan, plan->next->stations[i]);
    for (size_t i = 0; i != plan->next->station_count; i++)
        plan->options.stations[i]->port = plan->place[plan->next->stations[i]->port];
}

static void close_ports(plan_t *plan)
{
    for (size_t here = 0; here != plan->loop->options.port_count; here++) {
        poll_port_t *const port = &plan->loop->ports[here];
        if (is_open(plan, here)) continue;
        if (port->was_open && !port->is_lost) (void)poll_port_end_stations(port);
        poll_port_end(port);
        memset(port, 0, sizeof *port);
    }
}

static void place_ports(plan_t *plan)
{
    poll_loop_t *const loop = plan->loop;
    memset(plan->options.ports, 0, sizeof plan->options.ports);
    plan->options.port_count = 0;
    for (size_t there = 0; there != plan->next->port_count; there++) {
        const size_t here = plan->place[there];
        plan->options.ports[here] = plan->next->ports[there];
        if (here >= plan->options.port_count) plan->options.port_count = here + 1;
    }
    loop->options = plan->options;
}

static void open_ports(plan_t *plan)
{
    poll_loop_t *const loop = plan->loop;
    loop->ports_left = 0;
    for (size_t here = 0; here != loop->options.port_count; here++) {
        const bool is_there = loop->options.ports[here].station_count != 0;
        if (is_there && !loop->ports[here].is_done) loop->ports_left++;
    }
    for (size_t i = loop->options.station_count; i != 0; i--) {
        station_t *const station = loop->options.stations[i - 1];
        if (!is_open(plan, station->port)) poll_port_add(&loop->ports[station->port], station);
    }
    for (size_t here = 0; here != loop->options.port_count; here++)
        if (!is_open(plan, here) && loop->options.ports[here].station_count != 0)
            poll_port_begin(&loop->ports[here], loop, &loop->options.ports[here]);
}

static void adapt_ports(plan_t *plan)
{
    poll_loop_t *const loop = plan->loop;
    for (size_t here = 0; here != loop->options.port_count; here++) {
        station_t *stations[MAX_STATIONS_ON_A_LINE];
        size_t count = 0;
        for (size_t i = 0; plan->adapts[here] && i != loop->options.station_count; i++)
            if (loop->options.stations[i]->port == here) stations[count++] = loop->options.stations[i];
        if (plan->adapts[here]) poll_adapt(&loop->ports[here], stations, count);
    }
}

bool poll_loop_change(poll_loop_t *loop, const sensor_options_t *next, bool is_urgent)
{
    static plan_t plan; /* too large for a small stack */
    memset(&plan, 0, sizeof plan);
    plan.loop = loop;
    plan.next = next;
    plan_ports(&plan);
    if (!is_urgent && is_any_busy(&plan)) return false;
    plan.options = *next;
    find_stations(&plan);
    close_ports(&plan);
    place_ports(&plan);
    adapt_ports(&plan);
    open_ports(&plan);
    return true;
}
