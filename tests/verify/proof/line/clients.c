/* SPDX-License-Identifier: MIT */
/*
 * proves: src/engine/modbus_client.c src/engine/modbus_client_zero.c src/engine/dyp_client.c
 * with:   src/codec/modbus_rtu.c src/codec/dyp_55aa.c src/codec/dyp_stream.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 300 -eva-slevel 400 -eva-split-return full
 *          -eva-slevel-function main:0,go_on:0,submit:100000
 * quick:   no
 *
 * Both clients over any line: any request is submitted, and their protocols are asked what line.h says that a line asks
 * of them, with any bytes. The bytes that have come are the last ones that there are, and so are the registers: one too
 * far is an alarm.
 */
#include "any_line.h"
#include "contracts.h"
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/modbus_client.h"

enum { MOST = 13, MOST_REGISTERS = 4 };

static fathom_modbus_request_t request;

/* The byte that a response's length follows from, in ranges with one length each. One that has not come is none. */
static void any_command(uint8_t *frame, uint8_t have, uint8_t which)
{
    static const uint8_t least[] = {0, 1, 2, 3, 4, 0x10, 0x11, 0x12, 0x13, 0x14};
    static const uint8_t most[] = {0, 1, 2, 3, 0x0F, 0x10, 0x11, 0x12, 0x13, 0xFF};
    if (have > 3) frame[3] = any_8_in(least[which], most[which]);
}

static void any_function(uint8_t *frame, uint8_t have, uint8_t which)
{
    static const uint8_t least[] = {0, 3, 4, 6, 7, 0x10, 0x11, 0x83, 0x84, 0x86, 0x87, 0x90, 0x91};
    static const uint8_t most[] = {2, 3, 5, 6, 0x0F, 0x10, 0x82, 0x83, 0x85, 0x86, 0x8F, 0x90, 0xFF};
    if (have > 1) frame[1] = any_8_in(least[which], most[which]);
}

/* Of a read, the byte count: that of the bytes that have come, fewer, more, and more than there may be. */
static void any_size(uint8_t *frame, uint8_t have, uint8_t which)
{
    const uint8_t exact = (uint8_t)(have < 5 ? 0 : have - 5);
    if (have < 3) return;
    if (which == 0) frame[2] = exact;
    if (which == 1 && exact != 0) frame[2] = any_8_in(0, (uint8_t)(exact - 1));
    if (which == 1 && exact == 0) frame[2] = 0;
    if (which == 2) frame[2] = any_8_in((uint8_t)(exact + 1), 250);
    if (which == 3) frame[2] = any_8_in(251, UINT8_MAX);
}

enum { COMMANDS = 10, FUNCTIONS = 13, SIZES = 4, READ = 1 };

/* What line_response.c does with `have` bytes at the front of the frame. A frame that is shorter than what has come is
 * the same one that had come when it was as long. */
static void look_at(const fathom_protocol_t *protocol, uint8_t have, bool is_dyp)
{
    uint8_t bytes[MOST];
    uint8_t *const frame = bytes + (MOST - have);
    any_bytes(bytes, MOST);
    const uint8_t which = any_8_in(0, is_dyp ? COMMANDS - 1 : FUNCTIONS - 1);
    uint8_t size = 0;
    /*@ split which; */
    if (!is_dyp && which == READ) size = any_8_in(0, SIZES - 1);
    /*@ split size; */
    if (is_dyp) any_command(frame, have, which);
    if (!is_dyp) any_function(frame, have, which);
    if (!is_dyp && which == READ) any_size(frame, have, size);
    (void)protocol->is_request(&request.transaction, frame, have);
    if (protocol->may_collide != NULL) (void)protocol->may_collide(&request.transaction);
    if (protocol->length(frame, have) != have) return;
    if (protocol->check(frame, have) != 0) return;
    (void)frame[protocol->address_offset];
    (void)protocol->parse_response(&request.transaction, frame);
}

static void go_on(void)
{
    if (fathom_line_is_queued(&any_line, &request.transaction)) {
        const fathom_status_t status =
            fathom_dyp_client_broadcast_address(&any_line, &request, any_8_in(1, 254));
        /*@ assert status == FATHOM_ERR_BUSY; */
    }
    (void)fathom_line_poll(&any_line);
    if (any_bool()) fathom_modbus_client_cancel(&any_line, &request);
}

static void submit(uint16_t *values, uint8_t count)
{
    static fathom_modbus_t transports[3];
    transports[0] = fathom_modbus_client(&any_line);
    transports[1] = fathom_modbus_client_with_zero(&any_line);
    transports[2] = fathom_dyp_client(&any_line);
    const uint8_t client = any_8_in(0, 3);
    /*@ split client; */
    const uint8_t function = any_8_in(0, 2);
    /*@ split function; */
    /* Of a write of one register, and where the address is set, the count tells nothing. */
    if ((function == 1 || client == 3) && (function != 1 || count != 0)) return;
    if (function == 0)
        fathom_modbus_read_holding_registers(&request.message, any_8(), any_16(), count, values);
    if (function == 1) fathom_modbus_write_single_register(&request.message, any_8(), any_16(), any_16());
    if (function == 2)
        fathom_modbus_write_multiple_registers(&request.message, any_8(), any_16(), count, values);
    if (function == 0) request.message.has_effect = any_bool();
    request.transaction.timeout_us = any_32();
    request.transaction.line_settings = NULL;
    const fathom_status_t status = client == 3
                                       ? fathom_dyp_client_broadcast_address(&any_line, &request, any_8())
                                       : transports[client].submit(transports[client].line, &request);
    if (status != FATHOM_PENDING) return;
    /*@ slevel merge; */
    if (any_bool()) {
        go_on();
        return;
    }
    const uint8_t have = any_8_in(1, MOST);
    /*@ split have; */
    look_at(request.transaction.protocol, have, client >= 2);
}

void main(void)
{
    uint16_t registers[MOST_REGISTERS];
    const uint8_t count = any_8_in(0, MOST_REGISTERS);
    /*@ split count; */
    for (uint8_t i = 0; i < MOST_REGISTERS; i++) registers[i] = any_16();
    any_line_init();
    request.transaction.status = FATHOM_OK;
    submit(registers + (MOST_REGISTERS - count), count);
}
