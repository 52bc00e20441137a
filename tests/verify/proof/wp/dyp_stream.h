/* SPDX-License-Identifier: MIT */
/* What fathom/codec/dyp_stream.h says, as contracts. */
#include <stdbool.h>

#include "logic.h"

/*@ requires \valid_read(bytes + (0 .. length - 1));
    assigns \nothing;
    ensures \result == sum_of(bytes, length);
*/
uint8_t fathom_dyp_checksum(const uint8_t *bytes, uint8_t length);

/*@ requires 1 <= length && \valid_read(frame + (0 .. length - 1));
    assigns \nothing;
    ensures \result != 0 <==> frame[0] == 0xFF && frame[length - 1] == sum_of(frame, length - 1);
*/
bool fathom_dyp_stream_is_valid(const uint8_t *frame, uint8_t length);

/*@ requires probes <= 4 && \valid_read(frame + (0 .. 2 * probes)) && \valid(values + (0 .. probes - 1));
    requires \separated(values + (0 .. probes - 1), frame + (0 .. 2 * probes));
    assigns values[0 .. probes - 1];
    ensures registers(frame + 1, values, probes);
*/
void fathom_dyp_stream_decode(const uint8_t *frame, uint16_t *values, uint8_t probes);

/*@ requires probes <= 4 && \valid(frame + (0 .. 2 * probes + 1)) && \valid_read(values + (0 .. probes - 1));
    requires \separated(values + (0 .. probes - 1), frame + (0 .. 2 * probes + 1));
    assigns frame[0 .. 2 * probes + 1];
    ensures \result == 2 * probes + 2;
    ensures frame[0] == 0xFF;
    ensures registers(frame + 1, values, probes);
    ensures frame[2 * probes + 1] == sum_of(frame, 2 * probes + 1);
*/
uint8_t fathom_dyp_stream_encode(uint8_t *frame, const uint16_t *values, uint8_t probes);
