/* SPDX-License-Identifier: MIT */
/*
 * The time of characters and silences on the simulated wire. A sender holds bytes and the level of its pin at any time.
 */
#include "wire.h"

#include <string.h>

enum { START_AND_DATA_BITS = 9 };

/* Above this rate the Modbus silences are fixed times. */
static const uint32_t slow_baud = 19200;

static uint32_t bits_us(uint32_t baud, uint32_t bits)
{
    return (uint32_t)((bits * UINT32_C(1000000) + baud - 1) / baud);
}

static uint32_t character_bits(const fathom_line_settings_t *settings)
{
    return (uint32_t)(START_AND_DATA_BITS + (settings->parity != FATHOM_PARITY_NONE ? 1 : 0) +
                      settings->stop_bits);
}

uint32_t fathom_sim_span_us(const fathom_line_settings_t *settings, uint16_t characters)
{
    /* 256 characters of 12 bits are 3072 * 10^6: they fit */
    return bits_us(settings->baud, character_bits(settings) * characters);
}

/* Half characters, which need not be whole bits, at twice the rate. */
static uint32_t halves_us(const fathom_line_settings_t *settings, uint32_t halves, uint32_t fixed_us)
{
    return settings->baud > slow_baud ? fixed_us
                                      : bits_us(2 * settings->baud, character_bits(settings) * halves);
}

uint32_t fathom_sim_gap_us(const fathom_line_settings_t *settings) { return halves_us(settings, 3, 750); }

uint32_t fathom_sim_silence_us(const fathom_line_settings_t *settings)
{
    return halves_us(settings, 7, 1750);
}

bool fathom_sim_same_settings(const fathom_line_settings_t *a, const fathom_line_settings_t *b)
{
    const uint32_t apart = a->baud > b->baud ? a->baud - b->baud : b->baud - a->baud;
    return a->parity == b->parity && apart <= b->baud / 40;
}

uint32_t fathom_sim_until_us(uint32_t at_us, uint32_t now_us)
{
    const uint32_t ahead_us = fathom_elapsed_us(at_us, now_us);
    return ahead_us > INT32_MAX ? 0 : ahead_us;
}

bool fathom_sim_sender_idle(const fathom_sim_sender_t *sender) { return sender->sent == sender->length; }

size_t fathom_sim_sender_put(fathom_sim_sender_t *sender, const fathom_line_settings_t *settings,
                             const uint8_t *bytes, size_t count, uint32_t at_us)
{
    if (fathom_sim_sender_idle(sender)) {
        sender->settings = *settings;
        sender->begin_us = at_us;
        sender->length = 0;
        sender->paused = 0;
        sender->marked = false;
    } else if (sender->sent != 0) {
        sender->begin_us += fathom_sim_span_us(&sender->settings, sender->sent);
        sender->length = (uint16_t)(sender->length - sender->sent);
        memmove(sender->bytes, sender->bytes + sender->sent, sender->length);
    }
    sender->sent = 0;
    const size_t space = FATHOM_SIM_QUEUE - (size_t)sender->length;
    if (count > space) count = space;
    if (count != 0) memcpy(sender->bytes + sender->length, bytes, count);
    sender->length = (uint16_t)(sender->length + count);
    return count;
}

uint32_t fathom_sim_sender_next_us(const fathom_sim_sender_t *sender)
{
    const uint16_t characters = (uint16_t)(sender->sent + (sender->on_wire ? 1 : 0));
    uint32_t next_us = sender->begin_us + fathom_sim_span_us(&sender->settings, characters);
    for (uint8_t i = 0; i < sender->paused; i++)
        if (sender->sent >= sender->pauses[i].at) next_us += sender->pauses[i].us;
    return next_us;
}

bool fathom_sim_sender_level(const fathom_sim_sender_t *sender, uint32_t now_us)
{
    const fathom_line_settings_t *const settings = &sender->settings;
    const uint8_t byte = sender->bytes[sender->sent];
    const uint32_t left_us = fathom_sim_until_us(fathom_sim_sender_next_us(sender), now_us);
    const uint32_t left = (left_us * settings->baud + 999999) / 1000000; /* bits, the present one included */
    if (left >= character_bits(settings)) return false;
    if (left <= settings->stop_bits) return true;
    if (settings->parity != FATHOM_PARITY_NONE && left == settings->stop_bits + UINT32_C(1)) {
        bool odd = settings->parity == FATHOM_PARITY_ODD;
        for (uint8_t rest = byte; rest != 0; rest >>= 1) odd ^= (rest & 1) != 0;
        return odd;
    }
    return (byte >> (character_bits(settings) - left - 1) & 1) != 0;
}
