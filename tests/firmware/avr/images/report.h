/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REPORT_H
#define FATHOM_TEST_AVR_REPORT_H

/* What an image tells the bench (../board.h), and what a test reads of it (../reports.h). */
#include <avr/io.h>
#include <stdint.h>

#include "../reports.h"
#include "fathom/sample.h"
#include "fathom/status.h"

static inline void report_16(uint16_t value)
{
    GPIOR0 = (uint8_t)value;
    GPIOR0 = (uint8_t)(value >> 8);
}

static inline void report_32(uint32_t value)
{
    report_16((uint16_t)value);
    report_16((uint16_t)(value >> 16));
}

static inline void report_sample(const fathom_sample_t *sample)
{
    report_32(sample->time_us);
    report_16(sample->distance_mm);
    report_16(sample->sequence);
    GPIOR0 = sample->kind;
    GPIOR0 = sample->unit;
    GPIOR0 = sample->probe;
    GPIOR1 = REPORT_SAMPLE;
}

static inline void report_error(fathom_status_t status)
{
    GPIOR0 = (uint8_t)-status;
    GPIOR1 = REPORT_ERROR;
}

static inline void report_counters(const uint16_t *counters, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) report_16(counters[i]);
    GPIOR1 = REPORT_COUNTERS;
}

/* What the test has written to GPIOR0: how to begin. */
static inline uint8_t await_orders(void)
{
    GPIOR1 = REPORT_READY;
    while (GPIOR0 == 0) {
    }
    const uint8_t orders = GPIOR0;
    GPIOR0 = 0;
    GPIOR1 = REPORT_BEGUN;
    return orders;
}

#endif
