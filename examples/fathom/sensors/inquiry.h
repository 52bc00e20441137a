/* SPDX-License-Identifier: MIT */
#ifndef INQUIRY_H
#define INQUIRY_H

#include "fathom/status.h"
#include "sensors/finding.h"

/* What a scan lets a model ask of a device, to tell whether the device is one: reads, and nothing else. */
typedef struct inquiry inquiry_t;
struct inquiry {
    /* Reads so many registers. What is damaged, or does not fit (perhaps a measurement that came unasked), is asked
     * again; silence too, if silence_tries > 1. True: status is FATHOM_OK. */
    bool (*ask)(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us,
                uint8_t silence_tries);
    fathom_status_t status;  /* of the last response; at first of the one to model_t.scan.first */
    const uint16_t *values;  /* of that response */
    scan_finding_t *finding; /* to be filled */
};

/* An A16 answers 0x0101 in about 120 ms and 0x0100 in up to 520, an A05 takes about 100 ms a probe. */
enum { INQUIRY_MEASURE_US = 300000, INQUIRY_SLOW_US = 1000000 };

#endif
