/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_CONTROLLED_H
#define FATHOM_A16_CONTROLLED_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/engine/sensor.h"
#include "fathom/engine/stream.h"
#include "fathom/engine/trigger.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with controlled UART output (A16 3): each falling edge at its RX pin makes it measure once and send one frame
 * FF H L SUM, 90..110 ms later. 9600 8N1. The edge is made by a pin, or by a UART break of the line, so that a serial
 * adapter will do.
 *
 * One sample a response, given when the line has been silent for gap_us behind it; time_us is when its last byte came.
 * FATHOM_TARGET, or what the window makes of the values 0, FFFD, FFFE and FFFF (dyp.h). The errors of fathom_poll,
 * each of one trigger:
 *   FATHOM_ERR_NO_RESPONSE  nothing came in time: no supply, a cut wire, not in this mode
 *   FATHOM_ERR_CHECKSUM     something came in time, and no good frame among it
 *   FATHOM_ERR_MALFORMED    a good frame with a value that is refused: outside the window, or FFFF; it is in
 *                           measurement.refused_raw, and counted
 *   FATHOM_ERR_PORT         the HAL's port is broken; returned by every poll until it works again. Or it has refused
 *                           for a second to begin or to end the break; it is tried on; that is returned once a second
 *
 * A frame is the response if its last byte comes earliest_us..latest_us after the edge: the datasheet's time, and on
 * either side a margin for the clocks and the frame's own 4 ms. Where the port has no time stamps a byte may have come
 * at any time since the poll before, and both ends are stretched by that much. All other frames are counted in `late`
 * and dropped. What cannot be told apart: the response to the trigger before, if it comes 200 ms or more after that.
 *
 * No frame from before the trigger is a response. The driver reads the port once more directly after the edge, so that
 * bytes that waited in the port are known to be too early. If the program does not poll for more than latest_us and
 * FATHOM_LINE_LATE_US, the line drops what waits in the port (line.h, rule 14), and the trigger has no response.
 *
 *     polls     |        |                                      |
 *     trigger            |edge  earliest_us      latest_us
 *     wire      [frame]  |      |<-- [response] -->|
 *     result    `late`                                          one sample
 */

/* Zero-valued members of fathom_a16_controlled_config_t mean these. */
#define FATHOM_A16_CONTROLLED_DEFAULT_PERIOD_US   121000uL
#define FATHOM_A16_CONTROLLED_DEFAULT_EARLIEST_US 80000uL
#define FATHOM_A16_CONTROLLED_DEFAULT_LATEST_US   130000uL

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    fathom_line_t *line; /* its own; the sensor becomes the line's listener */
    /* What drives the module's RX pin: a pin, or a break of the line (fathom_output_line_break). */
    fathom_output_t trigger;
    /* From trigger to trigger, at least. It "must be greater than 120ms" (A16 3(2)), also by a clock that counts in
     * ms; 0 and anything less: 121 ms. */
    uint32_t period_us;   /* At most 2^31 - 1. */
    uint32_t earliest_us; /* 1 to latest_us. 0 selects 80 ms. */
    uint32_t latest_us;   /* earliest_us to 2^31 - 1. 0 selects 130 ms. */
    /* How long the trigger is low, at least, and how long high before it falls; 0: 2 ms (trigger.h). */
    uint16_t low_us;
    /* Silence that ends a frame (stream.h), in microseconds: 1042 to 65535. Behind an operating system choose 25000. 0
     * selects 5000. */
    uint16_t gap_us;
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 16350 mm */
} fathom_a16_controlled_config_t;

typedef struct {
    fathom_stream_t stream; /* first: its listener is the sensor's */
    fathom_line_t *line;
    fathom_trigger_t trigger;
    fathom_dyp_measurement_t measurement;
    uint32_t earliest_us;
    uint32_t latest_us;
    uint32_t edge_us; /* the trigger */
    uint32_t came_us; /* the earliest time at which the newest bytes can have come */
    uint16_t late;    /* frames that came at another time; stops at 65535, and the user may set it to 0 */
    bool waiting;     /* for the response */
    bool heard;       /* bytes came when the response may */
    uint16_t values[1];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
} fathom_a16_controlled_t;

/*
 * Makes the pin high and makes the driver the listener of the line. The first trigger comes low_us later.
 *   FATHOM_OK            The driver listens.
 *   FATHOM_ERR_ARGUMENT     `line` or `trigger.set` is NULL, or a member is outside its range.
 *   FATHOM_ERR_BUSY         The line has another listener, which stays. The trigger was not touched.
 *   FATHOM_ERR_UNSUPPORTED  The port, whose break is the trigger, has no set_break.
 */
fathom_status_t fathom_a16_controlled_init(fathom_a16_controlled_t *sensor,
                                           const fathom_a16_controlled_config_t *config);

/*
 * Stops listening, if the driver is the listener of the line, and lets the trigger go high; the memory is the caller's
 * again. Call it again, and not poll, unless it returns
 * FATHOM_OK: the trigger is high, always where it is a pin.
 * FATHOM_PENDING, FATHOM_ERR_PORT: as fathom_line_break(line, false). If the caller gives up here, TX stays low, and
 * the line sends nothing until that is FATHOM_OK.
 */
fathom_status_t fathom_a16_controlled_deinit(fathom_a16_controlled_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a16_controlled_sensor(fathom_a16_controlled_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
