/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pc.h"
#include "tty.h"

/* port/posix on 8250s: settings, who has a port, traffic. */

/* ---- settings ---- */

static void parity_and_stop_bits_stick(void)
{
    static const struct {
        fathom_parity_t parity;
        uint8_t stop_bits;
        tcflag_t cflag;
    } rows[] = {{FATHOM_PARITY_EVEN, 1, PARENB},
                {FATHOM_PARITY_ODD, 1, PARENB | PARODD},
                {FATHOM_PARITY_NONE, 2, CSTOPB},
                {FATHOM_PARITY_NONE, 1, 0}};
    (void)tty_open(NEAR, 9600, FATHOM_PARITY_NONE, 1);
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        const fathom_line_settings_t settings = {19200, (uint8_t)rows[i].parity, rows[i].stop_bits};
        CHECK_INT(fathom_posix_set_line(&tty_port, &settings), FATHOM_POSIX_OK);
        tty_has(NEAR, rows[i].cflag, B19200);
        /* The chip's own registers: parity N, E or O, stop bits. */
        static const char letters[] = {
            [FATHOM_PARITY_NONE] = 'N', [FATHOM_PARITY_EVEN] = 'E', [FATHOM_PARITY_ODD] = 'O'};
        CHECK_INT(guest_ask("chip 19200 %c %d", letters[rows[i].parity], rows[i].stop_bits), 1);
    }
}

static void every_rate_up_to_115200_is_what_the_chip_has(void)
{
    static const struct {
        uint32_t baud;
        speed_t speed;
    } rows[] = {{1200, B1200},   {2400, B2400},   {4800, B4800},   {9600, B9600},
                {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)tty_open(NEAR, rows[i].baud, FATHOM_PARITY_EVEN, 1);
        tty_has(NEAR, PARENB, rows[i].speed);
        CHECK_INT(guest_ask("chip %lu E 1", (unsigned long)rows[i].baud), 1);
        fathom_posix_close(&tty_port);
    }
}

static void a_rate_above_the_chips_is_refused(void)
{
    static const fathom_line_settings_t fast = {230400, FATHOM_PARITY_NONE, 1};
    fathom_uart_t uart = tty_open(NEAR, 57600, FATHOM_PARITY_ODD, 2);
    const int far = tty_raw(FAR, B57600, PARENB | PARODD | CSTOPB);
    CHECK_INT(fathom_posix_set_line(&tty_port, &fast), FATHOM_POSIX_ERR_REFUSED);
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "asked for raw 230400 8N1, the driver set ");
    tty_has(NEAR, PARENB | PARODD | CSTOPB, B57600); /* what held before holds, and the port works */
    CHECK_INT(guest_ask("chip 57600 O 2"), 1);
    char bytes[8];
    tty_write(&uart, "still on", 8);
    CHECK_INT(tty_receive(far, bytes, sizeof bytes, 500), 8);
    CHECK_INT(memcmp(bytes, "still on", 8), 0);
    fathom_posix_close(&tty_port);

    CHECK_INT(fathom_posix_open(&tty_port, NEAR, &fast), FATHOM_POSIX_ERR_REFUSED);
    CHECK_INT(fathom_posix_fd(&tty_port), -1);
    tty_has(NEAR, PARENB | PARODD | CSTOPB, B57600);
}

static void a_name_without_a_uart_is_not_found(void)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    CHECK_INT(fathom_posix_open(&tty_port, "/dev/ttyS3", &settings), FATHOM_POSIX_ERR_NOT_FOUND);
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "no UART behind this name");
}

static void rs485_is_refused_with_what_to_do(void)
{
    (void)tty_open(NEAR, 19200, FATHOM_PARITY_EVEN, 1);
    const fathom_posix_rs485_t rs485 = {.before_ms = 1};
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &rs485), FATHOM_POSIX_ERR_UNSUPPORTED);
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "does not drive an RS-485 transceiver");
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "use ");
}

/* ---- for one program alone ---- */

static int open_it(void *ctx)
{
    static fathom_posix_uart_t port;
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    (void)ctx;
    const fathom_posix_status_t status = fathom_posix_open(&port, NEAR, &settings);
    return -(int)status;
}

static int open_past_the_port(void *ctx)
{
    (void)ctx;
    return open(NEAR, O_RDWR | O_NOCTTY | O_NONBLOCK) >= 0 ? 0 : errno;
}

enum { ROOT = 0, USER = 1000 };

static void another_process_is_kept_out_by_the_lock(void)
{
    (void)tty_open(NEAR, 9600, FATHOM_PARITY_NONE, 1);
    CHECK_INT(guest_other_process(ROOT, open_past_the_port, NULL), 0); /* TIOCEXCL does not stop root */
    CHECK_INT(guest_other_process(ROOT, open_it, NULL), -FATHOM_POSIX_ERR_IN_USE);
    fathom_posix_close(&tty_port);
    CHECK_INT(guest_other_process(ROOT, open_it, NULL), 0);
}

