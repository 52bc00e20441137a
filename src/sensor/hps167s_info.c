/* SPDX-License-Identifier: MIT */
/*
 * The commands #1 to #4 of the HPS-167S. Most of this file is about #2, whose response has the shape of a measurement.
 */
#include "fathom/sensor/hps167s_info.h"

#include "hps167s_internal.h"

/* Equal responses to #2 in succession that are needed by default, and among unsolicited frames. */
enum { SAME_RESPONSES = 2, RESPONSES_AMONG_UNASKED = 3 };

/* The number of reads after which #2 is given up; among unsolicited frames most reads meet one of these. */
enum { MAX_RESPONSES = 8, MAX_RESPONSES_AMONG_UNASKED = 32 };

/* Time after an unsolicited frame in which another one is expected, in microseconds. */
#define UNASKED_US 2000000uL

/* Stands for "no measurement yet": it equals no response to #2, whose first byte is 00 or FF. */
#define NOTHING 0x0101u

fathom_status_t fathom_hps167s_ask_once(fathom_hps167s_t *sensor, uint8_t command, uint8_t count)
{
    fathom_modbus_unit_request_t request;
    request.values = sensor->values;
    request.first = command;
    request.last = count;
    request.function = FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    request.id = fathom_hps167s_id(command);
    const fathom_status_t status = fathom_modbus_command(&sensor->unit, &request);
    fathom_hps167s_follow(sensor, status);
    return status;
}

static fathom_status_t read_command(fathom_hps167s_t *sensor, uint8_t command, uint8_t count)
{
    fathom_modbus_unit_poll(&sensor->unit);
    return fathom_hps167s_ask_once(sensor, command, count);
}

fathom_status_t fathom_hps167s_get_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT);
    if (status == FATHOM_OK) fathom_hps167s_decode_version(sensor->values, out);
    return status;
}

/* ---- #2 ---- */

static bool same_4(const uint16_t *a, const uint16_t *b)
{
    uint8_t i = 0;
    while ((i != 4u) && (a[i] == b[i])) i++;
    return i == 4u;
}

/* Returns true if the newest response to #5 is a measurement. One that equals the newest response to #2 may be a late
 * response to #2. */
static bool is_new(fathom_hps167s_t *sensor)
{
    if (same_4(sensor->measurement, sensor->last_configuration)) return false;
    copy_4(sensor->last_measurement, sensor->measurement);
    return true;
}

/*
 * Compares all measurements with #2 from now on. A program that never reads #2 does not link the comparison.
 *
 * The newest measurement is still in `measurement`. Without a response to #2, `last_configuration` is all 0. That
 * equals no measurement, because a distance of 0 is refused anyway.
 */
static void be_wary(fathom_hps167s_t *sensor)
{
    if (sensor->is_new != NULL) return;
    sensor->is_new = is_new;
    copy_4(sensor->last_measurement, sensor->measurement);
    if (sensor->measurement[0] == 0u) sensor->last_measurement[0] = NOTHING;
}

static void be_among_unasked(fathom_hps167s_t *sensor, uint32_t time_us)
{
    sensor->unasked_us = time_us;
    sensor->is_among_unasked = true;
}

bool fathom_hps167s_accept_unsolicited(fathom_hps167s_t *sensor, const uint16_t registers[4],
                                       uint32_t time_us)
{
    be_wary(sensor);
    be_among_unasked(sensor, time_us);
    if (same_4(registers, sensor->last_configuration)) {
        /* An earlier frame like this one may have been mistaken for a response, unless a response is still to come. */
        if (!sensor->is_outstanding) sensor->agreed = 0;
        sensor->is_outstanding = false;
        return false;
    }
    if ((sensor->unit.current == fathom_hps167s_id(FATHOM_HPS167S_CONFIGURATION)) &&
        fathom_hps167s_may_be_configuration(registers))
        return false;
    copy_4(sensor->last_measurement, registers);
    return true;
}

/*
 * The pause before the next read among unsolicited frames, up to 131 ms.
 *
 * With equal pauses, the period of a slow loop and that of the sensor could keep step: then each request would leave
 * just before an unsolicited frame, and this frame would be mistaken for the response. So the pause follows from the
 * low bits of the clock. 40503 is 2^16 divided by the golden ratio, and odd.
 */
static uint32_t drawn_pause_us(const fathom_modbus_unit_t *unit)
{
    return ((unit->polled_us * 40503u) & UINT16_MAX) * 2u;
}

/* Evaluates the newest frame with the shape of #2. Returns true if enough equal responses have arrived in succession. A
 * frame that is a measurement neither counts nor starts the count again. */
