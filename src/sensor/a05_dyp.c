/* SPDX-License-Identifier: MIT */
/*
 * The driver of an A05 on RS-485 with `55 AA` frames. It describes its requests as Modbus reads, which dyp_client.c
 * turns into frames, and adds the command that sets the address.
 */
#include "fathom/sensor/a05_dyp.h"

#include "../common.h"
#include "fathom/codec/dyp_55aa.h"

/* Time-outs. The response for all probes arrives after 200 to 210 ms, for one probe after 65 to 75 ms (A05 2(3)1). */
#define ALL_PROBES_TIMEOUT_US 500000uL
#define ONE_PROBE_TIMEOUT_US  200000uL

enum { ALL_PROBES = 0x0F };

const fathom_model_facts_t fathom_a05_dyp_model = {
    .min_mm = 1, .max_mm = FATHOM_A05_MAX_MM, .period_ms = 100, /* A05 2(3)1 */
};

static bool is_one(uint8_t probes) { return (probes & (probes - 1u)) == 0u; }

fathom_status_t fathom_a05_dyp_init(fathom_a05_dyp_t *sensor, fathom_line_t *line,
                                    const fathom_a05_dyp_config_t *config)
{
    fathom_dyp_modbus_t *const base = &sensor->base;
    const fathom_modbus_t transport = fathom_dyp_client(line);
    fathom_a05_dyp_config_t zeroed;
    const fathom_status_t status = fathom_modbus_unit_begin(&base->unit, &transport, sensor, sizeof *sensor);
    if (status < 0) return status;
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    const uint8_t probes = (config->probes != 0u) ? config->probes : ALL_PROBES;
    if (config->modbus.address_zero || (probes > ALL_PROBES)) return FATHOM_ERR_ARGUMENT;
    /* Without room for the longest response, dyp_client.c refuses all requests. */
    if (!fathom_modbus_unit_has_room(&transport, FATHOM_DYP_MAX_RESPONSE)) return FATHOM_ERR_ARGUMENT;

    const bool is_single = is_one(probes);
    const uint8_t first = is_single ? fathom_dyp_first_probe(probes) : 1u;
    base->first = (uint16_t)(FATHOM_DYP_FIRST_REGISTER + (first - 1));
    base->count = is_single ? 1 : FATHOM_DYP_PROBES;
    base->measurement.values = sensor->values;
    base->start_us = config->start_us;
    base->measurement.facts = fathom_dyp_facts_or(config->model, &fathom_a05_dyp_model);
    base->measurement.model = FATHOM_A05;
    base->measurement.first = first;
    base->probes = probes;
    /* All probes take two and a half times as long as one. */
    const uint32_t one_us = fathom_dyp_us(base->measurement.facts->period_ms);
    return fathom_dyp_modbus_init(base, &transport, &config->modbus,
                                  is_single ? ONE_PROBE_TIMEOUT_US : ALL_PROBES_TIMEOUT_US,
                                  is_single ? one_us : ((one_us / 2u) * 5u));
}

void fathom_a05_dyp_deinit(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

void fathom_a05_dyp_power_on(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_power_on(&sensor->base); }

bool fathom_a05_dyp_is_written(const fathom_a05_dyp_t *sensor) { return sensor->base.unit.is_written; }

void fathom_a05_dyp_cancel(fathom_a05_dyp_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

/* Submits a request of either kind. It is the transport of the unit only during fathom_a05_dyp_broadcast_address(), so
 * nothing else can send the command that sets the address. */
static fathom_status_t submit_either(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    if (head[1] != FATHOM_MODBUS_WRITE_SINGLE_REGISTER) return fathom_dyp_client_submit(line, request);
    request->transaction.timeout_us = ONE_PROBE_TIMEOUT_US;
    return fathom_dyp_client_broadcast_address(line, request, head[5]);
}

/* Measures the first probe. If a unit responds, it is at the address of the request. */
static fathom_status_t read_address(const fathom_modbus_setting_t *setting, uint32_t *address)
{
    fathom_dyp_modbus_t *const base = setting->driver;
    uint16_t distance = 0;
    const fathom_status_t status = fathom_dyp_modbus_look(base, FATHOM_DYP_FIRST_REGISTER, &distance);
    *address = base->unit.address;
    return status;
}

fathom_status_t fathom_a05_dyp_broadcast_address(fathom_a05_dyp_t *sensor, uint8_t address)
{
    fathom_modbus_unit_t *const unit = &sensor->base.unit;
    fathom_modbus_setting_t setting;
    if ((address == FATHOM_LINE_ALL_UNITS) || (address == FATHOM_LINE_ANY_UNIT) ||
        (unit->transport.line == NULL) || fathom_modbus_is_next_unchecked(unit))
        return fathom_modbus_refuse_argument(unit);
    fathom_modbus_unit_poll(unit);
    fathom_dyp_modbus_describe(&sensor->base, &setting, FATHOM_DYP_REGISTER_ADDRESS, address);
    setting.read = read_address;
    setting.address = address;
    unit->transport.submit =
        submit_either; /* Only here may the command leave that sets the address of every A05. */
    const fathom_status_t status = fathom_modbus_set(unit, &setting);
    unit->transport.submit = fathom_dyp_client_submit;
    return status;
}

fathom_status_t fathom_a05_dyp_find(fathom_a05_dyp_find_t *find, fathom_line_t *line, uint8_t *address)
{
    fathom_modbus_request_t *const request = &find->request;
    if (!find->is_asked) {
        request->transaction.timeout_us = ONE_PROBE_TIMEOUT_US;
        fathom_modbus_read_holding_registers(&request->message, FATHOM_LINE_ANY_UNIT,
                                             FATHOM_DYP_FIRST_REGISTER, 1, &find->value);
        const fathom_status_t status = fathom_dyp_client_submit(line, request);
        if (status != FATHOM_PENDING) return status;
        find->is_asked = true;
    }
    (void)fathom_line_poll(line); /* A broken port ends the request. */
    if (request->transaction.status == FATHOM_PENDING) {
        if (fathom_line_is_queued(line, &request->transaction)) return FATHOM_PENDING;
        request->transaction.status = FATHOM_ERR_CANCELLED; /* The line was initialised again. */
    }
    find->is_asked = false;
    if (request->transaction.status == FATHOM_OK) *address = request->message.head[0];
    return (fathom_status_t)request->transaction.status;
}

void fathom_a05_dyp_find_cancel(fathom_a05_dyp_find_t *find, fathom_line_t *line)
{
    fathom_line_cancel(line, &find->request.transaction);
    find->is_asked = false;
}
