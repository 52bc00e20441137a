/* SPDX-License-Identifier: MIT */
#include "fathom/hps167s_info.h"

#include "hps167s_inside.h"

/* Where the commands are, and with how many registers; the right length is part of the command. */
enum { VERSION = 0x0001, VERSION_COUNT = 3 };
enum { CONFIGURATION = FATHOM_HPS167S_CONFIGURATION, CONFIGURATION_COUNT = 4 };
enum { DETAILS = 0x0003, DETAILS_COUNT = 11, DETAILS_ACK = 0xB0 };
enum { TEMPERATURE = 0x0004, TEMPERATURE_COUNT = 1 };

enum { FIRST_YEAR = 2000, MAX_ANSWERS = 8, ANSWERS_AMONG_UNASKED = 3 };

fathom_status_t fathom_hps167s_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out)
{
    const uint16_t *const values = sensor->values;
    const fathom_status_t status = fathom_hps167s_command(sensor, VERSION, VERSION_COUNT);
    if (status != FATHOM_READY) return status;
    out->year = (uint16_t)(FIRST_YEAR + high(values[0]));
    out->month = low(values[0]);
    out->day = high(values[1]);
    out->major = low(values[1]);
    out->minor = high(values[2]);
    out->revision = low(values[2]);
    return FATHOM_READY;
}

/* ---- #2 ---- */

/* The code of #9, which says that all others mean 19200. */
static uint32_t baud_of(uint8_t code)
{
    if (code == 2) return 57600ul;
    if (code == 3) return 115200ul;
    return code == 4 ? 230400ul : 19200ul;
}

/* Its four bytes are the last of one register, a whole one, and the first of a third. */
static uint32_t reconnect_time_ms(const fathom_hps167s_t *sensor, const uint16_t *registers)
{
    const uint16_t first = (uint16_t)(low(registers[1]) * 256u + high(registers[2]));
    const uint16_t last = (uint16_t)(low(registers[2]) * 256u + high(registers[3]));
    return sensor->low_word_first ? (uint32_t)last << 16 | first : (uint32_t)first << 16 | last;
}

static bool is_switch(uint8_t byte) { return byte == 0x00 || byte == 0xFF; }

bool fathom_hps167s_may_be_configuration(const uint16_t registers[4])
{
    return is_switch(high(registers[0])) && is_switch(low(registers[0])) &&
           !fathom_hps167s_is_abnormal(registers);
}

bool fathom_hps167s_heard(fathom_hps167s_t *sensor, const uint16_t registers[4], uint32_t time_us)
{
    const bool is_told = same_4(registers, sensor->told);
    sensor->unasked_us = time_us;
    if (is_told) {
        /* Was it that which came as an answer? Not if an answer is still to come. */
        if (!sensor->is_owed) sensor->agreed = 0;
        sensor->is_owed = false;
    }
    if (is_told ||
        (fathom_hps167s_has_asked(sensor, CONFIGURATION) && fathom_hps167s_may_be_configuration(registers)))
        return false;
    copy_4(sensor->measured, registers);
    return true;
}

/* A frame of the right shape has come: is it enough now? One that is a measurement counts neither way. */
static bool is_believed(fathom_hps167s_t *sensor)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    const uint16_t *const values = sensor->values;
    uint8_t needed = sensor->same_answers;
    if (sensor->answers++ == 0) sensor->agreed = 0;
    if (!fathom_hps167s_may_be_configuration(values) || same_4(values, sensor->measured)) {
        copy_4(sensor->measured, values);
        sensor->unasked_us = unit->polled_us;
        sensor->is_owed = true;
    } else {
        if (!same_4(values, sensor->told)) sensor->agreed = 0;
        copy_4(sensor->told, values);
        sensor->agreed++;
    }
    const bool is_among_unasked =
        fathom_elapsed_us(unit->polled_us, sensor->unasked_us) < FATHOM_HPS167S_UNASKED_US;
    if (is_among_unasked && needed < ANSWERS_AMONG_UNASKED) needed = ANSWERS_AMONG_UNASKED;
    if (sensor->agreed >= needed) return true;
    /* A question in step with what the device sends by itself would get that each time. */
    if (is_among_unasked)
        unit->pause_us += (uint32_t)((2u * sensor->answers + 1u) * (FATHOM_HPS167S_MIN_PERIOD_US / 2));
    return false;
}

