/* SPDX-License-Identifier: MIT */
/*
 * What it costs to read many lines, each with an HPS-167S that responds at once, by several ways of a program:
 *
 *     bench_lines together|spread ROUNDS WINDOW_MS PERIOD_MS LINES[,LINES...] [WAY ...]
 *
 * together: all lines begin at once, as in a program that reads them all from its start on; spread: one after another,
 * evenly over the period, so that hardly two of them are ever due at one time. Prints one row of CSV a way and round;
 * the ways take turns, so that what else the machine does meets each of them. Round 0 is for warming up. WAY: loop,
 * libmodbus, every; none: all. Exit status 0, or 1 when a reading was wrong or a line could not be read, or 2 for wrong
 * usage.
 */
#define _DEFAULT_SOURCE 1 /* getrusage */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "lines.h"

enum { WARM_PERIODS = 3 };

const fathom_line_settings_t lines_settings = {LINES_BAUD, FATHOM_PARITY_EVEN, 1};

static const lines_way_t *const ways[] = {&lines_loop, &lines_libmodbus, &lines_every};
enum { WAYS = sizeof ways / sizeof *ways };

uint64_t lines_now_us(void)
{
    struct timespec now = {0, 0};
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

uint32_t lines_first_us(const lines_job_t *job, unsigned n)
{
    return job->is_spread ? (uint32_t)((uint64_t)job->period_us * n / job->count) : 0;
}

uint32_t lines_warm_us(const lines_job_t *job) { return WARM_PERIODS * job->period_us; }

static void one_more(uint32_t *count) { __atomic_store_n(count, *count + 1, __ATOMIC_RELAXED); }

void lines_see(lines_seen_t *seen, unsigned distance_mm)
{
    const unsigned number = distance_mm - LINES_FIRST_MM - seen->line * LINES_RESPONSES;
    const bool is_right = number < LINES_RESPONSES &&
                          (seen->number == LINES_RESPONSES || number == (seen->number + 1) % LINES_RESPONSES);
    one_more(is_right ? &seen->right : &seen->wrong);
    seen->number = is_right ? number : LINES_RESPONSES;
}

static uint64_t us_of(const struct timeval *time)
{
    return (uint64_t)time->tv_sec * 1000000u + (uint64_t)time->tv_usec;
}

void lines_mark(const lines_job_t *job, lines_mark_t *mark)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    mark->time_us = lines_now_us();
    mark->user_us = us_of(&usage.ru_utime);
    mark->system_us = us_of(&usage.ru_stime);
    mark->right = mark->wrong = 0;
    for (unsigned n = 0; n != job->count; n++) {
        mark->right += __atomic_load_n(&job->seen[n].right, __ATOMIC_RELAXED);
        mark->wrong += __atomic_load_n(&job->seen[n].wrong, __ATOMIC_RELAXED);
    }
}

/* One row. False: it could not be measured, or a reading was wrong. */
static bool measure(lines_job_t *job, const lines_way_t *way, unsigned round)
{
    lines_mark_t marks[2] = {{0}, {0}};
    for (unsigned n = 0; n != job->count; n++) job->seen[n] = (lines_seen_t){n, LINES_RESPONSES, 0, 0};
    if (!way->run(job, marks)) {
        (void)fprintf(stderr, "bench_lines: %s: a line could not be opened\n", way->name);
        return false;
    }
    (void)printf("%u,%s,%u,%lu,%lu,%lu,%u,%u\n", job->count, way->name, round,
                 (unsigned long)(marks[1].time_us - marks[0].time_us),
                 (unsigned long)(marks[1].user_us - marks[0].user_us),
                 (unsigned long)(marks[1].system_us - marks[0].system_us), marks[1].right - marks[0].right,
                 marks[1].wrong);
    return marks[1].wrong == 0 && marks[1].right != marks[0].right;
}

static bool is_named(const char *name, char **names)
{
    if (*names == NULL) return true;
    while (*names != NULL && strcmp(*names, name) != 0) names++;
    return *names != NULL;
}

static bool measure_all(lines_job_t *job, unsigned rounds, char **names)
{
    bool is_right = true;
    for (unsigned round = 0; round <= rounds; round++) {
        for (unsigned i = 0; i != WAYS; i++) {
            const lines_way_t *const way = ways[(i + round) % WAYS];
            if (is_named(way->name, names) && !measure(job, way, round)) is_right = false;
        }
    }
    return is_right;
}

int main(int argc, char **argv)
{
    static char paths[LINES_MOST][LINES_PATH];
    static lines_job_t job = {.paths = paths};
    if (argc < 6) return 2;
    const unsigned rounds = (unsigned)atoi(argv[2]);
    job.is_spread = strcmp(argv[1], "spread") == 0;
    job.window_us = (uint32_t)atoi(argv[3]) * 1000u;
    job.period_us = (uint32_t)atoi(argv[4]) * 1000u;
    (void)setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    if (!lines_begin_far_end(LINES_MOST, paths)) return 1;
    (void)puts("lines,way,round,time_us,user_us,system_us,transactions,wrong");
    bool is_right = true;
    for (char *at = argv[5]; *at != '\0'; at += *at == ',') {
        job.count = (unsigned)strtoul(at, &at, 10);
        if (job.count == 0 || job.count > LINES_MOST) return 2;
        if (!measure_all(&job, rounds, argv + 6)) is_right = false;
    }
    return is_right ? 0 : 1;
}
