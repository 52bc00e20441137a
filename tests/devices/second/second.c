/* SPDX-License-Identifier: MIT */
/* Inputs in, time forward, bytes out. */
#include "second_device.h"

#include <string.h>

static void add_input(second_device_t *d, const input_t *input)
{
    if (d->input_count == SECOND_INPUTS) {
        d->lost++;
        return;
    }
    size_t place = d->input_count++;
    while (place > 0) { /* stable: equal times keep their order */
        const input_t *before = &d->inputs[(d->input_first + place - 1) % SECOND_INPUTS];
        if (before->time_us <= input->time_us) break;
        d->inputs[(d->input_first + place) % SECOND_INPUTS] = *before;
        place--;
    }
    d->inputs[(d->input_first + place) % SECOND_INPUTS] = *input;
}

void second_power(second_device_t *device, bool on, uint64_t at_us)
{
    add_input(device, &(input_t){.kind = INPUT_POWER, .time_us = at_us, .on = on});
}

void second_host_byte(second_device_t *device, uint8_t value, uint64_t start_us, uint64_t end_us,
                      second_line_t line)
{
    input_t input = {
        .kind = INPUT_START, .time_us = start_us, .start_us = start_us, .value = value, .line = line};
    add_input(device, &input);
    input.kind = INPUT_BYTE;
    input.time_us = end_us;
    add_input(device, &input);
}

void second_rx_level(second_device_t *device, bool low, uint64_t at_us)
{
    add_input(device, &(input_t){.kind = INPUT_LEVEL, .time_us = at_us, .on = low});
}

void second_scene(second_device_t *device, const second_scene_t *scene, uint64_t at_us)
{
    add_input(device, &(input_t){.kind = INPUT_SCENE, .time_us = at_us, .scene = *scene});
}

void second_fault(second_device_t *device, bool failed, uint64_t at_us)
{
    add_input(device, &(input_t){.kind = INPUT_FAULT, .time_us = at_us, .on = failed});
}

static void power(second_device_t *d, bool on)
{
    if (d->powered == on) return;
    size_t cut = d->out_count;
    for (int i = 0; i < TIMER_COUNT; i++) d->timer_us[i] = SECOND_NEVER;
    d->powered = on;
    d->alive = d->automatic = d->levels.high = false;
    d->out_count = d->job_count = 0;
    d->out_begin_us = d->out_free_us = 0;
    d->next_address = -1;
    d->next_line.baud = 0;
    second_wire_drop_rx(d);
    if (on) {
        d->power_on_us = d->now_us;
        d->hooks->power_on(d);
        d->timer_us[TIMER_ALIVE] = d->now_us + chosen_us(d, CHOICE_any_power_on_us);
        if (chosen(d, CHOICE_any_power_on_glitch) >= 0 && d->config.kind < SECOND_TALKERS) {
            uint8_t glitch = (uint8_t)chosen(d, CHOICE_any_power_on_glitch);
            second_wire_send(d, &glitch, 1, d->now_us, d->line, NULL);
        }
    }
    second_event_t *event = second_truth_log(d, SECOND_EVENT_POWER);
    event->new_value = on;
    event->old_value = on ? 0 : (int64_t)cut;
}

static void take_input(second_device_t *d)
{
    input_t input = d->inputs[d->input_first];
    d->input_first = (d->input_first + 1) % SECOND_INPUTS;
    d->input_count--;
    switch (input.kind) {
    case INPUT_POWER:
        power(d, input.on);
        break;
    case INPUT_SCENE:
        d->scenes[d->scene_count % SECOND_SCENES].time_us = d->now_us;
        d->scenes[d->scene_count % SECOND_SCENES].scene = input.scene;
        d->scene_count++;
        break;
    case INPUT_FAULT:
        if (d->hooks->fault != NULL) d->hooks->fault(d, input.on);
        break;
    case INPUT_START:
    case INPUT_BYTE:
    case INPUT_LEVEL:
        second_wire_input(d, &input);
        break;
    }
}

static void frame_end(second_device_t *d)
{
    if (d->rx_bad) {
        second_slave_discard(d);
    } else if (d->rx_len > 0) {
        d->hooks->frame(d);
    }
    second_wire_drop_rx(d);
}

static void take_job(second_device_t *d)
{
    job_t job = d->jobs[0];
    d->job_count--;
    memmove(d->jobs, d->jobs + 1, d->job_count * sizeof d->jobs[0]);
    if (d->job_count > 0) d->timer_us[TIMER_JOB] = d->jobs[0].due_us;
    d->hooks->job(d, &job);
}

static void take_timer(second_device_t *d, timer_slot_t slot)
{
    d->timer_us[slot] = SECOND_NEVER;
    switch (slot) {
    case TIMER_ALIVE:
        d->alive = true;
        d->hooks->alive(d);
        second_truth_log(d, SECOND_EVENT_EFFECT);
        break;
    case TIMER_FRAME_END:
        frame_end(d);
        break;
    case TIMER_JOB:
        take_job(d);
        break;
    case TIMER_AFTER:
        second_slave_effect(d);
        break;
    case TIMER_TICK:
    case TIMER_LEVEL:
    case TIMER_TRIGGER:
    case TIMER_BACK:
    case TIMER_COUNT:
        d->hooks->timer(d, slot);
        break;
    }
}

static timer_slot_t first_timer(const second_device_t *d)
{
    timer_slot_t first = TIMER_ALIVE;
    for (int i = 1; i < TIMER_COUNT; i++) {
        if (d->timer_us[i] < d->timer_us[first]) first = (timer_slot_t)i;
    }
    return first;
}

uint64_t second_next_us(const second_device_t *d)
{
    uint64_t next_us = d->timer_us[first_timer(d)];
    if (d->input_count > 0 && d->inputs[d->input_first].time_us < next_us) {
        next_us = d->inputs[d->input_first].time_us;
    }
    if (d->out_count > 0 && d->out[d->out_first].end_us < next_us) next_us = d->out[d->out_first].end_us;
    return next_us;
}

void second_run(second_device_t *d, uint64_t until_us, second_sink_t sink, void *context)
{
    for (;;) {
        uint64_t next_us = second_next_us(d);
        if (next_us == SECOND_NEVER || next_us > until_us) break;
        if (next_us > d->now_us) d->now_us = next_us;
        timer_slot_t timer = first_timer(d);
        if (d->out_count > 0 && d->out[d->out_first].end_us <= next_us) {
            second_byte_t byte = d->out[d->out_first];
            d->out_first = (d->out_first + 1) % SECOND_OUTPUTS;
            d->out_count--;
            if (sink != NULL) sink(context, &byte);
        } else if (d->timer_us[timer] <= next_us) {
            take_timer(d, timer);
        } else {
            take_input(d);
        }
    }
    if (until_us > d->now_us && until_us != SECOND_NEVER) d->now_us = until_us;
}
