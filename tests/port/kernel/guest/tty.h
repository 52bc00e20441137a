/* SPDX-License-Identifier: MIT */
#ifndef TTY_H
#define TTY_H

#include <stddef.h>
#include <stdint.h>
#include <termios.h>

#include "fathom/fathom.h"
#include "fathom_posix.h"
#include "guest.h"

/* A port under test, and the same tty seen past it. */

extern fathom_posix_uart_t tty_port;

/* Opens tty_port, or ends the case. */
fathom_uart_t tty_open(const char *path, uint32_t baud, fathom_parity_t parity, uint8_t stop_bits);

/* A descriptor of one's own, of a tty that is raw and has these settings; as root it is not kept out. */
int tty_raw(const char *path, speed_t speed, tcflag_t cflag);

/* What the driver has in c_cflag and its rate, read through a descriptor of one's own. */
void tty_has(const char *path, tcflag_t cflag, speed_t speed);

/* Opens the port, and changes it to each of these settings: the driver and the chip have them then. */
typedef struct {
    uint32_t baud;
    speed_t speed;
    fathom_parity_t parity;
    uint8_t stop_bits;
} tty_settings_t;
void tty_takes_each(const char *path, const tty_settings_t *rows, size_t count);

/* Writes all of it, calling sent meanwhile. */
void tty_write(const fathom_uart_t *uart, const void *bytes, size_t length);

/* Reads from a descriptor until there are so many, or the time is over; returns how many there were. */
size_t tty_receive(int fd, void *bytes, size_t length, unsigned ms);

/* Reads a distance over tty_port by the library's HPS-167S at its factory settings, which is table 18's 2083 mm. */
void tty_reads_2083(const fathom_uart_t *uart);
void tty_is_2083(const fathom_sample_t *sample);

#endif
