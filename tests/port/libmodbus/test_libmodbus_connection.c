/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1
#include <time.h>

#include "fathom/sensor/hps167s.h"
#include "libmodbus_rig.h"

#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

/* What the port does when the connection is broken, full or not there, and how it begins. */

static const uint8_t request_1[] = {REQUEST(1)};
static const uint8_t response_1[] = {RESPONSE(1)};

static void ask(void)
{
    rig_ask_three(&rig.request, 1, 3); /* retries are not made on a broken connection */
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig_expect_request(1);
}

/* Everything queued has ended, and what is asked now ends too. */
static void expect_broken(fathom_libmodbus_error_t error)
{
    rig_expect_broken(error);
    rig_ask_three(&rig.request, 1, 0);
    rig_expect_broken(error); /* the first reason is kept */
    rig_expect_none();
}

/* After a new connection requests are answered; the unit may still be quarantined. */
static void expect_to_go_on(void)
{
    rig_connect();
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(2 * RIG_TIMEOUT_US);
    rig_expect_request(2);
    rig_answered(2);
    assert_int_equal(fathom_libmodbus_error(&rig.port), FATHOM_LIBMODBUS_OK);
}

static const suite_t suite = {.set_up = rig_tcp_set_up, .tear_down = rig_tear_down};

TEST(a_server_that_closes_breaks_it_until_there_is_a_new_connection)
{
    ask();
    rig_hang_up();
    expect_broken(FATHOM_LIBMODBUS_ERR_HUNG_UP);
    expect_to_go_on();
}

TEST(a_response_before_the_end_of_the_connection_is_read)
{
    ask();
    rig_say_response(1);
    rig_hang_up();
    (void)rig_poll();
    rig_expect_three();
}

TEST(half_a_response_and_the_end_break_it)
{
    for (size_t cut = 1; cut != sizeof response_1; cut++) {
        rig_again(cut == 1);
        ask();
        rig_say(response_1, cut);
        assert_int_equal(rig_poll(), FATHOM_PENDING);
        rig_hang_up();
        expect_broken(FATHOM_LIBMODBUS_ERR_HUNG_UP);
        expect_to_go_on();
    }
}

/* The far end of a socket pair that closes with a request unread is a reset. */
TEST(a_reset_has_the_systems_number)
{
    rig_ask_three(&rig.request, 1, 3);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig_hang_up();
    expect_broken(FATHOM_LIBMODBUS_ERR_SYSTEM);
    assert_int_equal(rig.port.system_error, ECONNRESET);
    expect_to_go_on();
}

