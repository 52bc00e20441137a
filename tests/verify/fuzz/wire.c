/* SPDX-License-Identifier: MIT */
#include "wire.h"

/* MOST_BEFORE: of a mark, which may say that the last byte came so long ago. */
enum {
    BYTE_US = 1042,
    MARK_US = 500,
    MOST_BEFORE_US = 15 * MARK_US,
    READ = 3,
    EXCEPTION = 0x80,
    BAD = FATHOM_RX_PARITY | FATHOM_RX_FRAMING
};

wire_t wire;
const fathom_line_settings_t wire_settings[2] = {{9600, FATHOM_PARITY_NONE, 1},
                                                 {19200, FATHOM_PARITY_EVEN, 1}};

/* ---- the port ---- */

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return wire.now_us;
}
const fathom_clock_t wire_clock = {now_us, NULL};

static void note(uint8_t byte, bool is_broken)
{
    if (wire.count == WIRE_HEARD - 1) return;
    wire.heard[wire.count] = byte;
    wire.is_broken[wire.count] = wire.is_broken[wire.count] || is_broken;
    wire.is_broken[++wire.count] = false;
}

static int read_bytes(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx;
    PROMISE(rx->flags == 0 && rx->last_us == 0, "hal.h: rx comes zeroed");
    wire.reads++;
    if (wire.read_fails != 0) {
        wire.read_fails--;
        wire.is_broken[wire.count] = true;
        return -1;
    }
    const size_t n = wire.queued < capacity ? wire.queued : capacity;
    if (n == 0) return 0;
    memcpy(bytes, wire.queue, n);
    wire.queued -= (unsigned)n;
    memmove(wire.queue, wire.queue + n, wire.queued);
    rx->flags = wire.flags;
    rx->last_us = wire.last_us;
    const uint8_t flags = wire.has_marks ? wire.flags : 0;
    wire.flags = 0;
    if ((flags & (BAD | FATHOM_RX_OVERRUN)) != 0) wire.is_broken[wire.count] = true;
    if ((flags & BAD) == 0)
        for (size_t i = 0; i != n; i++) note(bytes[i], false);
    return (int)n;
}

static int write_bytes(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx;
    PROMISE(length >= 1 && length <= 255, "hal.h: write: 1..255 bytes");
    PROMISE(!wire.is_low, "line.h: while TX is low nothing is sent");
    if (wire.write_fails != 0) {
        wire.write_fails--;
        return wire.write_result;
    }
    memcpy(wire.request, bytes, length);
    wire.length = (uint8_t)length;
    wire.wrote_us = wire.now_us;
    wire.leaves_us = (uint32_t)length * BYTE_US;
    wire.writes++;
    return (int)length;
}

static bool has_sent(void *ctx)
{
    (void)ctx;
    if (wire.sent_late != 0) {
        wire.sent_late--;
        return false;
    }
    return fathom_elapsed_us(wire.now_us, wire.wrote_us) >= wire.leaves_us;
}

static uint32_t leaves_in_us(void *ctx)
{
    (void)ctx;
    const uint32_t passed_us = fathom_elapsed_us(wire.now_us, wire.wrote_us);
    return passed_us < wire.leaves_us ? wire.leaves_us - passed_us : 0;
}

static int set_line(void *ctx, const fathom_line_settings_t *settings)
{
    (void)ctx;
    PROMISE(settings->baud != 0 && settings->parity <= FATHOM_PARITY_ODD && settings->stop_bits >= 1 &&
                settings->stop_bits <= 2,
            "hal.h: the settings of a line");
    if (wire.set_line_fails == 0) return 1;
    wire.set_line_fails--;
    return wire.line_result;
}

static int set_break(void *ctx, bool on)
{
    (void)ctx;
    if (wire.set_break_fails != 0) {
        wire.set_break_fails--;
        return wire.break_result;
    }
    wire.is_low = on;
    return 1;
}

const fathom_uart_t wire_uart = {.read = read_bytes,
                                 .write = write_bytes,
                                 .sent = has_sent,
                                 .set_line = set_line,
                                 .set_break = set_break,
                                 .leaves_in_us = leaves_in_us};

void wire_begin(uint32_t now, bool has_marks)
{
    /* all but the buffers, which need no beginning */
    wire.now_us = now;
    wire.passed_us = 0;
    wire.queued = wire.count = 0;
    wire.is_broken[0] = false;
    wire.flags = wire.length = 0;
    wire.has_marks = has_marks;
    wire.wrote_us = now;
    wire.leaves_us = 0;
    wire.is_draining = wire.is_low = false;
    wire.read_fails = wire.write_fails = wire.set_line_fails = wire.set_break_fails = wire.sent_late = 0;
}

void wire_drain(void)
{
    wire.is_draining = true;
    wire.queued = 0;
    wire.flags = 0;
    wire.read_fails = wire.write_fails = wire.set_line_fails = wire.set_break_fails = wire.sent_late = 0;
}

