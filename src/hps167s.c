/* SPDX-License-Identifier: MIT */
#include "fathom/hps167s.h"

#include "hps167s_inside.h"

enum { MEASURE_FIRST = 0x0008, MEASURE_COUNT = 4 };

/* What a distance can say (#5). Over range is 65.53 m: the note has two decimals, so from 65530 to all ones,
 * which is the abnormal packet. */
#define MIN_MM         80u
#define MAX_MM         30000u
#define MIN_OVER_RANGE 65530u
#define FAILURE        65535u

enum { MAX_EXPONENT = 16, SAME_ANSWERS = 2, MAX_SAME_ANSWERS = 8 };

#define MEASURE_TIMEOUT_US 500000ul

/* No answer to #2: its first byte is 00 or FF. */
#define NEVER_TOLD 0x0101u

fathom_status_t fathom_hps167s_set_limits(fathom_hps167s_limits_t *limits,
                                          const fathom_hps167s_limits_t *wanted)
{
    limits->max_mm = wanted->max_mm != 0 ? wanted->max_mm : MAX_MM;
    limits->over_range_mm = wanted->over_range_mm != 0 ? wanted->over_range_mm : MIN_OVER_RANGE;
    limits->min_mm = wanted->min_mm != 0 ? wanted->min_mm : MIN_MM;
    const bool is_good = limits->min_mm <= limits->max_mm && limits->max_mm < limits->over_range_mm &&
                         limits->over_range_mm < FAILURE;
    return is_good ? FATHOM_READY : FATHOM_ERR_ARGUMENT;
}

void fathom_hps167s_expect_warm_up(fathom_hps167s_t *sensor, uint8_t warm_up_s)
{
    sensor->warm_us = (uint32_t)(warm_up_s * 1000000ul) + sensor->question.timeout_us;
}

fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_hps167s_config_t *config)
{
    fathom_modbus_question_t *const question = &sensor->question;
    if (config->address > FATHOM_HPS167S_MAX_ADDRESS || config->same_answers > MAX_SAME_ANSWERS ||
        fathom_hps167s_set_limits(&sensor->limits, &config->limits) < 0)
        return FATHOM_ERR_ARGUMENT;
    question->timeout_us = config->timeout_us != 0 ? config->timeout_us : MEASURE_TIMEOUT_US;
    sensor->command_timeout_us = config->command_timeout_us;
    if (sensor->command_timeout_us == 0)
        sensor->command_timeout_us = FATHOM_HPS167S_DEFAULT_COMMAND_TIMEOUT_US;
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
    uint8_t warm_up_s = config->warm_up_s;
    if (warm_up_s == 0 && !config->no_warm_up) warm_up_s = FATHOM_HPS167S_FACTORY_WARM_UP_S;
    fathom_hps167s_expect_warm_up(sensor, warm_up_s);
    sensor->sequence = 0;
    sensor->implausible = 0;
    sensor->told[0] = NEVER_TOLD;
    sensor->measured[0] = NEVER_TOLD;
    sensor->answers = 0;
    sensor->is_owed = false;
    sensor->same_answers = config->same_answers != 0 ? config->same_answers : SAME_ANSWERS;
    sensor->steps_per_degree = config->steps_per_degree != 0 ? config->steps_per_degree : 1;
    sensor->low_word_first = config->low_word_first;
    sensor->is_seeking = false;
    sensor->reset_answer = FATHOM_HPS167S_NO_RESET_ANSWER;
    sensor->next_baud = 0;
    const fathom_status_t status = fathom_modbus_unit_init(&sensor->unit, config->modbus, config->clock,
                                                           config->address != 0 ? config->address : 1);
    if (status == FATHOM_READY)
        sensor->unasked_us = (uint32_t)(sensor->unit.polled_us - FATHOM_HPS167S_UNASKED_US);
    return status;
}

void fathom_hps167s_deinit(fathom_hps167s_t *sensor) { fathom_hps167s_cancel(sensor); }

void fathom_hps167s_cancel(fathom_hps167s_t *sensor)
{
    sensor->answers = 0;
    fathom_modbus_unit_cancel(&sensor->unit);
}

const fathom_line_settings_t *fathom_hps167s_here(const fathom_hps167s_t *sensor)
{
    const fathom_modbus_unit_t *const unit = &sensor->unit;
    const fathom_line_settings_t *const moved = unit->setting != 0 ? unit->home_settings : unit->settings;
    return moved != NULL ? moved : sensor->question.settings;
}

const fathom_line_settings_t *fathom_hps167s_with_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const fathom_line_settings_t *const here = fathom_hps167s_here(sensor);
    fathom_line_settings_t *const there = &sensor->moved[here == &sensor->moved[0] ? 1 : 0];
    there->baud = baud;
    there->parity = here->parity;
    there->stop_bits = here->stop_bits;
    return there;
}

