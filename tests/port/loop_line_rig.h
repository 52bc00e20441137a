/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_LINE_RIG_H
#define FATHOM_TESTS_LOOP_LINE_RIG_H

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "suite.h"

#include "fathom/sensor/hps167s.h"
#include "fathom_loop.h"
#include "posix_pty.h"

/* ---- the far end: an HPS-167S of address 1 behind each pseudo terminal, in a process of its own, whose calls are not
 * counted. It answers each request with 2083 mm, after late_ms, and does nothing else meanwhile. ---- */

enum { FAR_END_MM = 2083, FAR_END_MOST = 64 };
enum { REQUEST = 8, FAR_END_S = 60 };

/* HPS-167S table 18: 2083 mm and what stands beside it; the CRC by hand. */
static const uint8_t far_end_response[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                           0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

static inline void far_end_serve(const posix_pty_t *ptys, unsigned count, unsigned late_ms)
{
    static struct pollfd entries[FAR_END_MOST];
    static size_t have[FAR_END_MOST];
    uint8_t bytes[REQUEST];
    for (unsigned i = 0; i != count; i++) entries[i] = (struct pollfd){ptys[i].master, POLLIN, 0};
    for (;;) {
        if (poll(entries, count, -1) <= 0) continue;
        for (unsigned i = 0; i != count; i++) {
            const ssize_t n = entries[i].revents != 0 ? read(entries[i].fd, bytes, REQUEST - have[i]) : 0;
            have[i] += n > 0 ? (size_t)n : 0;
            if (have[i] != REQUEST) continue;
            have[i] = 0;
            if (late_ms != 0) (void)poll(NULL, 0, (int)late_ms);
            if (write(entries[i].fd, far_end_response, sizeof far_end_response) !=
                (ssize_t)sizeof far_end_response)
                _exit(1);
        }
    }
}

static inline pid_t far_end_begin(const posix_pty_t *ptys, unsigned count, unsigned late_ms)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        (void)alarm(FAR_END_S); /* a child does not inherit it */
        far_end_serve(ptys, count, late_ms);
    }
    return child;
}

static inline void far_end_end(pid_t child)
{
    int status = 0;
    assert_int_equal(kill(child, SIGTERM), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}

/* ---- the lines ---- */

/* Include this file after _DEFAULT_SOURCE. Lines on pseudo terminals, an HPS-167S on each, in one loop. A far end
 * responds in less than a millisecond on an idle machine, so a time-out of 1 s is long. A unit whose port broke is
 * quarantined for twice the time-out. */
typedef struct {
    fathom_loop_t loop;
    unsigned count;
    posix_pty_t ptys[FAR_END_MOST];
    fathom_loop_line_t lines[FAR_END_MOST];
    fathom_hps167s_t drivers[FAR_END_MOST];
    fathom_loop_sensor_t sensors[FAR_END_MOST];
    unsigned readings[FAR_END_MOST], errors[FAR_END_MOST], port_errors[FAR_END_MOST];
    unsigned opened, failed; /* that were told */
} line_rig_t;

enum { LINE_RIG_TIMEOUT_US = 1000000 };

static line_rig_t rig;

static void line_rig_tell(void *ctx, const fathom_loop_source_t *source, bool is_open)
{
    *(is_open ? &rig.opened : &rig.failed) += 1;
}

static void line_rig_take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    const unsigned i = *(const unsigned *)ctx;
    if (status != FATHOM_OK) {
        *(status == FATHOM_ERR_PORT ? &rig.port_errors[i] : &rig.errors[i]) += 1;
        return;
    }
    assert_int_equal(sample->distance_mm, FAR_END_MM);
    rig.readings[i]++;
}

/* Adds another line, on its pseudo terminal. */
static inline void line_rig_add(uint32_t baud)
{
    static unsigned numbers[FAR_END_MOST];
    const unsigned i = rig.count++;
    const fathom_line_settings_t settings = {baud, FATHOM_PARITY_NONE, 1};
    numbers[i] = i;
    assert_int_equal(fathom_loop_add_line(&rig.loop, &rig.lines[i], rig.ptys[i].path, &settings),
                     FATHOM_POSIX_OK);
    const fathom_hps167s_config_t config = {.modbus.timeout_us = LINE_RIG_TIMEOUT_US};
    assert_int_equal(fathom_hps167s_init(&rig.drivers[i], &rig.lines[i].bus.modbus, &config), FATHOM_OK);
    rig.sensors[i] =
        (fathom_loop_sensor_t){fathom_hps167s_sensor(&rig.drivers[i]), line_rig_take, &numbers[i], NULL};
    fathom_loop_add_sensor(&rig.lines[i].source, &rig.sensors[i]);
}

static inline void line_rig_begin(const fathom_loop_config_t *config)
{
    memset(&rig, 0, sizeof rig);
    for (unsigned i = 0; i != FAR_END_MOST; i++) rig.ptys[i].master = -1;
    fathom_loop_config_t with = config != NULL ? *config : (fathom_loop_config_t){0};
    with.tell = line_rig_tell;
    assert_int_equal(fathom_loop_init(&rig.loop, &with), FATHOM_POSIX_OK);
}

static inline void line_rig_end(void)
{
    fathom_loop_deinit(&rig.loop);
    for (unsigned i = 0; i != FAR_END_MOST; i++) posix_pty_close(&rig.ptys[i]);
}

/* Steps until this many have been taken of the line, and fails after a while. */
static inline void line_rig_until(const unsigned *counter, unsigned count)
{
    const uint64_t begin_us = fathom_posix_now_us();
    while (*counter < count) {
        assert_true(fathom_posix_now_us() - begin_us < POSIX_LIMIT_MS * 1000u);
        fathom_loop_step(&rig.loop, 100000);
    }
}

#endif
