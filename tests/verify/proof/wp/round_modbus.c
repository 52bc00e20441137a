/* SPDX-License-Identifier: MIT */
/* Modbus RTU: what is encoded has the right CRC and is parsed as what it was. Proved of the contracts alone. */
#include "modbus_rtu.h"

/*@ lemma crc_of_range{L}: \forall uint8_t *bytes, integer n; 0 <= n ==> 0 <= crc_of(bytes, n) <= 0xFFFF;

    // crc_step_low of crc.h, which crc_step.c has seen to hold, with a name, by which provers find what it is to be used on.
    predicate steps_to(integer crc, integer byte, integer high) = crc_step(crc, byte) == high;
    axiomatic StepsLow {
        axiom steps_low: \forall integer crc, byte, high; 0 <= crc <= 0xFFFF && 0 <= byte <= 0xFF && 0 <= high <= 0xFF ==>
            (steps_to(crc, byte, high) <==> crc == byte + 256 * high);
    }
*/

/* "Over a frame that ends in its own CRC the result is 0, which is how a receiver checks one", and over no other. */
/*@ requires 2 <= length && \valid_read(frame + (0 .. length - 1));
    assigns \nothing;
    ensures \result != 0 <==> ends_in_crc((uint8_t *)frame, length);
*/
bool accepted(const uint8_t *frame, uint8_t length)
{
    /*@ assert of_data: 0 <= crc_of((uint8_t *)frame, length - 2) <= 0xFFFF; */
    /*@ assert low: crc_of((uint8_t *)frame, length - 1) ==
            crc_step(crc_of((uint8_t *)frame, length - 2), frame[length - 2]); */
    /*@ assert high: crc_of((uint8_t *)frame, length) ==
            crc_step(crc_of((uint8_t *)frame, length - 1), frame[length - 1]); */
    /*@ assert none: steps_to(crc_of((uint8_t *)frame, length - 1), frame[length - 1], 0) <==>
            crc_of((uint8_t *)frame, length - 1) == frame[length - 1]; */
    /*@ assert ends: steps_to(crc_of((uint8_t *)frame, length - 2), frame[length - 2], frame[length - 1]) <==>
            ends_in_crc((uint8_t *)frame, length); */
    return fathom_crc16(frame, length) == 0u;
}

/*@ requires \valid_read(sent) && sent->head[1] == 16 && 1 <= sent->head[5] <= 123 && sent->head[4] == 0;
    requires \valid_read(sent->values + (0 .. sent->head[5] - 1)) && \valid(frame + (0 .. 263)) && \valid(got);
    requires \valid(got->values + (0 .. 122));
    requires \separated(frame + (0 .. 263), sent, got, sent->values + (0 .. 122), got->values + (0 .. 122));
    assigns frame[0 .. 254], got->head[0 .. 5], got->exception, got->values[0 .. 122];
    ensures ready: \result == FATHOM_OK;
    ensures head: same_six(&got->head[0], &sent->head[0]);
    ensures same: \forall integer i; 0 <= i < sent->head[5] ==> got->values[i] == sent->values[i];
*/
fathom_status_t write_request(const fathom_modbus_message_t *sent, uint8_t *frame,
                              fathom_modbus_message_t *got)
{
    const uint8_t length = fathom_modbus_rtu_encode_request(sent, frame);
    /*@ assert head: same_six(frame, &sent->head[0]); */
    /*@ assert size: frame[6] == 2 * frame[5]; */
    /*@ assert data: registers(frame + 7, sent->values, frame[5]); */
    const bool is_sealed = accepted(frame, length);
    const uint8_t whole = fathom_modbus_rtu_request_length(frame, length);
    /*@ assert valid: is_sealed != 0 && whole == length; */
    fathom_status_t status;
parse:
    status = fathom_modbus_rtu_parse_request(got, frame, 123);
    /*@ assert frame_kept: \forall integer i; 0 <= i < 255 ==> frame[i] == \at(frame[i], parse); */
    /*@ assert values_kept: \forall integer i; 0 <= i < sent->head[5] ==>
            sent->values[i] == \at(sent->values[i], parse); */
    /*@ assert head_kept: same_six(frame, &sent->head[0]) && frame[6] == 2 * frame[5]; */
    /*@ assert data_kept: registers(frame + 7, sent->values, frame[5]); */
    /*@ assert head_got: same_six(&got->head[0], frame); */
    /*@ assert ready: status == FATHOM_OK; */
    /*@ assert data_got: registers(frame + 7, got->values, frame[5]); */
    return status;
}

/*@ requires \valid_read(sent) && sent->head[1] == 3 && 1 <= sent->head[5] <= 125 && sent->exception == 0;
    requires \valid_read(sent->values + (0 .. sent->head[5] - 1)) && \valid(frame + (0 .. 259)) && \valid(got);
    requires got->head[0] == sent->head[0] && got->head[1] == 3 && got->head[5] == sent->head[5];
    requires \valid(got->values + (0 .. 124));
    requires \separated(frame + (0 .. 259), sent, got, sent->values + (0 .. 124), got->values + (0 .. 124));
    assigns frame[0 .. 254], got->head[0], got->exception, got->values[0 .. got->head[5] - 1];
    ensures ready: \result == FATHOM_OK;
    ensures same: \forall integer i; 0 <= i < sent->head[5] ==> got->values[i] == sent->values[i];
*/
fathom_status_t read_response(const fathom_modbus_message_t *sent, uint8_t *frame,
                              fathom_modbus_message_t *got)
{
    const uint8_t length = fathom_modbus_rtu_encode_response(sent, frame);
    /*@ assert head: frame[0] == sent->head[0] && frame[1] == 3 && frame[2] == 2 * sent->head[5]; */
    /*@ assert data: registers(frame + 3, sent->values, sent->head[5]); */
    const bool is_sealed = accepted(frame, length);
    const uint8_t whole = fathom_modbus_rtu_response_length(frame, length);
    /*@ assert valid: is_sealed != 0 && whole == length; */
    fathom_status_t status;
parse:
    status = fathom_modbus_rtu_parse_response(got, frame);
    /*@ assert frame_kept: \forall integer i; 0 <= i < 255 ==> frame[i] == \at(frame[i], parse); */
    /*@ assert values_kept: \forall integer i; 0 <= i < sent->head[5] ==>
            sent->values[i] == \at(sent->values[i], parse); */
    /*@ assert head_kept: frame[0] == sent->head[0] && frame[1] == 3 && frame[2] == 2 * sent->head[5]; */
    /*@ assert data_kept: registers(frame + 3, sent->values, sent->head[5]); */
    /*@ assert ready: status == FATHOM_OK; */
    /*@ assert data_got: registers(frame + 3, got->values, sent->head[5]); */
    return status;
}
