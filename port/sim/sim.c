/* SPDX-License-Identifier: MIT */
/* The simulated line. It moves bytes between the host and all devices, each at its time, with collisions. */
#include "sim.h"

#include <string.h>

enum { BYTE_ERRORS = FATHOM_RX_PARITY | FATHOM_RX_FRAMING };

void fathom_sim_line_init(fathom_sim_line_t *line, const fathom_line_settings_t *settings, uint32_t now_us)
{
    memset(line, 0, sizeof *line);
    line->settings = *settings;
    line->now_us = now_us;
    line->quiet = true;
}

/* ---- what reaches the host ---- */

/* What a UART makes of a byte at another rate is not specified; here it is the same every time. */
static uint8_t garbled(uint8_t byte) { return (uint8_t) ~(byte << 1); }

/* mark: what the UART reports of the byte besides (FATHOM_RX_...). */
static void arrive(fathom_sim_line_t *line, const fathom_sim_sender_t *sender, uint8_t byte, uint8_t mark)
{
    uint8_t flags = (uint8_t)((sender->after_silence ? FATHOM_RX_SILENCE : 0) | (mark & BYTE_ERRORS));
    line->arrived_us = line->now_us;
    line->quiet = false;
    if (line->waiting == FATHOM_SIM_QUEUE || (mark & FATHOM_RX_OVERRUN) != 0) {
        line->counters.overruns++;
        line->lost = true;
        return;
    }
    if (sender->corrupted || !fathom_sim_same_settings(&line->settings, &sender->settings)) {
        flags |= FATHOM_RX_FRAMING;
        byte = garbled(byte);
    }
    if (line->lost) flags |= FATHOM_RX_OVERRUN;
    line->lost = false;
    fathom_sim_arrival_t *const arrival =
        &line->arrivals[(uint16_t)(line->first + line->waiting) % FATHOM_SIM_QUEUE];
    arrival->end_us = line->now_us;
    arrival->byte = byte;
    arrival->flags = flags;
    line->waiting++;
    line->counters.to_host++;
}

/* Latched here, so that it is right however long ago the last byte came. */
static void notice_quiet(fathom_sim_line_t *line)
{
    if (fathom_elapsed_us(line->now_us, line->arrived_us) >= fathom_sim_silence_us(&line->settings))
        line->quiet = true;
}

/* ---- bytes on the wire; `device` is the sender, NULL the host ---- */

static void collide(fathom_sim_line_t *line, fathom_sim_sender_t *sender, fathom_sim_sender_t *other)
{
    if (sender == other || !other->on_wire) return;
    sender->corrupted = true;
    other->corrupted = true;
    line->counters.collisions++;
}

static bool hears(const fathom_sim_line_t *line, const fathom_sim_device_t *listener,
                  const fathom_sim_device_t *device)
{
    return listener != device && (device == NULL || !line->full_duplex);
}

/* What the host does with its TX pin, as edges. */
static void hold_rx(const fathom_sim_line_t *line, uint8_t by, bool low)
{
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next)
        fathom_sim_device_hold_rx(at, by, low, line->now_us);
}

static void byte_begins(fathom_sim_line_t *line, fathom_sim_sender_t *sender,
                        const fathom_sim_device_t *device)
{
    sender->corrupted = false;
    notice_quiet(line);
    sender->after_silence = line->quiet;
    if (!line->full_duplex) {
        collide(line, sender, &line->host);
        for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next)
            collide(line, sender, &at->sender);
    }
    sender->on_wire = true;
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next)
        if (hears(line, at, device)) fathom_sim_device_receive_start(at, line->now_us);
    if (device == NULL) hold_rx(line, FATHOM_SIM_HELD_BY_BYTE, true);
}

