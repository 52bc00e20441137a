/* SPDX-License-Identifier: MIT */
/* HPS-167 with a UART: frames of its own around the measurements of the HPS-167S. From what public programs for it send
 * and expect; what they leave open is a choice. */
#include "second_device.h"

#include <string.h>

enum { SINGLE = 0x22, CONTINUOUS = 0x24, STOP = 0x30, TEMPERATURE = 0x3F };
enum { START = 0x0A, REQUEST_LEN = 10, COMMAND = 1, FIRST = 2, DATA = 2, UNKNOWN = 3, ANY_BYTES = -1 };

/* CRC-16/CCITT-FALSE: x^16 + x^12 + x^5 + 1, all ones first, the high bit of each byte first. */
uint16_t second_hps167_crc(const uint8_t *bytes, size_t len)
{
    uint32_t rest = 0xFFFF;
    for (size_t i = 0; i < len; i++) {
        rest ^= (uint32_t)bytes[i] << 8;
        for (int bit = 0; bit < 8; bit++) {
            rest <<= 1;
            if (rest > 0xFFFF) rest ^= 0x11021;
        }
    }
    return (uint16_t)rest;
}

static second_event_t *send(second_device_t *d, const job_t *job, uint8_t *frame, size_t count,
                            second_event_kind_t kind)
{
    frame[0] = START;
    frame[1] = (uint8_t)(count + 2);
    put_word(frame + DATA + count, second_hps167_crc(frame + DATA, count));
    return second_slave_response(d, job, frame, DATA + count + 2, kind);
}

static void send_measurement(second_device_t *d, const job_t *job)
{
    uint8_t frame[SECOND_FRAME_MAX];
    second_event_t seen = {0};
    int64_t unknown = chosen(d, CHOICE_hps167_unknown);
    for (size_t i = 0; i < UNKNOWN; i++)
        frame[DATA + i] = unknown == ANY_BYTES ? (uint8_t)second_truth_random(d, 256) : (uint8_t)unknown;
    bool at_request = job->end_us != 0 && chosen(d, CHOICE_hps_sample_at) == 0;
    second_hps_fill(d, at_request ? job->end_us : d->now_us, second_hps_fails(d), frame + DATA + UNKNOWN,
                    &seen);
    second_event_t *event = send(d, job, frame, UNKNOWN + 8, SECOND_EVENT_MEASUREMENT);
    second_hps_log(event, &seen, job);
}

static void unasked(second_device_t *d)
{
    const job_t job = {
        .bytes = {START, CONTINUOUS}, .answered = true, .protocol = PROTOCOL_HPS167, .line = d->line};
    send_measurement(d, &job);
}

static void end_output(second_device_t *d)
{
    d->automatic = false;
    d->timer_us[TIMER_TICK] = SECOND_NEVER;
    second_truth_log(d, SECOND_EVENT_EFFECT);
}

static void on_job(second_device_t *d, const job_t *job)
{
    uint8_t frame[SECOND_FRAME_MAX];
    switch (job->bytes[COMMAND]) {
    case SINGLE:
        send_measurement(d, job);
        return;
    case CONTINUOUS:
        d->automatic = true;
        d->timer_us[TIMER_TICK] = d->now_us;
        second_truth_log(d, SECOND_EVENT_EFFECT);
        return;
    case STOP:
        end_output(d);
        frame[DATA] = 1;
        send(d, job, frame, 1, SECOND_EVENT_RESPONSE);
        return;
    default: /* TEMPERATURE */
        put_word(frame + DATA, (uint16_t)chosen(d, CHOICE_hps167_temperature));
        send(d, job, frame, 2, SECOND_EVENT_RESPONSE);
        return;
    }
}

static bool is_known(const job_t *job)
{
    uint8_t command = job->bytes[COMMAND];
    if (command == SINGLE || command == CONTINUOUS) return true;
    return (command == STOP || command == TEMPERATURE) && job->bytes[FIRST] == 1;
}

static void on_frame(second_device_t *d)
{
    job_t job = {.len = d->rx_len,
                 .begin_us = d->rx_begin_us,
                 .end_us = d->rx_end_us,
                 .answered = true,
                 .protocol = PROTOCOL_HPS167,
                 .line = d->line};
    memcpy(job.bytes, d->rx, d->rx_len);
    if (job.len != REQUEST_LEN || job.bytes[0] != START ||
        second_hps167_crc(job.bytes, REQUEST_LEN - 2) != word_at(job.bytes + REQUEST_LEN - 2)) {
        second_slave_discard(d);
        return;
    }
    bool is_single = job.bytes[COMMAND] == SINGLE;
    int64_t beside = chosen(d, CHOICE_hps167_single_beside);
    if (!is_known(&job) || (is_single && d->automatic && beside == 2)) {
        second_slave_refuse(d, &job, RESPONSE_SILENCE);
        return;
    }
    if (is_single && d->automatic && beside == 1) end_output(d);
    job.due_us = job.end_us + chosen_us(d, CHOICE_hps167_reply_us);
    if (is_single || job.bytes[COMMAND] == CONTINUOUS)
        job.due_us = job.end_us + second_truth_span(d, 1000, CHOICE_hps_measure_us);
    second_job_add(d, &job, chosen(d, CHOICE_hps_busy) != 0);
}

static void on_byte(second_device_t *d)
{
    if (chosen(d, CHOICE_hps167_frame_end) != 0 || d->rx_bad || d->rx_len != REQUEST_LEN) return;
    on_frame(d);
    second_wire_drop_rx(d);
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    if (slot != TIMER_TICK || !d->automatic) return;
    d->timer_us[TIMER_TICK] = d->now_us + chosen_us(d, CHOICE_hps_measure_us);
    if (d->out_free_us <= d->now_us) unasked(d);
}

static void on_init(second_device_t *d) { d->line = (second_line_t){115200, 'N', 1}; }
static void on_power_on(second_device_t *d) { d->hps.failed = false; }

static void on_alive(second_device_t *d)
{
    static const char text[] = "Hypersen\r\n";
    size_t len = (size_t)chosen(d, CHOICE_hps167_text);
    second_wire_send(d, (const uint8_t *)text, len, d->now_us, d->line, NULL);
}

static uint64_t silence_us(const second_device_t *d)
{
    return second_wire_bits_ns(d->line, 7 * second_wire_character_bits(d->line)) / 2000;
}

const hooks_t second_hps167_hooks = {
    .init = on_init,
    .power_on = on_power_on,
    .alive = on_alive,
    .byte = on_byte,
    .frame = on_frame,
    .job = on_job,
    .timer = on_timer,
    .unasked = unasked,
    .silence_us = silence_us,
};
