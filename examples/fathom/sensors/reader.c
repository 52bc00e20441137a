/* SPDX-License-Identifier: MIT */
#include "sensors/reader.h"

#include <stdlib.h>
#include <string.h>

#include "fathom/engine/internal/modbus_setting.h"
#include "output/words.h"
#include "sensors/driver.h"

/* ---- open and close ---- */

bool reader_open(reader_t **reader, const model_mode_t *mode, port_t *port, const reader_settings_t *settings)
{
    if (*reader == NULL) *reader = allocate(sizeof **reader);
    const uint16_t sequence = (*reader)->sequence != NULL ? *(*reader)->sequence : 0;
    memset(*reader, 0, sizeof **reader);
    (*reader)->mode = mode;
    (*reader)->line = &port->line;
    if (!mode->read(*reader, port, settings)) return false;
    *(*reader)->sequence = sequence;
    return true;
}

const char *reader_refusal(const reader_t *reader)
{
    return reader->refusal != NULL ? reader->refusal : "its driver does not take these settings";
}

fathom_status_t reader_close(reader_t *reader)
{
    if (reader == NULL || reader->end == NULL) return FATHOM_OK;
    const fathom_status_t status = reader->end(reader);
    if (status != FATHOM_PENDING) reader->end = NULL;
    return status;
}

void reader_free(reader_t **reader)
{
    free(*reader);
    *reader = NULL;
}

/* ---- reading ---- */

fathom_status_t reader_poll(reader_t *reader, fathom_sample_t *sample)
{
    return reader != NULL ? fathom_poll(&reader->sensor, sample) : FATHOM_PENDING;
}

uint32_t reader_due_us(const reader_t *reader)
{
    return reader != NULL ? fathom_due_us(&reader->sensor, 1) : FATHOM_NO_DEADLINE;
}

bool reader_has_more(const reader_t *reader)
{
    return reader != NULL && reader->response != NULL && reader->response->left != 0;
}

void reader_cancel(reader_t *reader)
{
    if (reader != NULL && reader->unit != NULL) fathom_modbus_unit_cancel(reader->unit);
}

void reader_write_next_unchecked(reader_t *reader)
{
    if (reader != NULL && reader->unit != NULL) (void)fathom_modbus_write_next_unchecked(reader->unit);
}

void reader_listen_unasked(reader_t *reader)
{
    if (reader != NULL && reader->mode->listen_unasked != NULL) reader->mode->listen_unasked(reader);
}

const char *reader_remark(reader_t *reader)
{
    if (reader == NULL) return NULL;
    const char *const remark = reader->remark;
    reader->remark = NULL;
    return remark;
}

bool reader_has_sent(const reader_t *reader, const fathom_transaction_t *transaction)
{
    return reader != NULL && reader->unit != NULL && transaction == &reader->unit->request.transaction;
}

/* ---- counters and facts ---- */

void reader_take_counters(reader_t *reader, reader_counters_t *counters)
{
    *counters = (reader_counters_t){0};
    if (reader == NULL) return;
    if (reader->frames != NULL) {
        memcpy(counters->stream, reader->frames, sizeof counters->stream);
        memset(reader->frames, 0, sizeof counters->stream);
    }
    if (reader->unit != NULL) {
        counters->responses = reader->unit->responses;
        counters->failures = reader->unit->failures;
        reader->unit->responses = reader->unit->failures = 0;
    }
    if (reader->meter == NULL) return;
    counters->noises = reader->meter->noises;
    reader->meter->noises = 0;
    if (reader->pins->missed != NULL) {
        counters->missed = *reader->pins->missed;
        *reader->pins->missed = 0;
    }
    if (reader->pins->lost_events != NULL) {
        counters->lost_events = *reader->pins->lost_events;
        *reader->pins->lost_events = 0;
    }
}

reader_facts_t reader_facts(const reader_t *reader)
{
    static const fathom_modbus_unit_t no_unit;
    if (reader == NULL) return (reader_facts_t){0};
    const fathom_modbus_unit_t *const unit = reader->unit != NULL ? reader->unit : &no_unit;
    const fathom_transaction_t *const transaction = &unit->request.transaction;
    reader_facts_t facts = {
        .least_period_us = reader->period_us != NULL ? *reader->period_us : 0,
        .values = reader->values,
        .value_count = reader->value_count,
        .is_unexpected = transaction->status == FATHOM_ERR_MALFORMED,
        .exception = fathom_modbus_unit_exception(unit),
        .has_unasked = reader->unasked.is_new || reader->unasked.implausible != 0,
        .is_automatic = reader->check.is_automatic,
        .is_in_progress = transaction->status == FATHOM_PENDING && transaction->attempts != 0,
        .timeouts_in_row = unit->timeouts_in_row,
        .backoff_left_us = unit->backoff_left_us,
        .is_written = unit->is_written,
        .is_setting = unit->setting != 0,
        .is_later = reader->next_baud != NULL && *reader->next_baud != 0,
        .acknowledgement = unit->outcome,
        .address = unit->address,
        .line = unit->line_settings,
        .has_temperature = reader->temperature.is_known,
        .temperature_dc = reader->temperature.dc,
    };
    if (reader->response != NULL && !facts.is_unexpected) {
        facts.refused_probe = reader->response->refused_probe;
        facts.refused_raw = reader->response->refused_raw;
    }
    if (reader->window != NULL) {
        facts.min_mm = reader->window->min_mm != 0 ? reader->window->min_mm : 1;
        facts.max_mm = reader->window->max_mm;
    }
    return facts;
}

/* ---- what drivers share ---- */

fathom_modbus_config_t driver_config(const port_t *port, const reader_settings_t *settings)
{
    return (fathom_modbus_config_t){
        .line_settings = port_has_settings(port->kind) ? settings->line : NULL,
        .period_us = settings->period_us,
        .timeout_us = settings->timeout_us,
        .backoff_us = settings->backoff_us,
        .address = settings->address,
        .address_zero = settings->address == 0,
        .retries = settings->retries,
    };
}

uint32_t driver_now_us(const reader_t *reader)
{
    const fathom_clock_t *const clock = reader->line->parts->clock;
    return clock->now_us(clock->ctx);
}
