/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_UNIT_H
#define FATHOM_MODBUS_UNIT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * One Modbus unit as a driver deals with it: one request at a time, no faster than the device can, and each
 * outcome handed over once. The Modbus drivers are built on it; their users need not know it.
 *
 * A unit that does not answer is asked less and less often, so that it does not take the line from the others:
 * after the third time in a row it is left alone for one time-out, then for two, four, eight, sixteen. The first
 * thing that it says ends that. A command is asked at once all the same.
 *
 * There are two kinds of question. The repeated one (a measurement) comes again and again, and nobody minds
 * if an outcome is replaced by a newer one. A command is asked once, and its outcome waits for whoever asked. Both
 * may be reads or writes; modbus_setting.h has the settings of a device, which take several of them.
 */
typedef struct {
    uint32_t timeout_us; /* first byte of the answer */
    uint32_t pace_us;    /* from this request to the next one to the unit, at least; retries come when the
                            line sends them, and the next one that much after the last of them */
    uint32_t backoff_us; /* the longest that a dead unit is left alone; 0: 16 time-outs; up to 2^31 */
    const fathom_line_settings_t *settings; /* fathom_exchange_t.settings */
    /* count registers, the driver's: those of a read are written on FATHOM_READY only, those of a write of many read
     * when it leaves. That of a write of one is read at once and need not live any longer. */
    uint16_t *values;
    uint16_t first; /* address of the first register, 1..0x3FFF; with is_command and the function it tells
                         the questions of a driver apart */
    uint8_t count;  /* 1..125; 1..123 to write many */
    uint8_t retries;
    bool is_command;
    uint8_t function; /* 0: FATHOM_MODBUS_READ_HOLDING_REGISTERS; or one of the two that write */
} fathom_modbus_question_t;

typedef struct {
    fathom_modbus_request_t request;
    const fathom_modbus_t *modbus;
    const fathom_clock_t *clock;
    uint32_t polled_us;
    uint32_t pace_us; /* of the present question */
    uint32_t backoff_us;
    uint32_t pause_us; /* until the unit may be asked again */
    uint32_t alone_us; /* until a unit that does not answer is asked the repeated question again */
    uint32_t warm_us;  /* after power-on: until silence is an error */
    uint32_t heard_us; /* the clock when the last answer came */
    /* Not NULL: instead of a question's, since the device has changed its. */
    const fathom_line_settings_t *settings;
    uint16_t answers; /* counters; each stops at 65535. The other outcomes: */
    uint16_t failures;
    uint8_t address; /* 0..254; what is written to 0 goes to all units */
    uint8_t state;
    uint8_t attempts; /* of the present question that were seen to leave */
    uint8_t silences; /* outcomes in a row that were FATHOM_ERR_NO_ANSWER, as far as they matter */
    bool is_command;  /* the present question */
    uint16_t asked;   /* which question is the present one; 0: none yet */
    uint16_t waiting; /* the command that waits for its turn; 0: none */

    /* modbus_setting.h: */
    const fathom_line_settings_t *home_settings; /* where the device was, while a setting moves it */
    uint16_t setting;                            /* the question that is carried out; 0: none */
    uint8_t home_address;
    uint8_t step;    /* FATHOM_MODBUS_UNIT_INSIDE: what is asked now belongs to the setting */
    int8_t outcome;  /* of the write */
    uint16_t doubts; /* bit register % 16: was written and has not read so since; until power-on */
    uint16_t given;  /* the setting that was written last, and was acknowledged or not so before; 0: none */
    uint16_t given_value;
    bool is_written; /* the write of the last setting has been handed to the line */
    bool is_blind;   /* the next setting is, or the present one */
} fathom_modbus_unit_t;

enum { FATHOM_MODBUS_UNIT_INSIDE = 8 };

/* modbus and clock outlive the unit. FATHOM_READY, or FATHOM_ERR_ARGUMENT: a pointer is NULL or the address
 * is 255, which asks everybody. */
fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_t *modbus,
                                        const fathom_clock_t *clock, uint8_t address);

/*
 * Asks the question, or goes on with it: call it with the same question until it is not FATHOM_PENDING.
 * FATHOM_READY or the error with which the request ended (fathom_exchange_t), each outcome once: where two callers ask
 * the same question, also as the first one of a setting, the one that calls next has it, and the other asks anew.
 * FATHOM_ERR_BUSY: another command or setting is not finished, or nobody has taken its outcome.
 * FATHOM_ERR_WARMING_UP: so soon after power-on the unit was silent, was not understood or refused.
 * FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY: as fathom_modbus_t.submit. FATHOM_ERR_PORT: as fathom_modbus_t.poll,
 * and nothing was asked.
 */
fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question);

/* What tells the questions of one driver apart; not 0. */
uint16_t fathom_modbus_unit_name(const fathom_modbus_question_t *question);

/* Forgets what was asked and any outcome; a request under way is cancelled. A setting that was under way may hold or
 * not; the unit is asked where it was before. */
void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit);

/* The device gets power now: what was asked is forgotten, and for warm_us (up to 2^31) its silence, damaged answers
 * and exceptions are FATHOM_ERR_WARMING_UP. */
void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us);

/* Is it so soon after power-on? As of the last call. */
bool fathom_modbus_unit_is_warming_up(const fathom_modbus_unit_t *unit);

/* How long until something can happen without a new byte, given that the unit is asked again and again. */
uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit);

#ifdef __cplusplus
}
#endif

#endif
