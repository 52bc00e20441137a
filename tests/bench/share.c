/* SPDX-License-Identifier: MIT */
/* Prints what each of three sensors gets of one pair. */
#include <stdio.h>

#include "../devices/sim/mix.h"

enum { SECONDS = 60, ALONE_HPS = 1 << MIX_A16 | 1 << MIX_A05 };

static const char *const names[MIX_SENSORS] = {"A16", "A05", "HPS-167S"};

static const struct {
    const char *name;
    mix_t mix;
} rows[] = {
    {"HPS-167S alone", {.absent = ALONE_HPS}},
    {"A16 processed", {.processed = true}},
    {"A16 real-time", {.processed = false}},
    {"A16 processed, HPS-167S every 200 ms", {.hps_period_us = 200000, .processed = true}},
    {"A16 real-time, HPS-167S every 200 ms", {.hps_period_us = 200000, .processed = false}},
    {"A16 real-time, A05 dead", {.dead = 1 << MIX_A05}},
};

static void show(const char *name, mix_t mix, bool fair)
{
    mix_share_t shares[MIX_SENSORS];
    mix.fair = fair;
    mix_run(&mix, SECONDS, shares);
    for (int i = 0; i != MIX_SENSORS; i++) {
        if ((mix.absent >> i & 1) != 0) continue;
        (void)printf("%-38s %-11s %-9s %10.1f %9u %9.1f %9.0f ms\n", name, fair ? "fair share" : "first come",
                     names[i], shares[i].responses / (double)SECONDS, (unsigned)shares[i].failures,
                     shares[i].line_us / (SECONDS * 1e4), shares[i].longest_wait_us / 1e3);
    }
}

int main(void)
{
    (void)printf("%-38s %-11s %-9s %10s %9s %9s %12s\n", "mix", "policy", "sensor", "readings/s", "failures",
                 "line, %", "longest wait");
    for (size_t row = 0; row != sizeof rows / sizeof *rows; row++) {
        for (int fair = 0; fair != 2; fair++) show(rows[row].name, rows[row].mix, fair != 0);
    }
    return 0;
}
