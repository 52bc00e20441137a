/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_AUTO_H
#define FATHOM_HPS167S_AUTO_H

#include "fathom/engine/line.h"
#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S that sends measurements which nobody asked for. The datasheet contradicts itself: 2.2.1 says that a slave
 * cannot, and #5 that measuring continuously is asking again and again, while table 12, #10 and #15 speak of
 * "continuous output". Fathom asks (hps167s.h); this is for a unit that talks, or for listening to another master that
 * asks it.
 *
 * It is the listener of a line and looks for frames of the shape of #5's response from one address: id 03 08, 8 bytes,
 * CRC. It finds its way back into step byte by byte, and the CRC decides. Asking the same device on the same line works
 * meanwhile: a response to a command goes to the command, a frame that nobody waits for comes here.
 *
 * One sample a frame, as from asking. Where several frames came between two polls, the newest; the others are counted.
 * The errors of fathom_poll:
 *   FATHOM_ERR_STALE      no good frame for stale_us; said once every stale_us
 *   FATHOM_ERR_MALFORMED  a frame with figures that it cannot mean; counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; said by every poll until it works again
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
    fathom_hps167s_t *driver; /* NULL: no driver does */
    bool (*heard)(fathom_hps167s_t *driver, const uint16_t registers[4], uint32_t time_us);
    const fathom_hps167s_limits_t *limits;
    uint32_t stale_us;
    uint32_t left_us; /* until it is stale */
    uint32_t polled_us;
    uint32_t time_us; /* of the frame */
    uint16_t registers[4];
    uint16_t sequence;
    uint16_t implausible; /* frames that were refused for their figures; this and the next stop at 65535 */
    uint16_t missed;      /* frames that a newer one replaced before they were polled */
    const uint8_t *from;  /* whose frames */
    uint8_t address;
    uint8_t frame_address; /* of the frame */
    uint8_t have;
    bool is_new;
    uint8_t bytes[FATHOM_HPS167S_FRAME_LENGTH];
} fathom_hps167s_auto_t;

/* Begins to listen, instead of the listener before. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no line, or an address over
 * 32. */
fathom_status_t fathom_hps167s_auto_init(fathom_hps167s_auto_t *sensor,
                                         const fathom_hps167s_auto_config_t *config);

/*
 * Another driver asks the same device on this line, and outlives this. From now on frames are looked for from its
 * address, wherever that moves, and it is told of each (fathom_hps167s_heard). A response to its #2 has the same shape and
 * may come after something else was taken for it: what equals the last one is no measurement, nor, from #2 until another
 * question is asked, is anything that could be one; both are counted as implausible. Of distances that is 255 mm alone.
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
