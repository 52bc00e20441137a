/* SPDX-License-Identifier: MIT */
/*
 * The driver of the HPS-167S, as far as it measures: init, poll, power-on and cancel. hps167s_info.c,
 * hps167s_settings.c and hps167s_auto.c add the other commands, the settings and the listener.
 */
#include "fathom/sensor/hps167s.h"

#include "hps167s_internal.h"

/* MEASUREMENT_LENGTH is that of the response to #5: address, function, byte count, 4 registers and CRC. */
enum { MAX_SAME_RESPONSES = 8, MEASUREMENT_LENGTH = 5 + (2 * FATHOM_HPS167S_MEASUREMENT_COUNT) };

#define MEASURE_TIMEOUT_US 500000uL

static bool is_valid(const fathom_modbus_t *transport, const fathom_hps167s_config_t *config)
{
    return (config->modbus.address <= FATHOM_HPS167S_MAX_ADDRESS) && !config->modbus.address_zero &&
           (config->same_responses <= MAX_SAME_RESPONSES) &&
           fathom_modbus_unit_has_room(transport, MEASUREMENT_LENGTH);
}

fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_modbus_t *transport,
                                    const fathom_hps167s_config_t *config)
{
    fathom_hps167s_config_t zeroed;
    fathom_status_t status = fathom_modbus_unit_begin(&sensor->unit, transport, sensor, sizeof *sensor);
    if (status < 0) return status;
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    if (!is_valid(transport, config)) return FATHOM_ERR_ARGUMENT;
    sensor->warm_up_s = config->warm_up_s;
    if ((config->warm_up_s == 0u) && !config->no_warm_up)
        sensor->warm_up_s = FATHOM_HPS167S_FACTORY_WARM_UP_S;
    sensor->same_responses = config->same_responses;
    sensor->steps_per_degree = config->steps_per_degree;
    sensor->low_word_first = config->low_word_first;
    sensor->reset_response = FATHOM_HPS167S_NO_RESET_RESPONSE;
    status = fathom_modbus_unit_init(&sensor->unit, transport, &config->modbus, MEASURE_TIMEOUT_US,
                                     FATHOM_HPS167S_MIN_PERIOD_US);
    if (status < 0) clear(sensor, sizeof *sensor);
    return status;
}

fathom_status_t fathom_hps167s_set_limits(fathom_hps167s_t *sensor, fathom_hps167s_limits_t *limits)
{
    const fathom_status_t status = fathom_hps167s_complete_limits(limits);
    if (status == FATHOM_OK) sensor->limits = limits;
    return status;
}

void fathom_hps167s_deinit(fathom_hps167s_t *sensor) { fathom_hps167s_cancel(sensor); }

void fathom_hps167s_cancel(fathom_hps167s_t *sensor)
{
    sensor->responses = 0;
    fathom_modbus_unit_cancel(&sensor->unit);
}

void fathom_hps167s_power_on(fathom_hps167s_t *sensor)
{
    const uint32_t warm_us = (uint32_t)(sensor->warm_up_s * 1000000uL) + sensor->unit.timeout_us;
    sensor->responses = 0;
    fathom_modbus_unit_power_on(&sensor->unit, warm_us);
    if (sensor->follow != NULL) sensor->follow(sensor, FATHOM_PENDING);
}

fathom_status_t fathom_hps167s_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167s_t *const sensor = ctx;
    fathom_modbus_unit_poll(&sensor->unit);
    const fathom_status_t status = fathom_modbus_unit_measure(
        &sensor->unit, FATHOM_HPS167S_MEASUREMENT, FATHOM_HPS167S_MEASUREMENT_COUNT, sensor->measurement);
    fathom_hps167s_follow(sensor, status);
    if (status != FATHOM_OK) return status;
    if (fathom_modbus_unit_is_warming_up(&sensor->unit) && fathom_hps167s_is_abnormal(sensor->measurement))
        return FATHOM_ERR_WARMING_UP;
    if (((sensor->is_new != NULL) && !sensor->is_new(sensor)) ||
        (fathom_hps167s_decode_within(sensor->limits, sensor->measurement, sample) < 0)) {
        count_one(&sensor->implausible);
        return FATHOM_ERR_MALFORMED;
    }
    sample->time_us = fathom_modbus_unit_heard_us(&sensor->unit);
    sensor->sequence++;
    sample->sequence = sensor->sequence;
    sample->model = FATHOM_HPS167S;
    sample->address = sensor->unit.address;
    sample->probe = 1;
    return FATHOM_OK;
}

uint32_t fathom_hps167s_sensor_due_us(void *ctx)
{
    const fathom_hps167s_t *const sensor = ctx;
    return fathom_modbus_unit_due_us(&sensor->unit);
}
