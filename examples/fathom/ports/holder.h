/* SPDX-License-Identifier: MIT */
#ifndef HOLDER_H
#define HOLDER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom_posix.h"

/*
 * Which other program uses a serial port, as far as the system shows it: by the descriptors of all processes, whatever
 * name of the device they opened; by their controlling terminals, which show a getty of root to every user; and by lock
 * files. The far end of a pseudo terminal is no such program.
 */
typedef struct {
    char who[64];     /* "cat (process 1234)"; "": none is known */
    char stop[128];   /* what to do about it: "Stop it" */
    uint32_t program; /* differs for programs with other names; 0: none is known */
    bool is_hidden;   /* other programs may use the port, and this user cannot see them */
    bool is_changed;  /* the port does not have the settings that this program gave it */
    bool is_hung_up;  /* the port was hung up, and its device is still there */
    bool is_console;  /* the console of the kernel */
} holder_t;

/* Searches who uses a port that is open, or whose opening was refused because it is in use. path: its present name. The
 * processes are searched three times, and then at most once a minute; between two searches the result of the newest one
 * is checked. A port that is simulated, or no serial port, is used by none. */
void holder_find(holder_t *holder, const fathom_posix_uart_t *serial, const char *path);

/* The folder of the processes. Tests have another one. */
extern const char *holder_proc;

#endif