TEST(a_modbus_t_that_is_not_connected_is_a_broken_port)
{
    ask();
    modbus_close(rig.modbus);
    expect_broken(FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    fathom_libmodbus_wait(&rig.port, FATHOM_NO_DEADLINE); /* returns at once */
    expect_to_go_on();
}

TEST(what_is_no_modbus_breaks_it_and_ends_the_connection)
{
    static const uint8_t nonsense[][9] = {
        {'H', 'T', 'T', 'P', '/', '1', '.', '1', ' '},
        {0xF0, 1, 0, 1, 0, 3, 1, 0x83, 2},   /* protocol 1 */
        {0xF0, 1, 1, 0, 0, 3, 1, 0x83, 2},   /* protocol 256 */
        {0xF0, 1, 0, 0, 0, 0, 1, 0x83, 2},   /* nothing follows */
        {0xF0, 1, 0, 0, 0, 1, 1, 0x83, 2},   /* a unit and no function */
        {0xF0, 1, 0, 0, 0, 255, 1, 0x83, 2}, /* more than Modbus has */
        {0xF0, 1, 0, 0, 1, 3, 1, 0x83, 2},
    };
    for (size_t i = 0; i != sizeof nonsense / sizeof nonsense[0]; i++) {
        uint8_t byte = 0;
        rig_again(i == 0);
        ask();
        rig_say(nonsense[i], sizeof nonsense[i]);
        expect_broken(FATHOM_LIBMODBUS_ERR_NONSENSE);
        assert_int_equal(recv(rig.far, &byte, 1, MSG_DONTWAIT), 0); /* the far end sees that it is over */
        expect_to_go_on();
    }
}

/* What follows it may look like a response, and is not. */
TEST(behind_what_is_no_modbus_nothing_is_read)
{
    static const uint8_t header[] = {0xF0, 1, 0, 1, 0, 9};
    static const uint8_t response[] = {RESPONSE(1)};
    ask();
    rig_say(header, sizeof header);
    rig_say(response, sizeof response);
    expect_broken(FATHOM_LIBMODBUS_ERR_NONSENSE);
    for (int i = 0; i != 5; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    assert_int_equal(fathom_libmodbus_error(&rig.port), FATHOM_LIBMODBUS_ERR_NONSENSE);
    expect_to_go_on();
}

/* The socket waits if it is let; then the alarm ends the test. */
TEST(a_full_connection_is_busy_and_nothing_waits)
{
    const size_t filled = rig_fill();
    rig_ask_three(&rig.request, 1, 0);
    for (int i = 0; i != 10; i++) assert_int_equal(rig_poll(), FATHOM_PENDING);
    assert_int_equal(rig.request.transaction.attempts, 0);
    rig_drain(filled);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig_expect_request(1);
    rig_answered(1);
}

TEST(a_connection_that_stays_full_is_broken_after_a_second)
{
    (void)rig_fill();
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(FATHOM_LINE_SEND_US - FINE_US);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_run_fine(3 * FINE_US);
    assert_int_equal(status(), FATHOM_ERR_PORT);
}

TEST(units_that_modbus_set_slave_refuses_are_unsupported) { rig_expect_units_refused(248, 254); }

TEST(line_settings_are_unsupported_and_nothing_is_sent) { rig_expect_no_settings(FINE_US); }

TEST(counts_out_of_range_are_refused)
{
    fathom_modbus_read_holding_registers(&rig.request.message, 1, 0, 126, rig.values);
    assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_ERR_ARGUMENT);
    rig_ask_three(&rig.request, 1, 0);
    assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_ERR_BUSY);
}

TEST(init_wants_all_that_it_needs)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock};
    assert_int_equal(fathom_libmodbus_init(NULL, rig.modbus, &config), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_libmodbus_init(&rig.port, NULL, &config), FATHOM_ERR_ARGUMENT);
}

TEST(without_a_config_the_clock_is_that_of_the_system)
{
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, NULL), FATHOM_OK);
    const fathom_clock_t *const clock = rig.port.parts.clock;
    const uint32_t before_us = clock->now_us(clock->ctx);
    (void)nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    assert_in_range(clock->now_us(clock->ctx) - before_us, 2000, 60000000);
}

TEST(a_driver_reads_by_the_transport_of_the_port)
{
    static fathom_hps167s_t gate;
    fathom_sample_t sample;
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, NULL), FATHOM_OK);
    assert_int_equal(fathom_hps167s_init(&gate, &rig.port.modbus, NULL), FATHOM_OK);
    rig_hang_up();
    assert_int_equal(fathom_libmodbus_read(&rig.port, fathom_hps167s_sensor(&gate), &sample),
                     FATHOM_ERR_PORT);
    assert_int_equal(fathom_libmodbus_error(&rig.port), FATHOM_LIBMODBUS_ERR_HUNG_UP);
}

/* Else libmodbus would sleep and connect by itself when sending fails: the alarm ends that. */
TEST(libmodbus_does_not_recover_by_itself)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock};
    assert_int_equal(modbus_set_error_recovery(rig.modbus, MODBUS_ERROR_RECOVERY_LINK), 0);
    assert_int_equal(modbus_set_response_timeout(rig.modbus, 2 * RIG_ALARM_S, 0), 0);
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
    rig_hang_up();
    assert_true(modbus_send_raw_request(rig.modbus, request_1 + 6, 6) < 0);
}

TEST(a_wait_ends_when_a_byte_is_there_or_the_far_end_has_gone)
{
    ask();
    rig_say(response_1, 1);
    fathom_libmodbus_wait(&rig.port, FATHOM_NO_DEADLINE);
    rig_say(response_1 + 1, sizeof response_1 - 1);
    (void)rig_poll();
    rig_expect_three();
    fathom_libmodbus_wait(&rig.port, 1000);
    rig_hang_up();
    fathom_libmodbus_wait(&rig.port, FATHOM_NO_DEADLINE);
}
