/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* ppoll */
#include <poll.h>
#include <time.h>

#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_posix.h"
#include "lines.h"

/* The loop that is easily written: whatever has happened, all sensors are polled. */

typedef struct {
    fathom_posix_uart_t port;
    fathom_uart_t uart;
    fathom_line_parts_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    fathom_hps167s_t driver;
    uint8_t frame[32];
} every_t;

static every_t lines[LINES_MOST];
static fathom_sensor_t sensors[LINES_MOST];
static struct pollfd entries[LINES_MOST];
static fathom_clock_t monotonic;

static bool add(const lines_job_t *job, unsigned n)
{
    every_t *const at = &lines[n];
    if (fathom_posix_open(&at->port, job->paths[n], &lines_settings) != FATHOM_POSIX_OK) return false;
    monotonic = fathom_posix_clock();
    at->uart = fathom_posix_uart(&at->port);
    at->config = (fathom_line_parts_t){.uart = &at->uart,
                                       .clock = &monotonic,
                                       .frame = at->frame,
                                       .frame_size = sizeof at->frame,
                                       .find_echo = fathom_line_find_echo,
                                       .silence_us = FATHOM_T3_5_US(LINES_BAUD, 11),
                                       .gap_us = 25000};
    if (fathom_line_init(&at->line, &at->config) != FATHOM_OK) return false;
    at->modbus = fathom_modbus_client(&at->line);
    const fathom_hps167s_config_t config = {.modbus.address = LINES_UNIT,
                                            .modbus.period_us = job->period_us,
                                            .modbus.timeout_us = LINES_TIMEOUT_S * 1000000u};
    if (fathom_hps167s_init(&at->driver, &at->modbus, &config) != FATHOM_OK) return false;
    sensors[n] = fathom_hps167s_sensor(&at->driver);
    return true;
}

static void poll_until(lines_job_t *job, unsigned count, uint64_t end_us)
{
    for (;;) {
        for (unsigned n = 0; n != count; n++) {
            fathom_sample_t sample;
            fathom_status_t status;
            while ((status = fathom_poll(&sensors[n], &sample)) != FATHOM_PENDING)
                lines_see(&job->seen[n], status == FATHOM_OK ? sample.distance_mm : 0);
            entries[n] =
                (struct pollfd){fathom_posix_fd(&lines[n].port), fathom_posix_poll_events(&lines[n].port), 0};
        }
        const uint64_t now_us = lines_now_us();
        if (now_us >= end_us) return;
        uint64_t max_us = fathom_due_us(sensors, count);
        if (max_us > end_us - now_us) max_us = end_us - now_us;
        const struct timespec limit = {(time_t)(max_us / 1000000), (long)(max_us % 1000000) * 1000};
        (void)ppoll(entries, count, &limit, NULL);
    }
}

static bool run(lines_job_t *job, lines_mark_t marks[2])
{
    const uint64_t begin_us = lines_now_us();
    unsigned count = 0;
    while (count != job->count) {
        poll_until(job, count, begin_us + lines_first_us(job, count));
        if (!add(job, count)) break;
        count++;
    }
    for (unsigned i = 0; i != 2; i++) {
        poll_until(job, count, begin_us + lines_warm_us(job) + i * job->window_us);
        lines_mark(job, &marks[i]);
    }
    for (unsigned n = 0; n != count; n++) fathom_posix_close(&lines[n].port);
    return count == job->count;
}

const lines_way_t lines_every = {"every", run};