void wire_poll_begins(void) { wire.reads = wire.writes = 0; }

void wire_poll_has_ended(void)
{
    PROMISE(wire.reads <= 16, "line.h: at most 16 reads of the port");
    PROMISE(wire.writes <= 1, "a poll begins one transaction at most");
}

void wire_pass(uint32_t us)
{
    wire.now_us += us;
    wire.passed_us += us;
}

bool wire_is_future(uint32_t time_us)
{
    return fathom_elapsed_us(wire.now_us, time_us) > wire.passed_us + MOST_BEFORE_US;
}

/* ---- the far end ---- */

static void come(const uint8_t *bytes, unsigned count)
{
    if (wire.is_draining || wire.queued + count > WIRE_QUEUE) return;
    memcpy(wire.queue + wire.queued, bytes, count);
    wire.queued += count;
}

/* CRC-16/CCITT-FALSE, bit by bit. */
static uint16_t crc_of_hps167(const uint8_t *bytes, unsigned count)
{
    uint32_t crc = 0xFFFF;
    for (unsigned i = 0; i != count * 8u; i++) {
        const uint32_t in = bytes[i / 8] >> (7 - i % 8) & 1u;
        crc = (crc << 1 ^ ((crc >> 15 ^ in) % 2 != 0 ? 0x1021u : 0u)) % 65536u;
    }
    return (uint16_t)crc;
}

/* The response to a request of an HPS-167; returns its length. */
static unsigned respond_as_hps167(uint8_t *frame)
{
    const unsigned count = frame[1] == 0x30 ? 1 : frame[1] == 0x3F ? 2 : 11;
    for (unsigned i = 0; i != count; i++)
        frame[2 + i] = count == 1 || i == 3 ? fuzz_byte() & 63 : fuzz_byte();
    const uint16_t crc = crc_of_hps167(frame + 2, count);
    frame[1] = (uint8_t)(count + 2);
    frame[2 + count] = (uint8_t)(crc >> 8);
    frame[3 + count] = (uint8_t)crc;
    return count + 4;
}

/* What the last request asks for, with the input's values; how: bits. */
static void respond(uint8_t how)
{
    const uint8_t *const asked = wire.request;
    uint8_t frame[WIRE_FRAME + 8];
    unsigned length = 8;
    if (wire.length < 5) return;
    memcpy(frame, asked, 8);
    if (asked[0] == 0x55) {
        length = asked[3] == 1 ? 13 : asked[3] == 3 ? 5 : 7;
        for (unsigned i = 4; i + 1 < length; i++) frame[i] = i % 2 == 0 ? fuzz_byte() & 15 : fuzz_byte();
        if (asked[2] == 255) frame[2] = 3;
        frame[length - 1] = fuzz_sum(frame, length - 1);
    } else if (asked[0] == 0x0A && wire.length == 10 && asked[1] >= 0x22) {
        length = respond_as_hps167(frame);
    } else {
        if (asked[0] == 255) frame[0] = 2;
        if ((how & 2) != 0) {
            frame[1] |= EXCEPTION;
            frame[2] = fuzz_byte();
            length = 5;
        } else if (asked[1] == READ) {
            frame[2] = (uint8_t)(2 * asked[5]);
            length = 5u + frame[2];
            for (unsigned i = 3; i + 2 < length; i++) frame[i] = fuzz_byte();
        }
        fuzz_seal(frame, length - 2);
    }
    if ((how & 4) != 0) frame[fuzz_byte() % length] ^= (uint8_t)(1u << (fuzz_byte() & 7));
    if ((how & 8) != 0) length = 1 + fuzz_byte() % length;
    if ((how & 1) != 0) come(asked, wire.length);
    come(frame, length);
}

/* FF H L SUM, of one or of four; or an HPS-167S's unasked frame. */
static void send_by_itself(uint8_t how)
{
    uint8_t frame[13] = {0xFF};
    const unsigned length = how % 3 == 0 ? 4 : how % 3 == 1 ? 10 : 13;
    for (unsigned i = 1; i + 1 < length; i++) frame[i] = i % 2 != 0 ? fuzz_byte() & 31 : fuzz_byte();
    frame[length - 1] = fuzz_sum(frame, length - 1);
    if (length == 13) {
        frame[0] = 1;
        frame[1] = READ;
        frame[2] = 8;
        fuzz_seal(frame, 11);
    }
    come(frame, length);
}

static void fail(uint8_t how)
{
    static const int8_t writes[] = {0, -1, 0, 1};
    if ((how & 1) != 0) wire.read_fails = 1;
    if ((how & 2) != 0) wire.write_fails = 1 + (how >> 6);
    wire.write_result = writes[how >> 6];
    if ((how & 4) != 0) wire.set_line_fails = 1;
    wire.line_result = (how & 32) != 0 ? 0 : -1;
    if ((how & 8) != 0) wire.sent_late = fuzz_byte();
    if ((how & 16) != 0) wire.set_break_fails = 1 + (how >> 6);
    wire.break_result = (how & 32) != 0 ? 0 : -1;
}

