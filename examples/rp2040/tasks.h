/* SPDX-License-Identifier: MIT */
#ifndef RP2040_TASKS_H
#define RP2040_TASKS_H

#include <stdint.h>

/* What the task of a line has last read. */
typedef struct {
    uint32_t readings;
    uint32_t errors;
    uint32_t distance_mm; /* 65535: no target, or an error */
    int32_t status;       /* fathom_status_t */
} tasks_reading_t;

extern tasks_reading_t tank, gate;

#endif
