/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "fathom_loop.h"
#include "tty.h"

/* port/posix on the 8250s of a PC: settings, who has a port, traffic; and a sensor at the other end of the cable. ttyS1
 * and ttyS2 are joined by it, behind ttyS3 there is nothing. */

#define NEAR "/dev/ttyS1"
#define FAR  "/dev/ttyS2"

/* ---- settings ---- */

GUEST_CASE(every_setting_is_what_the_chip_has)
{
    static const tty_settings_t rows[] = {
        {1200, B1200, FATHOM_PARITY_EVEN, 1},    {2400, B2400, FATHOM_PARITY_EVEN, 1},
        {4800, B4800, FATHOM_PARITY_EVEN, 1},    {9600, B9600, FATHOM_PARITY_EVEN, 1},
        {19200, B19200, FATHOM_PARITY_EVEN, 1},  {19200, B19200, FATHOM_PARITY_ODD, 1},
        {19200, B19200, FATHOM_PARITY_NONE, 2},  {19200, B19200, FATHOM_PARITY_NONE, 1},
        {38400, B38400, FATHOM_PARITY_EVEN, 1},  {57600, B57600, FATHOM_PARITY_EVEN, 1},
        {115200, B115200, FATHOM_PARITY_EVEN, 1}};
    tty_takes_each(NEAR, rows, sizeof rows / sizeof rows[0]);
}

GUEST_CASE(a_rate_above_the_chips_is_refused)
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

GUEST_CASE(a_name_without_a_uart_is_not_found)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    CHECK_INT(fathom_posix_open(&tty_port, "/dev/ttyS3", &settings), FATHOM_POSIX_ERR_NOT_FOUND);
    CHECK_SAYS(fathom_posix_error_text(&tty_port), "no UART behind this name");
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

enum { USER = 1000 };

GUEST_CASE(a_user_is_kept_out_by_tiocexcl_alone)
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

/* ---- traffic ---- */

GUEST_CASE(sent_waits_for_the_last_stop_bit)
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

GUEST_CASE(line_errors_are_counted_by_the_driver)
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

/* ---- a sensor: read, lost, and read again; by the port, the loop and the tool ---- */

