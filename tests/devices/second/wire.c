/* SPDX-License-Identifier: MIT */
/* Bytes on the wire: check codes, sending, receiving, and where a frame ends. */
#include "second_device.h"

#include <string.h>

uint16_t second_wire_crc16(const uint8_t *bytes, size_t len)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < len; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            bool out = (crc & 1) != 0;
            crc >>= 1;
            if (out) crc ^= 0xA001;
        }
    }
    return crc;
}

uint8_t second_wire_sum8(const uint8_t *bytes, size_t len)
{
    unsigned sum = 0;
    for (size_t i = 0; i < len; i++) sum += bytes[i];
    return (uint8_t)(sum & 0xFF);
}

uint32_t second_wire_character_bits(second_line_t line)
{
    return 1U + 8U + (line.parity != 'N' ? 1U : 0U) + line.stop_bits;
}

uint64_t second_wire_bits_ns(second_line_t line, uint32_t bits)
{
    return bits * UINT64_C(1000000000) / line.baud;
}

/* A receiver follows a rate that is 2 % off, and a longer stop bit does not harm it. */
bool second_wire_same(second_line_t a, second_line_t b)
{
    uint32_t off = a.baud > b.baud ? a.baud - b.baud : b.baud - a.baud;
    return (uint64_t)off * 50 <= b.baud && a.parity == b.parity;
}

static uint64_t gap_ns(const second_device_t *d, second_line_t line)
{
    uint64_t ns = second_wire_bits_ns(line, second_wire_character_bits(line)) *
                  (uint64_t)chosen(d, CHOICE_any_byte_gap_tenths) / 10;
    return ns > 1000 ? ns - 1000 : 0; /* times are cut to microseconds: stay within 1.5 characters */
}

uint64_t second_wire_length_us(const second_device_t *d, size_t len, second_line_t line)
{
    uint64_t character_ns = second_wire_bits_ns(line, second_wire_character_bits(line));
    return (len * character_ns + (len - 1) * gap_ns(d, line)) / 1000;
}

void second_wire_send(second_device_t *d, const uint8_t *bytes, size_t len, uint64_t at_us,
                      second_line_t line, second_event_t *event)
{
    uint64_t start_us = at_us > d->out_free_us ? at_us : d->out_free_us;
    uint64_t character_ns = second_wire_bits_ns(line, second_wire_character_bits(line));
    uint64_t ns = start_us * 1000;
    if (d->out_free_us < start_us || d->out_count == 0) d->out_begin_us = start_us;
    for (size_t i = 0; i < len; i++) {
        if (d->out_count == SECOND_OUTPUTS) {
            d->lost++;
            break;
        }
        second_byte_t *out = &d->out[(d->out_first + d->out_count++) % SECOND_OUTPUTS];
        *out = (second_byte_t){bytes[i], ns / 1000, (ns + character_ns) / 1000, line};
        d->out_free_us = out->end_us;
        ns += character_ns + gap_ns(d, line);
    }
    if (event == NULL) return;
    event->start_us = start_us;
    event->end_us = d->out_free_us;
    memcpy(event->raw, bytes, len);
    event->raw_len = (uint8_t)len;
}

void second_wire_drop_rx(second_device_t *d)
{
    d->rx_len = 0;
    d->rx_bad = false;
    d->timer_us[TIMER_FRAME_END] = SECOND_NEVER;
}

static void append(second_device_t *d, uint8_t value, uint64_t start_us, uint64_t end_us)
{
    if (d->rx_len == 0) d->rx_begin_us = start_us;
    if (d->rx_len < SECOND_FRAME_MAX)
        d->rx[d->rx_len++] = value;
    else
        d->rx_bad = true;
    d->rx_end_us = end_us;
    d->timer_us[TIMER_FRAME_END] = end_us + d->hooks->silence_us(d);
}

