/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_H
#define FATHOM_HPS167S_H

#include <stdint.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/engine/internal/modbus_setting.h"
#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S, infrared time of flight on RS-485, by Modbus RTU. From the factory: address 1, 19200 8E1. Here it
 * measures; hps167s_registers.h has what its commands and values mean, hps167s_info.h what can be read,
 * hps167s_settings.h what can be set, hps167s_auto.h listens to unasked frames.
 *
 * Its "registers" are commands, each with one right length; it is no register file, and reading in the wrong
 * place can reset it. What is declared here sends command #5 of the datasheet and nothing else.
 *
 * One sample a response, as often as polling and the pace allow:
 *   FATHOM_TARGET     80..30000 mm (the range is 80 to 18000)
 *   FATHOM_NO_TARGET  out of range or too weak: the device sends 65.53 m
 *   FATHOM_UNKNOWN    1..79 mm, below its range
 *   FATHOM_FAULT      the device reports a failure, with the abnormal packet of #5: all ones for distance, ambient
 *                     and precision, and magnitude 0. The datasheet leaves the exponent open, so any is taken
 * The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_RESPONSE  nothing from the unit in timeout_us, retries included. It is silent for some
 *                           seconds after power-on
 *   FATHOM_ERR_CHECKSUM     its response was damaged
 *   FATHOM_ERR_EXCEPTION    it refused; fathom_hps167s_exception has the number (1..4: table 39)
 *   FATHOM_ERR_MALFORMED    it sent something else, or values that it cannot mean: those are counted (implausible).
 *                           A distance of all ones in any other packet is one of them
 *   FATHOM_ERR_WARMING_UP   one of the first three, or the abnormal packet, so soon after fathom_hps167s_power_on
 *   FATHOM_ERR_PORT         the HAL's port is broken; returned by every poll until it works again
 *   FATHOM_ERR_LINE_BUSY    the line was never silent. Says nothing about the unit (status.h)
 *   FATHOM_ERR_OTHER_MASTER another master asked the same unit. Says nothing about the unit
 *   FATHOM_ERR_CANCELLED    the line was initialised again, or another driver moved the unit
 *   FATHOM_ERR_ARGUMENT     the driver is not initialised
 *
 * The longest time until fathom_poll() returns an outcome is that of modbus_unit.h:
 *
 *     period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *
 * Here B is the bound of a transaction alone on its line (line.h), S the sum of the bounds of the line's other
 * transactions, and P the polling interval. While a command or setting of this driver is in progress, its time is added.
 */

/* From one measurement to the next, at least: 54 a second (table 1). */
#define FATHOM_HPS167S_MIN_PERIOD_US 18519uL

/* Read by init only. Members that are 0 mean their defaults: a period of 18519 us, and a time-out of 500 ms, since the
 * slowest rate is 6 a second. The datasheet gives no times of commands. */
typedef struct {
    /* The address: 1..32, no address_zero. line_settings also where the baud rate is to be set. */
    fathom_modbus_config_t modbus;
    uint8_t warm_up_s; /* as it was set with #7, for fathom_hps167s_power_on; 0: 5, the factory's */
    bool no_warm_up;   /* it was set to 0 s */

    /* How to read what the datasheet leaves open; fathom_hps167s_set_limits has more. */

    /* The configuration (#2) is believed when so many responses in succession agree: its frame has the shape of a
     * measurement's. 1..8; 0: 2. 3 at least for 2 s after an unasked frame was heard. */
    uint8_t same_responses;
    uint8_t steps_per_degree; /* of the temperature (#4), degrees Fahrenheit: 10 for tenths; 0: 1 */
    /* The reconnect time (#15, #2) has its low word first. False: the high word, as all integers of the device. */
    bool low_word_first;
} fathom_hps167s_config_t;

#define FATHOM_HPS167S_NO_RESET_RESPONSE 0xFFFFu

typedef struct fathom_hps167s fathom_hps167s_t;

