/* SPDX-License-Identifier: MIT */
#include "fathom/fathom.hpp"

#include "bus.h"

static fathom::DRIVER sensor(bus);

int main()
{
    bus_begin();
    if (sensor.begin() != FATHOM_OK) return 1;
    for (;;) {
        if (sensor.poll() == FATHOM_PENDING) continue;
        distance_mm = sensor.distance_mm();
    }
}
