/* SPDX-License-Identifier: MIT */
/*
 * Any stream of any length, in pieces of any length, with silences and losses anywhere, polled at any time.
 *
 * proves: src/engine/stream.c
 * with: src/codec/dyp_stream.c
 * options: -eva-auto-loop-unroll 24 -eva-slevel-function any_stream:1
 */
#include "fathom/engine/stream.h"
#include "assumptions.h"

enum { PIECE = 3 }; /* what comes at once: a longer piece is several, between which nothing is done */

static void any_piece(fathom_stream_t *stream)
{
    uint8_t bytes[PIECE];
    const uint8_t count = any_8_in(0, PIECE);
    any_memory(bytes, sizeof bytes);
    fathom_stream_feed(stream, bytes, count, any_bool(), any_32());
}

static void any_stream(uint8_t length)
{
    static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];
    static fathom_stream_t stream;
    fathom_stream_config_t config;
    config.storage = storage + sizeof storage - FATHOM_STREAM_STORAGE(length);
    config.stale_us = any_32();
    config.gap_us = any_16();
    config.length = length;
    any_memory(storage, sizeof storage);
    if (fathom_stream_init(&stream, &config, any_32()) != FATHOM_OK) return;
    while (any_bool()) {
        any_piece(&stream);
        (void)fathom_stream_due_us(&stream, any_32());
        if (fathom_stream_poll(&stream, any_32()) == FATHOM_OK) {
            const uint8_t *const frame = fathom_stream_frame(&stream);
            const uint8_t first = frame[0];
            const uint8_t last = frame[length - 1];
        }
        (void)fathom_stream_due_us(&stream, any_32());
    }
}

static void refused(uint8_t *memory, uint8_t length)
{
    static fathom_stream_t stream;
    fathom_stream_config_t config;
    config.storage = memory;
    config.stale_us = any_32();
    config.gap_us = any_16();
    config.length = length;
    const fathom_status_t status = fathom_stream_init(&stream, &config, any_32());
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
}

int main(void)
{
    static uint8_t storage[1];
    any_stream(FATHOM_DYP_A16_LENGTH);
    any_stream(FATHOM_DYP_A05_LENGTH);
    refused(NULL, any_8());
    refused(storage, any_8_in(0, FATHOM_DYP_A16_LENGTH - 1));
    refused(storage, any_8_in(FATHOM_DYP_A16_LENGTH + 1, FATHOM_DYP_A05_LENGTH - 1));
    refused(storage, any_8_in(FATHOM_DYP_A05_LENGTH + 1, UINT8_MAX));
    return 0;
}
