/* SPDX-License-Identifier: MIT */
/* A05: UART automatic with Modbus; RS485 with 55 AA frames and Modbus. */
#include "second_device.h"

#include <string.h>

enum { DISTANCE = 0x0106, DISTANCE_ALIAS = 0x0010, ADDRESS = 0x0200 };
enum { ALL_PROBES = 0x01, SET_ADDRESS = 0x03, ONE_PROBE = 0x10, DYP_REQUEST_LEN = 5 };

static bool fitted(const second_device_t *d, size_t probe) { return (d->config.fitted >> probe & 1) != 0; }

static void on_init(second_device_t *d)
{
    d->line = (second_line_t){9600, 'N', 1};
    if (d->config.kind == SECOND_A05_UART) d->line.parity = (char)chosen(d, CHOICE_a05_uart_parity);
    d->us.stored_address = d->address = d->config.address;
}

static void on_power_on(second_device_t *d)
{
    d->address = d->us.stored_address;
    d->served_real = false;
    d->us.level_recorded = false;
    d->us.low_seen = d->level_low;
    d->us.high_seen = !d->level_low;
    d->us.linger = d->us.linger_behind = 0;
    d->us.dyp_free_us = d->us.set_address_us = 0;
    memset(d->us.last_sent, 0, sizeof d->us.last_sent);
    if (d->config.kind != SECOND_A05_UART) return;
    bool instant = chosen(d, CHOICE_a05_level_rule) == 0;
    d->timer_us[TIMER_LEVEL] = d->now_us + (instant ? chosen_us(d, CHOICE_a05_level_instant_us) : 1000000);
}

static void on_alive(second_device_t *d)
{
    d->automatic = d->config.kind == SECOND_A05_UART;
    if (d->automatic) d->timer_us[TIMER_TICK] = d->now_us;
}

/* Values. */
static uint16_t value_sent(second_device_t *d, size_t probe, int32_t mm)
{
    if (mm == SECOND_NOTHING || mm > 0xFFFF) {
        int64_t nothing = chosen(d, CHOICE_a05_nothing);
        return nothing == -1 ? d->us.last_sent[probe] : (uint16_t)nothing;
    }
    return d->us.last_sent[probe] = (uint16_t)mm;
}

/* Puts the probes asked for into the event, seen between the event's two times. */
static void see(second_device_t *d, second_event_t *event, uint8_t probes, bool mean)
{
    uint16_t before = 0;
    event->probes = probes;
    for (size_t probe = 0; probe < SECOND_PROBES; probe++) {
        if (!fitted(d, probe)) {
            int64_t value = chosen(d, CHOICE_a05_unfitted);
            if (value == -1) value = chosen(d, CHOICE_a05_unfitted_value);
            if (value == -2) value = second_truth_random(d, 0x10000);
            event->sent[probe] = value == -3 ? before : (uint16_t)value;
            continue;
        }
        int32_t mm = second_truth_seen(d, probe, event->seen_from_us, event->seen_to_us, mean);
        uint16_t last_sent = d->us.last_sent[probe];
        bool asked = (probes >> probe & 1) != 0;
        event->true_mm[probe] = mm;
        event->sent[probe] = before = value_sent(d, probe, mm);
        if (mm == SECOND_NOTHING && asked) event->no_target = true;
        if (!asked) d->us.last_sent[probe] = last_sent;
    }
}

