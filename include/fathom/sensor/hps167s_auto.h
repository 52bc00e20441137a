/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_AUTO_H
#define FATHOM_HPS167S_AUTO_H

#include "fathom/engine/line.h"
#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S that sends measurements without a request. The datasheet contradicts itself: 2.2.1 says that a slave cannot,
 * and #5 that to measure continuously is to repeat the request, while table 12, #10 and #15 speak of "continuous
 * output". hps167s.h sends requests; this is for a unit that sends by itself, or for listening to another client.
 *
 * It is the listener of a line and looks for frames of the shape of #5's response from one address: ADDRESS 03 08,
 * 8 bytes, CRC. It gets back into step byte by byte, and the CRC decides. Requests to the same device on the same line
 * work meanwhile: a response goes to its request, a frame that no request waits for comes here.
 *
 * One sample a frame, as from hps167s.h. Where several frames came between two polls, the newest; the others are
 * counted. The errors of fathom_poll:
 *   FATHOM_ERR_STALE      no good frame for stale_us; returned once every stale_us
 *   FATHOM_ERR_MALFORMED  a frame with values that it cannot mean; counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; returned by every poll until it works again
 */

/* Read by init only; the line outlives this. Members that are 0 mean their defaults. */
typedef struct {
    fathom_line_t *line; /* it becomes the line's listener; its frame holds 13 bytes or more */
    uint32_t stale_us;   /* 0: 2 s; the slowest rate is 6 a second */
    uint8_t address;     /* 1..32; 0: 1 */
} fathom_hps167s_auto_config_t;

enum { FATHOM_HPS167S_FRAME_LENGTH = 13 };

typedef struct {
    fathom_listener_t listener; /* first, so that one pointer is both */
    fathom_line_t *line;
    fathom_hps167s_t *driver; /* NULL: none is beside it */
    bool (*heard)(fathom_hps167s_t *driver, const uint16_t registers[4], uint32_t time_us);
    const fathom_hps167s_limits_t *limits;
    uint32_t stale_us;
    uint32_t left_us; /* until it is stale */
    uint32_t polled_us;
    uint32_t time_us; /* of the frame */
    uint16_t registers[4];
    uint16_t sequence;
    uint16_t implausible; /* frames that were refused for their values; this and the next stop at 65535 */
    uint16_t missed;      /* frames that a newer one replaced before they were polled */
    const uint8_t *from;  /* the address whose frames are taken */
    uint8_t address;
    uint8_t frame_address; /* of the frame */
    uint8_t have;
    bool is_new;
    uint8_t bytes[FATHOM_HPS167S_FRAME_LENGTH];
} fathom_hps167s_auto_t;

/* Begins to listen, instead of the listener before. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no line, or address > 32. */
fathom_status_t fathom_hps167s_auto_init(fathom_hps167s_auto_t *sensor,
                                         const fathom_hps167s_auto_config_t *config);

/*
 * `driver` sends requests to the same device on this line, and outlives this. From now on frames are looked for from
 * its address, wherever that moves, and each is passed to fathom_hps167s_heard. A response to its #2 has the same shape
 * and may come after another frame was taken for it: a frame that equals the last #2 is no measurement, nor, from #2
 * until the next request, one that could be #2; both are counted as implausible. Of distances that is 255 mm alone.
 */
void fathom_hps167s_auto_beside(fathom_hps167s_auto_t *sensor, fathom_hps167s_t *driver);

/* As fathom_hps167s_use_limits. */
fathom_status_t fathom_hps167s_auto_use_limits(fathom_hps167s_auto_t *sensor,
                                               fathom_hps167s_limits_t *limits);

/* Stops listening; the memory is the caller's again. */
void fathom_hps167s_auto_deinit(fathom_hps167s_auto_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_hps167s_auto_sensor(fathom_hps167s_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
