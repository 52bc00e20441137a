/* SPDX-License-Identifier: MIT */
#include "fathom/engine/modbus_client.h"

#include "fathom/codec/crc16.h"
#include "modbus_client_internal.h"

/*
 * The Modbus RTU client of a line on which a unit may have the address 0. A program that does not name it
 * does not search noise for frames of unit 0.
 */

static const fathom_protocol_t protocol = {.encode = fathom_modbus_client_encode,
                                           .length = fathom_modbus_rtu_response_length,
                                           .check = fathom_crc16,
                                           .is_request = fathom_modbus_client_is_request,
                                           .parse_response = fathom_modbus_client_parse_response,
                                           .may_collide = fathom_modbus_client_may_collide,
                                           .is_unit_0_ordinary = true};

fathom_status_t fathom_modbus_client_submit_with_zero(fathom_line_t *line, fathom_modbus_request_t *request)
{
    if (fathom_modbus_client_reads_0(request) || (request->message.head[0] == FATHOM_MODBUS_ANY_UNIT))
        return fathom_modbus_client_start(line, request, &protocol);
    return fathom_modbus_client_submit(line, request);
}

fathom_modbus_t fathom_modbus_client_with_zero(fathom_line_t *line)
{
    const fathom_modbus_t transport = {.line = line, .submit = fathom_modbus_client_submit_with_zero};
    return transport;
}
