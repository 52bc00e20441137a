/* SPDX-License-Identifier: MIT */
#include "fathom/hps167s.h"

/* The commands that are reads: where, and with how many registers; the right length is part of the command. */
enum { VERSION_FIRST = 0x0001, VERSION_COUNT = 3 };
enum { DETAILS_FIRST = 0x0003, DETAILS_COUNT = 11, DETAILS_ACK = 0xB0 };
enum { MEASURE_FIRST = 0x0008, MEASURE_COUNT = 4 };

/* What a distance can say (#5). Over range is 65.53 m: the note has two decimals, so from 65530 to all ones,
 * which is the abnormal packet. */
#define MIN_MM         1u
#define MAX_MM         30000u
#define MIN_OVER_RANGE 65530u
#define FAILURE        65535u

enum { MAX_EXPONENT = 16, FIRST_YEAR = 2000 };

#define MEASURE_TIMEOUT_US 500000ul
#define COMMAND_TIMEOUT_US 1000000ul

static uint8_t high(uint16_t value) { return (uint8_t)(value >> 8); }
static uint8_t low(uint16_t value) { return (uint8_t)value; }

fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_hps167s_config_t *config)
{
    fathom_modbus_question_t *const question = &sensor->question;
    if (config->address > FATHOM_HPS167S_MAX_ADDRESS) return FATHOM_ERR_ARGUMENT;
    question->timeout_us = config->timeout_us != 0 ? config->timeout_us : MEASURE_TIMEOUT_US;
    question->pace_us = FATHOM_HPS167S_MIN_PERIOD_US;
    if (config->period_us > question->pace_us) question->pace_us = config->period_us;
    question->values = sensor->values;
    question->first = MEASURE_FIRST;
    question->count = MEASURE_COUNT;
    question->retries = config->retries;
    question->backoff_us = config->backoff_us;
    question->settings = config->settings;
    question->is_command = false;
    question->function = 0;
    sensor->sequence = 0;
    sensor->implausible = 0;
    return fathom_modbus_unit_init(&sensor->unit, config->modbus, config->clock,
                                   config->address != 0 ? config->address : 1);
}

void fathom_hps167s_deinit(fathom_hps167s_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

void fathom_hps167s_cancel(fathom_hps167s_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample)
{
    const uint16_t raw = registers[0];
    const uint8_t exponent = high(registers[2]);
    const bool is_target = raw >= MIN_MM && raw <= MAX_MM;
    uint32_t magnitude = 0;
    if (raw != FAILURE) {
        if (!is_target && raw < MIN_OVER_RANGE) return FATHOM_ERR_MALFORMED;
        if (exponent > MAX_EXPONENT) return FATHOM_ERR_MALFORMED;
        magnitude = (uint32_t)registers[1] << exponent;
    }
    /* The abnormal packet has ones in ambient and precision too, but a distance of all ones is none either way. */
    sample->kind = is_target ? FATHOM_TARGET : raw == FAILURE ? FATHOM_FAULT : FATHOM_NO_TARGET;
    sample->raw = raw;
    sample->distance_mm = is_target ? raw : 0;
    sample->magnitude = magnitude;
    sample->ambient = low(registers[2]);
    sample->precision = registers[3];
    sample->interference = false;
    return FATHOM_READY;
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167s_t *const sensor = ctx;
    fathom_status_t status = fathom_modbus_unit_ask(&sensor->unit, &sensor->question);
    if (status != FATHOM_READY) return status;
    status = fathom_hps167s_decode(sensor->values, sample);
    if (status != FATHOM_READY) {
        if (sensor->implausible != UINT16_MAX) sensor->implausible++;
        return status;
    }
    sample->time_us = sensor->unit.heard_us;
    sample->sequence = ++sensor->sequence;
    sample->model = FATHOM_HPS167S;
    sample->unit = sensor->unit.address;
    sample->probe = 1;
    return FATHOM_READY;
}

static uint32_t due_us(void *ctx)
{
    const fathom_hps167s_t *const sensor = ctx;
    return fathom_modbus_unit_due_us(&sensor->unit);
}

fathom_sensor_t fathom_hps167s_sensor(fathom_hps167s_t *sensor)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = sensor;
    return handle;
}

static fathom_status_t command(fathom_hps167s_t *sensor, uint16_t first, uint8_t count)
{
    fathom_modbus_question_t question = sensor->question;
    question.timeout_us = COMMAND_TIMEOUT_US;
    question.first = first;
    question.count = count;
    question.is_command = true;
    return fathom_modbus_unit_ask(&sensor->unit, &question);
}

fathom_status_t fathom_hps167s_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out)
{
    const uint16_t *const values = sensor->values;
    const fathom_status_t status = command(sensor, VERSION_FIRST, VERSION_COUNT);
    if (status != FATHOM_READY) return status;
    out->year = (uint16_t)(FIRST_YEAR + high(values[0]));
    out->month = low(values[0]);
    out->day = high(values[1]);
    out->major = low(values[1]);
    out->minor = high(values[2]);
    out->revision = low(values[2]);
    return FATHOM_READY;
}

/* The answer's bytes are the ACK byte, so that what follows stands across the registers. */
fathom_status_t fathom_hps167s_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out)
{
    const uint16_t *values = sensor->values;
    const fathom_status_t status = command(sensor, DETAILS_FIRST, DETAILS_COUNT);
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
