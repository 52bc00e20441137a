/* SPDX-License-Identifier: MIT */
#include "wire.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "hex.h"
#include "wire_units.h"

wire_t wire;

/* ---- Bytes on the wire ---- */

/* A byte that has not ended yet. Invariant: sorted by their ends. */
typedef struct {
    wire_us_t start_us, end_us;
    uint8_t value, source, frame; /* index in `frames` */
    bool is_hit;
} air_t;

enum { AIR = 1024, FRAMES = 128, HEARD = 1024 };

static air_t air[AIR];
static size_t air_first, air_end;

/* Frames whose bytes are on the wire. `left`: bytes that have not ended. */
static struct {
    wire_frame_t frame;
    uint8_t left;
} frames[FRAMES];
static uint8_t newest_frame;

/* What waits in the host's port. */
static struct {
    wire_us_t end_us;
    uint8_t value;
    bool is_hit;
} ring[WIRE_RING];
static size_t ring_first, ring_count;

/* What the host has read, to find what chance may have made. */
static struct {
    uint8_t value;
    bool is_hit;
} heard[HEARD];
static uint32_t heard_count;

static wire_us_t last_end_us;

enum { LOG = 32 };

static wire_frame_t log_frames[LOG];
static uint32_t logged;

uint32_t wire_random(uint32_t limit)
{
    wire.random ^= wire.random << 13;
    wire.random ^= wire.random >> 7;
    wire.random ^= wire.random << 17;
    return (uint32_t)((wire.random >> 20) % (limit != 0 ? limit : 1));
}

bool wire_one_in(unsigned n) { return n != 0 && wire_random(n) == 0; }

static void hit(air_t *byte)
{
    if (byte->is_hit) return;
    byte->is_hit = true;
    byte->value = (uint8_t)wire_random(256);
    frames[byte->frame].frame.is_hit = true;
}

static void put_on_air(const air_t *byte)
{
    if (air_first > AIR / 2) {
        memmove(air, air + air_first, (air_end - air_first) * sizeof *air);
        air_end -= air_first;
        air_first = 0;
    }
    assert(air_end != AIR);
    size_t at = air_end++;
    while (at != air_first && air[at - 1].end_us > byte->end_us) {
        air[at] = air[at - 1];
        at--;
    }
    air[at] = *byte;
    for (size_t i = air_first; i != air_end; i++) {
        if (air[i].source == byte->source || air[i].start_us >= byte->end_us ||
            byte->start_us >= air[i].end_us)
            continue;
        hit(&air[i]);
        hit(&air[at]);
    }
}

wire_frame_t *wire_send(uint8_t source, wire_us_t start_us, const uint8_t *bytes, size_t length)
{
    assert(start_us >= wire.now_us && length != 0 && length <= WIRE_FRAME);
    newest_frame = (uint8_t)((newest_frame + 1) % FRAMES);
    wire_frame_t *const frame = &frames[newest_frame].frame;
    assert(frames[newest_frame].left == 0);
    frame->start_us = start_us;
    frame->end_us = start_us + length * wire.byte_us;
    frame->quiet_us = start_us > last_end_us ? start_us - last_end_us : 0;
    frame->source = source;
    frame->length = (uint8_t)length;
    frame->is_hit = frame->is_cut = false;
    memcpy(frame->bytes, bytes, length);
    frames[newest_frame].left = (uint8_t)length;
    for (size_t i = 0; i != length; i++)
        put_on_air(&(air_t){start_us + i * wire.byte_us, start_us + (i + 1) * wire.byte_us, bytes[i], source,
                            newest_frame, false});
    if (last_end_us < frame->end_us) last_end_us = frame->end_us;
    return frame;
}

static void deliver(const air_t *byte)
{
    const size_t size = wire.ring_size != 0 ? wire.ring_size : WIRE_RING;
    if (wire.fails_to_read && wire.loses_bytes_when_broken) return;
    if (ring_count == size) return; /* the ring keeps its oldest bytes */
    const size_t at = (ring_first + ring_count++) % WIRE_RING;
    ring[at].end_us = byte->end_us;
    ring[at].value = byte->value;
    ring[at].is_hit = byte->is_hit || byte->source == WIRE_NOISE || frames[byte->frame].frame.is_cut;
}

