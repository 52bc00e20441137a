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

/**
 * @file
 * @brief Reads any number of sensors on any number of ttys and pins, in one thread of a Linux program.
 *
 * A loop waits with one epoll(7). It polls only the sources that are ready or due, and opens a lost port again. The
 * loop never allocates memory, and waits only in fathom_loop_run() and fathom_loop_step(); the driver of a USB port may
 * also need a few milliseconds to open it. The section "Many lines" of include/COST.md has the processor time for 1 to
 * 256 lines. A loop that polls everything after each event costs twice as much with 32 lines, nearly all of it in reads
 * that return nothing.
 *
 * @code
 * static fathom_loop_t loop;
 * static fathom_loop_line_t north;
 * static fathom_hps167s_t gate;
 * static fathom_loop_sensor_t gate_sensor = {.take = print, .ctx = "gate"};
 *
 * fathom_loop_init(&loop, NULL);
 * fathom_loop_add_line(&loop, &north, "/dev/ttyUSB0", &fathom_hps167s_factory_line);
 * fathom_hps167s_init(&gate, &north.modbus, NULL);
 * gate_sensor.sensor = fathom_hps167s_sensor(&gate);
 * fathom_loop_add_sensor(&north.source, &gate_sensor);
 * fathom_loop_run(&loop);
 * @endcode
 *
 * A **source** is a tty with a line, a pin, or another thing with a descriptor. Each sensor belongs to one source. A
 * source is **open** or **lost**.
 *
 * 1. **When a source is polled.** The loop polls a source when its descriptor becomes ready, or when the time that its
 *    `due_us` and those of its sensors returned has passed. It polls each source at least every 35 minutes. If a source
 *    is due at once 16 times in a row, the loop polls it once a millisecond from then on. If epoll does not accept the
 *    descriptor (a file, or a descriptor that another source has), the loop polls the source every 10 ms.
 *    A turn of a line polls the line once, however many sensors it has (fathom_line_was_polled()).
 *
 * 2. **Lost sources.** When a source is lost, each of its sensors reports FATHOM_ERR_PORT once, and the loop closes the
 *    source. The loop tries to open it again after `first_pause_us`, and doubles this pause with each attempt up to
 *    `longest_pause_us`. If the source was open for 1 s, the next loss begins with the first pause again. Without this,
 *    the descriptor of a lost port would stay ready and the loop would use a whole processor.
 *
 * 3. **Memory.** The loop, its sources and its sensors are in the caller's memory. They must stay valid, and must not
 *    be moved, as long as they are part of the loop.
 *
 * 4. **Threads.** Call all functions of a loop from one thread. Only fathom_loop_stop() may be called from another
 *    thread or from a signal handler.
 */

/** @brief A loop (struct fathom_loop). */
typedef struct fathom_loop fathom_loop_t;

/** @brief A source (struct fathom_loop_source). */
typedef struct fathom_loop_source fathom_loop_source_t;

/** @brief A sensor of a source (struct fathom_loop_sensor). */
typedef struct fathom_loop_sensor fathom_loop_sensor_t;

/* ---- sensors ---- */

/** @brief A sensor of a source: a node in the caller's memory. fathom_loop_read() sets it in one call. */
struct fathom_loop_sensor {
    /** @brief The sensor, as fathom_..._sensor() of its driver returns it. */
    fathom_sensor_t sensor;

    /**
     * @brief Called with each result of fathom_poll() except FATHOM_PENDING.
     *
     * When the port is lost, each of its sensors gets FATHOM_ERR_PORT once. It is not repeated until the port was open
     * again; fathom_loop_error_text() has the reason. When the port is open again, the loop drops the results that a
     * sensor has from the time in between.
     *
     * The callback may stop the loop, and may add sources and sensors to it. It must not remove anything. A call of
     * fathom_loop_step() or fathom_loop_run() from the callback does nothing.
     *
     * @param ctx     The member `ctx`.
     * @param status  The result of fathom_poll(). Never FATHOM_PENDING.
     * @param sample  The sample, valid during the call. NULL unless `status` is FATHOM_OK.
     */
    void (*take)(void *ctx, fathom_status_t status, const fathom_sample_t *sample);

    /** @brief Passed to `take`. */
    void *ctx;

    /* private */
    fathom_loop_sensor_t *next;
};

/* ---- sources ---- */

/**
 * @brief The functions of one kind of source. A constant table that must stay valid.
 *
 * Lines and pins have their tables already. A program needs a table only for a source of its own.
 */
