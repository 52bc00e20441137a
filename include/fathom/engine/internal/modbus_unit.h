/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_UNIT_H
#define FATHOM_MODBUS_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief One Modbus unit as a driver uses it: one request at a time, paced, each result delivered once.
 *
 * The Modbus drivers are built on this file. A program needs only fathom_modbus_config_t and the rules below. Commands
 * stand in modbus_command.h and settings in modbus_setting.h; a program that only measures links neither.
 *
 * Rules of behaviour:
 *
 * 1. **Two kinds of request.** The measurement (of fathom_poll()) is sent again and again, and a
 *    newer result may replace an older one. A command (a function such as fathom_hps167s_get_details()) is sent once, and
 *    its result waits for its caller. modbus_setting.h builds settings from several commands.
 *
 * 2. **Pace.** `period_us` or the driver's least period passes from one request to the next. A retry leaves when the
 *    line sends it; the period counts from the last retry.
 *
 * 3. **Back-off.** After the third time-out in a row the measurement pauses for one time-out, then for two, four,
 *    eight and sixteen, at most `backoff_us`. A dead unit then takes little time from the others. Any response of the
 *    unit, even a damaged one, ends the back-off. FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER prove nothing about
 *    the unit: the count of time-outs stays, and the same pause follows again. A command is sent in spite of a back-off.
 *
 * 4. **Power-on.** After `..._power_on()`, FATHOM_ERR_NO_RESPONSE, FATHOM_ERR_CHECKSUM and FATHOM_ERR_EXCEPTION are
 *    reported as FATHOM_ERR_WARMING_UP until the start-up time has passed. FATHOM_ERR_LINE_BUSY and
 *    FATHOM_ERR_OTHER_MASTER are reported unchanged: a starting unit causes neither, so waiting would not cure them.
 *
 * 5. **An abandoned command ends.** While a command or setting is unfinished, or its result was not fetched,
 *    fathom_poll() returns FATHOM_PENDING and other commands return FATHOM_ERR_BUSY. If its function is not called for
 *    FATHOM_MODBUS_ABANDONED_US and for FATHOM_MODBUS_ABANDONED_POLLS calls of other functions of the driver, the next
 *    call of another function cancels it and proceeds. The abandoned function starts
 *    again when it is called the next time.
 *
 * 6. **A forgotten request ends.** If the line is initialised again while a request of the driver is queued, the request
 *    ends with FATHOM_ERR_CANCELLED, at the latest with the first poll 65.5 ms after that.
 *
 * The longest time until an outcome, if the program polls every P microseconds:
 *
 *     B(t, r)   bound of one transaction with the time-out t and r retries, alone on its line (line.h)
 *     S         sum of the bounds of the line's n other queued transactions; other drivers have one each
 *
 *     fathom_poll()   period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *     a command       period_us + B(timeout_us, retries) + B(command_timeout_us, retries) + 2 S + 2 P
 *
 * A command waits for a measurement that is on the wire. While commands or settings run, fathom_poll() waits for them
 * as well. If one is abandoned, that adds greatest(FATHOM_MODBUS_ABANDONED_US, FATHOM_MODBUS_ABANDONED_POLLS * P).
 */

/** @brief Default of fathom_modbus_config_t::command_timeout_us: 1 s. */
#define FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US 1000000uL

/** @brief Time in microseconds after which a command whose caller does not call may be cancelled (rule 5): 5 s. */
#define FATHOM_MODBUS_ABANDONED_US 5000000uL

/** @brief Number of calls of other functions that must also have passed, so that slow loops keep their command. */
#define FATHOM_MODBUS_ABANDONED_POLLS 16u

/**
 * @brief Connection of a Modbus driver to its sensor: the part of the config that all Modbus drivers share.
 *
 * The driver's init function copies the config. The line of the transport and the line settings must stay valid as long
 * as the driver. A member that is 0 takes its default. The init function returns FATHOM_ERR_ARGUMENT if a member is
 * outside its range.
 */
typedef struct {
    /** @brief Line settings of this unit, if those of the units on one line differ; NULL: `line_settings` of the parts (line.h). */
    const fathom_line_settings_t *line_settings;

    /** @brief Time from one measurement to the next in microseconds, 0 to 2^31 - 1. At least the driver's period. */
    uint32_t period_us;

    /** @brief Time-out of a measurement in microseconds, 1 to 2^31 - 1. 0 selects the driver's default. */
    uint32_t timeout_us;

    /** @brief Time-out of all other requests in microseconds, 1 to 2^31 - 1. 0 selects 1 s. */
    uint32_t command_timeout_us;

    /** @brief Longest back-off in microseconds, 1 to 2^31 - 1. 0 selects 16 time-outs. */
    uint32_t backoff_us;

    /** @brief Address of the unit, 1 to 254. 0 selects 1, the factory setting. HPS-167S: 1 to 32. */
    uint8_t address;

    /**
     * @brief True if the unit is at address 0 and responds there; `address` is 0 then.
     *
     * Such a unit can be read but not set. For A16 and A05 by Modbus only.
     */
    bool address_zero;

    /** @brief Number of retries after a failed read, 0 to 254. Writes are never retried. */
    uint8_t retries;
} fathom_modbus_config_t;