static void unasked(second_device_t *d)
{
    if (!d->us.level_recorded && chosen(d, CHOICE_a05_before_level) == 0) return;
    uint64_t lag_us = chosen_us(d, d->served_real ? CHOICE_a05_realtime_us : CHOICE_a05_processed_us);
    int64_t before = chosen(d, CHOICE_a05_before_ready);
    bool mean = chosen(d, CHOICE_a05_settling) != 0;
    second_event_t seen = {0};
    seen.not_ready = d->now_us < d->power_on_us + lag_us;
    if (seen.not_ready && before == 0) return;
    seen.seen_from_us = seen.not_ready ? d->power_on_us : d->now_us - lag_us;
    if (seen.not_ready && before == 2) seen.seen_from_us = d->now_us;
    seen.seen_to_us = mean ? d->now_us : seen.seen_from_us;
    second_event_t *event = second_truth_log(d, SECOND_EVENT_MEASUREMENT);
    event->not_ready = seen.not_ready;
    event->seen_from_us = seen.seen_from_us;
    event->seen_to_us = seen.seen_to_us;
    see(d, event, 0x0F, mean);
    uint8_t frame[10] = {0xFF};
    for (size_t probe = 0; probe < SECOND_PROBES; probe++) {
        if (fitted(d, probe) && seen.not_ready && before == 1) event->sent[probe] = 0;
        if (fitted(d, probe) && seen.not_ready && before == 3)
            event->sent[probe] = value_sent(d, probe, SECOND_NOTHING);
        put_word(frame + 1 + 2 * probe, event->sent[probe]);
    }
    frame[9] = second_wire_sum8(frame, 9);
    second_wire_send(d, frame, sizeof frame, d->now_us, d->line, event);
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    if (slot == TIMER_TICK) second_slave_tick(d, chosen_us(d, CHOICE_a05_period_us));
    if (slot == TIMER_LEVEL) {
        int64_t rule = chosen(d, CHOICE_a05_level_rule);
        d->served_real = rule == 0 ? d->level_low : d->us.low_seen && (rule == 1 || !d->us.high_seen);
        d->us.level_recorded = true;
        second_truth_log(d, SECOND_EVENT_EFFECT);
    }
    if (slot == TIMER_BACK && !d->automatic) {
        d->automatic = true;
        d->us.linger = 0;
        d->timer_us[TIMER_TICK] = d->now_us;
        second_truth_log(d, SECOND_EVENT_EFFECT);
    }
}

static void on_level(second_device_t *d, bool low)
{
    if (low)
        d->us.low_seen = true;
    else
        d->us.high_seen = true;
}

/* 55 AA frames. */
static size_t dyp_stream(uint8_t *frame, uint8_t address, uint8_t command, const second_event_t *seen)
{
    size_t len = 4;
    frame[0] = 0x55;
    frame[1] = 0xAA;
    frame[2] = address;
    frame[3] = command;
    for (size_t probe = 0; seen != NULL && probe < SECOND_PROBES; probe++) {
        if ((seen->probes >> probe & 1) == 0) continue;
        put_word(frame + len, seen->sent[probe]);
        len += 2;
    }
    frame[len] = second_wire_sum8(frame, len);
    return len + 1;
}

/* seen_from_us of a request's measurement. */
static void see_for(second_device_t *d, const job_t *job, second_event_t *seen, uint8_t probes)
{
    seen->seen_from_us = chosen(d, CHOICE_a05_sample_at) == 0 ? job->end_us : d->now_us;
    seen->seen_to_us = seen->seen_from_us;
    for (size_t probe = 0; probe < SECOND_PROBES; probe++) seen->true_mm[probe] = SECOND_NOTHING;
    see(d, seen, probes, false);
}

static void copy_seen(second_event_t *event, const second_event_t *seen)
{
    event->probes = seen->probes;
    event->no_target = seen->no_target;
    event->seen_from_us = seen->seen_from_us;
    event->seen_to_us = seen->seen_to_us;
    memcpy(event->true_mm, seen->true_mm, sizeof event->true_mm);
    memcpy(event->sent, seen->sent, sizeof event->sent);
}

