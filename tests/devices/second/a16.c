/* SPDX-License-Identifier: MIT */
/* A16: UART automatic, UART controlled, RS232, RS485. */
#include "second_device.h"

enum { PROCESSED = 0x0100, REAL_TIME = 0x0101, ADDRESS = 0x0200, MODE = 0x0202, POLARITY = 0x0205 };
enum { THRESHOLD = 0x0206, DATA_TYPE = 0x0207 };

typedef struct {
    uint16_t value;
    bool no_frame, not_ready;
    int32_t true_mm;
    uint64_t from_us, to_us;
} reading_t;

static void on_init(second_device_t *d)
{
    d->line = (second_line_t){9600, 'N', 1};
    d->us.stored_address = d->address = d->config.address;
    d->us.stored_type = (uint8_t)chosen(d, CHOICE_a16_type_default);
    d->us.polarity = 1;
    d->us.threshold = 1000;
}

static void on_power_on(second_device_t *d)
{
    d->address = d->us.stored_address;
    d->us.type = d->us.stored_type;
    d->us.select_low = d->level_low;
    d->us.select_us = d->now_us;
    d->us.trigger_free_us = 0;
    d->us.last_sent[0] = 0;
    d->us.linger = d->us.linger_behind = 0;
}

static void select_output(second_device_t *d)
{
    d->served_real = d->config.kind == SECOND_A16_AUTO ? d->us.select_low : d->us.type != 0;
}

static uint16_t value_sent(second_device_t *d, int32_t mm, bool *no_frame)
{
    if (mm == SECOND_NOTHING || mm > 0xFFFF) {
        int64_t nothing = chosen(d, CHOICE_a16_nothing);
        *no_frame = nothing == -2;
        if (nothing == -1) return d->us.last_sent[0];
        return nothing == -2 ? 0xFFFF : (uint16_t)nothing;
    }
    return d->us.last_sent[0] = (uint16_t)mm;
}

/* The value that the sensor gives out by itself, some response time behind the scene. */
static reading_t settled(second_device_t *d, bool real)
{
    uint64_t lag_us = chosen_us(d, real ? CHOICE_a16_realtime_us : CHOICE_a16_processed_us);
    uint64_t origin_us = d->power_on_us;
    if (d->config.kind == SECOND_A16_AUTO && chosen(d, CHOICE_a16_level_switch) != 0)
        origin_us = d->us.select_us;
    reading_t r = {.from_us = origin_us, .to_us = d->now_us};
    r.not_ready = d->now_us < d->power_on_us + lag_us;
    if (d->now_us > origin_us + lag_us) r.from_us = d->now_us - lag_us;
    bool mean = chosen(d, CHOICE_a16_settling) != 0;
    int64_t before = chosen(d, CHOICE_a16_before_ready);
    if (r.not_ready && before == 2) r.from_us = d->now_us;
    r.true_mm = second_truth_seen(d, 0, r.from_us, r.to_us, mean);
    if (r.not_ready && before != 2) {
        r.no_frame = before == 0;
        if (before == 3) r.value = value_sent(d, SECOND_NOTHING, &r.no_frame);
    } else {
        r.value = value_sent(d, r.true_mm, &r.no_frame);
    }
    if (!mean) r.to_us = r.from_us;
    return r;
}

static void describe(second_event_t *event, const reading_t *r)
{
    event->probes = 0x01;
    event->sent[0] = r->value;
    event->true_mm[0] = r->true_mm;
    event->no_target = r->true_mm == SECOND_NOTHING;
    event->not_ready = r->not_ready;
    event->seen_from_us = r->from_us;
    event->seen_to_us = r->to_us;
}

static void send_frame(second_device_t *d, const reading_t *r, bool asked)
{
    if (r->no_frame) return;
    uint8_t frame[5] = {0xFF, 0xFF, (uint8_t)(r->value >> 8), (uint8_t)(r->value & 0xFF)};
    frame[4] = second_wire_sum8(frame + 1, 3);
    size_t skip = chosen(d, CHOICE_a16_start_bytes) == 2 ? 0 : 1;
    second_event_t *event = second_truth_log(d, SECOND_EVENT_MEASUREMENT);
    event->asked = asked;
    describe(event, r);
    second_wire_send(d, frame + skip, 5 - skip, d->now_us, d->line, event);
}

