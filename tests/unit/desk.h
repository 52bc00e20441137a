/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_DESK_H
#define FATHOM_TESTS_DESK_H

#include "drivers.h"
#include "fake_modbus.h"

/* A driver on the fake transport of Modbus, and what its device is asked and says, in order. */
typedef struct {
    fathom_sensor_t sensor; /* the test's, for desk_poll */
    fathom_sample_t sample; /* the last one */
    uint32_t step_us;       /* the application's loop */
    int32_t argument;       /* of the command */
    uint8_t retries;        /* that readings have to have; what changes a device has none */
    uint32_t timeout_us;    /* that all have to have; 0: any */
} desk_t;

extern fake_modbus_t fake;
extern desk_t desk;

/* One request as it has to be, and how it ends: FATHOM_OK with the registers of `values` (of a write: acknowledged),
 * FATHOM_ERR_EXCEPTION with values[0], or another error. A write of many has to carry `values`. */
typedef struct {
    uint8_t head[6]; /* unit, function, address, count or value */
    fathom_status_t ends;
    uint16_t values[4];
    uint32_t baud; /* at which it is asked; 0: no settings are named */
} row_t;

/* Reads of one register, and a write of one that is acknowledged: A05 3(3), A16 6(3). */
#define READ(unit, address, ends, value)                                                                     \
    {                                                                                                        \
        {unit, 3, HIGH(address), LOW(address), 0, 1}, ends, {value}, 0                                       \
    }
#define WRITE(unit, address, value, ends)                                                                    \
    {                                                                                                        \
        {unit, 6, HIGH(address), LOW(address), HIGH(value), LOW(value)}, ends, {2}, 0                        \
    }

/* All begins anew at this time, with a loop of 1 ms. */
void desk_begin(uint32_t now_us);

/* fathom_poll, checked; and so much later, when nothing comes of it. */
fathom_status_t desk_poll(void);
fathom_status_t desk_poll_after(uint32_t us);
void desk_waits(uint32_t us);

/* The request under way is as in the row, and ends so with the next poll. */
void desk_response(const row_t *row);
void desk_says(uint16_t value); /* a read of one register */

/* Calls the command in the application's loop until it has ended: exactly these requests are made. desk_part: until the
 * last of them is answered, which the next call will see. */
void desk_part(fathom_status_t (*command)(void), const row_t *rows, unsigned count);
fathom_status_t desk_play(fathom_status_t (*command)(void), const row_t *rows, unsigned count);

#define ROWS(...)                  (const row_t[]){__VA_ARGS__}, sizeof((const row_t[]){__VA_ARGS__}) / sizeof(row_t)
#define PLAY(command, status, ...) assert_int_equal(desk_play(command, ROWS(__VA_ARGS__)), status)

#define PART(command, ...) desk_part(command, ROWS(__VA_ARGS__))

#endif
