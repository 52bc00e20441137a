/* SPDX-License-Identifier: MIT */
/* HPS-167S: Modbus with commands #1 to #15. */
#include "second_device.h"

#include <string.h>

enum { READ = 0x03, MEASURE = 0x08, FACTORY_RESET = 0x09 };

second_line_t second_hps_line(uint8_t code)
{
    static const uint32_t rates[] = {19200, 19200, 57600, 115200, 230400};
    return (second_line_t){rates[code < 5 ? code : 0], 'E', 1};
}

hps_settings_t second_hps_factory(const second_device_t *d)
{
    return (hps_settings_t){.id = 1,
                            .baud_code = 1,
                            .termination = 0xFF,
                            .auto_out = 0xFF,
                            .warm_s = 5,
                            .reconnect_ms = (uint32_t)chosen(d, CHOICE_hps_reconnect_ms)};
}

static void on_init(second_device_t *d)
{
    static const uint8_t version[6] = {0x14, 0x09, 0x1B, 0x02, 0x01, 0x00};
    static const uint8_t details[22] = {0xB0, 0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14, 0x20, 0x34,
                                        0x38, 0x35, 0x01, 0x06, 0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09};
    hps_t *s = &d->hps;
    s->flash = second_hps_factory(d);
    s->flash.id = d->config.address;
    s->flash.baud_code = (uint8_t)chosen(d, CHOICE_hps_baud_code);
    s->flash.termination = (uint8_t)chosen(d, CHOICE_hps_termination);
    s->flash.auto_out = (uint8_t)chosen(d, CHOICE_hps_auto_out);
    s->used = s->set = s->flash;
    d->address = s->flash.id;
    d->line = second_hps_line(s->flash.baud_code);
    memcpy(s->version, version, sizeof s->version);
    memcpy(s->details, details, sizeof s->details);
    if (chosen(d, CHOICE_hps_details) == 0) return;
    for (size_t i = 0; i < sizeof s->version; i++) s->version[i] = (uint8_t)second_truth_random(d, 256);
    for (size_t i = 1; i < sizeof s->details; i++) s->details[i] = (uint8_t)second_truth_random(d, 256);
}

static void on_power_on(second_device_t *d)
{
    d->hps.used = d->hps.set = d->hps.flash;
    d->address = d->hps.used.id;
    d->line = second_hps_line(d->hps.used.baud_code);
    d->hps.warm_since_us = d->now_us;
    d->hps.pause_until_us = 0;
    d->hps.fault_since_us = d->now_us;
    d->hps.fault_sent = d->hps.unasked_stopped = false;
}

static void on_alive(second_device_t *d)
{
    d->automatic = chosen(d, CHOICE_hps_unasked) != 0 && d->hps.used.auto_out != 0;
    if (d->automatic) d->timer_us[TIMER_TICK] = d->now_us;
}

bool second_hps_warming_up(const second_device_t *d)
{
    return d->now_us < d->hps.warm_since_us + d->hps.used.warm_s * UINT64_C(1000000);
}

static uint64_t silence_us(const second_device_t *d)
{
    if (d->line.baud > 19200) return 1750;
    return second_wire_bits_ns(d->line, 7 * second_wire_character_bits(d->line)) / 2000;
}

/* Measurements. */
static uint16_t distance(const second_device_t *d, int32_t mm, bool *over_range)
{
    int64_t value = (int64_t)mm + chosen(d, CHOICE_hps_deviation_mm) + d->hps.used.offset;
    int64_t near = mm < 80 ? chosen(d, CHOICE_hps_near) : 0;
    *over_range = mm == SECOND_NOTHING || mm > chosen(d, CHOICE_hps_far_mm) || near == 3 || value >= 65530;
    if (*over_range) return (uint16_t)chosen(d, CHOICE_hps_over_range);
    if (near != 0) return near == 1 ? 80 : 0;
    if (value < 0 && chosen(d, CHOICE_hps_below_zero) == 0) return 0;
    return (uint16_t)(value & 0xFFFF);
}