static void unasked(second_device_t *d)
{
    reading_t r = settled(d, d->served_real);
    send_frame(d, &r, false);
}

/* UART controlled. */
static void trigger(second_device_t *d, uint64_t at_us)
{
    job_t job = {.begin_us = at_us, .end_us = at_us, .protocol = PROTOCOL_TRIGGER, .line = d->line};
    uint64_t t1_us = chosen_us(d, CHOICE_a16_t1_us);
    if (at_us < d->us.trigger_free_us) {
        int64_t early = chosen(d, CHOICE_a16_early_trigger);
        if (early == 0 || (early == 2 && d->us.trigger_free_us > at_us + t1_us)) {
            second_truth_log(d, SECOND_EVENT_REFUSED);
            return;
        }
        if (early == 1) d->job_count = 0;
        if (early == 2) job.begin_us = d->us.trigger_free_us;
    }
    d->us.trigger_free_us = job.begin_us + t1_us;
    job.due_us = job.begin_us + second_truth_span(d, 90000, CHOICE_a16_t2_us);
    size_t len = chosen(d, CHOICE_a16_start_bytes) == 2 ? 5 : 4;
    if (chosen(d, CHOICE_a16_t2_to) != 0) job.due_us -= second_wire_length_us(d, len, d->line);
    job.end_us = job.due_us; /* the next in the queue has its own time */
    second_job_add(d, &job, true);
}

static void triggered(second_device_t *d, const job_t *job)
{
    reading_t r = {.from_us = chosen(d, CHOICE_a16_sample_at) == 0 ? job->begin_us : d->now_us};
    r.to_us = r.from_us;
    r.true_mm = second_truth_seen(d, 0, r.from_us, r.to_us, false);
    r.value = value_sent(d, r.true_mm, &r.no_frame);
    if (r.no_frame) second_truth_log(d, SECOND_EVENT_REFUSED);
    send_frame(d, &r, true);
}

static void on_level(second_device_t *d, bool low)
{
    uint64_t width_us = chosen_us(d, CHOICE_a16_trigger_width_us);
    bool at_end = chosen(d, CHOICE_a16_trigger_edge) != 0;
    if (d->config.kind == SECOND_A16_AUTO) {
        d->timer_us[TIMER_LEVEL] = d->now_us + chosen_us(d, CHOICE_a16_level_stable_us);
    }
    if (d->config.kind != SECOND_A16_CONTROLLED || !d->alive) return;
    if (low) {
        d->us.fall_us = d->now_us;
        if (!at_end) d->timer_us[TIMER_TRIGGER] = d->now_us + width_us;
    } else {
        d->timer_us[TIMER_TRIGGER] = SECOND_NEVER;
        if (at_end && d->now_us >= d->us.fall_us + width_us) trigger(d, d->now_us);
    }
}

/* A byte on RX is a row of pulses: the first one that is wide enough counts. */
static void on_pulse(second_device_t *d, const input_t *byte)
{
    second_event_t *event = second_truth_log(d, SECOND_EVENT_NOISE);
    event->raw[0] = byte->value;
    event->raw_len = 1;
    if (d->config.kind != SECOND_A16_CONTROLLED || !d->alive) return;
    unsigned levels = (unsigned)byte->value << 1 | 0x200U; /* start bit, data, stop bit */
    for (uint32_t bit = 0; bit < 9; bit++) {
        uint32_t end = bit;
        while ((levels >> end & 1U) == 0) end++;
        if (second_wire_bits_ns(byte->line, end - bit) / 1000 >= chosen_us(d, CHOICE_a16_trigger_width_us) &&
            end > bit) {
            uint32_t edge = chosen(d, CHOICE_a16_trigger_edge) != 0 ? end : bit;
            trigger(d, byte->start_us + second_wire_bits_ns(byte->line, edge) / 1000);
            return;
        }
        if (end > bit) bit = end;
    }
}

