/* SPDX-License-Identifier: MIT */
/* Requests, responses and refusals; and the automatic output and the Modbus that the A16 and the A05 share. */
#include "second_device.h"

#include <string.h>

static int64_t either(const second_device_t *d, second_choice_t a16, second_choice_t a05)
{
    return chosen(d, d->config.kind == SECOND_A05_UART || d->config.kind == SECOND_A05_RS485 ? a05 : a16);
}

static second_event_t *log_request(second_device_t *d, const job_t *job, second_event_kind_t kind)
{
    second_event_t *event = second_truth_log(d, kind);
    event->start_us = job->begin_us;
    event->end_us = job->end_us;
    event->function = job->bytes[1];
    event->reg = word_at(job->bytes + 2);
    if (job->protocol == PROTOCOL_DYP) event->reg = (uint16_t)(0xAA00 + job->bytes[3]);
    memcpy(event->raw, job->bytes, job->len);
    event->raw_len = (uint8_t)job->len;
    return event;
}

void second_job_add(second_device_t *d, const job_t *job, bool queue)
{
    if (d->job_count == SECOND_JOBS || (d->job_count > 0 && !queue)) {
        log_request(d, job, SECOND_EVENT_REFUSED);
        return;
    }
    job_t *added = &d->jobs[d->job_count];
    *added = *job;
    if (added->due_us < d->now_us) added->due_us = d->now_us;
    if (d->job_count > 0) {
        uint64_t free_us = d->jobs[d->job_count - 1].due_us + (job->due_us - job->end_us);
        if (added->due_us < free_us) added->due_us = free_us;
    }
    d->job_count++;
    d->timer_us[TIMER_JOB] = d->jobs[0].due_us;
}

second_event_t *second_slave_response(second_device_t *d, const job_t *job, uint8_t *frame, size_t len,
                                      second_event_kind_t kind)
{
    if (job->protocol == PROTOCOL_MODBUS) {
        uint16_t crc = second_wire_crc16(frame, len);
        frame[len++] = (uint8_t)(crc & 0xFF);
        frame[len++] = (uint8_t)(crc >> 8);
    }
    if (!job->answered) return &d->unsent;
    second_event_t *event = second_truth_log(d, kind);
    event->asked = true;
    event->function = job->bytes[1];
    event->reg = job->protocol == PROTOCOL_DYP ? (uint16_t)(0xAA00 + job->bytes[3]) : word_at(job->bytes + 2);
    second_wire_send(d, frame, len, d->now_us, job->line, event);
    while (d->us.linger_behind > 0) {
        d->us.linger_behind--;
        d->hooks->unasked(d);
    }
    return event;
}

second_event_t *second_slave_echo(second_device_t *d, const job_t *job)
{
    uint8_t frame[SECOND_FRAME_MAX];
    memcpy(frame, job->bytes, 6);
    frame[0] = job->reply_address;
    return second_slave_response(d, job, frame, 6, SECOND_EVENT_RESPONSE);
}

void second_slave_refuse(second_device_t *d, const job_t *job, int64_t how)
{
    second_event_t *event = log_request(d, job, SECOND_EVENT_REFUSED);
    if (how == RESPONSE_SILENCE || !job->answered) return;
    event->exception = (uint8_t)how;
    if (how == RESPONSE_ECHOED) {
        second_slave_echo(d, job);
        return;
    }
    uint8_t frame[5] = {job->reply_address, job->bytes[1] | 0x80, (uint8_t)how};
    second_slave_response(d, job, frame, 3, SECOND_EVENT_RESPONSE);
}

void second_slave_job(second_device_t *d, const job_t *job, serve_t read, serve_t write)
{
    if (job->bytes[1] != 0x03 && job->bytes[1] != 0x06)
        second_slave_refuse(d, job, chosen(d, CHOICE_mb_illegal_function));
    else if (job->len != 8)
        second_slave_refuse(d, job, chosen(d, CHOICE_mb_bad_length));
    else if (job->bytes[1] == 0x03)
        read(d, job);
    else
        write(d, job);
}

void second_slave_setting(second_device_t *d, uint16_t reg, int64_t old_value, int64_t new_value, bool flash)
{
    if (flash) d->flash_writes++;
    second_event_t *event = second_truth_log(d, SECOND_EVENT_SETTING);
    event->reg = reg;
    event->old_value = old_value;
    event->new_value = new_value;
}

void second_slave_effect(second_device_t *d)
{
    if (d->next_address >= 0) d->address = (uint8_t)d->next_address;
    if (d->next_line.baud != 0) d->line = d->next_line;
    d->next_address = -1;
    d->next_line.baud = 0;
    second_truth_log(d, SECOND_EVENT_EFFECT);
}

