/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_PTY_H
#define FATHOM_SIM_PTY_H

#include <stdbool.h>
#include <stdint.h>

#include "sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A simulated line as a serial port: a pseudo terminal that any program can open, in real time. POSIX.
 *
 *     fathom_sim_pty_t pty;
 *     if (fathom_sim_pty_open(&pty, &line, &(fathom_sim_pty_config_t){.link = "/tmp/a16"}) < 0) ...
 *     for (;;) {
 *         uint32_t due_us;
 *         if (fathom_sim_pty_pump(&pty, &due_us) < 0) ...
 *         wait until fathom_sim_pty_fd(&pty) is readable, or for due_us
 *     }
 *
 * A frame of a device is handed over as a whole, when its last bit has come, as USB adapters do.
 *
 * Rate: the simulator sees the rate that the client has set, and a device answers at its own only. Parity
 * and stop bits cannot be seen through a pseudo terminal: they are taken to be those of the first device with
 * the client's rate; where there is none, as the line was initialised.
 *
 * Clients come and go. The port is raw from the beginning and stays as the last client has set it. What a
 * device sends while no one reads is kept, as by an operating system, up to 255 bytes; then it is thrown away
 * and kept anew. A client that opens a port that talks by itself flushes first, as with any serial port.
 * One that takes the port for itself alone (TIOCEXCL) must give it back (TIOCNXCL): it does not end at close.
 */
typedef struct {
    /* a symbolic link to make, for a name that stays; NULL: none. Kept until close. What is there already is EEXIST,
     * but for a link that a pty left behind which was not closed: one to a terminal that is gone, which is replaced
     * in one step */
    const char *link;
    bool ignore_baud; /* devices hear the client at any rate */
} fathom_sim_pty_config_t;

enum { FATHOM_SIM_PTY_PATH = 64, FATHOM_SIM_PTY_LINK = 256 };

typedef struct {
    fathom_sim_line_t *line;
    int master;
    int slave;                     /* held open, so that the last client's leaving is no error here */
    fathom_line_settings_t opened; /* the line's, when it was opened */
    bool ignore_baud;
    uint8_t pending_length; /* bytes that the terminal did not take yet */
    uint8_t pending[255];
    char path[FATHOM_SIM_PTY_PATH];
    char link[FATHOM_SIM_PTY_LINK];
} fathom_sim_pty_t;

/* The time that the pty uses: CLOCK_MONOTONIC in us. Initialise the line and attach the devices with it. */
uint32_t fathom_sim_pty_now_us(void);

/* config: NULL for the defaults. Returns 0, or -1 with errno and nothing left behind. The line stays the
 * caller's. One pty a line. */
int fathom_sim_pty_open(fathom_sim_pty_t *pty, fathom_sim_line_t *line,
                        const fathom_sim_pty_config_t *config);

/* Moves bytes both ways, never waits. Returns 0 and how long until it must be called again without input
 * (10 minutes at most), or -1 with errno when the terminal is broken. */
int fathom_sim_pty_pump(fathom_sim_pty_t *pty, uint32_t *due_us);

/* For poll(2), to read. */
int fathom_sim_pty_fd(const fathom_sim_pty_t *pty);

/* What a client opens: /dev/pts/N. */
const char *fathom_sim_pty_path(const fathom_sim_pty_t *pty);

/* Closes it; removes the link if it still points here. Twice is no error. */
void fathom_sim_pty_close(fathom_sim_pty_t *pty);

#ifdef __cplusplus
}
#endif

#endif