static void dyp_measure(second_device_t *d, const job_t *job)
{
    uint8_t command = job->bytes[3], frame[16];
    uint8_t probes = (uint8_t)(command == ALL_PROBES ? 0x0FU : 1U << (command - ONE_PROBE));
    second_event_t seen = {0};
    if ((probes & d->config.fitted) == 0 && chosen(d, CHOICE_a05_unfitted_alone) != RESPONSE_TAKEN) {
        second_slave_refuse(d, job, RESPONSE_SILENCE);
        return;
    }
    see_for(d, job, &seen, probes);
    size_t len = dyp_stream(frame, job->reply_address, command, &seen);
    if (command == ALL_PROBES && chosen(d, CHOICE_a05_all_sum) != 0)
        frame[len - 1] = (uint8_t)(second_wire_sum8(frame, 2) + second_wire_sum8(frame + 4, len - 5));
    copy_seen(second_slave_response(d, job, frame, len, SECOND_EVENT_MEASUREMENT), &seen);
}

static void dyp_set_address(second_device_t *d, const job_t *job)
{
    uint8_t address = job->bytes[2], frame[16];
    bool taken = address != 0xFF;
    if (address == 0) taken = chosen(d, CHOICE_a05_dyp_address_zero) == RESPONSE_TAKEN;
    if (!taken && (address == 0 || chosen(d, CHOICE_a05_dyp_address_ff) == RESPONSE_SILENCE)) {
        second_slave_refuse(d, job, RESPONSE_SILENCE);
        return;
    }
    if (taken) {
        bool at_once = chosen(d, CHOICE_a05_dyp_address_effect) == 0;
        bool kept = !at_once || chosen(d, CHOICE_mb_address_kept) != 0;
        int64_t old_value = at_once ? d->address : d->us.stored_address;
        if (kept) d->us.stored_address = address;
        if (at_once) d->next_address = address;
        second_slave_setting(d, 0xAA00 + SET_ADDRESS, old_value, address, kept);
        if (at_once) second_slave_effect(d);
    }
    size_t len = dyp_stream(frame, address, SET_ADDRESS, NULL);
    if (chosen(d, CHOICE_a05_dyp_address_response) != 0) {
        const second_event_t zero = {.probes = 0x01};
        len = dyp_stream(frame, address, ONE_PROBE, &zero);
    }
    if (!taken) second_truth_log(d, SECOND_EVENT_REFUSED)->exception = RESPONSE_ECHOED;
    second_slave_response(d, job, frame, len, SECOND_EVENT_RESPONSE);
}

static void dyp_request(second_device_t *d, const uint8_t *bytes)
{
    job_t job = {.len = DYP_REQUEST_LEN, .end_us = d->rx_end_us, .protocol = PROTOCOL_DYP, .line = d->line};
    uint8_t to = bytes[2], command = bytes[3];
    bool all = command == ALL_PROBES, known = all || (command >= ONE_PROBE && command < ONE_PROBE + 4);
    memcpy(job.bytes, bytes, DYP_REQUEST_LEN);
    job.begin_us = d->rx_begin_us;
    if (d->rx_len > DYP_REQUEST_LEN)
        job.begin_us =
            job.end_us -
            second_wire_bits_ns(d->line, DYP_REQUEST_LEN * second_wire_character_bits(d->line)) / 1000;
    job.answered = true;
    job.reply_address = d->address;
    if (command == SET_ADDRESS) { /* names only the new address: every sensor on the pair takes it */
        /* The response looks like the request: another sensor's response must not be answered again. */
        bool again = d->us.set_address_us != 0 && job.begin_us < d->us.set_address_us + 250000;
        if (again) {
            second_slave_refuse(d, &job, RESPONSE_SILENCE);
            return;
        }
        d->us.set_address_us = job.end_us;
        job.due_us = job.end_us + second_truth_span(d, 1000, CHOICE_a05_response_us) +
                     chosen_us(d, CHOICE_mb_flash_us);
        second_job_add(d, &job, true);
        return;
    }
    if (to != d->address && to != 0xFF) return;
    if (to == 0xFF) {
        job.answered = chosen(d, CHOICE_a05_dyp_ff) != 0;
        if (chosen(d, CHOICE_a05_dyp_ff) == 2) job.reply_address = 0xFF;
    } else if (to == 0) {
        job.answered = chosen(d, CHOICE_a05_address_zero) != RESPONSE_OTHER;
    }
    if (!known) {
        second_slave_refuse(d, &job, RESPONSE_SILENCE);
        return;
    }
    int64_t early = chosen(d, CHOICE_a05_early);
    uint64_t wait_us = 0;
    if (job.begin_us < d->us.dyp_free_us && early != 1) {
        if (early == 0) {
            second_slave_refuse(d, &job, RESPONSE_SILENCE);
            return;
        }
        wait_us = d->us.dyp_free_us - job.begin_us;
    }
    d->us.dyp_free_us = job.begin_us + wait_us + (all ? 250000 : 100000);
    job.due_us = chosen(d, CHOICE_a05_t2_from) == 0 ? job.end_us : job.begin_us;
    job.due_us += wait_us;
    job.due_us += all ? second_truth_span(d, 200000, CHOICE_a05_all_us)
                      : second_truth_span(d, 65000, CHOICE_a05_one_us);
    if (chosen(d, CHOICE_a05_t2_to) != 0) job.due_us -= second_wire_length_us(d, all ? 13 : 7, d->line);
    second_job_add(d, &job, true);
}

