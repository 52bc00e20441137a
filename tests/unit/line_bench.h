/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LINE_BENCH_H
#define FATHOM_TESTS_LINE_BENCH_H

#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fathom/line.h"
#include "fathom/modbus_client.h"

/* A line on a fake UART, and two Modbus requests to put on it. 9600 8N1. */
enum { BYTE_US = 1042, T3_5_US = 3646, GAP_US = 5000, TIMEOUT_US = 100000 };

typedef struct {
    fake_t fake;
    uint8_t frame[32];
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_request_t request;
    fathom_modbus_request_t other;
    uint16_t value;
    uint16_t other_value;
} bench_t;

extern bench_t bench;

/* Before each test. */
int set_up(void **state);

/* Frames of the datasheets: A16 6(4) examples 1 and 2, HPS-167S "abnormal response", A05 3(4) example 3. */
extern const uint8_t ask_1_processed[8];
extern const uint8_t answer_1_754[7];
extern const uint8_t answer_1_751[7];
extern const uint8_t exception_1_2[5];
extern const uint8_t answer_1_three[11];

/* Moves time on in steps and polls after each; run takes steps of 100 us. */
void run_in_steps(uint32_t for_us, uint32_t step_us);
void run(uint32_t for_us);

/* Submits a read of register 0x0100. *value is 0xDEAD until it is answered. */
void ask(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value, uint8_t retries);

/* Asks unit 1 and runs until the last stop bit has left, which was at most 400 us ago. */
void ask_1_and_send(uint8_t retries);

/* Bytes that can be read at once. receive_answer makes a frame with one register. */
void receive(const uint8_t *bytes, size_t length);
void receive_answer(uint8_t unit, uint16_t value);

fathom_status_t status_of(const fathom_modbus_request_t *request);
unsigned counter(unsigned which);

#endif
