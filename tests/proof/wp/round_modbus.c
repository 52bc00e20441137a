/* SPDX-License-Identifier: MIT */
/* Modbus RTU: what is encoded has the right CRC and is parsed as what it was. Proved of the contracts alone. */
#include "modbus_rtu.h"

/*@ lemma crc_of_range{L}: \forall uint8_t *bytes, integer n; 0 <= n ==> 0 <= crc_of(bytes, n) <= 0xFFFF;

    // "Over a frame that ends in its own CRC the result is 0, which is how a receiver checks one", and over no other.
    lemma residue{L}: \forall uint8_t *bytes, integer n; 0 <= n && 0 <= bytes[n] <= 255 && 0 <= bytes[n + 1] <= 255 ==>
        (crc_of(bytes, n + 2) == 0 <==> bytes[n] + 256 * bytes[n + 1] == crc_of(bytes, n));
*/

/*@ requires 2 <= length && \valid_read(frame + (0 .. length - 1));
    assigns \nothing;
    ensures \result != 0 <==> ends_in_crc((uint8_t *)frame, length);
*/
bool accepted(const uint8_t *frame, uint8_t length) { return fathom_crc16(frame, length) == 0u; }

/*@ requires \valid_read(sent) && sent->head[1] == 16 && 1 <= sent->head[5] <= 123 && sent->head[4] == 0;
    requires \valid_read(sent->values + (0 .. sent->head[5] - 1)) && \valid(frame + (0 .. 263)) && \valid(got);
    requires \valid(got->values + (0 .. 122));
    requires \separated(frame + (0 .. 263), sent, got, sent->values + (0 .. 122), got->values + (0 .. 122));
    assigns frame[0 .. 254], got->head[0 .. 5], got->exception, got->values[0 .. 122];
    ensures valid: \result != 0;
    ensures head: same_six(&got->head[0], &sent->head[0]);
    ensures same: \forall integer i; 0 <= i < sent->head[5] ==> got->values[i] == sent->values[i];
*/
bool write_request(const fathom_modbus_message_t *sent, uint8_t *frame, fathom_modbus_message_t *got)
{
    const uint8_t length = fathom_modbus_rtu_encode_request(sent, frame);
    return accepted(frame, length) && fathom_modbus_rtu_request_length(frame, length) == length &&
           fathom_modbus_rtu_parse_request(got, frame, 123) == FATHOM_READY;
}

/*@ requires \valid_read(sent) && sent->head[1] == 3 && 1 <= sent->head[5] <= 125 && sent->exception == 0;
    requires \valid_read(sent->values + (0 .. sent->head[5] - 1)) && \valid(frame + (0 .. 259)) && \valid(got);
    requires got->head[0] == sent->head[0] && got->head[1] == 3 && got->head[5] == sent->head[5];
    requires \valid(got->values + (0 .. 124));
    requires \separated(frame + (0 .. 259), sent, got, sent->values + (0 .. 124), got->values + (0 .. 124));
    assigns frame[0 .. 254], got->head[0], got->exception, got->values[0 .. got->head[5] - 1];
    ensures valid: \result != 0;
    ensures same: \forall integer i; 0 <= i < sent->head[5] ==> got->values[i] == sent->values[i];
*/
bool read_response(const fathom_modbus_message_t *sent, uint8_t *frame, fathom_modbus_message_t *got)
{
    const uint8_t length = fathom_modbus_rtu_encode_response(sent, frame);
    return accepted(frame, length) && fathom_modbus_rtu_response_length(frame, length) == length &&
           fathom_modbus_rtu_parse_response(got, frame) == FATHOM_READY;
}