static void byte_ends(fathom_sim_line_t *line, fathom_sim_sender_t *sender, fathom_sim_device_t *device)
{
    const uint8_t byte = sender->bytes[sender->sent];
    const uint8_t mark = sender->marked ? sender->marks[sender->sent] : 0;
    sender->sent++;
    sender->on_wire = false;
    if (device == NULL) line->counters.from_host++;
    if (device != NULL || line->echo) arrive(line, sender, byte, mark);
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next)
        if (hears(line, at, device))
            fathom_sim_device_receive_end(at, &sender->settings, byte,
                                          !sender->corrupted && (mark & BYTE_ERRORS) == 0, line->full_duplex,
                                          line->now_us);
    if (device == NULL) hold_rx(line, FATHOM_SIM_HELD_BY_BYTE, false);
    if (device != NULL) fathom_sim_device_sent(device, line->now_us);
}

/* ---- time ---- */

static uint32_t sender_due_us(const fathom_sim_sender_t *sender, uint32_t now_us)
{
    if (fathom_sim_sender_idle(sender)) return FATHOM_NO_DEADLINE;
    return fathom_sim_until_us(fathom_sim_sender_next_us(sender), now_us);
}

static uint32_t soonest(uint32_t a_us, uint32_t b_us) { return a_us < b_us ? a_us : b_us; }

static uint32_t due_us(const fathom_sim_line_t *line)
{
    uint32_t due = sender_due_us(&line->host, line->now_us);
    for (const fathom_sim_device_t *at = line->devices; at != NULL; at = at->next) {
        due = soonest(due, sender_due_us(&at->sender, line->now_us));
        due = soonest(due, fathom_sim_device_due_us(at, line->now_us));
    }
    return due;
}

/* The first thing that is due at this moment. Bytes end before anything else and begin after it, so that a
 * silence of exactly t3.5 ends a frame and back-to-back bytes do not collide. */
static void act(fathom_sim_line_t *line)
{
    fathom_sim_sender_t *begins = NULL;
    fathom_sim_device_t *talker = NULL;
    if (sender_due_us(&line->host, line->now_us) == 0) {
        if (line->host.on_wire) {
            byte_ends(line, &line->host, NULL);
            return;
        }
        begins = &line->host;
    }
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next) {
        if (sender_due_us(&at->sender, line->now_us) != 0) continue;
        if (at->sender.on_wire) {
            byte_ends(line, &at->sender, at);
            return;
        }
        if (begins == NULL) {
            begins = &at->sender;
            talker = at;
        }
    }
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next) {
        if (fathom_sim_device_due_us(at, line->now_us) != 0) continue;
        fathom_sim_device_act(at, line->now_us);
        return;
    }
    if (begins != NULL) byte_begins(line, begins, talker);
}

void fathom_sim_run(fathom_sim_line_t *line, uint32_t now_us)
{
    const uint32_t ahead_us = fathom_sim_until_us(now_us, line->now_us);
    uint32_t left_us = ahead_us;
    for (;;) {
        const uint32_t due = due_us(line);
        if (due > left_us) break;
        line->now_us += due;
        left_us -= due;
        act(line);
    }
    line->now_us += left_us;
    notice_quiet(line);
}

uint32_t fathom_sim_due_us(fathom_sim_line_t *line, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    return due_us(line);
}

/* ---- the host's end ---- */

void fathom_sim_attach(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_device_t **end = &line->devices;
    fathom_sim_run(line, now_us);
    while (*end != NULL) end = &(*end)->next;
    *end = device;
    device->next = NULL;
    device->others_on_wire = 0;
    /* a sender that is active now is in the middle of a byte, whose end will be counted too */
    fathom_sim_device_power_on(device, line->now_us);
    fathom_sim_device_hold_rx(device, FATHOM_SIM_HELD_BY_BYTE, line->host.on_wire, line->now_us);
    fathom_sim_device_hold_rx(device, FATHOM_SIM_HELD_BY_BREAK, line->in_break, line->now_us);
    if (line->host.on_wire || line->in_break) device->others_on_wire++;
    for (const fathom_sim_device_t *at = line->devices; at != device; at = at->next)
        if (at->sender.on_wire && !line->full_duplex) device->others_on_wire++;
}

