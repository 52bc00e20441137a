/* SPDX-License-Identifier: MIT */
#include "fake_modbus.h"

#include <string.h>

#include "suite.h"

/*
 * Each call of NAME comes to __wrap_NAME, and __real_NAME is the one of the library. fake_modbus.cmake links so.
 */
#define REPLACES(type, name, parameters)                                                                     \
    type __real_##name parameters;                                                                           \
    type __wrap_##name parameters;                                                                           \
    type __wrap_##name parameters

static void assert_unchanged(const fake_modbus_t *fake)
{
    const fathom_modbus_request_t *const is = fake->request;
    const fathom_modbus_request_t *const was = &fake->snapshot;
    assert_non_null(is);
    assert_memory_equal(is->message.head, was->message.head, sizeof was->message.head);
    assert_ptr_equal(is->message.values, was->message.values);
    assert_int_equal(is->transaction.timeout_us, was->transaction.timeout_us);
    assert_int_equal(is->transaction.retries, was->transaction.retries);
}

/* A line with this address as its kind is a fake. */
static const uint8_t kind_of_fake;

static bool is_fake(const fathom_line_t *line) { return (const void *)line->kind == &kind_of_fake; }

static fathom_status_t fake_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    fake_modbus_t *const fake = (fake_modbus_t *)line;
    if (fake->refuses < 0) return fake->refuses;
    assert_null(fake->request);
    assert_true(fake->submits < FAKE_MODBUS_LOG);
    memcpy(fake->log[fake->submits++], request->message.head, sizeof *fake->log);
    fake->request = request;
    request->transaction.attempts = 0;
    request->transaction.status = FATHOM_PENDING;
    fake->snapshot = *request;
    return FATHOM_PENDING;
}

static void end(fake_modbus_t *fake, fathom_status_t status)
{
    fake->request->transaction.link.heard_us = fake->heard_us;
    fake->request->transaction.status = (int8_t)status;
    fake->request = NULL;
    fake->ends = FATHOM_PENDING;
    fake->is_sent = false;
}

/* ---- in the place of the functions of line.h ---- */

REPLACES(void, fathom_line_cancel, (fathom_line_t * line, fathom_transaction_t *transaction))
{
    if (!is_fake(line)) {
        __real_fathom_line_cancel(line, transaction);
        return;
    }
    fake_modbus_t *const fake = (fake_modbus_t *)line;
    fake->cancels++;
    assert_ptr_equal(fake->request, transaction);
    assert_unchanged(fake);
    end(fake, FATHOM_ERR_CANCELLED);
}

REPLACES(void, fathom_line_cancel_unit, (fathom_line_t * line, uint8_t address))
{
    if (!is_fake(line)) {
        __real_fathom_line_cancel_unit(line, address);
        return;
    }
    fake_modbus_t *const fake = (fake_modbus_t *)line;
    fake->unit_cancels++;
    fake->cancelled_unit = address;
    if (fake->request != NULL && fake->request->message.head[0] == address) end(fake, FATHOM_ERR_CANCELLED);
}

/* Each driver polls, in each call. */
REPLACES(bool, fathom_line_was_polled, (const fathom_line_t *line, uint32_t since_us))
{
    return !is_fake(line) && __real_fathom_line_was_polled(line, since_us);
}

REPLACES(fathom_status_t, fathom_line_poll, (fathom_line_t * line))
{
    if (!is_fake(line)) return __real_fathom_line_poll(line);
    fake_modbus_t *const fake = (fake_modbus_t *)line;
    fake->polls++;
    if (fake->request == NULL) return fake->transport;
    assert_unchanged(fake);
    fathom_modbus_request_t *const request = fake->request;
    if (fake->is_sent) request->transaction.attempts++;
    fake->is_sent = false;
    if (fake->ends == FATHOM_PENDING) return fake->transport;
    if (fake->ends == FATHOM_OK && request->message.head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS) {
        assert_int_equal(request->message.head[5], fake->response_count);
        memcpy(request->message.values, fake->response, fake->response_count * sizeof *fake->response);
    }
    if (fake->ends == FATHOM_ERR_EXCEPTION) request->message.exception = fake->exception;
    end(fake, fake->ends);
    return fake->transport;
}

REPLACES(uint32_t, fathom_line_due_us, (const fathom_line_t *line))
{
    return is_fake(line) ? ((const fake_modbus_t *)line)->due_us : __real_fathom_line_due_us(line);
}

