/* SPDX-License-Identifier: MIT */
#ifndef ANY_LINE_H
#define ANY_LINE_H

#include "assumptions.h"
#include "fathom/engine/internal/modbus_unit.h"
#include "fathom/engine/line.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"

/*
 * Any line that keeps to fathom/engine/line.h, in place of src/engine/line*.c, to prove what stands upon one: the
 * clients and the drivers that listen. At each poll a transaction may end with any status, and the listener may be called
 * any number of times with any bytes. What the line promises to what stands upon it is proved of the real one in line.c.
 */

enum { ANY_FRAME_SIZE = 27, ANY_CALL_SIZE = 3 };

static uint8_t any_line_frame[ANY_FRAME_SIZE];
static fathom_line_parts_t any_line_config;
static fathom_line_t any_line;
static fathom_line_t blank_line;              /* not initialised; a driver refuses it */
static fathom_transaction_t *any_line_queued; /* NULL: none */

static void any_line_init(void)
{
    any_line_config.uart = any_bool() ? &assumed_uart : &assumed_bare_uart;
    any_line_config.clock = &assumed_clock;
    any_line_config.frame = any_line_frame;
    any_line_config.frame_size = any_8_in(8, ANY_FRAME_SIZE);
    any_line_config.silence_us = any_16();
    any_line_config.gap_us = any_16();
    any_line.parts = &any_line_config;
}

/* What a driver may read of it. */
static void any_line_look(fathom_line_t *line)
{
    /*@ assert line == &any_line; */
    line->polled_us = any_32();
    line->silent_us = any_16();
    line->received_count = any_8();
}

static void any_line_end(int8_t status)
{
    any_line_queued->status = status;
    any_line_queued->link.heard_us = any_32();
    any_line_queued = NULL;
}

static void any_line_go_on(void)
{
    if (any_bool()) any_line_queued = NULL; /* It was initialised again and has forgotten its transactions. */
    if (any_line_queued == NULL || any_bool()) return;
    any_line_queued->attempts = any_8();
    if (any_bool()) return;
    any_line_end(
        (int8_t)(any_bool() ? FATHOM_OK : Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_PORT)));
}

/* All that the protocol may be asked while the transaction is queued. What it writes may be there from the beginning:
 * nothing tells when it comes but the status. */
static void any_line_converse(fathom_transaction_t *transaction)
{
    const fathom_protocol_t *const protocol = transaction->protocol;
    uint8_t frame[ANY_FRAME_SIZE];
    const uint8_t length = protocol->encode(transaction, any_line_frame);
    /*@ assert encoded: 1 <= length <= any_line_config.frame_size; */
    any_bytes(frame, ANY_FRAME_SIZE);
    (void)protocol->parse_response(transaction, frame);
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction)
{
    /*@ assert line == &any_line; */
    if (transaction->timeout_us > INT32_MAX) return FATHOM_ERR_ARGUMENT;
    if (transaction == any_line_queued) return FATHOM_ERR_BUSY;
    if (transaction->line_settings != NULL) (void)assumed_set_line(&assumed_ctx, transaction->line_settings);
    any_line_converse(transaction);
    transaction->status = FATHOM_PENDING;
    transaction->attempts = 0;
    any_line_queued = transaction;
    return FATHOM_PENDING;
}

void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction)
{
    /*@ assert line == &any_line; */
    if (transaction == any_line_queued) any_line_end(FATHOM_ERR_CANCELLED);
}

void fathom_line_cancel_unit(fathom_line_t *line, uint8_t address)
{
    /*@ assert line == &any_line; */
    if (any_line_queued != NULL && any_line_queued->address == address) any_line_end(FATHOM_ERR_CANCELLED);
}

bool fathom_line_is_queued(const fathom_line_t *line, const fathom_transaction_t *transaction)
{
    /*@ assert line == &any_line; */
    return transaction == any_line_queued;
}

bool fathom_line_was_polled(const fathom_line_t *line, uint32_t since_us)
{
    /*@ assert line == &any_line; */
    (void)since_us;
    return any_bool();
}