void wire_op(uint8_t op)
{
    const uint8_t high = op >> 4;
    uint8_t bytes[16];
    switch (op % 16) {
    case 0:
        for (unsigned i = 0; i <= high; i++) bytes[i] = fuzz_byte();
        come(bytes, high + 1u);
        break;
    case 1:
    case 2:
    case 3:
        respond(op % 16 == 1 ? 0 : high);
        break;
    case 4:
        send_by_itself(high);
        break;
    case 5:
        come(wire.request, wire.length);
        break;
    case 6:
        wire_pass(high * 250u);
        break;
    case 7:
        wire_pass(fuzz_byte() * 256u);
        break;
    case 8:
        wire_pass(fuzz_byte() * 20000u);
        break;
    case 9:
        wire_pass((uint32_t)fuzz_byte() << (high + 8));
        break;
    case 10:
        fail(fuzz_byte());
        break;
    default: /* 11 */
        wire.flags = fuzz_byte() & 31;
        wire.last_us = wire.now_us - (uint32_t)high * MARK_US;
        break;
    }
}

/* ---- what was heard ---- */

/* The frame that begins at `at`, of `length` bytes without a break, NULL: none. */
static const uint8_t *frame_at(unsigned at, unsigned length)
{
    if (at + length > wire.count) return NULL;
    for (unsigned i = at + 1; i < at + length; i++)
        if (wire.is_broken[i]) return NULL;
    return wire.heard + at;
}

static const uint8_t *modbus_at(unsigned at, unsigned length, uint8_t unit)
{
    const uint8_t *const frame = frame_at(at, length);
    if (frame == NULL || (unit != 255 && frame[0] != unit) || fuzz_crc(frame, length) != 0) return NULL;
    return frame;
}

bool wire_heard_read(unsigned from, uint8_t unit, uint8_t count, const uint16_t *values)
{
    for (unsigned at = from; at < wire.count; at++) {
        if (at + 2 >= wire.count || wire.heard[at + 1] != READ || wire.heard[at + 2] != 2 * count) continue;
        const uint8_t *const frame = modbus_at(at, 5u + 2u * count, unit);
        uint8_t alike = 0;
        if (frame == NULL) continue;
        while (alike != count && (values == NULL || values[alike] == fuzz_word_at(frame + 3 + 2 * alike)))
            alike++;
        if (alike == count) return true;
    }
    return false;
}

bool wire_heard_head(unsigned from, const uint8_t head[6])
{
    for (unsigned at = from; at < wire.count; at++) {
        const uint8_t *const frame = modbus_at(at, 8, head[0]);
        if (frame != NULL && memcmp(frame + 1, head + 1, 5) == 0) return true;
    }
    return false;
}

bool wire_heard_exception(unsigned from, uint8_t unit, uint8_t function, uint8_t code)
{
    for (unsigned at = from; at < wire.count; at++) {
        const uint8_t *const frame = modbus_at(at, 5, unit);
        if (frame != NULL && frame[1] == (function | EXCEPTION) && frame[2] == code) return true;
    }
    return false;
}

bool wire_heard_register(unsigned from, uint8_t unit, uint16_t value)
{
    for (unsigned at = from; at + 2 < wire.count; at++) {
        const uint8_t size = wire.heard[at + 2];
        if (wire.heard[at + 1] != READ || size == 0 || size % 2 != 0 || size > 250) continue;
        const uint8_t *const frame = modbus_at(at, 5u + size, unit);
        for (unsigned i = 0; frame != NULL && i != size; i += 2)
            if (fuzz_word_at(frame + 3 + i) == value) return true;
    }
    return false;
}

bool wire_heard_sum(unsigned from, uint8_t start, uint8_t length, uint16_t value)
{
    for (unsigned at = from; at < wire.count; at++) {
        const uint8_t *const frame = wire.heard[at] == start ? frame_at(at, length) : NULL;
        if (frame == NULL || frame[length - 1] != fuzz_sum(frame, length - 1u)) continue;
        for (unsigned i = start == 0xFF ? 1 : 4; i + 2u < length; i += 2)
            if (fuzz_word_at(frame + i) == value) return true;
    }
    return false;
}

bool wire_heard_hps167(uint16_t value)
{
    for (unsigned at = 0; at < wire.count; at++) {
        const uint8_t *const frame = wire.heard[at] == 0x0A ? frame_at(at, 15) : NULL;
        if (frame == NULL || frame[1] != 0x0D || fuzz_word_at(frame + 5) != value) continue;
        if (fuzz_word_at(frame + 13) == crc_of_hps167(frame + 2, 11)) return true;
    }
    return false;
}
