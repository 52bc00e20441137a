/* SPDX-License-Identifier: MIT */
#ifndef PC_H
#define PC_H

#include "guest.h"

/* The cases of a PC with 8250s: ttyS1 and ttyS2 are joined by a cable, behind ttyS3 there is nothing. */
#define NEAR "/dev/ttyS1"
#define FAR  "/dev/ttyS2"

extern const guest_case_t pc_port_cases[];
extern const size_t pc_port_case_count;
extern const guest_case_t pc_sensor_cases[];
extern const size_t pc_sensor_case_count;

#endif
