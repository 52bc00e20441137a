/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STREAM_H
#define FATHOM_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/dyp_frame.h"
#include "fathom/line.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Turns the bytes of a sensor that sends by itself into frames FF .. SUM of 4 or 10 bytes (dyp_frame.h), as
 * the listener of a line or fed by hand.
 *
 * A good sum does not prove where a frame begins or ends, so a frame is believed only if
 *  - it stands in a believable place: it is the first thing after a silence that the clock or the port saw
 *    (gap_us), or it follows right upon another valid frame and no other alignment of the bytes of both was
 *    valid; and
 *  - what comes next shows that it has ended: a byte that begins another frame (FF), or a silence of gap_us.
 * So a frame is given one byte late, or where the line falls silent gap_us late: 5 ms on a microcontroller,
 * 25 ms behind an operating system. fathom_stream_due_us tells when; time_us stays the time of its last byte.
 * A gap_us that is longer than the pauses only means that the next frame decides.
 *
 * The place of a frame is `sure` where silence was seen before it and behind it, or where two frames or more came
 * right before it and it follows in step with them. In any other place that is believed, a frame could still be made of
 * the halves of two.
 *
 * Everything else is counted and dropped. So with gaps seen no stream of whole frames can show a value of
 * another alignment; without them, a value that is valid in two alignments (511 mm held still) is never
 * shown: the stream turns stale and says so by its AMBIGUOUS counter. What 8 bits of sum cannot see stays
 * unseen:
 *  - a frame of which two bytes or more were hit, once in 256;
 *  - a byte too many, once in 65536: the sum has to be FF and the byte has to fit;
 *  - a byte too few, before a frame that follows without a silence and goes on with FF, as FF FF FD FB (no
 *    target) does: once in 256 at most.
 *
 * The newest frame wins: when two come between two polls the older one is counted as MISSED.
 */

/* Zero-valued members of fathom_stream_config_t mean these. */
#define FATHOM_STREAM_DEFAULT_GAP_US   5000
#define FATHOM_STREAM_DEFAULT_STALE_US 10000000ul

/* Bytes of memory that a stream of frames of `length` bytes needs. */
#define FATHOM_STREAM_STORAGE(length) (2 * (length))

/* Counters; each stops at 65535, and the user may set it to 0. */
enum {
    FATHOM_STREAM_FRAMES = 0,    /* good ones */
    FATHOM_STREAM_MISSED = 1,    /* good ones that a newer one replaced before it was polled */
    FATHOM_STREAM_AMBIGUOUS = 2, /* right sums in a place where another alignment was right too */
    FATHOM_STREAM_UNSURE = 3,    /* right sums with neither a silence nor an unambiguous frame before them, or
                                    with something else than a frame or a silence behind them */
    FATHOM_STREAM_STALES = 4,    /* times that the deadline passed */
    FATHOM_STREAM_BYTES = 5,     /* all that came */
    FATHOM_STREAM_COUNTERS = 6
};

typedef struct {
    uint8_t *storage;  /* FATHOM_STREAM_STORAGE(length) bytes, the stream's alone */
    uint32_t stale_us; /* without a good frame for so long, the stream is stale; 0: 10 s */
    uint16_t gap_us;   /* a silence of so much starts a frame and ends one; more than a byte takes (1042 us at
                          9600 baud) and less than the pause between frames; behind an operating system
                          25000. 0: 5000 */
    uint8_t length;    /* 4 or 10 */
} fathom_stream_config_t;

typedef struct {
    fathom_listener_t listener; /* first, so that one pointer is both */
    const fathom_stream_config_t *config;
    uint32_t polled_us;
    uint32_t left_us;      /* until it is stale */
    uint32_t time_us;      /* of the newest good frame */
    uint32_t candidate_us; /* when its last byte came */
    uint16_t counters[FATHOM_STREAM_COUNTERS];
    uint8_t oldest; /* where in the ring */
    uint8_t run;    /* bytes since a gap; stops at 255 */
    uint8_t since;  /* bytes since the end of the last valid window; stops at 255 */
    bool gap;       /* the run began with a gap that was seen */
    uint8_t steps;  /* valid windows right upon one another without a doubt, less one; stops at 255 */
    bool doubtful;  /* the last valid window overlapped a valid one before it */
    bool first;     /* that window was the first thing after a gap */
    bool candidate; /* the ring holds a frame, if the next byte begins another one or none comes for gap_us */
    bool fresh;     /* the newest good frame has not been polled */
    bool sure;      /* its place is sure; to be read after a poll that gave it */
} fathom_stream_t;

/* Makes a stream ready; it is stale config->stale_us from now_us. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no
 * storage, or a length that is neither 4 nor 10. */
fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us);

/*
 * Takes `count` bytes; 0: bytes were lost here. after_gap: the line was seen to be silent for gap_us before the
 * first. time_us: when the last one came. A stream that listens to a line is fed by it.
 */
void fathom_stream_feed(fathom_stream_t *stream, const uint8_t *bytes, uint8_t count, bool after_gap,
                        uint32_t time_us);

/*
 * To be called when all that came before now_us has been fed: a silence since the last byte ends a frame.
 * FATHOM_READY: *frame is the newest good frame, config->length bytes in the stream's storage, to be read
 *   before more is fed; stream->time_us is when it came. Each frame is given once.
 * FATHOM_ERR_STALE: no good frame for stale_us; said once, then the deadline begins again.
 * FATHOM_PENDING: neither.
 */
fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us, const uint8_t **frame);

/* How long until poll will say FATHOM_READY or FATHOM_ERR_STALE if nothing comes; 0 when a frame waits to be
 * polled. */
uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
