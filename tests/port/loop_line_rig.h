/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_LINE_RIG_H
#define FATHOM_TESTS_LOOP_LINE_RIG_H

#include "suite.h"

#include "fathom/sensor/hps167s.h"
#include "fathom_loop.h"
#include "loop_far_end.h"

/* Lines on pseudo terminals, an HPS-167S on each, in one loop. A far end responds in less than a millisecond on an idle
 * machine, so a time-out of 1 s is long. A unit whose port broke is quarantined for twice the time-out. */
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