REPLACES(bool, fathom_line_is_queued, (const fathom_line_t *line, const fathom_transaction_t *transaction))
{
    if (!is_fake(line)) return __real_fathom_line_is_queued(line, transaction);
    const fathom_modbus_request_t *const request = ((const fake_modbus_t *)line)->request;
    return request != NULL && &request->transaction == transaction;
}

/* The client of `55 AA` submits to the line itself. */
REPLACES(fathom_status_t, fathom_line_submit, (fathom_line_t * line, fathom_transaction_t *transaction))
{
    if (!is_fake(line)) return __real_fathom_line_submit(line, transaction);
    return fake_submit(line, (fathom_modbus_request_t *)transaction);
}

/* ---- the test's side ---- */

static uint32_t fake_now_us(void *ctx) { return ((const fake_modbus_t *)ctx)->now_us; }

void fake_modbus_init(fake_modbus_t *fake)
{
    memset(fake, 0, sizeof *fake);
    fake->now_us = 5000;
    fake->ends = FATHOM_PENDING;
    fake->transport = FATHOM_PENDING;
    fake->due_us = FATHOM_NO_DEADLINE;
    fake->parts.clock = &fake->clock;
    fake->parts.frame_size = UINT8_MAX;
    fake->line.parts = &fake->parts;
    fake->line.kind = (const fathom_line_kind_t *)(const void *)&kind_of_fake;
    fake->modbus = (fathom_modbus_t){.line = &fake->line, .submit = fake_submit};
    fake->clock = (fathom_clock_t){fake_now_us, fake};
}

void fake_modbus_send(fake_modbus_t *fake)
{
    assert_non_null(fake->request);
    fake->is_sent = true;
}

void fake_modbus_response(fake_modbus_t *fake, const uint16_t *values, uint8_t count)
{
    assert_in_range(count, 1, sizeof fake->response / sizeof *fake->response);
    memcpy(fake->response, values, count * sizeof *values);
    fake->response_count = count;
    fake_modbus_fail(fake, FATHOM_OK);
}

void fake_modbus_acknowledge(fake_modbus_t *fake)
{
    assert_non_null(fake->request);
    assert_int_not_equal(fake->request->message.head[1], FATHOM_MODBUS_READ_HOLDING_REGISTERS);
    fake_modbus_fail(fake, FATHOM_OK);
}

void fake_modbus_refuse(fake_modbus_t *fake, uint8_t exception)
{
    fake->exception = exception;
    fake_modbus_fail(fake, FATHOM_ERR_EXCEPTION);
}

void fake_modbus_fail(fake_modbus_t *fake, fathom_status_t status)
{
    assert_non_null(fake->request);
    /* A line that cannot do the line settings sends nothing. */
    const bool has_left = status != FATHOM_ERR_UNSUPPORTED;
    if (has_left && fake->request->transaction.attempts == 0) fake_modbus_send(fake);
    fake->ends = status;
}

void fake_modbus_forget(fake_modbus_t *fake)
{
    assert_non_null(fake->request);
    fake->request = NULL;
    fake->is_sent = false;
    fake->ends = FATHOM_PENDING;
}

void fake_modbus_assert_asked(const fake_modbus_t *fake, unsigned submits, uint8_t unit, uint16_t first,
                              uint16_t count)
{
    const uint8_t head[] = {unit,
                            0x03,
                            (uint8_t)(first >> 8),
                            (uint8_t)(first & 0xFF),
                            (uint8_t)(count >> 8),
                            (uint8_t)(count & 0xFF)};
    assert_int_equal(fake->submits, submits);
    assert_true(submits != 0);
    assert_memory_equal(fake->log[submits - 1], head, sizeof head);
}

fathom_status_t init_unit(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                          const fathom_modbus_config_t *config, uint32_t timeout_us, uint32_t pace_us)
{
    const fathom_status_t status = fathom_modbus_unit_begin(unit, transport, unit, sizeof *unit);
    return status < 0 ? status : fathom_modbus_unit_init(unit, transport, config, timeout_us, pace_us);
}

fathom_status_t ask_unit(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *request)
{
    if (request->id >= FATHOM_MODBUS_COMMAND) return fathom_modbus_command(unit, request);
    return fathom_modbus_unit_measure(unit, request->first, (uint8_t)request->last, request->values);
}
