/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "plan.h"
#include "tables.h"
#include "theory.h"

/* The soak as a program: prints a line for each sensor and fault, and fails when a rule is broken. */

static const char usage[] =
    "usage: soak [--transactions N] [--seed N] [--jobs N] [--only SENSOR[:FAULT[+FAULT]] | --only eight]\n"
    "Every sensor and mode in simulated time with each fault, each pair of faults, and all at once.\n"
    "  transactions    requests sent; of a sensor that sends by itself: frames\n"
    "  readings     samples; wrong: responses with a sample that the device has not said, or (old) not now\n"
    "  most         wrong responses that the checksum must let pass, at most: expected from the frames that "
    "were\n"
    "               hit in a way that it does not see for certain\n"
    "  stuck        no outcome in the longest time that the headers allow\n"
    "  recovered    from the end of the faults to the next right reading, the worst beside its bound\n"
    "  lost         transactions without a reading; unaccounted: of them those that no counter shows, or "
    "books\n"
    "               that do not balance; unexplained: those that no fault explains\n";

enum { MOST_JOBS = 8, EIGHT_SECONDS = 600 };

typedef struct {
    uint8_t setting;
    FILE *out;
    char *text;
    size_t size;
    cell_result_t sum;
    uint32_t broken, rows;
} share_t;

static struct {
    uint64_t transactions;
    uint32_t seed, jobs;
    uint8_t only; /* SOAK_SETTINGS: all */
    bool only_eight;
    uint8_t kinds[CELL_KINDS], kinds_used;
    pthread_mutex_t lock;
    uint8_t next;
    share_t shares[SOAK_SETTINGS];
} job = {
    .transactions = 100000, .seed = 1, .jobs = 1, .only = SOAK_SETTINGS, .lock = PTHREAD_MUTEX_INITIALIZER};

static void print_row(FILE *out, const char *sensor, const char *name, const cell_result_t *result)
{
    const rig_totals_t *const totals = &result->totals;
    const char *const broken = cell_broken_rule(result);
    (void)fprintf(out,
                  "%-13s %-26s %9" PRIu64 " %9" PRIu64 " %6" PRIu64 " %5" PRIu64 " %8.2f %5" PRIu64
                  " %9.1f %9.1f %8" PRIu64 " %4" PRIu64 " %4" PRIu64 "  %s%s\n",
                  sensor, name, totals->transactions, totals->readings, totals->wrong_responses, totals->old,
                  result->expected, totals->stuck, (double)result->recovered_us / 1000,
                  (double)result->bound_us / 1000, totals->lost, totals->unaccounted, totals->unexplained,
                  broken != NULL ? "BROKEN: " : "ok",
                  broken != NULL                         ? broken
                  : result->is_alike && totals->old != 0 ? " (old: see below)"
                                                         : "");
}

static void print_head(void)
{
    (void)printf("%-13s %-26s %9s %9s %6s %5s %8s %5s %9s %9s %8s %4s %4s\n", "sensor", "fault",
                 "transactions", "readings", "wrong", "old", "most", "stuck", "recov ms", "bound ms", "lost",
                 "unac", "unex");
}

static void report(void *ctx, uint8_t setting, const char *name, const cell_result_t *result)
{
    share_t *const share = ctx;
    print_row(share->out, soak_facts[setting].name, name, result);
    if (cell_broken_rule(result) != NULL) share->broken++;
    share->rows++;
    cell_add(&share->sum, result);
}

static void soak(share_t *share, uint64_t transactions)
{
    const plan_t plan = {report, share, job.seed};
    if (job.kinds_used != 0) {
        plan_these(&plan, share->setting, job.kinds, job.kinds_used, transactions);
        return;
    }
    plan_singles(&plan, share->setting, transactions / 2);
    plan_pairs(&plan, share->setting, transactions / 10 * 4);
    plan_mixtures(&plan, share->setting, transactions / 10);
}

