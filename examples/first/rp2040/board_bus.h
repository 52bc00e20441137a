/* SPDX-License-Identifier: MIT */
#ifndef FIRST_BOARD_BUS_H
#define FIRST_BOARD_BUS_H

#include "fathom_rp2040.h"

typedef fathom_rp2040_bus_t board_bus_t;

#endif
