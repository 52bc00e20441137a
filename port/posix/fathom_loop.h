/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LOOP_H
#define FATHOM_LOOP_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/sensor.h"
#include "fathom_posix.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Reads any number of sensors on any number of ttys and pins in one thread of a Linux program: one epoll(7), which
 * polls what is ready or due and nothing else, and opens again what was lost.
 *
 *     static fathom_loop_t loop;
 *     static fathom_loop_line_t north;
 *     static fathom_hps167s_t gate;
 *     static fathom_loop_sensor_t gate_sensor = {.take = print, .ctx = "gate"};
 *
 *     fathom_loop_init(&loop, NULL);
 *     fathom_loop_add_line(&loop, &north, "/dev/ttyUSB0", &(fathom_line_settings_t){19200, FATHOM_PARITY_EVEN, 1});
 *     fathom_hps167s_init(&gate, &(fathom_hps167s_config_t){.modbus.transport = &north.modbus});
 *     gate_sensor.sensor = fathom_hps167s_sensor(&gate);
 *     fathom_loop_add_sensor(&north.source, &gate_sensor);
 *     fathom_loop_run(&loop);
 *
 * A loop that polls everything whenever anything has happened costs twice as much with 32 lines, nearly all of it in
 * reads that bring nothing; and where a port was lost, its descriptor is ready for ever: a loop that goes on waiting
 * for it takes all of a processor. Here a source is polled when its descriptor has become ready, or when the time that
 * its due_us has told is over; a source that was lost is closed, and opened again after a pause that grows.
 *
 * All memory is the caller's; nothing is allocated, and nothing may be moved while it is part of a loop. One thread;
 * only fathom_loop_stop may be called from another one, or from a signal handler. It waits in fathom_loop_run and
 * fathom_loop_step alone (opening a USB port may take the driver some milliseconds).
 */
typedef struct fathom_loop fathom_loop_t;
typedef struct fathom_loop_source fathom_loop_source_t;
typedef struct fathom_loop_sensor fathom_loop_sensor_t;

/* ---- sensors ---- */

/* A sensor on a source: a node in the caller's memory. */
struct fathom_loop_sensor {
    fathom_sensor_t sensor;
    /*
     * What fathom_poll has returned, whatever it is but FATHOM_PENDING. sample: NULL unless that is FATHOM_OK.
     * FATHOM_ERR_PORT comes once when the port was lost, to each of its sensors, and not again before the port was
     * back; the source's error_text has the reason. What a sensor has to say right when its port is back, of the time
     * in which it was away, is dropped. It may stop the loop and add to it; it removes nothing, and a step or a run
     * from here does nothing.
     */
    void (*take)(void *ctx, fathom_status_t status, const fathom_sample_t *sample);
    void *ctx;
    fathom_loop_sensor_t *next; /* the loop's */
};

/* ---- sources: what all of the above are made of ---- */

/* What kind of thing is behind a source. A table, const; members that may be NULL say so. */
typedef struct {
    /* Opens it. False: not now, and error_text says why; it is called again after a pause. NULL: it is open. */
    bool (*open)(fathom_loop_source_t *source);
    /* Closes what was open; NULL: there is nothing to do. */
    void (*close)(fathom_loop_source_t *source);
    /* Of an open one: its descriptor; -1: time alone wakes it. */
    int (*fd)(const fathom_loop_source_t *source);
    /* The events of poll(2) to wait for, asked after each poll; NULL: POLLIN. */
    short (*events)(const fathom_loop_source_t *source);
    /* Does what can be done now without waiting, before its sensors are polled. False: it is lost. NULL: nothing. */
    bool (*poll)(fathom_loop_source_t *source);
    /* How long until that is to be called if nothing comes, besides what its sensors say; NULL: any time. */
    uint32_t (*due_us)(fathom_loop_source_t *source);
    /* Why it could not be opened, or was lost; one line. NULL: "it is lost". */
    const char *(*error_text)(const fathom_loop_source_t *source);
} fathom_loop_kind_t;

