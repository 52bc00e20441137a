/* SPDX-License-Identifier: MIT */
#ifndef JOB_H
#define JOB_H

#include "fathom/engine/modbus_client.h"

/*
 * The job whose cost is measured: reading 4 registers, writing one and writing two, over a UART that is as
 * small as a port can be. job.c is what a user writes on top of the library, mcu.c and host.c are below it.
 */

extern const fathom_uart_t uart;
extern const fathom_clock_t clock;

void job_begin(void);
fathom_status_t job_read(void);
fathom_status_t job_write_one(void);
fathom_status_t job_write_many(void);

#endif