typedef struct {
    /** @brief Opens the source. Returns false if that fails; `error_text` then has the reason, and the loop calls
     * `open` again after a pause. NULL: the source is always open. */
    bool (*open)(fathom_loop_source_t *source);

    /** @brief Closes an open source. NULL: there is nothing to close. */
    void (*close)(fathom_loop_source_t *source);

    /** @brief Returns the descriptor of an open source. Called after each poll. -1: only time wakes the source. If the
     * source closes its descriptor and opens another one, call fathom_loop_renew(). */
    int (*fd)(const fathom_loop_source_t *source);

    /** @brief Returns the events of poll(2) to wait for. Called after each poll. NULL: POLLIN. */
    short (*events)(const fathom_loop_source_t *source);

    /** @brief Does what is possible without waiting. Called before the sensors of the source are polled. Returns false
     * if the source is lost. NULL: there is nothing to do. */
    bool (*poll)(fathom_loop_source_t *source);

    /** @brief Returns the time in microseconds until `poll` must be called again if nothing arrives. The sensors of the
     * source have their own times. NULL: FATHOM_NO_DEADLINE. */
    uint32_t (*due_us)(fathom_loop_source_t *source);

    /** @brief Returns the reason why the source could not be opened or was lost, in one line. NULL: "it is lost". */
    const char *(*error_text)(const fathom_loop_source_t *source);
} fathom_loop_kind_t;

/**
 * @brief A source, in the caller's memory. Usually the first member of a larger struct.
 *
 * For a source of your own: set all members to 0, set `kind`, and call fathom_loop_add(). A program may read `is_open`
 * and `is_hung_up`. All members without a comment that allows more belong to the loop.
 */
struct fathom_loop_source {
    /** @brief The kind of this source. Set it before fathom_loop_add(). */
    const fathom_loop_kind_t *kind;
    /** @brief True if the source is open. May be read. */
    bool is_open;
    /** @brief Private: true if epoll, or `sleep` of the configuration, wakes this source. */
    bool is_watched;
    /** @brief Private: true if the source became ready and was not read to the end since. */
    bool is_readable;
    /** @brief True if the descriptor has hung up. A later read reports this. May be read. */
    bool is_hung_up;
    /** @brief Set it to true in `open`, if a read that returns less than the requested number of bytes has read all.
     * This is so for ttys. */
    bool reads_all;
    /** @brief Private: number of times in a row that the source was due at once. */
    uint8_t zeros;
    /** @brief Private: the events that epoll waits for. */
    short events;
    /** @brief Private: the descriptor that epoll waits for. */
    int fd;
    /** @brief Private: the newest pause before the source is opened, in microseconds. 0: none yet. */
    uint32_t pause_us;
    /** @brief Private: the time at which the source was opened. */
    uint64_t opened_us;
    /** @brief Private: the loop. NULL if the source is part of no loop. */
    fathom_loop_t *loop;
    /** @brief Private: the sensors of the source. */
    fathom_loop_sensor_t *sensors;

    /* private */
    fathom_loop_source_t *next;
    fathom_uart_t inner; /* the UART that fathom_loop_uart() wraps */
    uint64_t sampled_us; /* the time before the newest read of it */
    /* A heap of sources, by the time at which each is due. */
    uint64_t due_us;
    bool is_due;
    fathom_loop_source_t *parent, *left, *right;
    fathom_loop_source_t *ready; /* the source that this step polls after this one */
};

/* ---- the loop ---- */

/** @brief Configuration of a loop. A member that is 0 takes its default. Copied by fathom_loop_init(). */
typedef struct {
    /** @brief First pause before a source that was lost or could not be opened is opened again, in microseconds (rule
     * 2). 0: 500 ms. */
    uint32_t first_pause_us;

    /** @brief Longest such pause, in microseconds. 0: 8 s. */
    uint32_t longest_pause_us;

    /**
     * @brief Called when a source was opened, and when it could not be opened or was lost. NULL: not called.
     *
     * For a source that cannot be opened, this happens at most once in each pause. fathom_loop_error_text() has the
     * reason. The callback may stop the loop, but must not change it otherwise.
     *
     * @param ctx      The member `ctx`.
     * @param source   The source.
     * @param is_open  True if the source is open, for the first time or again. False if it is lost or could not be
     *                 opened.
     */
    void (*tell)(void *ctx, const fathom_loop_source_t *source, bool is_open);

    /** @brief Clock for simulated time, in microseconds. NULL: CLOCK_MONOTONIC. */
    uint64_t (*now_us)(void *ctx);

    /**
     * @brief Sleep for simulated time. NULL: epoll.
     *
     * The function returns after `max_us` microseconds at the latest, or at any time if `max_us` is FATHOM_NO_DEADLINE.
     * Before it returns it calls fathom_loop_wake() for each source that may be ready.
     */
    void (*sleep)(void *ctx, fathom_loop_t *loop, uint32_t max_us);

    /** @brief Passed to these functions. */
    void *ctx;
} fathom_loop_config_t;

