/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_UNIT_H
#define FATHOM_MODBUS_UNIT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a driver reaches its sensor: what the configs of all Modbus drivers have in common. Read by init only; the
 * transport, its clock and the line settings outlive the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_modbus_t *transport; /* modbus_client.h, dyp_client.h, or a port's */
    /* Where those on one line differ (line.h); NULL: as they are. */
    const fathom_line_settings_t *line_settings;
    uint32_t period_us;  /* from one measurement to the next; 0 and anything less: the driver's least */
    uint32_t timeout_us; /* of a measurement; 0: the driver's */
    uint32_t command_timeout_us; /* of all other requests; 0: 1 s */
    uint32_t backoff_us;         /* the longest back-off; 0: 16 time-outs; up to 2^31 */
    uint8_t address;             /* 1..254; 0: 1, the factory's */
    /* It is at address 0 and responds there; `address` is 0. It can be read, not set. For A16 and A05 by Modbus. */
    bool address_zero;
    uint8_t retries; /* after a failed attempt, of what only reads; 0: none */
} fathom_modbus_config_t;

#define FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US 1000000uL

/*
 * One Modbus unit as a driver deals with it: one request at a time, no faster than the device can, and each
 * outcome handed over once. The Modbus drivers are built on it; their users need not know it.
 *
 * Back-off: a silent unit gets fewer and fewer requests, so that it does not take the line from the others. After the
 * third time-out in a row the repeated request pauses for one time-out, then for two, four, eight, sixteen. The first
 * response, whatever it is, ends that. A command is sent at once all the same.
 *
 * There are two kinds of request, told apart by their id. The repeated one (a measurement) comes again and again, and
 * its outcome may be replaced by a newer one. A command is sent once, and its outcome waits for its caller. Both may be
 * reads or writes; modbus_setting.h has the settings of a device, which take several of them. From one request to the
 * next passes the period at least; retries come when the line sends them, and the period counts from the last of them.
 */
typedef struct {
    /* The driver's: registers of a read are written on FATHOM_READY only, those of a write of many read when it leaves.
     * NULL: there are none, as of a write of one. */
    uint16_t *values;
    uint16_t first;   /* address of the first register */
    uint16_t last;    /* how many registers, 1..125, to write many 1..123; or the value to write one */
    uint8_t function; /* FATHOM_MODBUS_READ_HOLDING_REGISTERS or one of the two that write */
    uint8_t id; /* tells a driver's requests apart: 1..127 repeated, from FATHOM_MODBUS_COMMAND a command */
} fathom_modbus_unit_request_t;

enum { FATHOM_MODBUS_COMMAND = 0x80 };

/* The bytes first, where small machines reach them best. */
typedef struct {
    uint8_t state;
    uint8_t current;         /* id of the present request; 0: none yet */
    uint8_t waiting;         /* id of the command that waits for its turn; 0: none */
    int8_t transport_status; /* of its last poll */
    uint8_t attempts;        /* of the present request that were seen to leave */
    uint8_t timeouts_in_row; /* outcomes in a row that were FATHOM_ERR_NO_RESPONSE, as far as they matter */
    uint8_t retries;         /* as in fathom_modbus_config_t */
    uint8_t address;         /* 0..254; what is written to 0 goes to all units */

    /* modbus_setting.h: */
    uint8_t setting; /* the id of the write that is carried out; 0: none */
    uint8_t step;    /* with FATHOM_MODBUS_UNIT_IN_SETTING, FATHOM_MODBUS_UNIT_ONCE */
    int8_t outcome;  /* of the write */
    uint8_t known_address;
    /* Id of the setting that was written last, and was acknowledged or read as another value before; 0: none. */
    uint8_t last_written;
    bool is_written;             /* the write of the last setting has been handed to the line */
    bool is_blind;               /* the next setting is, or the present one */
    uint16_t last_written_value; /* of it */
    uint16_t unconfirmed;        /* bit id % 16: was written and has not read back since; until power-on */

    uint16_t responses; /* outcomes that are FATHOM_READY; stops at 65535 */
    uint16_t failures;  /* the others; stops at 65535 */
    const fathom_modbus_t *transport;
    const fathom_line_settings_t *line_settings;       /* where the device is now; NULL: as the line is */
    const fathom_line_settings_t *known_line_settings; /* where it was, while a setting moves it */
    uint32_t polled_us;
    uint32_t pause_us;        /* until the next request may be sent */
    uint32_t backoff_left_us; /* until the repeated request may be sent again */
    uint32_t warm_us;         /* after power-on: until silence is an error */
    uint32_t timeout_us;      /* this and the next three as in fathom_modbus_config_t, without zeros */
    uint32_t command_timeout_us;
    uint32_t pace_us;
    uint32_t backoff_us;
    fathom_modbus_request_t request;
} fathom_modbus_unit_t;

