/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include "tty.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

fathom_posix_uart_t tty_port;

fathom_uart_t tty_open(const char *path, uint32_t baud, fathom_parity_t parity, uint8_t stop_bits)
{
    const fathom_line_settings_t settings = {baud, (uint8_t)parity, stop_bits};
    if (fathom_posix_open(&tty_port, path, &settings) != FATHOM_POSIX_OK)
        guest_fail(__FILE__, __LINE__, "%s", fathom_posix_error_text(&tty_port));
    return fathom_posix_uart(&tty_port);
}

int tty_raw(const char *path, speed_t speed, tcflag_t cflag)
{
    struct termios tty;
    const int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    CHECK(fd >= 0);
    CHECK_INT(tcgetattr(fd, &tty), 0);
    cfmakeraw(&tty);
    tty.c_iflag = 0;
    tty.c_cflag = CS8 | CREAD | CLOCAL | cflag;
    (void)cfsetospeed(&tty, speed);
    (void)cfsetispeed(&tty, speed);
    CHECK_INT(tcsetattr(fd, TCSANOW, &tty), 0);
    return fd;
}

void tty_has(const char *path, tcflag_t cflag, speed_t speed)
{
    struct termios tty;
    const int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    CHECK(fd >= 0);
    CHECK_INT(tcgetattr(fd, &tty), 0);
    CHECK_INT(tty.c_cflag & (CSIZE | PARENB | PARODD | CSTOPB | CRTSCTS), CS8 | cflag);
    CHECK_INT(cfgetospeed(&tty), speed);
    CHECK_INT(cfgetispeed(&tty), speed);
    (void)close(fd);
}

void tty_takes_each(const char *path, const tty_settings_t *rows, size_t count)
{
    static const struct {
        tcflag_t cflag;
        char letter;
    } parities[] = {[FATHOM_PARITY_NONE] = {0, 'N'},
                    [FATHOM_PARITY_EVEN] = {PARENB, 'E'},
                    [FATHOM_PARITY_ODD] = {PARENB | PARODD, 'O'}};
    (void)tty_open(path, 38400, FATHOM_PARITY_NONE, 1);
    for (const tty_settings_t *row = rows; row != rows + count; row++) {
        const fathom_line_settings_t settings = {row->baud, (uint8_t)row->parity, row->stop_bits};
        CHECK_INT(fathom_posix_set_line(&tty_port, &settings), FATHOM_POSIX_OK);
        tty_has(path, parities[row->parity].cflag | (row->stop_bits == 2 ? CSTOPB : 0), row->speed);
        CHECK_INT(guest_ask("chip %lu %c %d", (unsigned long)row->baud, parities[row->parity].letter,
                            row->stop_bits),
                  1);
    }
}

void tty_write(const fathom_uart_t *uart, const void *bytes, size_t length)
{
    CHECK_INT(uart->write(uart->ctx, bytes, length), length);
    while (!uart->sent(uart->ctx)) guest_sleep_ms(1);
}

size_t tty_receive(int fd, void *bytes, size_t length, unsigned ms)
{
    const uint64_t end_us = fathom_posix_now_us() + ms * 1000ull;
    size_t count = 0;
    while (count != length && fathom_posix_now_us() < end_us) {
        struct pollfd one = {fd, POLLIN, 0};
        (void)poll(&one, 1, 10);
        const ssize_t n = read(fd, (uint8_t *)bytes + count, length - count);
        if (n > 0) count += (size_t)n;
    }
    return count;
}

void tty_is_2083(const fathom_sample_t *sample)
{
    CHECK_INT(sample->kind, FATHOM_TARGET);
    CHECK_INT(sample->distance_mm, 2083);
    CHECK_INT(sample->magnitude, 7231744);
}

void tty_reads_2083(const fathom_uart_t *uart)
{
    fathom_sample_t sample = {0};
    static uint8_t frame[32];
    static fathom_line_t line;
    static fathom_hps167s_t gate;
    const fathom_clock_t clock = fathom_posix_clock();
    const fathom_line_parts_t line_parts = {.uart = uart,
                                            .clock = &clock,
                                            .frame = frame,
                                            .frame_size = sizeof frame,
                                            .find_echo = fathom_line_find_echo,
                                            .silence_us = FATHOM_T3_5_US(19200, 11),
                                            .gap_us = 25000};
    CHECK_INT(fathom_line_init(&line, &line_parts), FATHOM_OK);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    CHECK_INT(fathom_hps167s_init(&gate, &modbus, NULL), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    CHECK_INT(fathom_wait(&sensor, &sample, fathom_posix_wait, &tty_port), FATHOM_OK);
    tty_is_2083(&sample);
    fathom_hps167s_deinit(&gate);
}
