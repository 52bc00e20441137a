/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

const uint8_t ask_1_processed[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
const uint8_t answer_1_754[] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};
const uint8_t answer_1_751[] = {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8};
const uint8_t exception_1_2[] = {0x01, 0x83, 0x02, 0xC0, 0xF1};
const uint8_t answer_1_three[] = {0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47};

bench_t bench;

int set_up(void **state)
{
    memset(&bench, 0, sizeof bench);
    fake_init(&bench.fake);
    bench.fake.byte_us = BYTE_US;
    bench.config =
        (fathom_line_config_t){&bench.fake.uart,     &bench.fake.clock, bench.frame, sizeof bench.frame,
                               FATHOM_LINE_ECHO_OFF, T3_5_US,           GAP_US};
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_READY);
    *state = &bench;
    return 0;
}

/* Moves time on in steps and polls after each. */
void run_in_steps(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        bench.fake.now_us += step_us;
        fathom_line_poll(&bench.line);
    }
}

void run(uint32_t for_us) { run_in_steps(for_us, 100); }

void ask(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value, uint8_t retries)
{
    fathom_modbus_read_holding_registers(&request->message, unit, 0x0100, 1, value);
    request->exchange.timeout_us = TIMEOUT_US;
    request->exchange.retries = retries;
    *value = 0xDEAD;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, request), FATHOM_PENDING);
}

/* Asks unit 1 for its processed value; the request has just left the pin. */
void ask_1_and_send(uint8_t retries)
{
    ask(&bench.request, 1, &bench.value, retries);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    run(8 * BYTE_US + 100);
}

void receive(const uint8_t *bytes, size_t length) { fake_receive(&bench.fake, 0, bytes, length); }

fathom_status_t status_of(const fathom_modbus_request_t *request)
{
    return (fathom_status_t)request->exchange.status;
}

unsigned counter(unsigned which) { return bench.line.counters[which]; }

/* A frame from `unit` with one register, its CRC by the bitwise definition. */
static size_t make_answer(uint8_t *frame, uint8_t unit, uint16_t value)
{
    const uint8_t head[] = {unit, 0x03, 0x02, (uint8_t)(value >> 8), (uint8_t)value};
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != sizeof head; i++) {
        frame[i] = head[i];
        crc ^= head[i];
        for (int bit = 0; bit != 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    frame[5] = (uint8_t)crc;
    frame[6] = (uint8_t)(crc >> 8);
    return 7;
}

void receive_answer(uint8_t unit, uint16_t value)
{
    uint8_t frame[7];
    receive(frame, make_answer(frame, unit, value));
}
