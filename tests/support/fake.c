/* SPDX-License-Identifier: MIT */
#include "fake.h"

#include <assert.h>
#include <string.h>

static bool is_due(const fake_t *fake, uint32_t at_us) { return (int32_t)(fake->now_us - at_us) >= 0; }

static int fake_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fake_t *const fake = ctx;
    fake->reads++;
    assert(rx->flags == 0 && rx->last_us == 0); /* the caller's part of the contract */
    if (fake->read_fails) return -1;
    if (fake->first == fake->last || !is_due(fake, fake->chunks[fake->first].at_us)) return 0;
    fake_chunk_t *const chunk = &fake->chunks[fake->first];
    size_t length = chunk->length - chunk->taken;
    if (length > capacity) length = capacity;
    memcpy(bytes, chunk->bytes + chunk->taken, length);
    if (chunk->taken == 0) *rx = chunk->rx;
    chunk->taken += length;
    if (chunk->taken == chunk->length) fake->first++;
    if (fake->first == fake->last) fake->first = fake->last = 0;
    return (int)length;
}

static int fake_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fake_t *const fake = ctx;
    if (fake->write_fails) return -1;
    if (fake->write_busy) return 0;
    if (fake->write_too_short) return (int)length - 1;
    assert(length >= 1 && length <= 255 && fake->written < FAKE_WRITES);
    const fake_write_t *const before = fake->written != 0 ? &fake->writes[fake->written - 1] : NULL;
    const size_t used = before != NULL ? (size_t)(before->bytes - fake->write_bytes) + before->length : 0;
    assert(length <= FAKE_WRITE_BYTES - used);
    fake_write_t *const write = &fake->writes[fake->written++];
    write->bytes = memcpy(fake->write_bytes + used, bytes, length);
    write->length = length;
    write->at_us = fake->now_us;
    write->baud = fake->settings.baud;
    fake->busy_until_us = fake->now_us + (uint32_t)length * fake->byte_us;
    return (int)length;
}

static bool fake_sent(void *ctx)
{
    const fake_t *const fake = ctx;
    return !fake->never_sent && is_due(fake, fake->busy_until_us);
}

static int fake_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fake_t *const fake = ctx;
    fake->set_lines++;
    if (settings->baud == fake->unsupported_baud) return -1;
    if (!fake_sent(ctx)) return 0;
    fake->settings = *settings;
    return 1;
}

static int fake_set_break(void *ctx, bool on)
{
    fake_t *const fake = ctx;
    if (!fake_sent(ctx)) return 0;
    if (fake->refusals != 0 && on == fake->refuses_begin) {
        if (fake->refusals > 0) fake->refusals--;
        return fake->refusal;
    }
    fake->breaks += on;
    fake->in_break = on;
    return 1;
}

uint32_t fake_leaves_in_us(void *ctx) { return ((const fake_t *)ctx)->leaves_in_us; }

static uint32_t fake_now_us(void *ctx)
{
    fake_t *const fake = ctx;
    fake->now_us += fake->step_us;
    return fake->now_us;
}

void fake_init(fake_t *fake)
{
    memset(fake, 0, sizeof *fake);
    fake->now_us = 1000;
    fake->busy_until_us = fake->now_us;
    fake->uart = (fathom_uart_t){.read = fake_read,
                                 .write = fake_write,
                                 .sent = fake_sent,
                                 .set_line = fake_set_line,
                                 .set_break = fake_set_break,
                                 .ctx = fake};
    fake->clock = (fathom_clock_t){fake_now_us, fake};
}

void fake_receive_rx(fake_t *fake, uint32_t in_us, const uint8_t *bytes, size_t length, fathom_rx_t rx)
{
    const fake_chunk_t *const before = fake->last != 0 ? &fake->chunks[fake->last - 1] : NULL;
    const size_t used = before != NULL ? (size_t)(before->bytes - fake->chunk_bytes) + before->length : 0;
    assert(fake->last < FAKE_CHUNKS && length <= FAKE_CHUNK_BYTES - used);
    fake_chunk_t *const chunk = &fake->chunks[fake->last++];
    chunk->at_us = fake->now_us + in_us;
    chunk->bytes = memcpy(fake->chunk_bytes + used, bytes, length);
    chunk->length = length;
    chunk->taken = 0;
    chunk->rx = rx;
}

void fake_receive(fake_t *fake, uint32_t in_us, const uint8_t *bytes, size_t length)
{
    fake_receive_rx(fake, in_us, bytes, length, (fathom_rx_t){0, 0});
}

void fake_trickle(fake_t *fake, uint32_t in_us, uint32_t byte_us, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i != length; i++)
        fake_receive(fake, in_us + (uint32_t)(i + 1) * byte_us, bytes + i, 1);
}

bool fake_drained(const fake_t *fake) { return fake->first == fake->last; }
