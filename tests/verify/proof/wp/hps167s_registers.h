/* SPDX-License-Identifier: MIT */
/* What fathom/codec/hps167s_registers.h says, as contracts. */
#include "fathom/codec/hps167s_registers.h"

#include <stddef.h>

#include "facts.h"

/*@ axiomatic words {
        axiom both_ones: \forall uint16_t x, y; (x & y) == 65535 <==> (x == 65535 && y == 65535);
        axiom high_word: \forall uint32_t x; (uint16_t)(x >> 16) == (x >> 16);
        axiom shifted_up: \forall uint16_t x, integer n; 0 <= n <= 16 ==> (x << n) <= 0xFFFF0000;
        axiom shifted_not_below: \forall uint16_t x, integer n; 0 <= n <= 16 ==> 0 <= (x << n);
    }

    // Byte n of a response, the first is 0, in the order of the wire: the high one of a register first.
    logic integer byte_of{L}(uint16_t *registers, integer n) =
        n % 2 == 0 ? registers[n / 2] / 256 : registers[n / 2] % 256;

    // #15 in its two registers.
    logic integer ms_of(integer first, integer second, integer low_word_first) =
        low_word_first != 0 ? (second << 16) | first : (first << 16) | second;

    logic integer baud_of(integer code) = code == 2 ? 57600 : code == 3 ? 115200 : code == 4 ? 230400 : 19200;

    // "Distance, Ambient, and Precision are all 0xFF and the value of Magnitude is 0x00".
    predicate is_abnormal{L}(uint16_t *registers) = registers[0] == 0xFFFF && registers[1] == 0 &&
        registers[2] % 256 == 0xFF && registers[3] == 0xFFFF;

    predicate is_within(integer raw, integer max_mm, integer over_range_mm) =
        raw != 0 && raw != 0xFFFF && (raw <= max_mm || raw >= over_range_mm);
*/

/*@ requires \valid_read(registers + n / 2);
    assigns \nothing;
    ensures \result == byte_of((uint16_t *)registers, n);
*/
static inline uint8_t fathom_hps167s_get_byte(const uint16_t *registers, uint8_t n);

/*@ requires \valid_read(registers + n / 2);
    assigns \nothing;
    ensures \result == byte_of((uint16_t *)registers, n);
*/
static uint8_t byte(const uint16_t *registers, uint8_t n);

/*@ assigns \nothing;
    ensures \result == baud_of(code);
*/
uint32_t fathom_hps167s_baud(uint16_t code);

/*@ assigns \nothing;
    ensures none: \result == 0 <==> baud != 19200 && baud != 57600 && baud != 115200 && baud != 230400;
    ensures code: \result != 0 ==> 1 <= \result <= 4 && baud_of(\result) == baud;
*/
uint8_t fathom_hps167s_baud_code(uint32_t baud);

/*@ requires \valid_read(registers + (0 .. 2)) && \valid(version) && \separated(version, registers + (0 .. 2));
    assigns *version;
    ensures version->year == 2000 + byte_of((uint16_t *)registers, 0);
    ensures version->month == byte_of((uint16_t *)registers, 1);
    ensures version->day == byte_of((uint16_t *)registers, 2);
    ensures version->major == byte_of((uint16_t *)registers, 3);
    ensures version->minor == byte_of((uint16_t *)registers, 4);
    ensures version->revision == byte_of((uint16_t *)registers, 5);
*/
void fathom_hps167s_decode_version(const uint16_t registers[3], fathom_hps167s_version_t *version);

/*@ assigns \nothing;
    ensures \result != 0 <==> 1 <= month <= 12 && 1 <= day <= 31;
*/
bool fathom_hps167s_is_date(uint8_t month, uint8_t day);

/*@ requires \valid_read(registers + (0 .. 10)) && \valid(details) && \separated(details, registers + (0 .. 10));
    assigns *details;
    ensures \forall integer i; 0 <= i < 16 ==> details->uuid[i] == byte_of((uint16_t *)registers, 1 + i);
    ensures details->year == 2000 + byte_of((uint16_t *)registers, 17);
    ensures details->month == byte_of((uint16_t *)registers, 18);
    ensures details->day == byte_of((uint16_t *)registers, 19);
    ensures details->major == byte_of((uint16_t *)registers, 20);
    ensures details->minor == byte_of((uint16_t *)registers, 21);
*/
void fathom_hps167s_decode_details(const uint16_t registers[11], fathom_hps167s_details_t *details);

