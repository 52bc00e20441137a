/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_DRIVERS_H
#define FATHOM_TESTS_DRIVERS_H

#include <string.h>

#include "suite.h"

#include "fathom/engine/sensor.h"

/* What the tests of all drivers need. */
#define MS ((int32_t)1000) /* an int may have 16 bits */
enum { GUARD = 0xA5 };
#define HIGH(word)   (uint8_t)((word) >> 8 & 0xFF)
#define LOW(word)    (uint8_t)((word)&0xFF)
#define PENDS(call)  assert_int_equal(call, FATHOM_PENDING)
#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Polls the driver. A sample goes to *last; without one no member of it may be written. */
fathom_status_t checked_poll(const fathom_sensor_t *sensor, fathom_sample_t *last);

/* Every member is as it should be. */
void assert_sample(const fathom_sample_t *is, fathom_sample_t should);

/* All bytes are GUARD. */
void assert_guard(const void *object, size_t size);

#endif