/** @brief A loop, in the caller's memory. A program may read `sleeps` and `polls`. */
struct fathom_loop {
    /** @brief Private: the configuration, with its defaults. */
    fathom_loop_config_t config;
    /** @brief Private: the descriptor of epoll. -1 in simulated time. */
    int epoll_fd;
    /** @brief Private: the descriptor by which fathom_loop_stop() ends a sleep. -1 in simulated time. */
    int stop_fd;
    /** @brief Private: true if fathom_loop_stop() was called and no run has ended since. */
    volatile sig_atomic_t is_stopped;
    /** @brief Private: true during fathom_loop_step(). */
    bool is_in_step;
    /** @brief Private: true if the kernel has no epoll_pwait2(2). */
    bool has_no_pwait2;
    /** @brief Private: all sources. */
    fathom_loop_source_t *sources;
    /** @brief Private: the source that is due first. */
    fathom_loop_source_t *due;
    /** @brief Private: a time before the loop last asked the kernel for events. */
    uint64_t sampled_us;
    /** @brief Number of sleeps since fathom_loop_init(). */
    uint64_t sleeps;
    /** @brief Number of polls of sources since fathom_loop_init(). */
    uint64_t polls;
};

/**
 * @brief Initialises a loop without sources.
 *
 * @param loop    The loop, with any content. Call fathom_loop_deinit() first if it was initialised before.
 * @param config  The configuration, read only during the call. NULL: all defaults.
 * @retval FATHOM_POSIX_OK            The loop is ready.
 * @retval FATHOM_POSIX_ERR_ARGUMENT  `loop` is NULL.
 * @retval FATHOM_POSIX_ERR_SYSTEM    The system has no descriptor left.
 */
fathom_posix_status_t fathom_loop_init(fathom_loop_t *loop, const fathom_loop_config_t *config);

/** @brief Closes and removes all sources, and frees the descriptors of the loop. After this the memory is the caller's
 * again. Do not call it from a callback. */
void fathom_loop_deinit(fathom_loop_t *loop);

/**
 * @brief Adds a source and tries to open it.
 *
 * If the source cannot be opened, the loop calls `tell` of its configuration and tries again after a pause. If the
 * source is part of the loop already, nothing happens.
 *
 * @param loop    The loop.
 * @param source  The source. Its `kind` is set and all other members are 0.
 */
void fathom_loop_add(fathom_loop_t *loop, fathom_loop_source_t *source);

/**
 * @brief Removes a source from its loop and closes it. After this the memory is the caller's again.
 *
 * Do not call this function from a callback of the loop. Remove a pin before you close its descriptor. If the source is
 * part of no loop, nothing happens.
 */
void fathom_loop_remove(fathom_loop_source_t *source);

/**
 * @brief Adds a sensor to a source. The loop polls it after the sensors that were added before.
 *
 * If the source has this sensor already, nothing happens.
 *
 * @param source  The source.
 * @param sensor  The sensor. Its members `sensor` and `take` are set.
 */
void fathom_loop_add_sensor(fathom_loop_source_t *source, fathom_loop_sensor_t *sensor);

/**
 * @brief Sets a node and adds it to a source: fathom_loop_add_sensor() in one line.
 *
 * @param source  The source.
 * @param node    The node, which must stay valid as long as the source is part of a loop.
 * @param sensor  Copied to `node->sensor`.
 * @param take    Copied to `node->take`.
 * @param ctx     Copied to `node->ctx`.
 */
void fathom_loop_read(fathom_loop_source_t *source, fathom_loop_sensor_t *node, fathom_sensor_t sensor,
                      void (*take)(void *ctx, fathom_status_t status, const fathom_sample_t *sample),
                      void *ctx);

/** @brief Sleeps and polls until fathom_loop_stop() is called. Then the loop may be run again. */
void fathom_loop_run(fathom_loop_t *loop);

/**
 * @brief Sleeps once, until a source is ready or due, and polls the sources that are.
 *
 * This is for a program that has other work to do between two steps. A signal ends the sleep.
 *
 * @param loop    The loop.
 * @param max_us  Longest sleep in microseconds. FATHOM_NO_DEADLINE: without a limit.
 */
void fathom_loop_step(fathom_loop_t *loop, uint32_t max_us);

/**
 * @brief Stops the present fathom_loop_run() soon. If none is running, the next fathom_loop_run() returns at once.
 *
 * May be called from a signal handler and from another thread.
 */