static void a_user_is_kept_out_by_tiocexcl_alone(void)
{
    CHECK_INT(chmod(NEAR, 0666), 0);
    CHECK_INT(guest_other_process(USER, open_it, NULL), 0);
    const int other = open(NEAR, O_RDWR | O_NOCTTY | O_NONBLOCK); /* a program that knows no locks */
    CHECK_INT(ioctl(other, TIOCEXCL), 0);
    CHECK_INT(guest_other_process(USER, open_it, NULL), -FATHOM_POSIX_ERR_IN_USE);
    (void)close(other);
    CHECK_INT(guest_other_process(USER, open_it, NULL), 0);

    /* And such a program is kept out of ours, until it is closed. */
    (void)tty_open(NEAR, 9600, FATHOM_PARITY_NONE, 1);
    CHECK_INT(guest_other_process(USER, open_past_the_port, NULL), EBUSY);
    const int held = dup(fathom_posix_fd(&tty_port)); /* not the last close */
    fathom_posix_close(&tty_port);
    CHECK_INT(guest_other_process(USER, open_past_the_port, NULL), 0);
    (void)close(held);
}

static void a_user_without_the_right_is_told(void)
{
    CHECK_INT(chmod(NEAR, 0600), 0);
    CHECK_INT(guest_other_process(USER, open_it, NULL), -FATHOM_POSIX_ERR_PERMISSION);
}

/* ---- traffic ---- */

static void sent_waits_for_the_last_stop_bit(void)
{
    /* 12 bytes of 11 bits at 1200 baud: 110 ms. */
    const fathom_uart_t uart = tty_open(NEAR, 1200, FATHOM_PARITY_EVEN, 1);
    const int far = tty_raw(FAR, B1200, PARENB);
    const uint64_t began_us = fathom_posix_now_us();
    CHECK_INT(uart.write(uart.ctx, (const uint8_t *)"twelve bytes", 12), 12);
    CHECK(!uart.sent(uart.ctx));
    CHECK_WITHIN(uart.leaves_in_us(uart.ctx), 90000, 110000);
    while (!uart.sent(uart.ctx)) guest_sleep_ms(1);
    CHECK_WITHIN(fathom_posix_now_us() - began_us, 110000, 200000);
    char bytes[12];
    CHECK_INT(tty_receive(far, bytes, sizeof bytes, 500), 12);
    CHECK_INT(memcmp(bytes, "twelve bytes", 12), 0);
}

static void what_the_kernels_queue_does_not_hold_follows(void)
{
    static uint8_t block[250], got[64 * sizeof block];
    const fathom_uart_t uart = tty_open(NEAR, 115200, FATHOM_PARITY_NONE, 1);
    const int far = tty_raw(FAR, B115200, 0);
    size_t accepted = 0;
    CHECK_INT(tcflow(fathom_posix_fd(&tty_port), TCOOFF),
              0); /* the tty is stopped, its queue of 4 KiB fills */
    for (int n = (int)sizeof block; n > 0; accepted += (size_t)n) {
        for (size_t i = 0; i != sizeof block; i++) block[i] = (uint8_t)((accepted + i) % 251);
        CHECK(accepted < sizeof got - sizeof block);
        n = uart.write(uart.ctx, block, sizeof block);
        CHECK(n == 0 || n == (int)sizeof block);
    }
    CHECK_WITHIN(accepted, 3000, 6000);
    CHECK_INT(fathom_posix_poll_events(&tty_port), POLLIN | POLLOUT); /* the rest of one is kept */
    CHECK(!uart.sent(uart.ctx));
    CHECK_INT(tcflow(fathom_posix_fd(&tty_port), TCOON), 0);
    size_t count = 0;
    for (int tries = 0; tries != 300 && count != accepted; tries++) {
        (void)uart.sent(uart.ctx); /* hands over the rest */
        count += tty_receive(far, got + count, accepted - count, 20);
    }
    CHECK_INT(count, accepted);
    for (size_t i = 0; i != count; i++) CHECK_INT(got[i], i % 251);
    CHECK_INT(tty_receive(far, got, 1, 50), 0);
    CHECK_INT(fathom_posix_poll_events(&tty_port), POLLIN);
}

static void line_errors_are_counted_by_the_driver(void)
{
    fathom_posix_line_errors_t before;
    fathom_posix_line_errors_t after;
    uint8_t byte = 0xA5;
    (void)tty_open(NEAR, 19200, FATHOM_PARITY_EVEN, 1);
    CHECK_INT(fathom_posix_line_errors(&tty_port, &before), FATHOM_POSIX_OK);
    (void)guest_ask("break near");
    CHECK_INT(tty_receive(fathom_posix_fd(&tty_port), &byte, 1, 500), 1);
    CHECK_INT(byte, 0); /* which is how it is read */
    CHECK_INT(fathom_posix_line_errors(&tty_port, &after), FATHOM_POSIX_OK);
    CHECK_INT(after.breaks - before.breaks, 1);
    CHECK_INT(after.parity - before.parity, 0);
    CHECK_INT(after.framing - before.framing, 0);
    CHECK_INT(after.overrun - before.overrun, 0);
}

const guest_case_t pc_port_cases[] = {
    GUEST_CASE(parity_and_stop_bits_stick),
    GUEST_CASE(every_rate_up_to_115200_is_what_the_chip_has),
    GUEST_CASE(a_rate_above_the_chips_is_refused),
    GUEST_CASE(a_name_without_a_uart_is_not_found),
    GUEST_CASE(rs485_is_refused_with_what_to_do),
    GUEST_CASE(another_process_is_kept_out_by_the_lock),
    GUEST_CASE(a_user_is_kept_out_by_tiocexcl_alone),
    GUEST_CASE(a_user_without_the_right_is_told),
    GUEST_CASE(sent_waits_for_the_last_stop_bit),
    GUEST_CASE(what_the_kernels_queue_does_not_hold_follows),
    GUEST_CASE(line_errors_are_counted_by_the_driver),
};
const size_t pc_port_case_count = sizeof pc_port_cases / sizeof pc_port_cases[0];
