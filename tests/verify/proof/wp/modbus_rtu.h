/* SPDX-License-Identifier: MIT */
/* What fathom/codec/modbus_rtu.h says, as contracts. */
#include "fathom/codec/modbus_rtu.h"

#include "crc.h"

/*@ predicate is_function(integer function) = function == 3 || function == 6 || function == 16;

    // The registers of a request: as many as a frame can carry.
    predicate is_count(integer function, integer count) =
        function == 6 || (function == 16 && 1 <= count <= 123) || (function == 3 && 1 <= count <= 125);

    logic integer request_size(integer function, integer count) = function == 16 ? 2 * count + 9 : 8;

    predicate same_head{L}(uint8_t *a, uint8_t *b, integer count) =
        \forall integer i; 0 <= i < count ==> a[i] == b[i];

    // same_head of all six bytes, in words that provers need not search.
    predicate same_six{L}(uint8_t *a, uint8_t *b) =
        a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3] && a[4] == b[4] && a[5] == b[5];
*/

/*@ requires \valid(at + (0 .. 1));
    assigns at[0 .. 1];
    ensures \result == at + 2;
    ensures 256 * at[0] + at[1] == value;
*/
static uint8_t *put16(uint8_t *at, uint16_t value);

/*@ requires \valid_read(at + (0 .. 1));
    assigns \nothing;
    ensures \result == 256 * at[0] + at[1];
*/
static uint16_t get16(const uint8_t *at);

/*@ requires \valid(at + (0 .. 2 * count - 1)) && \valid_read(values + (0 .. count - 1));
    requires \separated(at + (0 .. 2 * count - 1), values + (0 .. count - 1));
    assigns at[0 .. 2 * count - 1];
    ensures \result == at + 2 * count;
    ensures registers(at, values, count);
*/
static uint8_t *put_values(uint8_t *at, const uint16_t *values, uint8_t count);

/*@ requires \valid_read(at + (0 .. 2 * count - 1)) && \valid(values + (0 .. count - 1));
    requires \separated(at + (0 .. 2 * count - 1), values + (0 .. count - 1));
    assigns values[0 .. count - 1];
    ensures registers((uint8_t *)at, values, count);
*/
static void get_values(uint16_t *values, const uint8_t *at, uint8_t count);

/*@ requires \valid(at + (0 .. 5)) && \valid_read(message) && \separated(at + (0 .. 5), message);
    assigns at[0 .. 5];
    ensures \result == at + 6;
    ensures same_head(at, &message->head[0], 6);
*/
static uint8_t *put_head(uint8_t *at, const fathom_modbus_message_t *message);

/*@ requires \base_addr(frame) == \base_addr(end) && 0 <= end - frame <= 253;
    requires \valid(frame + (0 .. end - frame + 1));
    assigns frame[end - frame .. end - frame + 1];
    ensures \result == end - frame + 2;
    ensures ends_in_crc(frame, \result);
*/
static uint8_t seal(uint8_t *frame, const uint8_t *end);

/*@ requires \valid(message);
    assigns message->head[0 .. 5], message->exception;
    ensures message->head[0] == address && message->head[1] == function && message->exception == 0;
    ensures 256 * message->head[2] + message->head[3] == first;
    ensures 256 * message->head[4] + message->head[5] == last;
*/
static void set(fathom_modbus_message_t *message, uint8_t address, uint8_t function, uint16_t first,
                uint16_t last);

/*@ requires \valid(message);
    assigns *message;
    ensures message->head[0] == address && message->head[1] == 3 && message->values == values;
    ensures 256 * message->head[2] + message->head[3] == first && message->exception == 0;
    ensures message->head[4] == 0 && message->head[5] == count;
*/
void fathom_modbus_read_holding_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                          uint8_t count, uint16_t *values);

/*@ requires \valid(message);
    assigns message->head[0 .. 5], message->exception;
    ensures message->head[0] == address && message->head[1] == 6 && message->exception == 0;
    ensures 256 * message->head[2] + message->head[3] == first;
    ensures 256 * message->head[4] + message->head[5] == value;
*/
void fathom_modbus_write_single_register(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                         uint16_t value);

/*@ requires \valid(message);
    assigns *message;
    ensures message->head[0] == address && message->head[1] == 16 && message->values == values;
    ensures 256 * message->head[2] + message->head[3] == first && message->exception == 0;
    ensures message->head[4] == 0 && message->head[5] == count;
*/
void fathom_modbus_write_multiple_registers(fathom_modbus_message_t *message, uint8_t address, uint16_t first,
                                            uint8_t count, const uint16_t *values);

