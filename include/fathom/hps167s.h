/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_H
#define FATHOM_HPS167S_H

#include <stdint.h>

#include "fathom/modbus_unit.h"
#include "fathom/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S, infrared time of flight on RS-485, asked by Modbus RTU. From the factory: address 1, 19200 8E1.
 *
 * Its "registers" are commands, each with one right length; it is no register file, and reading in the wrong
 * place can reset it. This driver sends commands #1, #3 and #5 of the datasheet and nothing else.
 *
 * One sample an answer, as often as polling and the pace allow:
 *   FATHOM_TARGET     1..30000 mm (the range is 80 to 18000)
 *   FATHOM_NO_TARGET  out of range or too weak: the device says 65.53 m
 *   FATHOM_FAULT      the device says that it has failed: all ones for a distance (#5, abnormal packet)
 * The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_ANSWER  nothing from the unit in timeout_us, retries included. It is silent for some
 *                         seconds after power-on
 *   FATHOM_ERR_CHECKSUM   its answer was damaged
 *   FATHOM_ERR_EXCEPTION  it refused; unit.request.message.exception has the number (1..4: table 39)
 *   FATHOM_ERR_MALFORMED  it answered something else, or figures that it cannot mean
 *   FATHOM_ERR_PORT       the HAL's port is broken; said by every poll until it works again
 */

/* From one measurement to the next, at least: 54 a second (table 1). */
#define FATHOM_HPS167S_MIN_PERIOD_US 18519ul

/* Read by init only; modbus and clock outlive the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_modbus_t *modbus;
    const fathom_clock_t *clock;
    const fathom_line_settings_t *settings; /* where those on one line differ (line.h); NULL: as they are */
    uint32_t backoff_us; /* how long a unit that does not answer is left alone at last; 0: 16 time-outs */
    uint32_t period_us;  /* from one request to the next; 0 and anything less: 18519 us */
    uint32_t timeout_us; /* of a measurement; the slowest rate is 6 a second. 0: 500 ms */
    uint8_t address;     /* 1..32; 0: 1, the factory's */
    uint8_t retries;     /* after a failed attempt, of commands too; 0: none */
} fathom_hps167s_config_t;

enum { FATHOM_HPS167S_MAX_ADDRESS = 32, FATHOM_HPS167S_MAX_REGISTERS = 11, FATHOM_HPS167S_UUID_LENGTH = 16 };

typedef struct {
    fathom_modbus_unit_t unit;
    fathom_modbus_question_t question; /* the repeated one */
    uint16_t values[FATHOM_HPS167S_MAX_REGISTERS];
    uint16_t sequence;
    uint16_t implausible; /* answers that were refused for their figures; stops at 65535 */
} fathom_hps167s_t;

/* Command #1, table 10. */
typedef struct {
    uint16_t year; /* 2000..2255 */
    uint8_t month; /* 1..12, if the device was set right */
    uint8_t day;   /* 1..31 */
    uint8_t major;
    uint8_t minor;
    uint8_t revision;
} fathom_hps167s_version_t;

/* Command #3, table 14. */
typedef struct {
    uint8_t uuid[FATHOM_HPS167S_UUID_LENGTH]; /* in the order of the wire */
    uint16_t year;                            /* 2000..2255 */
    uint8_t month;
    uint8_t day;
    uint8_t major;
    uint8_t minor;
} fathom_hps167s_details_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no modbus or clock, or an address over 32. */
fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_hps167s_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_hps167s_deinit(fathom_hps167s_t *sensor);

/* For fathom_poll, which measures (#5) again and again. */
fathom_sensor_t fathom_hps167s_sensor(fathom_hps167s_t *sensor);

/*
 * Commands. Each asks the device and returns at once, like everything here: call it, with the loop going on in
 * between, until it does not return FATHOM_PENDING. On FATHOM_READY *out is written, and only then. A command
 * takes its turn after a measurement that is under way, and until its outcome was taken fathom_poll is
 * FATHOM_PENDING; fathom_hps167s_cancel gives it up. The errors are those above, and
 *   FATHOM_ERR_BUSY       another command is not finished, or its outcome was not taken
 *   FATHOM_ERR_CAPACITY   the line's frame buffer is too small (27 bytes for the details)
 * An answer takes up to 1 s.
 */
fathom_status_t fathom_hps167s_interface_version(fathom_hps167s_t *sensor,
                                                 fathom_hps167s_version_t *out);                 /* #1 */
fathom_status_t fathom_hps167s_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out); /* #3 */

/* Gives up what is under way. */
void fathom_hps167s_cancel(fathom_hps167s_t *sensor);

/*
 * Reads the four registers of a measurement's answer (#5, table 18), also one that nobody asked for. Sets the
 * members of *sample that come from the device: kind, raw, distance_mm, magnitude, ambient, precision, and
 * interference (false). FATHOM_READY, or FATHOM_ERR_MALFORMED, with nothing written: a distance that it cannot
 * mean, or an exponent over 16.
 */
fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