/** @brief What the part for commands does for the measurement (modbus_command.h). NULL until the first command. */
typedef struct fathom_modbus_commands fathom_modbus_commands_t;

/** @brief Values of fathom_modbus_unit_t::current. Commands have greater values (modbus_command.h). */
enum { FATHOM_MODBUS_UNIT_MEASUREMENT = 1 /**< The newest request was the measurement. */ };

/**
 * @brief One Modbus unit, in the driver's memory. Initialise with fathom_modbus_unit_init().
 *
 * The bytes come first, where small machines reach them best. In zeroed memory `transport` is NULL, and each function
 * returns FATHOM_ERR_ARGUMENT or does nothing.
 */
typedef struct {
    /** @brief 0: no request; 1: a request is queued or on the wire; 2: its result was not fetched. */
    uint8_t state;
    /** @brief The newest request: FATHOM_MODBUS_UNIT_MEASUREMENT or the id of a command; 0: none yet. */
    uint8_t current;
    /** @brief Id of the command in progress, from its first call until its result was fetched; 0: none. */
    uint8_t command;
    /** @brief Number of calls of other functions after which the command or setting may be abandoned, 0 to 16 (rule 5). */
    uint8_t calls_left;
    /** @brief FATHOM_PENDING if the line worked at the last poll of the unit; otherwise its error. */
    int8_t transport_status;
    /** @brief Number of attempts of the present request at the last poll. */
    uint8_t attempts;
    /** @brief Number of time-outs in a row, 0 to 7. */
    uint8_t timeouts_in_row;
    /** @brief As in fathom_modbus_config_t. */
    uint8_t retries;
    /** @brief Address of the unit, 0 to 254. A write to address 0 reaches all units. */
    uint8_t address;

    /** @brief Id of the write of the setting in progress; 0: none. This and the next members: modbus_setting.h. */
    uint8_t setting;
    /** @brief Step of the setting in progress (modbus_setting.c). */
    uint8_t step;
    /** @brief True while a call belongs to the setting in progress. Invariant: false between two calls of the driver. */
    bool is_in_setting;
    /** @brief Result of the write. */
    int8_t outcome;
    /** @brief Address of the unit when the setting began. */
    uint8_t known_address;
    /** @brief Id of the newest setting that was acknowledged or read as another value before; 0: none. */
    uint8_t last_written;
    /** @brief True if the write of the newest setting was passed to the line. */
    bool is_written;
    /** @brief True if the next setting, or the setting in progress, is blind. */
    bool is_blind;
    /** @brief The value of `last_written`. */
    uint16_t last_written_value;
    /** @brief Bit (id modulo 16): this setting was written and has not read back since, until power-on. */
    uint16_t unconfirmed;

    /** @brief Number of requests that ended with FATHOM_OK; stops at 65535. */
    uint16_t responses;
    /** @brief Number of requests that failed, retries included; stops at 65535. */
    uint16_t failures;
    /** @brief NULL until the first command. */
    const fathom_modbus_commands_t *commands;
    /** @brief The transport, copied. Invariant: its line is NULL unless init has returned FATHOM_OK. */
    fathom_modbus_t transport;
    /** @brief Present line settings of the unit; NULL: those of the line. */
    const fathom_line_settings_t *line_settings;
    /** @brief Line settings of the unit when the setting began. */
    const fathom_line_settings_t *known_line_settings;
    /** @brief The clock at the last poll, in microseconds. */
    uint32_t polled_us;
    /** @brief Time until the next request may be sent, in microseconds. */
    uint32_t pause_us;
    /** @brief Time until the measurement may be sent again, in microseconds. */
    uint32_t backoff_left_us;
    /** @brief Rest of the start-up time after power-on, in microseconds. */
    uint32_t warm_us;
    /** @brief The clock when the present command or setting was last called, in microseconds (rule 5). */
    uint32_t kept_us;
    /** @brief As in fathom_modbus_config_t, with the defaults filled in. */
    uint32_t timeout_us;
    uint32_t command_timeout_us; /**< @copydoc timeout_us */
    uint32_t pace_us;            /**< @copydoc timeout_us */
    uint32_t backoff_us;         /**< @copydoc timeout_us */
    /** @brief The request. */
    fathom_modbus_request_t request;
} fathom_modbus_unit_t;

