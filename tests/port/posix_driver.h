/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_POSIX_DRIVER_H
#define FATHOM_TESTS_POSIX_DRIVER_H

#include <linux/serial.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <termios.h>

/*
 * What a driver can do that a pseudo terminal does not: refuse settings without a word, report a transmitter
 * that is not empty, take a part of a write, fail. It stands between the port and a pseudo terminal: link
 * with -Wl,--wrap= each of open fstat tcgetattr tcsetattr tcflush ioctl read write.
 */
/* Of the port that was opened last; 0 and false: what the pseudo terminal does. */
typedef struct {
    int open_error;
    int open_interrupts;                  /* so many calls give EINTR first */
    int stat_error;                       /* of fstat */
    bool is_8250;                         /* its device number; ioctls below are then its own */
    bool is_usb;                          /* an adapter's device number, above those of pseudo terminals */
    speed_t most;                         /* rates above it become 9600 */
    bool drops_parity;                    /* PARENB */
    bool drops_stop;                      /* CSTOPB */
    bool keeps_echo;                      /* ECHO stays */
    void (*changes)(struct termios *tty); /* what tcgetattr tells after the first tcsetattr; NULL: nothing */
    int flush_error;
    int get_error;
    int get_error_after; /* so many calls */
    int set_error;       /* the settings are taken all the same */
    int set_interrupts;  /* so many calls give EINTR first */
    int queued;          /* TIOCOUTQ */
    int queue_error;
    int lsr; /* TIOCSERGETLSR */
    int lsr_error, count_error;
    int exclusive; /* TIOCEXCL minus TIOCNXCL */
    int exclusive_calls, exclusive_error;
    int breaks; /* TIOCSBRK minus TIOCCBRK */
    int break_calls, break_error, read_error, read_interrupts;
    size_t read_most; /* bytes that a read was asked for at most */
    int write_most;   /* bytes that one write takes; 0: all */
    int write_error, write_interrupts;
    int write_refusals; /* so many calls give EAGAIN first */
    bool has_rs485;
    struct serial_rs485 rs485;        /* as TIOCSRS485 has left it */
    uint32_t rs485_drops, rs485_adds; /* flags that are not kept, that are set as well */
    uint32_t rs485_delay_most;        /* longer ones become this; 0: all are kept */
    int rs485_error;                  /* of TIOCSRS485 */
    int rs485_get_error;
    int rs485_get_error_after; /* so many calls */
    int rs485_sets;            /* calls of TIOCSRS485 */
    int sets;                  /* calls of tcsetattr */
    int writes;                /* calls of write */
} posix_driver_t;

extern posix_driver_t driver;

/* Nothing special any more; call it before each test. */
void posix_driver_reset(void);

#endif
