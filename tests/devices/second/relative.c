/* SPDX-License-Identifier: MIT */
/* A relative of the A16: what its row says. Where no source says anything, `is_late` chooses one of two answers, which
 * also chooses the earliest or the latest response. */
#include "relatives.h"

#include "second_device.h"

enum { PROCESSED = 0x0100, REAL_TIME = 0x0101, TEMPERATURE = 0x0102, ADDRESS = 0x0200 };
enum { FRAME_LEN = 4, FRAMES_OF_A_MEASUREMENT = 3, SOON_US = 1000, LATE_US = 90000, NO_PULSE_US = 20000 };

static const second_relative_t *row_of(const second_device_t *d) { return d->config.relative; }
static uint64_t ms(uint32_t value) { return value * UINT64_C(1000); }
static uint64_t either(const second_device_t *d, uint64_t soon, uint64_t late)
{
    return d->config.is_late ? late : soon;
}

static int32_t seen(const second_device_t *d) { return second_truth_seen(d, 0, d->now_us, d->now_us, false); }

/* A trigger that comes too soon, or that the module does not have. */
static void refuse(second_device_t *d) { second_truth_log(d, SECOND_EVENT_REFUSED); }

static second_event_t *log_measurement(second_device_t *d)
{
    second_event_t *event = second_truth_log(d, SECOND_EVENT_MEASUREMENT);
    event->asked = row_of(d)->trigger != TRIGGER_NONE;
    event->seen_from_us = d->us.fall_us;
    event->sent[0] = d->us.last_sent[0];
    return event;
}

static void send_frame(second_device_t *d)
{
    uint8_t frame[FRAME_LEN] = {0xFF};
    put_word(frame + 1, d->us.last_sent[0]);
    frame[3] = second_wire_sum8(frame, 3);
    second_event_t *event = log_measurement(d);
    event->old_value = d->us.linger; /* 0: a new measurement */
    second_wire_send(d, frame, FRAME_LEN, d->now_us, d->line, event);
}

/* The second answer to a period: the module repeats each measurement within it. */
static void automatic(second_device_t *d)
{
    const uint64_t gap_us = ms(row_of(d)->gap_ms);
    const bool repeats = gap_us != 0 && d->config.is_late;
    const uint8_t count = repeats ? FRAMES_OF_A_MEASUREMENT : 1;
    if (d->us.linger == 0) d->us.last_sent[0] = (uint16_t)seen(d);
    send_frame(d);
    d->us.linger = (uint8_t)((d->us.linger + 1) % count);
    d->timer_us[TIMER_TICK] = d->now_us + (gap_us != 0 ? gap_us / count : either(d, 50000, 1000000));
}

/* Returns the width of the pulse, or 0 if there is none. */
static uint64_t width_us(const second_device_t *d, int32_t mm)
{
    const second_relative_t *row = row_of(d);
    const uint64_t scale = row->us_per_dm != 0 ? row->us_per_dm : either(d, 575, 588);
    if (mm == SECOND_NO_PULSE) return 0;
    if (mm != SECOND_NOTHING) return ((uint64_t)mm * scale + 50) / 100;
    return row->none_ms != 0 ? ms(row->none_ms)
                             : row->max_mm * scale / 80; /* a quarter longer than the longest */
}

static void pulse(second_device_t *d)
{
    const uint64_t us = width_us(d, seen(d));
    second_event_t *event = log_measurement(d);
    event->new_value = (int64_t)us;
    if (us != 0) {
        d->levels.high = true;
        d->timer_us[TIMER_BACK] = d->now_us + us;
    }
    if (row_of(d)->form == FORM_FREE_PULSE) d->timer_us[TIMER_TICK] = d->now_us + ms(row_of(d)->gap_ms);
}

static void trigger(second_device_t *d, uint64_t at_us)
{
    const second_relative_t *row = row_of(d);
    if (at_us < d->us.trigger_free_us || d->timer_us[TIMER_TICK] != SECOND_NEVER || d->levels.high) {
        refuse(d);
        return;
    }
    d->us.fall_us = at_us;
    d->us.trigger_free_us = at_us + ms(row->gap_ms);
    if (row->form == FORM_PULSE) {
        d->timer_us[TIMER_TICK] = at_us + either(d, 300, 12000); /* both were seen */
        return;
    }
    d->us.last_sent[0] = (uint16_t)seen(d);
    uint64_t due_us = at_us + (row->to_ms != 0 ? ms(row->to_ms) : LATE_US);
    if (!d->config.is_late) {
        const uint64_t frame_us = second_wire_length_us(d, FRAME_LEN, d->line);
        due_us = at_us + (ms(row->from_ms) > frame_us ? ms(row->from_ms) - frame_us : SOON_US);
    }
    d->timer_us[TIMER_TICK] = due_us;
}