/**
 * @brief First step of a driver's init function: clears the driver, unless its request is still queued.
 *
 * `*unit` may be uninitialised: the function compares only its address.
 *
 * @param unit       The unit, a part of the driver.
 * @param transport  The transport that the driver is initialised with, or NULL.
 * @param driver     The driver.
 * @param size       Its size in bytes.
 * @retval FATHOM_OK            All bytes of the driver are 0, and the line of the transport is initialised.
 * @retval FATHOM_ERR_BUSY      The request of this unit is still queued. Nothing has changed. Call the driver's deinit
 *                              function first.
 * @retval FATHOM_ERR_ARGUMENT  `transport` has no initialised line. All bytes of the driver are 0.
 */
fathom_status_t fathom_modbus_unit_begin(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                                         void *driver, size_t size);

/**
 * @brief Initialises a unit. fathom_modbus_unit_begin() has returned FATHOM_OK for the same transport.
 *
 * @param unit        The unit.
 * @param transport   The transport: fathom_modbus_client(), fathom_dyp_client(), or that of a port.
 * @param config      The config, copied. Not NULL.
 * @param timeout_us  Default of `config->timeout_us`.
 * @param pace_us     The driver's least period in microseconds.
 * @retval FATHOM_OK         The unit can be used.
 * @retval FATHOM_ERR_ARGUMENT  A member of the config is outside its range. The unit is still cleared.
 */
fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                                        const fathom_modbus_config_t *config, uint32_t timeout_us,
                                        uint32_t pace_us);

/**
 * @brief Returns true if the line of a transport has room for frames of this length.
 *
 * @param transport  The transport, for which fathom_modbus_unit_begin() has returned FATHOM_OK.
 * @param length     Length of the longest frame of the driver, in bytes.
 */
static inline bool fathom_modbus_unit_has_room(const fathom_modbus_t *transport, uint8_t length)
{
    return length <= transport->line->parts->frame_size;
}

/**
 * @brief Polls the line, unless another driver has polled it in this round, and advances all deadlines.
 *
 * Each function of a driver that sends requests calls this function first and once, because the stack is deepest in it.
 */
void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit);

/**
 * @brief Sends the measurement, or continues with it. Call fathom_modbus_unit_poll() before.
 *
 * Each result is delivered once. The next call starts the next measurement.
 *
 * @param unit    The unit.
 * @param first   Address of the first register.
 * @param count   Number of registers, 1 to 125.
 * @param values  `count` registers in the driver's memory, written on FATHOM_OK only. Must stay valid until the
 *                request has ended.
 * @retval FATHOM_OK           The unit responded. `values` are written.
 * @retval FATHOM_PENDING         The request is not finished, or may not be sent yet, or a command or setting is in
 *                                progress (rule 5).
 * @retval FATHOM_ERR_WARMING_UP  The unit failed so soon after power-on (rule 4).
 * @retval FATHOM_ERR_ARGUMENT    The unit is not initialised, or as fathom_modbus_t::submit.
 * @retval FATHOM_ERR_CAPACITY    As fathom_modbus_t::submit.
 * @retval FATHOM_ERR_PORT        The port is broken. Nothing was sent.
 * @return All other values: the error with which the request ended (fathom_transaction_t).
 */
fathom_status_t fathom_modbus_unit_measure(fathom_modbus_unit_t *unit, uint16_t first, uint8_t count,
                                           uint16_t *values);

/**
 * @brief Cancels the request and forgets its result.
 *
 * A setting in progress may be set or not; the unit uses its former address and line settings again.
 */
void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit);

/**
 * @brief Records that the sensor is powered now: cancels the request and starts the start-up time.
 *
 * @param unit     The unit.
 * @param warm_us  The start-up time in microseconds, at most 2^32 - 1 (rule 4).
 */
void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us);

/** @brief Returns true if the start-up time had not passed at the last call. */
static inline bool fathom_modbus_unit_is_warming_up(const fathom_modbus_unit_t *unit)
{
    return unit->warm_us != 0u;
}

/** @brief Returns the exception code of the last response, valid after FATHOM_ERR_EXCEPTION until the next request. */
static inline uint8_t fathom_modbus_unit_exception(const fathom_modbus_unit_t *unit)
{
    return unit->request.message.exception;
}

/** @brief Returns the number of requests that ended with FATHOM_OK; stops at 65535. */
static inline uint16_t fathom_modbus_unit_responses(const fathom_modbus_unit_t *unit)
{
    return unit->responses;
}

/** @brief Returns the number of requests that failed, retries included; stops at 65535. */
static inline uint16_t fathom_modbus_unit_failures(const fathom_modbus_unit_t *unit)
{
    return unit->failures;
}

/** @brief Returns the clock at the last byte of the response, in microseconds. Valid until the next request. */
static inline uint32_t fathom_modbus_unit_heard_us(const fathom_modbus_unit_t *unit)
{
    return unit->request.transaction.link.heard_us;
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The time assumes that the measurement is sent again. 0 for a unit that is not initialised.
 */
uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit);

#ifdef __cplusplus
}
#endif

#endif
