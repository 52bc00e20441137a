/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_HPS_DESK_H
#define FATHOM_TESTS_HPS_DESK_H

#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/hps167s_info.h"
#include "fathom/hps167s_settings.h"

/* An HPS-167S driver on the fake seam, and what the device is asked and says, in order. */
enum { DESK_GUARD = 0xA5 };

typedef struct {
    fake_modbus_t fake;
    fathom_hps167s_config_t config;
    fathom_hps167s_t hps;
    fathom_sensor_t sensor;
    fathom_sample_t sample;
    uint32_t step_us; /* the application's loop */
    int32_t argument; /* of the command */
} desk_t;

extern desk_t desk;

/* One request as it has to be, and how it ends: FATHOM_READY with the registers of `values` (of a write: acknowledged),
 * FATHOM_ERR_EXCEPTION with values[0], or another error. A write of many has to carry `values`. */
typedef struct {
    uint8_t head[6]; /* unit, function, address, count or value */
    fathom_status_t ends;
    uint16_t values[4];
    uint32_t baud; /* at which it is asked; 0: no settings are named */
} row_t;

/* Set-up of a test, and the driver's init. */
int desk_set_up(void **state);
void desk_start(void);

/* Calls the command in the application's loop until it has ended: exactly these requests are made. */
fathom_status_t desk_play(fathom_status_t (*command)(void), const row_t *rows, unsigned count);

/* fathom_poll, the sample filled with DESK_GUARD before. */
fathom_status_t desk_poll(void);

/* A driver of its own, at this address and with these settings in its config. */
void desk_start_at(uint8_t address, const fathom_line_settings_t *settings);

/* The next measurement is asked of this unit at this rate, 3 s later; 0: no settings are named. Then it is answered with
 * the example of command #5, or not at all, which fathom_poll tells like this. */
void desk_asks(uint8_t unit, uint32_t baud);
void desk_answers(void);
void desk_is_silent(fathom_status_t as);

void desk_assert_guard(const void *object, size_t size);

#define ROWS(...) (const row_t[]){__VA_ARGS__}, sizeof((const row_t[]){__VA_ARGS__}) / sizeof(row_t)

/* In a fine loop and in one that comes round every 20 ms, and across the wrap of the clock. */
enum { DESK_ROUNDS = 4 };
void desk_begin_round(unsigned round);

#define DESK_SUITE                                                                                           \
    static const suite_t suite = {                                                                           \
        .set_up = desk_set_up, .begin_round = desk_begin_round, .rounds = DESK_ROUNDS}

#endif
