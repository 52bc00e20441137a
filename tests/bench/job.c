/* SPDX-License-Identifier: MIT */
#include "job.h"

/*
 * JOB_SLEEP: the program sleeps by fathom_line_due_us() and cancels. JOB_SENDERS, JOB_MASTERS: the line knows devices that send by themselves, and other masters. JOB_COUNTERS: the line
 * counts what happens. JOB_ALL: and finds out whether it echoes, heeds what the port says of the
 * bytes, has a listener, changes the line settings, and may read unit 0. Without either it is told that there is no
 * echo; what the library always has are retries, broadcast, break, any unit, and the quarantine of late responses.
 */

/* What the job needs of RAM; job.py asks the linker for the sizes of these by name. */
fathom_line_t line;
fathom_modbus_request_t request;
uint8_t frame[32];
#ifdef JOB_COUNTERS
uint16_t counters[FATHOM_LINE_COUNTERS];
#endif

static uint16_t values[4];

static const fathom_line_parts_t config = {.uart = &uart,
                                           .clock = &clock,
                                           .frame = frame,
                                           .frame_size = sizeof frame,
#ifdef JOB_COUNTERS
                                           .count = fathom_line_count,
                                           .counters = counters,
#endif
#ifdef JOB_ALL
                                           .find_echo = fathom_line_find_echo,
                                           .marks = fathom_line_marks,
#else
                                           .echo = FATHOM_LINE_ECHO_OFF,
#endif
#ifdef JOB_SENDERS
                                           .senders = &fathom_line_senders,
#endif
#ifdef JOB_MASTERS
                                           .masters = &fathom_line_masters,
#endif
                                           .silence_us = FATHOM_T3_5_US(19200, 11)};

#ifdef JOB_ALL
static uint8_t unasked;

static void job_receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                        uint32_t time_us)
{
    unasked = (uint8_t)(unasked + count);
}

static fathom_listener_t listener;
static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
#endif

void job_begin(void)
{
    fathom_line_init(&line, &config);
#ifdef JOB_ALL
    listener.receive = job_receive;
    listener.gap_us = 2005;
    (void)fathom_line_replace_listener(&line, &listener);
    request.transaction.line_settings = &settings;
#endif
    request.transaction.timeout_us = 100000;
    request.transaction.retries = 1;
}

static fathom_status_t job_run(void)
{
#ifdef JOB_ALL
    const fathom_status_t status = fathom_modbus_client_submit_with_zero(&line, &request);
#else
    const fathom_status_t status = fathom_modbus_client_submit(&line, &request);
#endif
    if (status != FATHOM_PENDING) return status;
    while (request.transaction.status == FATHOM_PENDING) {
        fathom_line_poll(&line);
#ifdef JOB_SLEEP
        /* Here a program sleeps for this time. If nothing can change any more, it cancels. */
        if (fathom_line_due_us(&line) == FATHOM_NO_DEADLINE) fathom_line_cancel(&line, &request.transaction);
#endif
    }
    return (fathom_status_t)request.transaction.status;
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