/*@ requires \valid_read(message) && is_function(message->head[1]);
    assigns \nothing;
    ensures out_of_range: \result == 0 <==> !is_count(message->head[1], message->head[5]);
    ensures fits: \result != 0 ==> \result >= 8 && \result >= request_size(message->head[1], message->head[5]);
    ensures response_fits: \result != 0 && message->head[1] == 3 ==> \result >= 5 + 2 * message->head[5];
    ensures least: \result != 0 ==> \result == 8 || \result == request_size(message->head[1], message->head[5]) ||
                                    (message->head[1] == 3 && \result == 5 + 2 * message->head[5]);
*/
uint8_t fathom_modbus_rtu_frame_size(const fathom_modbus_message_t *message);

/*@ requires \valid_read(message) && is_function(message->head[1]) && is_count(message->head[1], message->head[5]);
    requires \valid(frame + (0 .. request_size(message->head[1], message->head[5]) - 1));
    requires message->head[1] == 16 ==> \valid_read(message->values + (0 .. message->head[5] - 1));
    requires \separated(frame + (0 .. 254), message);
    requires message->head[1] == 16 ==> \separated(frame + (0 .. 254), message->values + (0 .. message->head[5] - 1));
    assigns frame[0 .. request_size(message->head[1], message->head[5]) - 1];
    ensures \result == request_size(message->head[1], message->head[5]);
    ensures head: same_head(frame, &message->head[0], 6);
    ensures message->head[1] == 16 ==> frame[6] == 2 * message->head[5] &&
                                       registers(frame + 7, message->values, message->head[5]);
    ensures ends_in_crc(frame, \result);
*/
uint8_t fathom_modbus_rtu_encode_request(const fathom_modbus_message_t *message, uint8_t *frame);

/*@ requires \valid_read(a + (0 .. count - 1)) && \valid_read(b + (0 .. count - 1));
    assigns \nothing;
    ensures \result != 0 <==> same_head((uint8_t *)a, (uint8_t *)b, count);
    ensures four: \result != 0 && count == 4 ==> a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
*/
static bool is_alike(const uint8_t *a, const uint8_t *b, uint8_t count);

/*@ requires 1 <= have && \valid_read(bytes + (0 .. have - 1));
    assigns \nothing;
    ensures more: have <= 2 ==> \result == 3;
    ensures exception: have > 2 && (bytes[1] == 0x83 || bytes[1] == 0x86 || bytes[1] == 0x90) ==> \result == 5 ||
        (bytes[1] == 0x83 && \result == 0);
    ensures write: have > 2 && (bytes[1] == 6 || bytes[1] == 16) ==> \result == 8;
    ensures read: have > 2 && bytes[1] == 3 ==>
        \result == (bytes[2] % 2 == 0 && 2 <= bytes[2] <= 250 ? bytes[2] + 5 : 0);
    ensures none: have > 2 && !is_function(bytes[1] % 128) ==> \result == 0;
*/
uint8_t fathom_modbus_rtu_response_length(const uint8_t *bytes, uint8_t have);

/*@ requires 1 <= have && \valid_read(message) && \valid_read(bytes + (0 .. have - 1));
    assigns \nothing;
    ensures \result != 0 <==> same_head((uint8_t *)bytes, &message->head[0], have < 6 ? have : 6);
*/
bool fathom_modbus_rtu_is_request(const fathom_modbus_message_t *message, const uint8_t *bytes, uint8_t have);

/*@ requires \valid(message) && is_function(message->head[1]) && \valid_read(frame + (0 .. 4));
    requires frame[1] == 3 ==> \valid_read(frame + (0 .. frame[2] + 4));
    requires frame[1] == 6 || frame[1] == 16 ==> \valid_read(frame + (0 .. 7));
    requires message->head[1] == 3 ==> \valid(message->values + (0 .. message->head[5] - 1)) &&
        \separated(message->values + (0 .. message->head[5] - 1), message, frame + (0 .. 259));
    requires \separated(message, frame + (0 .. 259));
    assigns message->head[0], message->exception, message->values[0 .. message->head[5] - 1];
    ensures results: \result == FATHOM_OK || \result == FATHOM_ERR_EXCEPTION || \result == FATHOM_ERR_MALFORMED ||
        \result == FATHOM_PENDING;
    ensures pending: \result == FATHOM_PENDING <==> frame[0] != \old(message->head[0]) && \old(message->head[0]) != 255;
    ensures read_ready: frame[0] == \old(message->head[0]) && frame[1] == 3 && message->head[1] == 3 &&
        frame[2] == 2 * message->head[5] ==> \result == FATHOM_OK;
    ensures exception: \result == FATHOM_ERR_EXCEPTION <==>
        \result != FATHOM_PENDING && frame[1] == \old(message->head[1]) + 128;
    ensures code: \result == FATHOM_ERR_EXCEPTION ==> message->exception == frame[2];
    ensures kept: \result != FATHOM_ERR_EXCEPTION ==> message->exception == \old(message->exception);
    ensures head_kept: \result != FATHOM_OK ==> message->head[0] == \old(message->head[0]);
    ensures values_kept: \result != FATHOM_OK || message->head[1] != 3 ==>
        \forall integer i; 0 <= i < message->head[5] ==> message->values[i] == \old(message->values[i]);
    ensures unit: \result == FATHOM_OK ==> message->head[0] == frame[0] && frame[1] == message->head[1];
    ensures read: \result == FATHOM_OK && message->head[1] == 3 ==>
        frame[2] == 2 * message->head[5] && registers((uint8_t *)frame + 3, message->values, message->head[5]);
    ensures write: \result == FATHOM_OK && message->head[1] != 3 ==>
        same_six((uint8_t *)frame, &message->head[0]);
*/
fathom_status_t fathom_modbus_rtu_parse_response(fathom_modbus_message_t *message, const uint8_t *frame);

