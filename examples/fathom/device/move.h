/* SPDX-License-Identifier: MIT */
#ifndef MOVE_H
#define MOVE_H

#include "device/session.h"

/* Are the places at which a unit is to be silent now? That is the new address at the rate of today, which it passes,
 * and at the new rate. Asks there, and comes back. False after saying what was there, or that it is not known. */
bool move_is_free(session_t *session, uint8_t address, uint32_t baud);

/* The session goes where the driver has followed the unit. False after saying why. */
bool move_follow(session_t *session);

#endif
