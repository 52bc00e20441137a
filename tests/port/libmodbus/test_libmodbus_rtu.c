/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1
#include "libmodbus_rig.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

/* RTU frames through a modbus_t: A05 3(4)1 example 3, and what its neighbours say. Other CRCs by the definition. */
static const uint8_t request[] = {0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6};
static const uint8_t response[] = {0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47};

enum { SILENCE_US = 4011, GAP_US = 25000 };

static void ask(uint8_t retries)
{
    rig_ask_three(&rig.request, 1, retries);
    rig_run_fine(SILENCE_US + FINE_US);
    rig_expect_sent(request, sizeof request);
}

static void answered(void)
{
    rig_say(response, sizeof response);
    rig_run_fine(FINE_US);
    rig_expect_three();
}

static const suite_t suite = {.set_up = rig_rtu_set_up, .tear_down = rig_tear_down};

TEST(a_request_has_its_crc_once_and_its_response_is_read)
{
    ask(0);
    answered();
}

/* What it says in its default, found out, is FATHOM_ERR_ECHO before the first read. */
TEST(the_config_says_whether_there_is_an_echo)
{
    static const uint8_t write[] = {0x01, 0x06, 0x00, 0x10, 0x00, 0x07};
    static const uint8_t outcomes[] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON};
    static const int expected[] = {FATHOM_ERR_ECHO, FATHOM_OK, FATHOM_ERR_NO_RESPONSE};
    for (size_t i = 0; i != sizeof outcomes; i++) {
        rig_again(i == 0);
        const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock, .echo = outcomes[i]};
        uint8_t sent[16];
        assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
        rig.request.transaction.timeout_us = RIG_TIMEOUT_US;
        fathom_modbus_write_single_register(&rig.request.message, 1, 0x0010, 7);
        assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_PENDING);
        rig_run_fine(SILENCE_US + FINE_US);
        assert_int_equal(recv(rig.far, sent, sizeof sent, MSG_DONTWAIT), 8);
        assert_memory_equal(sent, write, sizeof write);
        rig_say(sent, 8);
        rig_run_fine(RIG_TIMEOUT_US + 1000);
        assert_int_equal(status(), expected[i]);
    }
}

TEST(the_config_has_the_silence_and_the_gap)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock, .silence_us = 1750, .gap_us = 3000};
    assert_int_equal(rig.port.parts.gap_us, GAP_US); /* the default, behind an operating system */
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(1800);
    rig_expect_sent(request, sizeof request);
    rig_say(response, 5);
    rig_run_fine(FINE_US + 2800);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_run_fine(300);
    assert_int_equal(status(), FATHOM_ERR_CHECKSUM); /* it broke off */
}

TEST(units_over_247_are_unsupported) { rig_expect_units_refused(248, 255); }

TEST(line_settings_are_unsupported_and_nothing_is_sent) { rig_expect_no_settings(SILENCE_US + FINE_US); }

/* It would sleep until the request has left. */
TEST(a_transceiver_that_libmodbus_switches_is_unsupported)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock};
    assert_int_equal(modbus_rtu_set_rts(rig.modbus, MODBUS_RTU_RTS_UP), 0);
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_ERR_UNSUPPORTED);
}

TEST(a_port_that_hangs_up_is_broken_and_works_again_when_it_is_back)
{
    ask(3);
    rig_hang_up();
    rig_expect_broken(FATHOM_LIBMODBUS_ERR_HUNG_UP);
    rig_connect();
    rig_run_fine(2 * RIG_TIMEOUT_US); /* its quarantine */
    ask(0);
    answered();
    assert_int_equal(fathom_libmodbus_error(&rig.port), FATHOM_LIBMODBUS_OK);
}

/* As libmodbus opens it, and as it looks when the far end of a pseudo terminal closes. */
TEST(a_terminal_that_hangs_up_is_broken)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock};
    const int far = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(far >= 0 && grantpt(far) == 0 && unlockpt(far) == 0);
    assert_int_equal(rig_tear_down(NULL), 0);
    rig.modbus = modbus_new_rtu(ptsname(far), 19200, 'N', 8, 1);
    rig.far = -1;
    (void)alarm(RIG_ALARM_S);
    assert_int_equal(modbus_connect(rig.modbus), 0);
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
    rig.transport = rig.port.modbus;
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(SILENCE_US + FINE_US);
    assert_int_equal(rig.request.transaction.attempts, 1);
    assert_int_equal(close(far), 0);
    rig_expect_broken(FATHOM_LIBMODBUS_ERR_HUNG_UP);
}

TEST(a_modbus_t_that_is_not_connected_is_a_broken_port)
{
    modbus_close(rig.modbus);
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(SLOW_US);
    rig_expect_broken(FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    assert_true(rig.port.uart.write(rig.port.uart.ctx, request, sizeof request) < 0);
    assert_true(rig.port.uart.sent(rig.port.uart.ctx)); /* the line does not wait for it */
}

TEST(a_full_port_is_busy_and_nothing_waits)
{
    const size_t filled = rig_fill();
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(2 * SILENCE_US);
    assert_int_equal(rig.request.transaction.attempts, 0);
    assert_false(rig.port.uart.sent(rig.port.uart.ctx));
    rig_drain(filled);
    assert_true(rig.port.uart.sent(rig.port.uart.ctx));
    rig_run_fine(FINE_US);
    rig_expect_sent(request, sizeof request);
}
