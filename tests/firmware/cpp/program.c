/* SPDX-License-Identifier: MIT */
/* The program of program.cpp in C: it keeps the newest reading and its status, and no old distance outlives an error. */
#include "bus.h"

#define JOIN_(a, b, c) a##b##c
#define JOIN(a, b, c)  JOIN_(a, b, c)

static JOIN(fathom_, DRIVER, _t) sensor;
static fathom_sample_t sample;
static fathom_status_t status = FATHOM_PENDING;

int main(void)
{
    bus_begin();
    if (JOIN(fathom_, DRIVER, _init)(&sensor, &bus.ON, NULL) != FATHOM_OK) return 1;
    for (;;) {
        const fathom_status_t result = JOIN(fathom_, DRIVER, _poll)(&sensor, &sample);
        if (result == FATHOM_PENDING) continue;
        status = result;
        distance_mm = status == FATHOM_OK && sample.kind == FATHOM_TARGET ? sample.distance_mm : 0;
    }
}