static void end_byte(void)
{
    const air_t byte = air[air_first++];
    if (byte.source != WIRE_HOST || wire.echoes) deliver(&byte);
    if (byte.source != WIRE_HOST) wire.received_us = byte.end_us;
    if (--frames[byte.frame].left != 0) return;
    const wire_frame_t frame = frames[byte.frame].frame;
    log_frames[logged++ % LOG] = frame;
    if (frame.source == WIRE_HOST) wire.host_hits += frame.is_hit;
    if (wire.master.timeout_us != 0 && frame.source == WIRE_MASTER)
        wire.master.next_us = frame.end_us + wire.master.timeout_us;
    if (wire.master.timeout_us != 0 && frame.source >= WIRE_FIRST_UNIT)
        wire.master.next_us = frame.end_us + wire.master.period_us;
    for (uint8_t i = 0; i != wire.unit_count; i++) wire_unit_hears(&wire.units[i], &frame);
}

/* ---- Time ---- */

static void next_noise(void)
{
    const uint8_t byte = wire.noise.is_constant ? wire.noise.value : (uint8_t)wire_random(256);
    (void)wire_send(WIRE_NOISE, wire.now_us, &byte, 1);
    wire.noise.next_us += wire.noise.period_us + wire_random((uint32_t)wire.noise.spread_us);
}

static void next_foreign_request(void)
{
    wire_master_t *const master = &wire.master;
    const uint8_t form = (uint8_t)(master->requests++ % master->form_count);
    (void)wire_send(WIRE_MASTER, wire.now_us, master->forms[form], master->lengths[form]);
    master->next_us += master->period_us + wire_random((uint32_t)master->spread_us);
    const wire_us_t end_us = wire.now_us + master->lengths[form] * wire.byte_us;
    if (master->next_us < end_us) master->next_us = end_us;
}

static wire_us_t least(wire_us_t a, wire_us_t b) { return a < b ? a : b; }

/* Does what happens next, if it happens until `until_us`. */
static bool step(wire_us_t until_us)
{
    const wire_us_t byte_us = air_first != air_end ? air[air_first].end_us : WIRE_NEVER;
    wire_us_t next_us = least(least(byte_us, wire.noise.next_us), wire.master.next_us);
    wire_unit_t *unit = NULL;
    for (uint8_t i = 0; i != wire.unit_count; i++) {
        const wire_us_t due_us = least(wire.units[i].next_frame_us, wire.units[i].response_us);
        if (due_us >= next_us) continue;
        next_us = due_us;
        unit = &wire.units[i];
    }
    if (next_us > until_us) return false;
    if (next_us > wire.now_us) wire.now_us = next_us;
    if (unit != NULL)
        wire_unit_acts(unit);
    else if (next_us == byte_us)
        end_byte();
    else if (next_us == wire.noise.next_us)
        next_noise();
    else
        next_foreign_request();
    return true;
}

void wire_run_to(wire_us_t until_us)
{
    while (step(until_us)) {
    }
    if (wire.now_us < until_us) wire.now_us = until_us;
}

void wire_run(wire_us_t for_us) { wire_run_to(wire.now_us + for_us); }

void wire_sleep(wire_us_t at_most_us)
{
    const wire_us_t until_us = wire.now_us + at_most_us;
    while (ring_count == 0 && step(until_us)) {
    }
    if (ring_count == 0 && wire.now_us < until_us) wire.now_us = until_us;
}

/* ---- The host's port ---- */

static void note_call(void)
{
    if (wire.on_call != NULL) wire.on_call();
}

static void remember(uint8_t value, bool is_hit)
{
    heard[heard_count % HEARD].value = value;
    heard[heard_count % HEARD].is_hit = is_hit;
    heard_count++;
}

static uint32_t clock_at(wire_us_t us) { return (uint32_t)((int64_t)us + wire.skew_us); }

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx;
    note_call();
    if (wire.fails_to_read && wire.loses_bytes_when_broken) ring_count = 0;
    if (wire.fails_to_read) return -1;
    size_t length = 0;
    wire_us_t end_us = 0;
    while (length != capacity && ring_count != 0) {
        end_us = ring[ring_first].end_us;
        bytes[length++] = ring[ring_first].value;
        remember(ring[ring_first].value, ring[ring_first].is_hit);
        if (wire.has_time_stamps) {
            rx->last_us = clock_at(end_us);
            rx->flags = FATHOM_RX_TIMED;
        }
        ring_first = (ring_first + 1) % WIRE_RING;
        ring_count--;
        /* "One call never spans a silence that the port knows of". */
        if (wire.has_time_stamps && ring_count != 0 && ring[ring_first].end_us > end_us + 2 * wire.byte_us)
            break;
    }
    return (int)length;
}

