/* SPDX-License-Identifier: MIT */
#ifndef FIRST_BOARD_BUS_H
#define FIRST_BOARD_BUS_H

#include "fathom_posix.h"

typedef fathom_posix_bus_t board_bus_t;

#endif
