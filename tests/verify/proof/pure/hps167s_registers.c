/* SPDX-License-Identifier: MIT */
/*
 * Every value of every register, in arrays of just the length that a command has.
 *
 * proves: src/codec/hps167s_registers.c
 * options: -eva-split-return full
 */
#include "fathom/codec/hps167s_registers.h"
#include "assumptions.h"

static void any_registers(uint16_t *registers, uint8_t count)
{
    for (uint8_t i = 0; i != count; i++) registers[i] = any_16();
}

static void version(void)
{
    uint16_t registers[FATHOM_HPS167S_VERSION_COUNT];
    fathom_hps167s_version_t version;
    any_registers(registers, FATHOM_HPS167S_VERSION_COUNT);
    fathom_hps167s_decode_version(registers, &version);
    (void)fathom_hps167s_is_date(version.month, version.day);
}

static void details(void)
{
    uint16_t registers[FATHOM_HPS167S_DETAILS_COUNT];
    fathom_hps167s_details_t details;
    any_registers(registers, FATHOM_HPS167S_DETAILS_COUNT);
    (void)fathom_hps167s_may_be_details(registers);
    fathom_hps167s_decode_details(registers, &details);
    (void)fathom_hps167s_is_date(details.month, details.day);
}

static void configuration(void)
{
    uint16_t registers[FATHOM_HPS167S_CONFIGURATION_COUNT];
    fathom_hps167s_configuration_t configuration;
    any_registers(registers, FATHOM_HPS167S_CONFIGURATION_COUNT);
    (void)fathom_hps167s_may_be_configuration(registers);
    fathom_hps167s_decode_configuration(registers, any_bool(), &configuration);
    /*@ assert \initialized(&configuration.baud) && \initialized(&configuration.baud_code); */
}

static void reconnect(void)
{
    uint16_t registers[FATHOM_HPS167S_RECONNECT_COUNT];
    fathom_hps167s_encode_reconnect_time(any_32(), false, registers);
    (void)fathom_hps167s_decode_reconnect_time(registers[0], registers[1], any_bool());
    fathom_hps167s_encode_reconnect_time(any_32(), true, registers);
    (void)fathom_hps167s_decode_reconnect_time(registers[0], registers[1], any_bool());
}

static void measurement(void)
{
    uint16_t registers[FATHOM_HPS167S_MEASUREMENT_COUNT];
    fathom_sample_t sample;
    fathom_hps167s_limits_t limits;
    any_registers(registers, FATHOM_HPS167S_MEASUREMENT_COUNT);
    if (fathom_hps167s_decode(registers, &sample) == FATHOM_OK) {
        /*@ assert \initialized(&sample.kind) && \initialized(&sample.magnitude); */
    }
    limits.max_mm = any_16();
    limits.over_range_mm = any_16();
    limits.min_mm = any_16();
    (void)fathom_hps167s_complete_limits(&limits);
    (void)fathom_hps167s_decode_within(&limits, registers, &sample);
}

int main(void)
{
    version();
    details();
    configuration();
    reconnect();
    measurement();
    (void)fathom_hps167s_baud(any_16());
    (void)fathom_hps167s_baud_code(any_32());
    (void)fathom_hps167s_temperature_dc(fathom_hps167s_to_signed(any_16()), any_8_in(1, UINT8_MAX));
    return 0;
}