fathom_status_t fathom_line_poll(fathom_line_t *line)
{
    while (any_bool()) {
        uint8_t bytes[ANY_CALL_SIZE];
        const uint8_t count = any_8_in(0, ANY_CALL_SIZE);
        /*@ split count; */
        any_bytes(bytes, ANY_CALL_SIZE);
        any_line_look(line);
        /* line.h has it: "`count` bytes"; they are the last ones there are. */
        if (line->listener != NULL)
            line->listener->receive(line->listener, bytes + (ANY_CALL_SIZE - count), count, any_bool(),
                                    any_32());
    }
    any_line_look(line);
    any_line_go_on();
    return any_bool() ? FATHOM_PENDING : FATHOM_ERR_PORT;
}

fathom_status_t fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener)
{
    /*@ assert line == &any_line; */
    if (listener != NULL && line->listener != NULL && line->listener != listener) return FATHOM_ERR_BUSY;
    line->listener = listener;
    return FATHOM_OK;
}

fathom_listener_t *fathom_line_replace_listener(fathom_line_t *line, fathom_listener_t *listener)
{
    /*@ assert line == &any_line; */
    fathom_listener_t *const previous = line->listener;
    line->listener = listener;
    return previous;
}

/* A driver that refuses its config may call this function too. */
void fathom_line_unlisten(fathom_line_t *line, const fathom_listener_t *listener)
{
    /*@ assert line == &any_line || line == &blank_line; */
    if (line->listener == listener) line->listener = NULL;
}

/* The line may hold bytes or not, at each call. */
bool fathom_line_holds_bytes(const fathom_line_t *line)
{
    /*@ assert line == &any_line; */
    return any_bool();
}

void fathom_line_flush(fathom_line_t *line)
{
    /*@ assert line == &any_line; */
    any_line_look(line);
}

uint32_t fathom_line_due_us(const fathom_line_t *line)
{
    /*@ assert line == &any_line; */
    return any_32();
}

/* Of all that it may return the drivers tell no more apart than OK, PENDING and below zero. */
fathom_status_t fathom_line_break(fathom_line_t *line, bool on)
{
    /*@ assert line == &any_line; */
    /*@ assert on == 0 || on == 1; */
    any_line_look(line);
    return (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_PENDING);
}

bool fathom_line_is_idle(const fathom_line_t *line) { return line->received_count == 0 && any_bool(); }

uint32_t fathom_line_last_byte_us(const fathom_line_t *line) { return line->polled_us - line->silent_us; }

/* What the configs of the drivers have in common, with any value. a16_modbus.c has the transports that are refused. */

static const fathom_line_settings_t assumed_settings = {19200, FATHOM_PARITY_EVEN, 1};

static void any_modbus_config(fathom_modbus_config_t *config)
{
    config->line_settings = any_bool() ? &assumed_settings : NULL;
    config->period_us = any_32();
    config->timeout_us = any_32();
    config->command_timeout_us = any_32();
    config->backoff_us = any_32();
    config->address = any_8();
    config->address_zero = any_bool();
    config->retries = any_8();
}

/* Any facts of a model. A config of NULL selects those of the datasheet. */
static const fathom_model_facts_t *any_facts(void)
{
    static fathom_model_facts_t facts;
    facts.line_settings = NULL;
    facts.min_mm = any_16();
    facts.max_mm = any_16();
    facts.period_ms = any_16();
    facts.trigger_us = any_16();
    facts.us_per_dm = any_16();
    facts.start = any_8();
    facts.trigger_byte = any_8();
    facts.earliest_ms = any_8();
    facts.latest_ms = any_8();
    facts.no_target_ms = any_8();
    facts.value_fffb = any_8();
    facts.value_fffd = any_8();
    facts.value_fffe = any_8();
    facts.value_ffff = any_8();
    facts.value_0 = any_8();
    facts.registers = any_8();
    return &facts;
}

/* Which probes an A05 has, as a mask; from 16 on they are refused. Those that begin at the same one stand together:
 * which is 0..5. */
static uint8_t any_probes(uint8_t which)
{
    switch (which) {
    case 0:
        return (uint8_t)(2 * any_8_in(0, 7) + 1);
    case 1:
        return (uint8_t)(4 * any_8_in(0, 3) + 2);
    case 2:
        return (uint8_t)(8 * any_8_in(0, 1) + 4);
    case 3:
        return 8;
    case 4:
        return 0;
    default:
        return any_8_in(16, UINT8_MAX);
    }
}

/* The two calls of a program's loop. */
static void any_poll(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    (void)fathom_poll(sensor, &sample);
    (void)fathom_due_us(sensor, 1);
}

#endif
