/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STREAM_H
#define FATHOM_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/codec/dyp_stream.h"
#include "fathom/engine/line.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Turns the bytes of a sensor that sends by itself into frames FF .. SUM of 4 or 10 bytes (dyp_stream.h), as
 * the listener of a line or fed by hand.
 *
 * A good sum does not prove where a frame begins or ends, so a frame is believed only if
 *  - it stands in a believable place: it is the first thing after a silence that the clock or the port saw
 *    (gap_us), or it follows right upon another valid frame and no other alignment of the bytes of both was
 *    valid; and
 *  - what comes next shows that it has ended: a byte that begins another frame (FF), or a silence of gap_us.
 * So a frame is given one byte late, or where the line falls silent gap_us late: 5 ms on a microcontroller,
 * 25 ms behind an operating system. fathom_stream_due_us tells when; time_us stays the time of its last byte.
 * With a gap_us that is longer than the pauses, the next frame decides.
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
#define FATHOM_STREAM_DEFAULT_STALE_US 10000000uL

/* Bytes of memory that a stream of frames of `length` bytes needs. */
#define FATHOM_STREAM_STORAGE(length) (2 * (length))

/* Counters; each stops at 65535, and the user may set it to 0. */
enum {
    FATHOM_STREAM_FRAMES = 0,    /* good ones */
    FATHOM_STREAM_MISSED = 1,    /* good ones that a newer one replaced before it was polled */
    FATHOM_STREAM_AMBIGUOUS = 2, /* right sums in a place where another alignment was right too */
    /* right sums without a silence or an unambiguous frame before them, or without a frame or a silence behind */
    FATHOM_STREAM_UNSURE = 3,
    FATHOM_STREAM_STALES = 4, /* times that the deadline passed */
    FATHOM_STREAM_BYTES = 5,  /* all that came */
    FATHOM_STREAM_COUNTERS = 6
};

/* Read by init only. */
typedef struct {
    uint8_t *storage; /* FATHOM_STREAM_STORAGE(length) bytes, the stream's alone */
    /* Without a good frame for so long, the stream is stale; up to 2^31 - 1, 35 minutes. 0: 10 s. */
    uint32_t stale_us;
    /* A silence of so much starts a frame and ends one; more than a byte takes (1042 us at 9600 baud) and less than the
     * pause between frames; behind an operating system 25000. 0: 5000. */
    uint16_t gap_us;
    uint8_t length; /* 4 or 10 */
} fathom_stream_config_t;

typedef struct {
    fathom_listener_t listener; /* first, so that one pointer is both */
    /* bytes before words: a Cortex-M0+ reaches no others at once */
    uint8_t to_step; /* bytes until the window is right upon the last valid one, plus one; stops at 0 */
    bool gap;        /* the bytes since the last gap began with one that was seen, and none was lost */
    /* Not 0: the window is a frame, if the next byte begins another one or none comes for gap_us. 1: by the window
     * before it. 2: the first thing after a gap. 3: its place is sure. */
    uint8_t candidate;
    bool fresh; /* the newest good frame has not been polled */
    uint8_t length;
    /* Bytes until the window holds nothing from before the last gap or loss, plus one; stops at 0. */
    uint8_t to_whole;
    uint8_t last; /* of the last valid window: it overlapped one before it (1), or was right upon one (2) */
    bool sure;    /* the newest good frame's place is sure; to be read after a poll that gave it */
    uint16_t counters[FATHOM_STREAM_COUNTERS];
    uint8_t *storage; /* the window, which is the last `length` bytes; behind it the newest good frame */
    uint32_t stale_us;
    uint32_t since_us;     /* the last poll that gave a frame or FATHOM_ERR_STALE */
    uint32_t time_us;      /* of the newest good frame */
    uint32_t candidate_us; /* when its last byte came */
} fathom_stream_t;

/* Makes a stream ready; it is stale config->stale_us from now_us. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no
 * storage, or a length that is neither 4 nor 10. */
fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us);

/* The same where storage, length, stale_us and listener.gap_us of the stream are set, to what a config may have;
 * also to begin anew: all that came is forgotten. */
void fathom_stream_begin(fathom_stream_t *stream, uint32_t now_us);

/*
 * Takes `count` bytes; 0: bytes were lost here. after_gap: the line was seen to be silent for gap_us before the
 * first, or what came before is known to have ended. time_us: when the last one came. A stream that listens to a line is fed by it.
 * fathom_stream_receive: `listener` is that of a stream.
 */
void fathom_stream_receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                           uint32_t time_us);

static inline void fathom_stream_feed(fathom_stream_t *stream, const uint8_t *bytes, uint8_t count,
                                      bool after_gap, uint32_t time_us)
{
    fathom_stream_receive(&stream->listener, bytes, count, after_gap, time_us);
}

/*
 * To be called when all that came before now_us has been fed: a silence since the last byte ends a frame.
 * FATHOM_READY: fathom_stream_frame is the newest good frame, `length` bytes, to be read before more is fed;
 *   stream->time_us is when it came. Each frame is given once.
 * FATHOM_ERR_STALE: no good frame for stale_us; returned once, then the deadline begins again.
 * FATHOM_PENDING: neither.
 */
fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us);

static inline const uint8_t *fathom_stream_frame(const fathom_stream_t *stream)
{
    return &stream->storage[stream->length];
}

/* How long, in us, until poll returns FATHOM_READY or FATHOM_ERR_STALE if nothing comes; 0: a frame waits. */
uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