static void on_alive(second_device_t *d)
{
    select_output(d);
    if (d->config.kind == SECOND_A16_CONTROLLED) {
        int64_t at_power_on = chosen(d, CHOICE_a16_trigger_at_power_on);
        if (at_power_on == 2 || (at_power_on == 1 && d->level_low)) trigger(d, d->now_us);
    }
    d->automatic = d->config.kind == SECOND_A16_AUTO || d->config.kind == SECOND_A16_RS232;
    if (d->automatic) d->timer_us[TIMER_TICK] = d->now_us;
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    if (slot == TIMER_TICK) second_slave_tick(d, chosen_us(d, CHOICE_a16_period_us));
    if (slot == TIMER_TRIGGER) trigger(d, d->us.fall_us);
    if (slot == TIMER_LEVEL && d->us.select_low != d->level_low) {
        d->us.select_low = d->level_low;
        d->us.select_us = d->now_us;
        if (!d->alive) return;
        select_output(d);
        second_truth_log(d, SECOND_EVENT_EFFECT);
    }
}

/* Modbus. */
static void on_frame(second_device_t *d)
{
    job_t job;
    if (!second_slave_frame(d, &job)) return;
    job.due_us = job.end_us + second_truth_span(d, 1000, CHOICE_a16_response_us);
    if (job.bytes[1] == 0x06) job.due_us += chosen_us(d, CHOICE_mb_flash_us);
    second_job_add(d, &job, chosen(d, CHOICE_mb_busy) != 0);
}

static void on_byte(second_device_t *d)
{
    if (!second_slave_by_length(d)) return;
    on_frame(d);
    second_wire_drop_rx(d);
}

/* RESPONSE_TAKEN: the register can be read, value is set; RESPONSE_ECHOED: the same. Else how it is refused. */
static int64_t read_one(second_device_t *d, uint16_t reg, reading_t *reading, uint16_t *value)
{
    int64_t for_switch = chosen(d, CHOICE_a16_switch_registers);
    switch (reg) {
    case PROCESSED:
    case REAL_TIME:
        *reading = settled(d, reg == REAL_TIME);
        *value = reading->value;
        return RESPONSE_TAKEN;
    case ADDRESS:
        *value = d->address;
        return RESPONSE_TAKEN;
    case MODE:
        *value = d->automatic;
        return chosen(d, CHOICE_a16_mode_read);
    case POLARITY:
        *value = d->us.polarity;
        return for_switch;
    case THRESHOLD:
        *value = d->us.threshold;
        return for_switch;
    case DATA_TYPE:
        *value = d->us.type;
        return d->config.kind == SECOND_A16_RS485 ? chosen(d, CHOICE_a16_type_rs485) : RESPONSE_TAKEN;
    default:
        *value = 0;
        return RESPONSE_SILENCE;
    }
}

static bool in_table(uint32_t reg)
{
    return (reg >= PROCESSED && reg <= REAL_TIME) || reg == ADDRESS || reg == MODE ||
           (reg >= POLARITY && reg <= DATA_TYPE);
}

static int64_t read_rule(const second_device_t *d, uint16_t first, uint16_t count)
{
    uint32_t known = 0;
    for (uint32_t i = 0; i < count; i++) known += in_table(first + i) ? 1U : 0U;
    if (count == 0 || count > 125) return chosen(d, CHOICE_mb_bad_count);
    if (known == 0) return chosen(d, CHOICE_mb_unknown_register);
    if (known < count) return chosen(d, CHOICE_a16_holes);
    return count > 1 ? chosen(d, CHOICE_a16_two_values) : RESPONSE_TAKEN;
}

static void read_registers(second_device_t *d, const job_t *job)
{
    uint16_t first = word_at(job->bytes + 2), count = word_at(job->bytes + 4);
    uint8_t frame[3 + 2 * 125 + 2] = {job->reply_address, 0x03, (uint8_t)(2 * count)};
    reading_t readings[2] = {{0}};
    uint8_t measured = 0;
    int64_t rule = read_rule(d, first, count);
    if (rule == RESPONSE_TAKEN && count > (SECOND_FRAME_MAX - 5) / 2) rule = chosen(d, CHOICE_mb_bad_count);
    for (uint16_t i = 0; i < count && rule >= RESPONSE_TAKEN; i++) {
        uint16_t reg = (uint16_t)(first + i), value = 0;
        bool real = reg == REAL_TIME;
        int64_t how = in_table(reg) ? read_one(d, reg, &readings[real ? 1 : 0], &value) : RESPONSE_TAKEN;
        if (how < RESPONSE_TAKEN) rule = how;
        if (reg == PROCESSED || real) measured |= real ? 2 : 1;
        put_word(frame + 3 + 2 * i, value);
    }
    if (rule < RESPONSE_TAKEN) {
        second_slave_refuse(d, job, rule);
        return;
    }
    size_t len = 3U + 2U * count;
    second_event_t *event = second_slave_response(
        d, job, frame, len, measured != 0 ? SECOND_EVENT_MEASUREMENT : SECOND_EVENT_RESPONSE);
    if (measured == 0 || event == &d->unsent) return;
    second_event_t sent = *event;
    bool real = (measured & 1) == 0;
    describe(event, &readings[real ? 1 : 0]);
    event->reg = real ? REAL_TIME : PROCESSED;
    event->served_real = real;
    if (measured != 3) return;
    event = second_truth_log(d, SECOND_EVENT_MEASUREMENT); /* a second value in the same frame */
    *event = sent;
    describe(event, &readings[1]);
    event->reg = REAL_TIME;
    event->served_real = true;
}

