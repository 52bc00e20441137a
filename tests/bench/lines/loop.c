/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s.h"
#include "fathom_loop.h"
#include "lines.h"

static fathom_loop_t loop;
static fathom_loop_line_t lines[LINES_MOST];
static fathom_hps167s_t drivers[LINES_MOST];
static fathom_loop_sensor_t sensors[LINES_MOST];

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    lines_see(ctx, status == FATHOM_OK ? sample->distance_mm : 0);
}

static bool add(lines_job_t *job, unsigned n)
{
    fathom_hps167s_config_t config = {.modbus.address = LINES_UNIT,
                                      .modbus.period_us = job->period_us,
                                      .modbus.timeout_us = LINES_TIMEOUT_S * 1000000u};
    if (fathom_loop_add_line(&loop, &lines[n], job->paths[n], &lines_settings) != FATHOM_POSIX_OK ||
        fathom_hps167s_init(&drivers[n], &lines[n].bus.modbus, &config) != FATHOM_OK)
        return false;
    sensors[n] = (fathom_loop_sensor_t){fathom_hps167s_sensor(&drivers[n]), take, &job->seen[n], NULL};
    fathom_loop_add_sensor(&lines[n].source, &sensors[n]);
    return true;
}

static void step_until(uint64_t end_us)
{
    for (uint64_t now_us; (now_us = lines_now_us()) < end_us;)
        fathom_loop_step(&loop, (uint32_t)(end_us - now_us));
}

static bool run(lines_job_t *job, lines_mark_t marks[2])
{
    if (fathom_loop_init(&loop, NULL) != FATHOM_POSIX_OK) return false;
    const uint64_t begin_us = lines_now_us();
    bool is_added = true;
    for (unsigned n = 0; n != job->count && is_added; n++) {
        step_until(begin_us + lines_first_us(job, n));
        is_added = add(job, n);
    }
    for (unsigned i = 0; i != 2; i++) {
        step_until(begin_us + lines_warm_us(job) + i * job->window_us);
        lines_mark(job, &marks[i]);
    }
    fathom_loop_deinit(&loop);
    return is_added;
}

const lines_way_t lines_loop = {"loop", run};
