/* SPDX-License-Identifier: MIT */
#include "tables.h"

#include <inttypes.h>
#include <stdio.h>

#include "eight.h"

static uint64_t all_but_last(const eight_result_t *result)
{
    uint64_t sum = 0;
    for (uint8_t i = 0; i < EIGHT_LAST; i++) sum += result->readings[i];
    return sum;
}

/* Without back-off it is for comparison: only the first rules hold. */
static uint32_t print_eight(uint8_t mix, uint8_t trouble, bool backs_off, const eight_result_t *alive,
                            const eight_result_t *result)
{
    const uint32_t percent = eight_percent(alive, result);
    const char *broken = eight_broken_rule(result);
    if (broken == NULL && backs_off && percent < EIGHT_LEAST_PERCENT) broken = "less than 90 %";
    (void)printf("%-22s %-8s %-9s %9" PRIu64 " %9" PRIu64 " %6" PRIu32 " %% %10.1f %10.1f  %s%s\n",
                 eight_mix_names[mix], eight_trouble_names[trouble], backs_off ? "yes" : "no",
                 all_but_last(alive), all_but_last(result), percent, (double)result->returned_us / 1000,
                 (double)result->bound_us / 1000, broken != NULL ? "BROKEN: " : "ok",
                 broken != NULL ? broken : "");
    return broken != NULL ? 1 : 0;
}

uint32_t tables_eight(uint32_t seconds, uint32_t seed)
{
    uint32_t broken = 0;
    (void)printf("\neight units on one pair, the last one in trouble, %" PRIu32
                 " s; the readings of the other "
                 "seven, the worst off of them, and how soon the last one is back\n",
                 seconds);
    (void)printf("%-22s %-8s %-9s %9s %9s %8s %10s %10s\n", "units", "last", "back-off", "all well", "now",
                 "worst", "back ms", "bound ms");
    for (uint8_t mix = 0; mix < EIGHT_MIXES; mix++)
        for (uint8_t without = 0; without != 2; without++) {
            eight_result_t alive;
            eight_run(mix, EIGHT_ALIVE, without, seconds, seed, &alive);
            for (uint8_t trouble = EIGHT_DEAD; trouble < EIGHT_TROUBLES; trouble++) {
                eight_result_t result;
                eight_run(mix, trouble, without, seconds, seed, &result);
                broken += print_eight(mix, trouble, without == 0, &alive, &result);
            }
        }
    return broken;
}
