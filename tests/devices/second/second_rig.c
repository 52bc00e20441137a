/* SPDX-License-Identifier: MIT */
#include "second_rig.h"

#include <string.h>

#include "suite.h"

uint32_t rig_clock_us(const rig_t *rig, uint64_t us) { return rig->clock_begins_us + (uint32_t)us; }

static uint32_t clock_now_us(void *ctx)
{
    const rig_t *rig = ctx;
    return rig_clock_us(rig, rig->now_us);
}

static bool is_pair(const rig_t *rig)
{
    second_kind_t kind = rig->device.config.kind;
    return kind == SECOND_A16_RS485 || kind == SECOND_A05_RS485 || kind == SECOND_HPS167S;
}

static uint32_t random_below(rig_t *rig, uint32_t below)
{
    rig->random = rig->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)((rig->random >> 33) % below);
}

static bool is_drawn(rig_t *rig) { return random_below(rig, 1000) < rig->damage_of_1000; }

/* Returns the mask of the bit that is to be wrong in this byte of the device, or 0. */
static uint8_t wrong_bit(rig_t *rig, const second_byte_t *byte)
{
    const second_device_t *d = &rig->device;
    const second_event_t *frame = NULL;
    if (rig->damage == RIG_UNHARMED || rig->damage == RIG_LOSSES) return 0;
    const uint8_t bit = (uint8_t)(1u << random_below(rig, 8));
    if (rig->damage == RIG_SOFT_UART) return is_drawn(rig) ? bit : 0;
    for (uint64_t i = second_log_count(d); i-- > 0 && frame == NULL;) {
        const second_event_t *e = second_log_at(d, i);
        if (e == NULL) break;
        if (e->kind == SECOND_EVENT_MEASUREMENT && e->start_us <= byte->start_us) frame = e;
    }
    if (frame == NULL || byte->end_us > frame->end_us) return 0;
    if (frame->start_us != rig->frame_start_us) {
        rig->frame_start_us = frame->start_us;
        rig->bytes_to_damage = is_drawn(rig) ? (uint8_t)(1 + random_below(rig, frame->raw_len)) : 0;
    }
    if (rig->bytes_to_damage == 0) return 0;
    return --rig->bytes_to_damage == 0 ? bit : 0;
}

static void add(rig_t *rig, uint8_t value, uint8_t flags, uint64_t end_us)
{
    assert_true(rig->count < RIG_BYTES);
    size_t at = (rig->first + rig->count++) % RIG_BYTES;
    rig->received_count++;
    if (flags != 0) rig->marked_count++;
    rig->bytes[at].value = value;
    rig->bytes[at].flags = flags;
    rig->bytes[at].is_foreign = rig->bytes[at].is_wrong = false;
    rig->bytes[at].end_us = end_us;
}

/* A byte of the device. A receiver of a pair is off while its own driver is on. */
static void receive(void *context, const second_byte_t *byte)
{
    rig_t *rig = context;
    if (is_pair(rig) && byte->start_us < rig->sent_us) return;
    if (byte->start_us < rig->zeros_until_us) return;
    if (rig->damage == RIG_LOSSES && is_drawn(rig)) return;
    uint32_t off =
        rig->set.baud > byte->line.baud ? rig->set.baud - byte->line.baud : byte->line.baud - rig->set.baud;
    const uint8_t wrong = wrong_bit(rig, byte);
    uint8_t value = byte->value ^ wrong;
    uint8_t flags = wrong != 0 && rig->sees_parity ? FATHOM_RX_PARITY : 0;
    if (off * 40u > rig->set.baud) {
        value = (uint8_t)(byte->value * 5 + 3);
        flags = FATHOM_RX_FRAMING;
    } else if (byte->line.parity != rig->set.parity) {
        flags = rig->set.parity == 'N' ? FATHOM_RX_FRAMING : FATHOM_RX_PARITY;
    }
    add(rig, value, flags, byte->end_us);
    rig->bytes[(rig->first + rig->count - 1) % RIG_BYTES].is_wrong = wrong != 0;
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    rig_t *rig = ctx;
    int count = 0;
    uint64_t last_us = 0, character_us = 11000000 / rig->set.baud;
    while (rig->count > 0 && (size_t)count < capacity) {
        uint8_t flags = rig->bytes[rig->first].flags;
        uint64_t end_us = rig->bytes[rig->first].end_us;
        if (count > 0 && (flags != 0 || end_us > last_us + 2 * character_us)) break;
        bytes[count++] = rig->bytes[rig->first].value;
        last_us = end_us;
        rig->first = (rig->first + 1) % RIG_BYTES;
        rig->count--;
        rx->flags |= flags;
        if (flags != 0) break;
    }
    if (count > 0 && rig->has_stamps) {
        rx->flags |= FATHOM_RX_TIMED;
        rx->last_us = rig_clock_us(rig, last_us);
    }
    return count;
}

