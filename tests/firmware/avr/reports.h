/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REPORTS_H
#define FATHOM_TEST_AVR_REPORTS_H

#include <stdint.h>

/* Kinds of records of the images "auto" and "modbus". */
enum {
    REPORT_READY = 1,    /* waits for orders in GPIOR0, not 0 */
    REPORT_BEGUN = 2,    /* has them */
    REPORT_SAMPLE = 3,   /* time_us 4 bytes, distance_mm 2, sequence 2, kind, unit, probe */
    REPORT_ERROR = 4,    /* -status */
    REPORT_COUNTERS = 5, /* 2 bytes each */
    REPORT_ASKED = 6     /* has done what was ordered while it ran */
};

/* Orders to "auto". */
enum { ORDER_A16 = 1, ORDER_A05 = 2, ORDER_20_MS = 4 };

/* Orders to "modbus": how to begin, and while it runs. */
enum {
    ORDER_BEGIN = 1,      /* with any of: */
    ORDER_RETRY = 2,      /* one retry */
    ORDER_TWO_UNITS = 4,  /* unit 2 besides unit 1 */
    ORDER_SLOW_LOOP = 8,  /* it comes round every 20 ms */
    ORDER_115200 = 16,    /* 8E1, instead of 19200 */
    ORDER_AWAY = 64,      /* while it runs: nothing for 60 ms */
    ORDER_COUNTERS = 128, /* while it runs: report those of the line, then those of the port */
};

#endif
