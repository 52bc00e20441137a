/* SPDX-License-Identifier: MIT */
#include "wire_desk.h"

desk_t desk;

void desk_init_line(void)
{
    assert_int_equal(fathom_line_init(&desk.line, &desk.config), FATHOM_OK);
    (void)fathom_line_poll(&desk.line);
}

void desk_open(desk_parts_t parts, wire_us_t turn_us, wire_us_t jitter_us)
{
    memset(&desk, 0, sizeof desk);
    desk.turn_us = turn_us;
    desk.jitter_us = jitter_us;
    desk.config =
        (fathom_line_parts_t){.uart = &wire.uart,
                              .clock = &wire.clock,
                              .frame = desk.frame,
                              .frame_size = sizeof desk.frame,
                              .echo = FATHOM_LINE_ECHO_OFF,
                              .silence_us = wire.byte_us == WIRE_BYTE_19200_US ? FATHOM_T3_5_US(19200, 11)
                                                                               : FATHOM_T3_5_US(9600, 10),
                              .count = fathom_line_count,
                              .counters = desk.counters,
                              .marks = wire.has_time_stamps ? fathom_line_marks : NULL,
                              .senders = (parts & DESK_SENDERS) != 0 ? &fathom_line_senders : NULL,
                              .masters = (parts & DESK_MASTERS) != 0 ? &fathom_line_masters : NULL};
    desk_init_line();
    desk.modbus = fathom_modbus_client(&desk.line);
}

void desk_learn_protocol(void)
{
    desk_request_t request = {0};
    desk_read(&request, 0, 1, 100000, 0);
    fathom_line_cancel(&desk.line, &request.request.transaction);
}

void desk_turn(void)
{
    wire_run(desk.turn_us - desk.jitter_us + wire_random((uint32_t)(2 * desk.jitter_us + 1)));
    if (!wire.noise.is_in_phase) return;
    const uint8_t byte = (uint8_t)wire_random(256);
    (void)wire_send(WIRE_NOISE, wire.now_us, &byte, 1);
}

void desk_run(wire_us_t for_us)
{
    for (const wire_us_t end_us = wire.now_us + for_us; wire.now_us < end_us;) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
}

wire_us_t desk_longest_turn_us(void)
{
    return desk.longest_turn_us != 0 ? desk.longest_turn_us : desk.turn_us + desk.jitter_us;
}

wire_us_t desk_bound_us(wire_us_t timeout_us, unsigned retries, unsigned others)
{
    enum { WAITS = 5 };
    const wire_us_t busy_us = desk.config.busy_us != 0 ? desk.config.busy_us : FATHOM_LINE_DEFAULT_BUSY_US;
    const wire_us_t turn_us = desk_longest_turn_us();
    const wire_us_t attempt_us =
        busy_us + 2 * FATHOM_LINE_SEND_US + timeout_us + FATHOM_LINE_FINISH_US + WAITS * turn_us;
    return (others + 1) * ((retries + 1) * attempt_us + retries * (timeout_us + turn_us));
}

unsigned desk_count(unsigned which) { return desk.counters[which]; }

static void submit(desk_request_t *request, uint32_t timeout_us, uint8_t retries)
{
    request->request.transaction.timeout_us = timeout_us;
    request->request.transaction.retries = retries;
    request->begin_us = wire.now_us;
    assert_int_equal(fathom_modbus_client_submit(&desk.line, &request->request), FATHOM_PENDING);
}

void desk_read(desk_request_t *request, uint16_t reg, uint8_t count, uint32_t timeout_us, uint8_t retries)
{
    memset(request->values, 0, sizeof request->values);
    fathom_modbus_read_holding_registers(&request->request.message, 1, reg, count, request->values);
    submit(request, timeout_us, retries);
}

void desk_write(desk_request_t *request, uint16_t reg, uint16_t value, uint32_t timeout_us)
{
    fathom_modbus_write_single_register(&request->request.message, 1, reg, value);
    submit(request, timeout_us, 0);
}

fathom_status_t desk_status(const desk_request_t *request)
{
    return (fathom_status_t)request->request.transaction.status;
}

fathom_status_t desk_wait(const desk_request_t *request, wire_us_t at_most_us)
{
    for (const wire_us_t end_us = wire.now_us + at_most_us;
         desk_status(request) == FATHOM_PENDING && wire.now_us < end_us;) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
    return desk_status(request);
}
