/* SPDX-License-Identifier: MIT */
#include "job.h"

/* What the job needs of RAM; tests/bench/run.py asks the linker for the sizes of these three by name. */
fathom_line_t line;
fathom_modbus_request_t request;
uint8_t frame[32];

static uint16_t values[4];

static const fathom_line_config_t config = {.uart = &uart,
                                            .clock = &clock,
                                            .frame = frame,
                                            .frame_size = sizeof frame,
                                            .silence_us = FATHOM_T3_5_US(19200, 11)};

void job_begin(void)
{
    fathom_line_init(&line, &config);
    request.exchange.timeout_us = 100000;
    request.exchange.retries = 1;
}

static fathom_status_t job_run(void)
{
    const fathom_status_t status = fathom_modbus_client_submit(&line, &request);
    if (status != FATHOM_PENDING) return status;
    while (request.exchange.status == FATHOM_PENDING) fathom_line_poll(&line);
    return (fathom_status_t)request.exchange.status;
}

fathom_status_t job_read(void)
{
    fathom_modbus_read_holding_registers(&request.message, 1, 0x0100, 4, values);
    return job_run();
}

fathom_status_t job_write_one(void)
{
    fathom_modbus_write_single_register(&request.message, 1, 0x0200, values[0]);
    return job_run();
}

fathom_status_t job_write_many(void)
{
    fathom_modbus_write_multiple_registers(&request.message, 1, 0x0201, 2, values);
    return job_run();
}