static bool ends_in_dyp_request(const second_device_t *d)
{
    if (d->config.kind != SECOND_A05_RS485 || d->rx_len < DYP_REQUEST_LEN) return false;
    const uint8_t *tail = d->rx + d->rx_len - DYP_REQUEST_LEN;
    if (tail[0] != 0x55 || tail[1] != 0xAA || tail[4] != second_wire_sum8(tail, 4)) return false;
    return chosen(d, CHOICE_a05_dyp_search) != 0 || (d->rx_len == DYP_REQUEST_LEN && !d->rx_bad);
}

static void on_byte(second_device_t *d)
{
    d->us.low_seen = d->us.high_seen = true; /* start bit and stop bit */
    if (ends_in_dyp_request(d)) {
        dyp_request(d, d->rx + d->rx_len - DYP_REQUEST_LEN);
        second_wire_drop_rx(d);
    } else if (second_slave_by_length(d)) {
        d->hooks->frame(d);
        second_wire_drop_rx(d);
    }
}

/* Modbus. The first probe of a read, or SECOND_PROBES. */
static size_t first_probe(const second_device_t *d, uint16_t reg)
{
    if (reg >= DISTANCE && reg < DISTANCE + SECOND_PROBES) return (size_t)(reg - DISTANCE);
    size_t aliases = chosen(d, CHOICE_a05_alias_end) != 0 ? SECOND_PROBES : SECOND_PROBES - 1;
    if (reg >= DISTANCE_ALIAS && reg < DISTANCE_ALIAS + aliases) return (size_t)(reg - DISTANCE_ALIAS);
    return SECOND_PROBES;
}

static void go_back_later(second_device_t *d)
{
    uint64_t back_us = chosen_us(d, CHOICE_a05_back_us);
    if (back_us != 0) d->timer_us[TIMER_BACK] = d->now_us + back_us;
}

static void on_frame(second_device_t *d)
{
    job_t job;
    bool was_automatic = d->automatic, served = second_slave_frame(d, &job);
    if (was_automatic && !d->automatic) go_back_later(d);
    if (!served) return;
    uint16_t reg = word_at(job.bytes + 2), count = word_at(job.bytes + 4);
    bool measure = job.len == 8 && job.bytes[1] == 0x03 && first_probe(d, reg) < SECOND_PROBES && count > 0;
    job.due_us = job.end_us;
    if (measure) {
        size_t probes = SECOND_PROBES - first_probe(d, reg);
        if (count < probes) probes = count;
        job.due_us += second_truth_span(d, 65000, CHOICE_a05_modbus_one_us);
        for (; probes > 1; probes--) job.due_us += second_truth_span(d, 1000, CHOICE_a05_modbus_more_us);
    } else {
        job.due_us += second_truth_span(d, 1000, CHOICE_a05_response_us);
        if (job.bytes[1] == 0x06) job.due_us += chosen_us(d, CHOICE_mb_flash_us);
    }
    d->timer_us[TIMER_BACK] = SECOND_NEVER;
    second_job_add(d, &job, chosen(d, CHOICE_mb_busy) != 0);
}