/* A trigger counts when it is wide enough, or when it ends. */
static void on_level(second_device_t *d, bool low)
{
    const second_relative_t *row = row_of(d);
    if (!d->alive) return;
    if (row->trigger != TRIGGER_LOW && row->trigger != TRIGGER_HIGH) {
        refuse(d);
        return;
    }
    if (low == (row->trigger == TRIGGER_LOW)) {
        d->levels.changed_us = d->now_us;
        if (!d->config.is_late) d->timer_us[TIMER_TRIGGER] = d->now_us + row->least_us;
        return;
    }
    const uint64_t held_us = d->now_us - d->levels.changed_us;
    d->timer_us[TIMER_TRIGGER] = SECOND_NEVER;
    if (held_us > (row->most_us != 0 ? row->most_us : NO_PULSE_US))
        refuse(d); /* it is the rest, or another mode */
    if (d->config.is_late && held_us >= row->least_us) trigger(d, d->now_us);
}

static void on_frame(second_device_t *d)
{
    const second_relative_t *row = row_of(d);
    job_t job;
    if (row->form != FORM_MODBUS || !second_slave_frame(d, &job)) return;
    const bool is_real = word_at(job.bytes + 2) == REAL_TIME;
    const uint32_t longest_ms = is_real ? row->real_ms : row->to_ms;
    job.due_us = job.end_us + either(d, SOON_US, longest_ms != 0 ? ms(longest_ms) : LATE_US);
    if (d->job_count != 0) refuse(d);
    second_job_add(d, &job, false);
}

static void on_byte(second_device_t *d)
{
    const second_relative_t *row = row_of(d);
    if (row->form == FORM_MODBUS) return;
    if (row->trigger == TRIGGER_BYTE && d->rx[d->rx_len - 1] == row->trigger_byte)
        trigger(d, either(d, d->rx_begin_us, d->rx_end_us));
    else
        refuse(d);
    second_wire_drop_rx(d);
}

static void read_register(second_device_t *d, const job_t *job)
{
    const uint16_t reg = word_at(job->bytes + 2);
    const bool is_distance = reg == PROCESSED || reg == REAL_TIME;
    uint8_t frame[SECOND_FRAME_MAX] = {job->reply_address, 0x03, 2};
    uint16_t value = d->address;
    if (is_distance) value = d->us.last_sent[0] = (uint16_t)seen(d);
    if (reg == TEMPERATURE) value = (uint16_t)second_truth_seen(d, 1, d->now_us, d->now_us, false);
    const bool has = is_distance || reg == ADDRESS || (reg == TEMPERATURE && row_of(d)->has_temperature);
    if (!has || word_at(job->bytes + 4) != 1) {
        second_slave_refuse(d, job, 2);
        return;
    }
    put_word(frame + 3, value);
    second_event_t *event = second_slave_response(
        d, job, frame, 5, is_distance ? SECOND_EVENT_MEASUREMENT : SECOND_EVENT_RESPONSE);
    event->sent[0] = value;
}

static void write_register(second_device_t *d, const job_t *job) { second_slave_refuse(d, job, 2); }
static void on_job(second_device_t *d, const job_t *job)
{
    second_slave_job(d, job, read_register, write_register);
}

static void on_init(second_device_t *d)
{
    d->line = (second_line_t){row_of(d)->baud != 0 ? row_of(d)->baud : 9600, 'N', 1};
    d->us.stored_address = d->address = d->config.address;
}

static void on_power_on(second_device_t *d)
{
    d->us = (ultrasonic_t){.stored_address = d->us.stored_address};
    d->levels.changed_us = d->now_us;
}

static void on_alive(second_device_t *d)
{
    const second_form_t form = row_of(d)->form;
    if (form == FORM_AUTO || form == FORM_FREE_PULSE) d->timer_us[TIMER_TICK] = d->now_us;
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    const second_form_t form = row_of(d)->form;
    if (slot == TIMER_TRIGGER) trigger(d, d->now_us - row_of(d)->least_us);
    if (slot == TIMER_BACK) d->levels.high = false;
    if (slot != TIMER_TICK) return;
    if (form == FORM_AUTO)
        automatic(d);
    else if (form == FORM_CONTROLLED)
        send_frame(d);
    else
        pulse(d);
}

const hooks_t second_relative_hooks = {
    .init = on_init,
    .power_on = on_power_on,
    .alive = on_alive,
    .byte = on_byte,
    .frame = on_frame,
    .job = on_job,
    .timer = on_timer,
    .level = on_level,
    .silence_us = second_slave_silence_us,
};
