/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/*
 * Random traffic with one unit, on lines with and without echo, which the driver is not told: reads and writes in both
 * protocols, with retries; echoes and responses with a wrong bit, responses that are late or missing. Whatever comes:
 *  - a write is OK only if the unit has answered it,
 *  - a read is OK only with the unit's value,
 *  - a line with echo is never believed to have none.
 */
enum { RUNS = 300, TRANSACTIONS = 8, KINDS = 4 };

typedef enum { READ = 0, WRITE = 1, DYP_READ = 2, DYP_SET_ADDRESS = 3 } kind_t;

static uint32_t seed;
static uint16_t values[4];

static uint32_t below(uint32_t n)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)(seed >> 8) * n) >> 24);
}

static void damage(uint8_t *bytes, size_t length)
{
    bytes[below((uint32_t)length)] ^= (uint8_t)(1u << below(8));
}

static void ask_for(kind_t kind, uint16_t value)
{
    fathom_modbus_request_t *const request = &bench.request;
    fathom_status_t status = FATHOM_PENDING;
    memset(values, 0xA5, sizeof values);
    request->transaction.timeout_us = TIMEOUT_US;
    request->transaction.retries = (uint8_t)below(3);
    if (kind == READ || kind == DYP_READ)
        fathom_modbus_read_holding_registers(&request->message, 1, 0x0106, kind == READ ? 1 : 4, values);
    else
        fathom_modbus_write_single_register(&request->message, 1, 0x0205, value);
    if (kind == DYP_SET_ADDRESS)
        status = fathom_dyp_client_broadcast_address(&bench.line, request, (uint8_t)(value % 254 + 1));
    else if (kind == DYP_READ)
        status = fathom_dyp_client_submit(&bench.line, request);
    else
        status = fathom_modbus_client_submit(&bench.line, request);
    assert_int_equal(status, FATHOM_PENDING);
}

/* What the unit says to a request. */
static size_t make_response(kind_t kind, uint16_t value, const fake_write_t *request, uint8_t *response)
{
    const uint8_t high = (uint8_t)(value >> 8);
    const uint8_t low = (uint8_t)value;
    const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, high, low, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA};
    const uint8_t one[] = {0x01, 0x03, 0x02, high, low};
    uint16_t sum = 0;
    if (kind == WRITE || kind == DYP_SET_ADDRESS) {
        memcpy(response, request->bytes, request->length);
        return request->length;
    }
    if (kind == DYP_READ) {
        for (size_t i = 0; i != sizeof four; i++) sum = (uint16_t)(sum + (response[i] = four[i]));
        response[sizeof four] = (uint8_t)sum;
        return sizeof four + 1;
    }
    sum = 0xFFFF;
    for (size_t i = 0; i != sizeof one; i++) {
        sum ^= response[i] = one[i];
        for (int bit = 0; bit != 8; bit++) sum = (uint16_t)((sum & 1) != 0 ? sum >> 1 ^ 0xA001 : sum >> 1);
    }
    response[5] = (uint8_t)sum;
    response[6] = (uint8_t)(sum >> 8);
    return sizeof one + 2;
}

/* What follows a request on the wire; true: the unit's undamaged response is among it. */
static bool follow(kind_t kind, uint16_t value, bool echoes, const fake_write_t *request)
{
    uint8_t bytes[16];
    const uint32_t leaves_us = (uint32_t)request->length * BYTE_US;
    if (echoes) {
        memcpy(bytes, request->bytes, request->length);
        if (below(5) == 0) damage(bytes, request->length);
        come(BY_BYTE, 0, bytes, request->length);
    }
    const uint32_t delay_us = below(below(3) != 0 ? 20000 : 2 * TIMEOUT_US - 40000);
    const size_t length = make_response(kind, value, request, bytes);
    const uint32_t fate = below(10);
    if (fate >= 8) return false;
    if (fate >= 6) damage(bytes, length);
    come(BY_BYTE, leaves_us + delay_us, bytes, length);
    return fate < 6;
}

static unsigned ready[KINDS];

static void transaction(bool echoes, uint32_t step_us)
{
    const kind_t kind = (kind_t)below(KINDS);
    const uint16_t value = (uint16_t)(below(4) == 0 ? 0x0100 + below(256) : 1 + below(6000));
    size_t seen = bench.fake.written;
    bool is_answered = false;
    ask_for(kind, value);
    for (uint32_t i = 0; status_of(&bench.request) == FATHOM_PENDING; i++) {
        assert_true(i < 100000);
        run_in_steps(step_us, step_us);
        if (bench.fake.written == seen) continue;
        if (follow(kind, value, echoes, &bench.fake.writes[seen++])) is_answered = true;
    }
    if (status_of(&bench.request) == FATHOM_OK) {
        assert_true(is_answered);
        if (kind == READ || kind == DYP_READ) assert_int_equal(values[0], value);
        ready[kind]++;
    }
    if (echoes) assert_int_not_equal(known_echo(), FATHOM_LINE_ECHO_OFF);
    run_in_steps(4 * TIMEOUT_US, 1000); /* all quarantines are over */
}

static const suite_t suite = {.set_up = set_up};

TEST(no_traffic_makes_an_echo_an_acknowledgement)
{
    seed = 1;
    memset(ready, 0, sizeof ready);
    for (unsigned runs = 0; runs != RUNS; runs++) {
        const bool echoes = below(2) != 0;
        const uint32_t step_us = steps_us[below(2)];
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        for (unsigned n = 0; n != TRANSACTIONS; n++) transaction(echoes, step_us);
    }
    for (unsigned kind = 0; kind != KINDS; kind++) assert_true(ready[kind] > RUNS); /* it was no idle talk */
}
