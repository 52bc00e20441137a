/* SPDX-License-Identifier: MIT */
/*
 * Decodes the registers of the HPS-167S and encodes those of #15. The sections follow the numbers of the commands.
 */
#include "fathom/codec/hps167s_registers.h"

#include <stddef.h>

enum { FIRST_YEAR = 2000, ACK = 0xB0 };

/* Default limits of a distance (#5), in mm. Over range is "65.53 meters": with two decimals, that is from 65530 on. A
 * distance of all ones belongs to the abnormal packet. */
enum { MIN_MM = 80, MAX_MM = 30000 };
#define MIN_OVER_RANGE 65530u
#define FAILURE        65535u

static uint8_t byte(const uint16_t *registers, uint8_t n) { return fathom_hps167s_get_byte(registers, n); }

/* ---- #1, #3, #9 ---- */

uint32_t fathom_hps167s_baud(uint16_t code)
{
    if (code == 2u) return 57600uL;
    if (code == 3u) return 115200uL;
    return (code == 4u) ? 230400uL : FATHOM_HPS167S_FACTORY_BAUD;
}

uint8_t fathom_hps167s_baud_code(uint32_t baud)
{
    uint8_t code = FATHOM_HPS167S_BAUD_CODES;
    while ((code != 0u) && (fathom_hps167s_baud(code) != baud)) code--;
    return code;
}

void fathom_hps167s_decode_version(const uint16_t registers[3], fathom_hps167s_version_t *version)
{
    version->year = (uint16_t)(FIRST_YEAR + byte(registers, 0));
    version->month = byte(registers, 1);
    version->day = byte(registers, 2);
    version->major = byte(registers, 3);
    version->minor = byte(registers, 4);
    version->revision = byte(registers, 5);
}

bool fathom_hps167s_is_date(uint8_t month, uint8_t day)
{
    return (month >= 1u) && (month <= 12u) && (day >= 1u) && (day <= 31u);
}

void fathom_hps167s_decode_details(const uint16_t registers[11], fathom_hps167s_details_t *details)
{
    enum { UUID = 1, DATE = UUID + FATHOM_HPS167S_UUID_LENGTH };
    for (uint8_t i = 0; i != FATHOM_HPS167S_UUID_LENGTH; i++)
        details->uuid[i] = byte(registers, (uint8_t)(UUID + i));
    details->year = (uint16_t)(FIRST_YEAR + byte(registers, DATE));
    details->month = byte(registers, DATE + 1);
    details->day = byte(registers, DATE + 2);
    details->major = byte(registers, DATE + 3);
    details->minor = byte(registers, DATE + 4);
}

bool fathom_hps167s_may_be_details(const uint16_t registers[11])
{
    return byte(registers, FATHOM_HPS167S_ACK_BYTE) == ACK;
}

/* ---- #2, #15 ---- */

uint32_t fathom_hps167s_decode_reconnect_time(uint16_t first, uint16_t second, bool low_word_first)
{
    return low_word_first ? (((uint32_t)second << 16) | first) : (((uint32_t)first << 16) | second);
}

void fathom_hps167s_encode_reconnect_time(uint32_t ms, bool low_word_first, uint16_t registers[2])
{
    registers[low_word_first ? 1 : 0] = (uint16_t)(ms >> 16);
    registers[low_word_first ? 0 : 1] = (uint16_t)ms;
}

uint32_t fathom_hps167s_configured_reconnect_time_ms(const uint16_t registers[4], bool low_word_first)
{
    enum { FIRST = FATHOM_HPS167S_RECONNECT_BYTE };
    return fathom_hps167s_decode_reconnect_time(
        (uint16_t)((byte(registers, FIRST) * 256u) + byte(registers, FIRST + 1)),
        (uint16_t)((byte(registers, FIRST + 2) * 256u) + byte(registers, FIRST + 3)), low_word_first);
}

