/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_WIRE_UNITS_H
#define FATHOM_TESTS_WIRE_UNITS_H

#include "wire.h"

/* A frame has ended on the wire. The unit ignores it unless the frame is a request to the unit that it could
 * hear. */
void wire_unit_hears(wire_unit_t *unit, const wire_frame_t *frame);

/* The unit's next frame or its response is due: the unit sends it. */
void wire_unit_acts(wire_unit_t *unit);

#endif