void second_slave_discard(second_device_t *d)
{
    second_event_t *event = second_truth_log(d, SECOND_EVENT_DISCARDED);
    event->start_us = d->rx_begin_us;
    event->end_us = d->rx_end_us;
    event->old_value = (int64_t)d->rx_len;
    memcpy(event->raw, d->rx, d->rx_len);
    event->raw_len = (uint8_t)d->rx_len;
}

/* Is the request for this sensor, and from which address does it answer, if at all? */
static bool for_me(const second_device_t *d, job_t *job)
{
    uint8_t to = job->bytes[0];
    bool write = job->bytes[1] == 0x06;
    job->answered = true;
    job->reply_address = d->address;
    if (to == d->address) {
        job->answered =
            to != 0 || either(d, CHOICE_a16_address_zero, CHOICE_a05_address_zero) != RESPONSE_OTHER;
        return true;
    }
    if (to == 0xFF) {
        int64_t how = chosen(d, write ? CHOICE_mb_ff_write : CHOICE_mb_ff_read);
        job->answered = how != 0;
        if (how == 2) job->reply_address = 0xFF;
        return true;
    }
    job->answered = false;
    return to == 0 && write && chosen(d, CHOICE_mb_zero_broadcast) != 0;
}

static void leave_automatic(second_device_t *d, bool answered)
{
    uint8_t linger = (uint8_t)either(d, CHOICE_a16_linger, CHOICE_a05_linger);
    int64_t when = either(d, CHOICE_a16_linger_when, CHOICE_a05_linger_when);
    d->automatic = false;
    second_truth_log(d, SECOND_EVENT_EFFECT);
    if (when == 2 && linger > 0) { /* the tick goes on */
        d->us.linger = linger;
        return;
    }
    d->timer_us[TIMER_TICK] = SECOND_NEVER;
    if (when == 1 && answered) {
        d->us.linger_behind = linger;
        return;
    }
    for (; linger > 0; linger--) d->hooks->unasked(d);
}

bool second_slave_frame(second_device_t *d, job_t *job)
{
    memset(job, 0, sizeof *job);
    memcpy(job->bytes, d->rx, d->rx_len);
    job->len = d->rx_len;
    job->begin_us = d->rx_begin_us;
    job->end_us = d->rx_end_us;
    job->line = d->line;
    job->protocol = PROTOCOL_MODBUS;
    if (job->len < 4 || second_wire_crc16(job->bytes, job->len) != 0) {
        second_slave_discard(d);
        return false;
    }
    bool mine = for_me(d, job);
    if (!d->automatic) return mine;
    bool served = either(d, CHOICE_a16_first_command, CHOICE_a05_first_command) == 0;
    bool by_any = either(d, CHOICE_a16_switch_by, CHOICE_a05_switch_by) != 0;
    if (mine || by_any) leave_automatic(d, mine && served && job->answered);
    if (mine && !served) log_request(d, job, SECOND_EVENT_REFUSED);
    return mine && served;
}

bool second_slave_by_length(const second_device_t *d)
{
    return chosen(d, CHOICE_mb_frame_end) == 1 && !d->rx_bad && d->rx_len == 8 &&
           (d->rx[1] == 0x03 || d->rx[1] == 0x06);
}

uint64_t second_slave_silence_us(const second_device_t *d)
{
    if (chosen(d, CHOICE_mb_frame_end) == 2) return 20000;
    return second_wire_bits_ns(d->line, 7 * second_wire_character_bits(d->line)) / 2000;
}

void second_slave_write_address(second_device_t *d, const job_t *job, uint16_t value, int64_t zero)
{
    if (value > 0xFF) {
        int64_t how = chosen(d, CHOICE_mb_address_high);
        if (how != RESPONSE_TAKEN) {
            second_slave_refuse(d, job, how);
            return;
        }
        value &= 0xFF;
    }
    if (value == 0xFF || (value == 0 && zero < RESPONSE_OTHER)) {
        second_slave_refuse(d, job, value == 0xFF ? chosen(d, CHOICE_mb_address_ff) : zero);
        return;
    }
    bool at_power_on = chosen(d, CHOICE_mb_address_effect) != 0;
    bool kept = at_power_on || chosen(d, CHOICE_mb_address_kept) != 0;
    int64_t old_value = at_power_on ? d->us.stored_address : d->address;
    if (kept) d->us.stored_address = (uint8_t)value;
    if (!at_power_on) d->next_address = value;
    second_slave_setting(d, 0x0200, old_value, value, kept);
    second_slave_echo(d, job);
    if (!at_power_on) d->timer_us[TIMER_AFTER] = job->answered ? d->out_free_us : d->now_us;
}

void second_slave_tick(second_device_t *d, uint64_t period_us)
{
    if (!d->automatic && d->us.linger == 0) return;
    if (d->automatic || --d->us.linger > 0) d->timer_us[TIMER_TICK] = d->now_us + period_us;
    if (d->out_free_us <= d->now_us) d->hooks->unasked(d);
}
