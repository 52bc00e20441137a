/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_WIRE_USERS_H
#define FATHOM_TESTS_WIRE_USERS_H

#include "wire_desk.h"

/* A driver on the line of the desk, its unit on the wire, and a judge of its outcomes. */
typedef enum {
    USER_HPS167S,
    USER_A16_MODBUS,
    USER_A05_MODBUS,
    USER_A05_DYP,
    USER_HPS167S_AUTO,
    USER_A16_AUTO,
    USER_A05_AUTO,
    USER_A16_CONTROLLED,
    USER_KINDS
} user_kind_t;

typedef struct {
    user_kind_t kind;
    fathom_sensor_t sensor;
    wire_unit_t *unit;
    wire_us_t timeout_us; /* of a request */
    wire_us_t rest_us;    /* that the driver may add: period and back-off; of a stream the stale time */
    uint8_t retries;
    bool is_stream;

    wire_us_t since_us;      /* the last outcome */
    wire_us_t slack_us;      /* the program did not poll for this time since then */
    unsigned ready, chances; /* chances: values that noise made, which no checksum detects */
} user_t;

enum { USERS = 4 };

extern user_t users[USERS];
extern unsigned user_count;

/* The name of a kind. */
const char *user_name(user_kind_t kind);
bool user_is_stream(user_kind_t kind);
/* The rate of the sensor's wire. */
uint32_t user_byte_us(user_kind_t kind);

/* After wire_open() and desk_open(): adds the unit with `address` to the wire, and its driver to the desk. */
user_t *user_add(user_kind_t kind, uint8_t address, uint8_t retries);
/* Initialises the driver again, as after a restart of the program. */
void user_init(user_t *user);
void user_deinit(user_t *user);
void users_forget(void);

/* Polls once and judges the outcome. */
fathom_status_t user_poll(user_t *user);

/* The program did not poll for this time. */
void users_slept(wire_us_t for_us);

/* Good frames that a driver of automatic frames of A16 or A05 has found. */
unsigned user_frames(const user_t *user);

/* The time within which each poll of the user must have had an outcome. */
wire_us_t user_bound_us(const user_t *user);

#endif