static void *work(void *unused)
{
    for (;;) {
        (void)pthread_mutex_lock(&job.lock);
        const uint8_t setting = job.next++;
        (void)pthread_mutex_unlock(&job.lock);
        if (setting >= SOAK_SETTINGS) return NULL;
        if (job.only != SOAK_SETTINGS && job.only != setting) continue;
        share_t *const share = &job.shares[setting];
        share->setting = setting;
        share->out = open_memstream(&share->text, &share->size);
        if (share->out == NULL) abort();
        soak(share, job.only == SOAK_SETTINGS ? job.transactions / SOAK_SETTINGS : job.transactions);
        (void)fclose(share->out);
    }
}

/* SENSOR[:FAULT[+FAULT]] */
static bool parse_only(char *text)
{
    char *faults = strchr(text, ':');
    if (faults != NULL) *faults++ = '\0';
    job.only_eight = strcmp(text, "eight") == 0;
    if (job.only_eight) return faults == NULL;
    job.only = plan_find(text);
    if (job.only == SOAK_SETTINGS) return false;
    for (char *save = NULL, *name = faults == NULL ? NULL : strtok_r(faults, "+", &save); name != NULL;
         name = strtok_r(NULL, "+", &save)) {
        const uint8_t kind = fathom_sim_fault_find(name);
        if (kind == 0 || job.kinds_used == CELL_KINDS) return false;
        job.kinds[job.kinds_used++] = kind;
    }
    return true;
}

static bool parse(int argc, char **argv)
{
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc) return false;
        const unsigned long long number = strtoull(argv[i + 1], NULL, 10);
        if (strcmp(argv[i], "--transactions") == 0)
            job.transactions = number;
        else if (strcmp(argv[i], "--seed") == 0)
            job.seed = (uint32_t)number;
        else if (strcmp(argv[i], "--jobs") == 0)
            job.jobs = (uint32_t)number;
        else if (strcmp(argv[i], "--only") != 0 || !parse_only(argv[i + 1]))
            return false;
    }
    return job.jobs >= 1 && job.jobs <= MOST_JOBS && job.transactions != 0;
}

/* Sensors and faults; returns how many lines break a rule. */
static uint32_t soak_all(void)
{
    pthread_t threads[MOST_JOBS];
    cell_result_t sum = {0};
    uint32_t broken = 0, rows = 0;
    const time_t begin = time(NULL);
    for (uint32_t i = 1; i < job.jobs; i++)
        if (pthread_create(&threads[i], NULL, work, NULL) != 0) abort();
    (void)work(NULL);
    for (uint32_t i = 1; i < job.jobs; i++) (void)pthread_join(threads[i], NULL);
    print_head();
    for (uint8_t i = 0; i < SOAK_SETTINGS; i++) {
        share_t *const share = &job.shares[i];
        if (share->text == NULL) continue;
        (void)fputs(share->text, stdout);
        free(share->text);
        cell_add(&sum, &share->sum);
        broken += share->broken;
        rows += share->rows;
    }
    print_row(stdout, "all", "all", &sum);
    (void)printf("\nold values that cannot be told from new ones (%d causes):\n", THEORY_ALIKE);
    for (uint8_t i = 0; i < THEORY_ALIKE; i++) (void)printf("  %s\n", theory_alike[i].why);
    (void)printf("\n%" PRIu64 " transactions, %" PRIu64 " readings, %" PRIu64
                 " wrong (at most %.1f expected), %" PRIu64 " stuck, %" PRIu64 " s; %" PRIu32
                 " lines, %" PRIu32 " of them break a rule\n",
                 sum.totals.transactions, sum.totals.readings, sum.totals.wrong_responses, sum.expected,
                 sum.totals.stuck, (uint64_t)(time(NULL) - begin), rows, broken);
    return broken;
}

int main(int argc, char **argv)
{
    uint32_t broken = 0;
    if (!parse(argc, argv)) {
        (void)fputs(usage, stderr);
        return 2;
    }
    if (!job.only_eight) broken += soak_all();
    if (job.only == SOAK_SETTINGS) broken += tables_eight(EIGHT_SECONDS, job.seed);
    return broken == 0 ? 0 : 1;
}