/* Mostly the first member of something larger. The caller sets kind before it is added; the rest is the loop's. */
struct fathom_loop_source {
    const fathom_loop_kind_t *kind;
    bool is_open;     /* may be read */
    bool is_watched;  /* something wakes it when it becomes ready */
    bool is_readable; /* it has become ready, and not all has been read since */
    bool is_hung_up;  /* which a read tells that is still to come */
    bool reads_all; /* set it where a read that brings less than was asked for has brought all: ttys do so */
    uint8_t zeros;  /* times in a row that it was due at once */
    short events;   /* that are waited for */
    int fd;
    uint32_t pause_us;  /* the last one before it was opened; 0: none */
    uint64_t opened_us; /* when it was */
    fathom_loop_t *loop;
    fathom_loop_sensor_t *sensors;
    fathom_loop_source_t *next;
    fathom_uart_t inner;
    /* In a heap, by the time when it is due. */
    uint64_t due_us;
    bool is_due;
    fathom_loop_source_t *parent, *left, *right;
    fathom_loop_source_t *ready; /* in this step, after this one */
};

/* ---- the loop ---- */

/* Members that are 0 have their defaults. Read by init only. */
typedef struct {
    /* The pause before a source that was lost, or could not be opened, is tried again: the first one, 500 ms; doubled
     * each time up to the longest, 8 s. One that was open for 1 s begins with the first one again. */
    uint32_t first_pause_us;
    uint32_t longest_pause_us;
    /* At most once a source and pause: it could not be opened, or was lost (is_open false), or is open, again or for
     * the first time. fathom_loop_error_text has the reason. It may not change the loop, but stop it. NULL: not
     * told. */
    void (*tell)(void *ctx, const fathom_loop_source_t *source, bool is_open);
    /* For simulated time; NULL: CLOCK_MONOTONIC and epoll. sleep: returns after max_us (FATHOM_NO_DEADLINE: any time)
     * at the latest, and has called fathom_loop_wake for each source that may have something. */
    uint64_t (*now_us)(void *ctx);
    void (*sleep)(void *ctx, fathom_loop_t *loop, uint32_t max_us);
    void *ctx;
} fathom_loop_config_t;

struct fathom_loop {
    fathom_loop_config_t config;
    int epoll_fd;
    int stop_fd;
    volatile sig_atomic_t is_stopped;
    bool is_in_step;
    bool has_no_pwait2; /* the kernel has no epoll_pwait2(2) */
    fathom_loop_source_t *sources;
    fathom_loop_source_t *due; /* the one that is due first */
    uint64_t sleeps;           /* so far, */
    uint64_t polls;            /* of sources */
};

/* config: NULL, all defaults. FATHOM_POSIX_OK; ARGUMENT; or SYSTEM, the system has no descriptor left. */
fathom_posix_status_t fathom_loop_init(fathom_loop_t *loop, const fathom_loop_config_t *config);

/* Closes all sources, and forgets them. */
void fathom_loop_deinit(fathom_loop_t *loop);

/*
 * Adds a source whose kind is set and whose other members are zeros, and tries to open it. A source that cannot be
 * opened is no failure: that is told, and it is tried again. One that is part of the loop already: nothing happens.
 *
 * A descriptor that epoll does not take, a file say, or one that another source has, is polled every 10 ms. A source
 * that is due at once 16 times in a row is polled each millisecond from then on, and any one every 35 minutes at least.
 */
void fathom_loop_add(fathom_loop_t *loop, fathom_loop_source_t *source);

/* Closes it; it is the caller's again. Not from a callback of the loop; of a pin, before its descriptor is closed. */
void fathom_loop_remove(fathom_loop_source_t *source);

/* sensor->sensor and take are set; it is polled after those that were added before. */
void fathom_loop_add_sensor(fathom_loop_source_t *source, fathom_loop_sensor_t *sensor);

