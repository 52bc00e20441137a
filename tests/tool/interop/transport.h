/* SPDX-License-Identifier: MIT */
#ifndef TRANSPORT_H
#define TRANSPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/modbus.h"

/* What fathom_client and fathom_libmodbus_client share: steps.h's steps through the library's Modbus transport. */
typedef struct {
    const fathom_modbus_t *modbus;
    void (*wait)(void *port, uint32_t max_us);
    void *port;
    uint32_t timeout_us;
} transport_t;

/* Does the steps, ended by NULL, and prints an outcome each. False: one is no step, or none it can do. */
bool transport_run(const transport_t *transport, char **steps);

#endif
