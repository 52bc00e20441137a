/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_TEXT_H
#define SENSOR_TEXT_H

#include "sensors/models.h"

/* SENSOR[:ADDRESS][:MODE], as a user names a sensor: digits are the address, words the mode. */
typedef struct {
    const model_t *model;
    const char *address; /* NULL: it is not there; "": the factory's */
    const char *mode;    /* NULL: it is not there */
    char parts[40];
} sensor_text_t;

/* Of `text`, its first `length` bytes. It may not be moved afterwards. False after a usage error. */
bool sensor_text_parse(sensor_text_t *sensor, const char *command, const char *text, size_t length);

/* Its address, where it says one; else *address stays. False after a usage error. */
bool sensor_text_address(const sensor_text_t *sensor, const char *command, const model_mode_t *mode,
                         uint8_t *address);

#endif