static void write_mode(second_device_t *d, const job_t *job, uint16_t value)
{
    int64_t how = RESPONSE_TAKEN;
    if (value > 1) how = chosen(d, CHOICE_a16_mode_value);
    if (d->config.kind == SECOND_A16_RS485) how = chosen(d, CHOICE_a16_mode_rs485);
    if (how != RESPONSE_TAKEN) {
        second_slave_refuse(d, job, how);
        return;
    }
    bool automatic = value != 0;
    second_slave_setting(d, MODE, d->automatic, automatic, false);
    second_slave_echo(d, job);
    if (automatic == d->automatic) return;
    d->automatic = automatic;
    d->us.linger = 0;
    d->timer_us[TIMER_TICK] = automatic ? d->out_free_us + chosen_us(d, CHOICE_a16_period_us) : SECOND_NEVER;
    second_truth_log(d, SECOND_EVENT_EFFECT);
}

static void write_register(second_device_t *d, const job_t *job)
{
    uint16_t reg = word_at(job->bytes + 2), value = word_at(job->bytes + 4);
    bool flag = reg == POLARITY || reg == DATA_TYPE;
    uint16_t *target = reg == POLARITY ? &d->us.polarity : reg == THRESHOLD ? &d->us.threshold : &d->us.type;
    int64_t how = RESPONSE_TAKEN;
    if (reg == ADDRESS) {
        second_slave_write_address(d, job, value, chosen(d, CHOICE_a16_address_zero));
        return;
    }
    if (reg == MODE) {
        write_mode(d, job, value);
        return;
    }
    if (reg == DATA_TYPE && d->config.kind == SECOND_A16_RS485) how = chosen(d, CHOICE_a16_type_rs485);
    if (reg == POLARITY || reg == THRESHOLD) how = chosen(d, CHOICE_a16_switch_registers);
    if (how == RESPONSE_TAKEN && flag && value > 1) how = chosen(d, CHOICE_a16_flag_value);
    if (reg == PROCESSED || reg == REAL_TIME) how = chosen(d, CHOICE_mb_read_only_write);
    if (!in_table(reg)) how = chosen(d, CHOICE_mb_unknown_register);
    if (how != RESPONSE_TAKEN) {
        second_slave_refuse(d, job, how);
        return;
    }
    if (flag && value > 1) value = 1; /* "as 1" */
    bool kept = reg != DATA_TYPE || chosen(d, CHOICE_a16_type_kept) != 0;
    uint16_t old_value = *target;
    *target = value;
    if (reg == DATA_TYPE && kept) d->us.stored_type = (uint8_t)value;
    second_slave_setting(d, reg, old_value, value, kept);
    second_slave_echo(d, job);
    select_output(d);
    if (reg == DATA_TYPE) second_truth_log(d, SECOND_EVENT_EFFECT);
}

static void on_job(second_device_t *d, const job_t *job)
{
    if (job->protocol == PROTOCOL_TRIGGER)
        triggered(d, job);
    else
        second_slave_job(d, job, read_registers, write_register);
}

const hooks_t second_a16_hooks = {
    .init = on_init,
    .power_on = on_power_on,
    .alive = on_alive,
    .byte = on_byte,
    .frame = on_frame,
    .pulse = on_pulse,
    .job = on_job,
    .timer = on_timer,
    .level = on_level,
    .unasked = unasked,
    .silence_us = second_slave_silence_us,
};
