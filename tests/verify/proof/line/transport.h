/* SPDX-License-Identifier: MIT */
#ifndef TRANSPORT_H
#define TRANSPORT_H

#include "assumptions.h"
#include "fathom/engine/modbus.h"

/*
 * Any transport that keeps to fathom/engine/modbus.h, to prove the drivers over it: over a line, whose own proof is
 * line.c and whose clients' is clients.c, or over a port's. At each call anything that modbus.h allows may happen; a
 * request ends at any of them with any status that stands at fathom_transaction_t. What it may rely on is asserted.
 */

static fathom_modbus_request_t *assumed_request; /* under way; NULL: none */

/* The registers of a response are there as soon as the request is, and can be any: nothing tells a driver when they
 * come but the status, and until then it may not look. */
static void assumed_registers(const fathom_modbus_message_t *message)
{
    const uint8_t count = message->head[5];
    /*@ assert count_of_read: 1 <= count <= 125 && message->head[4] == 0; */
    /*@ assert room: \valid(message->values + (0 .. count - 1)); */
    for (uint8_t i = 0; i < count; i++) message->values[i] = any_16();
}

static fathom_status_t assumed_submit(void *ctx, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert \initialized(&request->transaction.timeout_us) && \initialized(&request->transaction.retries); */
    if (request->transaction.line_settings != NULL)
        (void)assumed_set_line(ctx, request->transaction.line_settings);
    if (assumed_request == request) return FATHOM_ERR_BUSY;
    if (any_bool()) return (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_ARGUMENT);
    if (head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS) {
        assumed_registers(&request->message);
    } else if (head[1] == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS) {
        /*@ assert sent_many: 1 <= head[5] <= 123 &&
                              \initialized(request->message.values + (0 .. head[5] - 1)); */
    } else {
        /*@ assert function: head[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER; */
    }
    request->transaction.status = FATHOM_PENDING;
    request->transaction.attempts = 0;
    assumed_request = request;
    return FATHOM_PENDING;
}

static void assumed_end(int8_t status)
{
    assumed_request->transaction.status = status;
    assumed_request->transaction.link.heard_us = any_32();
    assumed_request = NULL;
}

/* What is under way goes on: it was sent again, or has ended. */
static void assumed_go_on(void)
{
    if (assumed_request == NULL || any_bool()) return;
    assumed_request->transaction.attempts = any_8();
    assumed_request->message.head[0] = any_8_in(0, 255); /* of a read of any unit: who has responded */
    assumed_request->message.exception = any_8();
    if (any_bool()) return;
    assumed_end(
        (int8_t)(any_bool() ? FATHOM_OK : Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_PORT)));
}

static void assumed_cancel(void *ctx, fathom_modbus_request_t *request)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert \valid(request); */
    if (assumed_request == request) assumed_end(FATHOM_ERR_CANCELLED);
}

static void assumed_cancel_unit(void *ctx, uint8_t address)
{
    /*@ assert ctx == &assumed_ctx; */
    (void)address;
    if (assumed_request != NULL && any_bool()) assumed_end(FATHOM_ERR_CANCELLED);
}

static fathom_status_t assumed_poll(void *ctx, uint32_t since_us)
{
    (void)since_us;
    /*@ assert ctx == &assumed_ctx; */
    assumed_go_on();
    return any_bool() ? FATHOM_PENDING : FATHOM_ERR_PORT;
}

static uint32_t assumed_due_us(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_32();
}

/* The transport was initialised again and has forgotten its requests. */
static void assumed_forget(void)
{
    if (any_bool()) assumed_request = NULL;
}

static bool assumed_has(void *ctx, const fathom_modbus_request_t *request)
{
    /*@ assert ctx == &assumed_ctx; */
    assumed_forget();
    return assumed_request == request;
}

/* One that knows its queue and limits the frame, which driver.h sets to any length, and one that does neither. */
static fathom_modbus_t assumed_transport = {assumed_submit, assumed_cancel, assumed_cancel_unit,
                                            assumed_poll,   assumed_due_us, &assumed_clock,
                                            &assumed_ctx,   assumed_has,    13};
static const fathom_modbus_t assumed_bare_transport = {assumed_submit, assumed_cancel, assumed_cancel_unit,
                                                       assumed_poll,   assumed_due_us, &assumed_clock,
                                                       &assumed_ctx,   NULL,           0};

/* ---- what every config of a driver has ---- */

static const fathom_line_settings_t assumed_settings = {19200, FATHOM_PARITY_EVEN, 1};

#endif
