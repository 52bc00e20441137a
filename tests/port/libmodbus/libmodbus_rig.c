/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1
#include "libmodbus_rig.h"

#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

rig_t rig;

enum { UNTOUCHED = 0x5A5A };

void rig_connect(void)
{
    int ends[2];
    modbus_close(rig.modbus);
    if (rig.far >= 0) (void)close(rig.far);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    assert_int_equal(modbus_set_socket(rig.modbus, ends[0]), 0);
    rig.far = ends[1];
}

static int set_up(modbus_t *modbus)
{
    /* The unit's quarantine holds a request back as long as this. */
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock, .hold_us = RIG_TIMEOUT_US};
    (void)alarm(RIG_ALARM_S);
    memset(&rig, 0, sizeof rig);
    fake_init(&rig.fake);
    rig.far = -1;
    rig.modbus = modbus;
    rig_connect();
    memset(&rig.port, 0xA5, sizeof rig.port); /* any content will do */
    assert_int_equal(fathom_libmodbus_init(&rig.port, modbus, &config), FATHOM_OK);
    rig.transport = rig.port.modbus;
    return 0;
}

static int (*again)(void **state);

int rig_tcp_set_up(void **state)
{
    again = rig_tcp_set_up;
    return set_up(modbus_new_tcp("127.0.0.1", 502));
}

int rig_rtu_set_up(void **state)
{
    again = rig_rtu_set_up;
    return set_up(modbus_new_rtu("/nowhere", 19200, 'E', 8, 1));
}

void rig_again(bool is_first)
{
    if (!is_first) assert_int_equal(rig_tear_down(NULL) + again(NULL), 0);
}

int rig_tear_down(void **state)
{
    if (rig.far >= 0) (void)close(rig.far);
    modbus_close(rig.modbus);
    modbus_free(rig.modbus);
    (void)alarm(0);
    return 0;
}

void rig_ask_three(fathom_modbus_request_t *request, uint8_t unit, uint8_t retries)
{
    for (size_t i = 0; i != sizeof rig.values / sizeof rig.values[0]; i++) rig.values[i] = UNTOUCHED;
    memset(request, 0, sizeof *request);
    request->transaction.timeout_us = RIG_TIMEOUT_US;
    request->transaction.retries = retries;
    fathom_modbus_read_holding_registers(&request->message, unit, 0x0107, 3, rig.values);
    assert_int_equal(rig.transport.submit(rig.transport.line, request), FATHOM_PENDING);
}

void rig_expect_three(void)
{
    assert_int_equal(rig.request.transaction.status, FATHOM_OK);
    assert_int_equal(rig.values[0], 250);
    assert_int_equal(rig.values[1], 659);
    assert_int_equal(rig.values[2], 2426);
    assert_int_equal(rig.values[3], UNTOUCHED);
}

void rig_expect_none(void)
{
    for (size_t i = 0; i != sizeof rig.values / sizeof rig.values[0]; i++)
        assert_int_equal(rig.values[i], UNTOUCHED);
}

void rig_run(uint32_t in_us, uint32_t step_us)
{
    for (uint32_t us = 0; us < in_us; us += step_us) {
        rig.fake.now_us += step_us;
        (void)fathom_line_poll(rig.transport.line);
    }
}

fathom_status_t rig_poll(void)
{
    rig.fake.now_us += FINE_US;
    return fathom_line_poll(rig.transport.line);
}

void rig_hang_up(void)
{
    assert_int_equal(close(rig.far), 0);
    rig.far = -1;
}

static uint8_t junk[4096];

size_t rig_fill(void)
{
    size_t filled = 0;
    ssize_t n = 0;
    while ((n = send(modbus_get_socket(rig.modbus), junk, sizeof junk, MSG_DONTWAIT)) > 0)
        filled += (size_t)n;
    return filled;
}

void rig_drain(size_t filled)
{
    while (filled != 0) {
        const ssize_t n = recv(rig.far, junk, sizeof junk, MSG_DONTWAIT);
        assert_true(n > 0);
        filled -= (size_t)n;
    }
}

void rig_expect_broken(fathom_libmodbus_error_t error)
{
    assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    assert_int_equal(status(), FATHOM_ERR_PORT);
    assert_int_equal(fathom_libmodbus_error(&rig.port), error);
}

void rig_expect_no_settings(uint32_t in_us)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    rig_ask_three(&rig.request, 1, 0);
    rig.request.transaction.line_settings = &settings;
    rig_run_fine(in_us);
    assert_int_equal(status(), FATHOM_ERR_UNSUPPORTED);
    rig_expect_sent(NULL, 0);
}

void rig_expect_units_refused(unsigned first, unsigned last)
{
    assert_int_equal(modbus_set_slave(rig.modbus, 42), 0);
    for (unsigned unit = 0; unit != 256; unit++) {
        fathom_modbus_write_single_register(&rig.request.message, (uint8_t)unit, 0x0010, 7);
        assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request),
                         unit >= first && unit <= last ? FATHOM_ERR_UNSUPPORTED : FATHOM_PENDING);
        fathom_line_cancel(rig.transport.line, &rig.request.transaction);
        assert_int_equal(modbus_get_slave(rig.modbus), 42); /* the program's own */
    }
}

void rig_say(const void *bytes, size_t length)
{
    assert_int_equal(send(rig.far, bytes, length, MSG_NOSIGNAL), length);
}

void rig_expect_sent(const void *bytes, size_t length)
{
    uint8_t sent[600];
    const ssize_t n = recv(rig.far, sent, sizeof sent, MSG_DONTWAIT);
    if (length == 0) {
        assert_true(n < 0 && errno == EAGAIN);
        return;
    }
    assert_int_equal(n, length);
    assert_memory_equal(sent, bytes, length);
}

void rig_expect_request(uint8_t transaction) { rig_expect_sent((const uint8_t[]){REQUEST(transaction)}, 12); }

void rig_say_response(uint8_t transaction) { rig_say((const uint8_t[]){RESPONSE(transaction)}, 15); }

void rig_answered(uint8_t transaction)
{
    rig_say_response(transaction);
    rig_run_fine(FINE_US);
    rig_expect_three();
}

void rig_ask(uint8_t retries)
{
    rig_ask_three(&rig.request, 1, retries);
    rig_run_fine(FINE_US);
    rig_expect_request(1);
    assert_int_equal(status(), FATHOM_PENDING);
}