static bool is_believed(fathom_hps167s_t *sensor)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    const uint16_t *const values = sensor->values;
    uint8_t needed = (sensor->same_responses != 0u) ? sensor->same_responses : SAME_RESPONSES;
    if (sensor->responses++ == 0u) sensor->agreed = 0;
    if (!fathom_hps167s_may_be_configuration(values) || same_4(values, sensor->last_measurement)) {
        copy_4(sensor->last_measurement, values);
        be_among_unasked(sensor, unit->polled_us);
        sensor->is_outstanding = true;
    } else {
        if (!same_4(values, sensor->last_configuration)) sensor->agreed = 0;
        copy_4(sensor->last_configuration, values);
        sensor->agreed++;
    }
    if (fathom_elapsed_us(unit->polled_us, sensor->unasked_us) >= UNASKED_US)
        sensor->is_among_unasked = false;
    if (sensor->is_among_unasked && (needed < RESPONSES_AMONG_UNASKED)) needed = RESPONSES_AMONG_UNASKED;
    if (sensor->agreed >= needed) return true;
    if (sensor->is_among_unasked) unit->pause_us += drawn_pause_us(unit);
    return false;
}

static bool is_given_up(const fathom_hps167s_t *sensor)
{
    return sensor->responses >= (sensor->is_among_unasked ? MAX_RESPONSES_AMONG_UNASKED : MAX_RESPONSES);
}

enum { CONFIGURATION = FATHOM_MODBUS_COMMAND | FATHOM_HPS167S_CONFIGURATION };

/*
 * The read is given up. If an unsolicited frame was mistaken for a response, the response may still arrive, and it has
 * the shape of a measurement. The read stays in progress until the response can no longer arrive; else the next
 * request would receive it. Measurements wait meanwhile, because the pause after each of them would delay the end.
 */
static fathom_status_t give_up(fathom_hps167s_t *sensor)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    unit->command = 0;
    if (!sensor->is_outstanding || (unit->pause_us == 0u)) return FATHOM_ERR_MALFORMED;
    unit->command = CONFIGURATION;
    fathom_modbus_command_keep(unit);
    return FATHOM_PENDING;
}

fathom_status_t fathom_hps167s_read_configuration(fathom_hps167s_t *sensor)
{
    fathom_status_t status;
    be_wary(sensor);
    if (sensor->unit.command != CONFIGURATION) sensor->responses = 0; /* The previous read was abandoned. */
    for (;;) {
        status = is_given_up(sensor) ? give_up(sensor)
                                     : fathom_hps167s_ask_once(sensor, FATHOM_HPS167S_CONFIGURATION,
                                                               FATHOM_HPS167S_CONFIGURATION_COUNT);
        if ((status == FATHOM_PENDING) || (status == FATHOM_ERR_BUSY)) return status;
        if ((status != FATHOM_OK) || is_believed(sensor)) break;
        if (is_given_up(sensor)) sensor->unit.pause_us = sensor->unit.command_timeout_us;
    }
    sensor->responses = 0;
    return status;
}

fathom_status_t fathom_hps167s_get_configuration(fathom_hps167s_t *sensor,
                                                 fathom_hps167s_configuration_t *out)
{
    fathom_modbus_unit_poll(&sensor->unit);
    const fathom_status_t status = fathom_hps167s_read_configuration(sensor);
    if (status == FATHOM_OK) fathom_hps167s_decode_configuration(sensor->values, sensor->low_word_first, out);
    return status;
}

/* ---- #3, #4 ---- */

fathom_status_t fathom_hps167s_get_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT);
    if (status != FATHOM_OK) return status;
    if (!fathom_hps167s_may_be_details(sensor->values)) return FATHOM_ERR_MALFORMED;
    fathom_hps167s_decode_details(sensor->values, out);
    return FATHOM_OK;
}

fathom_status_t fathom_hps167s_get_temperature(fathom_hps167s_t *sensor, fathom_hps167s_temperature_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_TEMPERATURE, 1);
    if (status != FATHOM_OK) return status;
    const int16_t raw = fathom_hps167s_to_signed(sensor->values[0]);
    const int32_t temperature_dc =
        fathom_hps167s_temperature_dc(raw, (sensor->steps_per_degree != 0u) ? sensor->steps_per_degree : 1u);
    if ((temperature_dc > INT16_MAX) || (temperature_dc < INT16_MIN)) return FATHOM_ERR_MALFORMED;
    out->fahrenheit = raw;
    out->temperature_dc = (int16_t)temperature_dc;
    return FATHOM_OK;
}
