/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_listen.h"

#include <string.h>

#include "commands/scan/scan_plan.h"
#include "fathom/engine/stream.h"
#include "ports/channel.h"
#include "sensors/models.h"

enum { LEAST_FRAMES = 2, LEAST_BYTES = LEAST_FRAMES * FATHOM_DYP_A16_LENGTH, OTHER_RATE_US = 1000000 };

typedef struct {
    fathom_stream_t stream;
    fathom_stream_config_t config;
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A05_LENGTH)]; /* the longest frame */
} model_stream_t;

typedef struct {
    fathom_listener_t listener; /* first, so that one pointer is both */
    const scan_wire_t *wire;
    model_stream_t of[MODELS]; /* those of models without frames of their own are not begun */
} streams_t;

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us)
{
    streams_t *const streams = (streams_t *)listener;
    for (size_t i = 0; i != MODELS; i++)
        if (models[i]->scan.frame_length != 0)
            fathom_stream_feed(&streams->of[i].stream, bytes, count, after_gap, time_us);
}

/* A silence ends a frame, and it is polling that sees it. */
static void poll_streams(void *ctx)
{
    streams_t *const streams = ctx;
    const fathom_clock_t *const clock = streams->wire->clock;
    const uint32_t now_us = clock->now_us(clock->ctx);
    for (size_t i = 0; i != MODELS; i++)
        if (models[i]->scan.frame_length != 0) (void)fathom_stream_poll(&streams->of[i].stream, now_us);
}

static void begin_stream(model_stream_t *of, uint8_t length, uint32_t now_us)
{
    of->config.storage = of->storage;
    of->config.gap_us = CHANNEL_STREAM_GAP_US;
    of->config.length = length;
    (void)fathom_stream_init(&of->stream, &of->config, now_us); /* all of it is there */
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
    for (size_t i = 0; i != MODELS; i++)
        if (models[i]->scan.frame_length != 0)
            begin_stream(&streams->of[i], models[i]->scan.frame_length, now_us);
    (void)fathom_line_listen(wire->line, &streams->listener);
    const fathom_status_t status = scan_hear(wire, line, us, poll_streams, streams);
    (void)fathom_line_listen(wire->line, NULL);
    return status;
}

static bool name_sensor(scan_finding_t *finding, const model_t *model, scan_mode_t mode)
{
    finding->kind = SCAN_SENSOR;
    finding->model = (uint8_t)model->id;
    finding->mode = (uint8_t)mode;
    return true;
}

/* What was heard with these settings; false: nothing that can be named. */
static bool understand(const scan_wire_t *wire, const fathom_line_settings_t *line, const streams_t *streams,
                       scan_finding_t *finding)
{
    evidence_t evidence;
    listener_judge(wire->listener, 0, &evidence);
    finding->line = *line;
    /* Four frames of an A16 may hold one of an A05, by chance, but not between two silences. */
    for (size_t i = MODELS; i-- != 0;)
        if (streams->of[i].stream.counters[FATHOM_STREAM_FRAMES] >= LEAST_FRAMES)
            return name_sensor(finding, models[i], SCAN_AUTO);
    if (evidence.masters != 0) {
        finding->kind = SCAN_MASTER;
        finding->address = evidence.masters_address;
        return true;
    }
    if (evidence.foreign == 0) return false;
    /* Responses to no request: tables 12, #10 and #15 of the HPS-167S speak of continuous output. */
    finding->kind = SCAN_SENDER;
    finding->address = evidence.foreign_address;
    for (size_t i = 0; i != MODELS; i++)
        if (models[i]->may_send_unasked && model_has_rate(models[i], line->baud))
            return name_sensor(finding, models[i], SCAN_MODBUS);
    return true;
}

/* The same at all rates to which a sensor can be set, a second each. */
static fathom_status_t try_rates(const scan_wire_t *wire, streams_t *streams, scan_finding_t *finding)
{
    for (size_t i = 0; i != MODELS; i++) {
        for (const uint32_t *rate = models[i]->rates; rate != NULL && *rate != 0; rate++) {
            const fathom_line_settings_t line = {*rate, models[i]->line.parity, 1};
            const fathom_status_t status = hear(wire, &line, OTHER_RATE_US, streams);
            if (status == FATHOM_ERR_UNSUPPORTED) continue; /* a port that cannot do this rate */
            if (status != FATHOM_OK || understand(wire, &line, streams, finding)) return status;
        }
    }
    finding->kind = SCAN_SENDER;
    finding->line = scan_dyp_line;
    return FATHOM_OK;
}

fathom_status_t scan_listen(const scan_wire_t *wire, uint32_t listen_us, scan_unasked_t *unasked)
{
    streams_t streams;
    memset(unasked, 0, sizeof *unasked);
    const fathom_status_t status = hear(wire, &scan_dyp_line, listen_us, &streams);
    unasked->is_heard = wire->listener->bytes >= LEAST_BYTES;
    if (status != FATHOM_OK || !unasked->is_heard) return status;
    if (understand(wire, &scan_dyp_line, &streams, &unasked->finding)) return FATHOM_OK;
    return try_rates(wire, &streams, &unasked->finding);
}