static bool changes(const rig_t *rig, const uint8_t *bytes, size_t length)
{
    if (rig->device.config.kind == SECOND_HPS167)
        return bytes[1] != 0x22 && bytes[1] != 0x24 && bytes[1] != 0x30 && bytes[1] != 0x3F;
    if (length == 1) return false; /* a trigger */
    if (bytes[0] == 0x55 && bytes[1] == 0xAA) return bytes[3] == 0x03;
    return bytes[1] != 0x03 || (length == 8 && bytes[2] == 0 && bytes[3] == 0x09); /* HPS-167S #6 is a read */
}

static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    rig_t *rig = ctx;
    uint64_t bits = 9U + (rig->set.parity != 'N' ? 1U : 0U) + rig->set.stop_bits;
    assert_true(rig->now_us >= rig->sent_us && !rig->in_break && length <= RIG_FRAME);
    for (size_t i = 0; i < length; i++)
        second_host_byte(&rig->device, bytes[i], rig->now_us + i * bits * 1000000 / rig->set.baud,
                         rig->now_us + (i + 1) * bits * 1000000 / rig->set.baud, rig->set);
    rig->sent_us = rig->now_us + length * bits * 1000000 / rig->set.baud;
    memcpy(rig->last, bytes, length);
    rig->last_len = length;
    if (changes(rig, bytes, length)) {
        bool is_dyp = bytes[0] == 0x55 && bytes[1] == 0xAA;
        rig->writes++;
        bool may = bytes[0] == 0 && bytes[1] == 6 && bytes[2] == 0 && (bytes[3] == 0x12 || bytes[3] == 0x13);
        if (!is_dyp && (bytes[0] == 255 || (bytes[0] == 0 && !may))) rig->to_all++;
    }
    return (int)length;
}

static bool uart_sent(void *ctx)
{
    const rig_t *rig = ctx;
    return rig->now_us >= rig->sent_us;
}

static uint32_t uart_leaves_in_us(void *ctx)
{
    const rig_t *rig = ctx;
    return rig->now_us < rig->sent_us ? (uint32_t)(rig->sent_us - rig->now_us) : 0;
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    rig_t *rig = ctx;
    if (rig->now_us < rig->sent_us) return 0;
    rig->set.baud = settings->baud;
    rig->set.parity = "NEO"[settings->parity];
    rig->set.stop_bits = settings->stop_bits;
    return 1;
}

static int uart_set_break(void *ctx, bool on)
{
    rig_t *rig = ctx;
    if (rig->now_us < rig->sent_us) return 0;
    if (on != rig->in_break) second_rx_level(&rig->device, on, rig->now_us);
    rig->in_break = on;
    return 1;
}

static bool pin_get(void *ctx)
{
    const rig_t *rig = ctx;
    return second_output(&rig->device) != (rig->device.config.kind == SECOND_A05_RELAY);
}

void rig_open(rig_t *rig, const second_config_t *config)
{
    static const uint32_t begins_us[] = {0, 4294000000u, 4200000000u, 2147483000u};
    assert_true(second_init(&rig->device, config));
    rig->now_us = rig->sent_us = 0;
    rig->in_break = false;
    rig->first = rig->count = rig->last_len = 0;
    rig->received_count = 0;
    rig->marked_count = 0;
    rig->damage = RIG_UNHARMED;
    rig->damage_of_1000 = 0;
    rig->sees_parity = false;
    rig->random = config->seed;
    rig->frame_start_us = SECOND_NEVER;
    rig->bytes_to_damage = 0;
    rig->zero_us = rig->zeros_until_us = 0;
    rig->writes = rig->to_all = 0;
    rig->loop = config->seed % 3 == 2 ? RIG_EVERY_20_MS : config->seed % 24 == 1 ? RIG_EVERY_1_MS : RIG_WOKEN;
    /* A loop in step with what a device sends unasked may never see a silence to ask in (line.h). */
    bool is_slow = rig->loop == RIG_EVERY_20_MS;
    bool is_fast =
        (config->kind == SECOND_HPS167S && second_choice(&rig->device, CHOICE_hps_unasked_us) < 60000) ||
        (config->kind == SECOND_HPS167 && second_choice(&rig->device, CHOICE_hps_measure_us) < 60000);
    if (is_slow && (config->kind == SECOND_A16_RS232 || config->kind == SECOND_A05_UART))
        rig->loop = RIG_EVERY_7_MS;
    if (is_slow && is_fast) rig->loop = RIG_EVERY_1_MS;
    rig->has_stamps = rig->loop == RIG_WOKEN;
    rig->clock_begins_us = begins_us[config->seed / 3 % 4];
    rig->set = (second_line_t){9600, 'N', 1};
    if (config->kind == SECOND_HPS167S) rig->set = (second_line_t){19200, 'E', 1};
    if (config->kind == SECOND_HPS167) rig->set = (second_line_t){115200, 'N', 1};
    rig->clock = (fathom_clock_t){clock_now_us, rig};
    rig->uart = (fathom_uart_t){.read = uart_read,
                                .write = uart_write,
                                .sent = uart_sent,
                                .set_line = uart_set_line,
                                .set_break = uart_set_break,
                                .leaves_in_us = uart_leaves_in_us,
                                .ctx = rig};
    rig->pin = (fathom_pin_t){NULL, pin_get, rig};
    fathom_edges_init(&rig->edges, &rig->pin);
    rig->line_parts = (fathom_line_parts_t){.uart = &rig->uart,
                                            .clock = &rig->clock,
                                            .frame = rig->frame,
                                            .frame_size = sizeof rig->frame,
                                            .find_echo = fathom_line_find_echo,
                                            .marks = fathom_line_marks,
                                            .senders = &fathom_line_senders,
                                            .masters = &fathom_line_masters,
                                            .echo = config->seed / 12 % 2 == 0 ? FATHOM_LINE_ECHO_OFF : 0,
                                            .gap_us = rig->loop == RIG_EVERY_20_MS ? 25000 : 0};
    assert_int_equal(fathom_line_init(&rig->line, &rig->line_parts), FATHOM_OK);
    rig->modbus = fathom_modbus_client_with_zero(&rig->line);
}

