/* SPDX-License-Identifier: MIT */
/*
 * Any samples at any times, through a window of each length, behind which there is no memory.
 *
 * proves: src/processing/median.c
 * options: -eva-auto-loop-unroll 64 -eva-slevel 1 -eva-widening-delay 20
 *         -eva-slevel-function fathom_median_init:80,is_configuration:20,init:80,any_median:80
 *         -eva-split-return-function is_configuration:1,fathom_median_init:0,init:0
 */
#include "fathom/processing/median.h"
#include "any_sample.h"

static uint16_t window[FATHOM_MEDIAN_MAX_COUNT];
static fathom_median_t median;

static fathom_status_t init(uint16_t *first, uint8_t count)
{
    fathom_median_config_t config;
    config.window = first;
    config.unknown_us = any_32();
    config.gate_mm = any_16();
    config.gate_row = any_8();
    config.count = count;
    return fathom_median_init(&median, &config);
}

static void any_samples(void)
{
    while (any_bool()) {
        static fathom_sample_t out;
        fathom_sample_t sample = any_sample();
        if (any_bool()) (void)fathom_median_advance(&median, any_32());
        if (any_bool())
            (void)fathom_median_add_sample(&median, &sample, &out);
        else
            (void)fathom_median_add_sample(&median, &sample, &sample);
    }
}

static void any_median(uint8_t count)
{
    if (init(window + FATHOM_MEDIAN_MAX_COUNT - count, count) == FATHOM_OK) any_samples();
}

int main(void)
{
    any_memory(window, sizeof window);
    /*@ loop unroll 13; */
    for (uint8_t count = FATHOM_MEDIAN_MIN_COUNT; count <= FATHOM_MEDIAN_MAX_COUNT; count++)
        any_median(count);
    fathom_status_t status = init(NULL, any_8());
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    fathom_sample_t sample = any_sample();
    const bool is_median = fathom_median_add_sample(&median, &sample, &sample); /* in zeroed memory */
    /*@ assert is_median == 0; */
    status = init(window, any_8_in(0, FATHOM_MEDIAN_MIN_COUNT - 1));
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    status = init(window, any_8_in(FATHOM_MEDIAN_MAX_COUNT + 1, UINT8_MAX));
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    return 0;
}
