/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_H
#define FATHOM_HPS167S_H

#include <stdint.h>

#include "fathom/modbus_setting.h"
#include "fathom/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S, infrared time of flight on RS-485, asked by Modbus RTU. From the factory: address 1, 19200 8E1.
 * Here it measures; hps167s_info.h has what it tells, hps167s_settings.h what can be set, hps167s_auto.h listens to
 * frames that nobody asked for.
 *
 * Its "registers" are commands, each with one right length; it is no register file, and reading in the wrong
 * place can reset it. What is declared here sends command #5 of the datasheet and nothing else.
 *
 * One sample an answer, as often as polling and the pace allow:
 *   FATHOM_TARGET     80..30000 mm (the range is 80 to 18000)
 *   FATHOM_NO_TARGET  out of range or too weak: the device says 65.53 m
 *   FATHOM_UNKNOWN    1..79 mm, below its range
 *   FATHOM_FAULT      the device says that it has failed, with the abnormal packet of #5: all ones for distance, ambient
 *                     and precision, and magnitude 0. The text says nothing of the exponent, so that any will do
 * The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_ANSWER  nothing from the unit in timeout_us, retries included. It is silent for some
 *                         seconds after power-on
 *   FATHOM_ERR_CHECKSUM   its answer was damaged
 *   FATHOM_ERR_EXCEPTION  it refused; unit.request.message.exception has the number (1..4: table 39)
 *   FATHOM_ERR_MALFORMED  it answered something else, or figures that it cannot mean: those are counted (implausible).
 *                         A distance of all ones in any other packet is one of them
 *   FATHOM_ERR_WARMING_UP one of the first three, or the abnormal packet, so soon after fathom_hps167s_power_on
 *   FATHOM_ERR_PORT       the HAL's port is broken; said by every poll until it works again
 */

/* From one measurement to the next, at least: 54 a second (table 1). */
#define FATHOM_HPS167S_MIN_PERIOD_US 18519ul

/* What a distance is taken for. The datasheet says "65.53 meters" for over range (#5), two decimals of a figure in mm,
 * and gives a range of 18 m and a note about 20 m; what lies between is no figure of this device. */
typedef struct {
    uint16_t max_mm;        /* min_mm..max_mm is a target; 0: 30000 */
    uint16_t over_range_mm; /* from here to 65534 is no target; over max_mm; 0: 65530 */
    uint16_t min_mm;        /* 1..min_mm - 1 is FATHOM_UNKNOWN; up to max_mm; 0: 80 */
} fathom_hps167s_limits_t;

/* Read by init only; modbus and clock outlive the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_modbus_t *modbus;
    const fathom_clock_t *clock;
    /* Where those on one line differ (line.h), and where the baud rate is to be set; NULL: as the line is. */
    const fathom_line_settings_t *settings;
    uint32_t backoff_us; /* how long a unit that does not answer is left alone at last; 0: 16 time-outs */
    uint32_t period_us;  /* from one request to the next; 0 and anything less: 18519 us */
    uint32_t timeout_us; /* of a measurement; the slowest rate is 6 a second. 0: 500 ms */
    uint32_t command_timeout_us; /* of whatever else is asked; 0: 1 s. The datasheet gives no times */
    uint8_t address;             /* 1..32; 0: 1, the factory's */
    uint8_t retries;             /* after a failed attempt, of commands that only read too; 0: none */
    uint8_t warm_up_s;           /* as it was set with #7, for fathom_hps167s_power_on; 0: 5, the factory's */
    bool no_warm_up;             /* it was set to 0 s */
    fathom_hps167s_limits_t limits;

    /* How to read what the datasheet leaves open, beside the limits. */
    uint8_t same_answers; /* the configuration (#2) is believed when so many answers in succession agree: its
                                   frame has the shape of a measurement's. 1..8; 0: 2. 3 at least for 2 s after
                                   an unasked frame was heard */
    uint8_t
        steps_per_degree; /* the temperature (#4) counts in steps of one degree Fahrenheit, by so much finer:
                                   10 for tenths. 0: 1 */
    bool low_word_first;  /* the reconnect time (#15, #2) has its low word first. False: the high word, as all
                                   other integers of the device */
} fathom_hps167s_config_t;

enum { FATHOM_HPS167S_MAX_ADDRESS = 32, FATHOM_HPS167S_MAX_REGISTERS = 11 };
#define FATHOM_HPS167S_NO_RESET_ANSWER 0xFFFFu

typedef struct {
    fathom_modbus_unit_t unit;
    uint32_t command_timeout_us;
    fathom_modbus_question_t question; /* the repeated one */
    fathom_hps167s_limits_t limits;
    uint32_t warm_us;
    uint16_t values[FATHOM_HPS167S_MAX_REGISTERS];
    uint16_t sequence;
    uint16_t implausible; /* answers that were refused for their figures; stops at 65535 */

    /* Answers to #2 and to #5 have one shape: neither may be what the other was last. */
    uint16_t told[4];
    uint16_t measured[4];
    uint32_t unasked_us; /* the clock when an unasked frame was heard */
    bool is_owed;        /* an answer to #2 is still to come: something else was taken for it */
    uint8_t answers;     /* to #2, this time */
    uint8_t agreed;      /* of them, in succession */
    uint8_t same_answers;
    uint8_t steps_per_degree;
    bool low_word_first;

    /* hps167s_settings.h: */
    bool is_seeking;   /* it may be at `other` as well */
    bool is_looked_at; /* before the factory reset */
    uint16_t
        reset_answer; /* of the last #6: 1 is success, FATHOM_HPS167S_NO_RESET_ANSWER none, else the device's
                              error code */
    uint16_t wanted[2]; /* the value of the setting under way */
    uint32_t next_baud; /* from the next power-on; 0: as now */
    const fathom_line_settings_t *other;
    fathom_line_settings_t moved[2]; /* the one that holds, and the one that is being set */
} fathom_hps167s_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no modbus or clock, an address over 32, over_range_mm that is 65535 or not over
 * max_mm, min_mm over max_mm, more than 8 same_answers. */
fathom_status_t fathom_hps167s_init(fathom_hps167s_t *sensor, const fathom_hps167s_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_hps167s_deinit(fathom_hps167s_t *sensor);

/*
 * To be called when the sensor gets power: what was under way is forgotten, and for warm_up_s and one time-out (of a
 * question that was asked at the end of it) silence, a damaged answer, an exception and the abnormal packet are
 * FATHOM_ERR_WARMING_UP: command #7 says that nothing is measured then, not what is answered. Where nobody can tell
 * when the sensor gets power, leave it out, and they are what they are.
 * A baud rate that was set for the next power-on is now asked at, in turns with the one before, until an answer comes.
 */
void fathom_hps167s_power_on(fathom_hps167s_t *sensor);

/* For fathom_poll, which measures (#5) again and again. */
fathom_sensor_t fathom_hps167s_sensor(fathom_hps167s_t *sensor);

/* Gives up what is under way. A setting may then hold or not; the driver asks where it did before. */
void fathom_hps167s_cancel(fathom_hps167s_t *sensor);

/*
 * Reads the four registers of a measurement's answer (#5, table 18), also one that nobody asked for. Sets the
 * members of *sample that come from the device: kind, raw, distance_mm, magnitude, ambient, precision, and
 * interference (false). FATHOM_READY, or FATHOM_ERR_MALFORMED, with nothing written: a distance that it cannot
 * mean, or an exponent over 16. decode_within: with other limits, of which none is 0.
 */
fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample);
fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
