/* SPDX-License-Identifier: MIT */
#include "scan/scan_listen.h"

#include <string.h>

#include "fathom/hps167s_registers.h"
#include "fathom/stream.h"
#include "scan/scan_plan.h"
#include "shared/channel.h"

enum { LEAST_FRAMES = 2, LEAST_BYTES = LEAST_FRAMES * FATHOM_DYP_A16_LENGTH, OTHER_RATE_US = 1000000 };

typedef struct {
    fathom_listener_t listener; /* first, so that one pointer is both */
    const scan_wire_t *wire;
    fathom_stream_t a16;
    fathom_stream_t a05;
    fathom_stream_config_t a16_config;
    fathom_stream_config_t a05_config;
    uint8_t a16_storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
    uint8_t a05_storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A05_LENGTH)];
} streams_t;

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us)
{
    streams_t *const streams = (streams_t *)listener;
    fathom_stream_feed(&streams->a16, bytes, count, after_gap, time_us);
    fathom_stream_feed(&streams->a05, bytes, count, after_gap, time_us);
}

/* A silence ends a frame, and it is polling that sees it. */
static void poll_streams(void *ctx)
{
    streams_t *const streams = ctx;
    const fathom_clock_t *const clock = streams->wire->clock;
    const uint32_t now_us = clock->now_us(clock->ctx);
    (void)fathom_stream_poll(&streams->a16, now_us);
    (void)fathom_stream_poll(&streams->a05, now_us);
}

static void begin_stream(fathom_stream_t *stream, fathom_stream_config_t *config, uint8_t *storage,
                         uint8_t length, uint32_t now_us)
{
    config->storage = storage;
    config->gap_us = CHANNEL_STREAM_GAP_US;
    config->length = length;
    (void)fathom_stream_init(stream, config, now_us); /* all of it is there */
}

/* Listens with these settings; what the streams and the listener have heard is there then. */
static fathom_status_t hear(const scan_wire_t *wire, const fathom_line_settings_t *line, uint32_t us,
                            streams_t *streams)
{
    const uint32_t now_us = wire->clock->now_us(wire->clock->ctx);
    memset(streams, 0, sizeof *streams);
    streams->listener.receive = receive;
    streams->listener.gap_us = CHANNEL_STREAM_GAP_US;
    streams->wire = wire;
    begin_stream(&streams->a16, &streams->a16_config, streams->a16_storage, FATHOM_DYP_A16_LENGTH, now_us);
    begin_stream(&streams->a05, &streams->a05_config, streams->a05_storage, FATHOM_DYP_A05_LENGTH, now_us);
    fathom_line_listen(wire->line, &streams->listener);
    const fathom_status_t status = scan_hear(wire, line, us, poll_streams, streams);
    fathom_line_listen(wire->line, NULL);
    return status;
}

static void name_sensor(scan_finding_t *finding, fathom_model_t model, scan_mode_t mode)
{
    finding->kind = SCAN_SENSOR;
    finding->model = (uint8_t)model;
    finding->mode = (uint8_t)mode;
}

/* What was heard with these settings; false: nothing that can be named. */
static bool understand(const scan_wire_t *wire, const fathom_line_settings_t *line, const streams_t *streams,
                       scan_finding_t *finding)
{
    evidence_t evidence;
    listener_judge(wire->listener, 0, &evidence);
    finding->line = *line;
    /* Four frames of an A16 may hold one of an A05, by chance, but not between two silences. */
    if (streams->a05.counters[FATHOM_STREAM_FRAMES] >= LEAST_FRAMES) {
        name_sensor(finding, FATHOM_A05, SCAN_AUTO);
    } else if (streams->a16.counters[FATHOM_STREAM_FRAMES] >= LEAST_FRAMES) {
        name_sensor(finding, FATHOM_A16, SCAN_AUTO);
    } else if (evidence.masters != 0) {
        finding->kind = SCAN_MASTER;
        finding->address = evidence.masters_address;
    } else if (evidence.foreign != 0) {
        /* Answers to no request: tables 12, #10 and #15 of the HPS-167S speak of continuous output. */
        finding->kind = SCAN_SENDER;
        finding->address = evidence.foreign_address;
        if (scan_is_hps167s_rate(line->baud)) name_sensor(finding, FATHOM_HPS167S, SCAN_MODBUS);
    } else {
        return false;
    }
    return true;
}

fathom_status_t scan_listen(const scan_wire_t *wire, uint32_t listen_us, scan_unasked_t *unasked)
{
    streams_t streams;
    memset(unasked, 0, sizeof *unasked);
    fathom_status_t status = hear(wire, &scan_dyp_line, listen_us, &streams);
    unasked->is_heard = wire->listener->bytes >= LEAST_BYTES;
    if (status != FATHOM_READY || !unasked->is_heard) return status;
    if (understand(wire, &scan_dyp_line, &streams, &unasked->finding)) return FATHOM_READY;
    for (uint8_t code = 1; code <= FATHOM_HPS167S_BAUD_CODES; code++) {
        const uint32_t baud = fathom_hps167s_baud(code);
        const fathom_line_settings_t line = {baud, scan_factory_parity(baud), 1};
        status = hear(wire, &line, OTHER_RATE_US, &streams);
        if (status == FATHOM_ERR_UNSUPPORTED) continue; /* a port that cannot do this rate */
        if (status != FATHOM_READY) return status;
        if (understand(wire, &line, &streams, &unasked->finding)) return FATHOM_READY;
    }
    unasked->finding.kind = SCAN_SENDER;
    unasked->finding.line = scan_dyp_line;
    return FATHOM_READY;
}
