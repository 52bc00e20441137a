/* SPDX-License-Identifier: MIT */
#ifndef MODBUS_EXCEPTION_H
#define MODBUS_EXCEPTION_H

#include <stdbool.h>
#include <stdint.h>

/* What an exception of Modbus says. */
typedef struct {
    const char *name; /* the specification's */
    const char *meaning;
    bool is_other_sensor; /* than the user has named, most likely */
} modbus_exception_t;

modbus_exception_t modbus_exception(uint8_t number);

#endif
