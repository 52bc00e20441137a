/* SPDX-License-Identifier: MIT */
#include "transport.h"

#include <stdio.h>

#include "steps.h"

static void print_outcome(const fathom_modbus_request_t *request, const step_t *step)
{
    switch (request->transaction.status) {
    case FATHOM_OK:
        if (step->kind == STEP_READ)
            step_print(step->values, step->count, 4);
        else
            (void)puts("done");
        break;
    case FATHOM_ERR_EXCEPTION:
        (void)printf("exception %u\n", request->message.exception);
        break;
    case FATHOM_ERR_NO_RESPONSE:
        (void)puts("no response");
        break;
    case FATHOM_ERR_CHECKSUM:
        (void)puts("damaged");
        break;
    case FATHOM_ERR_MALFORMED:
        (void)puts("unfit");
        break;
    default:
        (void)printf("%s\n", fathom_status_name((fathom_status_t)request->transaction.status));
        break;
    }
}

static bool run(const transport_t *transport, step_t *step, uint8_t unit)
{
    fathom_line_t *const line = transport->modbus->line;
    fathom_modbus_request_t request = {.transaction = {.timeout_us = transport->timeout_us}};
    switch (step->kind) {
    case STEP_READ:
        fathom_modbus_read_holding_registers(&request.message, unit, step->first, (uint8_t)step->count,
                                             step->values);
        break;
    case STEP_WRITE:
        fathom_modbus_write_single_register(&request.message, unit, step->first, step->values[0]);
        break;
    case STEP_MANY:
        fathom_modbus_write_multiple_registers(&request.message, unit, step->first, (uint8_t)step->count,
                                               step->values);
        break;
    default:
        return false;
    }
    const fathom_status_t status = transport->modbus->submit(line, &request);
    if (status != FATHOM_PENDING) {
        (void)printf("not sent, %s\n", fathom_status_name(status));
        return true;
    }
    for (;;) {
        (void)fathom_line_poll(line);
        if (request.transaction.status != FATHOM_PENDING) break;
        transport->wait(transport->port, fathom_line_due_us(line));
    }
    print_outcome(&request, step);
    (void)fflush(stdout);
    return true;
}

bool transport_run(const transport_t *transport, char **steps)
{
    uint8_t unit = 1;
    for (; *steps != NULL; steps++) {
        step_t step;
        if (!step_parse(&step, *steps)) return false;
        if (step.kind == STEP_UNIT)
            unit = (uint8_t)step.first;
        else if (!run(transport, &step, unit))
            return false;
    }
    return true;
}