/* The same in one line: sets node->sensor, take and ctx, and adds it. */
void fathom_loop_read(fathom_loop_source_t *source, fathom_loop_sensor_t *node, fathom_sensor_t sensor,
                      void (*take)(void *ctx, fathom_status_t status, const fathom_sample_t *sample),
                      void *ctx);

/* Sleeps and polls until fathom_loop_stop is called; then it may be run again. */
void fathom_loop_run(fathom_loop_t *loop);

/* Once: sleeps until something is ready or due, no longer than max_us (FATHOM_NO_DEADLINE: any time), and polls it.
 * For a program that has something else to do. Signals end the sleep. */
void fathom_loop_step(fathom_loop_t *loop, uint32_t max_us);

/* Ends fathom_loop_run, soon; where none runs, the next one. It may be called from a signal handler and from another
 * thread. */
void fathom_loop_stop(fathom_loop_t *loop);

/* For a loop of another kind: a descriptor that can be read whenever fathom_loop_step has something to do for what has
 * come (-1 with a `sleep` of the config), and how long until it has for time alone (FATHOM_NO_DEADLINE: nothing). Ask
 * again after each step, and after what was added. */
int fathom_loop_fd(const fathom_loop_t *loop);
uint32_t fathom_loop_due_us(const fathom_loop_t *loop);

/* In the next step it is polled, and read. For a config's sleep, and for what was changed from outside. */
void fathom_loop_wake(fathom_loop_source_t *source);

/* In words, one line; "" where nothing has failed. */
const char *fathom_loop_error_text(const fathom_loop_source_t *source);

/* `uart`, but that read asks it only where the source's descriptor has become ready: no system call brings nothing. The
 * uart of an open source, which outlives its use. */
fathom_uart_t fathom_loop_uart(fathom_loop_source_t *source, const fathom_uart_t *uart);

/* ---- lines and pins ---- */

/* A tty with a line (line.h) and a Modbus client on it. `modbus` and `line` are for the drivers' configs; all can be
 * used as soon as it was added, also while the port is not there. */
typedef struct {
    fathom_loop_source_t source;
    /* For fathom_posix_set_rs485 and fathom_posix_line_errors, as long as source.is_open. */
    fathom_posix_uart_t port;
    const char *path; /* the caller's */
    fathom_line_settings_t settings;
    fathom_uart_t uart;
    fathom_clock_t clock;
    /* Set by fathom_loop_add_line: it finds out whether there is echo, the silence of the settings, a gap of 25 ms, no
     * counters. May be changed before the first step, but for `echo`, which fathom_loop_add_line has read. */
    fathom_line_parts_t parts;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[255];
} fathom_loop_line_t;

/* Sets all of *line, and adds it. path and settings as fathom_posix_open has them; path is the caller's, as long as the
 * line is part of the loop. FATHOM_POSIX_OK, also where the port is not there; or ARGUMENT: a NULL, settings that
 * fathom_posix_open does not allow, or a line that is part of the loop already. */
fathom_posix_status_t fathom_loop_add_line(fathom_loop_t *loop, fathom_loop_line_t *line, const char *path,
                                           const fathom_line_settings_t *settings);

/* Anything else with a descriptor that wakes its sensors, such as a pin of port/gpio. It is the caller's to open and to
 * close. When a sensor says FATHOM_ERR_PORT it is left alone for a pause, and then polled again. */
typedef struct {
    fathom_loop_source_t source;
    int fd;
} fathom_loop_pin_t;

/* Sets all of *pin, and adds it. fd: open as long as the pin is part of the loop, such as fathom_gpio_fd of one with
 * edges. One that is part of the loop already: nothing happens. */
void fathom_loop_add_pin(fathom_loop_t *loop, fathom_loop_pin_t *pin, int fd);

#ifdef __cplusplus
}
#endif

#endif
