/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REPORTS_H
#define FATHOM_TEST_AVR_REPORTS_H

#include <stdint.h>

/* Kinds of records of the image "sensors". */
enum {
    REPORT_READY = 1,    /* waits for orders, not 0, in `ordered` */
    REPORT_BEGUN = 2,    /* has them */
    REPORT_SAMPLE = 3,   /* time_us 4 bytes, distance_mm 2, sequence 2, kind, unit, probe */
    REPORT_ERROR = 4,    /* -status */
    REPORT_COUNTERS = 5, /* 2 bytes each */
    REPORT_ASKED = 6     /* has done what was ordered while it ran */
};

/* Orders: how to begin, with which sensor, and what else. */
enum {
    ORDER_A16 = 1,
    ORDER_A05 = 2,
    ORDER_HPS167S = 4,
    ORDER_RETRY = 8,      /* one retry */
    ORDER_TWO_UNITS = 16, /* unit 2 besides unit 1 */
    ORDER_SLOW_LOOP = 32, /* it comes round every 20 ms */
    ORDER_115200 = 64     /* 8E1, instead of 19200 */
};

/* While it runs. */
enum {
    ORDER_AWAY = 1,    /* nothing for 60 ms */
    ORDER_COUNTERS = 2 /* report those of the line, then those of the port */
};

#endif
