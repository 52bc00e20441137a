/* SPDX-License-Identifier: MIT */
/* What A16 and A05 have in common: decode(encode(x)) is x, and encode(x) is valid. Proved of the contracts alone. */
#include "dyp_55aa.h"

/*@ requires probes <= 4 && \valid(frame + (0 .. 9)) && \valid_read(values + (0 .. probes - 1));
    requires \valid(back + (0 .. probes - 1));
    requires \separated(frame + (0 .. 9), values + (0 .. probes - 1), back + (0 .. probes - 1));
    assigns frame[0 .. 9], back[0 .. probes - 1];
    ensures valid: \result != 0;
    ensures same: \forall integer i; 0 <= i < probes ==> back[i] == values[i];
*/
bool stream(uint8_t *frame, const uint16_t *values, uint16_t *back, uint8_t probes)
{
    const uint8_t length = fathom_dyp_stream_encode(frame, values, probes);
    const bool valid = fathom_dyp_stream_is_valid(frame, length);
    fathom_dyp_stream_decode(frame, back, probes);
    return valid;
}

/*@ requires length_of(command) != 0 && \valid(frame + (0 .. 12)) && \valid_read(values + (0 .. 3));
    requires \valid(back + (0 .. 3)) && \separated(frame + (0 .. 12), values + (0 .. 3), back + (0 .. 3));
    assigns frame[0 .. 12], back[0 .. 3];
    ensures valid: \result != 0;
    ensures same: \forall integer i; 0 <= i < values_of(command) ==> back[i] == values[i];
*/
bool response(uint8_t *frame, uint8_t address, uint8_t command, const uint16_t *values, uint16_t *back)
{
    const uint8_t length = fathom_dyp_55aa_encode_response(frame, address, command, values);
    const bool valid = fathom_dyp_55aa_is_valid(frame, length);
    const uint8_t whole = fathom_dyp_55aa_frame_length(frame, length);
    /*@ assert whole: whole == length; */
    fathom_dyp_55aa_decode(frame, back);
    return valid;
}