/* A measurement, and its response (HPS-167S, tables 17 and 18). */
static const uint8_t ask[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
static const uint8_t says_2083[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                    0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

/* In another process; it ends with the case. */
static void begin_sensor(void)
{
    uint8_t heard[sizeof ask] = {0};
    const int fd = tty_raw(FAR, B19200, PARENB);
    if (fork() != 0) {
        (void)close(fd);
        return;
    }
    for (;;) {
        uint8_t byte;
        if (tty_receive(fd, &byte, 1, 1000) != 1) continue;
        memmove(heard, heard + 1, sizeof heard - 1);
        heard[sizeof heard - 1] = byte;
        if (memcmp(heard, ask, sizeof ask) == 0 && write(fd, says_2083, sizeof says_2083) < 0) _exit(1);
    }
}

GUEST_CASE(a_sensor_is_read_from_tty_to_tty)
{
    const fathom_uart_t uart = tty_open(NEAR, 19200, FATHOM_PARITY_EVEN, 1);
    begin_sensor();
    for (int i = 0; i != 5; i++) tty_reads_2083(&uart);
}

/* ---- hang-up ---- */

static void hang_up(void)
{
    const int fd = open(NEAR, O_RDWR | O_NOCTTY | O_NONBLOCK);
    CHECK(fd >= 0);
    CHECK_INT(ioctl(fd, TIOCVHANGUP), 0);
    (void)close(fd);
}

GUEST_CASE(a_hang_up_is_a_lost_port)
{
    const fathom_uart_t uart = tty_open(NEAR, 19200, FATHOM_PARITY_EVEN, 1);
    fathom_posix_line_errors_t errors;
    uint8_t byte;
    fathom_rx_t rx = {0};
    CHECK_INT(uart.read(uart.ctx, &byte, 1, &rx), 0);
    hang_up();
    const uint64_t began_us = fathom_posix_now_us();
    fathom_posix_wait(&tty_port, 5000000);
    CHECK_WITHIN(fathom_posix_now_us() - began_us, 0, 1000000); /* it wakes a program */
    CHECK_INT(uart.read(uart.ctx, &byte, 1, &rx), -1);
    CHECK_INT(fathom_posix_error(&tty_port), FATHOM_POSIX_ERR_LOST);
    CHECK_INT(uart.write(uart.ctx, &byte, 1), -1);
    CHECK_INT(fathom_posix_line_errors(&tty_port, &errors), FATHOM_POSIX_ERR_LOST);
    CHECK_INT(fathom_posix_set_rs485(&tty_port, NULL), FATHOM_POSIX_ERR_LOST);
    CHECK(uart.sent(uart.ctx)); /* so that no caller waits */
    fathom_posix_close(&tty_port);
    (void)tty_open(NEAR, 19200, FATHOM_PARITY_EVEN, 1); /* and it can be opened again */
}

/* ---- the loop ---- */

static struct {
    fathom_loop_t loop;
    fathom_loop_line_t line;
    fathom_hps167s_t gate;
    fathom_loop_sensor_t sensor;
    fathom_sample_t sample;
    int readings, port_errors, opened, lost;
} rig;

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    (void)ctx;
    CHECK(status == FATHOM_OK || status == FATHOM_ERR_PORT);
    if (status == FATHOM_ERR_PORT) {
        rig.port_errors++;
        return;
    }
    tty_is_2083(sample);
    rig.readings++;
    if (rig.readings % 5 == 0) fathom_loop_stop(&rig.loop);
}

static void tell(void *ctx, const fathom_loop_source_t *source, bool is_open)
{
    (void)ctx;
    if (is_open) {
        rig.opened++;
        return;
    }
    rig.lost++;
    CHECK_SAYS(fathom_loop_error_text(source), NEAR ": the device was unplugged or its far end closed");
}

static uint64_t processor_us(void)
{
    struct rusage used;
    CHECK_INT(getrusage(RUSAGE_SELF, &used), 0);
    return (uint64_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) * 1000000u +
           (uint64_t)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

GUEST_CASE(the_loop_reads_loses_and_opens_it_again)
{
    const fathom_loop_config_t config = {.tell = tell};
    CHECK_INT(fathom_loop_init(&rig.loop, &config), FATHOM_POSIX_OK);
    const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    begin_sensor();
    CHECK_INT(fathom_loop_add_line(&rig.loop, &rig.line, NEAR, &settings), FATHOM_POSIX_OK);
    CHECK_INT(fathom_hps167s_init(&rig.gate, &rig.line.bus.modbus, NULL), FATHOM_OK);
    rig.sensor.take = take;
    rig.sensor.sensor = fathom_hps167s_sensor(&rig.gate);
    fathom_loop_add_sensor(&rig.line.source, &rig.sensor);
    fathom_loop_run(&rig.loop);
    CHECK_INT(rig.readings, 5);
    CHECK_INT(rig.opened, 1);

    hang_up();
    while (rig.lost == 0) fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    const uint64_t began_us = fathom_posix_now_us();
    const uint64_t used_us = processor_us();
    while (rig.opened == 1) fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    /* The first pause is 500 ms. It is slept through: a loop that spins would take all of it. */
    CHECK_WITHIN(fathom_posix_now_us() - began_us, 450000, 1500000);
    CHECK_WITHIN(processor_us() - used_us, 0, 100000);
    CHECK_INT(rig.lost, 1);
    CHECK_INT(rig.port_errors, 1);

    fathom_loop_run(&rig.loop);
    CHECK_INT(rig.readings, 10);
    fathom_loop_deinit(&rig.loop);
}

/* ---- the tool ---- */

GUEST_CASE(the_tool_reads_the_sensor)
{
    static char out[2000];
    begin_sensor();
    CHECK_INT(guest_tool("read hps167s --port " NEAR " --count 3 --format csv", out, sizeof out), 0);
    CHECK_SAYS(out, "2083");
}

GUEST_CASE(the_tool_says_why_it_cannot)
{
    static char out[2000];
    CHECK_INT(guest_tool("read hps167s@" NEAR ",rs485=on --count 1", out, sizeof out), 1);
    CHECK_SAYS(out, "fathom: " NEAR ": the driver of this port does not drive an RS-485 transceiver");
    CHECK_SAYS(out, "use ");
    (void)tty_open(NEAR, 9600, FATHOM_PARITY_NONE, 1);
    CHECK_INT(guest_tool("read hps167s --port " NEAR " --count 1", out, sizeof out), 1);
    CHECK_SAYS(out, "fathom: " NEAR ": in use by another program");
}