/*@ requires \valid_read(registers + (0 .. 10));
    assigns \nothing;
    ensures \result != 0 <==> byte_of((uint16_t *)registers, 0) == 0xB0;
*/
bool fathom_hps167s_may_be_details(const uint16_t registers[11]);

/*@ requires \valid_read(registers + (0 .. 3));
    assigns \nothing;
    ensures \result != 0 <==> is_abnormal((uint16_t *)registers);
*/
bool fathom_hps167s_is_abnormal(const uint16_t registers[4]);

/*@ assigns \nothing;
    ensures \result != 0 <==> value == 0 || value == 0xFF;
*/
static bool is_switch(uint8_t value);

/*@ requires \valid_read(registers + (0 .. 3));
    assigns \nothing;
    ensures \result != 0 <==> !is_abnormal((uint16_t *)registers) &&
        (byte_of((uint16_t *)registers, 0) == 0 || byte_of((uint16_t *)registers, 0) == 0xFF) &&
        (byte_of((uint16_t *)registers, 1) == 0 || byte_of((uint16_t *)registers, 1) == 0xFF);
*/
bool fathom_hps167s_may_be_configuration(const uint16_t registers[4]);

/*@ requires 1 <= steps_per_degree;
    assigns \nothing;
    ensures nearest: -9 * steps_per_degree <= 2 * (9 * steps_per_degree * \result -
        50 * (fahrenheit - 32 * steps_per_degree)) <= 9 * steps_per_degree;
*/
int32_t fathom_hps167s_temperature_dc(int16_t fahrenheit, uint8_t steps_per_degree);

/*@ requires \valid(limits);
    assigns *limits;
    ensures max: limits->max_mm == (\old(limits->max_mm) == 0 ? 30000 : \old(limits->max_mm));
    ensures over: limits->over_range_mm == (\old(limits->over_range_mm) == 0 ? 65530 : \old(limits->over_range_mm));
    ensures min: limits->min_mm == (\old(limits->min_mm) == 0 ? 80 : \old(limits->min_mm));
    ensures results: \result == FATHOM_OK || \result == FATHOM_ERR_ARGUMENT;
    ensures ready: \result == FATHOM_OK <==>
        limits->min_mm <= limits->max_mm < limits->over_range_mm && limits->over_range_mm != 65535;
*/
fathom_status_t fathom_hps167s_complete_limits(fathom_hps167s_limits_t *limits);

/*@ requires \valid_read(registers + (0 .. 3)) && \valid(sample) && \separated(sample, registers + (0 .. 3));
    requires limits == \null || (\valid_read(limits) && \separated(sample, limits));
    assigns *sample;
    ensures results: \result == FATHOM_OK || \result == FATHOM_ERR_MALFORMED;
    ensures kept: \result != FATHOM_OK ==> sample->kind == \old(sample->kind) && sample->raw == \old(sample->raw) &&
        sample->distance_mm == \old(sample->distance_mm) && sample->magnitude == \old(sample->magnitude) &&
        sample->ambient == \old(sample->ambient) && sample->precision == \old(sample->precision) &&
        sample->interference == \old(sample->interference);
    ensures failed: is_abnormal((uint16_t *)registers) ==> \result == FATHOM_OK && sample->kind == FATHOM_FAULT &&
        sample->distance_mm == 0 && sample->magnitude == 0;
    ensures refused: \result != FATHOM_OK <==> !is_abnormal((uint16_t *)registers) &&
        (byte_of((uint16_t *)registers, 4) > 16 ||
         (limits == \null ? !is_within(registers[0], 30000, 65530) :
                            !is_within(registers[0], limits->max_mm, limits->over_range_mm)));
    ensures fields: \result == FATHOM_OK ==> sample->raw == registers[0] && sample->precision == registers[3] &&
        sample->ambient == byte_of((uint16_t *)registers, 5) && sample->interference == 0;
    ensures magnitude: \result == FATHOM_OK && !is_abnormal((uint16_t *)registers) ==>
        sample->magnitude == (registers[1] << byte_of((uint16_t *)registers, 4));
    ensures distance: \result == FATHOM_OK ==>
        sample->distance_mm == (sample->kind == FATHOM_TARGET ? registers[0] : 0);
    ensures kind: \result == FATHOM_OK && !is_abnormal((uint16_t *)registers) ==> sample->kind ==
        (registers[0] >= (limits == \null ? 65530 : limits->over_range_mm) ? FATHOM_NO_TARGET :
         registers[0] >= (limits == \null ? 80 : limits->min_mm) ? FATHOM_TARGET : FATHOM_UNKNOWN);
*/
fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample);

