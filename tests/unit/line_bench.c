/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "hex.h"

const uint8_t ask_1_processed[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
const uint8_t response_1_754[] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};
const uint8_t response_1_751[] = {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8};
const uint8_t set_address_5[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71};
const uint8_t exception_1_2[] = {0x01, 0x83, 0x02, 0xC0, 0xF1};
const uint8_t set_36_ms[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0x24, 0xF1, 0xAC};
const uint8_t set_ms_done[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02};
const uint8_t response_1_three[] = {0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47};
const uint8_t dyp_four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
const uint8_t dyp_first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};
const uint8_t auto_frame[] = {0xFF, 0x07, 0xA1, 0xA7};

bench_t bench;
bench_listener_t bench_listener;

void show_empty_port(void)
{
    assert_int_equal(poll_line(), FATHOM_PENDING);
    bench.fake.reads = 0;
}

static void begin_line(void)
{
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    show_empty_port();
}

int set_up(void **state)
{
    memset(&bench, 0, sizeof bench);
    memset(&bench.line, 0xA5, sizeof bench.line); /* line.h: fathom_line_init() needs no zeros */
    fake_init(&bench.fake);
    bench.fake.byte_us = BYTE_US;
    bench.config = (fathom_line_parts_t){.uart = &bench.fake.uart,
                                         .clock = &bench.fake.clock,
                                         .frame = bench.frame,
                                         .frame_size = sizeof bench.frame,
                                         .echo = FATHOM_LINE_ECHO_OFF,
                                         .silence_us = T3_5_US,
                                         .gap_us = GAP_US,
                                         .find_echo = fathom_line_find_echo,
                                         .marks = fathom_line_marks,
                                         .count = fathom_line_count,
                                         .counters = bench.counters,
                                         .senders = &fathom_line_senders};
    begin_line();
    *state = &bench;
    return 0;
}

void run_in_steps(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        bench.fake.now_us += step_us;
        poll_line();
    }
}

void set_up_echo(uint8_t echo)
{
    bench.config.echo = echo;
    begin_line();
}

void run(uint32_t for_us) { run_in_steps(for_us, 100); }

fathom_status_t poll_line(void) { return fathom_line_poll(&bench.line); }

uint32_t due(void) { return fathom_line_due_us(&bench.line); }

void submit(fathom_modbus_request_t *request)
{
    request->transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit_with_zero(&bench.line, request), FATHOM_PENDING);
}

void submit_dyp(fathom_modbus_request_t *request)
{
    request->transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, request), FATHOM_PENDING);
}

void ask(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value, uint8_t retries)
{
    fathom_modbus_read_holding_registers(&request->message, unit, 0x0100, 1, value);
    request->transaction.retries = retries;
    *value = 0xDEAD;
    submit(request);
}

void ask_dyp(fathom_modbus_request_t *request, uint8_t unit, uint8_t count, uint16_t *values)
{
    fathom_modbus_read_holding_registers(&request->message, unit, 0x0106, count, values);
    for (uint8_t i = 0; i != count; i++) values[i] = 0xDEAD;
    submit_dyp(request);
}

void ask_to_write(fathom_modbus_request_t *request, uint8_t unit)
{
    fathom_modbus_write_single_register(&request->message, unit, 0x0200, 5);
    submit(request);
}

void ask_to_write_36_ms(void)
{
    static const uint16_t values[] = {0, 36};
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0x0020, 2, values);
    submit(&bench.request);
}

void ask_1(uint8_t retries) { ask(&bench.request, 1, &bench.value, retries); }

void ask_other(uint8_t unit) { ask(&bench.other, unit, &bench.other_value, 0); }

void ask_1_and_send(uint8_t retries)
{
    ask_1(retries);
    run(T3_5_US + 200);
    expect_written(1);
    run(8 * BYTE_US + 100);
}

int set_up_asked(void **state)
{
    set_up(state);
    ask_1_and_send(0);
    return 0;
}

int set_up_quarantined(void **state)
{
    set_up_asked(state);
    run(TIMEOUT_US + 200);
    expect(FATHOM_ERR_NO_RESPONSE);
    return 0;
}

void receive(const uint8_t *bytes, size_t length) { fake_receive(&bench.fake, 0, bytes, length); }

