/* SPDX-License-Identifier: MIT */
#include "fathom/a05_dyp.h"

/* The answer comes after 200..210 or 65..75 ms (A05 2(3)1). */
#define ALL_PROBES_TIMEOUT_US 500000ul
#define ONE_PROBE_TIMEOUT_US  200000ul

enum { ALL_PROBES = 0x0F };

static bool is_one(uint8_t probes) { return (probes & (probes - 1)) == 0; }

fathom_status_t fathom_a05_dyp_init(fathom_a05_dyp_t *sensor, const fathom_a05_dyp_config_t *config)
{
    fathom_dyp_modbus_t *const base = &sensor->base;
    fathom_modbus_question_t *const question = &base->question;
    const uint8_t probes = config->probes != 0 ? config->probes : ALL_PROBES;
    if (config->line == NULL || probes > ALL_PROBES) return FATHOM_ERR_ARGUMENT;

    uint8_t first = 0;
    question->count = FATHOM_DYP_PROBES;
    question->timeout_us = ALL_PROBES_TIMEOUT_US;
    question->pace_us = FATHOM_A05_DYP_ALL_PROBES_US;
    if (is_one(probes)) {
        while ((probes >> first & 1) == 0) first++;
        question->count = 1;
        question->timeout_us = ONE_PROBE_TIMEOUT_US;
        question->pace_us = FATHOM_A05_DYP_ONE_PROBE_US;
    }
    if (config->timeout_us != 0) question->timeout_us = config->timeout_us;
    if (config->period_us > question->pace_us) question->pace_us = config->period_us;
    question->first = (uint16_t)(FATHOM_DYP_FIRST_REGISTER + first);
    question->retries = config->retries;
    question->backoff_us = config->backoff_us;
    question->settings = config->settings;
    base->answer.values = sensor->values;
    base->command_timeout_us = config->command_timeout_us;
    base->start_us = config->start_us;
    fathom_dyp_window_copy(&base->answer.window, &config->window);
    base->answer.model = FATHOM_A05;
    base->answer.first = (uint8_t)(first + 1);
    base->probes = probes;
    sensor->client = fathom_dyp_client(config->line);
    return fathom_dyp_modbus_init(base, &sensor->client, config->line->config->clock,
                                  config->address != 0 ? config->address : 1, FATHOM_A05_MAX_MM);
}

void fathom_a05_dyp_deinit(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

fathom_sensor_t fathom_a05_dyp_sensor(fathom_a05_dyp_t *sensor)
{
    return fathom_dyp_modbus_sensor(&sensor->base);
}

void fathom_a05_dyp_power_on(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_power_on(&sensor->base); }

bool fathom_a05_dyp_is_written(const fathom_a05_dyp_t *sensor) { return sensor->base.unit.is_written; }

void fathom_a05_dyp_cancel(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

/* The driver's seam to the line while the address is being set, and at no other time: so nothing else can send the
 * command. */
static fathom_status_t submit_either(void *ctx, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    if (head[1] != FATHOM_MODBUS_WRITE_SINGLE_REGISTER) return fathom_dyp_client_submit(ctx, request);
    return fathom_dyp_client_set_every_address(ctx, request, head[5]);
}

/* Measures the first probe; whoever answers is at the address that was asked. */
static fathom_status_t read_address(void *driver, uint32_t *address)
{
    fathom_a05_dyp_t *const sensor = driver;
    uint16_t distance = 0;
    const fathom_status_t status = fathom_dyp_modbus_get(&sensor->base, FATHOM_DYP_FIRST_REGISTER, &distance);
    *address = sensor->base.unit.address;
    return status;
}

fathom_status_t fathom_a05_dyp_set_every_address(fathom_a05_dyp_t *sensor, uint8_t address)
{
    uint16_t value = address;
    fathom_modbus_question_t write = sensor->base.question;
    fathom_modbus_setting_t setting;
    if (address == FATHOM_LINE_ALL_UNITS || address == FATHOM_LINE_ANY_UNIT || sensor->base.unit.is_blind)
        return FATHOM_ERR_ARGUMENT;
    write.timeout_us = ONE_PROBE_TIMEOUT_US;
    write.values = &value;
    write.first = FATHOM_DYP_REGISTER_ADDRESS;
    write.count = 1;
    write.retries = 0;
    write.is_command = true;
    write.function = FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    setting.read = read_address;
    setting.driver = sensor;
    setting.write = &write;
    setting.value = address;
    setting.settings = NULL;
    setting.address = address;
    sensor->client.submit = submit_either;
    const fathom_status_t status = fathom_modbus_set(&sensor->base.unit, &setting);
    sensor->client = fathom_dyp_client(sensor->client.ctx);
    return status;
}

fathom_status_t fathom_a05_dyp_find(fathom_a05_dyp_find_t *find, fathom_line_t *line, uint8_t *address)
{
    fathom_modbus_request_t *const request = &find->request;
    if (!find->is_asked) {
        request->exchange.timeout_us = ONE_PROBE_TIMEOUT_US;
        fathom_modbus_read_holding_registers(&request->message, FATHOM_LINE_ANY_UNIT,
                                             FATHOM_DYP_FIRST_REGISTER, 1, &find->value);
        const fathom_status_t status = fathom_dyp_client_submit(line, request);
        if (status != FATHOM_PENDING) return status;
        find->is_asked = true;
    }
    (void)fathom_line_poll(line); /* a broken port ends the request */
    if (request->exchange.status == FATHOM_PENDING) return FATHOM_PENDING;
    find->is_asked = false;
    if (request->exchange.status == FATHOM_READY) *address = request->message.head[0];
    return (fathom_status_t)request->exchange.status;
}

void fathom_a05_dyp_find_cancel(fathom_a05_dyp_find_t *find, fathom_line_t *line)
{
    fathom_line_cancel(line, &find->request.exchange);
    find->is_asked = false;
}