/* Changes over to the other place where the device may be. */
static void change_over(fathom_hps167s_t *sensor)
{
    const fathom_line_settings_t *const here = sensor->unit.settings;
    sensor->unit.settings = sensor->other;
    sensor->other = here;
}

void fathom_hps167s_power_on(fathom_hps167s_t *sensor)
{
    sensor->answers = 0;
    fathom_modbus_unit_power_on(&sensor->unit, sensor->warm_us);
    if (sensor->next_baud == 0) return;
    sensor->other = fathom_hps167s_with_baud(sensor, sensor->next_baud);
    sensor->next_baud = 0;
    sensor->is_seeking = true;
    change_over(sensor);
}

/* A question has ended: does it tell where the device is? No setting begins before that is known. */
static void learn(fathom_hps167s_t *sensor, fathom_status_t status)
{
    if (!sensor->is_seeking) return;
    if (status == FATHOM_ERR_WARMING_UP) status = (fathom_status_t)sensor->unit.request.exchange.status;
    if (status == FATHOM_READY || status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_MALFORMED)
        sensor->is_seeking = false;
    else if (status == FATHOM_ERR_NO_ANSWER || status == FATHOM_ERR_CHECKSUM)
        change_over(sensor);
}

static fathom_status_t ask(fathom_hps167s_t *sensor, const fathom_modbus_question_t *question)
{
    const fathom_status_t status = fathom_modbus_unit_ask(&sensor->unit, question);
    learn(sensor, status);
    return status;
}

void fathom_hps167s_describe(const fathom_hps167s_t *sensor, uint16_t first,
                             fathom_modbus_question_t *question)
{
    *question = sensor->question; /* pace, back-off and line settings are the same */
    question->timeout_us = sensor->command_timeout_us;
    question->first = first;
    question->is_command = true;
}

fathom_status_t fathom_hps167s_command(fathom_hps167s_t *sensor, uint16_t first, uint8_t count)
{
    fathom_modbus_question_t question;
    fathom_hps167s_describe(sensor, first, &question);
    question.count = count;
    return ask(sensor, &question);
}

bool fathom_hps167s_has_asked(const fathom_hps167s_t *sensor, uint16_t first)
{
    fathom_modbus_question_t question;
    fathom_hps167s_describe(sensor, first, &question);
    return sensor->unit.asked == fathom_modbus_unit_name(&question);
}

bool fathom_hps167s_is_abnormal(const uint16_t registers[4])
{
    return registers[0] == FAILURE && registers[1] == 0 && low(registers[2]) == 0xFF &&
           registers[3] == 0xFFFF;
}

fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample)
{
    const uint16_t raw = registers[0];
    const uint8_t exponent = high(registers[2]);
    uint8_t kind = FATHOM_FAULT;
    uint32_t magnitude = 0;
    if (!fathom_hps167s_is_abnormal(registers)) {
        const bool is_over = raw >= limits->over_range_mm;
        if (raw == 0 || raw == FAILURE || exponent > MAX_EXPONENT) return FATHOM_ERR_MALFORMED;
        if (raw > limits->max_mm && !is_over) return FATHOM_ERR_MALFORMED;
        kind = is_over ? FATHOM_NO_TARGET : raw < limits->min_mm ? FATHOM_UNKNOWN : FATHOM_TARGET;
        magnitude = (uint32_t)registers[1] << exponent;
    }
    sample->kind = kind;
    sample->raw = raw;
    sample->distance_mm = kind == FATHOM_TARGET ? raw : 0;
    sample->magnitude = magnitude;
    sample->ambient = low(registers[2]);
    sample->precision = registers[3];
    sample->interference = false;
    return FATHOM_READY;
}

fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample)
{
    fathom_hps167s_limits_t limits;
    limits.max_mm = MAX_MM;
    limits.over_range_mm = MIN_OVER_RANGE;
    limits.min_mm = MIN_MM;
    return fathom_hps167s_decode_within(&limits, registers, sample);
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167s_t *const sensor = ctx;
    const uint16_t *const values = sensor->values;
    fathom_status_t status = ask(sensor, &sensor->question);
    if (status != FATHOM_READY) return status;
    if (fathom_modbus_unit_is_warming_up(&sensor->unit) && fathom_hps167s_is_abnormal(values))
        return FATHOM_ERR_WARMING_UP;
    status = FATHOM_ERR_MALFORMED;
    /* The very answer to #2 again: it came late. */
    if (!same_4(values, sensor->told)) status = fathom_hps167s_decode_within(&sensor->limits, values, sample);
    if (status != FATHOM_READY) {
        if (sensor->implausible != UINT16_MAX) sensor->implausible++;
        return status;
    }
    copy_4(sensor->measured, values);
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