void receive_hex(const char *hex)
{
    uint8_t bytes[32];
    receive(bytes, hex_parse(hex, bytes));
}

void receive_rx(const uint8_t *bytes, size_t length, uint8_t flags)
{
    fake_receive_rx(&bench.fake, 0, bytes, length, (fathom_rx_t){0, flags});
}

/* The CRC by the bitwise definition. */
void receive_response(uint8_t unit, uint16_t value)
{
    uint8_t frame[] = {unit, 0x03, 0x02, (uint8_t)(value >> 8), (uint8_t)value, 0, 0};
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != 5; i++) {
        crc ^= frame[i];
        for (int bit = 0; bit != 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    frame[5] = (uint8_t)crc;
    frame[6] = (uint8_t)(crc >> 8);
    receive_all(frame);
}

void deliver(const uint8_t *bytes, size_t length)
{
    receive(bytes, length);
    run(100);
}

void deliver_hex(const char *hex)
{
    receive_hex(hex);
    run(100);
}

void deliver_response(uint8_t unit, uint16_t value)
{
    receive_response(unit, value);
    run(100);
}

void receive_damaged(void)
{
    uint8_t damaged[sizeof response_1_754];
    memcpy(damaged, response_1_754, sizeof damaged);
    damaged[4] ^= 0x10;
    receive_all(damaged);
}

void response_1(uint16_t value)
{
    deliver_response(1, value);
    expect_mm(value);
}

void response_other(uint8_t unit, uint16_t value)
{
    deliver_response(unit, value);
    expect_other(FATHOM_OK);
    assert_int_equal(bench.other_value, value);
}

void cancel(fathom_modbus_request_t *request) { fathom_modbus_client_cancel(&bench.line, request); }

void break_port(void)
{
    bench.fake.read_fails = true;
    assert_int_equal(poll_line(), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    assert_int_equal(poll_line(), FATHOM_PENDING); /* The line drops what the port holds (line.h, rule 14). */
}

fathom_status_t status_of(const fathom_modbus_request_t *request)
{
    return (fathom_status_t)request->transaction.status;
}

unsigned counter(unsigned which) { return bench.counters[which]; }

void expect_mm(uint16_t value)
{
    expect(FATHOM_OK);
    assert_int_equal(bench.value, value);
}

void expect_failed(fathom_status_t status)
{
    expect(status);
    assert_int_equal(bench.value, 0xDEAD);
}

void expect_sent(uint32_t after_us, uint32_t within_us)
{
    const size_t before = bench.fake.written;
    run(after_us);
    expect_written(before);
    run(within_us);
    expect_written(before + 1);
}

void expect_bytes(size_t which, const uint8_t *bytes, size_t length)
{
    assert_true(which < bench.fake.written);
    assert_int_equal(bench.fake.writes[which].length, length);
    assert_memory_equal(bench.fake.writes[which].bytes, bytes, length);
}

void expect_hex(size_t which, const char *hex)
{
    uint8_t bytes[32];
    expect_bytes(which, bytes, hex_parse(hex, bytes));
}

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    assert_ptr_equal(listener, &bench_listener.base);
    assert_true(bench_listener.length + count <= sizeof bench_listener.bytes);
    if (count == 0) bench_listener.losses++, bench_listener.lost_at = bench_listener.length;
    if (after_gap) bench_listener.gaps++, bench_listener.gap_at = bench_listener.length;
    memcpy(bench_listener.bytes + bench_listener.length, bytes, count);
    bench_listener.length += count;
    bench_listener.calls++;
    bench_listener.time_us = time_us;
}

void listen_for(uint16_t gap_us)
{
    memset(&bench_listener, 0, sizeof bench_listener);
    bench_listener.base.receive = hear;
    bench_listener.base.gap_us = gap_us;
    (void)fathom_line_replace_listener(&bench.line, &bench_listener.base);
}

void expect_heard(const uint8_t *bytes, size_t length, const uint8_t *more, size_t more_length)
{
    assert_int_equal(bench_listener.length, length + more_length);
    assert_memory_equal(bench_listener.bytes, bytes, length);
    assert_memory_equal(bench_listener.bytes + length, more, more_length);
}