static void measure(second_device_t *d, uint64_t at_us, uint8_t *data, second_event_t *event)
{
    uint64_t lag_us = 0;
    if (d->hps.used.filter > 0)
        lag_us = (uint64_t)d->hps.used.filter * chosen_us(d, CHOICE_hps_filter_lag_us);
    event->seen_from_us = at_us > d->power_on_us + lag_us ? at_us - lag_us : d->power_on_us;
    event->seen_to_us = event->seen_from_us;
    event->true_mm[0] = second_truth_seen(d, 0, event->seen_from_us, event->seen_to_us, false);
    event->sent[0] = distance(d, event->true_mm[0], &event->no_target);
    event->probes = 0x01;
    int64_t magnitude = chosen(d, CHOICE_hps_magnitude), precision = chosen(d, CHOICE_hps_precision);
    int64_t exponent = chosen(d, CHOICE_hps_magnitude_exp);
    if (event->no_target) {
        precision = chosen(d, CHOICE_hps_over_precision);
        if (chosen(d, CHOICE_hps_over_magnitude) >= 0) {
            magnitude = chosen(d, CHOICE_hps_over_magnitude);
            exponent = 0;
        }
    }
    put_word(data, event->sent[0]);
    put_word(data + 2, (uint16_t)magnitude);
    data[4] = (uint8_t)exponent;
    data[5] = (uint8_t)chosen(d, CHOICE_hps_ambient);
    put_word(data + 6, (uint16_t)precision);
}

static void abnormal(const second_device_t *d, uint8_t *data, second_event_t *event)
{
    memset(data, 0xFF, 8);
    put_word(data + 2, 0);
    data[4] = (uint8_t)chosen(d, CHOICE_hps_abnormal_exp);
    event->fault = true;
    event->probes = 0x01;
    event->sent[0] = 0xFFFF;
    event->true_mm[0] = second_truth_seen(d, 0, d->now_us, d->now_us, false);
}

bool second_hps_fails(second_device_t *d)
{
    int64_t every = chosen(d, CHOICE_hps_fault_every);
    return every != 0 && second_truth_random(d, (uint32_t)every) == 0;
}

void second_hps_fill(second_device_t *d, uint64_t at_us, bool failed, uint8_t *data, second_event_t *seen)
{
    if (failed)
        abnormal(d, data, seen);
    else
        measure(d, at_us, data, seen);
}

void second_hps_log(second_event_t *event, const second_event_t *seen, const job_t *job)
{
    event->asked = job->end_us != 0;
    event->probes = seen->probes;
    event->fault = seen->fault;
    event->no_target = seen->no_target;
    event->seen_from_us = seen->seen_from_us;
    event->seen_to_us = seen->seen_to_us;
    event->true_mm[0] = seen->true_mm[0];
    event->sent[0] = seen->sent[0];
}

void second_hps_send(second_device_t *d, const job_t *job, bool failed)
{
    uint8_t frame[16] = {job->reply_address, READ, 8};
    second_event_t seen = {0};
    bool at_request = job->end_us != 0 && chosen(d, CHOICE_hps_sample_at) == 0;
    second_hps_fill(d, at_request ? job->end_us : d->now_us, failed, frame + 3, &seen);
    second_hps_log(second_slave_response(d, job, frame, 11, SECOND_EVENT_MEASUREMENT), &seen, job);
}

static void unasked(second_device_t *d)
{
    job_t job = {.bytes = {d->address, READ, 0, MEASURE}, .answered = true, .line = d->line};
    job.reply_address = d->address;
    if (d->now_us < d->hps.pause_until_us || d->hps.unasked_stopped) return;
    if (second_hps_warming_up(d)) {
        if (chosen(d, CHOICE_hps_unasked_warm) != 0) second_hps_send(d, &job, true);
        return;
    }
    if (!d->hps.failed) {
        second_hps_send(d, &job, second_hps_fails(d));
        return;
    }
    uint64_t wait_us = d->hps.used.reconnect_ms * UINT64_C(1000);
    bool once = chosen(d, CHOICE_hps_fault_packets) != 0;
    if (d->now_us < d->hps.fault_since_us + wait_us || (once && d->hps.fault_sent)) return;
    d->hps.fault_sent = true;
    second_hps_send(d, &job, true);
}

