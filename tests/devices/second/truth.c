/* SPDX-License-Identifier: MIT */
/* What is in front of the probes, and the log for a judge. */
#include "second_device.h"

#include <string.h>

second_event_t *second_truth_log(second_device_t *d, second_event_kind_t kind)
{
    second_event_t *event = &d->log[d->log_count++ % SECOND_LOG_EVENTS];
    memset(event, 0, sizeof *event);
    event->kind = kind;
    event->time_us = d->now_us;
    event->line = d->line;
    event->address = d->address;
    event->automatic = d->automatic;
    event->served_real = d->served_real;
    event->fitted = d->config.fitted;
    event->flash_writes = d->flash_writes;
    for (size_t i = 0; i < SECOND_PROBES; i++) event->true_mm[i] = SECOND_NOTHING;
    return event;
}

uint64_t second_log_count(const second_device_t *device) { return device->log_count; }

const second_event_t *second_log_at(const second_device_t *device, uint64_t index)
{
    if (index >= device->log_count || index + SECOND_LOG_EVENTS < device->log_count) return NULL;
    return &device->log[index % SECOND_LOG_EVENTS];
}

second_state_t second_state(const second_device_t *d)
{
    return (second_state_t){d->powered, d->alive, d->automatic,    d->served_real,
                            d->address, d->line,  d->flash_writes, d->lost};
}

static uint64_t oldest(const second_device_t *d)
{
    return d->scene_count > SECOND_SCENES ? d->scene_count - SECOND_SCENES : 0;
}

int32_t second_truth_seen(const second_device_t *d, size_t probe, uint64_t from_us, uint64_t to_us, bool mean)
{
    uint64_t end_us = to_us, seen_us = 0, nothing_us = 0, sum = 0;
    for (uint64_t i = d->scene_count; i-- > oldest(d);) {
        uint64_t begin_us = d->scenes[i % SECOND_SCENES].time_us;
        int32_t mm = d->scenes[i % SECOND_SCENES].scene.mm[probe];
        bool last = begin_us <= from_us || i == oldest(d);
        if (last && (!mean || from_us == to_us)) return mm;
        if (last) begin_us = from_us;
        if (begin_us < end_us) {
            uint64_t span_us = end_us - begin_us;
            if (mm == SECOND_NOTHING) {
                nothing_us += span_us;
            } else {
                seen_us += span_us;
                sum += span_us * (uint64_t)mm;
            }
            end_us = begin_us;
        }
        if (last) break;
    }
    if (seen_us == 0 || nothing_us >= seen_us) return SECOND_NOTHING;
    return (int32_t)((sum + seen_us / 2) / seen_us);
}

uint32_t second_truth_random(second_device_t *d, uint32_t below)
{
    d->random ^= d->random << 13;
    d->random ^= d->random >> 7;
    d->random ^= d->random << 17;
    return (uint32_t)((d->random >> 16) % below);
}

uint64_t second_truth_span(second_device_t *d, uint64_t shortest_us, second_choice_t longest)
{
    uint64_t drawn_us = chosen_us(d, longest);
    if (chosen(d, CHOICE_any_response_jitter) == 0 || drawn_us <= shortest_us) return drawn_us;
    return shortest_us + second_truth_random(d, (uint32_t)(drawn_us - shortest_us) + 1);
}