/* Returns the time of a character of 11 bits. */
static uint64_t character_us(const rig_t *rig) { return 11000000 / rig->set.baud; }

static bool is_sending_zeros(const rig_t *rig) { return rig->zero_us < rig->zeros_until_us; }

static void run_to(rig_t *rig, uint64_t until_us)
{
    bool has_level = rig->device.config.kind >= SECOND_TALKERS;
    for (uint64_t next_us = 0; has_level && (next_us = second_next_us(&rig->device)) <= until_us;) {
        bool was_high = second_output(&rig->device);
        second_run(&rig->device, next_us, receive, rig);
        bool is_high = second_output(&rig->device);
        if (is_high != was_high) fathom_edges_feed(&rig->edges, is_high, rig_clock_us(rig, next_us));
    }
    second_run(&rig->device, until_us, receive, rig);
    for (; rig->zero_us <= until_us && is_sending_zeros(rig); rig->zero_us += character_us(rig)) {
        add(rig, 0x00, 0, rig->zero_us);
        rig->bytes[(rig->first + rig->count - 1) % RIG_BYTES].is_foreign = true;
    }
    rig->now_us = until_us;
}

void rig_pass(rig_t *rig, uint32_t due_us)
{
    if (rig->loop != RIG_WOKEN) {
        static const uint32_t every_us[RIG_LOOPS] = {
            [RIG_EVERY_1_MS] = 1000, [RIG_EVERY_7_MS] = 7000, [RIG_EVERY_20_MS] = 20000};
        run_to(rig, rig->now_us + every_us[rig->loop]);
        return;
    }
    uint64_t until_us = rig->now_us + (due_us == 0 ? 1 : due_us < 1000000 ? due_us : 1000000);
    size_t before = rig->count;
    while (rig->now_us < until_us && rig->count == before) {
        uint64_t next_us = second_next_us(&rig->device);
        if (is_sending_zeros(rig) && rig->zero_us < next_us) next_us = rig->zero_us;
        if (next_us > until_us) next_us = until_us;
        if (next_us < rig->now_us) next_us = rig->now_us;
        run_to(rig, next_us);
    }
}

void rig_power(rig_t *rig, bool on)
{
    second_power(&rig->device, on, rig->now_us);
    run_to(rig, rig->now_us + 1);
}

void rig_restart(rig_t *rig, uint64_t off_us, uint64_t on_us)
{
    rig_power(rig, false);
    rig_wait(rig, off_us);
    rig_power(rig, true);
    rig_wait(rig, on_us);
}

void rig_scene(rig_t *rig, int32_t mm1, int32_t mm2, int32_t mm3, int32_t mm4)
{
    second_scene(&rig->device, &(second_scene_t){{mm1, mm2, mm3, mm4}}, rig->now_us);
}

void rig_damage(rig_t *rig, rig_damage_t damage, uint32_t of_1000)
{
    rig->damage = damage;
    rig->damage_of_1000 = of_1000;
}

void rig_zeros(rig_t *rig, uint64_t us)
{
    rig->zero_us = rig->now_us + character_us(rig);
    rig->zeros_until_us = rig->now_us + us;
}

void rig_wait(rig_t *rig, uint64_t us)
{
    for (uint64_t end_us = rig->now_us + us; rig->now_us < end_us;) {
        fathom_line_poll(&rig->line);
        uint64_t left_us = end_us - rig->now_us;
        uint32_t due_us = fathom_line_due_us(&rig->line);
        rig_pass(rig, due_us < left_us ? due_us : (uint32_t)left_us);
    }
}
