/* SPDX-License-Identifier: MIT */
#include "fake_modbus.h"

#include <string.h>

#include "suite.h"

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

static fathom_status_t fake_submit(void *ctx, fathom_modbus_request_t *request)
{
    fake_modbus_t *const fake = ctx;
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

static void fake_cancel(void *ctx, fathom_modbus_request_t *request)
{
    fake_modbus_t *const fake = ctx;
    fake->cancels++;
    assert_ptr_equal(fake->request, request);
    assert_unchanged(fake);
    end(fake, FATHOM_ERR_CANCELLED);
}

static void fake_cancel_unit(void *ctx, uint8_t unit)
{
    fake_modbus_t *const fake = ctx;
    fake->unit_cancels++;
    fake->cancelled_unit = unit;
    if (fake->request != NULL && fake->request->message.head[0] == unit) end(fake, FATHOM_ERR_CANCELLED);
}

static fathom_status_t fake_poll(void *ctx, uint32_t since_us)
{
    (void)since_us;
    fake_modbus_t *const fake = ctx;
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

static uint32_t fake_due_us(void *ctx) { return ((const fake_modbus_t *)ctx)->due_us; }

static bool fake_has(void *ctx, const fathom_modbus_request_t *request)
{
    const fake_modbus_t *const fake = ctx;
    return request != NULL && fake->request == request;
}

static uint32_t fake_now_us(void *ctx) { return ((const fake_modbus_t *)ctx)->now_us; }

void fake_modbus_init(fake_modbus_t *fake)
{
    memset(fake, 0, sizeof *fake);
    fake->now_us = 5000;
    fake->ends = FATHOM_PENDING;
    fake->transport = FATHOM_PENDING;
    fake->due_us = FATHOM_NO_DEADLINE;
    fake->modbus = (fathom_modbus_t){.submit = fake_submit,
                                     .cancel = fake_cancel,
                                     .cancel_unit = fake_cancel_unit,
                                     .poll = fake_poll,
                                     .due_us = fake_due_us,
                                     .clock = &fake->clock,
                                     .ctx = fake,
                                     .has = fake_has};
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
    if (fake->request->transaction.attempts == 0) fake_modbus_send(fake);
    fake->ends = status;
}

void fake_modbus_forget(fake_modbus_t *fake)
{
    assert_non_null(fake->request);
    fake->request = NULL;
    fake->is_sent = false;
    fake->ends = FATHOM_PENDING;
}

void fake_modbus_end_unsent(fake_modbus_t *fake, fathom_status_t status)
{
    assert_non_null(fake->request);
    fake->ends = status;
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