fathom_status_t fathom_hps167s_configuration(fathom_hps167s_t *sensor, fathom_hps167s_configuration_t *out)
{
    const uint16_t *const values = sensor->values;
    fathom_status_t status = FATHOM_READY;
    bool is_enough = false;
    while (!is_enough && status == FATHOM_READY) {
        status = fathom_hps167s_command(sensor, CONFIGURATION, CONFIGURATION_COUNT);
        if (status == FATHOM_PENDING || status == FATHOM_ERR_BUSY) return status;
        if (status != FATHOM_READY) continue;
        is_enough = is_believed(sensor);
        if (!is_enough && sensor->answers == MAX_ANSWERS) status = FATHOM_ERR_MALFORMED;
    }
    sensor->answers = 0;
    if (status != FATHOM_READY) return status;
    out->termination = high(values[0]) != 0;
    out->measures_after_power_on = low(values[0]) != 0;
    out->warm_up_s = high(values[1]);
    out->reconnect_time_ms = reconnect_time_ms(sensor, values);
    out->baud_code = low(values[3]);
    out->baud = baud_of(out->baud_code);
    return FATHOM_READY;
}

/* ---- #3, #4 ---- */

/* The answer's first byte is the ACK byte, so that what follows stands across the registers. */
fathom_status_t fathom_hps167s_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out)
{
    const uint16_t *values = sensor->values;
    const fathom_status_t status = fathom_hps167s_command(sensor, DETAILS, DETAILS_COUNT);
    if (status != FATHOM_READY) return status;
    if (high(values[0]) != DETAILS_ACK) return FATHOM_ERR_MALFORMED;
    for (uint8_t i = 0; i != FATHOM_HPS167S_UUID_LENGTH; i = (uint8_t)(i + 2)) {
        out->uuid[i] = low(*values++);
        out->uuid[i + 1] = high(*values);
    }
    out->year = (uint16_t)(FIRST_YEAR + low(values[0]));
    out->month = high(values[1]);
    out->day = low(values[1]);
    out->major = high(values[2]);
    out->minor = low(values[2]);
    return FATHOM_READY;
}

/* (F - 32) * 50 / 9 with F = raw / steps; an odd divisor or one that is 9 times something has no halves to round. */
static int32_t tenths_of_celsius(int16_t raw, uint8_t steps)
{
    const int32_t dividend = ((int32_t)raw - 32 * (int32_t)steps) * 50;
    const int32_t divisor = 9 * (int32_t)steps;
    return (dividend >= 0 ? dividend + divisor / 2 : dividend - divisor / 2) / divisor;
}

fathom_status_t fathom_hps167s_temperature(fathom_hps167s_t *sensor, fathom_hps167s_temperature_t *out)
{
    const fathom_status_t status = fathom_hps167s_command(sensor, TEMPERATURE, TEMPERATURE_COUNT);
    if (status != FATHOM_READY) return status;
    const uint16_t bits = sensor->values[0];
    const int16_t raw = (int16_t)(bits < 0x8000u ? (int32_t)bits : (int32_t)bits - 0x10000);
    const int32_t temperature_dc = tenths_of_celsius(raw, sensor->steps_per_degree);
    if (temperature_dc > INT16_MAX || temperature_dc < INT16_MIN) return FATHOM_ERR_MALFORMED;
    out->fahrenheit = raw;
    out->temperature_dc = (int16_t)temperature_dc;
    return FATHOM_READY;
}
