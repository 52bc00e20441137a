/* SPDX-License-Identifier: MIT */
/*
 * A Modbus RTU client by libmodbus:
 *
 *     libmodbus_client PORT BAUD none|even TIMEOUT_MS STEP ...
 *
 * Exit status 0 when every step was tried, 1 when the port does not open, 2 for wrong usage.
 */
#include <errno.h>
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>

#include "steps.h"

enum { FUNCTION = 1, EXCEPTION = 0x80, CRC_LENGTH = 2 };

static void print_failure(void)
{
    const int exception = errno - MODBUS_ENOBASE; /* EMBXILFUN is MODBUS_ENOBASE + 1, and so on */
    if (exception > 0 && exception < MODBUS_EXCEPTION_MAX)
        (void)printf("exception %d\n", exception);
    else if (errno == ETIMEDOUT)
        (void)puts("no response");
    else if (errno == EMBBADCRC)
        (void)puts("damaged");
    else if (errno == EMBBADDATA)
        (void)puts("unfit");
    else
        (void)puts(modbus_strerror(errno));
}

static void print_outcome(int result, const uint16_t *values, uint16_t count)
{
    if (result < 0)
        print_failure();
    else
        step_print(values, count, 4);
}

static void acknowledge(int result)
{
    if (result < 0)
        print_failure();
    else
        (void)puts("done");
}

static void coils(modbus_t *client, const step_t *step)
{
    uint8_t bits[STEP_VALUES];
    uint16_t values[STEP_VALUES];
    const int result = modbus_read_bits(client, step->first, step->count, bits);
    for (int i = 0; i < result; i++) values[i] = bits[i];
    print_outcome(result, values, step->count);
}

/* libmodbus adds the CRC, checks that of the response, and leaves the rest to its caller. */
static void raw(modbus_t *client, const step_t *step)
{
    uint8_t request[STEP_VALUES + 1], response[MODBUS_RTU_MAX_ADU_LENGTH];
    uint16_t bytes[MODBUS_RTU_MAX_ADU_LENGTH];
    request[0] = (uint8_t)modbus_get_slave(client);
    for (int i = 0; i != step->count; i++) request[i + 1] = (uint8_t)step->values[i];
    int length = modbus_send_raw_request(client, request, step->count + 1);
    if (length >= 0) length = modbus_receive_confirmation(client, response);
    if (length >= 0 && (response[FUNCTION] & EXCEPTION) != 0) {
        (void)printf("exception %d\n", response[FUNCTION + 1]);
    } else if (length < 0) {
        print_failure();
    } else {
        for (int i = 0; i != length; i++) bytes[i] = response[i];
        step_print(bytes, (uint16_t)(length - CRC_LENGTH), 2);
    }
}

static void run(modbus_t *client, const step_t *step)
{
    uint16_t values[STEP_VALUES];
    switch (step->kind) {
    case STEP_READ:
        print_outcome(modbus_read_registers(client, step->first, step->count, values), values, step->count);
        break;
    case STEP_INPUT:
        print_outcome(modbus_read_input_registers(client, step->first, step->count, values), values,
                      step->count);
        break;
    case STEP_COILS:
        coils(client, step);
        break;
    case STEP_WRITE:
        acknowledge(modbus_write_register(client, step->first, step->values[0]));
        break;
    case STEP_MANY:
        acknowledge(modbus_write_registers(client, step->first, step->count, step->values));
        break;
    case STEP_RAW:
        raw(client, step);
        break;
    case STEP_UNIT:
        if (modbus_set_slave(client, step->first) != 0) (void)puts("libmodbus does not take this unit");
        break;
    }
    (void)fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc < 6) return 2;
    const unsigned long timeout_ms = strtoul(argv[4], NULL, 10);
    modbus_t *const client =
        modbus_new_rtu(argv[1], (int)strtol(argv[2], NULL, 10), argv[3][0] == 'e' ? 'E' : 'N', 8, 1);
    if (client == NULL || modbus_set_slave(client, 1) != 0 || modbus_connect(client) != 0 ||
        modbus_set_response_timeout(client, (uint32_t)(timeout_ms / 1000),
                                    (uint32_t)(timeout_ms % 1000 * 1000)) != 0) {
        (void)fprintf(stderr, "%s: %s\n", argv[1], modbus_strerror(errno));
        modbus_free(client);
        return 1;
    }
    int status = 0;
    for (int i = 5; i != argc && status == 0; i++) {
        step_t step;
        if (step_parse(&step, argv[i]))
            run(client, &step);
        else
            status = 2;
    }
    modbus_close(client);
    modbus_free(client);
    return status;
}
