/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1
#include "libmodbus_rig.h"

#include <errno.h>
#include <sys/socket.h>

/* A system that takes a part of a request, or refuses it for a while. */

static struct {
    size_t most; /* bytes; 0: all */
    int error;
} sending;

ssize_t __real_send(int fd, const void *bytes, size_t length, int flags);
ssize_t __wrap_send(int fd, const void *bytes, size_t length, int flags);
int __real_modbus_send_raw_request(modbus_t *modbus, const uint8_t *bytes, int length);
int __wrap_modbus_send_raw_request(modbus_t *modbus, const uint8_t *bytes, int length);

ssize_t __wrap_send(int fd, const void *bytes, size_t length, int flags)
{
    if (sending.error != 0 && fd == modbus_get_socket(rig.modbus)) {
        errno = sending.error;
        return -1;
    }
    if (sending.most != 0 && length > sending.most) length = sending.most;
    return __real_send(fd, bytes, length, flags);
}

/* As libmodbus 3.1.6 tells a part: EMBBADDATA. */
int __wrap_modbus_send_raw_request(modbus_t *modbus, const uint8_t *bytes, int length)
{
    if (sending.error == 0) return __real_modbus_send_raw_request(modbus, bytes, length);
    errno = sending.error;
    return -1;
}

/* While sending has that error. */
static void ask(int error)
{
    sending.error = error;
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(5000);
    sending.error = 0;
}

static void expect_port(fathom_libmodbus_error_t error)
{
    assert_int_equal(status(), FATHOM_ERR_PORT);
    assert_int_equal(fathom_libmodbus_error(&rig.port), error);
}

static const suite_t suite = {.set_up = rig_tcp_set_up, .tear_down = rig_tear_down};
static const suite_t with_rig_rtu_set_up = {.set_up = rig_rtu_set_up, .tear_down = rig_tear_down};

TEST(a_part_of_a_request_ends_the_connection)
{
    uint8_t byte = 0;
    sending.most = 5;
    ask(0);
    sending.most = 0;
    expect_port(FATHOM_LIBMODBUS_ERR_TRUNCATED);
    for (int i = 0; i != 5; i++) assert_int_equal(recv(rig.far, &byte, 1, MSG_DONTWAIT), 1);
    assert_int_equal(recv(rig.far, &byte, 1, MSG_DONTWAIT), 0); /* nothing can follow it */
}

TEST(what_is_refused_for_a_while_is_sent_later)
{
    static const int errors[] = {EAGAIN, EINTR};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        rig_again(i == 0);
        ask(errors[i]);
        assert_int_equal(status(), FATHOM_PENDING);
        rig_run_fine(FINE_US);
        rig_expect_request(1);
    }
}

TEST(what_the_system_says_else_is_kept)
{
    ask(EHOSTUNREACH);
    expect_port(FATHOM_LIBMODBUS_ERR_SYSTEM);
    assert_int_equal(rig.port.system_error, EHOSTUNREACH);
}

TEST_IN(with_rig_rtu_set_up, a_part_of_a_request_of_rtu_is_told_too)
{
    ask(EMBBADDATA);
    expect_port(FATHOM_LIBMODBUS_ERR_TRUNCATED);
}

TEST_IN(with_rig_rtu_set_up, what_rtu_is_refused_for_a_while_is_sent_later)
{
    ask(EAGAIN);
    assert_int_equal(status(), FATHOM_PENDING);
    assert_int_equal(rig.request.transaction.attempts, 0);
    rig_run_fine(FINE_US);
    assert_int_equal(rig.request.transaction.attempts, 1);
}

TEST_IN(with_rig_rtu_set_up, an_adapter_that_was_unplugged_has_hung_up)
{
    static const int errors[] = {EIO, ENXIO, ENODEV};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        rig_again(i == 0);
        ask(errors[i]);
        expect_port(FATHOM_LIBMODBUS_ERR_HUNG_UP);
    }
}
