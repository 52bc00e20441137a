/* SPDX-License-Identifier: MIT */
#ifndef FIRST_BOARD_BUS_H
#define FIRST_BOARD_BUS_H

#include "fathom_stm32f4.h"

typedef fathom_stm32f4_bus_t board_bus_t;

#endif
