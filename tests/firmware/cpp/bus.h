/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CPP_BUS_H
#define FATHOM_TESTS_CPP_BUS_H

#include "fathom/fathom.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What both programs share: a bus of zeros that a port sets up elsewhere, and where a distance goes. */
typedef struct {
    fathom_line_t line;
    fathom_modbus_t modbus;
} bus_t;

extern bus_t bus;
extern volatile uint16_t distance_mm; /* 0: there is none */
void bus_begin(void);

#ifdef __cplusplus
}
#endif

#endif