void fathom_hps167s_decode_configuration(const uint16_t registers[4], bool low_word_first,
                                         fathom_hps167s_configuration_t *configuration)
{
    configuration->termination = byte(registers, FATHOM_HPS167S_TERMINATION_BYTE) != 0u;
    configuration->measures_after_power_on = byte(registers, FATHOM_HPS167S_MEASURES_BYTE) != 0u;
    configuration->warm_up_s = byte(registers, FATHOM_HPS167S_WARM_UP_BYTE);
    configuration->reconnect_time_ms = fathom_hps167s_configured_reconnect_time_ms(registers, low_word_first);
    configuration->baud_code = byte(registers, FATHOM_HPS167S_BAUD_BYTE);
    configuration->baud = fathom_hps167s_baud(configuration->baud_code);
}

static bool is_switch(uint8_t value) { return (value == FATHOM_HPS167S_OFF) || (value == FATHOM_HPS167S_ON); }

bool fathom_hps167s_may_be_configuration(const uint16_t registers[4])
{
    return is_switch(byte(registers, FATHOM_HPS167S_TERMINATION_BYTE)) &&
           is_switch(byte(registers, FATHOM_HPS167S_MEASURES_BYTE)) && !fathom_hps167s_is_abnormal(registers);
}

/* ---- #4 ---- */

/* (F - 32) * 50 / 9, rounded to the nearest: half of the divisor is added away from 0. */
int32_t fathom_hps167s_temperature_dc(int16_t fahrenheit, uint8_t steps_per_degree)
{
    const int32_t dividend = ((int32_t)fahrenheit - (32 * (int32_t)steps_per_degree)) * 50;
    const int32_t divisor = 9 * (int32_t)steps_per_degree;
    return ((dividend >= 0) ? (dividend + (divisor / 2)) : (dividend - (divisor / 2))) / divisor;
}

/* ---- #5 ---- */

fathom_status_t fathom_hps167s_complete_limits(fathom_hps167s_limits_t *limits)
{
    if (limits->max_mm == 0u) limits->max_mm = MAX_MM;
    if (limits->over_range_mm == 0u) limits->over_range_mm = MIN_OVER_RANGE;
    if (limits->min_mm == 0u) limits->min_mm = MIN_MM;
    const bool is_good = (limits->min_mm <= limits->max_mm) && (limits->max_mm < limits->over_range_mm) &&
                         (limits->over_range_mm < FAILURE);
    return is_good ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
}

bool fathom_hps167s_is_abnormal(const uint16_t registers[4])
{
    return ((registers[0] & registers[3]) == 0xFFFFu) && (registers[1] == 0u) &&
           ((uint8_t)registers[2] == 0xFFu);
}

fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample)
{
    const uint16_t raw = registers[0];
    const uint8_t exponent = (uint8_t)(registers[2] >> 8);
    uint8_t kind = FATHOM_FAULT;
    uint16_t distance_mm = 0;
    uint32_t magnitude = 0;
    uint16_t max_mm = MAX_MM;
    uint16_t over_range_mm = MIN_OVER_RANGE;
    uint16_t min_mm = MIN_MM;
    if (limits != NULL) {
        max_mm = limits->max_mm;
        over_range_mm = limits->over_range_mm;
        min_mm = limits->min_mm;
    }
    if (!fathom_hps167s_is_abnormal(registers)) {
        kind = FATHOM_NO_TARGET;
        if ((raw == 0u) || (raw == FAILURE) || (exponent > FATHOM_HPS167S_MAX_EXPONENT))
            return FATHOM_ERR_MALFORMED;
        if (raw < over_range_mm) {
            if (raw > max_mm) return FATHOM_ERR_MALFORMED;
            kind = FATHOM_UNKNOWN;
            if (raw >= min_mm) {
                kind = FATHOM_TARGET;
                distance_mm = raw;
            }
        }
        magnitude = (uint32_t)registers[1] << exponent;
    }
    sample->kind = kind;
    sample->raw = raw;
    sample->distance_mm = distance_mm;
    sample->magnitude = magnitude;
    sample->ambient = (uint8_t)registers[2];
    sample->precision = registers[3];
    sample->interference = false;
    return FATHOM_OK;
}

fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample)
{
    return fathom_hps167s_decode_within(NULL, registers, sample);
}
