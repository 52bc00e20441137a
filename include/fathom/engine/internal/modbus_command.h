/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_COMMAND_H
#define FATHOM_MODBUS_COMMAND_H

#include "fathom/engine/internal/modbus_unit.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Requests to a Modbus unit that are sent once, beside its measurement.
 *
 * The functions of the drivers that read or set something are built on this file; their users need not know it. The rules
 * stand in modbus_unit.h: at most one command or setting is in progress, and one that its caller has abandoned ends.
 */

/** @brief Ids of requests. */
enum { FATHOM_MODBUS_COMMAND = 0x80 /**< The least id of a command. */ };

/** @brief A command: one request of a driver. */
typedef struct {
    /**
     * @brief The registers, in the driver's memory.
     *
     * The registers of a read are written on FATHOM_OK only. Those of function 10 are read when the request leaves.
     * NULL for function 06.
     */
    uint16_t *values;
    /** @brief Address of the first register. */
    uint16_t first;
    /** @brief Number of registers: 1 to 125 to read, 1 to 123 to write. Function 06: the value. */
    uint16_t last;
    /** @brief FATHOM_MODBUS_READ_HOLDING_REGISTERS or one of the two functions that write. */
    uint8_t function;
    /** @brief Identifies the command within its driver: FATHOM_MODBUS_COMMAND to 255. */
    uint8_t id;
} fathom_modbus_unit_request_t;

/**
 * @brief Sends a command, or continues with it. Call fathom_modbus_unit_poll() before.
 *
 * Call both functions with a command of the same id until the result differs from FATHOM_PENDING. Each result is
 * delivered once. If two callers have the same command, the first to call receives the result, and the other starts
 * again.
 *
 * @param unit     The unit.
 * @param command  The command. Read during the call only, except `values`.
 * @retval FATHOM_OK           The unit responded. `values` are written.
 * @retval FATHOM_PENDING         The command is not finished, or may not be sent yet.
 * @retval FATHOM_ERR_BUSY        Another command or setting is unfinished, or its result was not fetched (rule 5 of
 *                                modbus_unit.h).
 * @return All other values: as fathom_modbus_unit_measure().
 */
fathom_status_t fathom_modbus_command(fathom_modbus_unit_t *unit,
                                      const fathom_modbus_unit_request_t *command);

/**
 * @brief Cancels the command or setting in progress if its caller has abandoned it (rule 5 of modbus_unit.h).
 *
 * Each call counts as a call of another function. Call it only if a command or setting is in progress and another one
 * waits for it.
 *
 * @retval true   The command or setting was abandoned, and is cancelled now.
 * @retval false  The command or setting is in progress.
 */
bool fathom_modbus_command_give_way(fathom_modbus_unit_t *unit);

/** @brief Records that the caller of the present command or setting has called (rule 5 of modbus_unit.h). */
void fathom_modbus_command_keep(fathom_modbus_unit_t *unit);

#ifdef __cplusplus
}
#endif

#endif