static bool changes_something(const uint8_t *bytes)
{
    return (bytes[0] == 0x55 && bytes[1] == 0xAA) ? bytes[3] == 0x03 : bytes[1] == 0x06 || bytes[1] == 0x10;
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx;
    note_call();
    if (wire.fails_to_write) return -1;
    if (wire.takes_no_bytes || wire.now_us < wire.host_end_us) return 0;
    if (changes_something(bytes))
        wire.least_quiet_us = least(wire.least_quiet_us, wire.now_us - wire.received_us);
    wire.host_start_us = wire.now_us;
    wire.host_end_us = wire.now_us + length * wire.byte_us;
    wire.host_frames++;
    memcpy(wire.last_sent.bytes, bytes, length < WIRE_FRAME ? length : WIRE_FRAME);
    wire.last_sent.length = (uint8_t)length;
    wire.last_sent.start_us = wire.host_start_us;
    wire.last_sent.end_us = wire.host_end_us;
    (void)wire_send(WIRE_HOST, wire.now_us, bytes, length);
    return (int)length;
}

static bool port_sent(void *ctx)
{
    (void)ctx;
    note_call();
    return !wire.never_sends && wire.now_us >= wire.host_end_us;
}

static int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    (void)ctx;
    note_call();
    if (settings->baud == 0) return -1;
    return !wire.refuses_settings && wire.now_us >= wire.host_end_us;
}

static int port_set_break(void *ctx, bool on)
{
    (void)ctx;
    note_call();
    if (wire.fails_to_write) return -1;
    if (wire.refuses_break || wire.now_us < wire.host_end_us) return 0;
    if (on && !wire.is_low) wire_edge();
    wire.is_low = on;
    return 1;
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    note_call();
    return clock_at(wire.now_us);
}

void wire_print(void)
{
    static const char *const names[] = {"none", "host", "master", "noise", "unit"};
    printf("seed %llu, now %.3f ms\n", (unsigned long long)wire.seed, (double)wire.now_us / 1e3);
    for (uint32_t i = logged > LOG ? logged - LOG : 0; i != logged; i++) {
        const wire_frame_t *const frame = &log_frames[i % LOG];
        const uint8_t source = frame->source < WIRE_FIRST_UNIT ? frame->source : WIRE_FIRST_UNIT;
        printf("%12.3f to %12.3f ms %-7s%s", (double)frame->start_us / 1e3, (double)frame->end_us / 1e3,
               names[source], frame->is_hit ? " hit" : "    ");
        for (uint8_t b = 0; b != frame->length; b++) printf(" %02X", frame->bytes[b]);
        printf("\n");
    }
}

size_t wire_waiting(void) { return ring_count; }

/* ---- Frames and values ---- */

uint8_t wire_seal(uint8_t *frame, size_t length)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != length; i++) {
        crc ^= frame[i];
        for (int bit = 0; bit != 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    frame[length] = (uint8_t)crc;
    frame[length + 1] = (uint8_t)(crc >> 8);
    return (uint8_t)(length + 2);
}

uint8_t wire_frame_of(const char *hex, uint8_t *frame) { return wire_seal(frame, hex_parse(hex, frame)); }

const wire_issue_t *wire_issue_of(uint16_t mm)
{
    if (mm < WIRE_FIRST_MM || mm >= WIRE_FIRST_MM + WIRE_ISSUES) return NULL;
    const uint32_t which = mm - WIRE_FIRST_MM;
    return which < wire.issued ? &wire.issues[which] : NULL;
}

bool wire_has_chance_of(uint16_t mm)
{
    enum { AROUND = 12 };
    const uint32_t first = heard_count > HEARD - 2 ? heard_count - (HEARD - 2) : 0;
    for (uint32_t i = first; i + 1 < heard_count; i++) {
        if (heard[i % HEARD].value != mm >> 8 || heard[(i + 1) % HEARD].value != (mm & 0xFF)) continue;
        for (uint32_t k = i > first + AROUND ? i - AROUND : first; k < heard_count && k < i + AROUND; k++)
            if (heard[k % HEARD].is_hit) return true;
    }
    return false;
}

/* ---- Begin ---- */

void wire_open(uint32_t byte_us, uint64_t seed)
{
    memset(&wire, 0, sizeof wire);
    memset(frames, 0, sizeof frames);
    air_first = air_end = ring_first = ring_count = 0;
    heard_count = logged = 0;
    last_end_us = 0;
    wire.seed = seed;
    wire.random = UINT64_C(88172645463325252) + seed * UINT64_C(0x9E3779B97F4A7C15);
    for (unsigned i = 0; i != 20; i++) (void)wire_random(2);
    wire.now_us = 1000000;
    wire.byte_us = byte_us;
    wire.least_quiet_us = WIRE_NEVER;
    wire.noise.next_us = wire.master.next_us = WIRE_NEVER;
    wire.uart = (fathom_uart_t){.read = port_read,
                                .write = port_write,
                                .sent = port_sent,
                                .set_line = port_set_line,
                                .set_break = port_set_break};
    wire.clock = (fathom_clock_t){now_us, NULL};
}