/* In `step`: the present request belongs to the setting that is carried out; it is its write, sent once. */
enum { FATHOM_MODBUS_UNIT_IN_SETTING = 8, FATHOM_MODBUS_UNIT_ONCE = 16 };

/* timeout_us and pace_us: the driver's time-out where the config says 0, and its least period. FATHOM_READY, or
 * FATHOM_ERR_ARGUMENT: no transport, or it has no clock; the address is 255 (any unit), or is set beside
 * address_zero. */
fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_config_t *config,
                                        uint32_t timeout_us, uint32_t pace_us);

/*
 * Lets time pass and the transport work. Each function of a driver that sends requests calls it first, once and not
 * from within others: below it the stack is deepest.
 */
void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit);

/*
 * Sends the request, or goes on with it, after fathom_modbus_unit_poll: call both, with a request of the same id, until
 * it is not FATHOM_PENDING.
 * FATHOM_READY or the error with which the request ended (fathom_transaction_t), each outcome once: where two callers
 * have the same request, also as the first one of a setting, the one that calls next gets it, and the other begins
 * anew.
 * FATHOM_ERR_BUSY: another command or setting is not finished, or its outcome was not taken.
 * FATHOM_ERR_WARMING_UP: so soon after power-on the unit was silent, was not understood or refused.
 * FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY: as fathom_modbus_t.submit. FATHOM_ERR_PORT: the last poll returned
 * it, and nothing was sent.
 */
fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit,
                                       const fathom_modbus_unit_request_t *request);

/* Forgets the request and any outcome; a request under way is cancelled. A setting that was under way may be set or
 * not; the unit is looked for where it was before. */
void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit);

/* The device gets power now: the request is forgotten, and for warm_us (up to 2^31) its silence, damaged responses
 * and exceptions are FATHOM_ERR_WARMING_UP. */
void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us);

/* Is it so soon after power-on? As of the last call. */
static inline bool fathom_modbus_unit_is_warming_up(const fathom_modbus_unit_t *unit)
{
    return unit->warm_us != 0u;
}

/* The exception code of the response that came last, FATHOM_MODBUS_ILLEGAL_FUNCTION or another; 0: it was none. Valid
 * after FATHOM_ERR_EXCEPTION, until the next request. */
static inline uint8_t fathom_modbus_unit_exception(const fathom_modbus_unit_t *unit)
{
    return unit->request.message.exception;
}

/* How many requests ended with FATHOM_READY, and how many otherwise, retries included; each stops at 65535. */
static inline uint16_t fathom_modbus_unit_responses(const fathom_modbus_unit_t *unit)
{
    return unit->responses;
}
static inline uint16_t fathom_modbus_unit_failures(const fathom_modbus_unit_t *unit)
{
    return unit->failures;
}

/* The clock when the last byte of the response came; until the next request. */
static inline uint32_t fathom_modbus_unit_heard_us(const fathom_modbus_unit_t *unit)
{
    return unit->request.transaction.link.heard_us;
}

/* How long, in us, until poll has something to do without a new byte, given that the request is repeated. */
uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit);

#ifdef __cplusplus
}
#endif

#endif