void fathom_loop_stop(fathom_loop_t *loop);

/**
 * @brief Returns a descriptor for another event loop: it is readable when a source is ready.
 *
 * The other loop calls fathom_loop_step() when the descriptor is readable or the time of fathom_loop_due_us() has
 * passed. If the configuration has a `sleep`, the descriptor is -1.
 */
int fathom_loop_fd(const fathom_loop_t *loop);

/**
 * @brief Returns the time in microseconds until fathom_loop_step() must be called if nothing arrives.
 *
 * Returns FATHOM_NO_DEADLINE if no source is due. Call it again after each step, and after a source or a sensor was
 * added.
 */
uint32_t fathom_loop_due_us(const fathom_loop_t *loop);

/** @brief Makes the loop poll and read a source in its next step. For `sleep` of the configuration, and after a change
 * from outside, such as a new request. If the source is not open, nothing happens. */
void fathom_loop_wake(fathom_loop_source_t *source);

/**
 * @brief Makes the loop wait for another descriptor from the end of this turn of the source on.
 *
 * The loop recognises another descriptor by its number, and the system often assigns the number of a closed one again. Call
 * this after the old descriptor has been closed.
 */
void fathom_loop_renew(fathom_loop_source_t *source);

/** @brief Returns why a source could not be opened or was lost, in one line. Returns "" if nothing has failed. */
const char *fathom_loop_error_text(const fathom_loop_source_t *source);

/**
 * @brief Wraps a UART so that `read` makes a system call only if the descriptor of the source has become ready.
 *
 * @param source  The source. It must stay valid as long as the result is used.
 * @param uart    The UART of the source. Copied.
 * @return The wrapped UART, by value.
 */
fathom_uart_t fathom_loop_uart(fathom_loop_source_t *source, const fathom_uart_t *uart);

/* ---- lines and pins ---- */

/**
 * @brief A tty with a line (line.h) that is part of a loop, in the caller's memory.
 *
 * After fathom_loop_add_line(), drivers may be initialised with `bus.modbus` or `bus.line`, also while the port cannot be
 * opened.
 */
typedef struct {
    /** @brief The source, for fathom_loop_add_sensor(). */
    fathom_loop_source_t source;

    /**
     * @brief Port, line and transport (fathom_posix.h). Do not open or close it: the loop does.
     *
     * While `source.is_open` is true, fathom_posix_set_rs485() and fathom_posix_line_errors() may use the port. If the
     * program needs other parts, it changes `bus.parts` before the first step and before a driver uses the line, and then
     * calls fathom_line_init() with `&bus.line` and `&bus.parts` again. Only `silence_us` and `gap_us` may be changed
     * without that call.
     */
    fathom_posix_bus_t bus;

    /* private */
    const char *path;
    fathom_line_settings_t settings; /* with which the port is opened */
} fathom_loop_line_t;

/**
 * @brief Sets all members of a line and adds it to a loop.
 *
 * @param loop      The loop.
 * @param line      The line, with any content. It must not be part of the loop.
 * @param path      Path of the tty, as for fathom_posix_open(). Must stay valid as long as the line is part of the
 *                  loop.
 * @param settings  As for fathom_posix_open(). Copied.
 * @retval FATHOM_POSIX_OK            The line is part of the loop, whether or not the port could be opened.
 * @retval FATHOM_POSIX_ERR_ARGUMENT  A pointer is NULL, the settings are not allowed, or the line is part of the loop
 *                                    already.
 */
fathom_posix_status_t fathom_loop_add_line(fathom_loop_t *loop, fathom_loop_line_t *line, const char *path,
                                           const fathom_line_settings_t *settings);

/**
 * @brief A source for any other descriptor that wakes its sensors, such as a pin of port/gpio. In the caller's memory.
 *
 * The caller opens and closes the descriptor. If a sensor returns FATHOM_ERR_PORT, the loop pauses the source and then
 * polls it again.
 */
typedef struct {
    /** @brief The source, for fathom_loop_add_sensor(). */
    fathom_loop_source_t source;
    /** @brief Private: the descriptor. */
    int fd;
} fathom_loop_pin_t;

/**
 * @brief Sets all members of a pin and adds it to a loop. If the pin is part of the loop already, nothing happens.
 *
 * @param loop  The loop.
 * @param pin   The pin, with any content.
 * @param fd    The descriptor, such as fathom_gpio_fd() of a pin with edges. It must stay open as long as the pin is
 *              part of the loop.
 */
void fathom_loop_add_pin(fathom_loop_t *loop, fathom_loop_pin_t *pin, int fd);

#ifdef __cplusplus
}
#endif

#endif