struct fathom_hps167s {
    uint8_t warm_up_s;
    uint8_t same_responses;
    uint8_t steps_per_degree;
    bool low_word_first;
    /* hps167s_info.h: a response to #2 is still to come, another frame was taken for it. */
    bool is_outstanding;
    bool is_among_unasked; /* an unasked frame was heard lately */
    uint8_t responses;     /* to #2, this time */
    uint8_t agreed;        /* of them, in succession */
    bool is_seeking;       /* hps167s_settings.h: it may be at `other` as well */
    bool is_looked_at;     /* #2 was read before the factory reset */
    uint16_t sequence;
    uint16_t implausible; /* responses that were refused for their values; stops at 65535 */
    /* To the last #6: 1 is success, FATHOM_HPS167S_NO_RESET_RESPONSE none, else the device's error code. */
    uint16_t reset_response;
    fathom_modbus_unit_request_t request;
    /* Responses to #2 and to #5 have one shape: neither may be what the other was last. */
    uint16_t measurement[FATHOM_HPS167S_MEASUREMENT_COUNT]; /* to #5 */
    uint16_t last_configuration[FATHOM_HPS167S_CONFIGURATION_COUNT];
    uint16_t last_measurement[FATHOM_HPS167S_MEASUREMENT_COUNT];
    uint16_t values[FATHOM_HPS167S_MAX_REGISTERS]; /* of all other responses */
    const fathom_hps167s_limits_t *limits;         /* NULL: the defaults */
    /* Is the response a measurement? NULL: #2 has not been read yet. */
    bool (*is_new)(fathom_hps167s_t *sensor);
    /* A request has ended; FATHOM_PENDING: power_on was called. NULL: the baud rate has never been set. */
    void (*follow)(fathom_hps167s_t *sensor, fathom_status_t status);
    uint32_t unasked_us; /* the clock when an unasked frame was heard */
    fathom_modbus_unit_t unit;
    uint32_t next_baud; /* from the next power-on; 0: as now */
    const fathom_line_settings_t *other;
    fathom_line_settings_t moved[2];                /* those in force, and those that are being set */
    fathom_modbus_setting_t setting;                /* the last one, or the one under way */
    uint16_t words[FATHOM_HPS167S_RECONNECT_COUNT]; /* what #15 writes */
};

/* FATHOM_OK, or FATHOM_ERR_ARGUMENT: no transport, an address over 32, address_zero, more than 8 same_responses, a
 * member of `modbus` outside its range (fathom_modbus_config_t), or a frame buffer of the line below 13 bytes. All values
 * of the other members are accepted. A refused init zeroes *sensor; then each poll and command returns
 * FATHOM_ERR_ARGUMENT. FATHOM_ERR_BUSY: a request of this driver is still queued; nothing changed. Call
 * fathom_hps167s_deinit() first. */
fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_hps167s_config_t *config);

/* Other limits of distances than the defaults, from now on. Fills in the defaults where *limits is 0; it is the
 * driver's as long as the sensor. FATHOM_OK, or FATHOM_ERR_ARGUMENT, and the limits are as before: over_range_mm
 * that is 65535 or not over max_mm, min_mm over max_mm. */
fathom_status_t fathom_hps167s_set_limits(fathom_hps167s_t *sensor, fathom_hps167s_limits_t *limits);

/* Cancels what is under way; the memory is the caller's again. After the configuration (#2) was read among unasked
 * frames a response may still be on its way: initialise another driver for the same unit a command's time-out later. */
void fathom_hps167s_deinit(fathom_hps167s_t *sensor);

/*
 * To be called when the sensor gets power: what was under way is forgotten, and for warm_up_s and one time-out (of a
 * request that was sent at the end of it) silence, a damaged response, an exception and the abnormal packet are
 * FATHOM_ERR_WARMING_UP: #7 says that nothing is measured then, not what is sent. Where the program does not know
 * when the sensor gets power, leave it out, and they are what they are.
 * A baud rate that was set for the next power-on is now used, in turns with the one before, until a response comes.
 */
void fathom_hps167s_power_on(fathom_hps167s_t *sensor);

/* For fathom_poll, which measures (#5) again and again. */
fathom_sensor_t fathom_hps167s_sensor(fathom_hps167s_t *sensor);

/* The exception code that came with the last FATHOM_ERR_EXCEPTION, until the next request; 0: there was none. */
static inline uint8_t fathom_hps167s_exception(const fathom_hps167s_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->unit);
}

/* For fathom_modbus_unit_responses and fathom_modbus_unit_failures: how many requests succeeded, and how many not. */
static inline const fathom_modbus_unit_t *fathom_hps167s_unit(const fathom_hps167s_t *sensor)
{
    return &sensor->unit;
}

/* Gives up what is under way. A setting may then be set or not; the driver stays where it was before. */
void fathom_hps167s_cancel(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