/* Nothing is heard of the byte that it is sending. */
static void cut_off(fathom_sim_line_t *line, const fathom_sim_device_t *device)
{
    if (!device->sender.on_wire || line->full_duplex) return;
    for (fathom_sim_device_t *other = line->devices; other != NULL; other = other->next)
        if (other != device) other->others_on_wire--;
}

void fathom_sim_power_cycle(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t off_us,
                            uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    cut_off(line, device);
    fathom_sim_device_power_off(device, off_us, line->now_us);
    fathom_sim_run(line, now_us); /* power that is back at once is there now */
}

void fathom_sim_detach(fathom_sim_line_t *line, fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    for (fathom_sim_device_t **at = &line->devices; *at != NULL; at = &(*at)->next) {
        if (*at != device) continue;
        *at = device->next;
        cut_off(line, device);
        return;
    }
}

void fathom_sim_set_line(fathom_sim_line_t *line, const fathom_line_settings_t *settings, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    line->settings = *settings;
}

size_t fathom_sim_receive(fathom_sim_line_t *line, const uint8_t *bytes, size_t count, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    if (line->in_break) return 0;
    return fathom_sim_sender_put(&line->host, &line->settings, bytes, count, line->now_us);
}

void fathom_sim_break(fathom_sim_line_t *line, bool on, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    if (line->in_break == on) return;
    line->in_break = on;
    for (fathom_sim_device_t *at = line->devices; at != NULL; at = at->next) {
        if (on)
            fathom_sim_device_receive_start(at, line->now_us);
        else
            fathom_sim_device_receive_end(at, &line->settings, 0, false, line->full_duplex, line->now_us);
    }
    hold_rx(line, FATHOM_SIM_HELD_BY_BREAK, on);
}

size_t fathom_sim_queued(fathom_sim_line_t *line, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    return (size_t)(line->host.length - line->host.sent);
}

bool fathom_sim_sent(fathom_sim_line_t *line, uint32_t now_us)
{
    fathom_sim_run(line, now_us);
    return fathom_sim_sender_idle(&line->host);
}

uint32_t fathom_sim_leaves_in_us(fathom_sim_line_t *line, uint32_t now_us)
{
    const fathom_sim_sender_t *const host = &line->host;
    if (fathom_sim_sent(line, now_us)) return 0;
    return fathom_sim_until_us(host->begin_us + fathom_sim_span_us(&host->settings, host->length),
                               line->now_us);
}

size_t fathom_sim_transmit_timed(fathom_sim_line_t *line, uint32_t now_us, uint8_t *bytes, size_t capacity,
                                 uint8_t knows, fathom_rx_t *rx)
{
    const uint8_t before = FATHOM_RX_SILENCE | FATHOM_RX_OVERRUN;
    size_t count = 0;
    fathom_sim_run(line, now_us);
    while (count < capacity && line->waiting != 0) {
        const fathom_sim_arrival_t *const arrival = &line->arrivals[line->first];
        const uint8_t flags = arrival->flags & knows;
        if (count != 0 && (flags & (BYTE_ERRORS | before)) != 0) break;
        bytes[count++] = arrival->byte;
        rx->flags |= flags;
        if ((knows & FATHOM_RX_TIMED) != 0) {
            rx->flags |= FATHOM_RX_TIMED;
            rx->last_us = arrival->end_us;
        }
        line->first = (uint16_t)((line->first + 1) % FATHOM_SIM_QUEUE);
        line->waiting--;
        if ((flags & BYTE_ERRORS) != 0) break;
    }
    return count;
}

size_t fathom_sim_transmit(fathom_sim_line_t *line, uint32_t now_us, uint8_t *bytes, size_t capacity)
{
    fathom_rx_t rx = {0, 0};
    return fathom_sim_transmit_timed(line, now_us, bytes, capacity, 0, &rx);
}
