/* SPDX-License-Identifier: MIT */
/*
 * Fathom's Modbus client on the termios port, for functions that no command of the tool has:
 *
 *     fathom_client PORT BAUD none|even TIMEOUT_MS STEP ...
 *
 * Exit status 0 when every step was tried, 1 when the port does not open, 2 for wrong usage. Whether the line
 * has an echo is found out by a read: a write needs one before it.
 */
#include <stdio.h>
#include <stdlib.h>

#include "fathom/modbus_client.h"
#include "fathom_posix.h"
#include "steps.h"

enum { BITS_OF_8N1 = 10, BITS_OF_8E1 = 11, BEHIND_AN_OS_US = 25000 };

static void print_outcome(const fathom_modbus_request_t *request, const step_t *step)
{
    switch (request->exchange.status) {
    case FATHOM_READY:
        if (step->kind == STEP_READ)
            step_print(step->values, step->count, 4);
        else
            (void)puts("done");
        break;
    case FATHOM_ERR_EXCEPTION:
        (void)printf("exception %u\n", request->message.exception);
        break;
    case FATHOM_ERR_NO_ANSWER:
        (void)puts("no answer");
        break;
    case FATHOM_ERR_CHECKSUM:
        (void)puts("damaged");
        break;
    case FATHOM_ERR_MALFORMED:
        (void)puts("unfit");
        break;
    default:
        (void)printf("status %d\n", request->exchange.status);
        break;
    }
}

static bool run(fathom_line_t *line, fathom_posix_uart_t *port, step_t *step, uint8_t unit,
                uint32_t timeout_us)
{
    fathom_modbus_request_t request = {.exchange = {.timeout_us = timeout_us}};
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
    const fathom_status_t status = fathom_modbus_client_submit(line, &request);
    if (status != FATHOM_PENDING) {
        (void)printf("not sent, status %d\n", (int)status);
        return true;
    }
    for (;;) {
        (void)fathom_line_poll(line);
        if (request.exchange.status != FATHOM_PENDING) break;
        fathom_posix_wait(port, fathom_line_due_us(line));
    }
    print_outcome(&request, step);
    (void)fflush(stdout);
    return true;
}

static bool run_all(fathom_line_t *line, fathom_posix_uart_t *port, uint32_t timeout_us, char **steps)
{
    uint8_t unit = 1;
    for (; *steps != NULL; steps++) {
        step_t step;
        if (!step_parse(&step, *steps)) return false;
        if (step.kind == STEP_UNIT)
            unit = (uint8_t)step.first;
        else if (!run(line, port, &step, unit, timeout_us))
            return false;
    }
    return true;
}

int main(int argc, char **argv)
{
    if (argc < 6) return 2;
    const bool has_parity = argv[3][0] == 'e';
    const fathom_line_settings_t settings = {(uint32_t)strtoul(argv[2], NULL, 10),
                                             has_parity ? FATHOM_PARITY_EVEN : FATHOM_PARITY_NONE, 1};
    static fathom_posix_uart_t port;
    if (fathom_posix_open(&port, argv[1], &settings) != FATHOM_POSIX_OK) {
        (void)fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
        return 1;
    }
    static uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
    const fathom_uart_t uart = fathom_posix_uart(&port);
    const fathom_clock_t clock = fathom_posix_clock();
    const fathom_line_config_t config = {
        .uart = &uart,
        .clock = &clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .silence_us = FATHOM_T3_5_US(settings.baud, has_parity ? BITS_OF_8E1 : BITS_OF_8N1),
        .gap_us = BEHIND_AN_OS_US,
    };
    fathom_line_t line;
    bool is_usage = fathom_line_init(&line, &config) == FATHOM_READY;
    is_usage = is_usage && run_all(&line, &port, (uint32_t)strtoul(argv[4], NULL, 10) * 1000u, argv + 5);
    fathom_posix_close(&port);
    return is_usage ? 0 : 2;
}