static int64_t read_rule(const second_device_t *d, uint16_t reg, uint16_t count)
{
    size_t probe = first_probe(d, reg);
    bool alias = reg < DISTANCE;
    size_t end = alias && chosen(d, CHOICE_a05_alias_end) == 0 ? SECOND_PROBES - 1 : SECOND_PROBES;
    if (count == 0 || count > 125) return chosen(d, CHOICE_mb_bad_count);
    if (reg == ADDRESS && count == 1) return RESPONSE_TAKEN;
    if (probe == SECOND_PROBES) return chosen(d, CHOICE_mb_unknown_register);
    if (alias && count > 1 && chosen(d, CHOICE_a05_alias_many) != RESPONSE_TAKEN)
        return chosen(d, CHOICE_a05_alias_many);
    if (probe + count > end) return chosen(d, CHOICE_a05_past_end);
    if (count == 1 && !fitted(d, probe)) return chosen(d, CHOICE_a05_unfitted_alone);
    return RESPONSE_TAKEN;
}

static void read_registers(second_device_t *d, const job_t *job)
{
    uint16_t reg = word_at(job->bytes + 2), count = word_at(job->bytes + 4);
    int64_t rule = read_rule(d, reg, count);
    uint8_t frame[16] = {job->reply_address, 0x03, 2};
    if (rule < RESPONSE_OTHER) {
        second_slave_refuse(d, job, rule);
        return;
    }
    if (reg == ADDRESS) {
        put_word(frame + 3, d->address);
        second_slave_response(d, job, frame, 5, SECOND_EVENT_RESPONSE);
        return;
    }
    size_t first = first_probe(d, reg), end = first + count, len = 3;
    size_t last = reg < DISTANCE && chosen(d, CHOICE_a05_alias_end) == 0 ? SECOND_PROBES - 1 : SECOND_PROBES;
    uint8_t probes = 0;
    if (end > last) end = last;
    for (size_t probe = first; probe < end; probe++) probes |= (uint8_t)(1U << probe);
    second_event_t seen = {0};
    see_for(d, job, &seen, probes);
    for (size_t probe = first; probe < end; probe++, len += 2) put_word(frame + len, seen.sent[probe]);
    frame[2] = (uint8_t)(len - 3);
    copy_seen(second_slave_response(d, job, frame, len, SECOND_EVENT_MEASUREMENT), &seen);
}

static void write_register(second_device_t *d, const job_t *job)
{
    uint16_t reg = word_at(job->bytes + 2);
    if (reg == ADDRESS)
        second_slave_write_address(d, job, word_at(job->bytes + 4), chosen(d, CHOICE_a05_address_zero));
    else if (first_probe(d, reg) < SECOND_PROBES)
        second_slave_refuse(d, job, chosen(d, CHOICE_mb_read_only_write));
    else
        second_slave_refuse(d, job, chosen(d, CHOICE_mb_unknown_register));
}

static void on_job(second_device_t *d, const job_t *job)
{
    if (job->protocol == PROTOCOL_DYP) {
        if (job->bytes[3] == SET_ADDRESS)
            dyp_set_address(d, job);
        else
            dyp_measure(d, job);
        return;
    }
    second_slave_job(d, job, read_registers, write_register);
    if (d->config.kind == SECOND_A05_UART) go_back_later(d);
}

const hooks_t second_a05_hooks = {
    .init = on_init,
    .power_on = on_power_on,
    .alive = on_alive,
    .byte = on_byte,
    .frame = on_frame,
    .job = on_job,
    .timer = on_timer,
    .level = on_level,
    .unasked = unasked,
    .silence_us = second_slave_silence_us,
};
