/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* clock_nanosleep, pthread_barrier */
#include <modbus.h>
#include <pthread.h>
#include <time.h>

#include "lines.h"

/* A thread for each line, which sleeps until its line is due, asks, and waits for the response. */

typedef struct {
    const lines_job_t *job;
    lines_seen_t *seen;
    uint64_t first_us;
    modbus_t *client;
    pthread_t thread;
} reader_t;

static reader_t readers[LINES_MOST];
static int is_over;

static void sleep_until(uint64_t time_us)
{
    const struct timespec at = {(time_t)(time_us / 1000000), (long)(time_us % 1000000) * 1000};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
}

static void *read_line(void *ctx)
{
    const reader_t *const reader = ctx;
    uint16_t values[FATHOM_HPS167S_MEASUREMENT_COUNT];
    for (uint64_t due_us = reader->first_us; !__atomic_load_n(&is_over, __ATOMIC_RELAXED);
         due_us += reader->job->period_us) {
        sleep_until(due_us);
        const int count = modbus_read_registers(reader->client, FATHOM_HPS167S_MEASUREMENT,
                                                FATHOM_HPS167S_MEASUREMENT_COUNT, values);
        lines_see(reader->seen, count == FATHOM_HPS167S_MEASUREMENT_COUNT ? values[0] : 0);
    }
    return NULL;
}

static bool open_line(reader_t *reader, const char *path)
{
    reader->client = modbus_new_rtu(path, LINES_BAUD, 'E', 8, 1);
    if (reader->client == NULL) return false;
    if (modbus_set_slave(reader->client, LINES_UNIT) == 0 &&
        modbus_set_response_timeout(reader->client, LINES_TIMEOUT_S, 0) == 0 &&
        modbus_connect(reader->client) == 0 && modbus_flush(reader->client) >= 0)
        return true;
    modbus_free(reader->client);
    return false;
}

static bool begin(lines_job_t *job, unsigned n, uint64_t begin_us)
{
    reader_t *const reader = &readers[n];
    reader->job = job;
    reader->seen = &job->seen[n];
    reader->first_us = begin_us + lines_first_us(job, n);
    if (!open_line(reader, job->paths[n])) return false;
    if (pthread_create(&reader->thread, NULL, read_line, reader) == 0) return true;
    modbus_close(reader->client);
    modbus_free(reader->client);
    return false;
}

static bool run(lines_job_t *job, lines_mark_t marks[2])
{
    const uint64_t begin_us = lines_now_us();
    unsigned count = 0;
    __atomic_store_n(&is_over, 0, __ATOMIC_RELAXED);
    while (count != job->count && begin(job, count, begin_us)) count++;
    for (unsigned i = 0; i != 2; i++) {
        sleep_until(begin_us + lines_warm_us(job) + i * job->window_us);
        lines_mark(job, &marks[i]);
    }
    __atomic_store_n(&is_over, 1, __ATOMIC_RELAXED);
    for (unsigned n = 0; n != count; n++) {
        (void)pthread_join(readers[n].thread, NULL);
        modbus_close(readers[n].client);
        modbus_free(readers[n].client);
    }
    return count == job->count;
}

const lines_way_t lines_libmodbus = {"libmodbus", run};
