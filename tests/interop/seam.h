/* SPDX-License-Identifier: MIT */
#ifndef SEAM_H
#define SEAM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/modbus.h"

/* What fathom_client and fathom_libmodbus_client share: steps.h's steps through the library's Modbus seam. */
typedef struct {
    const fathom_modbus_t *modbus;
    void (*wait)(void *port, uint32_t max_us);
    void *port;
    uint32_t timeout_us;
} seam_t;

/* Does the steps, ended by NULL, and prints an outcome each. False: one is no step, or none it can do. */
bool seam_run(const seam_t *seam, char **steps);

#endif
