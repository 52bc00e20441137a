/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s_info.h"

#include "hps167s_internal.h"

enum { SAME_RESPONSES = 2, MAX_RESPONSES = 8, RESPONSES_AMONG_UNASKED = 3 };

/* For so long after an unasked frame another one is to be expected. */
#define UNASKED_US 2000000uL

/* No response to #2, whose first byte is 00 or FF: nothing has been measured. */
#define NOTHING 0x0101u

static fathom_status_t read_command(fathom_hps167s_t *sensor, uint8_t command, uint8_t count)
{
    fathom_modbus_unit_poll(&sensor->unit);
    return fathom_hps167s_ask_once(sensor, command, count);
}

fathom_status_t fathom_hps167s_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT);
    if (status == FATHOM_READY) fathom_hps167s_decode_version(sensor->values, out);
    return status;
}

/* ---- #2 ---- */

static bool same_4(const uint16_t *a, const uint16_t *b)
{
    uint8_t i = 0;
    while ((i != 4u) && (a[i] == b[i])) i++;
    return i == 4u;
}

/* Not where it equals the last response to #2: that may have come late. */
static bool is_new(fathom_hps167s_t *sensor)
{
    if (same_4(sensor->measurement, sensor->last_configuration)) return false;
    copy_4(sensor->last_measurement, sensor->measurement);
    return true;
}

/* From the first time on that #2 matters, all measurements are compared; what was measured before is still there.
 * Without a response to #2 yet that is all 0, a distance that is refused anyway. */
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

bool fathom_hps167s_heard(fathom_hps167s_t *sensor, const uint16_t registers[4], uint32_t time_us)
{
    be_wary(sensor);
    be_among_unasked(sensor, time_us);
    if (same_4(registers, sensor->last_configuration)) {
        /* Was this frame taken for a response before? Not if a response is still to come. */
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

/* A frame of the right shape has come: do enough agree now? One that is a measurement counts neither way. */
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
    /* A request in step with what the device sends by itself would get an unasked frame each time. */
    if (sensor->is_among_unasked)
        unit->pause_us += (uint32_t)(((2u * sensor->responses) + 1u) * (FATHOM_HPS167S_MIN_PERIOD_US / 2u));
    return false;
}

/* It gives up. Where an unasked frame was taken for a response, a response is still to come, and has the shape of a
 * measurement: until it cannot come any more there is no outcome, or another driver's next request would meet it. */
static fathom_status_t give_up(const fathom_hps167s_t *sensor)
{
    return (sensor->is_outstanding && (sensor->unit.pause_us != 0u)) ? FATHOM_PENDING : FATHOM_ERR_MALFORMED;
}

fathom_status_t fathom_hps167s_read_configuration(fathom_hps167s_t *sensor)
{
    fathom_status_t status;
    be_wary(sensor);
    for (;;) {
        status = (sensor->responses == MAX_RESPONSES)
                     ? give_up(sensor)
                     : fathom_hps167s_ask_once(sensor, FATHOM_HPS167S_CONFIGURATION,
                                               FATHOM_HPS167S_CONFIGURATION_COUNT);
        if ((status == FATHOM_PENDING) || (status == FATHOM_ERR_BUSY)) return status;
        if ((status != FATHOM_READY) || is_believed(sensor)) break;
        if (sensor->responses == MAX_RESPONSES) sensor->unit.pause_us = sensor->unit.command_timeout_us;
    }
    sensor->responses = 0;
    return status;
}

fathom_status_t fathom_hps167s_configuration(fathom_hps167s_t *sensor, fathom_hps167s_configuration_t *out)
{
    fathom_modbus_unit_poll(&sensor->unit);
    const fathom_status_t status = fathom_hps167s_read_configuration(sensor);
    if (status == FATHOM_READY)
        fathom_hps167s_decode_configuration(sensor->values, sensor->low_word_first, out);
    return status;
}

/* ---- #3, #4 ---- */

fathom_status_t fathom_hps167s_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT);
    if (status != FATHOM_READY) return status;
    if (!fathom_hps167s_may_be_details(sensor->values)) return FATHOM_ERR_MALFORMED;
    fathom_hps167s_decode_details(sensor->values, out);
    return FATHOM_READY;
}

fathom_status_t fathom_hps167s_temperature(fathom_hps167s_t *sensor, fathom_hps167s_temperature_t *out)
{
    const fathom_status_t status = read_command(sensor, FATHOM_HPS167S_TEMPERATURE, 1);
    if (status != FATHOM_READY) return status;
    const int16_t raw = fathom_hps167s_signed(sensor->values[0]);
    const int32_t temperature_dc =
        fathom_hps167s_temperature_dc(raw, (sensor->steps_per_degree != 0u) ? sensor->steps_per_degree : 1u);
    if ((temperature_dc > INT16_MAX) || (temperature_dc < INT16_MIN)) return FATHOM_ERR_MALFORMED;
    out->fahrenheit = raw;
    out->temperature_dc = (int16_t)temperature_dc;
    return FATHOM_READY;
}
