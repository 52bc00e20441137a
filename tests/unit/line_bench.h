/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LINE_BENCH_H
#define FATHOM_TESTS_LINE_BENCH_H

#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"

/* A line on a fake UART, and two requests to put on it. 9600 8N1. */
enum { BYTE_US = 1042, T3_5_US = 3646, GAP_US = 5000, TIMEOUT_US = 100000 };

/* A request of 8 bytes that is submitted now has left by then: silence, bytes, and up to 400 us of the loop. */
enum { REQUEST_US = T3_5_US + 8 * BYTE_US + 400 };

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

typedef struct {
    fake_t fake;
    uint8_t frame[32];
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_parts_t config;
    fathom_line_t line;
    fathom_modbus_request_t request;
    fathom_modbus_request_t other;
    uint16_t value;
    uint16_t other_value;
} bench_t;

extern bench_t bench;

/* Before each test. */
int set_up(void **state);

/* Frames of the datasheets: A16 6(4) examples 1 to 3, HPS-167S "abnormal response", HPS-167S tables 37
 * (with 36 ms and the CRC, which it does not print) and 38, A05 3(4) example 3. */
extern const uint8_t ask_1_processed[8];
extern const uint8_t response_1_754[7];
extern const uint8_t response_1_751[7];
extern const uint8_t set_address_5[8];
extern const uint8_t exception_1_2[5];
extern const uint8_t set_36_ms[13];
extern const uint8_t set_ms_done[8];
extern const uint8_t response_1_three[11];

/* A05 2(3)3 with its sum put right, 2(3)4; A16 2(4): 1953 mm, unsolicited. */
extern const uint8_t dyp_four[13];
extern const uint8_t dyp_first_1953[7];
extern const uint8_t auto_frame[4];

/* Moves time on in steps and polls after each; run takes steps of 100 us. */
void run_in_steps(uint32_t for_us, uint32_t step_us);
/* The line anew, told this of its echo; FATHOM_LINE_ECHO_AUTO: it finds out. */
void set_up_echo(uint8_t echo);

void run(uint32_t for_us);
/* After an init the line drops all bytes until a poll has found the port empty. This is that poll. */
void show_empty_port(void);
fathom_status_t poll_line(void);
uint32_t due(void);

/* ---- asking; each is PENDING from then on, and a value is 0xDEAD until it is answered ---- */

void submit(fathom_modbus_request_t *request);
void submit_dyp(fathom_modbus_request_t *request);

/* A read of register 0x0100; of 0x0106 and those behind it as 55 AA; a write of 5 to 0x0200. */
void ask(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value, uint8_t retries);
void ask_dyp(fathom_modbus_request_t *request, uint8_t unit, uint8_t count, uint16_t *values);
void ask_to_write(fathom_modbus_request_t *request, uint8_t unit);

/* bench.request is set_36_ms, a write of two registers. */
void ask_to_write_36_ms(void);

/* bench.request of unit 1, and bench.other of any. */
void ask_1(uint8_t retries);
void ask_other(uint8_t unit);

/* Asks unit 1 and runs until the last stop bit has left, which was at most 400 us ago. */
void ask_1_and_send(uint8_t retries);

/* Before each test or in its loop: a new bench, and unit 1 was asked, without retries; and it is quarantined. */
int set_up_asked(void **state);
int set_up_quarantined(void **state);

/* ---- what comes ---- */

/* Bytes that can be read at once; those with flags are one read. receive_response makes a frame with one register. */
void receive(const uint8_t *bytes, size_t length);
void receive_rx(const uint8_t *bytes, size_t length, uint8_t flags);
void receive_response(uint8_t unit, uint16_t value);
#define receive_all(array) receive(array, sizeof(array))
void receive_hex(const char *hex); /* "01 03 14" */

/* The same, and a poll 100 us later. */
void deliver(const uint8_t *bytes, size_t length);
void deliver_response(uint8_t unit, uint16_t value);
#define deliver_all(array) deliver(array, sizeof(array))
void deliver_hex(const char *hex);

/* response_1_754 with one wrong bit. */
void receive_damaged(void);

/* The response to bench.request, of unit 1, or to bench.other: each is taken. */
void response_1(uint16_t value);
void response_other(uint8_t unit, uint16_t value);

/* The request is no longer the line's. */
void cancel(fathom_modbus_request_t *request);

/* A poll finds the port broken; then it works again. */
void break_port(void);

/* ---- what is expected ---- */

fathom_status_t status_of(const fathom_modbus_request_t *request);
unsigned counter(unsigned which);

/* Of bench.request and bench.other; how many writes there were; a counter of the line, and when it is due;
 * which unit a write was for. */
#define expect(status)         assert_int_equal(status_of(&bench.request), status)
#define expect_other(status)   assert_int_equal(status_of(&bench.other), status)
#define expect_written(n)      assert_int_equal(bench.fake.written, n)
#define expect_count(which, n) assert_int_equal(counter(which), n)
#define expect_due(us)         assert_int_equal(due(), us)
#define expect_unit(which, id) assert_int_equal(bench.fake.writes[which].bytes[0], id)

/* The first two after a run of so many us. */
#define expect_after(us, status)                                                                             \
    do {                                                                                                     \
        run(us);                                                                                             \
        expect(status);                                                                                      \
    } while (0)
#define expect_written_after(us, n)                                                                          \
    do {                                                                                                     \
        run(us);                                                                                             \
        expect_written(n);                                                                                   \
    } while (0)

/* bench.request is OK with this value. */
void expect_mm(uint16_t value);

/* It has ended so, or is PENDING, and its value is as it was. */
void expect_failed(fathom_status_t status);

/* Nothing is sent for so long, and one request within this time after it. */
void expect_sent(uint32_t after_us, uint32_t within_us);

/* The write of this number had these bytes and no more. */
void expect_bytes(size_t which, const uint8_t *bytes, size_t length);
void expect_hex(size_t which, const char *hex);

/* ---- a listener ---- */

typedef struct {
    fathom_listener_t base;
    uint8_t bytes[256];
    size_t length;
    unsigned calls;
    unsigned gaps;
    size_t gap_at; /* of the last one */
    unsigned losses;
    size_t lost_at; /* of the last one */
    uint32_t time_us;
} bench_listener_t;

/* A listener that has heard nothing yet, and listens to the line from now on. */
extern bench_listener_t bench_listener;
void listen_for(uint16_t gap_us);

/* It has heard these bytes, and after them those. */
void expect_heard(const uint8_t *bytes, size_t length, const uint8_t *more, size_t more_length);

#endif
