/* SPDX-License-Identifier: MIT */
/* What fathom/codec/dyp_55aa.h says, as contracts. */
#include "dyp_stream.h"

/*@ logic integer values_of(integer command) = command == 0x01 ? 4 : 0x10 <= command <= 0x13 ? 1 : 0;

    logic integer length_of(integer command) =
        command == 0x01 ? 13 : 0x10 <= command <= 0x13 ? 7 : command == 0x03 ? 5 : 0;

    predicate begins_with{L}(uint8_t *frame, integer address, integer command) =
        frame[0] == 0x55 && frame[1] == 0xAA && frame[2] == address && frame[3] == command;
*/

/*@ assigns \nothing;
    ensures \result == values_of(command);
*/
uint8_t fathom_dyp_55aa_value_count(uint8_t command);

/*@ assigns \nothing;
    ensures \result == length_of(command);
*/
uint8_t fathom_dyp_55aa_response_length(uint8_t command);

/*@ requires \valid(frame + (0 .. 3));
    assigns frame[0 .. 3];
    ensures \result == frame + 4;
    ensures begins_with(frame, address, command);
*/
static uint8_t *put_head(uint8_t *frame, uint8_t address, uint8_t command);

/*@ requires \base_addr(frame) == \base_addr(end) && 0 <= end - frame <= 254;
    requires \valid(frame + (0 .. end - frame));
    assigns *end;
    ensures \result == end - frame + 1;
    ensures *end == sum_of(frame, end - frame);
*/
static uint8_t seal(uint8_t *frame, uint8_t *end);

/*@ requires \valid(frame + (0 .. 4));
    assigns frame[0 .. 4];
    ensures \result == 5;
    ensures begins_with(frame, address, command);
    ensures frame[4] == sum_of(frame, 4);
*/
uint8_t fathom_dyp_55aa_encode_request(uint8_t *frame, uint8_t address, uint8_t command);

/*@ requires 1 <= have && \valid_read(bytes + (0 .. have - 1));
    assigns \nothing;
    ensures no_such: \result == 0 <==> bytes[0] != 0x55 || (have > 1 && bytes[1] != 0xAA) ||
                                       (have > 3 && length_of(bytes[3]) == 0);
    ensures more: \result != 0 && have <= 3 ==> \result == 4;
    ensures known: \result != 0 && have > 3 ==> \result == length_of(bytes[3]);
*/
uint8_t fathom_dyp_55aa_frame_length(const uint8_t *bytes, uint8_t have);

/*@ requires 1 <= length && \valid_read(frame + (0 .. length - 1));
    assigns \nothing;
    ensures \result != 0 <==> frame[length - 1] == sum_of(frame, length - 1);
*/
bool fathom_dyp_55aa_is_valid(const uint8_t *frame, uint8_t length);

/*@ requires \valid_read(frame + (0 .. 3)) && \valid_read(frame + (0 .. 3 + 2 * values_of(frame[3])));
    requires \valid(values + (0 .. values_of(frame[3]) - 1));
    requires \separated(values + (0 .. 3), frame + (0 .. 11));
    assigns values[0 .. values_of(frame[3]) - 1];
    ensures registers(frame + 4, values, values_of(frame[3]));
*/
void fathom_dyp_55aa_decode(const uint8_t *frame, uint16_t *values);

/*@ requires length_of(command) != 0 && \valid(frame + (0 .. length_of(command) - 1));
    requires \valid_read(values + (0 .. values_of(command) - 1));
    requires \separated(values + (0 .. 3), frame + (0 .. 12));
    assigns frame[0 .. length_of(command) - 1];
    ensures \result == length_of(command);
    ensures begins_with(frame, address, command);
    ensures registers(frame + 4, values, values_of(command));
    ensures frame[\result - 1] == sum_of(frame, \result - 1);
*/
uint8_t fathom_dyp_55aa_encode_response(uint8_t *frame, uint8_t address, uint8_t command,
                                        const uint16_t *values);
