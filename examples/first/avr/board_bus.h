/* SPDX-License-Identifier: MIT */
#ifndef FIRST_BOARD_BUS_H
#define FIRST_BOARD_BUS_H

#include "fathom_avr.h"

typedef fathom_avr_bus_t board_bus_t;

#endif
