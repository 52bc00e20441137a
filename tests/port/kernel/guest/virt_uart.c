/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include <fcntl.h>
#include <linux/serial.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tty.h"

/* port/posix on a PL011, whose other end is test_virt.py's. */

#define PORT "/dev/ttyAMA0"

GUEST_CASE(every_setting_is_what_the_chip_has)
{
    static const tty_settings_t rows[] = {
        {1200, B1200, FATHOM_PARITY_NONE, 1},     {9600, B9600, FATHOM_PARITY_NONE, 2},
        {19200, B19200, FATHOM_PARITY_EVEN, 1},   {57600, B57600, FATHOM_PARITY_ODD, 1},
        {115200, B115200, FATHOM_PARITY_EVEN, 2}, {230400, B230400, FATHOM_PARITY_NONE, 1},
        {460800, B460800, FATHOM_PARITY_EVEN, 1}, {921600, B921600, FATHOM_PARITY_ODD, 1}};
    tty_takes_each(PORT, rows, sizeof rows / sizeof rows[0]);
}

GUEST_CASE(a_break_holds_the_wire_low_until_it_ends)
{
    const fathom_uart_t uart = tty_open(PORT, 9600, FATHOM_PARITY_NONE, 1);
    CHECK_INT(guest_ask("is_in_break"), 0);
    CHECK_INT(uart.set_break(uart.ctx, true), 1);
    CHECK_INT(guest_ask("is_in_break"), 1);
    CHECK_INT(uart.set_break(uart.ctx, false), 1);
    CHECK_INT(guest_ask("is_in_break"), 0);
}

/* ---- RS-485 ---- */

/* As the driver has it, through a descriptor of one's own. */
static void driver_has(uint32_t flags, uint32_t before_ms, uint32_t after_ms)
{
    struct serial_rs485 got;
    const int fd = open(PORT, O_RDWR | O_NOCTTY | O_NONBLOCK);
    CHECK_INT(ioctl(fd, TIOCGRS485, &got), 0);
    CHECK_INT(got.flags, flags);
    CHECK_INT(got.delay_rts_before_send, before_ms);
    CHECK_INT(got.delay_rts_after_send, after_ms);
    (void)close(fd);
}

/* Sends five bytes. The chip's RTS is on meanwhile, or off, and the other way before and after, for the times. */
static void turns_round(const fathom_uart_t *uart, const char *level, unsigned before_ms, unsigned after_ms)
{
    (void)guest_ask("listen");
    tty_write(uart, "bytes", 5);
    guest_sleep_ms(after_ms + 50);
    (void)guest_ask("turned %s %u %u", level, before_ms, after_ms);
}

GUEST_CASE(rs485_is_set_and_read_back)
{
    const fathom_uart_t uart = tty_open(PORT, 19200, FATHOM_PARITY_EVEN, 1);
    const fathom_posix_rs485_t rs485 = {.before_ms = 20, .after_ms = 40};
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &rs485), FATHOM_POSIX_OK);
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND, 20, 40);
    turns_round(&uart, "on", 20, 40);
    const fathom_line_settings_t faster = {230400, FATHOM_PARITY_NONE, 1};
    CHECK_INT(fathom_posix_set_line(&tty_port, &faster), FATHOM_POSIX_OK); /* over which it holds, ... */
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND, 20, 40);
    turns_round(&uart, "on", 20, 40);
    fathom_posix_close(&tty_port); /* ... and after close */
    (void)tty_open(PORT, 9600, FATHOM_PARITY_NONE, 1);
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND, 20, 40);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_OK);
    driver_has(0, 0, 0);
}

GUEST_CASE(rs485_is_set_the_other_way_round)
{
    const fathom_uart_t uart = tty_open(PORT, 19200, FATHOM_PARITY_EVEN, 1);
    const fathom_posix_rs485_t rs485 = {.rts_off_to_send = true, .before_ms = 10};
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &rs485), FATHOM_POSIX_OK);
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_AFTER_SEND, 10, 0);
    turns_round(&uart, "off", 10, 0);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_OK);
}

GUEST_CASE(a_delay_that_the_kernel_cuts_is_refused)
{
    (void)tty_open(PORT, 19200, FATHOM_PARITY_EVEN, 1);
    const fathom_posix_rs485_t good = {.before_ms = 1, .after_ms = 2};
    const fathom_posix_rs485_t slow = {.before_ms = 1, .after_ms = 101};
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &good), FATHOM_POSIX_OK);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &slow), FATHOM_POSIX_ERR_REFUSED);
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "to 101 ms after, the driver set RTS on while sending, "
                                                   "from 1 ms before to 100 ms after");
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND, 1, 2);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_OK);
}

/* ---- a sensor at the other end ---- */

GUEST_CASE(a_sensor_is_read_with_rs485)
{
    const fathom_uart_t uart = tty_open(PORT, 19200, FATHOM_PARITY_EVEN, 1);
    const fathom_posix_rs485_t rs485 = {0};
    CHECK_INT(fathom_posix_set_rs485(&tty_port, &rs485), FATHOM_POSIX_OK);
    for (int i = 0; i != 5; i++) tty_reads_2083(&uart);
    while (!uart.sent(uart.ctx)) guest_sleep_ms(1); /* the far end has answered sooner than a wire can */
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_OK);
}

GUEST_CASE(the_tool_reads_it_with_rs485)
{
    static char out[2000];
    CHECK_INT(guest_tool("read hps167s --port " PORT " --rs485 --count 3 --format csv", out, sizeof out), 0);
    CHECK_SAYS(out, "2083");
    driver_has(SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND, 0, 0);
    (void)tty_open(PORT, 19200, FATHOM_PARITY_EVEN, 1);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_OK);
}