static void restart(second_device_t *d)
{
    second_line_t line = d->line;
    uint8_t code = d->hps.used.baud_code;
    on_power_on(d);
    if (chosen(d, CHOICE_hps_reset_order) == 2) { /* the rate waits for power-on */
        d->line = line;
        d->hps.used.baud_code = code;
    }
    d->alive = d->automatic = false;
    d->job_count = 0;
    d->timer_us[TIMER_JOB] = d->timer_us[TIMER_TICK] = SECOND_NEVER;
    d->timer_us[TIMER_ALIVE] = d->now_us + chosen_us(d, CHOICE_any_power_on_us);
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    if (slot == TIMER_BACK) restart(d);
    if (slot != TIMER_TICK || !d->automatic) return;
    bool busy = d->rx_len > 0 || d->now_us < d->rx_end_us + silence_us(d);
    if (busy && chosen(d, CHOICE_hps_unasked_idle) != 0) {
        d->timer_us[TIMER_TICK] = d->now_us + silence_us(d);
        return;
    }
    d->timer_us[TIMER_TICK] = d->now_us + chosen_us(d, CHOICE_hps_unasked_us);
    if (d->out_free_us <= d->now_us) unasked(d);
}

/* Requests. */
static void on_frame(second_device_t *d)
{
    job_t job = {.len = d->rx_len, .begin_us = d->rx_begin_us, .end_us = d->rx_end_us, .line = d->line};
    memcpy(job.bytes, d->rx, d->rx_len);
    job.bad_crc = job.len < 4 || second_wire_crc16(job.bytes, job.len) != 0;
    bool mine = job.bytes[0] == d->address;
    if (job.bad_crc && (!mine || job.len < 4 || chosen(d, CHOICE_hps_bad_crc) == RESPONSE_SILENCE)) {
        second_slave_discard(d);
        return;
    }
    if (!mine && job.bytes[0] != 0) return;
    job.answered = mine;
    job.reply_address = d->address;
    if (chosen(d, CHOICE_hps_other_parity) == 2) {
        job.line.parity = d->rx_line.parity;
        job.line.stop_bits = d->rx_line.stop_bits;
    }
    bool measurement = job.bytes[1] == READ && word_at(job.bytes + 2) == MEASURE;
    if (second_hps_warming_up(d) && !measurement && chosen(d, CHOICE_hps_warm_other) == RESPONSE_SILENCE) {
        second_slave_refuse(d, &job, RESPONSE_SILENCE);
        return;
    }
    int64_t unasked_then = chosen(d, CHOICE_hps_unasked_request);
    if (unasked_then == 1) d->hps.pause_until_us = job.end_us + d->hps.used.reconnect_ms * UINT64_C(1000);
    if (unasked_then == 2) d->hps.unasked_stopped = true;
    job.due_us = job.end_us;
    if (measurement)
        job.due_us += second_truth_span(d, 18519, CHOICE_hps_measure_us);
    else
        job.due_us += second_truth_span(d, 2006, CHOICE_hps_response_us);
    if (job.bytes[1] != READ || word_at(job.bytes + 2) == FACTORY_RESET)
        job.due_us += chosen_us(d, CHOICE_hps_flash_us);
    second_job_add(d, &job, chosen(d, CHOICE_hps_busy) != 0);
}

static void on_fault(second_device_t *d, bool failed)
{
    if (failed && !d->hps.failed) d->hps.fault_since_us = d->now_us;
    d->hps.failed = failed;
    d->hps.fault_sent = false;
}

static bool hears(const second_device_t *d, second_line_t line)
{
    if (chosen(d, CHOICE_hps_other_parity) != 0) line.parity = d->line.parity;
    return second_wire_same(line, d->line);
}

const hooks_t second_hps_hooks = {
    .init = on_init,
    .power_on = on_power_on,
    .alive = on_alive,
    .frame = on_frame,
    .job = second_hps_job,
    .timer = on_timer,
    .fault = on_fault,
    .unasked = unasked,
    .hears = hears,
    .silence_us = silence_us,
};