static void noise(second_device_t *d, uint8_t value, const input_t *input, bool taken)
{
    second_event_t *event = second_truth_log(d, SECOND_EVENT_NOISE);
    event->raw[0] = value;
    event->raw_len = 1;
    event->new_value = taken;
    if (taken)
        append(d, value, input->start_us, input->time_us);
    else if (d->rx_len > 0)
        d->timer_us[TIMER_FRAME_END] = input->time_us + d->hooks->silence_us(d);
}

/* Silences that the HPS-167S text asks for: 1.5 characters inside, 3.5 characters before a frame. */
static bool breaks_silence_rules(const second_device_t *d, const input_t *input)
{
    if (d->config.kind != SECOND_HPS167S) return false;
    if (d->rx_len > 0) {
        uint64_t longest_us =
            second_wire_bits_ns(d->line, 3 * second_wire_character_bits(d->line)) / 2000 + 1;
        if (d->line.baud > 19200) longest_us = 750;
        return chosen(d, CHOICE_hps_gap_inside) == 0 && input->start_us > d->rx_end_us + longest_us;
    }
    return chosen(d, CHOICE_hps_gap_before) != 0 && d->out_free_us > 0 &&
           input->start_us < d->out_free_us + d->hooks->silence_us(d);
}

static bool on_a_pair(const second_device_t *d)
{
    return d->config.kind == SECOND_A16_RS485 || d->config.kind == SECOND_A05_RS485 ||
           d->config.kind == SECOND_HPS167S;
}

static void receive(second_device_t *d, const input_t *input)
{
    if (!d->powered) return;
    if (!d->alive) {
        noise(d, input->value, input, false);
        return;
    }
    bool sending = input->start_us < d->out_free_us && input->time_us > d->out_begin_us;
    if (on_a_pair(d) && sending) {
        noise(d, (uint8_t)second_truth_random(d, 256), input, chosen(d, CHOICE_any_heard_while_sending) != 0);
        return;
    }
    if (d->hooks->hears != NULL ? !d->hooks->hears(d, input->line)
                                : !second_wire_same(input->line, d->line)) {
        noise(d, (uint8_t)second_truth_random(d, 256), input, chosen(d, CHOICE_any_wrong_line) != 0);
        return;
    }
    if (breaks_silence_rules(d, input)) d->rx_bad = true;
    d->rx_line = input->line;
    append(d, input->value, input->start_us, input->time_us);
    if (d->hooks->byte != NULL) d->hooks->byte(d);
}

static void level(second_device_t *d, const input_t *input)
{
    bool was_low = d->level_low;
    uint64_t since_us = d->level_since_us;
    d->level_low = input->on;
    if (was_low == input->on) return;
    d->level_since_us = input->time_us;
    if (!d->powered) return;
    if (d->hooks->level != NULL) d->hooks->level(d, input->on);
    bool hears_bytes = d->config.kind != SECOND_A16_AUTO && d->config.kind != SECOND_A16_CONTROLLED &&
                       d->config.kind < SECOND_TALKERS;
    uint64_t character_us = second_wire_bits_ns(d->line, second_wire_character_bits(d->line)) / 1000;
    if (!hears_bytes || input->on || !d->alive || input->time_us < since_us + character_us) return;
    input_t as_byte = *input;
    as_byte.start_us = since_us;
    noise(d, 0x00, &as_byte, chosen(d, CHOICE_any_break_as) != 0);
}

void second_wire_input(second_device_t *d, const input_t *input)
{
    switch (input->kind) {
    case INPUT_START:
        d->timer_us[TIMER_FRAME_END] = SECOND_NEVER;
        break;
    case INPUT_BYTE:
        if (d->config.kind == SECOND_A16_AUTO || d->config.kind == SECOND_A16_CONTROLLED) {
            if (d->powered) d->hooks->pulse(d, input);
        } else if (d->config.kind < SECOND_TALKERS) {
            receive(d, input);
        }
        break;
    case INPUT_LEVEL:
        level(d, input);
        break;
    case INPUT_POWER:
    case INPUT_SCENE:
    case INPUT_FAULT:
        break;
    }
}