/*@ requires 1 <= have && \valid_read(bytes + (0 .. have - 1));
    assigns \nothing;
    ensures function: have <= 1 ==> \result == 2;
    ensures fixed: have > 1 && bytes[1] != 16 ==> \result == (bytes[1] < 128 ? 8 : 0);
    ensures more: 1 < have < 7 && bytes[1] == 16 ==> \result == 7;
    ensures many: have >= 7 && bytes[1] == 16 ==> \result == (bytes[6] <= 246 ? bytes[6] + 9 : 0);
*/
uint8_t fathom_modbus_rtu_request_length(const uint8_t *bytes, uint8_t have);

/*@ requires \valid(message) && \valid_read(frame + (0 .. 7));
    requires frame[1] == 16 ==> \valid_read(frame + (0 .. frame[6] + 8));
    requires \valid(message->values + (0 .. capacity - 1));
    requires \separated(message, frame + (0 .. 263), message->values + (0 .. capacity - 1));
    assigns message->head[0 .. 5], message->exception, message->values[0 .. capacity - 1];
    ensures results: \result == FATHOM_OK || \result == FATHOM_ERR_EXCEPTION;
    ensures head: same_head(&message->head[0], (uint8_t *)frame, 6);
    ensures ready: \result == FATHOM_OK <==> frame[1] == 6 ||
        ((frame[1] == 3 || (frame[1] == 16 && frame[6] == 2 * frame[5])) && frame[4] == 0 && frame[5] <= capacity &&
         is_count(frame[1], frame[5]));
    ensures why: message->exception == (\result == FATHOM_OK ? 0 :
        frame[1] == 3 || frame[1] == 6 || frame[1] == 16 ? 3 : 1);
    ensures values: \result == FATHOM_OK && frame[1] == 16 ==>
        registers((uint8_t *)frame + 7, message->values, frame[5]);
    ensures values_kept: \result != FATHOM_OK || frame[1] != 16 ==>
        \forall integer i; 0 <= i < capacity ==> message->values[i] == \old(message->values[i]);
*/
fathom_status_t fathom_modbus_rtu_parse_request(fathom_modbus_message_t *message, const uint8_t *frame,
                                                uint8_t capacity);

/*@ requires \valid_read(message) && \valid(frame + (0 .. 7));
    requires message->exception != 0 || is_function(message->head[1]);
    requires message->exception == 0 && message->head[1] == 3 ==> message->head[5] <= 125 &&
        \valid(frame + (0 .. 4 + 2 * message->head[5])) &&
        \valid_read(message->values + (0 .. message->head[5] - 1)) &&
        \separated(frame + (0 .. 254), message->values + (0 .. message->head[5] - 1));
    requires \separated(frame + (0 .. 254), message);
    assigns frame[0 .. 254];
    ensures length_exception: \old(message->exception) != 0 ==> \result == 5;
    ensures length_read: \old(message->exception) == 0 && \old(message->head[1]) == 3 ==>
        \result == 5 + 2 * \old(message->head[5]);
    ensures length_write: \old(message->exception) == 0 && \old(message->head[1]) != 3 ==> \result == 8;
    ensures unit: frame[0] == message->head[0];
    ensures exception: message->exception != 0 ==> frame[2] == message->exception &&
        frame[1] == (message->head[1] < 128 ? message->head[1] + 128 : message->head[1]);
    ensures read: message->exception == 0 && message->head[1] == 3 ==> frame[1] == 3 &&
        frame[2] == 2 * message->head[5];
    ensures values: message->exception == 0 && message->head[1] == 3 ==>
        registers(frame + 3, message->values, message->head[5]);
    ensures write: message->exception == 0 && message->head[1] != 3 ==> frame[0] == message->head[0] &&
        frame[1] == message->head[1] && frame[2] == message->head[2];
    ensures written: message->exception == 0 && message->head[1] != 3 ==> frame[3] == message->head[3] &&
        frame[4] == message->head[4] && frame[5] == message->head[5];
    ensures ends_in_crc(frame, \result);
*/
uint8_t fathom_modbus_rtu_encode_response(const fathom_modbus_message_t *message, uint8_t *frame);
