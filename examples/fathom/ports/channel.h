/* SPDX-License-Identifier: MIT */
#ifndef CHANNEL_H
#define CHANNEL_H

#include "ports/port.h"

/* The former name of port_t, until each module has changed to the new one. */
typedef port_t channel_t;
enum { CHANNEL_STREAM_GAP_US = PORT_STREAM_GAP_US, CHANNEL_RESPONSE_GAP_US = PORT_RESPONSE_GAP_US };

#endif