/*@ requires \valid_read(registers + (0 .. 3)) && \valid(sample) && \separated(sample, registers + (0 .. 3));
    assigns *sample;
    ensures refused: \result != FATHOM_OK <==> !is_abnormal((uint16_t *)registers) &&
        (byte_of((uint16_t *)registers, 4) > 16 || !is_within(registers[0], 30000, 65530));
    ensures failed: is_abnormal((uint16_t *)registers) ==> sample->kind == FATHOM_FAULT;
    ensures kind: \result == FATHOM_OK && !is_abnormal((uint16_t *)registers) ==> sample->kind ==
        (registers[0] >= 65530 ? FATHOM_NO_TARGET : registers[0] >= 80 ? FATHOM_TARGET : FATHOM_UNKNOWN);
    ensures distance: \result == FATHOM_OK ==>
        sample->distance_mm == (sample->kind == FATHOM_TARGET ? registers[0] : 0);
*/
fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample);

/*@ assigns \nothing;
    ensures \result == ms_of(first, second, low_word_first);
*/
uint32_t fathom_hps167s_decode_reconnect_time(uint16_t first, uint16_t second, bool low_word_first);

/*@ requires \valid(registers + (0 .. 1));
    assigns registers[0 .. 1];
    ensures high_first: low_word_first == 0 ==> registers[0] == (ms >> 16);
    ensures high_second: low_word_first == 0 ==> registers[1] == (uint16_t)ms;
    ensures low_first: low_word_first != 0 ==> registers[0] == (uint16_t)ms;
    ensures low_second: low_word_first != 0 ==> registers[1] == (ms >> 16);
*/
void fathom_hps167s_encode_reconnect_time(uint32_t ms, bool low_word_first, uint16_t registers[2]);

/*@ requires \valid_read(registers + (0 .. 3));
    assigns \nothing;
    ensures \result == ms_of(
        256 * byte_of((uint16_t *)registers, 3) + byte_of((uint16_t *)registers, 4),
        256 * byte_of((uint16_t *)registers, 5) + byte_of((uint16_t *)registers, 6), low_word_first);
*/
uint32_t fathom_hps167s_configured_reconnect_time_ms(const uint16_t registers[4], bool low_word_first);

/*@ requires \valid_read(registers + (0 .. 3)) && \valid(configuration);
    requires \separated(configuration, registers + (0 .. 3));
    assigns *configuration;
    ensures configuration->termination != 0 <==> byte_of((uint16_t *)registers, 0) != 0;
    ensures configuration->measures_after_power_on != 0 <==> byte_of((uint16_t *)registers, 1) != 0;
    ensures configuration->warm_up_s == byte_of((uint16_t *)registers, 2);
    ensures configuration->reconnect_time_ms == ms_of(
        256 * byte_of((uint16_t *)registers, 3) + byte_of((uint16_t *)registers, 4),
        256 * byte_of((uint16_t *)registers, 5) + byte_of((uint16_t *)registers, 6), low_word_first);
    ensures configuration->baud_code == byte_of((uint16_t *)registers, 7);
    ensures configuration->baud == baud_of(byte_of((uint16_t *)registers, 7));
*/
void fathom_hps167s_decode_configuration(const uint16_t registers[4], bool low_word_first,
                                         fathom_hps167s_configuration_t *configuration);
